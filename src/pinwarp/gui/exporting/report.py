"""File > Export Report: pictures of both views, and all figures, as HTML and CSV."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path

from qtpy.QtCore import QBuffer, QIODevice
from qtpy.QtWidgets import QWidget

from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.maps import MapKind
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.gui.tasks.file_tasks import FileTasks, Progress
from pinwarp.io.report import Picture, write_figures, write_report
from pinwarp.session.editor import Editor
from pinwarp.session.judging.quality import quality_of
from pinwarp.session.judging.report import report_of
from pinwarp.session.judging.survey import Surveyor
from pinwarp.session.warp.component_words import applied_in_words
from pinwarp.session.warp.solver import WarpInputs, WarpSolver


class ReportExport:
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
    """

    def __init__(
        self,
        editor: Editor,
        tasks: FileTasks[Dialogs],
        views: Mapping[Side, QWidget],
        name: Callable[[], str],
    ) -> None:
        self._editor = editor
        self._tasks = tasks
        self._views = views
        self._name = name

    def ask_and_export(self) -> None:
        """Ask for a file and write the report there, with its numbers as CSV beside it."""
        name = f"{self._name().lower()}_report.html"
        path = self._tasks.ask_save("Export a report", name, (".html",), "Reports")
        if path is not None:
            self.export(path)

    def export(self, path: Path) -> None:
        """Write the report and its CSV."""
        session, title, now = self._editor.committed, self._name(), datetime.now()
        pictures = self._pictures()
        table = path.with_suffix(".csv")

        def write(progress: Progress) -> None:
            progress(0.1, "judging the pairs")
            result = WarpSolver().solve(WarpInputs.of(session))
            quality = quality_of(result)
            if quality is None:
                raise PinwarpError(result.problem or "There is no pair yet to report on.")
            progress(0.3, "measuring distances")
            destination = session.mesh(Side.DESTINATION)
            survey = Surveyor().survey(result, destination, MapKind.DISTANCE)
            report = report_of(title, session, result, quality, survey, now)
            progress(0.8, "writing")
            write_report(path, report, pictures)
            write_figures(table, report.figures)

        def arrived(_nothing: None) -> None:
            self._tasks.said.emit(f"Exported {path.name}, and its numbers as {table.name}")

        self._tasks.run(f"Exporting {path.name}", write, arrived)

    def _pictures(self) -> list[Picture]:
        applied = applied_in_words(self._editor.committed.settings)
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
