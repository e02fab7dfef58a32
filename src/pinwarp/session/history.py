"""Undo and redo: snapshots of the session with the label of what led to each."""

from __future__ import annotations

from dataclasses import dataclass

from pinwarp.core.frame_warp import BodyRules
from pinwarp.session.session import Session

NO_RULES = BodyRules()


@dataclass(frozen=True)
class Step:
    """A session, and in words what was done to get there.

    Where the session is of a body of a model, it comes with what is chosen for the body's elements.
    """

    session: Session
    label: str = ""
    merge_key: str | None = None
    rules: BodyRules = NO_RULES


class History:
    """Snapshots before and after the current one.

    A session is small (meshes are shared), so that a snapshot costs next to nothing.

    Examples
    --------
    >>> history = History(Session())
    >>> history.commit(Session(unit="m"), "Change unit")
    >>> history.undo_label
    'Change unit'
    >>> history.undo().unit
    'mm'
    """

    def __init__(self, session: Session, rules: BodyRules = NO_RULES) -> None:
        self._past: list[Step] = [Step(session, rules=rules)]
        self._future: list[Step] = []
        self._saved: Session | None = session

    @property
    def session(self) -> Session:
        """The current session."""
        return self._past[-1].session

    @property
    def saved(self) -> Session | None:
        """The session as its file holds it; None where none does."""
        return self._saved

    @property
    def rules(self) -> BodyRules:
        """What is chosen for the elements of the session's body, where it is of one."""
        return self._past[-1].rules

    @property
    def undo_label(self) -> str | None:
        """What undo would take back, None when there is nothing."""
        return self._past[-1].label if len(self._past) > 1 else None

    @property
    def redo_label(self) -> str | None:
        """What redo would do again, None when there is nothing."""
        return self._future[-1].label if self._future else None

    @property
    def is_dirty(self) -> bool:
        """Whether the session differs from the one saved last."""
        return self._saved is None or self.session != self._saved

    def commit(
        self,
        session: Session,
        label: str,
        merge_key: str | None = None,
        rules: BodyRules | None = None,
    ) -> None:
        """Make a session the current one; the rules stay without others.

        What equals the current one leaves no step. Commits in a row with the same merge key
        become one step.
        """
        rules = self.rules if rules is None else rules
        if session == self.session and rules == self.rules:
            return
        last = self._past[-1]
        if merge_key is not None and last.merge_key == merge_key and not self._future:
            self._past.pop()
        self._past.append(Step(session, label, merge_key, rules))
        self._future.clear()

    def undo(self) -> Session:
        """Go one step back, where there is one."""
        if len(self._past) > 1:
            self._future.append(self._past.pop())
        return self.session

    def redo(self) -> Session:
        """Go one step forward, where there is one."""
        if self._future:
            self._past.append(self._future.pop())
        return self.session

    def mark_saved(self, *, saved: bool = True) -> None:
        """Remember the current session as the one on disk (or that there is none)."""
        self._saved = self.session if saved else None
