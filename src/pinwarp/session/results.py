"""What follows from a session: the warp and its quality, cached by the inputs they depend on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import PinwarpError
from pinwarp.core.factor import SourceFactor, factorise
from pinwarp.core.landmarks import Position, Role, Side, positions
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import PenaltyConvention, Spline, solve
from pinwarp.session.session import Session

Matrix = NDArray[np.float64]


@dataclass(frozen=True)
class WarpInputs:
    """All that a warp depends on, and nothing that it does not (such as names)."""

    source: tuple[Position, ...]
    destination: tuple[Position, ...]
    penalty: float
    convention: PenaltyConvention
    planar: bool
    mesh: Mesh | None
    passengers: tuple[Position, ...]

    @classmethod
    def of(cls, session: Session) -> WarpInputs:
        """Collect the inputs from a session."""
        pairs = session.pairs
        return cls(
            source=tuple(pair.source for pair in pairs if pair.source is not None),
            destination=tuple(pair.destination for pair in pairs if pair.destination is not None),
            penalty=session.warping_penalty,
            convention=session.convention,
            planar=session.planar,
            mesh=session.mesh(Side.SOURCE),
            passengers=tuple(
                landmark.source
                for landmark in session.landmarks
                if landmark.role is Role.PASSENGER and landmark.source is not None
            ),
        )


@dataclass(frozen=True, eq=False)
class WarpResult:
    """A solved warp and what it does to the session it was solved for.

    Attributes
    ----------
    inputs
        What it was computed from.
    factor, spline
        None when there are no pairs or the solve failed.
    residuals : (n,) float64
        Distance of each warped source landmark from its destination, in mesh units.
    vertices : (m, 3) float32 or None
        The warped source mesh, for the screen.
    passengers : (k, 3) float64
        The warped passengers.
    problem
        Why there is no warp, in words for the user, where that is an error.
    """

    inputs: WarpInputs
    factor: SourceFactor | None = None
    spline: Spline | None = None
    residuals: Matrix | None = None
    vertices: NDArray[np.float32] | None = None
    passengers: Matrix | None = None
    problem: str | None = None

    @property
    def rms_residual(self) -> float | None:
        """Root mean square of the residuals, in mesh units."""
        if self.residuals is None:
            return None
        return float(np.sqrt(np.mean(self.residuals**2)))

    @property
    def flexibility(self) -> float | None:
        """Share of non-affine freedom left; None where the penalty has nothing to act on."""
        if self.factor is None or not len(self.factor.poles):
            return None
        if self.inputs.convention is PenaltyConvention.OPYNSIM and self.inputs.penalty > 0:
            return None
        return self.factor.flexibility(self.inputs.penalty)


class WarpSolver:
    """Solves sessions, keeping what the next one may share. For use by one thread at a time."""

    def __init__(self) -> None:
        self._last: WarpResult | None = None
        self.factorisations = 0
        self.solves = 0
        self.evaluations = 0

    def solve(self, inputs: WarpInputs) -> WarpResult:
        """Return the warp for these inputs, computing only what differs from the last ones."""
        last = self._last
        if last is not None and last.inputs == inputs:
            return last
        result = self._solve(inputs, last)
        self._last = result
        return result

    def _solve(self, inputs: WarpInputs, last: WarpResult | None) -> WarpResult:
        if not inputs.source:
            return WarpResult(inputs)
        try:
            factor, spline = self._spline(inputs, last)
        except PinwarpError as error:
            return WarpResult(inputs, problem=str(error))
        source = np.array(inputs.source)
        same_spline = last is not None and last.spline is spline
        if same_spline and last is not None and last.inputs.mesh is inputs.mesh:
            vertices = last.vertices
        else:
            vertices = self._evaluate(spline, inputs.mesh)
        passengers = np.array(inputs.passengers).reshape(-1, 3)
        return WarpResult(
            inputs=inputs,
            factor=factor,
            spline=spline,
            residuals=np.linalg.norm(
                spline.evaluate(source) - np.array(inputs.destination), axis=1
            ),
            vertices=vertices,
            passengers=spline.evaluate(passengers) if len(passengers) else passengers,
        )

    def _spline(self, inputs: WarpInputs, last: WarpResult | None) -> tuple[SourceFactor, Spline]:
        factor = last.factor if last is not None else None
        if (
            last is None
            or factor is None
            or (last.inputs.source, last.inputs.planar) != (inputs.source, inputs.planar)
        ):
            factor = factorise(inputs.source, planar=inputs.planar)
            self.factorisations += 1
        elif last.spline is not None and (
            last.inputs.destination,
            last.inputs.penalty,
            last.inputs.convention,
        ) == (inputs.destination, inputs.penalty, inputs.convention):
            return factor, last.spline
        self.solves += 1
        return factor, solve(factor, inputs.destination, inputs.penalty, inputs.convention)

    def _evaluate(self, spline: Spline, mesh: Mesh | None) -> NDArray[np.float32] | None:
        if mesh is None:
            return None
        self.evaluations += 1
        return spline.evaluate(mesh.vertices).astype(np.float32)


def warped_mesh(session: Session) -> Mesh:
    """Return the warped source mesh in double precision, for export.

    Raises
    ------
    PinwarpError
        When there is no source mesh, no pair, or the solve fails; the message says what to do.
    """
    mesh = session.mesh(Side.SOURCE)
    if mesh is None:
        raise PinwarpError("There is no source mesh to warp: open one first.")
    pairs = session.pairs
    if not pairs:
        raise PinwarpError("There is no pair yet: place a landmark on both meshes first.")
    factor = factorise(positions(pairs, Side.SOURCE), planar=session.planar)
    spline = solve(
        factor, positions(pairs, Side.DESTINATION), session.warping_penalty, session.convention
    )
    return mesh.with_vertices(spline.evaluate(mesh.vertices))
