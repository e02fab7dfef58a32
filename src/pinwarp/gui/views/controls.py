"""What the View menu does with the cameras. Nothing here changes the session."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np
import pyvista as pv
from qtpy.QtCore import QObject

from pinwarp.core.alignment import Similarity
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.gui.capability.action import Action, one_of
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.scene.camera_pose import (
    Matrix,
    Pose,
    StandardView,
    best_frame,
    inverse,
    pairing_fit,
    standard_frame,
)
from pinwarp.gui.scene.fronts import fronts
from pinwarp.gui.style.icons import icon
from pinwarp.gui.views.camera_link import CameraLink
from pinwarp.gui.views.canvas import Canvas
from pinwarp.gui.views.scenes import Scenes
from pinwarp.session.editor import Editor
from pinwarp.session.view import LinkMode

LINK_ACTIONS = {
    LinkMode.LINKED: "link_linked",
    LinkMode.ROTATION: "link_rotation",
    LinkMode.FREE: "link_free",
}
_LINKS = {
    LinkMode.LINKED: ("&Linked", "Both move, seen from the same side", 11),
    LinkMode.ROTATION: ("&Rotation Only", "Pan and zoom are of their own", 12),
    LinkMode.FREE: ("&Free", "Each view moves by itself", 13),
}
_SIDES = {
    StandardView.FRONT: ("&Front View", 11),
    StandardView.BACK: ("&Back View", 12),
    StandardView.LEFT: ("&Left View", 21),
    StandardView.RIGHT: ("&Right View", 22),
    StandardView.TOP: ("&Top View", 31),
    StandardView.BOTTOM: ("Botto&m View", 32),
}
# Share of the bone's diagonal that the height of a view shows after a focus.
CLOSE_UP = 0.4


class ViewControls(Capability):
    """The View menu's cameras.

    Parameters
    ----------
    editor
        Its view state is what the actions change.
    views
        One per side.
    scenes
        What they show.
    say
        Says a sentence in passing.
    parent
        The window.
    """

    def __init__(
        self,
        editor: Editor,
        views: Mapping[Side, Canvas],
        scenes: Scenes,
        say: Callable[[str], None],
        parent: QObject,
    ) -> None:
        self._editor = editor
        self._say = say
        self._views = views
        self._fitted_for: tuple[Landmark, ...] | None = None
        self._fit: Similarity | None = None
        self._expected: Callable[[], Similarity | None] = lambda: None
        self._expected_fit: Similarity | None = None
        self._surfaces = self._surfaces_now()
        self._pairs = 0
        self.link = CameraLink(views, self.pairing_fit)
        self._link_next = Action(
            "link_next",
            "&Next Camera Link",
            self._next_link,
            at="cameras.21 tools.42",
            keys="K",
            deed="Choose Next Camera Link",
            icon=LINK_ACTIONS[editor.view.link],
        )
        self.actions = (
            self._link_next,
            *one_of(map(self._link_action, LinkMode), parent),
            *self._of_cameras(),
        )
        editor.view_changed.connect(self._on_view)
        scenes.shown.connect(self._on_shown)
        self._on_view()

    def _link_action(self, mode: LinkMode) -> Action:
        text, tip, place = _LINKS[mode]
        return Action(
            LINK_ACTIONS[mode],
            text,
            lambda: self._editor.look(link=mode),
            checked=lambda: self._editor.view.link is mode,
            at=f"cameras.{place}",
            tip=tip,
        )

    def _of_cameras(self) -> tuple[Action, ...]:
        return (
            Action(
                "fit",
                "&Fit Both Views",
                self.fit_all,
                at="View.21 tools.41",
                keys="Home",
                icon="fit",
                tip="Look at both bones as a whole, from the side they are seen from",
            ),
            Action(
                "standard_view",
                "S&tandard View",
                self.look_as_at_first,
                at="View.23",
                keys="Shift+Home",
                deed="Return to Standard View",
                tip="Look at both bones as when they were opened",
            ),
            Action(
                "focus",
                "F&ocus on Selection",
                self.focus,
                at="View.22 row.41",
                keys="F",
                tip="Look at the selected landmarks closely",
            ),
            *(
                Action(
                    f"view_{view.value}",
                    text,
                    partial(self.look_from, view),
                    at=f"sides.{place}",
                    keys=str(number),
                    deed=f"Look From {text.replace('&', '').removesuffix(' View')}",
                    tip="The side that is shown first" if view is StandardView.FRONT else "",
                )
                for number, (view, (text, place)) in enumerate(_SIDES.items(), 1)
            ),
        )

    def shut_down(self) -> None:
        """Let go of the cameras and the editor."""
        self.link.unlink()
        self._editor.view_changed.disconnect(self._on_view)

    # What changed

    def _on_view(self, _changed: object = None) -> None:
        view = self._editor.view
        self.link.set_mode(view.link)
        self._link_next.setIcon(icon(LINK_ACTIONS[view.link]))
        self._link_next.setToolTip(
            f"Cameras are {view.link.value} ({self._link_next.keys} changes it)"
        )

    def _on_shown(self) -> None:
        surfaces, pairs = self._surfaces_now(), len(self._editor.session.pairs)
        # Each view has just fitted its new bone by itself, from a side of its own choice. Pairs
        # that come many at once are from a file: nobody is aiming at a place on the bone.
        unaligned = surfaces != self._surfaces or (self._pairs < 3 and pairs > self._pairs + 1)
        self._surfaces, self._pairs = surfaces, pairs
        if unaligned and (self.pairing_fit() is not None or self._is_upside_down()):
            self.look_as_at_first()

    def _is_upside_down(self) -> bool:
        """Whether a view that has fitted its bone by itself is another way up than the pair."""
        bones = self._bones
        return any(
            not np.array_equal(front, best_frame(bones[side].bounds_size))
            for side, front in fronts(bones, None).items()
        )

    @property
    def _bones(self) -> dict[Side, pv.PolyData]:
        return {side: x.bone for side, x in self._views.items() if x.bone is not None}

    def _surfaces_now(self) -> list[object]:
        return [view.surface for view in self._views.values()]

    def follow(self, expected: Callable[[], Similarity | None]) -> None:
        """Let somebody else tell how source maps to destination, where the pairs do not."""
        self._expected = expected

    def pairing_fit(self) -> Similarity | None:
        """Return how the pairs map source to destination, else how somebody expects it.

        The same object for the same pairs.
        """
        fit = self._fit_of_pairs()
        if fit is None and not _same(expected := self._expected(), self._expected_fit):
            self._expected_fit = expected
        return self._expected_fit if fit is None else fit

    def _fit_of_pairs(self) -> Similarity | None:
        landmarks = self._editor.session.landmarks
        if landmarks is not self._fitted_for:
            pairs = self._editor.session.pairs
            fit = pairing_fit(
                [pair.source for pair in pairs if pair.source is not None],
                [pair.destination for pair in pairs if pair.destination is not None],
            )
            self._fitted_for = landmarks
            if not _same(fit, self._fit):
                self._fit = fit
        return self._fit

    # Cameras

    def _next_link(self) -> None:
        modes = list(LinkMode)
        following = modes[(modes.index(self._editor.view.link) + 1) % len(modes)]
        self._editor.look(link=following)
        text, tip, _ = _LINKS[following]
        self._say(f"Cameras: {text.replace('&', '').lower()}. {tip}.")

    def fit_all(self) -> None:
        """Show both bones as a whole, each from where it is seen.

        Once the pairs tell how, the destination is shown from the source's anatomical side.
        """
        poses = {side: Pose.of(view.camera) for side, view in self._views.items()}
        if not all(pose.is_proper for pose in poses.values()):
            # There is no side to keep.
            self.look_as_at_first()
            return
        frames = {side: pose.frame for side, pose in poses.items()}
        self._show(frames, self._pairs_turn())

    def look_as_at_first(self) -> None:
        """Show both bones from the front; once the pairs tell how, from the same side."""
        self._show_from(StandardView.FRONT, self._pairs_turn())

    def _pairs_turn(self) -> Matrix | None:
        """Return how the pairs turn the source's sides to the destination's, None where free."""
        fit = self.pairing_fit() if self.link.mode is not LinkMode.FREE else None
        return fit.rotation if fit is not None else None

    def look_from(self, view: StandardView) -> None:
        """Show both bones from one of the source's six sides."""
        self._show_from(view, self.link.source_to_destination())

    def _show_from(self, view: StandardView, rotation: Matrix | None) -> None:
        fit = self.pairing_fit()
        found = fronts(self._bones, None if fit is None else fit.rotation)
        self._show({side: standard_frame(x, view) for side, x in found.items()}, rotation)

    def _show(self, frames: dict[Side, Matrix], rotation: Matrix | None) -> None:
        """Show both bones as a whole from given sides, or the destination as the source is."""
        frames = {side: x for side, x in frames.items() if self._views[side].bone is not None}
        if rotation is not None and len(frames) == 2:
            frames[Side.DESTINATION] = rotation @ frames[Side.SOURCE]
        with self.link.on_their_own():
            for side, frame in frames.items():
                self._views[side].look_at_all(frame)

    def focus(self) -> None:
        """Look at the selected landmarks from nearby, in both views; at everything without any."""
        targets = self._targets()
        if not targets:
            self.fit_all()
            return
        self.focus_on(targets)

    def focus_on(self, targets: Mapping[Side, Matrix]) -> None:
        """Look at (n, 3) places of one side or of both from nearby."""
        if not all(Pose.of(view.camera).is_proper for view in self._views.values()):
            # There is no side to look from any more.
            self.look_as_at_first()
        rotation = self.link.source_to_destination()
        poses = {side: Pose.of(view.camera) for side, view in self._views.items()}
        if rotation is not None:
            turned = rotation @ poses[Side.SOURCE].frame
            poses[Side.DESTINATION] = poses[Side.DESTINATION].turned(turned)
        with self.link.on_their_own():
            for side, positions in targets.items():
                view, pose = self._views[side], poses[side]
                if view.bone is None:
                    continue
                centre = positions.mean(axis=0)
                reach = 1.3 * float(np.linalg.norm(positions - centre, axis=1).max())
                half_height = max(
                    reach, CLOSE_UP / 2 * float(np.linalg.norm(view.bone.bounds_size))
                )
                near = half_height / np.tan(np.radians(view.camera.GetViewAngle()) / 2)
                # Whoever has zoomed in further stays there.
                view.set_pose(pose.focused(centre, min(pose.distance, float(near))))

    def show_place(self, side: Side, position: Sequence[float]) -> bool:
        """Turn a view until a position is seen; False where it is seen already."""
        view = self._views[side]
        if view.sees(position):
            return False
        self.link.lead(side, view.pose_to_see(position))
        return True

    def _targets(self) -> dict[Side, Matrix]:
        """Return where the selected landmarks are; the pairs guess the side that is missing."""
        editor, targets = self._editor, {}
        selected = [editor.session.landmark(name) for name in editor.selection.names]
        for side in Side:
            placed = [x.position(side) for x in selected if x is not None]
            positions = [position for position in placed if position is not None]
            if positions:
                targets[side] = np.array(positions)
        fit = self.pairing_fit()
        if len(targets) == 1 and fit is not None and self.link.mode is LinkMode.LINKED:
            ((side, known),) = targets.items()
            there = fit if side is Side.SOURCE else inverse(fit)
            targets[side.other] = there.apply(known)
        return targets


def _same(a: Similarity | None, b: Similarity | None) -> bool:
    if a is None or b is None:
        return a is b
    return (
        a.scale == b.scale
        and np.array_equal(a.rotation, b.rotation)
        and np.array_equal(a.translation, b.translation)
    )
