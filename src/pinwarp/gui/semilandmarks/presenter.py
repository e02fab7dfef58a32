"""Curves and patches of semilandmarks: drawn, seen, listed, changed."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from qtpy.QtWidgets import QLabel, QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability, Panel
from pinwarp.gui.placing.guidance import Guidance
from pinwarp.gui.placing.hand import Hand
from pinwarp.gui.scene.drawables import Drawable, ToolWords
from pinwarp.gui.semilandmarks.curve_tool import CurveTool
from pinwarp.gui.semilandmarks.group_edits import GroupEdits
from pinwarp.gui.semilandmarks.handle_drag import HandleDrag
from pinwarp.gui.semilandmarks.panel import SemilandmarkPanel
from pinwarp.gui.semilandmarks.patch_tool import PatchTool
from pinwarp.gui.semilandmarks.pictures import Picture
from pinwarp.gui.semilandmarks.shown import Asked, Shown, look_at
from pinwarp.gui.semilandmarks.view_tool import ViewTool
from pinwarp.gui.semilandmarks.words import in_short, why_not
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.controls import ViewControls
from pinwarp.gui.views.scenes import Scenes
from pinwarp.gui.views.viewport import Viewport
from pinwarp.gui.warp.warps import Warps
from pinwarp.session.editor import Editor
from pinwarp.session.view import ViewState


class Semilandmarks(Capability):
    """Everything between the groups of a session and what shows and changes them.

    Parameters
    ----------
    editor
        The truth.
    warps
        Where they slide.
    hand, guidance
        Whose key accepts curves, too, and who says what a click does.
    views
        Look at points.
    scenes, viewports
        Where they are seen, and where the hand is.
    say
        Says a sentence in passing.
    window
        Whose keys the tools take.
    """

    def __init__(
        self,
        editor: Editor,
        warps: Warps,
        hand: Hand,
        guidance: Guidance,
        views: ViewControls,
        scenes: Scenes,
        viewports: Mapping[Side, Viewport],
        say: Callable[[str], None],
        window: QWidget,
    ) -> None:
        self._editor = editor
        self._warps = warps
        self._views = views
        self._scenes = scenes
        self._guidance = guidance
        self._finders = warps.solver.slider.finders
        self._accept_key = hand.accept_action.keys
        self.shown = Shown(Asked.of(editor.session, None))
        self._asked = self.shown.asked
        self._point: tuple[str, int] | None = None
        self._worker = LatestWins(lambda asked: look_at(asked, self._finders))
        self._worker.computed.connect(self._on_shown)
        self._worker.failed.connect(self._on_failure)
        self.edits = GroupEdits(editor, self._finders, lambda: self.shown, say)
        self.curve_tool = CurveTool(editor, viewports, window, self._finders)
        self._pictures = {
            Side.SOURCE: Picture(Side.SOURCE, self.curve_tool),
            Side.DESTINATION: Picture(Side.DESTINATION),
        }
        self.patch_tool = PatchTool(viewports, window, self._fill)
        self.drag = HandleDrag(
            editor, viewports, self._finders, lambda name: self.shown.group(name),
            hand.refuse_locked, say,
        )  # fmt: skip
        for tool in (self.curve_tool, self.patch_tool):
            tool.said.connect(say)
            tool.changed.connect(self._on_tool)
        self.actions = (*self._of_tools(), *self._of_groups(), *self._of_points())
        by_key = {action.objectName(): action for action in self.actions}
        shown_keys = (
            "draw_curve add_patch accept_curve undraw_curve "
            "remove_group show_slides pin_point exclude_point"
        )
        self.panel = SemilandmarkPanel(
            [by_key[key] for key in shown_keys.split()],
            "Semilandmarks are points along curves and over surfaces whose counterparts nobody "
            "places: they slide until the warp bends least.\n\n"
            f"{by_key['draw_curve'].keys} draws a curve along a crest of the source, "
            f"{by_key['add_patch'].keys} spreads a patch over its surface.",
        )
        self.panels = (Panel("semilandmarks", "Semilandmarks", self.panel),)
        self.note = QLabel()
        self.notes = (self.note,)
        hand.share_accepting(self._accept, self._offers)
        guidance.give_way_to(lambda: self._tool.hint if self._tool is not None else "")
        self._connect()
        self._show()

    def _connect(self) -> None:
        editor, panel = self._editor, self.panel
        panel.group_chosen.connect(lambda name: editor.look(group=name))
        panel.point_chosen.connect(self._on_point)
        panel.frame_requested.connect(self.frame_freed)
        panel.count_requested.connect(self.edits.set_count)
        panel.model.rename_requested.connect(self._rename)
        panel.tree.remove_requested.connect(self._remove)
        editor.session_changed.connect(self._on_session)
        editor.view_changed.connect(self._on_view)
        self._warps.result_changed.connect(self._on_session)

    def shut_down(self) -> None:
        """Stop the workers and let go of the editor."""
        self._warps.result_changed.disconnect(self._on_session)
        self._editor.session_changed.disconnect(self._on_session)
        self._editor.view_changed.disconnect(self._on_view)
        self.patch_tool.stop()
        self.curve_tool.shut_down()
        self.edits.shut_down()
        self._worker.shut_down()

    @property
    def is_settled(self) -> bool:
        """Whether all that was asked for is done and shown."""
        current = Asked.of(self._editor.session, self._warps.result)
        idle = self._worker.is_idle and self.edits.is_idle and self.curve_tool.is_settled
        return idle and self.shown.asked == current

    # What can be asked for

    def _of_tools(self) -> tuple[Action, ...]:
        def has_source() -> bool:
            return self._editor.session.mesh(Side.SOURCE) is not None

        return (
            Action(
                "draw_curve",
                "Draw &Curve",
                switches=self._draw_curve,
                checked=lambda: self.curve_tool.is_active,
                at="semilandmarks.11 tools.33",
                keys="C",
                icon="curve",
                tip="Click along a crest of the source: semilandmarks slide along it",
                button="Draw Curve",
                possible=has_source,
            ),
            Action(
                "add_patch",
                "Add &Patch",
                self._add_patch,
                checked=lambda: self.patch_tool.is_active,
                at="semilandmarks.12 tools.34",
                keys="Shift+C",
                icon="patch",
                tip="Spread semilandmarks over the source, or inside a closed curve",
                button="Add Patch",
                possible=has_source,
            ),
            Action(
                "add_whole_patch",
                "Patch Over the &Whole Surface",
                lambda: self._fill(None),
                at="semilandmarks.13",
                tip="Closed curves or not",
                possible=has_source,
            ),
        )

    def _of_groups(self) -> tuple[Action, ...]:
        chosen, space = self._chosen, self._accept_key
        return (
            Action(
                "accept_curve",
                "&Accept Curve",
                lambda: self._accept(True),
                at="semilandmarks.21",
                tip=f"Draw it on the destination where it is expected ({space})",
                button="Accept",
                possible=lambda: self.edits.can_accept(chosen()),
            ),
            Action(
                "undraw_curve",
                "&Undraw Curve",
                lambda: self.edits.undraw(chosen()),
                at="semilandmarks.22",
                tip="Take back what was drawn on the destination: it slides by its tangents again",
                button="Undraw",
                possible=lambda: self.edits.can_undraw(chosen()),
            ),
            Action(
                "remove_group",
                "&Remove Curve or Patch",
                self._remove,
                at="semilandmarks.23",
                button="Remove",
                possible=chosen,
            ),
            Action(
                "show_slides",
                "Show &Slides",
                switches=lambda on: self._editor.look(slides=on),
                checked=lambda: self._editor.view.slides,
                at="semilandmarks.31",
                keys="Shift+A",
                tip="How far each semilandmark slid from where the landmarks alone put it",
                button="Slides",
            ),
            Action(
                "frame_freed",
                "&Look at Points Without Counterpart",
                self.frame_freed,
                at="semilandmarks.32",
                possible=lambda: any(one.freed for one in self.shown.groups),
            ),
        )

    def _of_points(self) -> tuple[Action, ...]:
        return (
            Action(
                "pin_point",
                "P&in Point",
                self._pin,
                at="semilandmarks.41",
                tip="Make the point chosen in the list a pair where it is",
                button="Pin",
                possible=lambda: self._point is not None and self.edits.can_pin(*self._point),
            ),
            Action(
                "exclude_point",
                "E&xclude Point",
                self._exclude,
                at="semilandmarks.42",
                tip="Let the point chosen in the list take part, or not",
                button="Exclude",
                possible=lambda: self._point is not None,
            ),
        )

    @property
    def _tool(self) -> ViewTool | None:
        tools = (self.curve_tool, self.patch_tool)
        return next((tool for tool in tools if tool.is_active), None)

    def _chosen(self) -> str:
        name = self._editor.view.group
        return name if self._editor.session.group(name) is not None else ""

    def _draw_curve(self, on: bool) -> None:
        self.patch_tool.stop()
        if on:
            self.curve_tool.start()
        else:
            self.curve_tool.stop()

    def _add_patch(self) -> None:
        """Cover the whole surface, or ask for a side where there are closed curves."""
        self.curve_tool.stop()
        if self.patch_tool.is_active:
            self.patch_tool.stop()
        elif self.edits.closed_curves:
            self.patch_tool.start()
        else:
            self._fill(None)

    def _fill(self, place: tuple[float, float, float] | None) -> None:
        self.edits.add_patch(place, self._chosen(), self.patch_tool.stop)

    def _accept(self, chosen_only: bool) -> bool:
        """Accept the chosen curve; else the first that is a ghost."""
        name = self._chosen()
        if chosen_only:
            return bool(name) and self.edits.accept(name)
        return any(self.edits.accept(one.group.name) for one in self.shown.groups)

    def _offers(self) -> bool:
        return any(self.edits.can_accept(one.group.name) for one in self.shown.groups)

    def _remove(self) -> None:
        if self._chosen():
            self.edits.remove(self._chosen())

    def _rename(self, name: str, new_name: str) -> None:
        is_chosen = name == self._chosen()
        if self.edits.rename(name, new_name) and is_chosen:
            self._editor.look(group=new_name.strip())

    def _pin(self) -> None:
        if self._point is not None:
            pinned = self.edits.pin(*self._point)
            if pinned:
                self._editor.select(pinned)

    def _exclude(self) -> None:
        if self._point is not None:
            self.edits.exclude(*self._point)

    def frame_freed(self) -> None:
        """Look at the points without a counterpart, those of the chosen group if it has some."""
        chosen = self.shown.group(self._chosen())
        several = [chosen] if chosen is not None and chosen.freed else self.shown.groups
        targets = {
            side: np.vstack([places[one.is_freed] for one, places in pairs])
            for side, pairs in (
                (Side.SOURCE, [(one, one.source) for one in several]),
                (Side.DESTINATION, [(one, one.destination) for one in several]),
            )
        }
        there = {side: places for side, places in targets.items() if len(places)}
        if there:
            self._views.focus_on(there)

    # What changed

    def _on_session(self, *_changed: object) -> None:
        editor = self._editor
        if not editor.is_previewing:
            session = editor.session
            self._finders.keep_only(session.mesh(side) for side in Side)
            if editor.view.group and session.group(editor.view.group) is None:
                editor.look(group="")
            if self._point is not None:
                group = session.group(self._point[0])
                if group is None or self._point[1] >= group.count:
                    self._point = None
        asked = Asked.of(editor.session, self._warps.result)
        if asked == self._asked:
            return
        self._asked = asked
        if asked.groups:
            self._worker.request(asked)
        else:
            # Nothing to work out; and what may be under way is of no more use.
            self._on_shown(Shown(asked))

    def _on_shown(self, shown: Shown) -> None:
        if shown.groups and not self._asked.groups:
            return
        offered, self.shown = self._offers(), shown
        self._show()
        if self._offers() != offered:
            self._guidance.show()

    def _on_failure(self, error: Exception) -> None:
        self.shown = Shown(self._asked)
        self._show()
        raise error

    def _on_view(self, view: ViewState) -> None:
        if self._point is not None and view.group != self._point[0]:
            self._point = None
        self._show()

    def _on_point(self, name: str, number: int) -> None:
        self._point = (name, number) if name and number >= 0 else None
        self._show()

    def _on_tool(self) -> None:
        self._scenes.renew()
        self._guidance.show()
        for action in self.actions:
            action.renew()

    def _show(self) -> None:
        self._scenes.renew()
        if self._editor.is_previewing and self.shown.asked.groups:
            # Figures that run are not read: they follow when what moves is dropped.
            return
        self.panel.show_groups(self.shown, self._editor.rulers.session, self._chosen())
        self.note.setText(in_short(self.shown))
        self.note.setToolTip(why_not(self.shown))
        for action in self.actions:
            action.renew()

    # What is seen

    def drawables(self, side: Side) -> Iterator[Drawable]:
        """Return dots, curves, handles and slides, and what is being drawn."""
        session, view = self._editor.session, self._editor.view
        yield from self._pictures[side].of(session, view, self.shown, self._point)
        if side is Side.SOURCE and self._tool is not None:
            yield ToolWords(self._tool.words)
