"""User stories: semilandmarks along curves."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
import pytest
from qtpy.QtCore import QPoint, QPointF, Qt
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication
from tests.gui.drawing import (
    CTRL,
    DESTINATION,
    LEFT,
    PLAIN,
    SHIFT,
    SOURCE,
    choose,
    clear_spots,
    dots,
    drag_handle,
    draw,
    handles,
    lines,
    names,
    panel,
    part,
    ring,
)

from pinwarp.core.groups import Handle
from pinwarp.core.mesh import Mesh
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui.scene.drawables import DotKind, Slides, ToolWords
from pinwarp.gui.semilandmarks.model import NAME, POINTS
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.session import Session

ENTER, ESC, BACK = Qt.Key.Key_Return, Qt.Key.Key_Escape, Qt.Key.Key_Backspace


def said(user):
    return user.window.statusBar().currentMessage()


def undo_all(user):
    """Back to the first session by the key; return how many steps that were."""
    steps = 0
    while user.editor.undo_label is not None:
        user.press(Qt.Key.Key_Z, CTRL)
        steps += 1
    return steps


def redo_all(user):
    while user.editor.redo_label is not None:
        user.press(Qt.Key.Key_Z, CTRL | SHIFT)


def test_a_curve_is_drawn_click_by_click_and_seen_on_both_bones(user):
    user.open_sample()
    view = user.window.viewports[SOURCE]
    before = user.session
    anchor = before.landmark("midshaft_anterior").source
    first, second = clear_spots(user, 2, first=0.3, last=0.4)
    assert part(user).note.text() == ""
    user.press(Qt.Key.Key_C)
    assert view.drawn(ToolWords).words == "Click along a crest of the source"
    assert user.window.actions_by_key["draw_curve"].isChecked()
    assert "anchors the curve" in user.window.parts.guidance.hint.text()
    for at in (first, second):
        user.click(SOURCE, at)
    # Near a landmark the click is that landmark.
    user.click(SOURCE, user.place_of(SOURCE, anchor) + QPoint(5, 0))
    assert [stop.landmark for stop in part(user).curve_tool.stops] == ["", "", "midshaft_anterior"]
    assert user.session is before
    user.press(BACK)
    assert len(part(user).curve_tool.stops) == 2
    # The way follows the mouse.
    user.move_with(view, user.place_of(SOURCE, anchor).toPointF(), Qt.MouseButton.NoButton)
    user.settle()
    solid, ghost = lines(user, SOURCE)
    assert not solid.is_ghost
    assert ghost.is_ghost
    assert ghost.places[0] == pytest.approx(np.array(handles(user, SOURCE)[1].position), abs=1e-3)
    assert np.linalg.norm(ghost.places[-1] - anchor) < 1.0
    user.click(SOURCE, user.place_of(SOURCE, anchor))
    user.press(ENTER)
    (curve,) = user.session.groups
    assert [handle.landmark for handle in curve.handles] == ["", "", "midshaft_anterior"]
    assert (curve.name, curve.count, curve.is_closed) == ("curve_1", 20, False)
    assert user.editor.undo_label == "Draw curve_1"
    assert view.drawn(ToolWords) is None
    assert view.tool is None
    assert user.session.landmarks == before.landmarks
    # Seen: twenty dots on either bone, a solid line on the source, a dashed one where it is going.
    for side in (SOURCE, DESTINATION):
        assert len(dots(user, side).positions) == 20
        assert user.window.viewports[side].surface.closest(dots(user, side).positions[4])[1] < 0.1
    assert [line.is_ghost for line in lines(user, SOURCE)] == [False]
    assert [line.is_ghost for line in lines(user, DESTINATION)] == [True]
    # What is a landmark has no handle of its own.
    assert [handle.is_ghost for handle in handles(user, DESTINATION)] == [True, True]
    assert len(handles(user, SOURCE)) == 2
    assert part(user).note.text() == "20 semilandmarks"
    user.editor.look(hovered=None)
    assert "Space accepts the ghost" in user.window.parts.guidance.hint.text()
    # Nothing of it catches the mouse but the handles.
    user.editor.look(group="")
    user.click(DESTINATION, user.place_of(DESTINATION, dots(user, DESTINATION).positions[12]))
    assert len(user.session.landmarks) == len(before.landmarks) + 1
    user.press(Qt.Key.Key_Z, CTRL)
    # The figures that would not hold are not shown.
    penalty = user.window.parts.penalty.panel
    assert penalty.plot._hint == "With semilandmarks no penalty is suggested."
    assert "mm" in penalty.figures.left_out.text()
    user.trigger("map_distance")
    assert user.window.viewports[DESTINATION].map_legend.content.title.endswith("(fitted)")


def test_a_curve_closes_ends_by_a_double_click_and_is_left_by_esc(user):
    user.open_sample()
    view = user.window.viewports[SOURCE]
    _, around = ring(user, 6)
    draw(user, around, end=None)
    (closed,) = user.session.groups
    assert closed.is_closed
    assert len(closed.handles) == 6
    # The way leads back to where it begins.
    (line,) = lines(user, SOURCE)
    assert line.places[0] == pytest.approx(line.places[-1])
    places = clear_spots(user, 3, first=0.66, last=0.74)
    user.press(Qt.Key.Key_C)
    for at in places[:2]:
        user.click(SOURCE, at)
    # The same place twice is not taken.
    user.qtbot.wait(600)
    user.click(SOURCE, places[1])
    assert len(part(user).curve_tool.stops) == 2
    assert "there already" in said(user)
    QTest.mouseMove(view, places[2])
    QTest.mouseDClick(view, LEFT, PLAIN, places[2])
    user.settle()
    if part(user).curve_tool.is_active:
        # QTest sends the second press alone.
        user.qtbot.wait(600)
        user.click(SOURCE, places[2])
        QTest.mouseDClick(view, LEFT, PLAIN, places[2])
        user.settle()
    assert names(user) == ["curve_1", "curve_2"]
    assert not user.session.groups[1].is_closed
    # Left by Esc nothing is changed, and Esc selects nothing away.
    before = user.session
    user.editor.select("midshaft_anterior")
    user.press(Qt.Key.Key_C)
    user.press(ENTER)
    assert "at least two places" in said(user)
    user.click(SOURCE, places[0])
    user.click(DESTINATION, user.free_place(DESTINATION))
    assert "drawn on the source" in said(user)
    user.click(SOURCE, QPoint(3, 3))
    assert "beside the bone" in said(user)
    user.press(ESC)
    assert user.session is before
    assert user.editor.selection.names == ("midshaft_anterior",)
    assert view.tool is None
    # Drags still orbit while one draws.
    user.press(Qt.Key.Key_C)
    pose = view.camera.GetPosition()
    user.drag(view, QPoint(30, 200), QPoint(90, 200))
    assert view.camera.GetPosition() != pose
    user.press(Qt.Key.Key_C)
    assert not part(user).curve_tool.is_active


def test_space_accepts_the_chosen_curve_before_a_landmark_and_any_other_behind_it(user):
    user.open_sample()
    waiting = "lateral_epicondyle"
    user.editor.commit(edits.remove_side(user.session, waiting, DESTINATION), "Take away")
    user.settle()
    draw(user, clear_spots(user, 2, first=0.3, last=0.45))
    draw(user, clear_spots(user, 2, first=0.65, last=0.72))
    assert user.editor.view.group == "curve_2"
    user.press(Qt.Key.Key_Space)
    assert user.editor.undo_label == "Accept curve_2"
    assert [group.is_drawn for group in user.session.groups] == [False, True]
    assert [line.is_ghost for line in lines(user, DESTINATION)] == [True, False]
    # That one is drawn: the landmark comes next, then the curve that nobody chose.
    user.press(Qt.Key.Key_Space)
    assert user.editor.undo_label == f"Accept {waiting}"
    user.press(Qt.Key.Key_Space)
    assert user.editor.undo_label == "Accept curve_1"
    user.press(Qt.Key.Key_Space)
    assert "nothing to accept" in said(user)
    choose(user, "curve_1")
    user.trigger("undraw_curve")
    assert user.editor.undo_label == "Undraw curve_1"
    assert [line.is_ghost for line in lines(user, DESTINATION)] == [True, False]


def test_a_dragged_handle_draws_the_curve_and_esc_puts_it_back(user):
    user.open_sample()
    draw(user, clear_spots(user, 3, first=0.3, last=0.45))
    before = user.session
    slides = user.window.parts.warps.solver.slider.slides
    drag_handle(user, DESTINATION, 1, QPoint(6, 4), release=False)
    assert user.editor.is_previewing
    assert user.window.parts.warps.solver.slider.slides == slides
    user.press(ESC, widget=user.window.viewports[DESTINATION])
    QTest.mouseRelease(user.window.viewports[DESTINATION], LEFT, PLAIN, QPoint(5, 5))
    assert user.session == before
    handle = drag_handle(user, DESTINATION, 1, QPoint(6, 4))
    (curve,) = user.session.groups
    assert curve.is_drawn
    assert user.editor.undo_label == "Draw curve_1 on the destination"
    assert np.linalg.norm(np.subtract(curve.handles[1].destination, handle.position)) > 1
    assert user.window.parts.warps.solver.slider.slides == slides + 1
    # Its points slide on the way that was drawn.
    (line,) = lines(user, DESTINATION)
    assert not line.is_ghost
    finder = user.window.parts.warps.solver.slider.finders.of(
        DESTINATION, user.session.mesh(DESTINATION)
    )
    path = finder.through(curve.places(DESTINATION))
    places = dots(user, DESTINATION).positions
    assert np.abs(path.closest(places)[0] - places).max() < 0.02
    # The next drag is a move, on either side; several of one handle are several steps.
    drag_handle(user, DESTINATION, 1, QPoint(-7, 0))
    assert user.editor.undo_label == "Move handle of curve_1"
    was = user.session.groups[0].handles[2].source
    drag_handle(user, SOURCE, 2, QPoint(0, 12))
    assert user.session.groups[0].handles[2].source != was
    # Dropped on a landmark it is that landmark.
    name = "midshaft_anterior"
    mark = user.place_of(SOURCE, user.session.landmark(name).source)
    start = user.place_of(SOURCE, user.session.groups[0].handles[2].source)
    user.drag(user.window.viewports[SOURCE], start, mark + QPoint(3, 0))
    assert user.session.groups[0].handles[2] == Handle(
        user.session.landmark(name).source, user.session.landmark(name).destination, name
    )
    # Then the handle goes where the landmark goes.
    user.drag(user.window.viewports[SOURCE], mark, mark + QPoint(0, 9))
    assert user.session.groups[0].handles[2].source == user.session.landmark(name).source
    assert user.editor.undo_label == f"Move {name}"
    # All of them back, and forth again.
    end = user.session
    user.press(Qt.Key.Key_L)
    drag_handle(user, DESTINATION, 1, QPoint(8, 0))
    assert user.session == end
    assert undo_all(user) == 6
    assert user.session.groups == ()
    assert dots(user, SOURCE) is None
    assert lines(user, SOURCE) == ()
    redo_all(user)
    assert user.session == end
    assert len(dots(user, DESTINATION).positions) == 20


def test_counts_names_and_points_are_changed_in_the_list_and_come_back_from_a_file(user, tmp_path):
    user.open_sample()
    draw(user, clear_spots(user, 3, first=0.3, last=0.45))
    draw(user, ring(user, 5, height=0.6)[1], end=None)
    choose(user, "curve_1")
    assert panel(user).spin.value() == 20
    panel(user).spin.setFocus()
    panel(user).spin.selectAll()
    QTest.keyClicks(panel(user).spin, "31")
    QTest.keyClick(panel(user).spin, ENTER)
    user.settle()
    assert user.session.groups[0].count == 31
    # Dragging the slider is one step to undo.
    slider = panel(user).slider
    slider.setFocus()
    for _ in range(5):
        QTest.keyClick(slider, Qt.Key.Key_Right)
    user.settle()
    assert user.session.groups[0].count == 36
    user.press(Qt.Key.Key_Z, CTRL)
    assert user.session.groups[0].count == 20
    redo_all(user)
    # Typed in the list.
    tree, model = panel(user).tree, panel(user).model
    for column, text in ((POINTS, "12"), (NAME, "linea")):
        tree.setFocus()
        tree.setCurrentIndex(model.index(0, column))
        QTest.keyClick(tree, Qt.Key.Key_F2)
        editor = QApplication.focusWidget()
        assert editor is not tree
        editor.selectAll()
        QTest.keyClicks(editor, text)
        QTest.keyClick(editor, ENTER)
        user.settle()
    assert (user.session.groups[0].name, user.session.groups[0].count) == ("linea", 12)
    assert user.editor.view.group == "linea"
    # A point takes no part, then is pinned.
    choose(user, "linea", 3)
    kinds = dots(user, SOURCE).kinds
    assert list(kinds[:12]).count(DotKind.CHOSEN) == 1
    user.trigger("exclude_point")
    assert user.session.groups[0].excluded == {3}
    assert part(user).note.text() == "31 semilandmarks"
    user.trigger("exclude_point")
    choose(user, "linea", 5)
    place = dots(user, DESTINATION).positions[5]
    user.trigger("pin_point")
    pinned = user.session.landmark("linea_6")
    assert np.array(pinned.destination) == pytest.approx(place)
    assert user.session.groups[0].excluded == {5}
    assert user.editor.selection.names == ("linea_6",)
    # Saved and opened again all is as it was.
    end, rest = user.session, dots(user, DESTINATION).positions
    user.dialogs.saves = [tmp_path / "curves.pinwarp.csv"]
    user.trigger("save_as")
    undo_all(user)
    assert names(user) == []
    user.dialogs.opens = [tmp_path / "curves.pinwarp.csv"]
    user.trigger("open_session")
    assert user.session.groups == end.groups
    assert dots(user, DESTINATION).positions == pytest.approx(rest, abs=1e-6)
    choose(user, "curve_2")
    QTest.keyClick(panel(user).tree, Qt.Key.Key_Delete)
    user.settle()
    assert names(user) == ["linea"]
    assert user.editor.undo_label == "Remove curve_2"
    assert user.editor.view.group == ""


def test_dots_follow_a_landmark_and_slide_again_when_it_is_dropped(user):
    user.open_sample()
    draw(user, clear_spots(user, 3, first=0.3, last=0.45))
    user.press(Qt.Key.Key_C, SHIFT)
    assert [group.count for group in user.session.groups] == [20, 300]
    slider = user.window.parts.warps.solver.slider
    rest, slides = dots(user, DESTINATION).positions, slider.slides
    user.drag_a_landmark(release=False)
    assert user.editor.is_previewing
    moved = dots(user, DESTINATION).positions
    assert np.linalg.norm(moved - rest, axis=1).max() > 1
    assert slider.slides == slides
    view = user.window.viewports[DESTINATION]
    QTest.mouseRelease(view, LEFT, PLAIN, QPoint(100, 100))
    user.settle()
    assert slider.slides == slides + 1
    off = [view.surface.closest(place)[1] for place in dots(user, DESTINATION).positions]
    assert max(off) < 0.1
    # A frame of the drag solves for the landmarks and all that slides.
    solver = user.window.parts.warps.solver
    landmark = user.session.pairs[3]
    inputs = []
    for step in range(6):
        place = tuple(np.add(landmark.destination, 0.2 * step))
        session = edits.move(user.session, landmark.name, DESTINATION, place)
        inputs.append(type(user.window.parts.warps.result.inputs).of(session))
    begin = time.process_time()
    for one in inputs:
        solver.solve_landmarks(one, moving=True)
    assert (time.process_time() - begin) / len(inputs) < 0.04
    # How far they slid is shown on demand.
    assert view.drawn(Slides) is None
    user.press(Qt.Key.Key_A, SHIFT)
    assert len(view.drawn(Slides).starts) == 320
    user.press(Qt.Key.Key_A, SHIFT)
    assert view.drawn(Slides) is None


def test_what_does_not_slide_says_why(user):
    user.open_sample()
    draw(user, clear_spots(user, 3, first=0.3, last=0.45))
    assert panel(user).problem.text() == ""
    few = [mark.name for mark in user.session.landmarks][3:]
    user.editor.commit(edits.remove(user.session, few), "Remove")
    user.settle()
    assert "from 4 on" in panel(user).problem.text()
    assert panel(user).problem.isVisibleTo(panel(user))
    assert part(user).note.text() == "20 semilandmarks, not sliding"
    assert len(dots(user, SOURCE).positions) == 20
    assert dots(user, DESTINATION) is None
    # With no pair at all it says so, too.
    user.editor.commit(edits.remove(user.session, [x.name for x in user.session.landmarks]), "All")
    user.settle()
    assert "no pairs" in panel(user).problem.text()
    user.press(Qt.Key.Key_Z, CTRL)
    user.press(Qt.Key.Key_Z, CTRL)
    assert panel(user).problem.text() == ""
    session = edits.set_penalty(user.session, 5.0)
    session = edits.set_convention(session, PenaltyConvention.OPYNSIM)
    user.editor.commit(session, "Change penalty convention")
    user.settle()
    assert "regularising convention" in panel(user).problem.text()


def test_points_without_a_counterpart_are_hollow_counted_and_framed(user):
    user.open_sample()
    draw(user, clear_spots(user, 3, first=0.3, last=0.45))
    user.press(Qt.Key.Key_C, SHIFT)
    # The destination was scanned down to its middle only.
    file = user.session.mesh_file(DESTINATION)
    mesh = file.mesh
    up = int(np.argmax(np.ptp(mesh.vertices, axis=0)))
    kept = mesh.vertices[mesh.faces][:, :, up].mean(axis=1) > np.median(mesh.vertices[:, up])
    half = replace(file, mesh=Mesh(mesh.vertices, mesh.faces[kept]))
    user.editor.commit(user.session.with_mesh(DESTINATION, half), "Open half a bone")
    user.settle()
    freed = int((dots(user, SOURCE).kinds == DotKind.FREED).sum())
    assert 50 < freed < 300
    assert freed == int((dots(user, DESTINATION).kinds == DotKind.FREED).sum())
    assert f"{freed} of 300 have no counterpart" in panel(user).freed.text()
    assert part(user).note.text() == f"320 semilandmarks, {freed} without counterpart"
    view = user.window.viewports[DESTINATION]
    before = view.camera.GetFocalPoint()
    panel(user).parentWidget().raise_()
    user.qtbot.mouseClick(panel(user).frame, LEFT)
    user.settle()
    assert view.camera.GetFocalPoint() != before
    lost = dots(user, DESTINATION).positions[dots(user, DESTINATION).kinds == DotKind.FREED]
    assert np.allclose(view.camera.GetFocalPoint(), lost.mean(axis=0), atol=5)


def test_nothing_is_left_of_a_drawing_when_its_bone_goes(user):
    user.open_sample()
    places = clear_spots(user, 3, first=0.3, last=0.45)

    def begin():
        user.press(Qt.Key.Key_C)
        for at in places[:2]:
            user.click(SOURCE, at)
        assert len(part(user).curve_tool.stops) == 2

    begin()
    user.editor.commit(user.session.with_mesh(SOURCE, None), "Remove the source")
    user.settle()
    assert user.window.viewports[SOURCE].tool is None
    assert "is gone" in said(user)
    user.press(Qt.Key.Key_C)
    assert not part(user).curve_tool.is_active
    user.press(Qt.Key.Key_Z, CTRL)
    # A landmark that a place is anchored to goes; the place stays.
    user.press(Qt.Key.Key_C)
    anchor = user.session.landmark("midshaft_anterior").source
    user.click(SOURCE, places[0])
    user.click(SOURCE, user.place_of(SOURCE, anchor))
    user.editor.commit(edits.remove(user.session, ["midshaft_anterior"]), "Remove")
    user.settle()
    assert [stop.landmark for stop in part(user).curve_tool.stops] == ["", ""]
    # What is typed into a field is the field's.
    line = user.window.parts.table.panel.filter
    line.setFocus()
    QTest.keyClicks(line, "ab")
    QTest.keyClick(line, BACK)
    assert line.text() == "a"
    assert len(part(user).curve_tool.stops) == 2
    # Another session: nothing of the drawing is in it.
    user.window.parts.documents.open_session(sample_session())
    user.settle()
    assert user.window.viewports[SOURCE].tool is None
    assert names(user) == []
    begin()
    # The window is closed while the last way is still looked for.
    QTest.mouseMove(user.window.viewports[SOURCE], places[2])
    QTest.mouseClick(user.window.viewports[SOURCE], LEFT, PLAIN, places[2])


def test_a_place_on_another_part_of_the_mesh_is_not_taken(user):
    user.open_sample()
    file = user.session.mesh_file(SOURCE)
    mesh = file.mesh
    up = int(np.argmax(np.ptp(mesh.vertices, axis=0)))
    heights = mesh.vertices[mesh.faces][:, :, up]
    middle = np.median(mesh.vertices[:, up])
    apart = ((heights > middle + 8).all(axis=1)) | ((heights < middle - 8).all(axis=1))
    torn = replace(file, mesh=Mesh(mesh.vertices, mesh.faces[apart]))
    user.editor.replace_all(Session(source=torn), None)
    user.settle()
    top, low = clear_spots(user, 2, first=0.25, last=0.75)
    user.press(Qt.Key.Key_C)
    user.click(SOURCE, top)
    user.click(SOURCE, low)
    assert "two parts of the mesh" in said(user)
    assert len(part(user).curve_tool.stops) == 1
    user.press(ESC)
    assert panel(user).tree.model().rowCount() == 0
    assert "C draws a curve" in panel(user).tree.empty_words
    view = user.window.viewports[SOURCE]
    assert view.pick(QPointF(top)) is not None
