"""When a first guess is offered: once for a destination that has been opened, and not for long."""

from __future__ import annotations

from pinwarp.core.landmarks import Side
from pinwarp.core.mesh import Mesh
from pinwarp.session.editor import Editor
from pinwarp.session.suggesting.guessing import missing_of


class Offer:
    """Knows whether a first guess is to be offered.

    It is where a destination was opened to landmarks of the source, or these came many at once,
    and none of them is on the destination yet. It ends once one is, or the user says so, which
    holds for the session.

    Parameters
    ----------
    editor
        The truth.
    """

    def __init__(self, editor: Editor) -> None:
        self._editor = editor
        self._is_declined = self._is_up = False
        self._mesh: Mesh | None = None
        self._count = 0

    def decline(self) -> None:
        """Do not offer it in this session any more."""
        self._is_declined, self._is_up = True, False

    def end(self) -> None:
        """Take it back: it was taken up."""
        self._is_up = False

    def landmarks(self) -> int:
        """Look at the committed session; return for how many landmarks it is offered, 0 if not."""
        editor = self._editor
        session = editor.committed
        if editor.undo_label is None and editor.redo_label is None:
            # Another session has just been opened, or begun.
            self._is_declined = False
        mesh, count = session.mesh(Side.DESTINATION), len(missing_of(session))
        # Whoever places one after the other on the source is busy.
        is_new = mesh is not self._mesh or count > self._count + 1
        self._mesh, self._count = mesh, count
        placed = any(landmark.destination is not None for landmark in session.landmarks)
        is_due = (
            None not in (mesh, session.mesh(Side.SOURCE))
            and count > 0
            and not placed
            and not self._is_declined
        )
        self._is_up = is_due and (self._is_up or is_new)
        return count if self._is_up else 0
