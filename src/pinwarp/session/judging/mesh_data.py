"""What is worth knowing at every vertex of a warped mesh, to be written along with it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.components import Components
from pinwarp.core.errors import RangeError
from pinwarp.core.jacobian import determinants, jacobians, stretches
from pinwarp.core.live import LARGEST_SINGLE
from pinwarp.core.normals import vertex_normals
from pinwarp.core.prediction import Prediction, prediction_of
from pinwarp.io.mesh_formats.vertex_data import VertexData
from pinwarp.session.session import Session
from pinwarp.session.warp.ghost import FEWEST_PAIRS
from pinwarp.session.warp.solved import SolvedWarp, in_parts, solved

Matrix = NDArray[np.float64]


def _silent(_share: float, _stage: str) -> None:
    return


def warped_mesh_data(
    session: Session | SolvedWarp,
    *,
    scalars: bool = True,
    progress: Callable[[float, str], None] = _silent,
) -> VertexData:
    """Return the normals of a warped mesh, and what the warp does at each of its vertices.

    Parameters
    ----------
    session
        With its source mesh; or its warp, solved.
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
        enough pairs and without semilandmarks, which were fitted, not observed.

    Raises
    ------
    PinwarpError
        When there is no source mesh, no pair, or the solve fails.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> session = read_session(sample_session())
    >>> list(warped_mesh_data(session).scalars)
    ['distance_mm', 'det_j', 'largest_stretch', 'smallest_stretch', 'deviation_mm']
    """
    warp = solved(session)
    progress(0.0, "finding normals")
    normals = vertex_normals(warp.mesh)
    if not scalars:
        return VertexData(normals)
    places, unit = warp.source.vertices, _in_a_name(warp.session.unit)
    found: dict[str, Matrix] = {}
    progress(0.1, "measuring distances")
    distances = warp.distances(lambda share: progress(0.1 + 0.4 * share, "measuring distances"))
    if distances is not None:
        found[f"distance{unit}"] = distances

    def derivatives(places: Matrix) -> Matrix:
        jacobian = jacobians(warp.applied, places)
        return np.column_stack([determinants(jacobian), *stretches(jacobian)])

    columns = in_parts(
        derivatives, places, lambda share: progress(0.5 + 0.2 * share, "measuring stretch")
    )
    names = ("det_j", "largest_stretch", "smallest_stretch")
    found |= dict(zip(names, columns.T, strict=True))
    prediction = _prediction(warp)
    if prediction is not None:
        found[f"deviation{unit}"] = in_parts(
            lambda places: prediction.standard_deviation(places)[:, None],
            places,
            lambda share: progress(0.7 + 0.3 * share, "estimating deviations"),
        )[:, 0]
    for name, values in found.items():
        if not float(np.abs(values).max()) <= LARGEST_SINGLE:
            raise RangeError(f"The figures {name} leave the range of numbers that files hold.")
    return VertexData(normals, found)


def _prediction(warp: SolvedWarp) -> Prediction | None:
    """Return what predicts the warp as applied, None where nothing does."""
    settings = warp.session.settings
    if settings.blend != 1 or not settings.is_regular or warp.result.semilandmarks is not None:
        return None
    if len(warp.destination) < FEWEST_PAIRS:
        return None
    match settings.components:
        case Components.FULL | Components.WITHOUT_POSE:
            penalty = settings.penalty
        case Components.AFFINE:
            penalty = math.inf
        case _:
            return None
    return prediction_of(warp.factor, warp.destination, penalty, warp.source.diagonal)


def _in_a_name(unit: str) -> str:
    """Return the end of a name that says the unit, in letters that every format takes."""
    plain = re.sub(r"[^A-Za-z0-9]+", "_", unit.replace("µ", "u").replace("μ", "u")).strip("_")
    return f"_{plain}" if plain else ""
