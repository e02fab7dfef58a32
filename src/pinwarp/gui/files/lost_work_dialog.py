"""The offer to restore what was not saved when pinwarp ended unexpectedly."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from enum import Enum, auto

from qtpy.QtCore import QDateTime, QLocale, QSize, Qt
from qtpy.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QStyle,
    QTreeWidget,
    QTreeWidgetItem,
    QVBoxLayout,
    QWidget,
)

from pinwarp.session.keeping.recovery import LostWork

_WIDTH, _LIST_WIDTH = 520, 640
_MOST_ROWS = 8


class LostAnswer(Enum):
    """What to do with unsaved work."""

    RESTORE = auto()
    DISCARD = auto()
    LATER = auto()


class LostWorkDialog(QDialog):
    """Shows what would be restored; a list where several windows were lost.

    Parameters
    ----------
    found
        The unsaved work, at least one.
    parent
        The window.
    """

    def __init__(self, found: Sequence[LostWork], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._found = list(found)
        self.answer = LostAnswer.LATER
        self.chosen = self._found[0]
        self.setWindowTitle("Restore unsaved work?")
        self.question = QLabel()
        self.about = QLabel()
        self.list = QTreeWidget()
        self.buttons = QDialogButtonBox()
        roles = QDialogButtonBox.ButtonRole
        self.restore = self.buttons.addButton("Restore", roles.AcceptRole)
        self.discard = self.buttons.addButton("Discard", roles.DestructiveRole)
        self.later = self.buttons.addButton("Later", roles.RejectRole)
        self._lay_out()
        self._fill()
        self.restore.clicked.connect(lambda: self._end(LostAnswer.RESTORE))
        self.discard.clicked.connect(lambda: self._end(LostAnswer.DISCARD))
        self.buttons.rejected.connect(self.reject)
        self.list.currentItemChanged.connect(self._show)
        self.list.itemActivated.connect(lambda: self._end(LostAnswer.RESTORE))
        self._show()

    def _lay_out(self) -> None:
        sign = QLabel()
        style = self.style()
        size = style.pixelMetric(QStyle.PixelMetric.PM_MessageBoxIconSize)
        sign.setPixmap(
            style.standardIcon(QStyle.StandardPixmap.SP_MessageBoxQuestion).pixmap(size, size)
        )
        font = self.question.font()
        font.setBold(True)
        self.question.setFont(font)
        words = QVBoxLayout()
        words.setSpacing(8)
        for label in (self.question, self.about):
            label.setWordWrap(True)
            # Names of files and landmarks are the user's own, not markup.
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setMinimumWidth(_WIDTH)
            words.addWidget(label)
        self.about.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        top = QHBoxLayout()
        top.setSpacing(14)
        top.addWidget(sign, 0, Qt.AlignmentFlag.AlignTop)
        top.addLayout(words, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(16, 16, 16, 12)
        column.setSpacing(14)
        column.addLayout(top)
        column.addWidget(self.list)
        column.addWidget(self.buttons)
        self.restore.setDefault(True)

    def _fill(self) -> None:
        several = len(self._found) > 1
        self.list.setVisible(several)
        self.list.setAccessibleName("Unsaved work")
        self.list.setRootIsDecorated(False)
        self.list.setAlternatingRowColors(True)
        self.list.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.list.setHeaderLabels(["Session", "Changed", "Pairs", "Last"])
        header = self.list.header()
        header.setStretchLastSection(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        height = self.list.fontMetrics().height() + 7
        for lost in self._found:
            work = lost.work
            row = [lost.name, moment_in_words(work.edited), str(lost.pairs), work.label or ""]
            item = QTreeWidgetItem(self.list, row)
            item.setSizeHint(0, QSize(0, height))
            item.setTextAlignment(2, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.list.setCurrentItem(self.list.topLevelItem(0))
        rows = min(len(self._found), _MOST_ROWS)
        self.list.setFixedHeight(header.sizeHint().height() + rows * height + 4)
        if several:
            self.list.setMinimumWidth(_LIST_WIDTH)

    def _show(self) -> None:
        self.chosen = self._found[max(self.list.indexOfTopLevelItem(self.list.currentItem()), 0)]
        self.question.setText(question_about(self.chosen))
        self.about.setText(words_about(self.chosen))

    def _end(self, answer: LostAnswer) -> None:
        self.answer = answer
        self.accept()


def question_about(lost: LostWork) -> str:
    """Return what happened and the question, with what would be restored."""
    what = f"{lost.pairs} pair{'' if lost.pairs == 1 else 's'}"
    if lost.work.label:
        what += f", last: {lost.work.label}"
    when = moment_in_words(lost.work.edited)
    return f"pinwarp did not close properly on {when}.\nRestore {lost.name} ({what})?"


def words_about(lost: LostWork) -> str:
    """Return which landmarks, meshes and file the unsaved work belongs to."""
    record = lost.work.record
    meshes = [mesh.path.name for mesh in (record.source_mesh, record.destination_mesh) if mesh]
    count = len(record.landmarks)
    lines = [f"{count} landmark{'' if count == 1 else 's'}"]
    if meshes:
        lines[0] += f" on {' and '.join(meshes)}"
    if lost.work.path is None:
        lines.append("It was never saved.")
    elif not lost.work.path.exists():
        lines.append(f"Its file {lost.work.path} is gone: saving writes it anew.")
    elif lost.file_has_changed:
        lines.append(f"Its file {lost.work.path} has changed since: saving will ask.")
    else:
        lines.append(f"Its file {lost.work.path} stays as it is until you save.")
    return "\n".join(lines)


def moment_in_words(moment: datetime) -> str:
    """Return a date and time of here, such as ``22 November at 14:03``."""
    local = moment.astimezone()
    year = "" if local.year == datetime.now().year else " yyyy"
    # The words around it are English, whatever the system speaks.
    english = QLocale(QLocale.Language.English)
    return english.toString(QDateTime(local.replace(tzinfo=None)), f"d MMMM{year} 'at' HH:mm")
