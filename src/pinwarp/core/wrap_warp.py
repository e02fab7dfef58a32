"""Carrying what muscles wrap over: cylinders, ellipsoids and spheres stay what they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.local_affine import Warp, directions, local_affine
from pinwarp.core.model_parts import WrapShape
from pinwarp.core.placement import Placement

Matrix = NDArray[np.float64]

# So far along its axis, in radii, a long cylinder is looked at: beyond it the bone has ended.
_REACH = 3.0
_AROUND = 24


@dataclass(frozen=True, eq=False)
class WrapFit:
    """A wrap that was carried.

    Attributes
    ----------
    placement, size
        As of :class:`~pinwarp.core.model_parts.WrapPart`, in the frame of the warp.
    turn : (3, 3) float64
        How the bone turns there.
    misfit : float
        How far the warped surface is from the shape, as a share of its size: for cylinders and
        spheres the range of the distance from the axis or centre, for ellipsoids the root mean
        square of what no affine map explains.
    """

    placement: Placement
    size: Matrix
    turn: Matrix
    misfit: float


def warped_wrap(warp: Warp, shape: WrapShape, placement: Placement, size: Matrix) -> WrapFit:
    """Carry a wrap.

    A cylinder's axis goes where the affine map that fits best over its surface takes it, its
    radius becomes the mean distance of 72 warped places of its surface, its length grows as the
    axis does. The half axes of an ellipsoid grow as the map stretches their directions, which
    turn with the bone. A sphere's radius becomes the mean.

    Parameters
    ----------
    warp
        Takes (m, 3) places.
    shape, placement, size
        As of :class:`~pinwarp.core.model_parts.WrapPart`, in the frame of the warp.

    Examples
    --------
    >>> from pinwarp.core.placement import HERE
    >>> fit = warped_wrap(lambda x: x * [2, 2, 3], WrapShape.CYLINDER, HERE, np.array([1.0, 4.0]))
    >>> fit.size.round(6).tolist(), round(fit.misfit, 6)
    ([2.0, 12.0], 0.0)
    """
    R = placement.rotation
    fit = local_affine(warp, placement.origin, _surface(shape, size) @ R.T)
    carried = warp(placement.out(_surface(shape, size))) - fit.centre
    if shape is WrapShape.CYLINDER:
        stretched = fit.linear @ R[:, 2]
        length = float(np.linalg.norm(stretched))
        z = stretched / length
        x = fit.rotation @ R[:, 0]
        x = x - z * (x @ z)
        x /= np.linalg.norm(x)
        rotation = np.column_stack([x, np.cross(z, x), z])
        far = np.linalg.norm(carried - np.outer(carried @ z, z), axis=1)
        misfit = float(np.ptp(far) / far.mean())
        return WrapFit(
            Placement(rotation, fit.centre),
            np.array([far.mean(), size[1] * length]),
            fit.rotation,
            misfit,
        )
    turned = Placement(fit.rotation @ R, fit.centre)
    if shape is WrapShape.ELLIPSOID:
        grown = size * np.linalg.norm(fit.linear @ R, axis=0)
        return WrapFit(turned, grown, fit.rotation, fit.misfit / float(grown.mean()))
    far = np.linalg.norm(carried, axis=1)
    return WrapFit(turned, np.array([far.mean()]), fit.rotation, float(np.ptp(far) / far.mean()))


def is_in_wrap(shape: WrapShape, placement: Placement, size: Matrix, place: Matrix) -> bool:
    """Tell whether a place is inside of a wrap.

    Examples
    --------
    >>> from pinwarp.core.placement import HERE
    >>> is_in_wrap(WrapShape.SPHERE, HERE, np.array([1.0]), np.array([0.5, 0.5, 0.5]))
    True
    """
    x, y, z = placement.into(place[None])[0]
    if shape is WrapShape.CYLINDER:
        return bool(np.hypot(x, y) < size[0] and abs(z) < size[1] / 2)
    return bool(np.linalg.norm(np.array([x, y, z]) / size) < 1)


def _surface(shape: WrapShape, size: Matrix) -> Matrix:
    """Return places of the surface as seen from the wrap."""
    if shape is not WrapShape.CYLINDER:
        return directions() * size
    radius, length = size
    half = min(length / 2, _REACH * radius)
    angles = np.linspace(0, 2 * np.pi, _AROUND, endpoint=False)
    ring = np.column_stack([radius * np.cos(angles), radius * np.sin(angles), 0 * angles])
    return np.concatenate([ring + np.array([0.0, 0.0, z]) for z in (-half, 0.0, half)])
