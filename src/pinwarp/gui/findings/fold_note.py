"""Says in the status bar that the warp folds, and leads to the landmarks responsible."""

from __future__ import annotations

from collections.abc import Callable

from qtpy.QtWidgets import QPushButton

from pinwarp.core.landmarks import Side
from pinwarp.gui.style import theme
from pinwarp.session.editor import Editor
from pinwarp.session.judging.survey import Survey
from pinwarp.session.warp.pair_names import pair_names

MOST_NAMES = 3


class FoldNote(QPushButton):
    """A line of text where there are folds, nothing where there are none.

    Parameters
    ----------
    editor
        Where a click selects the landmarks.
    focus
        Looks at the selection.
    """

    def __init__(self, editor: Editor, focus: Callable[[], None]) -> None:
        super().__init__()
        self._editor = editor
        self._focus = focus
        self._survey: Survey | None = None
        self.setFlat(True)
        self.setStyleSheet(f"color: {theme.warning_text_colour().name()};")
        self.setToolTip(
            "The warp turns the surface inside out there: click to select these landmarks"
        )
        self.hide()
        self.clicked.connect(self._select)

    def show_survey(self, survey: Survey | None) -> None:
        """Say how much folds, and near which landmarks, by their present names."""
        self._survey = survey
        count = survey.folds.count if survey is not None and survey.folds is not None else 0
        self.setVisible(count > 0)
        if not count:
            return
        names = self._names()
        text = "1 vertex folds" if count == 1 else f"{count:,} vertices fold"
        if names:
            more = len(names) - MOST_NAMES
            text += f" near {', '.join(names[:MOST_NAMES])}"
            text += f" and {more} more" if more > 0 else ""
        self.setText(text)

    def _names(self) -> tuple[str, ...]:
        """Return the landmarks responsible, those of the largest patch first."""
        if self._survey is None:
            return ()
        names = pair_names(self._survey.result.inputs, self._editor.session)
        rows = (row for finding in self._survey.findings for row in finding.rows)
        return tuple(dict.fromkeys(name for row in rows if (name := names[row]) is not None))

    def _select(self) -> None:
        names = self._names()
        if names:
            self._editor.select(*names, side=Side.DESTINATION)
            self._focus()
