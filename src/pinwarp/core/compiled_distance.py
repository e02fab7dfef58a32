"""The search for the closest triangle, compiled by numba.

Import only through :mod:`pinwarp.core.surface_distance`.

One thread a call, without the interpreter's lock: callers bring their own threads, and the live
preview never waits for a search to end.
"""

from __future__ import annotations

import numba
import numpy as np

# Not fastmath: the search begins at infinity, and what is no triangle is told by NaN.
_compile = numba.njit(cache=True, nogil=True, error_model="numpy")

# How many threads a search may be shared by.
THREADS = numba.config.NUMBA_NUM_THREADS
# Enough for a tree over more triangles than 32 bits can count.
DEEPEST = 64


@_compile
def _to_box(box, x, y, z):
    """Return the squared distance to a box: x, y, z from, then to."""
    dx = max(box[0] - x, 0.0, x - box[3])
    dy = max(box[1] - y, 0.0, y - box[4])
    dz = max(box[2] - z, 0.0, z - box[5])
    return dx * dx + dy * dy + dz * dz


@_compile
def _to_edge(dx, dy, dz, ex, ey, ez):
    """Return the squared distance to the edge from 0 to e."""
    length = ex * ex + ey * ey + ez * ez
    share = (dx * ex + dy * ey + dz * ez) / length if length > 0 else 0.0
    share = min(max(share, 0.0), 1.0)
    dx -= share * ex
    dy -= share * ey
    dz -= share * ez
    return dx * dx + dy * dy + dz * dz


@_compile
def _to_triangle(row, x, y, z):
    """Return the squared distance to a triangle: a corner, two edges from it, normal / area^2."""
    dx, dy, dz = x - row[0], y - row[1], z - row[2]
    ux, uy, uz = row[3], row[4], row[5]
    vx, vy, vz = row[6], row[7], row[8]
    nx, ny, nz = row[9], row[10], row[11]
    s = (dy * vz - dz * vy) * nx + (dz * vx - dx * vz) * ny + (dx * vy - dy * vx) * nz
    t = (uy * dz - uz * dy) * nx + (uz * dx - ux * dz) * ny + (ux * dy - uy * dx) * nz
    # All false for a triangle without area, whose normal is NaN.
    if s >= 0 and t >= 0 and s + t <= 1:
        dx -= s * ux + t * vx
        dy -= s * uy + t * vy
        dz -= s * uz + t * vz
        return dx * dx + dy * dy + dz * dz
    return min(
        _to_edge(dx, dy, dz, ux, uy, uz),
        _to_edge(dx, dy, dz, vx, vy, vz),
        _to_edge(dx - ux, dy - uy, dz - uz, vx - ux, vy - uy, vz - uz),
    )


@_compile
def closest_triangles(boxes, triangles, places, out, squares):
    """Write the row of the closest triangle and the squared distance to it.

    Parameters
    ----------
    boxes
        (2 k - 1, 6) boxes of a complete binary tree, those of node i's halves at 2 i + 1 and
        2 i + 2. The last k are the leaves, which share the triangles evenly, in order.
    triangles
        (k * leaf, 12), see :func:`_to_triangle`.
    places
        (m, 3), neighbours preferably one after the other.
    out, squares
        (m,) int64 and float64.
    """
    leaves = (len(boxes) + 1) // 2
    leaf = len(triangles) // leaves
    nodes = np.empty(DEEPEST, np.int64)
    bounds = np.empty(DEEPEST)
    closest = 0
    for i in range(len(places)):
        x, y, z = places[i]
        # What was closest to the place before is seldom far from this one.
        best = _to_triangle(triangles[closest], x, y, z)
        nodes[0] = 0
        bounds[0] = _to_box(boxes[0], x, y, z)
        waiting = 1
        while waiting:
            waiting -= 1
            node = nodes[waiting]
            if bounds[waiting] >= best:
                continue
            if node >= leaves - 1:
                first = (node - leaves + 1) * leaf
                for row in range(first, first + leaf):
                    square = _to_triangle(triangles[row], x, y, z)
                    if square < best:
                        best = square
                        closest = row
                continue
            near, far = 2 * node + 1, 2 * node + 2
            near_bound = _to_box(boxes[near], x, y, z)
            far_bound = _to_box(boxes[far], x, y, z)
            if far_bound < near_bound:
                near, far = far, near
                near_bound, far_bound = far_bound, near_bound
            if far_bound < best:
                nodes[waiting] = far
                bounds[waiting] = far_bound
                waiting += 1
            if near_bound < best:
                nodes[waiting] = near
                bounds[waiting] = near_bound
                waiting += 1
        out[i] = closest
        squares[i] = best


@_compile
def closest_positions(triangles, rows, places, out):
    """Write the position closest to each place in a triangle that is known.

    Parameters
    ----------
    triangles
        (t, 12), see :func:`_to_triangle`.
    rows, places
        (m,) which of them, and (m, 3).
    out
        (m, 3).
    """
    edges = np.empty((3, 6))
    for i in range(len(places)):
        row = triangles[rows[i]]
        d = places[i] - row[:3]
        u, v = row[3:6], row[6:9]
        nx, ny, nz = row[9], row[10], row[11]
        s = (d[1] * v[2] - d[2] * v[1]) * nx
        s += (d[2] * v[0] - d[0] * v[2]) * ny + (d[0] * v[1] - d[1] * v[0]) * nz
        t = (u[1] * d[2] - u[2] * d[1]) * nx
        t += (u[2] * d[0] - u[0] * d[2]) * ny + (u[0] * d[1] - u[1] * d[0]) * nz
        # All false for a triangle without area, whose normal is NaN.
        if s >= 0 and t >= 0 and s + t <= 1:
            for j in range(3):
                out[i, j] = row[j] + s * u[j] + t * v[j]
            continue
        # Where each edge begins, and how it goes on.
        for j in range(3):
            edges[0, j], edges[0, 3 + j] = 0.0, u[j]
            edges[1, j], edges[1, 3 + j] = 0.0, v[j]
            edges[2, j], edges[2, 3 + j] = u[j], v[j] - u[j]
        best = np.inf
        for edge in edges:
            length, along = 0.0, 0.0
            for j in range(3):
                length += edge[3 + j] * edge[3 + j]
                along += (d[j] - edge[j]) * edge[3 + j]
            share = min(max(along / length, 0.0), 1.0) if length > 0 else 0.0
            square = 0.0
            for j in range(3):
                square += (d[j] - edge[j] - share * edge[3 + j]) ** 2
            if square < best:
                best = square
                for j in range(3):
                    out[i, j] = row[j] + edge[j] + share * edge[3 + j]
