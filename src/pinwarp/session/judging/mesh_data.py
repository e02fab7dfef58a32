"""What is worth knowing at every vertex of a warped mesh, to be written along with it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.components import Components, as_drawn
from pinwarp.core.jacobian import determinants, jacobians, stretches
from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.normals import vertex_normals
from pinwarp.core.prediction import Prediction, prediction_of
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.mesh_formats.vertex_data import VertexData
from pinwarp.session.outputs.exports import SolvedWarp, solved
from pinwarp.session.session import Session

Matrix = NDArray[np.float64]

# So many vertices between two looks at whether the user cancelled: a tenth of a second.
PART = 50_000


def _silent(_share: float, _stage: str) -> None:
    return


def warped_mesh_data(
    session: Session,
    warped: Mesh,
    *,
    scalars: bool = True,
    progress: Callable[[float, str], None] = _silent,
) -> VertexData:
    """Return the normals of a warped mesh, and what the warp does at each of its vertices.

    Parameters
    ----------
    session
        With its source mesh.
    warped
        Its :func:`~pinwarp.session.outputs.exports.warped_mesh`.
    scalars
        Whether to compute more than the normals.
    progress
        Told the share that is done and what is going on; may raise to cancel.

    Returns
    -------
    VertexData
        Scalars: ``distance_UNIT`` to the destination's surface, where there is one (without
        pose: with the pose put back); ``det_j``, how much volume grows, 0 or less in a fold;
        ``largest_stretch`` and ``smallest_stretch`` of any direction; and ``deviation_UNIT``,
        the standard deviation of a coordinate of the warp as a prediction, where it means what
        is applied: for the whole warp and the affine fit of the regularising convention, with
        enough pairs.

    Raises
    ------
    PinwarpError
        When there is no pair, or the solve fails.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.outputs.exports import warped_mesh
    >>> from pinwarp.session.keeping.files import read_session
    >>> session = read_session(sample_session())
    >>> list(warped_mesh_data(session, warped_mesh(session)).scalars)
    ['distance_mm', 'det_j', 'largest_stretch', 'smallest_stretch', 'deviation_mm']
    """
    progress(0.0, "finding normals")
    normals = vertex_normals(warped)
    source, destination = session.mesh(Side.SOURCE), session.mesh(Side.DESTINATION)
    if not scalars or source is None:
        return VertexData(normals)
    warp, unit = solved(session), _in_a_name(session.unit)
    found: dict[str, Matrix] = {}
    if destination is not None:
        progress(0.1, "measuring distances")
        index = SurfaceIndex(destination)
        drawn = warp.applied(as_drawn(session.settings.components), session.settings.blend)
        found[f"distance{unit}"] = _in_parts(
            lambda places: index.distances(drawn.evaluate(places))[:, None],
            source.vertices,
            lambda share: progress(0.1 + 0.4 * share, "measuring distances"),
        )[:, 0]
    applied = warp.applied(session.settings.components, session.settings.blend)

    def derivatives(places: Matrix) -> Matrix:
        jacobian = jacobians(applied, places)
        return np.column_stack([determinants(jacobian), *stretches(jacobian)])

    columns = _in_parts(
        derivatives, source.vertices, lambda share: progress(0.5 + 0.2 * share, "measuring stretch")
    )
    names = ("det_j", "largest_stretch", "smallest_stretch")
    found |= dict(zip(names, columns.T, strict=True))
    prediction = _prediction(session, warp)
    if prediction is not None:
        found[f"deviation{unit}"] = _in_parts(
            lambda places: prediction.standard_deviation(places)[:, None],
            source.vertices,
            lambda share: progress(0.7 + 0.3 * share, "estimating deviations"),
        )[:, 0]
    return VertexData(normals, found)


def _prediction(session: Session, warp: SolvedWarp) -> Prediction | None:
    """Return what predicts the warp as applied, None where nothing does."""
    settings = session.settings
    if settings.blend != 1 or not settings.is_regular:
        return None
    match settings.components:
        case Components.FULL | Components.WITHOUT_POSE:
            return prediction_of(warp.factor, warp.destination, settings.penalty)
        case Components.AFFINE:
            return prediction_of(warp.factor, warp.destination, math.inf)
        case _:
            return None


def _in_parts(
    function: Callable[[Matrix], Matrix], places: Matrix, progress: Callable[[float], None]
) -> Matrix:
    parts = []
    for first in range(0, len(places), PART):
        progress(first / len(places))
        parts.append(function(places[first : first + PART]))
    return np.concatenate(parts)


def _in_a_name(unit: str) -> str:
    """Return the end of a name that says the unit, in letters that every format takes."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", unit.replace("µ", "u").replace("μ", "u")).strip("_")
    return f"_{plain}" if plain else ""
