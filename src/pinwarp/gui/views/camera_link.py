"""Two cameras that move together and know which places of the bones belong together."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from pinwarp.core.alignment import Similarity
from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.camera_pose import Matrix, Pose, inverse, relation_of
from pinwarp.gui.views.canvas import Canvas
from pinwarp.gui.views.viewport import Viewport
from pinwarp.session.view import LinkMode


class CameraLink:
    """Copies poses between two views, in the frame of each bone.

    Poses are copied and never the camera object: each view keeps its own clipping range, else a
    longer bone would be cut off in the other view.

    Once the pairs tell how the bones correspond, both are seen from the same anatomical side.
    Until then the other camera turns, shifts and zooms by the same amount as this one. A new pair
    turns nothing by itself: whoever is about to click the next place must not have it taken away
    from under the mouse. The fit is taken over when a camera moves next, or on Fit.

    Parameters
    ----------
    views
        One per side.
    fit
        Returns how the pairs map source to destination, None while they do not tell; the same
        object as long as the pairs are the same.
    """

    def __init__(self, views: Mapping[Side, Canvas], fit: Callable[[], Similarity | None]) -> None:
        self._views = views
        self._fit = fit
        self._mode = LinkMode.LINKED
        self._followed: Similarity | None = None
        self._leader = Side.SOURCE
        self._busy = False
        self._poses = {side: Pose.of(view.camera) for side, view in views.items()}
        self._tags = []
        for side, view in views.items():
            camera = view.camera
            tag = camera.AddObserver("ModifiedEvent", lambda *_, side=side: self._on_moved(side))
            self._tags.append((camera, tag))
            view.orbiting_changed.connect(self._on_orbiting)
            if isinstance(view, Viewport):
                view.turning_alone.connect(self._turn_alone)

    def unlink(self) -> None:
        """Let go of the cameras."""
        for camera, tag in self._tags:
            camera.RemoveObserver(tag)
        self._tags = []
        self._views = {}

    @property
    def mode(self) -> LinkMode:
        """How the cameras move together."""
        return self._mode

    def set_mode(self, mode: LinkMode) -> None:
        """Choose how the cameras move together; a link that is switched on acts at once."""
        if mode is self._mode:
            return
        self._mode = mode
        self._followed = None
        if self._fit() is not None:
            self._follow(self._leader, self._poses[self._leader])

    def source_to_destination(self) -> Matrix | None:
        """Return the rotation between the views as they should stand, None where each is free."""
        if self._mode is LinkMode.FREE or not self._both_drawn:
            return None
        return self._relation().rotation

    def lead(self, side: Side, pose: Pose) -> None:
        """Put one camera somewhere; the other follows, as it follows a hand."""
        self._leader = side
        # First, while the relation of both is still known.
        self._follow(side, pose)
        self._views[side].set_pose(pose)

    def _turn_alone(self, alone: bool) -> None:
        """Let a hand turn one bone and leave the other; they keep how they stand then."""
        self._followed = self._fit()
        self._busy = alone

    @contextmanager
    def on_their_own(self) -> Iterator[None]:
        """Move cameras one by one, and keep the relation that comes of it."""
        self._followed = self._fit()
        was_busy, self._busy = self._busy, True
        try:
            yield
        finally:
            self._busy = was_busy

    @property
    def _both_drawn(self) -> bool:
        return all(view.bone is not None for view in self._views.values())

    def _on_moved(self, side: Side) -> None:
        view = self._views[side]
        pose = Pose.of(view.camera)
        # VTK also tells of new clipping ranges, and of poses that are only half set.
        if not pose.is_proper or pose.is_at(self._poses[side]):
            return
        if self._busy or view.is_placing_camera:
            self._poses[side] = pose
            return
        self._leader = side
        self._follow(side, pose)

    def _follow(self, side: Side, pose: Pose) -> None:
        """Let the other view follow a pose of this one."""
        if self._mode is LinkMode.FREE or not self._both_drawn:
            self._poses[side] = pose
            return
        relation = self._relation()
        if side is Side.DESTINATION:
            relation = inverse(relation)
        self._poses[side] = pose
        other = self._poses[side.other]
        theirs = pose.mapped(relation)
        if not theirs.is_proper:
            # So far out that there is no such place.
            return
        if self._mode is LinkMode.ROTATION:
            theirs = other.turned(theirs.frame)
        self._busy = True
        try:
            self._views[side.other].set_pose(theirs)
        finally:
            self._busy = False

    def _relation(self) -> Similarity:
        """Return the map between the cameras: the pairs' where it is news, else the one kept."""
        fit = self._fit()
        if fit is not None and fit is not self._followed:
            self._followed = fit
            return fit
        return relation_of(self._poses[Side.SOURCE], self._poses[Side.DESTINATION])

    def _on_orbiting(self, orbiting: bool) -> None:
        """Draw both coarsely while both move."""
        if self._mode is not LinkMode.FREE or not orbiting:
            for view in self._views.values():
                view.set_orbiting(orbiting)
