"""From the polygons of a file to the triangles of a mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.mesh import Mesh
from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.surface import BrokenMeshError, Surface, are_few


def mesh_of(surface: Surface) -> tuple[Mesh, tuple[str, ...]]:
    """Make a mesh of what a file holds.

    Parameters
    ----------
    surface
        Polygons over points.

    Returns
    -------
    mesh
        Its vertices are in the order of the file, less those that no triangle uses.
    notes
        What was changed or left out, as sentences.

    Raises
    ------
    BrokenMeshError
        When no triangle is left, a corner does not exist, or more than a few vertices are not
        finite.

    Examples
    --------
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [9, 9, 9]])
    >>> mesh, notes = mesh_of(Surface(points, np.arange(4), np.array([4])))
    >>> mesh.faces.shape, notes[1]
    ((2, 3), '1 loose point dropped.')
    """
    points, corners, sizes = surface.points, surface.corners, surface.sizes
    notes = list(surface.notes)
    if len(corners) and (corners.min() < 0 or corners.max() >= len(points)):
        wrong = int(np.flatnonzero((corners < 0) | (corners >= len(points)))[0])
        face = int(np.searchsorted(np.cumsum(sizes), wrong, side="right"))
        raise BrokenMeshError(
            f"Face {face + 1:,} names vertex {int(corners[wrong]) + 1:,}, but there are only "
            f"{len(points):,}: the file was cut off or is damaged. Export or copy it again."
        )
    if len(sizes) and sizes.min() < 3:
        notes.append(f"{counted(int((sizes < 3).sum()), 'face')} of fewer than 3 corners dropped.")
        corners, sizes = corners[np.repeat(sizes >= 3, sizes)], sizes[sizes >= 3]
    places: NDArray[np.bool_] = np.logical_and.reduce(np.isfinite(points), axis=1)
    if not places.all() and not places[corners].all():
        whole = _whole_faces(places, corners, sizes)
        dropped = counted(int((~whole).sum()), "face")
        broken = counted(int((~places).sum()), "vertex", "vertices")
        notes.append(f"{broken} without a finite position dropped, with {dropped} on them.")
        corners, sizes = corners[np.repeat(whole, sizes)], sizes[whole]
    if len(sizes) and sizes.max() > 3:
        many = counted(int((sizes > 3).sum()), "polygon")
        notes.append(f"{many} of more than 3 corners cut into triangles.")
        # VTK is loaded only for what needs it.
        from pinwarp.io.mesh_formats.polydata import cut_polygons

        triangles = cut_polygons(points, corners, sizes)
    else:
        triangles = corners.reshape(-1, 3)
    a, b, c = triangles.T
    proper = (a != b) & (b != c) & (c != a)
    if not proper.all():
        dropped = counted(int((~proper).sum()), "triangle")
        notes.append(f"{dropped} with two corners at one vertex dropped.")
        triangles = triangles[proper]
    if not len(triangles):
        raise BrokenMeshError("The file holds no triangles. Export the bone as a triangle surface.")
    used = np.zeros(len(points), dtype=bool)
    used[triangles] = True
    if not used.all():
        loose = int((~used & places).sum())
        if loose:
            notes.append(f"{counted(loose, 'loose point')} dropped.")
        triangles = (np.cumsum(used) - 1)[triangles]
    return Mesh(points[used], triangles), tuple(notes)


def _whole_faces(
    places: NDArray[np.bool_], corners: NDArray[np.int64], sizes: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Return which faces have a finite place at every corner; where few have not, or refuse."""
    used = np.zeros(len(places), dtype=bool)
    used[corners] = True
    broken = np.flatnonzero(used & ~places)
    if not are_few(len(broken), int(used.sum())):
        raise BrokenMeshError(
            f"Vertex {int(broken[0]) + 1:,} has a coordinate that is not a finite number"
            f"{f', as have {len(broken) - 1:,} more' if len(broken) > 1 else ''}. "
            "Repair the mesh in the program it came from."
        )
    ends = np.cumsum(places[corners])[np.cumsum(sizes) - 1]
    whole: NDArray[np.bool_] = np.diff(ends, prepend=0) == sizes
    return whole
