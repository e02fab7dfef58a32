"""Handles of curves in the hand: shown elsewhere while they are dragged, one step when dropped."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from numpy.typing import NDArray

from pinwarp.core.errors import PinwarpError
from pinwarp.core.gathering import course_of, path_of
from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Side, as_position
from pinwarp.gui.semilandmarks.shown import ShownGroup
from pinwarp.gui.views.viewport import Viewport
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.warp.sliding import Finders


class HandleDrag:
    """Turns drags of handles into edits.

    Parameters
    ----------
    editor
        What is edited.
    viewports
        Where the hand is.
    finders
        Of ways over both bones.
    shown
        Returns a curve as it is seen.
    refuse_locked
        Says so where nothing may be moved, and returns whether that is so.
    say
        Says a sentence in passing.
    """

    def __init__(
        self,
        editor: Editor,
        viewports: Mapping[Side, Viewport],
        finders: Finders,
        shown: Callable[[str], ShownGroup | None],
        refuse_locked: Callable[[], bool],
        say: Callable[[str], None],
    ) -> None:
        self._editor = editor
        self._finders = finders
        self._shown = shown
        self._refuse_locked = refuse_locked
        self._say = say
        # What a drag began from, drawn on the destination where it is dragged there; and its name.
        self._begun: tuple[Session, str, Side, Session, str] | None = None
        for side, view in viewports.items():
            view.handle_clicked.connect(lambda name, _number: editor.look(group=name))
            view.handle_dragged.connect(
                lambda name, number, place, onto, side=side: self.drag(
                    side, name, number, place, onto
                )
            )
            view.handle_dropped.connect(lambda name, _number: self.drop(name))

    def drag(self, side: Side, name: str, number: int, place: NDArray, onto: str) -> None:
        """Show a handle elsewhere; on the source, a landmark that it is dragged onto anchors it."""
        editor = self._editor
        if self._refuse_locked():
            return
        begun = self._begin(side, name)
        if begun is None:
            return
        curve = begun.group(name)
        if not isinstance(curve, Curve) or number >= len(curve.handles):
            return
        editor.look(group=name)
        landmark = curve.handles[number].landmark
        if landmark:
            # Only on the destination, where it was not placed yet: it is the landmark that moves.
            editor.preview(edits.move(begun, landmark, side, as_position(place)))
            return
        anchors = {handle.landmark for handle in curve.handles}
        target = begun.landmark(onto) if side is Side.SOURCE and onto not in anchors else None
        if target is not None and target.source is not None:
            session = edits.move_handle(begun, name, number, side, target.source, onto)
        else:
            session = edits.move_handle(begun, name, number, side, as_position(place))
        editor.preview(session)

    def drop(self, name: str) -> None:
        """Leave a handle where it is, unless no way leads there."""
        editor, begun, self._begun = self._editor, self._begun, None
        if begun is None or not editor.is_previewing:
            return
        session = editor.session
        problem = self._problem(session, name)
        if problem:
            editor.cancel_preview()
            self._say(problem)
        else:
            editor.commit(session, begun[4])

    def _begin(self, side: Side, name: str) -> Session | None:
        """Return the session that a drag began from."""
        editor, begun = self._editor, self._begun
        if begun is not None and begun[:3] == (editor.committed, name, side):
            return begun[3]
        session, label = editor.committed, f"Move handle of {name}"
        curve = session.group(name)
        if side is Side.DESTINATION and isinstance(curve, Curve) and not curve.is_drawn:
            shown = self._shown(name)
            if shown is None or shown.expected is None:
                return None
            session = edits.accept_curve(session, name, shown.expected)
            label = f"Draw {name} on the destination"
        self._begun = (editor.committed, name, side, session, label)
        return session

    def _problem(self, session: Session, name: str) -> str:
        """Say why a curve is none where its handles are now."""
        curve = session.group(name)
        source, destination = (session.mesh(side) for side in Side)
        if not isinstance(curve, Curve):
            return ""
        try:
            if source is not None:
                course_of(curve, self._finders.of(Side.SOURCE, source))
            if destination is not None and curve.is_drawn:
                path_of(curve, self._finders.of(Side.DESTINATION, destination), Side.DESTINATION)
        except PinwarpError as error:
            return str(error)
        return ""
