"""The reading that was taken, and the ghosts that follow from it as the session goes on."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pinwarp.core.alignment import Similarity
from pinwarp.core.guessed import Reading
from pinwarp.core.landmarks import Side
from pinwarp.core.pose import PoseSettings
from pinwarp.gui.suggesting.run import Meshes
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.suggesting import ghosts_of
from pinwarp.session.suggesting.guessing import missing_of
from pinwarp.session.warp.ghost import Ghost


@dataclass(frozen=True, eq=False)
class Taken:
    """A reading, of which meshes it is, and how the same is had again."""

    reading: Reading
    meshes: Meshes
    settings: PoseSettings


class Expected:
    """Knows where all landmarks are expected that the destination lacks.

    Once all are placed the reading is kept: undo brings ghosts back.

    Parameters
    ----------
    editor
        The truth; drags under way move ghosts, too.

    Attributes
    ----------
    taken : Taken or None
        What they follow from.
    """

    def __init__(self, editor: Editor) -> None:
        self._editor = editor
        self.taken: Taken | None = None
        self._known: tuple[Ghost, ...] = ()
        self._known_for: tuple[object, object] = (None, None)

    def take(self, reading: Reading, session: Session, settings: PoseSettings) -> None:
        """Expect landmarks where a reading of a session puts them."""
        self.taken = Taken(reading, Meshes.of(session), settings)

    def renew(self, reading: Reading) -> None:
        """Take the same again, warped anew."""
        if self.taken is not None:
            self.taken = replace(self.taken, reading=reading)

    def forget(self) -> None:
        """Expect nothing any more, and hold no mesh."""
        self.taken = None
        self._known, self._known_for = (), (None, None)

    def ghosts(self) -> tuple[Ghost, ...]:
        """Return a ghost for each missing landmark within reach, the most certain first."""
        taken, session = self.taken, self._editor.session
        if taken is None or not taken.meshes.are_those_of(session):
            return ()
        if self._known_for[0] is not taken or self._known_for[1] != session.landmarks:
            self._known_for = (taken, session.landmarks)
            self._known = tuple(
                Ghost(place.name, Side.DESTINATION, place.position, place.radius)
                for place in ghosts_of(taken.reading, session)
            )
        return self._known

    def unplaced(self) -> list[str]:
        """Return the missing landmarks that have no ghost."""
        names = {ghost.name for ghost in self.ghosts()}
        return [x.name for x in missing_of(self._editor.session) if x.name not in names]

    def fit(self) -> Similarity | None:
        """Return how the reading lays the source on the destination, while there are ghosts."""
        if self.taken is None or not self.ghosts():
            return None
        pose = self.taken.reading.pose
        return Similarity(pose.rotation, pose.scale, pose.offset)
