"""Looking at destinations that were only suggested, and confirming them one after the other."""

from __future__ import annotations

from qtpy.QtCore import Qt
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.placing.hand import Hand
from pinwarp.session import edits
from pinwarp.session.editor import Editor


class Reviewing(Capability):
    """Lets the key that accepts ghosts confirm suggested landmarks: one at a time, each seen.

    Parameters
    ----------
    editor
        The truth.
    hand
        Whose key it is; it shows what is hidden first.
    view
        Of the destination: there one looks, and there the keys go.
    """

    def __init__(self, editor: Editor, hand: Hand, view: QWidget) -> None:
        self._editor = editor
        self._hand = hand
        self._view = view
        hand.share_accepting(self._accept, lambda: False)

    @property
    def _suggested(self) -> list[Landmark]:
        return [landmark for landmark in self._editor.committed.landmarks if landmark.is_suggested]

    @property
    def words(self) -> str:
        """What the key does now; empty where it confirms nothing."""
        selected = self._selected()
        if selected is None:
            return ""
        key = self._hand.accept_action.keys
        if len(self._editor.selection.names) > 1:
            return f"{key} looks at {selected.name}, the first of those that are only suggested."
        does = "confirms it where it is"
        if self._hand.first_seen.is_out_of_sight(*_place_of(selected)):
            does = "turns the view to it, then confirms it where it is"
        return f"{selected.name} is only suggested: {key} {does}, a drag moves it."

    def begin(self) -> None:
        """Look at the first suggested landmark, or the one after the selected."""
        suggested, names = self._suggested, self._editor.selection.names
        if not suggested:
            return
        rows = [row for row, one in enumerate(suggested) if one.name in names[:1]]
        single = len(names) == 1
        self._look_at(suggested[(rows[0] + 1) % len(suggested) if rows and single else 0])
        self._view.setFocus(Qt.FocusReason.OtherFocusReason)

    def _selected(self) -> Landmark | None:
        names = self._editor.selection.names
        return next((one for one in self._suggested if one.name in names), None)

    def _accept(self, chosen_only: bool) -> bool:
        """Confirm the selected one, or look at it first; see :meth:`Hand.share_accepting`."""
        selected = self._selected()
        if selected is None:
            if not chosen_only and self._suggested:
                self.begin()
                return True
            return False
        if len(self._editor.selection.names) > 1:
            # Not all of them at once: each is to be seen.
            self._look_at(selected)
        elif self._is_seen(selected):
            self._confirm(selected)
        return True

    def _confirm(self, landmark: Landmark) -> None:
        suggested = self._suggested
        row = suggested.index(landmark)
        following = [*suggested[row + 1 :], *suggested[:row]]
        session = edits.confirm(self._editor.committed, landmark.name)
        self._editor.commit(session, f"Confirm {landmark.name}")
        if following:
            self._editor.select(following[0].name, side=Side.DESTINATION)

    def _look_at(self, landmark: Landmark) -> None:
        self._editor.select(landmark.name, side=Side.DESTINATION)
        self._is_seen(landmark)

    def _is_seen(self, landmark: Landmark) -> bool:
        return self._hand.first_seen.is_seen(*_place_of(landmark))


def _place_of(landmark: Landmark) -> tuple[str, Side, Position]:
    place = landmark.destination
    assert place is not None, "what is suggested is somewhere"
    return landmark.name, Side.DESTINATION, place
