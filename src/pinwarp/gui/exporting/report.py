"""File > Export Report: pictures of both views, and all figures, as HTML and CSV."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from datetime import datetime
from pathlib import Path

from qtpy.QtCore import QBuffer, QIODevice
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Side
from pinwarp.core.model_rows import ElementRow
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.tasks.file_tasks import FileTasks, Progress
from pinwarp.io.report import Picture, write_figures, write_report
from pinwarp.session.editor import Editor
from pinwarp.session.judging.quality import Quality
from pinwarp.session.judging.report import report_of
from pinwarp.session.warp.refined import warp_in_words
from pinwarp.session.warp.result import WarpResult
from pinwarp.session.warp.solved import solved


class ReportExport(Capability):
    """Asks for a file and writes the report.

    Parameters
    ----------
    editor
        Whose session is reported.
    tasks
        Runs, asks and tells.
    views
        What is pictured, one per side.
    name
        Returns what the session is called.
    known
        Returns the last warp and what is known of its pairs, if anything: where they are those of
        the session, they are not found again.
    elements
        Returns what became of the elements of the model's body, where one is worked on.
    """

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks[Dialogs],
        views: Mapping[Side, QWidget],
        name: Callable[[], str],
        known: Callable[[], tuple[WarpResult | None, Quality | None]],
        elements: Callable[[], Sequence[ElementRow]],
    ) -> None:
        self._editor = editor
        self._tasks = tasks
        self._views = views
        self._name = name
        self.actions = (
            Action(
                "export_report",
                "Export &Report…",
                self.ask_and_export,
                at="File.44",
                keys="Ctrl+Shift+E",
                tip="Pictures, pairs and quality, as HTML",
                possible=lambda: editor.session.pairs,
            ),
        )
        self._known, self._elements = known, elements

    def ask_and_export(self) -> None:
        """Ask for a file and write the report there, with its numbers as CSV beside it."""
        name = f"{self._name().lower()}_report.html"
        path = self._tasks.ask_save("Export a report", name, (".html",), "Reports")
        if path is not None:
            self.export(path)

    def export(self, path: Path) -> None:
        """Write the report and its CSV."""
        session, title, now = self._editor.committed, self._name(), datetime.now()
        result, quality = self._known()
        elements = self._elements()
        pictures = self._pictures()
        table = path.with_suffix(".csv")

        def write(progress: Progress) -> None:
            report = report_of(
                title,
                solved(session, result),
                now,
                quality=quality,
                elements=elements,
                told=lambda share, stage: progress(0.1 + 0.7 * share, stage),
            )
            progress(0.8, "writing")
            write_report(path, report, pictures)
            write_figures(table, report.figures)

        def arrived(_nothing: None) -> None:
            self._tasks.said.emit(f"Exported {path.name}, and its numbers as {table.name}")

        self._tasks.run(f"Exporting {path.name}", write, arrived)

    def _pictures(self) -> list[Picture]:
        applied = warp_in_words(self._editor.committed)
        captions = {
            Side.SOURCE: "Source",
            Side.DESTINATION: f"Destination, with {applied} of the source",
        }
        return [Picture(captions[side], _png(view)) for side, view in self._views.items()]


def _png(widget: QWidget) -> bytes:
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    widget.grab().save(buffer, "PNG")
    return bytes(buffer.data().data())
