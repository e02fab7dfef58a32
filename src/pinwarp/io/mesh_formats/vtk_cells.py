"""The cells of VTK's unstructured grids, as meshio and Gmsh write surfaces: which are faces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.words import counted
from pinwarp.io.mesh_formats.surface import BrokenMeshError, cut_strips

# Numbers of vtkCellType.h.
_EMPTY, _STRIP, _PIXEL = 0, 6, 8
_POINTS = (1, 2)
_LINES = (3, 4, 21, 35, 68, 75)
_FACES = (5, 7, 9)
# Triangles and quads with further points on their sides, behind their corners.
_CURVED = {22: 3, 34: 3, 69: 3, 76: 3, 23: 4, 28: 4, 30: 4, 70: 4, 77: 4}


def faces_of_cells(
    kinds: NDArray[np.int64], corners: NDArray[np.int64], sizes: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], tuple[str, ...]]:
    """Return the faces of an unstructured grid.

    Parameters
    ----------
    kinds
        What each cell is, by VTK's numbers.
    corners
        The vertex numbers of all cells in a row.
    sizes
        How many belong to each cell.

    Returns
    -------
    corners, sizes
        Those of triangles, quads, polygons, pixels and strips, all strips last.
    notes
        What was left out, as sentences.

    Raises
    ------
    BrokenMeshError
        When the numbers do not match, or there are volumes and no face.

    Examples
    --------
    >>> corners, sizes, notes = faces_of_cells(
    ...     np.array([8, 10]), np.arange(8), np.array([4, 4])
    ... )
    >>> corners.tolist(), notes
    ([0, 1, 3, 2], ('1 volume cell dropped.',))
    """
    if len(kinds) != len(sizes) or sizes.sum() != len(corners):
        raise BrokenMeshError(
            "The cells of the file and their types are not as many: it is damaged. Export it again."
        )
    kept = sizes.copy()
    for kind, most in _CURVED.items():
        kept[kinds == kind] = np.minimum(sizes[kinds == kind], most)
    is_strip = kinds == _STRIP
    is_face = np.isin(kinds, (*_FACES, _PIXEL, *_CURVED))
    is_other = np.isin(kinds, (*_POINTS, *_LINES, _EMPTY))
    volumes = int((~(is_face | is_strip | is_other)).sum())
    if volumes and not (is_face.any() or is_strip.any()):
        raise BrokenMeshError(
            f"The file holds an unstructured grid of {counted(volumes, 'volume cell')} and no "
            "surface. Extract the surface (in ParaView: Extract Surface) and save it as PolyData."
        )
    place = np.arange(len(corners)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    chosen = np.repeat(is_face, sizes) & (place < np.repeat(kept, sizes))
    faces, face_sizes = corners[chosen], kept[is_face]
    # Pixels count row by row, polygons around.
    third = (np.cumsum(face_sizes) - face_sizes + 2)[(kinds[is_face] == _PIXEL) & (face_sizes == 4)]
    faces[third], faces[third + 1] = faces[third + 1], faces[third]
    strips = cut_strips(corners[np.repeat(is_strip, sizes)], sizes[is_strip])
    curved = int(np.isin(kinds, list(_CURVED)).sum())
    lines = int(np.isin(kinds, _LINES).sum())
    notes = {
        f"{counted(curved, 'curved face')} read by their corners.": curved,
        f"{counted(volumes, 'volume cell')} dropped.": volumes,
        f"{counted(lines, 'line')} dropped.": lines,
    }
    return (
        np.concatenate([faces, strips.ravel()]),
        np.concatenate([face_sizes, np.full(len(strips), 3, dtype=np.int64)]),
        tuple(note for note, count in notes.items() if count),
    )
