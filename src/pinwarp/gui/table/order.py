"""Sorting and filtering of the landmark table, which leave the landmarks' order alone."""

from __future__ import annotations

from collections.abc import Iterable

from qtpy.QtCore import QModelIndex, QObject, QSortFilterProxyModel, Qt

from pinwarp.core.landmarks import Landmark, LandmarkState
from pinwarp.gui.table.model import LandmarkModel
from pinwarp.session.judging.quality import NamedFinding

_HALF = (LandmarkState.SOURCE_ONLY, LandmarkState.DESTINATION_ONLY, LandmarkState.EMPTY)
_SHORTEST = 3
# What may be wrong, whatever it is.
_SUSPECT = "suspect"


def matches(landmark: Landmark, words: list[str], findings: Iterable[NamedFinding] = ()) -> bool:
    """Whether each word occurs in the name or note of a landmark, or begins its state.

    Parameters
    ----------
    landmark
        The landmark.
    words
        In lower case.
    findings
        What was noticed about it: the kinds count as states, and all that may be wrong is suspect.

    Examples
    --------
    >>> fovea = Landmark("Fovea", (1, 2, 3))
    >>> matches(fovea, ["vea"]), matches(fovea, ["source", "only"]), matches(fovea, ["paired"])
    (True, True, False)
    """
    text = f"{landmark.name}\n{landmark.note}".casefold()
    states = landmark.state.value.split()
    if landmark.state in _HALF:
        states.append("incomplete")
    if landmark.locked:
        states.append("locked")
    for found in findings:
        states += found.finding.kind.value.split()
        if found.finding.is_grave:
            states.append(_SUSPECT)
    return all(word in text or _begins(word, states) for word in words)


def _begins(word: str, states: list[str]) -> bool:
    # Shorter ones are on the way to a name, and every pair is "paired".
    return len(word) >= _SHORTEST and any(state.startswith(word) for state in states)


class LandmarkOrder(QSortFilterProxyModel):
    """The rows as they are shown."""

    def __init__(self, model: LandmarkModel, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._model = model
        self._words: list[str] = []
        self.setSourceModel(model)

    @property
    def is_filtered(self) -> bool:
        """Whether some landmarks may be hidden."""
        return bool(self._words)

    @property
    def is_original(self) -> bool:
        """Whether all rows are there in the order of the session."""
        return not self._words and self.sortColumn() < 0

    def set_filter(self, text: str) -> None:
        """Show the landmarks that match every word."""
        self._words = text.casefold().split()
        self.invalidate()

    def landmark(self, index: QModelIndex) -> Landmark:
        """Return the landmark of a row."""
        return self._model.landmarks[self.mapToSource(index).row()]

    def filterAcceptsRow(self, row: int, _parent: QModelIndex) -> bool:
        """Return whether a row is shown."""
        if not self._words:
            return True
        found = self._model.row(row)
        return matches(found.landmark, self._words, found.findings)

    def lessThan(self, left: QModelIndex, right: QModelIndex) -> bool:
        """Return whether a row comes before another; cells without a value come last."""
        keys = self._model.sort_keys(left.column())
        a, b = keys[left.row()], keys[right.row()]
        if a is None or b is None:
            ascending = self.sortOrder() == Qt.SortOrder.AscendingOrder
            # Qt turns the comparison round for a descending order.
            return a is not b and ((b is None) if ascending else (a is None))
        return bool(a < b)
