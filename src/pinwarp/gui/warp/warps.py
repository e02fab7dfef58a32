"""The warp of the session as it is, found by a worker while one edits."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum, auto

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.drawn.surface import shading_normals, triangles
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.scene.drawables import Drawable, Motion, Overlay, OverlayWarp
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.scenes import Scenes
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.quality import Quality, quality_of
from pinwarp.session.session import Session
from pinwarp.session.signals import isolated
from pinwarp.session.warp.rested import with_rest
from pinwarp.session.warp.result import WarpInputs, WarpResult
from pinwarp.session.warp.solver import EAGER_MODES, WarpSolver

# A table of figures that run is not read: while something moves it is renewed this often (s).
TABLE_PAUSE = 0.25
_FAILED = "The warp could not be computed: Help > Copy Details says what went wrong."


# In full, and as a stand-in.
_Warps = tuple[OverlayWarp | None, OverlayWarp | None]


class _Kind(Enum):
    """What is asked of the worker."""

    REST = auto()
    PREVIEW = auto()
    REFINE = auto()


@dataclass(frozen=True, eq=False)
class _Request:
    inputs: WarpInputs
    kind: _Kind
    result: WarpResult | None = None


@dataclass(frozen=True, eq=False)
class _Shaded:
    """A result made ready for the screen in the worker: in full, and as a stand-in."""

    result: WarpResult
    kind: _Kind
    warps: _Warps = (None, None)
    quality: Quality | None = None


class Warps(Capability):
    """Keeps the warp of the editor's session up to date, and draws it.

    ``result_changed`` emits each new warp, whether it is at rest (no drag is under way), and the
    quality of its pairs where that took no time; else it is for others to find out.
    ``figures_changed`` emits those whose figures are to be read: while something moves, few.

    Parameters
    ----------
    editor
        The truth.
    scenes
        Where the overlay is shown.
    surfaces
        Where meshes become surfaces.
    is_slow
        Says whether what moves is to be drawn as a stand-in.
    """

    result_changed = isolated(WarpResult, bool, object)
    figures_changed = isolated(WarpResult)

    def __init__(
        self,
        editor: Editor,
        scenes: Scenes,
        surfaces: Surfaces,
        is_slow: Callable[[], bool],
    ) -> None:
        self._editor = editor
        self._scenes = scenes
        self._surfaces = surfaces
        self._is_slow = is_slow
        self.solver = WarpSolver()
        self._worker = LatestWins(self._warp)
        self._worker.computed.connect(self._on_warp)
        self._worker.failed.connect(self._on_failure)
        self._asked: tuple[WarpInputs, bool] | None = None
        self.result: WarpResult | None = None
        self._figures_read_at = self._judged_at = 0.0
        self._shaded: _Warps = (None, None)
        self._overlay: _Warps = (None, None)
        self._is_moving = False
        # What stands in for the session's own refinement: a value, or none at all.
        self._instead: tuple[RefinementRecord | None] | None = None
        editor.session_changed.connect(self._ask)
        self._ask()

    def shut_down(self) -> None:
        """Stop the worker and let go of the editor."""
        self._worker.shut_down()
        self._editor.session_changed.disconnect(self._ask)

    def show_instead(self, refined: RefinementRecord | None) -> None:
        """Show another refinement than the session's own, or None, as far as it belongs to it."""
        self._instead = (refined,)
        self._ask()

    def show_own(self) -> None:
        """Show the session as it is again."""
        self._instead = None
        self._ask()

    @property
    def is_settled(self) -> bool:
        """Whether the warp is that of the session as it is."""
        if not self._worker.is_idle or self._asked is None:
            return False
        asked, previewed = self._asked
        current = WarpInputs.of(self._shown_session(), asked.stand_in)
        return asked == current and previewed == self._editor.is_previewing

    def rested(self, session: Session) -> Session:
        """Return a session that knows where its semilandmarks rest, as far as that is known.

        What has not come to rest yet does so when it is asked for again.
        """
        if not session.groups:
            return session
        result = self.result
        known = result is not None and result.inputs == WarpInputs.of(
            session, result.inputs.stand_in
        )
        return with_rest(session, result.semilandmarks if result is not None and known else None)

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return the warped source over the destination."""
        if side is not Side.DESTINATION:
            return
        view, (full, stand_in) = self._editor.view, self._overlay
        if full is not None or stand_in is not None:
            yield Overlay(full, stand_in, view.overlay, view.opacity, view.map_opacity)
        if self._is_moving:
            yield Motion()

    def _ask(self, _session: Session | None = None) -> None:
        """Ask the worker for the warp of the session as it is, if it is another."""
        inputs, previewing = self._inputs(), self._editor.is_previewing
        if previewing and not self._is_moving:
            self._is_moving = True
            self._scenes.renew()
        if (inputs, previewing) == self._asked:
            return
        self._asked = (inputs, previewing)
        kind = _Kind.PREVIEW if previewing else _Kind.REST
        self._worker.request(_Request(inputs, kind))

    def _inputs(self) -> WarpInputs:
        """Return what the warp depends on, with a stand-in where drawing in full is slow."""
        session = self._shown_session()
        mesh = session.mesh(Side.SOURCE)
        stand_in = (
            self._surfaces.of(mesh).stand_in if mesh is not None and self._is_slow() else None
        )
        return WarpInputs.of(session, stand_in)

    def _shown_session(self) -> Session:
        session = self._editor.session
        if self._instead is None:
            return session
        return edits.set_refinement(session, *self._instead)

    def _warp(self, request: _Request) -> _Shaded:
        """Solve and shade; runs in the worker."""
        if request.kind is _Kind.REFINE and request.result is not None:
            return _Shaded(self.solver.refine(request.result), request.kind)
        inputs = request.inputs
        solve = self.solver.preview if request.kind is _Kind.PREVIEW else self.solver.solve
        result = solve(inputs)
        before, before_coarse = self._shaded
        warps = (
            self._shade(result, inputs.mesh, result.vertices, before),
            self._shade(result, inputs.stand_in, result.stand_in, before_coarse),
        )
        # The mesh in full is as it was while only its stand-in moves.
        self._shaded = (
            warps[0] or _if_of(before, inputs.mesh),
            warps[1] or _if_of(before_coarse, inputs.stand_in),
        )
        return _Shaded(result, request.kind, warps, self._judge(result, request.kind))

    def _judge(self, result: WarpResult, kind: _Kind) -> Quality | None:
        """Judge the pairs along with the warp, so that all figures appear in one go.

        Which of them is wrong takes longer to say, and waits until the hand rests.
        """
        factor, now = result.factor, time.monotonic()
        if factor is None or not factor.has_modes or len(result.inputs.source) > EAGER_MODES:
            return None
        if kind is _Kind.PREVIEW and now - self._judged_at < TABLE_PAUSE:
            return None
        self._judged_at = now
        return quality_of(result, judge=kind is not _Kind.PREVIEW)

    def _shade(
        self,
        result: WarpResult,
        mesh: Mesh | None,
        vertices: NDArray[np.float32] | None,
        before: OverlayWarp | None,
    ) -> OverlayWarp | None:
        if mesh is None or vertices is None:
            return None
        if before is not None and before.mesh is mesh and before.vertices is vertices:
            return before
        normals = shading_normals(triangles(vertices, mesh.faces))
        # The warped surface shows its inside when it did so before, or when the warp mirrors it.
        whole = result.inputs.mesh
        affine = result.shown.affine[1:] if result.shown is not None else np.eye(3)
        mirrored = bool(np.linalg.det(affine) < 0)
        inside_out = (whole is not None and self._surfaces.of(whole).inside_out) != mirrored
        return OverlayWarp(mesh, vertices, normals, inside_out)

    def _on_warp(self, shaded: _Shaded) -> None:
        result, before = shaded.result, self.result
        if shaded.kind is _Kind.REFINE and (before is None or result.inputs != before.inputs):
            return
        self.result = result
        if shaded.kind is not _Kind.REFINE:
            same_mesh = before is not None and before.inputs.mesh is result.inputs.mesh
            self._overlay = _over(shaded.warps, self._overlay if same_mesh else (None, None))
        at_rest = shaded.kind is not _Kind.PREVIEW
        if at_rest and not self._editor.is_previewing:
            # Only now: the stand-in stays until the full mesh has caught up.
            self._is_moving = False
        self._scenes.renew()
        now = time.monotonic()
        due = shaded.quality is not None or now - self._figures_read_at > 2 * TABLE_PAUSE
        if due or at_rest:
            self._figures_read_at = now
            self.figures_changed.emit(result)
        self.result_changed.emit(result, at_rest, shaded.quality)
        if shaded.kind is _Kind.REST and result.factor is not None and not result.factor.has_modes:
            self._worker.request_if_idle(_Request(result.inputs, _Kind.REFINE, result))

    def _on_failure(self, error: Exception) -> None:
        if self._asked is not None:
            # The old warp must not pass for that of the new pairs.
            inputs, previewing = self._asked
            kind = _Kind.PREVIEW if previewing else _Kind.REST
            self._on_warp(_Shaded(WarpResult(inputs, problem=_FAILED), kind))
        raise error


def _if_of(warp: OverlayWarp | None, mesh: Mesh | None) -> OverlayWarp | None:
    """Return a warp of a mesh; nothing of a mesh gone by."""
    return warp if warp is not None and warp.mesh is mesh else None


def _over(warps: _Warps, before: _Warps) -> _Warps:
    """Return what is drawn after a warp: of what it did not renew, the last one stays."""
    if warps == (None, None):
        return warps
    return warps[0] or before[0], warps[1] or before[1]
