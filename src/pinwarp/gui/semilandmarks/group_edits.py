"""What the panel and the menu do to curves and patches."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from pinwarp.core.curves import PathFinder
from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Position, Side, as_position
from pinwarp.gui.semilandmarks.shown import Shown
from pinwarp.gui.semilandmarks.slow_edits import SlowEdit, SlowEdits
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.warp.accepting import accepted
from pinwarp.session.warp.sliding import Finders

PATCH_POINTS = 300


class GroupEdits:
    """Turns what is asked for into edits; those that take a while are made by a worker.

    Parameters
    ----------
    editor
        What is edited.
    finders
        Of ways over the bones.
    shown
        Returns what is seen of curves and patches.
    say
        Says a sentence in passing.
    """

    def __init__(
        self,
        editor: Editor,
        finders: Finders,
        shown: Callable[[], Shown],
        say: Callable[[str], None],
    ) -> None:
        self._editor = editor
        self._shown = shown
        self._say = say
        self._finders = finders
        self._slow = SlowEdits(editor, finders, say)

    @property
    def is_idle(self) -> bool:
        """Whether nothing is under way."""
        return self._slow.is_idle

    def shut_down(self) -> None:
        """Stop the worker."""
        self._slow.shut_down()

    # Patches

    @property
    def closed_curves(self) -> list[Curve]:
        """Those that have an inside."""
        groups = self._editor.session.groups
        return [group for group in groups if isinstance(group, Curve) and group.is_closed]

    def add_patch(self, place: Position | None, chosen: str, done: Callable[[], None]) -> None:
        """Spread a patch over the source.

        Parameters
        ----------
        place
            On which side of a closed curve; None for the whole surface.
        chosen
            The curve or patch that is chosen: if it is a closed curve, it is meant.
        done
            Called once the patch is there.
        """
        around = self._around(place, chosen) if place is not None else ""
        if place is not None and not around:
            self._say("There is no closed curve: a patch inside one begins with drawing it.")
            return
        name = edits.next_group_name(self._editor.session, "patch")

        def spread(session: Session, finder: PathFinder) -> Session:
            free = edits.next_group_name(session, "patch")
            return edits.add_patch(
                session, finder, count=PATCH_POINTS, around=around, inside=place, name=free
            )[0]

        def is_there() -> None:
            added = self._editor.session.groups[-1]
            self._editor.look(group=added.name)
            self._say(f"{added.name}: {added.count} points.")
            done()

        self._say(f"Spreading {PATCH_POINTS} points…")
        self._slow.ask(SlowEdit(spread, f"Spread {name}", done=is_there))

    def _around(self, place: Position, chosen: str) -> str:
        """Return the closed curve that is meant: the chosen one, else that which is nearest."""
        shown = self._shown()
        distances = {}
        for curve in self.closed_curves:
            one = shown.group(curve.name)
            if curve.name == chosen:
                return chosen
            if one is not None and Side.SOURCE in one.paths:
                apart = one.paths[Side.SOURCE] - np.array(place)
                distances[curve.name] = float(np.linalg.norm(apart, axis=1).min())
        return min(distances, key=lambda name: distances[name]) if distances else ""

    def set_count(self, name: str, count: int) -> None:
        """Give a group so many points; many such steps in a row are one to undo."""
        group = self._editor.committed.group(name)
        if group is None:
            return
        label, key = f"Change points of {name}", f"count {name}"

        def changed(session: Session, finder: PathFinder) -> Session:
            there = session.group(name)
            return session if there is None else edits.set_count(session, name, count, finder)

        self._slow.ask(SlowEdit(changed, label, key))

    # Curves

    def can_accept(self, name: str) -> bool:
        """Whether a curve is a ghost that can be accepted."""
        group, one = self._editor.session.group(name), self._shown().group(name)
        is_ghost = isinstance(group, Curve) and not group.is_drawn
        return is_ghost and one is not None and one.expected is not None

    def accept(self, name: str) -> bool:
        """Draw a curve on the destination where it is expected; say whether it was a ghost."""
        result = self._shown().asked.result
        if not self.can_accept(name) or result is None or result.spline is None:
            return False
        spline, finders = result.spline, self._finders

        def drawn(session: Session, finder: PathFinder) -> Session:
            mesh = session.mesh(Side.DESTINATION)
            if mesh is None:
                return session
            return accepted(session, name, spline, finder, finders.of(Side.DESTINATION, mesh))

        self._slow.ask(SlowEdit(drawn, f"Accept {name}"))
        return True

    def can_undraw(self, name: str) -> bool:
        """Whether a curve is drawn on the destination."""
        group = self._editor.session.group(name)
        return isinstance(group, Curve) and group.drawn

    def undraw(self, name: str) -> None:
        """Take back what was drawn of a curve on the destination."""
        self._try(lambda session: edits.undraw_curve(session, name), f"Undraw {name}")

    # All

    def rename(self, name: str, new_name: str) -> bool:
        """Call a group something else; say whether that could be."""
        return self._try(
            lambda session: edits.rename_group(session, name, new_name), f"Rename {name}"
        )

    def remove(self, name: str) -> None:
        """Remove a group."""
        self._try(lambda session: edits.remove_groups(session, [name]), f"Remove {name}")

    # Points

    def exclude(self, name: str, number: int) -> None:
        """Let a point take no part, or take part again."""
        group = self._editor.committed.group(name)
        if group is None or number >= group.count:
            return
        excluded = number not in group.excluded
        verb = "Exclude" if excluded else "Include"
        self._try(
            lambda session: edits.exclude_points(session, name, [number], excluded),
            f"{verb} point {number + 1} of {name}",
        )

    def can_pin(self, name: str, number: int) -> bool:
        """Whether a point has come to rest somewhere."""
        one = self._shown().group(name)
        return (
            one is not None
            # What is still shown of it may be older than the last edit.
            and one.group == self._editor.committed.group(name)
            and number < len(one.destination)
            and bool(np.isfinite(one.destination[number]).all())
            and not one.is_freed[number]
        )

    def pin(self, name: str, number: int) -> str:
        """Make a pair of a point where it is; return its name, empty where it could not be."""
        one = self._shown().group(name)
        if one is None or not self.can_pin(name, number):
            return ""
        source, destination = map(as_position, (one.source[number], one.destination[number]))
        before = {landmark.name for landmark in self._editor.committed.landmarks}
        pin = partial(_pinned, name, number, source, destination)
        if not self._try(pin, f"Pin point {number + 1} of {name}"):
            return ""
        new = [x.name for x in self._editor.committed.landmarks if x.name not in before]
        return new[0] if new else ""

    def _try(self, edit: Callable[[Session], Session], label: str) -> bool:
        problem = self._editor.attempt(edit, label)
        if problem:
            self._say(problem)
        return not problem


def _pinned(
    name: str, number: int, source: Position, destination: Position, session: Session
) -> Session:
    return edits.pin_point(session, name, number, source, destination)[0]
