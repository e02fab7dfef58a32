"""Small work in one compiled pass each. Import only through :mod:`pinwarp.core.small`.

Up to some hundred landmarks numpy spends more time on being called than on numbers.
"""

from __future__ import annotations

import numba
import numpy as np

from pinwarp.core.factor import CLOSE_TOLERANCE, PLANAR_TOLERANCE, TINIEST
from pinwarp.core.positions import LARGEST_COORDINATE

# Directions of a basis: the constant, x, y and z.
COLUMNS = 4
# Flatter landmarks may lie in a plane, as far as can be told here.
CERTAINLY_SPACE = 1e-3
NOT_SOLVED = -1.0

_options = {"fastmath": {"contract", "reassoc"}, "nogil": True, "error_model": "numpy"}
_compile = numba.njit(cache=True, **_options)
# Called from compiled code alone: not to make them callable from Python compiles in half the time.
_within = numba.njit(no_cpython_wrapper=True, no_cfunc_wrapper=True, **_options)


@_compile
def warp_point(table, point):
    """Return the warped point, NaN where it or what becomes of it cannot be used.

    The table (n + 3, 6) holds the centre, the affine part about it as rows of three, and then
    every landmark about the centre with its weight; see :func:`pinwarp.core.small.table_of`.
    """
    out = np.empty(3)
    x = point[0] - table[0, 0]
    y = point[1] - table[0, 1]
    z = point[2] - table[0, 2]
    fx = table[0, 3] + table[1, 0] * x + table[1, 3] * y + table[2, 0] * z
    fy = table[0, 4] + table[1, 1] * x + table[1, 4] * y + table[2, 1] * z
    fz = table[0, 5] + table[1, 2] * x + table[1, 5] * y + table[2, 2] * z
    for k in range(3, table.shape[0]):
        dx = x - table[k, 0]
        dy = y - table[k, 1]
        dz = z - table[k, 2]
        r = np.sqrt(dx * dx + dy * dy + dz * dz)
        fx += table[k, 3] * r
        fy += table[k, 4] * r
        fz += table[k, 5] * r
    out[0] = fx
    out[1] = fy
    out[2] = fz
    for i in range(3):
        if not (abs(point[i]) <= LARGEST_COORDINATE and abs(out[i]) <= LARGEST_COORDINATE):
            out[0] = np.nan
    return out


@_within
def _are_usable(positions):
    for i in range(positions.shape[0]):
        for j in range(3):
            if not abs(positions[i, j]) <= LARGEST_COORDINATE:
                return False
    return True


@_within
def _mean(positions):
    mean = np.zeros(3)
    for i in range(positions.shape[0]):
        for j in range(3):
            mean[j] += positions[i, j]
    return mean / positions.shape[0]


@_within
def _smallest_share(unit):
    """Return the smallest eigenvalue of ``unit unit^T`` (3, 3) as a share of the largest.

    In closed form (Smith, Comm. ACM 4 (1961)): good to rounding of the largest.
    """
    a = _dot(unit[0], unit[0])
    b = _dot(unit[1], unit[1])
    c = _dot(unit[2], unit[2])
    d = _dot(unit[0], unit[1])
    e = _dot(unit[1], unit[2])
    f = _dot(unit[0], unit[2])
    mean = (a + b + c) / 3
    a -= mean
    b -= mean
    c -= mean
    spread = np.sqrt((a * a + b * b + c * c + 2 * (d * d + e * e + f * f)) / 6)
    if spread == 0:
        return 1.0
    half = (a * (b * c - e * e) - d * (d * c - e * f) + f * (d * e - b * f)) / (2 * spread**3)
    angle = np.arccos(min(max(half, -1.0), 1.0)) / 3
    largest = mean + 2 * spread * np.cos(angle)
    smallest = mean + 2 * spread * np.cos(angle + 2 * np.pi / 3)
    return smallest / largest


@_within
def _dot(a, b):
    total = 0.0
    for i in range(a.shape[0]):
        total += a[i] * b[i]
    return total


@_within
def _reflect(reflectors, triangle, transposed, values):
    """Write ``Q values`` (or ``Q^T values``) over one column, Q = I - V T V^T."""
    seen = np.empty(COLUMNS)
    for c in range(COLUMNS):
        seen[c] = _dot(reflectors[c], values)
    for c in range(COLUMNS):
        share = 0.0
        for k in range(COLUMNS):
            share += (triangle[k, c] if transposed else triangle[c, k]) * seen[k]
        for i in range(values.shape[0]):
            values[i] -= share * reflectors[c, i]


@_within
def _factorise(basis, upper, triangle):
    """Reflect the rows of the basis (4, n) into reflectors, in place: P = Q R, LAPACK's geqrf."""
    for c in range(COLUMNS):
        column = basis[c, c:]
        head = column[0]
        norm = np.sqrt(_dot(column, column))
        diagonal = -norm if head > 0 else norm
        for k in range(c):
            upper[k, c] = basis[c, k]
            basis[c, k] = 0.0
        upper[c, c] = diagonal
        tau = (diagonal - head) / diagonal
        for i in range(1, column.shape[0]):
            column[i] /= head - diagonal
        column[0] = 1.0
        for later in range(c + 1, COLUMNS):
            share = tau * _dot(column, basis[later, c:])
            for i in range(column.shape[0]):
                basis[later, c + i] -= share * column[i]
        triangle[c, c] = tau
        for k in range(c):
            total = 0.0
            for m in range(k, c):
                total += triangle[k, m] * _dot(basis[m], basis[c])
            triangle[k, c] = -tau * total


@_within
def _cholesky(lower):
    """Factorise a symmetric matrix in place, by its lower triangle; False where it is not one."""
    count = lower.shape[0]
    for j in range(count):
        row = lower[j]
        pivot = row[j] - _dot(row[:j], row[:j])
        if not pivot > 0:
            return False
        pivot = np.sqrt(pivot)
        row[j] = pivot
        for i in range(j + 1, count):
            lower[i, j] = (lower[i, j] - _dot(lower[i, :j], row[:j])) / pivot
    return True


@_within
def _solve_lower(lower, values):
    """Solve ``L L^T x = values`` in place."""
    count = lower.shape[0]
    for i in range(count):
        values[i] = (values[i] - _dot(lower[i, :i], values[:i])) / lower[i, i]
    for i in range(count - 1, -1, -1):
        values[i] /= lower[i, i]
        value = values[i]
        for j in range(i):
            values[j] -= value * lower[i, j]


@_within
def _distances(unit, distances):
    """Write the distances between columns (3, n); return the least and largest to the nearest."""
    count = unit.shape[1]
    least = np.inf
    most = 0.0
    for i in range(count):
        x = unit[0, i]
        y = unit[1, i]
        z = unit[2, i]
        row = distances[i]
        for j in range(count):
            dx = unit[0, j] - x
            dy = unit[1, j] - y
            dz = unit[2, j] - z
            row[j] = np.sqrt(dx * dx + dy * dy + dz * dz)
        row[i] = np.inf
        nearest = np.inf
        for j in range(count):
            nearest = min(nearest, row[j])
        row[i] = 0.0
        least = min(least, nearest)
        most = max(most, nearest)
    return least, most


@_compile
def solve(source, destination, penalty):
    """Solve as :func:`pinwarp.core.spline.solve` does; the steps are explained there.

    Returns
    -------
    flatness : float
        The smallest extent of the landmarks as a share of the largest. Below 0 where nothing is
        solved, since something is to be said or refused: the caller then goes the long way.
    weights (n, 3), affine (4, 3)
    """
    count = source.shape[0]
    weights = np.empty((count, 3))
    affine = np.empty((COLUMNS, 3))
    if not (_are_usable(source) and _are_usable(destination)):
        return NOT_SOLVED, weights, affine

    # The source about its centre and in units of its size, by column: loops run along landmarks.
    centre = _mean(source)
    target = _mean(destination)
    extent = 0.0
    for i in range(count):
        for j in range(3):
            extent = max(extent, abs(source[i, j] - centre[j]))
    square = 0.0
    for i in range(count):
        for j in range(3):
            square += ((source[i, j] - centre[j]) / max(extent, TINIEST)) ** 2
    scale = extent * np.sqrt(square / count)
    if scale <= max(1e-12 * max(abs(centre[0]), abs(centre[1]), abs(centre[2])), TINIEST):
        return NOT_SOLVED, weights, affine
    basis = np.ones((COLUMNS, count))
    for i in range(count):
        for j in range(3):
            basis[1 + j, i] = (source[i, j] - centre[j]) / scale

    # What is next to a limit is left to the long way as well: it knows better.
    share = _smallest_share(basis[1:])
    flatness = np.sqrt(max(share, 0.0))
    if flatness < CERTAINLY_SPACE or abs(flatness / PLANAR_TOLERANCE - 1) < 1e-3:
        return NOT_SOLVED, weights, affine
    distances = np.empty((count, count))
    least, most = _distances(basis[1:], distances)
    same = 8 * count * np.finfo(np.float64).eps * count
    if not least > max(1.001 * CLOSE_TOLERANCE * most, same):
        return NOT_SOLVED, weights, affine

    # N = -Q2^T K Q2 with the penalty, and what couples it to the affine part above
    upper = np.zeros((COLUMNS, COLUMNS))
    triangle = np.zeros((COLUMNS, COLUMNS))
    _factorise(basis, upper, triangle)
    across = np.empty((COLUMNS, count))
    for i in range(count):
        for c in range(COLUMNS):
            across[c, i] = _dot(distances[i], basis[c])
    turned = np.zeros((COLUMNS, count))
    for c in range(COLUMNS):
        for k in range(c + 1):
            share = triangle[k, c]
            for i in range(count):
                turned[c, i] += share * across[k, i]
    inner = np.empty((COLUMNS, COLUMNS))
    for c in range(COLUMNS):
        for k in range(COLUMNS):
            inner[k, c] = _dot(basis[k], turned[c])
    for c in range(COLUMNS):
        for m in range(COLUMNS):
            share = 0.0
            for k in range(m + 1):
                share += triangle[k, m] * inner[k, c]
            for i in range(count):
                across[c, i] = turned[c, i] if m == 0 else across[c, i]
                across[c, i] -= 0.5 * share * basis[m, i]
    rest = count - COLUMNS
    coupling = np.empty((COLUMNS, rest))
    lower = np.empty((rest, rest))
    for i in range(count):
        row = coupling[i] if i < COLUMNS else lower[i - COLUMNS]
        stop = rest if i < COLUMNS else i - COLUMNS + 1
        x0 = across[0, i]
        x1 = across[1, i]
        x2 = across[2, i]
        x3 = across[3, i]
        v0 = basis[0, i]
        v1 = basis[1, i]
        v2 = basis[2, i]
        v3 = basis[3, i]
        for j in range(stop):
            k = COLUMNS + j
            row[j] = (
                (x0 * basis[0, k] + x1 * basis[1, k] + x2 * basis[2, k] + x3 * basis[3, k])
                + (v0 * across[0, k] + v1 * across[1, k] + v2 * across[2, k] + v3 * across[3, k])
                - distances[i, k]
            )
    for i in range(rest):
        lower[i, i] += penalty / scale
    if not _cholesky(lower):
        return NOT_SOLVED, weights, affine

    # Bending and affine part of the destination, coordinate by coordinate
    column = np.empty(count)
    finite = True
    for c in range(3):
        for i in range(count):
            column[i] = (destination[i, c] - target[c]) / scale
        _reflect(basis, triangle, True, column)
        bent = column[COLUMNS:]
        _solve_lower(lower, bent)
        for i in range(COLUMNS - 1, -1, -1):
            total = column[i] - _dot(coupling[i], bent)
            for k in range(i + 1, COLUMNS):
                total -= upper[i, k] * affine[k, c]
            affine[i, c] = total / upper[i, i]
        affine[0, c] = target[c] + scale * affine[0, c]
        for j in range(3):
            affine[0, c] -= centre[j] * affine[1 + j, c]
        for i in range(COLUMNS):
            column[i] = 0.0
            finite &= np.isfinite(affine[i, c])
        _reflect(basis, triangle, False, column)
        for i in range(count):
            weights[i, c] = -column[i]
            finite &= np.isfinite(column[i])
    return (flatness if finite else NOT_SOLVED), weights, affine
