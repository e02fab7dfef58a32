"""Wires the editor and the views: renders what changed, turns requests into edits."""

from __future__ import annotations

import weakref
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui.jobs import LatestWins
from pinwarp.gui.landmark_table import LandmarkModel, LandmarkTable
from pinwarp.gui.penalty_panel import PenaltyPanel
from pinwarp.gui.scene import scene_of
from pinwarp.gui.surface import Surface, shading_normals, triangles
from pinwarp.gui.viewport import Viewport
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.results import WarpInputs, WarpResult, WarpSolver
from pinwarp.session.session import Session


@dataclass(frozen=True, eq=False)
class _Shaded:
    """A result made ready for the screen in the worker."""

    result: WarpResult
    normals: NDArray | None


class Presenter:
    """Everything between the editor and the widgets; both are passed in.

    Parameters
    ----------
    editor
        The truth.
    viewports
        One per side.
    model, table, panel
        The other views.
    """

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
        self._asked: WarpInputs | None = None
        self.result: WarpResult | None = None
        self._normals_of: tuple[NDArray | None, NDArray | None] = (None, None)
        self._connect()
        self._on_session(editor.session)

    def _connect(self) -> None:
        editor, panel = self._editor, self._panel
        editor.session_changed.connect(self._on_session)
        editor.selection_changed.connect(self._on_looks)
        editor.view_changed.connect(self._on_looks)
        self._warps.computed.connect(self._on_warp)
        self._warps.failed.connect(self._on_failure)
        for side, viewport in self._viewports.items():
            self._connect_viewport(side, viewport)
        self._model.rename_requested.connect(self._on_rename)
        self._model.enable_requested.connect(self._on_enable)
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

    def _connect_viewport(self, side: Side, viewport: Viewport) -> None:
        editor = self._editor
        viewport.surface_clicked.connect(lambda position: self._on_place(side, position))
        viewport.background_clicked.connect(editor.select)
        viewport.landmark_clicked.connect(lambda name: editor.select(name, side=side))
        viewport.landmark_dragged.connect(
            lambda name, position: self._on_drag(name, side, position)
        )
        viewport.landmark_dropped.connect(lambda name: self._on_drop(name, side))
        viewport.drag_cancelled.connect(editor.cancel_preview)
        viewport.hovered.connect(lambda name: editor.look(hovered=name))

    def shut_down(self) -> None:
        """Stop the worker and let go of the editor."""
        self._warps.shut_down()
        self._editor.session_changed.disconnect(self._on_session)
        self._editor.selection_changed.disconnect(self._on_looks)
        self._editor.view_changed.disconnect(self._on_looks)

    @property
    def is_settled(self) -> bool:
        """Whether what is shown follows from the session as it is."""
        return self._warps.is_idle and self._asked == WarpInputs.of(self._editor.session)

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
            viewport.layer.caption = file.path.name if file is not None else ""
        self._model.show_session(session)
        self._panel.show_session(session)
        self._on_looks()
        inputs = WarpInputs.of(session)
        if inputs != self._asked:
            self._asked = inputs
            self._warps.request(inputs)

    def _on_looks(self, _changed: Any = None) -> None:
        editor = self._editor
        self._table.show_selection(editor.selection)
        for side, viewport in self._viewports.items():
            viewport.show_scene(
                scene_of(side, editor.session, editor.selection, editor.view, self.result)
            )

    def _warp(self, inputs: WarpInputs) -> _Shaded:
        """Solve and shade; runs in the worker."""
        result = self.solver.solve(inputs)
        vertices, normals = self._normals_of
        if result.vertices is not vertices:
            normals = None
            if result.vertices is not None and inputs.mesh is not None:
                normals = shading_normals(triangles(result.vertices, inputs.mesh.faces))
            self._normals_of = (result.vertices, normals)
        return _Shaded(result, normals)

    def _on_warp(self, shaded: _Shaded) -> None:
        previous, result = self.result, shaded.result
        self.result = result
        if previous is None or result.vertices is not previous.vertices:
            mesh = result.inputs.mesh
            self._viewports[Side.DESTINATION].show_overlay(
                mesh.faces if mesh is not None and result.vertices is not None else None,
                result.vertices,
                shaded.normals,
                inside_out=mesh is not None and self._is_flipped(mesh, result),
            )
        self._model.show_result(result)
        self._panel.show_result(result)
        self._on_looks()

    def _is_flipped(self, mesh: Mesh, result: WarpResult) -> bool:
        """Whether the warped surface shows its inside: it was so, or the warp mirrors."""
        surface = self._surface(mesh)
        mirrored = result.spline is not None and np.linalg.det(result.spline.affine[1:]) < 0
        return (surface is not None and surface.inside_out) != mirrored

    def _on_failure(self, error: Exception) -> None:
        raise error

    # From requests to edits

    def _on_place(self, side: Side, position: NDArray) -> None:
        session, name = edits.place(self._editor.committed, side, as_position(position))
        self._editor.commit(session, f"Place {name}")
        self._editor.select(name, side=side)

    def _on_drag(self, name: str, side: Side, position: NDArray) -> None:
        self._editor.select(name, side=side)
        self._editor.preview(edits.move(self._editor.committed, name, side, as_position(position)))

    def _on_drop(self, name: str, _side: Side) -> None:
        self._editor.commit(self._editor.session, f"Move {name}")

    def _on_rename(self, name: str, new_name: str) -> None:
        editor = self._editor
        try:
            session = edits.rename(editor.committed, name, new_name)
        except PinwarpError as error:
            self.complain(str(error))
            return
        was_selected = name in editor.selection.names
        editor.commit(session, f"Rename {name}")
        if was_selected:
            editor.select(new_name.strip())

    def _on_enable(self, name: str, enabled: bool) -> None:
        verb = "Enable" if enabled else "Disable"
        self._editor.commit(
            edits.set_enabled(self._editor.committed, name, enabled), f"{verb} {name}"
        )

    def _on_penalty(self, penalty: float) -> None:
        session = edits.set_penalty(self._editor.committed, penalty)
        self._editor.commit(session, "Change penalty")

    def _on_convention(self, convention: PenaltyConvention) -> None:
        session = edits.set_convention(self._editor.committed, convention)
        self._editor.commit(session, "Change penalty convention")

    def _on_planar(self, planar: bool) -> None:
        label = "Treat as planar" if planar else "Do not treat as planar"
        self._editor.commit(edits.set_planar(self._editor.committed, planar), label)

    def delete_side(self) -> None:
        """Delete the selected landmarks' position on the selected side."""
        editor, session = self._editor, self._editor.committed
        side = editor.selection.side
        for name in editor.selection.names:
            landmark = session.landmark(name)
            if landmark is None:
                continue
            # A half-placed landmark has only one position that can be meant.
            there = landmark.position(side) is not None
            session = edits.remove_side(session, name, side if there else side.other)
        editor.commit(session, f"Delete position of {self._selected_words()}")

    def delete_landmarks(self) -> None:
        """Delete the selected landmarks on both sides."""
        names = self._editor.selection.names
        label = f"Delete {self._selected_words()}"
        self._editor.commit(edits.remove(self._editor.committed, names), label)

    def _selected_words(self) -> str:
        names = self._editor.selection.names
        return names[0] if len(names) == 1 else f"{len(names)} landmarks"

    def complain(self, text: str) -> None:
        """Say what is wrong with something the user just typed; the window shows it."""
        self._panel.window().statusBar().showMessage(text, 8000)
