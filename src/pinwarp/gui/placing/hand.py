"""What the hand asks of the landmarks, turned into edits: place, move, nudge, snap, delete."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.landmarks import Landmark, Role, Side, as_position
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.drawn.surface import Surface
from pinwarp.gui.placing.first_seen import FirstSeen
from pinwarp.gui.placing.ghosts import Ghosts
from pinwarp.gui.views.controls import ViewControls
from pinwarp.gui.views.viewport import Viewport
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.guide import next_incomplete
from pinwarp.session.naming import in_words
from pinwarp.session.session import Session
from pinwarp.session.signals import isolated

# An arrow key moves by this share of the bone, unless a step was set.
NUDGE_SHARE = 1 / 500
_STRAY = "That click came with the drag and did nothing: click again."
# Nearer to the surface than this share of the bone, a landmark counts as on it.
ON_SURFACE = 1e-4


class Hand(Capability):
    """Turns the requests of viewports, table and menu into edits.

    ``refused`` emits why something was not done, in words for the user.

    Parameters
    ----------
    editor
        What is edited.
    viewports
        Where the hand is.
    ghosts
        What a click fills, and where it is expected.
    views
        Turn so that a ghost is seen.
    """

    refused = isolated(str)

    def __init__(
        self,
        editor: Editor,
        viewports: dict[Side, Viewport],
        ghosts: Ghosts,
        views: ViewControls,
    ) -> None:
        self._editor = editor
        self._viewports = viewports
        self._ghosts = ghosts
        self.first_seen = FirstSeen(views, viewports, self._tell_turned)
        self._others: list[tuple[Callable[[bool], bool], Callable[[], bool]]] = []
        self.snap_action = Action(
            "snap",
            "S&nap to Surface",
            self.snap,
            at="Place.31",
            keys="S",
            tip="Put the selection back onto the bone",
        )
        self.accept_action = Action(
            "accept_ghost",
            "&Accept Ghost",
            self.accept_ghost,
            at="Place.11",
            keys="Space",
            tip="Place it where it is expected",
        )
        self.lock_action = Action(
            "lock",
            "&Lock Landmarks",
            switches=lambda on: editor.look(locked=on),
            checked=lambda: editor.view.locked,
            at="Place.33 tools.31",
            keys="L",
            icon="lock",
            tip="Freeze all landmarks",
        )
        self.actions = (
            self.snap_action,
            self.accept_action,
            self.lock_action,
            *self._on_selection(),
        )
        for side, viewport in viewports.items():
            self._connect(side, viewport)

    def _on_selection(self) -> tuple[Action, ...]:
        def is_selected() -> bool:
            return bool(self._editor.selection.names)

        return (
            Action(
                "delete_side",
                "&Delete Position",
                self.delete_side,
                at="Edit.61 tools.23 row.61",
                keys="Del Backspace",
                icon="delete",
                tip="On the selected side only",
                possible=is_selected,
            ),
            Action(
                "delete_landmark",
                "Delete &Landmark",
                self.delete_landmarks,
                at="Edit.62 row.62",
                keys="Ctrl+Del",
                tip="On both sides",
                possible=is_selected,
            ),
            Action(
                "swap_destinations",
                "Swap Dest&inations",
                lambda: self.swap_destinations(self._editor.selection.names),
                at="Edit.71 row.31",
                tip="Of two landmarks",
                possible=self._can_swap,
            ),
        )

    @property
    def all_locked(self) -> str:
        """Why nothing is moved while all landmarks are locked."""
        return f"All landmarks are locked: {self.lock_action.keys} unlocks them."

    def _can_swap(self) -> bool:
        session, names = self._editor.session, self._editor.selection.names
        chosen = [mark for name in names if (mark := session.landmark(name)) is not None]
        return len(chosen) == 2 and all(
            mark.is_complete and mark.role is Role.PAIR for mark in chosen
        )

    def _connect(self, side: Side, viewport: Viewport) -> None:
        editor = self._editor
        viewport.surface_clicked.connect(lambda position: self.place(side, position))
        viewport.surface_ctrl_clicked.connect(lambda position: self.add_passenger(side, position))
        viewport.surface_shift_clicked.connect(lambda position: self.place_again(side, position))
        viewport.stray_clicked.connect(lambda: self.refused.emit(_STRAY))
        viewport.background_clicked.connect(editor.select)
        viewport.ghost_clicked.connect(
            lambda name, position: self.click_ghost(name, side, position)
        )
        viewport.landmark_clicked.connect(lambda name: editor.select(name, side=side))
        viewport.landmark_dragged.connect(lambda name, position: self.drag(name, side, position))
        viewport.landmark_dropped.connect(self.drop)
        viewport.drag_cancelled.connect(editor.cancel_preview)
        viewport.hovered.connect(lambda name: editor.look(hovered=name))
        viewport.nudged.connect(lambda across, upwards: self.nudge(side, across, upwards))

    # Placing

    def place(self, side: Side, position: Iterable[float]) -> None:
        """Place the landmark that is asked for, or a new one."""
        editor = self._editor
        if self._is_locked():
            return
        guided, target = editor.view.guided, self._ghosts.target(side)
        landmark = editor.committed.landmark(guided) if guided else None
        if landmark is not None and landmark.position(side) is not None:
            self.refused.emit(
                f"{guided} is placed on the {side.value} already: drag it to move it, or click on "
                f"the {side.other.value}."
            )
            return
        session, name = edits.place(
            editor.committed,
            side,
            as_position(position),
            target=target,
            pattern=editor.view.name_pattern,
        )
        self._placed(session, f"Place {name}", name, side)

    def place_again(self, side: Side, position: Iterable[float] | None) -> None:
        """Put the selected landmark where a side was clicked, wherever it was before."""
        editor = self._editor
        names = editor.selection.names
        landmark = editor.committed.landmark(names[0]) if len(names) == 1 else None
        if landmark is None:
            self.refused.emit("Select one landmark first: Shift+click puts it where you click.")
        elif position is None:
            self.refused.emit(
                f"There is no surface here: click on the bone to put {names[0]} on it."
            )
        elif landmark.role is Role.PASSENGER and side is Side.DESTINATION:
            self.refused.emit(f"{landmark.name} is a passenger: the warp carries it over.")
        elif not self._is_locked(landmark):
            session = edits.move(editor.committed, landmark.name, side, as_position(position))
            verb = "Place" if landmark.position(side) is None else "Re-place"
            self._placed(session, f"{verb} {landmark.name}", landmark.name, side)

    def share_accepting(self, accept: Callable[[bool], bool], offers: Callable[[], bool]) -> None:
        """Let somebody else accept ghosts of its own by the same key.

        Parameters
        ----------
        accept
            Called with whether only a ghost that the user chose is meant: this is asked before
            landmarks, all others behind them. Says whether it accepted one.
        offers
            Says whether there is one.
        """
        self._others.append((accept, offers))

    @property
    def offers_ghost(self) -> bool:
        """Whether there is a ghost to accept."""
        return any(map(self._ghosts.at, Side)) or any(offers() for _, offers in self._others)

    def accept_ghost(self) -> None:
        """Place the landmark that a ghost predicts, on the side that was worked on last if any."""
        if any(accept(True) for accept, _ in self._others):
            return
        ghost = self._ghosts.next(self._editor.selection.side)
        if ghost is None:
            if any(accept(False) for accept, _ in self._others):
                return
            self.refused.emit(
                "There is nothing to accept: from the third pair on, a landmark placed on one side "
                "shows its ghost on the other."
            )
            return
        if self._is_locked() or not self.first_seen.is_seen(ghost.name, ghost.side, ghost.position):
            return
        # What was said of a view that has turned is over; what is said of the next is not.
        self.refused.emit("")
        session = edits.accept(self._editor.committed, ghost.name, ghost.side, ghost.position)
        self._placed(session, f"Accept {ghost.name}", ghost.name, ghost.side)

    def _tell_turned(self, name: str) -> None:
        self.refused.emit(
            f"{name} was out of sight: the view has turned, {self.accept_action.keys} accepts it."
        )

    def _placed(self, session: Session, label: str, name: str, side: Side) -> None:
        editor = self._editor
        editor.commit(session, label)
        editor.select(name, side=side)
        landmark = session.landmark(name)
        if editor.view.guided is not None and landmark is not None and landmark.is_complete:
            editor.look(guided=next_incomplete(session, name))

    def add_passenger(self, side: Side, position: Iterable[float]) -> None:
        """Add a passenger where the source was clicked."""
        if self._is_locked():
            return
        if side is not Side.SOURCE:
            self.refused.emit("Passengers are placed on the source: the warp carries them over.")
            return
        session, name = edits.add_passenger(self._editor.committed, as_position(position))
        self._editor.commit(session, f"Add {name}")
        self._editor.select(name, side=side)

    # Moving

    def drag(self, name: str, side: Side, position: Iterable[float]) -> None:
        """Show a landmark elsewhere while it is dragged."""
        editor = self._editor
        editor.select(name, side=side)
        landmark = editor.committed.landmark(name)
        # It may have been deleted or locked since it was drawn.
        if landmark is not None and not self._is_locked(landmark):
            editor.preview(edits.move(editor.committed, name, side, as_position(position)))

    def drop(self, name: str) -> None:
        """Leave a dragged landmark, or ghost, where it is."""
        editor = self._editor
        if not editor.is_previewing:
            # It may be locked.
            return
        landmark, side = editor.committed.landmark(name), editor.selection.side
        if landmark is not None and landmark.position(side) is None:
            self._placed(editor.session, f"Place {name}", name, side)
        else:
            editor.commit(editor.session, f"Move {name}")

    def click_ghost(self, name: str, side: Side, position: Iterable[float] | None) -> None:
        """Place the next landmark where its ghost was clicked; of others, choose which is next."""
        if name != self._ghosts.target(side):
            self._editor.select(name, side=side)
        elif position is not None:
            self.place(side, position)

    def swap_destinations(self, names: Sequence[str]) -> None:
        """Exchange the destinations of two landmarks."""
        editor = self._editor
        chosen = [editor.committed.landmark(name) for name in names]
        if any(self._is_locked(landmark) for landmark in chosen):
            return
        one, other = names
        session = edits.swap_destinations(editor.committed, one, other)
        editor.commit(session, f"Swap {one} and {other}")

    def nudge(self, side: Side, across: int, upwards: int) -> None:
        """Move the selection by steps along the screen; what is on the surface stays on it."""
        viewport = self._viewports[side]
        surface = viewport.surface
        if surface is None:
            return
        step = self._editor.view.nudge or surface.diagonal * NUDGE_SHARE
        right, up = viewport.view_axes()
        shift = step * (across * right + upwards * up)

        def nudged(position: NDArray) -> NDArray:
            moved = position + shift
            return surface.closest(moved)[0] if is_on(surface, position) else moved

        self._move_selected(side, nudged, "Nudge", merge=True)

    def snap(self) -> None:
        """Put the selected landmarks onto the surface of the side they were selected on."""
        side = self._editor.selection.side
        surface = self._viewports[side].surface
        if surface is None:
            return
        self._move_selected(side, lambda position: surface.closest(position)[0], "Snap")

    def distance_off(self, landmark: Landmark, side: Side) -> float | None:
        """Return how far off the surface a landmark is; None where it lies on it."""
        surface, position = self._viewports[side].surface, landmark.position(side)
        if surface is None or position is None:
            return None
        _, off = surface.closest(position)
        return off if off > surface.diagonal * ON_SURFACE else None

    def _move_selected(
        self, side: Side, move: Callable[[NDArray], NDArray], verb: str, *, merge: bool = False
    ) -> None:
        editor = self._editor
        session, names = editor.committed, editor.selection.names
        if not names or self._is_locked():
            return
        for name in names:
            landmark = session.landmark(name)
            position = landmark.position(side) if landmark is not None else None
            if landmark is None or position is None or self._is_locked(landmark):
                continue
            session = edits.move(session, name, side, as_position(move(np.array(position))))
        key = f"{verb} {names} {side}" if merge else None
        editor.commit(session, f"{verb} {in_words(names)}", key)

    def refuse_locked(self) -> bool:
        """Say whether nothing may be moved, telling the user so."""
        return self._is_locked()

    def _is_locked(self, landmark: Landmark | None = None) -> bool:
        """Say whether landmarks (or one of them) are frozen, telling the user so."""
        if self._editor.view.locked:
            self.refused.emit(self.all_locked)
            return True
        if landmark is not None and landmark.locked:
            self.refused.emit(f"{landmark.name} is locked: unlock it in the table.")
            return True
        return False

    # Deleting

    def delete_side(self) -> None:
        """Delete the selected landmarks' position on the selected side."""
        editor, session = self._editor, self._editor.committed
        if self._is_locked():
            return
        side = editor.selection.side
        for name in editor.selection.names:
            landmark = session.landmark(name)
            if landmark is None or self._is_locked(landmark):
                continue
            # A half-placed landmark has only one position that can be meant.
            there = landmark.position(side) is not None
            session = edits.remove_side(session, name, side if there else side.other)
        editor.commit(session, f"Delete position of {in_words(editor.selection.names)}")

    def delete_landmarks(self) -> None:
        """Delete the selected landmarks on both sides."""
        editor = self._editor
        if self._is_locked():
            return
        session = editor.committed
        free = [
            name
            for name in editor.selection.names
            if (landmark := session.landmark(name)) and not self._is_locked(landmark)
        ]
        editor.commit(edits.remove(session, free), f"Delete {in_words(free)}")


def is_on(surface: Surface, position: NDArray) -> bool:
    """Whether a position lies on a surface, but for rounding."""
    return surface.closest(position)[1] <= ON_SURFACE * surface.diagonal
