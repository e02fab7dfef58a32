"""Takes snapshots of the warp: of the present penalty, or of five in a sweep."""

from __future__ import annotations

import weakref
from collections.abc import Callable

import numpy as np
from qtpy.QtCore import QObject, QRect, QRectF, QSize, Qt
from qtpy.QtGui import QImage

from pinwarp.core.settings import WarpSettings
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.penalty.figures import tidy_residual
from pinwarp.gui.penalty.passing_preview import PassingPreview
from pinwarp.gui.penalty.snapshot_strip import PICTURE, Snapshot, SnapshotStrip
from pinwarp.gui.views.canvas import Canvas
from pinwarp.gui.views.scenes import Scenes
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.gui.warp.warps import Warps
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs, WarpResult

MOST = 12
# Flexibilities of a sweep.
SWEEP = (1.0, 0.75, 0.5, 0.25, 0.0)
# Share of the bone's picture that is left free around it, and the narrowest picture.
BORDER = 0.06
NARROWEST = 0.6
_NO_WARP = "There is no warp to picture yet: place pairs on both meshes."
_NO_SCALE = "A sweep needs five pairs: with fewer the penalty has nothing to act on."


class Snapshots(Capability):
    """Keeps the window's snapshots; they are not part of the session.

    Parameters
    ----------
    editor, warps, quality
        Where the warps and their figures come from.
    scenes, canvas
        What is pictured.
    say
        Shows a message in the status bar.
    parent
        The window.
    """

    def __init__(
        self,
        editor: Editor,
        warps: Warps,
        quality: QualityPresenter,
        scenes: Scenes,
        canvas: Canvas,
        say: Callable[[str], None],
        parent: QObject,
    ) -> None:
        self._editor = editor
        self._warps = warps
        self._quality = quality
        self._scenes = scenes
        self._canvas = canvas
        self._say = say
        self.snapshots: tuple[Snapshot, ...] = ()
        self._ahead: list[float] = []
        self._swept: list[Snapshot] = []
        self._preview = PassingPreview(editor, parent)
        self._preview.ended.connect(self._on_ended)
        self.actions = (
            Action(
                "snapshot",
                "Take S&napshot",
                self.take,
                at="Warp.21",
                keys="P",
                tip="A picture of the warp at this penalty",
                button="Snapshot",
            ),
            Action(
                "sweep",
                "S&weep: 5 Snapshots",
                self.sweep,
                at="Warp.22",
                tip="From interpolation to the affine fit",
            ),
            Action(
                "clear_snapshots",
                "&Clear Snapshots",
                self.clear,
                at="Warp.23",
                possible=lambda: self.snapshots,
            ),
        )
        self.strip = strip = SnapshotStrip(self.actions)
        strip.settings_requested.connect(self._on_settings)
        strip.removal_requested.connect(self._on_removal)
        editor.session_changed.connect(self._on_session)
        editor.taken_up.connect(self.clear)
        warps.result_changed.connect(self._on_result)
        self._show()

    def shut_down(self) -> None:
        """Let go of the editor and the warps."""
        self._preview.shut_down()
        self._editor.taken_up.disconnect(self.clear)
        self._editor.session_changed.disconnect(self._on_session)
        self._warps.result_changed.disconnect(self._on_result)

    @property
    def is_settled(self) -> bool:
        """Whether no sweep is under way."""
        return self._preview.session is None

    def take(self) -> None:
        """Picture the warp as it is shown."""
        result = self._warps.result
        if result is None or result.shown is None:
            self._say(_NO_WARP)
        else:
            self._keep(self._snapshot(result))

    def sweep(self) -> None:
        """Picture the warp from interpolation to the affine fit."""
        result = self._warps.result
        factor = result.factor if result is not None else None
        if factor is None or not factor.has_modes or not len(factor.poles):
            self._say(_NO_SCALE)
        elif not self._editor.is_previewing:
            self._ahead = [factor.penalty_at(flexibility) for flexibility in SWEEP]
            self._swept = []
            self._show_next()

    def clear(self) -> None:
        """Remove all snapshots."""
        self.snapshots = ()
        self._show()

    # A sweep: each warp is previewed, and pictured when it has arrived; all appear at the end,
    # since a strip that appears makes the views smaller

    def _show_next(self) -> None:
        # A refinement belongs to one penalty: among the others it would not be a sweep.
        unrefined = edits.set_refinement(self._editor.committed, None)
        self._preview.show(edits.set_penalty(unrefined, self._ahead[0]))

    def _on_result(self, result: WarpResult, _at_rest: bool) -> None:
        session = self._preview.session
        if session is None or result.inputs != WarpInputs.of(session, result.inputs.stand_in):
            return
        self._swept.append(self._snapshot(result))
        self._ahead.pop(0)
        if self._ahead:
            self._show_next()
        else:
            self._preview.end()

    def _on_ended(self) -> None:
        if self._ahead:
            self._say("The sweep was stopped before all its snapshots were taken.")
        else:
            self._keep(*self._swept)
        self._ahead, self._swept = [], []

    # The snapshots

    def _keep(self, *taken: Snapshot) -> None:
        self.snapshots = (*self.snapshots, *taken)[-MOST:]
        self._show()
        self.strip.show_last()

    def _snapshot(self, result: WarpResult) -> Snapshot:
        # The warp has just arrived, and is not seen yet.
        self._scenes.show_now()
        quality, flexibility = self._quality.quality, result.flexibility
        left_out, mesh = None, result.inputs.mesh
        if quality is not None and quality.curve is not None and flexibility is not None:
            pairs = (quality.inputs.source, quality.inputs.destination)
            if pairs == (result.inputs.source, result.inputs.destination):
                left_out, _ = quality.curve.at(flexibility)
        return Snapshot(
            picture=picture_of(self._canvas),
            inputs=result.inputs.without_meshes,
            mesh=weakref.ref(mesh) if mesh is not None else None,
            flexibility=flexibility,
            leave_one_out=left_out if left_out is not None and np.isfinite(left_out) else None,
            residual=tidy_residual(result),
            ruler=self._editor.rulers.session,
        )

    def _on_settings(self, settings: WarpSettings) -> None:
        session = edits.set_basis(self._editor.committed, settings.basis)
        self._editor.commit(edits.set_penalty(session, settings.penalty), "Change penalty")

    def _on_removal(self, snapshot: Snapshot) -> None:
        self.snapshots = tuple(kept for kept in self.snapshots if kept is not snapshot)
        self._show()

    def _on_session(self, _session: Session) -> None:
        self._show_states()

    def _show(self) -> None:
        self.strip.show_snapshots(self.snapshots)
        self.actions[-1].renew()
        self._show_states()

    def _show_states(self) -> None:
        if not self.strip.tiles:
            return
        now = WarpInputs.of(self._editor.session)
        for tile in self.strip.tiles:
            changed = tile.snapshot.what_changed(now)
            settings = tile.snapshot.inputs.settings
            same = (settings.penalty, settings.basis) == (now.settings.penalty, now.settings.basis)
            tile.show_state(changed, same)


def picture_of(canvas: Canvas) -> QImage:
    """Return a small picture of the bones on a canvas, without the signs above them."""
    image = canvas.picture()
    ratio = image.width() / max(1, canvas.width())
    wanted = _around_the_bone(canvas)
    cut = QRect(*(round(ratio * x) for x in wanted.getRect()))
    sharpness = max(2.0, canvas.devicePixelRatioF())
    size = QSize(round(sharpness * PICTURE.width()), round(sharpness * PICTURE.height()))
    small = image.copy(cut).scaled(
        size, Qt.AspectRatioMode.KeepAspectRatio, Qt.TransformationMode.SmoothTransformation
    )
    small.setDevicePixelRatio(sharpness)
    return small


def _around_the_bone(canvas: Canvas) -> QRectF:
    """Return where the bone is on a canvas, with a border; all of the canvas without one."""
    everything = QRectF(canvas.rect())
    if canvas.bone is None:
        return everything
    points = np.asarray(canvas.bone.points)
    places = canvas.project(points[:: max(1, len(points) // 2000)])
    left, top = places.min(axis=0)
    right, bottom = places.max(axis=0)
    border = BORDER * max(right - left, bottom - top)
    width, height = right - left + 2 * border, bottom - top + 2 * border
    width = max(width, NARROWEST * height)
    around = QRectF((left + right - width) / 2, top - border, width, height)
    return around.intersected(everything) if around.intersects(everything) else everything
