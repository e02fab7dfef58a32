"""File > Export > Picture and Animation: asked for, rendered in steps, written by a job."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from qtpy.QtGui import QImage
from qtpy.QtWidgets import QDialog, QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.exporting.animation import (
    AnimationOrder,
    Ends,
    Format,
    Motion,
    animation_steps,
    ends_of,
)
from pinwarp.gui.exporting.offscreen import whole_of
from pinwarp.gui.exporting.picture import PictureOrder, picture_steps
from pinwarp.gui.exporting.picture_dialogs import AnimationDialog, PictureDialog
from pinwarp.gui.exporting.region import proposed, regions_of
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.tasks.file_tasks import FileTasks, Progress
from pinwarp.gui.views.canvas import Canvas
from pinwarp.io.animation import Frame, write_gif, write_mp4
from pinwarp.io.atomic import atomic_path
from pinwarp.session.editor import Editor
from pinwarp.session.warp.provenance import provenance
from pinwarp.session.warp.refined import warp_in_words


class PictureExport(Capability):
    """Asks what is wanted and where, and makes it.

    Parameters
    ----------
    editor
        Whose session is pictured.
    tasks
        Runs, asks and tells.
    views
        What is pictured, one per side.
    window
        The dialogs' parent.
    """

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks[Dialogs],
        views: Mapping[Side, Canvas],
        window: QWidget,
    ) -> None:
        self._editor = editor
        self._tasks = tasks
        self._views = views
        self._window = window
        # What was chosen last is proposed again.
        self._picture = PictureOrder()
        self._animation = AnimationOrder()
        self.actions = (
            Action(
                "export_picture",
                "Pi&cture…",
                self.ask_for_picture,
                at="export.11",
                tip="Of the views, at any size",
                possible=self._has_mesh,
            ),
            Action(
                "export_animation",
                "&Animation…",
                self.ask_for_animation,
                at="export.12",
                tip="Turned round, or warped and back",
                possible=self._has_mesh,
            ),
        )

    def _has_mesh(self) -> bool:
        return any(self._editor.session.mesh(side) is not None for side in Side)

    def ask_for_picture(self) -> None:
        """Ask what a picture is to show."""
        dialog = PictureDialog(
            self._picture, self._window, lambda order: proposed(order, self._views)
        )
        dialog.accepted.connect(lambda: self._make_picture(dialog.order))
        self._open(dialog)

    def ask_for_animation(self) -> None:
        """Ask what is to move."""
        dialog = AnimationDialog(self._animation, self._window)
        dialog.accepted.connect(lambda: self._make_animation(dialog.order))
        self._open(dialog)

    def _open(self, dialog: QDialog) -> None:
        dialog.finished.connect(dialog.deleteLater)
        dialog.open()

    def _make_picture(self, order: PictureOrder) -> None:
        self._picture = order
        path = self._ask_save("Export a picture", "png", "Pictures")
        if path is None:
            return
        what = self._shown(order.sides)
        made = provenance(self._editor.committed)

        def rendered(image: QImage) -> None:
            self._tasks.run(
                f"Exporting {path.name}",
                lambda _progress: _write_png(path, image, made),
                lambda _nothing: self._tasks.said.emit(
                    f"Exported {path.name}: {order.width} × {order.height} pixels{what}"
                ),
            )

        if order.filled:
            regions = regions_of(order, self._views)
        else:
            regions = {side: whole_of(self._views[side]) for side in order.sides}
        title = f"Exporting {path.name}"
        self._tasks.run_steps(title, picture_steps(order, self._views, regions), rendered)

    def _make_animation(self, order: AnimationOrder) -> None:
        self._animation = order
        path = self._ask_save("Export an animation", order.format.value, "Animations")
        if path is None:
            return
        title, view = f"Exporting {path.name}", self._views[Side.DESTINATION]
        session = self._editor.committed
        made = provenance(session)
        what = self._shown((Side.DESTINATION,))
        if order.motion is Motion.BLEND:
            what = f", to {warp_in_words(session)}"

        write_file = write_gif if order.format is Format.GIF else write_mp4

        def rendered(frames: list[Frame]) -> None:
            def write(progress: Progress) -> None:
                write_file(path, frames, order.seconds, remarks=made, progress=progress)

            self._tasks.run(
                title,
                write,
                lambda _nothing: self._tasks.said.emit(
                    f"Exported {path.name}: {order.frames} frames in {order.seconds:g} s{what}"
                ),
            )

        def render(ends: Ends | None) -> None:
            self._tasks.run_steps(title, animation_steps(order, view, ends), rendered)

        if order.motion is Motion.TURN:
            render(None)
            return

        def warp(progress: Progress) -> Ends:
            progress(0.0, "warping")
            return ends_of(session)

        self._tasks.run(title, warp, render)

    def _ask_save(self, title: str, suffix: str, kind: str) -> Path | None:
        source = self._editor.committed.source
        stem = source.path.stem if source is not None else "pinwarp"
        return self._tasks.ask_save(title, f"{stem}.{suffix}", (f".{suffix}",), kind)

    def _shown(self, sides: Sequence[Side]) -> str:
        """Say which part of the warp can be seen, where it can."""
        session = self._editor.committed
        seen = Side.DESTINATION in sides and self._editor.view.overlay and bool(session.pairs)
        return f", {warp_in_words(session)}" if seen else ""


def _write_png(path: Path, image: QImage, made: Sequence[str]) -> None:
    # The word of the PNG specification for what is told in it.
    image.setText("Description", "\n".join(made))
    with atomic_path(path) as temporary:
        if not image.save(str(temporary), "PNG"):
            raise OSError(f"{path} could not be written. Is the disk full?")
