"""Wires the editor and the views: renders what changed, turns requests into edits."""

from __future__ import annotations

import time
import weakref
from dataclasses import dataclass, replace
from enum import Enum, auto
from typing import Any

import numpy as np
from numpy.typing import NDArray
from psygnal import Signal

from pinwarp.core.landmarks import Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui.drawn.mesh import OverlayWarp
from pinwarp.gui.drawn.surface import Surface, shading_normals, triangles
from pinwarp.gui.penalty.panel import PenaltyPanel
from pinwarp.gui.placing.hand import LandmarkRequests
from pinwarp.gui.scene.scene import scene_of
from pinwarp.gui.table.table import LandmarkModel, LandmarkTable
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.viewport import Viewport
from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.quality import Quality, quality_of
from pinwarp.session.session import Session
from pinwarp.session.warp.ghost import Ghost, ghost_of
from pinwarp.session.warp.solver import EAGER_MODES, WarpInputs, WarpResult, WarpSolver

# A table of figures that run is not read: while something moves it is renewed this often (s).
TABLE_PAUSE = 0.25


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
    warps: tuple[OverlayWarp | None, OverlayWarp | None] = (None, None)
    quality: Quality | None = None


class Presenter:
    """Everything between the editor and the widgets; both are passed in.

    ``result_changed`` emits each new warp, whether it is at rest (no drag is under way), and the
    quality of its pairs where that took no time; else it is for others to find out.

    Parameters
    ----------
    editor
        The truth.
    viewports
        One per side.
    model, table, panel
        The other views.
    """

    result_changed = Signal(WarpResult, bool, object)

    def __init__(
        self,
        editor: Editor,
        viewports: dict[Side, Viewport],
        model: LandmarkModel,
        table: LandmarkTable,
        panel: PenaltyPanel,
    ) -> None:
        self._editor = editor
        self._viewports = viewports
        self._model = model
        self._table = table
        self._panel = panel
        self._surfaces: weakref.WeakKeyDictionary[Mesh, Surface] = weakref.WeakKeyDictionary()
        self.solver = WarpSolver()
        self._warps = LatestWins(self._warp)
        self._asked: tuple[WarpInputs, bool] | None = None
        self.result: WarpResult | None = None
        self._quality: Quality | None = None
        self._table_shown_at = self._judged_at = 0.0
        self._shown: weakref.WeakKeyDictionary[Mesh, OverlayWarp] = weakref.WeakKeyDictionary()
        self.ghosts: dict[Side, Ghost | None] = dict.fromkeys(Side)
        self._known_ghosts: dict[Side, Ghost | None] = {}
        self._ghost_keys: dict[Side, object] = {}
        self.requests = LandmarkRequests(editor, viewports, self.ghosts.get)
        self._connect()
        self._on_session(editor.session)

    def _connect(self) -> None:
        editor, panel = self._editor, self._panel
        editor.session_changed.connect(self._on_session)
        editor.selection_changed.connect(self._on_looks)
        editor.view_changed.connect(self._on_looks)
        self._warps.computed.connect(self._on_warp)
        self._warps.failed.connect(self._on_failure)
        self._table.selection_requested.connect(
            lambda names, side: editor.select(*names, side=Side(side) if side else None)
        )
        panel.penalty_previewed.connect(
            lambda penalty: editor.preview(edits.set_penalty(editor.committed, penalty))
        )
        panel.penalty_requested.connect(self._on_penalty)
        panel.convention_requested.connect(self._on_convention)
        panel.planar_requested.connect(self._on_planar)
        panel.unit_requested.connect(
            lambda unit: editor.commit(edits.set_unit(editor.committed, unit), "Change unit")
        )

    def shut_down(self) -> None:
        """Stop the worker and let go of the editor."""
        self._warps.shut_down()
        self._editor.session_changed.disconnect(self._on_session)
        self._editor.selection_changed.disconnect(self._on_looks)
        self._editor.view_changed.disconnect(self._on_looks)

    @property
    def is_settled(self) -> bool:
        """Whether what is shown follows from the session as it is."""
        if not self._warps.is_idle or self._asked is None:
            return False
        asked, previewed = self._asked
        current = WarpInputs.of(self._editor.session, asked.stand_in)
        return asked == current and previewed == self._editor.is_previewing

    def keep_surface(self, mesh: Mesh, surface: Surface) -> None:
        """Remember a surface made in a loading job for when its mesh is shown."""
        self._surfaces[mesh] = surface

    def _surface(self, mesh: Mesh | None) -> Surface | None:
        if mesh is None:
            return None
        if mesh not in self._surfaces:
            self._surfaces[mesh] = Surface(mesh)
        return self._surfaces[mesh]

    # From the session to the screen

    def _on_session(self, session: Session) -> None:
        for side, viewport in self._viewports.items():
            viewport.show_surface(self._surface(session.mesh(side)))
            file = session.mesh_file(side)
            viewport.layer.caption = "" if file is None else _caption(file)
        self._model.show_session(session)
        self._panel.show_session(session)
        self._on_looks()
        self._ask()

    def _ask(self) -> None:
        """Ask the worker for the warp of the session as it is, if it is another."""
        editor, destination = self._editor, self._viewports[Side.DESTINATION]
        if editor.is_previewing:
            destination.set_warping(True)
        inputs, previewing = self._inputs(), editor.is_previewing
        if (inputs, previewing) == self._asked:
            return
        self._asked = (inputs, previewing)
        kind = _Kind.PREVIEW if previewing else _Kind.REST
        self._warps.request(_Request(inputs, kind))

    def _inputs(self) -> WarpInputs:
        """Return what the warp depends on, with a stand-in where drawing in full is slow."""
        session = self._editor.session
        surface = self._surface(session.mesh(Side.SOURCE))
        slow = self._viewports[Side.DESTINATION].is_slow
        stand_in = surface.stand_in if surface is not None and slow else None
        return WarpInputs.of(session, stand_in)

    def _on_looks(self, _changed: Any = None) -> None:
        editor = self._editor
        self._table.show_selection(editor.selection)
        for side, viewport in self._viewports.items():
            self.ghosts[side] = self._ghost(side)
            viewport.show_scene(
                scene_of(
                    side,
                    editor.session,
                    editor.selection,
                    editor.view,
                    self.result,
                    self.ghosts[side],
                    self._quality,
                )
            )

    def show_quality(self, quality: Quality | None) -> None:
        """Show where the other pairs expect the selected landmarks."""
        self._quality = quality
        self._on_looks()

    def _ghost(self, side: Side) -> Ghost | None:
        """Predict where the next landmark of a side should be, on that side's surface."""
        editor, result = self._editor, self.result
        surface = self._surface(editor.session.mesh(side))
        if surface is None or result is None or editor.is_previewing:
            return None
        name = self.requests.target(side)
        landmark = editor.session.landmark(name) if name else None
        key = (side, landmark, result)
        if self._ghost_keys.get(side) != key:
            self._ghost_keys[side] = key
            ghost = ghost_of(landmark, side, result)
            if ghost is not None:
                place, _ = surface.closest(ghost.position)
                ghost = replace(ghost, position=as_position(place))
            self._known_ghosts[side] = ghost
        return self._known_ghosts[side]

    def _warp(self, request: _Request) -> _Shaded:
        """Solve and shade; runs in the worker."""
        if request.kind is _Kind.REFINE and request.result is not None:
            return _Shaded(self.solver.refine(request.result), request.kind)
        inputs = request.inputs
        solve = self.solver.preview if request.kind is _Kind.PREVIEW else self.solver.solve
        result = solve(inputs)
        return _Shaded(
            result,
            request.kind,
            (
                self._shade(result, inputs.mesh, result.vertices),
                self._shade(result, inputs.stand_in, result.stand_in),
            ),
            self._judge(result, request.kind),
        )

    def _judge(self, result: WarpResult, kind: _Kind) -> Quality | None:
        """Judge the pairs along with the warp, so that all figures appear in one go."""
        factor, now = result.factor, time.monotonic()
        if factor is None or not factor.has_modes or len(result.inputs.source) > EAGER_MODES:
            return None
        if kind is _Kind.PREVIEW and now - self._judged_at < TABLE_PAUSE:
            return None
        self._judged_at = now
        return quality_of(result)

    def _shade(
        self,
        result: WarpResult,
        mesh: Mesh | None,
        vertices: NDArray[np.float32] | None,
    ) -> OverlayWarp | None:
        if mesh is None or vertices is None:
            return None
        shown = self._shown.get(mesh)
        if shown is not None and shown.vertices is vertices:
            return shown
        normals = shading_normals(triangles(vertices, mesh.faces))
        # The warped surface shows its inside when it did so before, or when the warp mirrors it.
        whole = self._surface(result.inputs.mesh)
        affine = result.shown.affine[1:] if result.shown is not None else np.eye(3)
        mirrored = bool(np.linalg.det(affine) < 0)
        inside_out = (whole is not None and whole.inside_out) != mirrored
        self._shown[mesh] = OverlayWarp(mesh, vertices, normals, inside_out)
        return self._shown[mesh]

    def _on_warp(self, shaded: _Shaded) -> None:
        result, viewport = shaded.result, self._viewports[Side.DESTINATION]
        if shaded.kind is _Kind.REFINE and (
            self.result is None or result.inputs != self.result.inputs
        ):
            return
        self.result = result
        if shaded.kind is not _Kind.REFINE:
            if shaded.warps == (None, None):
                viewport.hide_overlay()
            else:
                viewport.show_overlay(shaded.warps)
        if shaded.kind is not _Kind.PREVIEW and not self._editor.is_previewing:
            # Only now: the stand-in stays until the full mesh has caught up.
            viewport.set_warping(False)
        now = time.monotonic()
        due = shaded.quality is not None or now - self._table_shown_at > 2 * TABLE_PAUSE
        due |= shaded.kind is not _Kind.PREVIEW
        if due:
            self._table_shown_at = now
            self._model.show_result(result)
        # Each widget that changes costs a composition of the window: only the slider's is live.
        if due or result.inputs.settings.penalty != self._editor.committed.settings.penalty:
            self._panel.show_result(result)
        self._on_looks()
        self.result_changed.emit(result, shaded.kind is not _Kind.PREVIEW, shaded.quality)
        if shaded.kind is _Kind.REST and result.factor is not None and not result.factor.has_modes:
            self._warps.request_if_idle(_Request(result.inputs, _Kind.REFINE, result))

    def _on_failure(self, error: Exception) -> None:
        raise error

    # The penalty

    def _on_penalty(self, penalty: float) -> None:
        session = edits.set_penalty(self._editor.committed, penalty)
        self._editor.commit(session, "Change penalty")

    def _on_convention(self, convention: PenaltyConvention) -> None:
        session = edits.set_convention(self._editor.committed, convention)
        self._editor.commit(session, "Change penalty convention")

    def _on_planar(self, planar: bool) -> None:
        label = "Treat as planar" if planar else "Do not treat as planar"
        self._editor.commit(edits.set_planar(self._editor.committed, planar), label)


def _caption(file: MeshFile | MeshReference) -> str:
    """Return the name of a mesh's file, and how the mesh differs from what is in it."""
    ways = [f"mirrored: {file.mirrored}"] if file.mirrored else []
    if file.scaled != 1:
        ways.append(f"× {file.scaled:g}")
    return f"{file.path.name} ({', '.join(ways)})" if ways else file.path.name
