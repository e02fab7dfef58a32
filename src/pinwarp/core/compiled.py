"""The evaluation loops, compiled by numba. Import only through :mod:`pinwarp.core.kernel`.

Points are taken in blocks that stay in the first-level cache while every landmark is added to
them; a block's coordinates are kept apart (x, y, z) so that the inner loop becomes vector code.
"""

from __future__ import annotations

import numba
import numpy as np

BLOCK = 512
# Single-precision sums are added into double-precision totals after this many landmarks.
RUN = 32


@numba.njit(parallel=True, fastmath=True, cache=True, error_model="numpy")
def evaluate_double(source, weights, affine, points, out):
    """Write ``f(points)`` into out; everything (.., 3) float64, affine (4, 3)."""
    count = source.shape[0]
    total = points.shape[0]
    for block in numba.prange((total + BLOCK - 1) // BLOCK):
        first = block * BLOCK
        size = min(BLOCK, total - first)
        x = np.empty(BLOCK)
        y = np.empty(BLOCK)
        z = np.empty(BLOCK)
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
        for k in range(count):
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
                r = np.sqrt(dx * dx + dy * dy + dz * dz)
                fx[i] += wx * r
                fy[i] += wy * r
                fz[i] += wz * r
        for i in range(size):
            out[first + i, 0] = fx[i]
            out[first + i, 1] = fy[i]
            out[first + i, 2] = fz[i]


@numba.njit(parallel=True, fastmath=True, cache=True, error_model="numpy")
def evaluate_single(source, weights, affine, points, out):
    """Do the same with float32 distances and float64 totals; only affine is float64."""
    count = source.shape[0]
    total = points.shape[0]
    for block in numba.prange((total + BLOCK - 1) // BLOCK):
        first = block * BLOCK
        size = min(BLOCK, total - first)
        x = np.empty(BLOCK, np.float32)
        y = np.empty(BLOCK, np.float32)
        z = np.empty(BLOCK, np.float32)
        sx = np.empty(BLOCK, np.float32)
        sy = np.empty(BLOCK, np.float32)
        sz = np.empty(BLOCK, np.float32)
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
                sx[i] = 0.0
                sy[i] = 0.0
                sz[i] = 0.0
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
                    r = np.sqrt(dx * dx + dy * dy + dz * dz)
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
