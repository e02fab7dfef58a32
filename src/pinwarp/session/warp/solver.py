"""What follows from a session: the warp and its quality, cached by the inputs they depend on."""

from __future__ import annotations

import weakref
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.basis import Basis
from pinwarp.core.components import applied
from pinwarp.core.errors import PinwarpError, RangeError
from pinwarp.core.factor import SourceFactor, factorise
from pinwarp.core.landmarks import Position
from pinwarp.core.lengths import ROUNDING, rounding_among
from pinwarp.core.live import (
    Influence,
    PenaltySweep,
    PreviewPoints,
    can_follow,
    preview,
    suits_single,
)
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import PenaltyConvention, Spline, solve
from pinwarp.session.warp.refined import refined_spline
from pinwarp.session.warp.result import WarpInputs, WarpResult
from pinwarp.session.warp.sliding import Slider, SlidGroups

Matrix = NDArray[np.float64]

# Up to here the eigendecomposition is done along with the solve; above, once the hand rests.
EAGER_MODES = 300


FITTED = (
    "The warp is refined to the surface, and nothing slides meanwhile: it keeps to the curves that "
    "are drawn on both bones."
)


class WarpSolver:
    """Solves sessions, keeping what the next one may share. For use by one thread at a time.

    Attributes
    ----------
    slider
        Brings semilandmarks to rest.
    factorisations, solves, evaluations
        How often each was really done, for tests and for the curious.
    """

    def __init__(self) -> None:
        self._last: WarpResult | None = None
        self._moving: WarpResult | None = None
        self._points: weakref.WeakKeyDictionary[Mesh, PreviewPoints] = weakref.WeakKeyDictionary()
        self.slider = Slider()
        self._sweep: tuple[object, PenaltySweep] | None = None
        self._influence: tuple[object, Influence] | None = None
        self.factorisations = 0
        self.solves = 0
        self.evaluations = 0

    def solve(self, inputs: WarpInputs) -> WarpResult:
        """Return the warp for these inputs, computing only what differs from the last ones."""
        last = self._last
        if last is not None and last.inputs == inputs:
            return last
        # A new state of rest: the shortcuts from the old one are of no more use.
        self._influence = None
        if self._sweep is not None:
            # Else it stays until another one takes its place, long after its bones are closed.
            meshes = (inputs.mesh, inputs.stand_in)
            if self._sweep[0] not in [_swept_by(inputs, mesh) for mesh in meshes]:
                self._sweep = None
        result = self.solve_landmarks(inputs)
        if result.factor is not None and result.shown is not None:
            if len(inputs.source) <= EAGER_MODES:
                _ = result.factor.modes
            kept = last if last is not None and last.shown is result.shown else WarpResult(inputs)
            try:
                result = replace(
                    result,
                    vertices=self._unless_kept(
                        result.shown, inputs.mesh, kept.inputs.mesh, kept.vertices
                    ),
                    stand_in=self._unless_kept(
                        result.shown, inputs.stand_in, kept.inputs.stand_in, kept.stand_in
                    ),
                )
            except RangeError as error:
                result = WarpResult(inputs, problem=str(error))
        self._last = self._moving = result
        return result

    def preview(self, inputs: WarpInputs) -> WarpResult:
        """Return the warp while something moves, by the fastest way that is good enough.

        Compared with the last state of rest, a changed penalty is swept, one changed destination
        is followed, anything else is evaluated directly. Only the stand-in is warped, if there is.
        """
        result = self.solve_landmarks(inputs, moving=True)
        self._moving = result
        mesh = inputs.stand_in or inputs.mesh
        if result.factor is None or result.shown is None or mesh is None:
            return result
        try:
            vertices = self._shortcut(result, result.shown, mesh)
            if vertices is None:
                vertices = self._evaluate(result.shown, mesh)
        except RangeError as error:
            self._moving = WarpResult(inputs, problem=str(error))
            return self._moving
        if inputs.stand_in is not None:
            return replace(result, stand_in=vertices)
        return replace(result, vertices=vertices)

    def refine(self, result: WarpResult) -> WarpResult:
        """Compute what the penalty's scale needs, where that was put off."""
        if result.factor is not None:
            _ = result.factor.modes
        return result

    def solve_landmarks(self, inputs: WarpInputs, *, moving: bool = False) -> WarpResult:
        """Solve, without warping any mesh; while something moves, semilandmarks are held."""
        if not inputs.source:
            return WarpResult(inputs, not_sliding=self._slid(inputs, moving)[1])
        try:
            result = self._solved(inputs, moving)
            assert result.spline is not None, "what is solved has a spline"
            shown = self._applied(result)
            landmarks = shown.evaluate(np.array(inputs.source))
            passengers = shown.evaluate(np.array(inputs.passengers).reshape(-1, 3))
        except PinwarpError as error:
            return WarpResult(inputs, problem=str(error))
        destination = np.array(inputs.destination)
        residuals = np.linalg.norm(landmarks - destination, axis=1)
        # What is only rounding must not sort rows or draw bars.
        residuals[residuals < rounding_among(destination)] = 0.0
        return replace(
            result, shown=shown, landmarks=landmarks, residuals=residuals, passengers=passengers
        )

    def _applied(self, result: WarpResult) -> Spline:
        for known in (self._moving, self._last):
            if (
                known is not None
                and known.shown is not None
                and known.spline is result.spline
                and known.inputs.settings == result.inputs.settings
            ):
                return known.shown
        settings = result.inputs.settings
        assert result.spline is not None, "what is solved has a spline"
        assert result.fit is not None, "and was solved from something"
        return applied(result.spline, *result.fit, settings.components, settings.blend)

    def _solved(self, inputs: WarpInputs, moving: bool) -> WarpResult:
        """Return factor and spline, of what is known already as far as it is the same."""
        factor = None
        for known in (self._moving, self._last):
            if known is None or known.factor is None:
                continue
            if _factorises_the_same(known.inputs, inputs):
                factor = known.factor
                # What was only held while something moved has still to come to rest.
                held = known is not self._last and inputs.sliding is not None
                same = known.spline is not None and _solves_the_same(known.inputs, inputs)
                if same and (moving or not held):
                    return WarpResult(
                        inputs,
                        factor,
                        known.spline,
                        known.semilandmarks,
                        known.not_sliding,
                        known.fit,
                    )
        settings = inputs.settings
        if factor is None:
            factor = factorise(inputs.source, planar=settings.planar, basis=settings.basis)
            self.factorisations += 1
        at_rest, not_sliding = self._slid(inputs, moving)
        fit = (factor, np.array(inputs.destination))
        if at_rest is not None:
            fit = (at_rest.factor, at_rest.targets)
            assert inputs.sliding is not None, "what slid was asked to"
            if moving and not self._rests(inputs):
                fit = at_rest.following(np.array(inputs.source), np.array(inputs.destination))
        self.solves += 1
        if inputs.refinement is not None:
            spline = refined_spline(inputs.refinement)
        else:
            spline = solve(*fit, settings.penalty, settings.convention)
        return WarpResult(inputs, factor, spline, at_rest, not_sliding, fit)

    def _slid(self, inputs: WarpInputs, moving: bool) -> tuple[SlidGroups | None, str | None]:
        """Return the semilandmarks at rest, or why there are none."""
        if inputs.sliding is None:
            # What slid before may be of bones that nobody works on any more.
            self.slider.forget()
            return None, None
        if inputs.refinement is not None:
            return None, FITTED
        if inputs.settings.basis is not Basis.R:
            return None, (
                "Semilandmarks slide with the basis r only: choose it, or remove curves and "
                "patches."
            )
        for known in (self._last, self._moving) if moving else ():
            # Under a refinement nothing had come to rest.
            if known is None or known.inputs.sliding is None or known.inputs.refinement is not None:
                continue
            was, now = known.inputs.sliding, inputs.sliding
            # As long as the same points slide on the same bones they are only held meanwhile.
            if (was.names, was.mesh, was.target) == (now.names, now.mesh, now.target):
                return known.semilandmarks, known.not_sliding
        if not inputs.settings.is_regular:
            return None, (
                "Semilandmarks slide in the regularising convention only: choose it, or remove "
                "curves and patches."
            )
        try:
            return self.slider.slide(inputs.sliding), None
        except PinwarpError as error:
            return None, str(error)

    def _rests(self, inputs: WarpInputs) -> bool:
        """Whether landmarks and groups are what they were at rest."""
        return self._last is not None and self._last.inputs.sliding == inputs.sliding

    def _unless_kept(
        self,
        spline: Spline,
        mesh: Mesh | None,
        kept_mesh: Mesh | None,
        kept: NDArray[np.float32] | None,
    ) -> NDArray[np.float32] | None:
        """Return the warped mesh: what is kept of the same spline, else evaluated."""
        if kept is not None and mesh is kept_mesh:
            return kept
        return self._evaluate(spline, mesh)

    def _evaluate(self, spline: Spline, mesh: Mesh | None) -> NDArray[np.float32] | None:
        if mesh is None:
            return None
        self.evaluations += 1
        return preview(spline, self._preview_points(mesh))

    def _preview_points(self, mesh: Mesh) -> PreviewPoints:
        if mesh not in self._points:
            self._points[mesh] = PreviewPoints.of(mesh.vertices)
        return self._points[mesh]

    def _shortcut(
        self, result: WarpResult, shown: Spline, mesh: Mesh
    ) -> NDArray[np.float32] | None:
        inputs = result.inputs
        last = self._last
        if last is None or last.spline is None:
            return None
        was = last.inputs
        now = inputs.settings
        # What is refined is neither the landmarks' sweep nor their influence.
        if inputs.refinement is not None or not now.is_whole or was.source != inputs.source:
            return None
        # Nothing but the penalty may differ: whatever else is set, now or in times to come.
        if replace(was.settings, penalty=now.penalty) != now:
            return None
        points = self._preview_points(mesh)
        if not (suits_single(last.spline, points) and suits_single(shown, points)):
            return None
        if was.destination == inputs.destination:
            if now.convention is PenaltyConvention.REGULARISING:
                return self._swept(result, mesh)
            return None
        # Semilandmarks follow a landmark that moves, so that each frame is a solve.
        factor = result.factor
        if factor is None or inputs.sliding is not None:
            return None
        moved = [
            row
            for row, (a, b) in enumerate(zip(was.destination, inputs.destination, strict=True))
            if a != b
        ]
        # A refined warp follows no landmark: it is out of date once one moves.
        if was.refinement is not None or len(moved) != 1 or was.settings != now:
            return None
        if not can_follow(factor):
            return None
        return self._followed(inputs, last.spline, factor, mesh, moved[0])

    def _swept(self, result: WarpResult, mesh: Mesh) -> NDArray[np.float32]:
        inputs = result.inputs
        key = _swept_by(inputs, mesh)
        if self._sweep is None or self._sweep[0] != key:
            # Free the old basis before the new one is made: each may be 100 MB.
            self._sweep = self._influence = None
            points = self._preview_points(mesh)
            assert result.fit is not None, "what is swept was solved"
            self._sweep = (key, PenaltySweep(*result.fit, points))
        return self._sweep[1].at(inputs.settings.penalty)

    def _followed(
        self, inputs: WarpInputs, spline: Spline, factor: SourceFactor, mesh: Mesh, row: int
    ) -> NDArray[np.float32]:
        key = (row, mesh)
        if self._influence is None or self._influence[0] != key:
            assert self._last is not None, "only a warp at rest is followed"
            self._sweep = self._influence = None
            begin = self._last.inputs.destination[row]
            points = self._preview_points(mesh)
            self._influence = (key, Influence(factor, spline, row, begin, points))
        return self._influence[1].at(inputs.destination[row])


def is_rounding(length: float, place: Position) -> bool:
    """Whether a length is no more than the last digits of a position.

    Examples
    --------
    >>> is_rounding(1e-12, (0.0, 40.0, 3.0)), is_rounding(1e-3, (0.0, 40.0, 3.0))
    (True, False)
    """
    # Without numpy, which takes ten times as long for three numbers: a table asks for every cell.
    return length < max(ROUNDING * max(map(abs, place)), 1e-300)


def _swept_by(inputs: WarpInputs, mesh: Mesh | None) -> tuple[object, ...]:
    """Return what a sweep of the penalty depends on."""
    settings = replace(inputs.settings, penalty=0.0)
    return (settings, inputs.source, inputs.destination, inputs.sliding, mesh)


def _factorises_the_same(a: WarpInputs, b: WarpInputs) -> bool:
    one, other = a.settings, b.settings
    return (a.source, one.planar, one.basis) == (b.source, other.planar, other.basis)


def _solves_the_same(a: WarpInputs, b: WarpInputs) -> bool:
    """Whether two warps are one, of which more or less is applied."""
    wholes = [(x.destination, x.settings.whole, x.refinement, x.sliding) for x in (a, b)]
    return wholes[0] == wholes[1]
