"""The evaluation loops, compiled by numba. Import only through :mod:`pinwarp.core.kernel`.

Points are taken in blocks that stay in the first-level cache while every landmark is added to
them; a block's coordinates are kept apart (x, y, z) so that the inner loop becomes vector code.
All loops run on every core and without the interpreter's lock.
"""

from __future__ import annotations

import numba
import numpy as np

from pinwarp.core.blocks import BLOCK, LARGEST_FIELD

# Sums in the precision of the points are added into double-precision totals after this many.
RUN = 32
# Landmarks whose distances are kept at hand while many fields are summed over them.
FEW = 8

_compile = numba.njit(parallel=True, fastmath=True, cache=True, nogil=True, error_model="numpy")


@_compile
def evaluate(source, weights, affine, points, out, logarithmic):
    """Write ``f(points)`` into out.

    Distances have the precision of the points (with which source, weights and out agree); affine
    (4, 3) and the totals are double. The basis is r where logarithmic is None, which is another
    compiled loop than that of ``r^2 log r``, not a question asked in it.
    """
    tiny = np.finfo(points.dtype).tiny
    count = source.shape[0]
    total = points.shape[0]
    for block in numba.prange((total + BLOCK - 1) // BLOCK):
        first = block * BLOCK
        size = min(BLOCK, total - first)
        x = np.empty(BLOCK, points.dtype)
        y = np.empty(BLOCK, points.dtype)
        z = np.empty(BLOCK, points.dtype)
        sx = np.empty(BLOCK, points.dtype)
        sy = np.empty(BLOCK, points.dtype)
        sz = np.empty(BLOCK, points.dtype)
        fx = np.empty(BLOCK)
        fy = np.empty(BLOCK)
        fz = np.empty(BLOCK)
        for i in range(size):
            x[i] = points[first + i, 0]
            y[i] = points[first + i, 1]
            z[i] = points[first + i, 2]
        for i in range(size):
            fx[i] = affine[0, 0] + affine[1, 0] * x[i] + affine[2, 0] * y[i] + affine[3, 0] * z[i]
            fy[i] = affine[0, 1] + affine[1, 1] * x[i] + affine[2, 1] * y[i] + affine[3, 1] * z[i]
            fz[i] = affine[0, 2] + affine[1, 2] * x[i] + affine[2, 2] * y[i] + affine[3, 2] * z[i]
        start = 0
        while start < count:
            for i in range(size):
                sx[i] = 0
                sy[i] = 0
                sz[i] = 0
            for k in range(start, min(count, start + RUN)):
                ux = source[k, 0]
                uy = source[k, 1]
                uz = source[k, 2]
                wx = weights[k, 0]
                wy = weights[k, 1]
                wz = weights[k, 2]
                for i in range(size):
                    dx = x[i] - ux
                    dy = y[i] - uy
                    dz = z[i] - uz
                    r = dx * dx + dy * dy + dz * dz
                    if logarithmic is None:
                        r = np.sqrt(r)
                    else:
                        r *= np.log(r + tiny) / 2
                    sx[i] += wx * r
                    sy[i] += wy * r
                    sz[i] += wz * r
            for i in range(size):
                fx[i] += sx[i]
                fy[i] += sy[i]
                fz[i] += sz[i]
            start += RUN
        for i in range(size):
            out[first + i, 0] = fx[i]
            out[first + i, 1] = fy[i]
            out[first + i, 2] = fz[i]


@_compile
def evaluate_fields(source, weights, affine, points, fields, scales):
    """Write many scalar splines over the same landmarks as 16-bit fields.

    Field q of a point is ``affine[:, q] . (1, v) + sum_k weights[k, q] |u_k - v|``, stored as
    ``fields[q, i] * scales[block, q]``. Everything is float32 but fields, which is int16.
    """
    count = source.shape[0]
    total = points.shape[0]
    wanted = weights.shape[1]
    for block in numba.prange((total + BLOCK - 1) // BLOCK):
        first = block * BLOCK
        size = min(BLOCK, total - first)
        x = np.empty(BLOCK, np.float32)
        y = np.empty(BLOCK, np.float32)
        z = np.empty(BLOCK, np.float32)
        r = np.zeros((FEW, BLOCK), np.float32)
        sums = np.empty((wanted, BLOCK), np.float32)
        for i in range(size):
            x[i] = points[first + i, 0]
            y[i] = points[first + i, 1]
            z[i] = points[first + i, 2]
        for q in range(wanted):
            a = affine[0, q]
            ax = affine[1, q]
            ay = affine[2, q]
            az = affine[3, q]
            for i in range(size):
                sums[q, i] = a + ax * x[i] + ay * y[i] + az * z[i]
        start = 0
        while start < count:
            few = min(FEW, count - start)
            for j in range(few):
                ux = source[start + j, 0]
                uy = source[start + j, 1]
                uz = source[start + j, 2]
                for i in range(size):
                    dx = x[i] - ux
                    dy = y[i] - uy
                    dz = z[i] - uz
                    r[j, i] = np.sqrt(dx * dx + dy * dy + dz * dz)
            if few == FEW:
                for q in range(wanted):
                    w0 = weights[start, q]
                    w1 = weights[start + 1, q]
                    w2 = weights[start + 2, q]
                    w3 = weights[start + 3, q]
                    w4 = weights[start + 4, q]
                    w5 = weights[start + 5, q]
                    w6 = weights[start + 6, q]
                    w7 = weights[start + 7, q]
                    for i in range(size):
                        sums[q, i] += (
                            w0 * r[0, i] + w1 * r[1, i] + w2 * r[2, i] + w3 * r[3, i]
                        ) + (w4 * r[4, i] + w5 * r[5, i] + w6 * r[6, i] + w7 * r[7, i])
            else:
                for q in range(wanted):
                    for j in range(few):
                        w = weights[start + j, q]
                        for i in range(size):
                            sums[q, i] += w * r[j, i]
            start += FEW
        for q in range(wanted):
            largest = np.float32(1e-30)
            for i in range(size):
                largest = max(largest, abs(sums[q, i]))
            scales[block, q] = largest / np.float32(LARGEST_FIELD)
            shrink = np.float32(LARGEST_FIELD) / largest
            for i in range(size):
                fields[q, first + i] = np.int16(np.rint(sums[q, i] * shrink))


@_compile
def combine_fields(fields, scales, shares, affine, points, out):
    """Write ``affine . (1, v) + sum_k shares[k] * field_k`` into out (m, 3) float32.

    Fields come in threes: x, y and z of each combination follow one another.
    """
    total = points.shape[0]
    count = shares.shape[0]
    for block in numba.prange((total + BLOCK - 1) // BLOCK):
        first = block * BLOCK
        size = min(BLOCK, total - first)
        x = np.empty(BLOCK, np.float32)
        y = np.empty(BLOCK, np.float32)
        z = np.empty(BLOCK, np.float32)
        f = np.empty(BLOCK, np.float32)
        for i in range(size):
            x[i] = points[first + i, 0]
            y[i] = points[first + i, 1]
            z[i] = points[first + i, 2]
        for c in range(3):
            a = affine[0, c]
            ax = affine[1, c]
            ay = affine[2, c]
            az = affine[3, c]
            for i in range(size):
                f[i] = a + ax * x[i] + ay * y[i] + az * z[i]
            # Two fields at a time: the sum is then loaded and stored half as often.
            for k in range(0, count - 1, 2):
                s0 = shares[k] * scales[block, 3 * k + c]
                s1 = shares[k + 1] * scales[block, 3 * k + 3 + c]
                f0 = fields[3 * k + c, first : first + size]
                f1 = fields[3 * k + 3 + c, first : first + size]
                for i in range(size):
                    f[i] += s0 * np.float32(f0[i]) + s1 * np.float32(f1[i])
            if count % 2:
                s0 = shares[count - 1] * scales[block, 3 * count - 3 + c]
                f0 = fields[3 * count - 3 + c, first : first + size]
                for i in range(size):
                    f[i] += s0 * np.float32(f0[i])
            for i in range(size):
                out[first + i, c] = f[i]


@_compile
def evaluate_scalar(source, weights, affine, points, out):
    """Write one scalar spline, all float32: affine (4,), weights (n,), out (m,)."""
    count = source.shape[0]
    total = points.shape[0]
    for block in numba.prange((total + BLOCK - 1) // BLOCK):
        first = block * BLOCK
        size = min(BLOCK, total - first)
        x = np.empty(BLOCK, np.float32)
        y = np.empty(BLOCK, np.float32)
        z = np.empty(BLOCK, np.float32)
        f = np.empty(BLOCK, np.float32)
        for i in range(size):
            x[i] = points[first + i, 0]
            y[i] = points[first + i, 1]
            z[i] = points[first + i, 2]
        for i in range(size):
            f[i] = affine[0] + affine[1] * x[i] + affine[2] * y[i] + affine[3] * z[i]
        for k in range(count):
            ux = source[k, 0]
            uy = source[k, 1]
            uz = source[k, 2]
            w = weights[k]
            for i in range(size):
                dx = x[i] - ux
                dy = y[i] - uy
                dz = z[i] - uz
                f[i] += w * np.sqrt(dx * dx + dy * dy + dz * dz)
        for i in range(size):
            out[first + i] = f[i]


@_compile
def evaluate_jacobian(source, weights, affine, points, out, logarithmic):
    """Write ``d f_c / d v_j`` into out[:, c, j], all in the precision of the points.

    A landmark's own term is left out at that landmark, where the spline has a cone; the basis is
    as for ``evaluate``. Nine sums fit
    into registers, not into a block: here the inner loop runs over the landmarks.
    """
    count = source.shape[0]
    # A whole number would turn single precision into double.
    one = points.dtype.type(1)
    zero = points.dtype.type(0)
    # Keeps 0/0 away at a landmark and is lost to rounding anywhere else.
    tiny = np.finfo(points.dtype).tiny
    ux, uy, uz = source[:, 0].copy(), source[:, 1].copy(), source[:, 2].copy()
    wx, wy, wz = weights[:, 0].copy(), weights[:, 1].copy(), weights[:, 2].copy()
    for i in numba.prange(points.shape[0]):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        xx, xy, xz = zero, zero, zero
        yx, yy, yz = zero, zero, zero
        zx, zy, zz = zero, zero, zero
        for k in range(count):
            dx = x - ux[k]
            dy = y - uy[k]
            dz = z - uz[k]
            q = dx * dx + dy * dy + dz * dz + tiny
            q = one / np.sqrt(q) if logarithmic is None else np.log(q) + one
            dx *= q
            dy *= q
            dz *= q
            xx += wx[k] * dx
            xy += wx[k] * dy
            xz += wx[k] * dz
            yx += wy[k] * dx
            yy += wy[k] * dy
            yz += wy[k] * dz
            zx += wz[k] * dx
            zy += wz[k] * dy
            zz += wz[k] * dz
        out[i, 0, 0] = affine[1, 0] + xx
        out[i, 0, 1] = affine[2, 0] + xy
        out[i, 0, 2] = affine[3, 0] + xz
        out[i, 1, 0] = affine[1, 1] + yx
        out[i, 1, 1] = affine[2, 1] + yy
        out[i, 1, 2] = affine[3, 1] + yz
        out[i, 2, 0] = affine[1, 2] + zx
        out[i, 2, 1] = affine[2, 2] + zy
        out[i, 2, 2] = affine[3, 2] + zz


@_compile
def pulls(places, directions, out):
    """Write ``-|p_a - p_b| (d_a . d_b)`` into out[a, b]: (c, 3), (c, 3), (c, c)."""
    count = places.shape[0]
    x, y, z = places[:, 0].copy(), places[:, 1].copy(), places[:, 2].copy()
    dx, dy, dz = directions[:, 0].copy(), directions[:, 1].copy(), directions[:, 2].copy()
    for a in numba.prange(count):
        xa, ya, za = x[a], y[a], z[a]
        ux, uy, uz = dx[a], dy[a], dz[a]
        for b in range(count):
            r = np.sqrt((xa - x[b]) ** 2 + (ya - y[b]) ** 2 + (za - z[b]) ** 2)
            out[a, b] = -r * (ux * dx[b] + uy * dy[b] + uz * dz[b])


@_compile
def add_influence(start, influence, shift, out):
    """Write ``start + influence (x) shift`` into out: (m, 3), (m,), (3,), (m, 3)."""
    for i in numba.prange(start.shape[0]):
        h = influence[i]
        out[i, 0] = start[i, 0] + h * shift[0]
        out[i, 1] = start[i, 1] + h * shift[1]
        out[i, 2] = start[i, 2] + h * shift[2]
