"""User stories: finding out which pairs to trust."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from qtpy.QtCore import QEvent, QPoint, QPointF, Qt
from qtpy.QtGui import QColor, QHelpEvent, QImage, QPainter
from qtpy.QtTest import QTest
from qtpy.QtWidgets import QApplication, QToolTip
from tests.core.femur import femur_landmarks
from tests.gui.test_landmark_table import NO_KEY, SHIFT, TableUser

from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.spline import factorise, solve
from pinwarp.gui.painted.arrows import paint_arrow
from pinwarp.gui.scene.drawables import Arrows
from pinwarp.gui.style import theme
from pinwarp.gui.table.columns import column_number
from pinwarp.gui.table.model import SHARE
from pinwarp.session import edits
from pinwarp.session.judging.quality import NamedFinding

OFF = "fovea_capitis"
SWAPPED = {"lateral_epicondyle", "medial_condyle_posterior"}
LEFT = Qt.MouseButton.LeftButton


class Judge(TableUser):
    """Looks at the table and the list below it."""

    @property
    def findings(self):
        return self.window.parts.findings.panel

    def said_by(self, row):
        return row.sentence.text().replace("\u200b", "")

    def click_on(self, widget):
        QTest.mouseClick(widget, LEFT, NO_KEY, widget.rect().center())
        self.user.settle()

    def text(self, name, key):
        return self.table.index_of(name, column_number(key)).data()

    def tip(self, name, key="left_out"):
        """What a mouse that rests on a cell is told."""
        at = self.cell(name, key).center()
        viewport = self.table.viewport()
        event = QHelpEvent(QEvent.Type.ToolTip, at, viewport.mapToGlobal(at))
        QApplication.sendEvent(viewport, event)
        return QToolTip.text()

    @property
    def layer(self):
        return self.window.viewports[Side.DESTINATION].layer

    @property
    def all_arrows(self):
        shown = self.window.viewports[Side.DESTINATION].drawn(Arrows)
        return shown.arrows if shown is not None else ()

    def arrows(self, left_out):
        return {arrow.name: arrow for arrow in self.all_arrows if arrow.left_out is left_out}


@pytest.fixture
def sample(user):
    user.open_sample()
    return Judge(user)


@pytest.fixture
def swapped(sample):
    session = edits.swap_destinations(sample.session, *sorted(SWAPPED))
    sample.user.editor.replace_all(session, None)
    sample.user.settle()
    return sample


@pytest.fixture
def displaced(sample):
    """The sample with a landmark placed far from where it belongs."""
    mark = sample.session.landmark(OFF)
    x, y, z = mark.destination
    session = edits.move(sample.session, OFF, Side.DESTINATION, (x, y, z + 60))
    sample.user.editor.replace_all(session, None)
    sample.user.settle()
    return sample


@pytest.fixture
def femur(user, shared_data):
    """The real femur, in millimetres, with the landmarks that came with it."""
    names, source, destination = femur_landmarks(shared_data)
    landmarks = [
        Landmark(name, as_position(a), as_position(b))
        for name, a, b in zip(names, source, destination, strict=True)
    ]
    user.editor.replace_all(edits.import_pairs(user.session, landmarks), None)
    user.settle()
    return Judge(user)


# The table


def test_the_table_sorts_by_what_the_others_say_and_draws_it_as_bars(swapped):
    swapped.click_header("left_out")
    swapped.click_header("left_out")
    assert set(swapped.shown()[:2]) == SWAPPED
    shares = [
        swapped.table.index_of(name, column_number("left_out")).data(SHARE)
        for name in swapped.shown()[:16]
    ]
    assert shares[0] == 1
    assert shares == sorted(shares, reverse=True)
    assert 0 < shares[-1] < 0.1

    def bar_at(name, key, share):
        room = swapped.cell(name, key)
        picture = swapped.table.viewport().grab().toImage()
        ratio = picture.devicePixelRatio()
        x = room.left() + 5 + share * (room.width() - 10)
        colour = picture.pixelColor(QPointF(x * ratio, (room.top() + 5) * ratio).toPoint())
        return colour.blue() - colour.red() > 20

    first, last = swapped.shown()[0], swapped.shown()[15]
    assert bar_at(first, "left_out", 0.99)
    assert not bar_at(last, "left_out", 0.5)
    assert not bar_at(first, "residual", 0.0), "0 has no bar"


def test_left_out_is_what_a_solve_without_the_pair_misses(sample):
    pairs = sample.session.pairs
    source = np.array([pair.source for pair in pairs])
    destination = np.array([pair.destination for pair in pairs])
    others = solve(factorise(source[1:]), destination[1:])
    missed = np.linalg.norm(others.evaluate(source[:1])[0] - destination[0])
    assert sample.text(pairs[0].name, "left_out") == f"{missed:.3g}"
    assert f"{missed:.3g} mm from where the other pairs expect it" in sample.tip(pairs[0].name)


def test_suspect_and_isolated_filter_the_table(swapped, qtbot):
    QTest.keyClicks(swapped.panel.filter, "suspect")
    assert set(swapped.shown()) == SWAPPED
    assert swapped.panel.count.text() == "2 of 20"
    swapped.click_on(swapped.findings.rows[0].remedy)
    assert swapped.shown() == []
    swapped.user.trigger("undo")
    assert set(swapped.shown()) == SWAPPED


def test_signs_tell_their_reason_and_leave_with_it(swapped):
    name = sorted(SWAPPED)[0]
    decoration = Qt.ItemDataRole.DecorationRole
    sign = swapped.table.index_of(name, column_number("left_out"))
    assert sign.data(decoration) is not None
    assert "look swapped" in swapped.tip(name)
    assert (
        swapped.table.index_of("fovea_capitis", column_number("left_out")).data(decoration) is None
    )
    swapped.click_on(swapped.findings.rows[0].remedy)
    assert swapped.table.index_of(name, column_number("left_out")).data(decoration) is None
    assert "look swapped" not in swapped.tip(name)


def test_the_names_stay_readable_in_the_dock_as_it_opens(sample):
    header, metrics = sample.table.horizontalHeader(), sample.table.fontMetrics()
    assert sample.table.width() <= 450
    assert header.length() <= sample.table.viewport().width(), "nothing is scrolled aside"
    assert header.sectionSize(0) >= metrics.horizontalAdvance("lesser_trochanter_tip") + 45


# The list


def test_a_swap_is_named_repaired_by_one_click_and_brought_back_by_undo(swapped):
    row, fold = swapped.findings.rows
    assert swapped.findings.header.text() == "2 to check"
    assert fold.found.finding.kind is FindingKind.FOLD, "which the swap makes"
    assert set(row.found.names) == SWAPPED
    assert all(name in swapped.said_by(row) for name in SWAPPED)
    before = swapped.session
    swapped.click_on(row.remedy)
    assert swapped.findings.isHidden()
    assert swapped.user.editor.undo_label.startswith("Swap ")
    swapped.user.trigger("undo")
    assert swapped.session == before
    assert set(swapped.findings.rows[0].found.names) == SWAPPED


def test_a_second_click_does_not_swap_back(swapped):
    row, _fold = swapped.findings.rows
    for _ in range(2):
        # At once, before the pairs are judged anew.
        QTest.mouseClick(row.remedy, LEFT, NO_KEY, row.remedy.rect().center())
    swapped.user.settle()
    assert swapped.findings.isHidden()
    swapped.user.trigger("undo")
    assert swapped.user.editor.undo_label is None


def test_locked_landmarks_are_not_swapped(swapped):
    name = sorted(SWAPPED)[0]
    swapped.click(name, "locked")
    before = swapped.session
    swapped.click_on(swapped.findings.rows[0].remedy)
    assert swapped.session == before
    assert swapped.said() == f"{name} is locked: unlock it in the table."


def test_a_click_on_a_finding_selects_its_landmarks_and_looks_at_them(swapped):
    swapped.panel.filter.setText("fovea")
    swapped.click_on(swapped.findings.rows[0].sentence)
    assert set(swapped.selected()) == SWAPPED
    assert swapped.panel.filter.text() == "", "the filter hid them"
    for side, viewport in swapped.window.viewports.items():
        places = [swapped.session.landmark(name).position(side) for name in SWAPPED]
        middle = viewport.project(np.mean(places, axis=0)[None])[0]
        centre = viewport.rect().center()
        assert np.hypot(*(middle - [centre.x(), centre.y()])) < 3


def test_keys_go_through_the_findings_and_to_their_buttons(femur):
    femur.press(Qt.Key.Key_N, SHIFT)
    first = QApplication.focusWidget()
    assert first is femur.findings.rows[0]
    assert femur.selected() == first.found.names
    QTest.keyClick(first, Qt.Key.Key_Down)
    second = QApplication.focusWidget()
    assert second is femur.findings.rows[1]
    QTest.keyClick(second, Qt.Key.Key_Return)
    (name,) = second.found.names
    assert femur.selected() == (name,)
    assert {*first.found.names, name} == {"landmark_9", "landmark_12"}
    QTest.keyClick(second, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is second.remedy
    QTest.keyClick(second.remedy, Qt.Key.Key_Tab)
    assert QApplication.focusWidget() is second.disable
    QTest.keyClick(second.disable, Qt.Key.Key_Space)
    femur.user.settle()
    femur.undo(f"Disable {name}")


def test_on_the_real_femur_nothing_is_wrong_two_are_worth_a_look_and_some_isolated(femur):
    rows = femur.findings.rows
    looks, isolated = rows[:2], rows[2:]
    assert {row.found.names[0] for row in looks} == {"landmark_9", "landmark_12"}
    assert all("from where the other pairs expect it" in femur.said_by(row) for row in looks)
    assert all(row.remedy.text() == "Re-place" and row.disable.isVisible() for row in looks)
    assert all(row.found.finding.kind is FindingKind.ISOLATED for row in isolated)
    assert "landmark_18" in [row.found.names[0] for row in isolated]
    assert all(row.disable.isHidden() and row.remedy.isHidden() for row in isolated)
    header = femur.findings.header
    assert header.text() == f"2 worth a look, {len(isolated)} isolated"
    assert not header.font().bold(), "there is nothing wrong"
    femur.panel.filter.setText("isolated")
    assert "landmark_18" in femur.shown()
    femur.panel.filter.setText("suspect")
    assert femur.shown() == []
    femur.panel.filter.setText("worth")
    assert set(femur.shown()) == {"landmark_9", "landmark_12"}


# What is displaced


def test_a_displaced_landmark_is_named_and_can_be_disabled(displaced):
    row = displaced.findings.rows[0]
    assert (row.found.finding.kind, row.found.names) == (FindingKind.DISPLACED, (OFF,))
    assert "mm from where the other pairs expect it; " in displaced.said_by(row)
    assert "without a mistake shows as much about once in 1,000" in displaced.tip(OFF)
    precise = [replace(x, destination_spread=0.5) for x in displaced.session.landmarks]
    displaced.user.editor.commit(replace(displaced.session, landmarks=tuple(precise)), "Keep")
    displaced.user.settle()
    off = row.found.finding.others[0]
    assert f" expect it, {off / 0.5:.0f} times its own spread; " in displaced.said_by(row)
    displaced.user.trigger("remove_spreads")
    displaced.user.settle()
    assert "times its own spread" not in displaced.said_by(row)
    displaced.click_on(row.disable)
    assert not displaced.session.landmark(OFF).enabled
    assert displaced.findings.isHidden()
    displaced.undo(f"Disable {OFF}")


def test_re_place_selects_the_landmark_and_shows_where_the_others_expect_it(displaced):
    displaced.user.editor.look(arrows=False)
    before = displaced.session
    displaced.click_on(displaced.findings.rows[0].remedy)
    assert displaced.selected() == (OFF,)
    assert displaced.user.editor.selection.side is Side.DESTINATION
    (arrow,) = displaced.arrows(left_out=True).values()
    there = displaced.window.viewports[Side.DESTINATION]
    for place in (arrow.start, arrow.end):
        x, y = there.project(np.array([place]))[0]
        assert there.rect().contains(QPoint(round(x), round(y))), "both ends are in sight"
    assert f"where the other pairs expect {OFF}" in displaced.said()
    assert displaced.session == before, "nothing is moved but by the hand"


def test_of_two_that_may_be_wrong_one_is_chosen_from_a_menu(displaced):
    panel, names = displaced.findings, (OFF, "lateral_epicondyle")
    rows = [[x.name for x in displaced.session.pairs].index(name) for name in names]
    finding = Finding(FindingKind.EITHER, tuple(rows), 0.01, (30.0, 4.0))
    panel.show_findings([NamedFinding(finding, names, finding.describe())])
    row = panel.rows[0]
    assert [a.text() for a in row.choice.actions()] == list(names), "not both"
    QTest.mousePress(row.remedy, LEFT, NO_KEY, row.remedy.rect().center())
    displaced.choose(row.which, names[1])
    assert displaced.selected() == (names[1],)
    QTest.mousePress(row.disable, LEFT, NO_KEY, row.disable.rect().center())
    displaced.choose(row.choice, OFF)
    assert not displaced.session.landmark(OFF).enabled
    assert displaced.session.landmark(names[1]).enabled


def test_in_a_drag_the_figures_follow_and_the_list_waits_for_the_hand(displaced):
    editor = displaced.user.editor
    before = displaced.text(OFF, "left_out")
    (row,) = [x for x in displaced.findings.rows if x.found.names == (OFF,)]
    x, y, z = displaced.session.landmark(OFF).destination
    editor.preview(edits.move(editor.committed, OFF, Side.DESTINATION, (x, y, z - 60)))
    displaced.user.settle()
    assert displaced.text(OFF, "left_out") != before
    assert row.found.finding.kind is FindingKind.DISPLACED
    editor.commit(editor.session, "Move")
    displaced.user.settle()
    assert displaced.findings.isHidden()


def test_many_findings_scroll_in_a_third_of_the_dock(femur):
    session = femur.session
    for i in range(24):
        source = (300.0 + i, 500.0, 80.0 * i)
        near = (source[0], source[1] + 0.001, source[2])
        pairs = [
            Landmark(f"close_{i}_{'long_' * 12}", source, source),
            Landmark(f"near_{i}", near, (near[0], near[1] + 5, near[2])),
        ]
        session = edits.import_pairs(session, pairs)
    femur.user.editor.replace_all(session, None)
    femur.user.settle()
    findings = femur.findings
    assert len(findings.rows) > 12
    assert findings.height() <= femur.panel.height() // 3
    bar = findings.scroll.verticalScrollBar()
    assert bar.maximum() > 0
    for row in findings.rows:
        # Neither below nor beside is anything cut off.
        assert row.sentence.height() >= row.sentence.heightForWidth(row.sentence.width())
        assert row.geometry().right() <= findings.scroll.viewport().width()
    QTest.mouseClick(findings.header, LEFT, NO_KEY, QPoint(20, 8))
    assert findings.scroll.isHidden()
    QTest.mouseClick(findings.header, LEFT, NO_KEY, QPoint(20, 8))
    assert findings.scroll.isVisible()


def test_a_mirrored_source_is_mirrored_back_by_one_click(sample):
    before = sample.session
    sample.user.trigger("mirror_x")
    (row,) = sample.findings.rows
    assert row.remedy.text() == "Mirror Across X"
    sample.click_on(row.remedy)
    assert sample.findings.isHidden()
    for mark in before.landmarks:
        assert sample.session.landmark(mark.name).source == pytest.approx(mark.source)


def test_findings_keep_their_names_when_landmarks_are_renamed_and_the_list_is_live(swapped):
    name = sorted(SWAPPED)[0]
    swapped.user.editor.commit(edits.rename(swapped.session, name, "renamed"), "Rename")
    assert "renamed" in swapped.findings.rows[0].found.names
    assert "renamed" in swapped.said_by(swapped.findings.rows[0])


# Swapping by hand


def test_two_selected_pairs_are_swapped_from_the_row_menu(sample):
    action = sample.window.actions_by_key["swap_destinations"]
    sample.click("fovea_capitis")
    assert not action.isEnabled()
    sample.click("lateral_epicondyle", modifier=Qt.KeyboardModifier.ControlModifier)
    assert action.isEnabled()
    before = sample.session
    sample.table.customContextMenuRequested.emit(sample.cell("fovea_capitis").center())
    sample.choose(sample.panel.row_menu, "Swap Destinations")
    there = before.landmark("lateral_epicondyle").destination
    assert sample.session.landmark("fovea_capitis").destination == there
    sample.undo("Swap fovea_capitis and lateral_epicondyle")
    assert sample.session == before
    sample.click("gluteus_medius_insertion", modifier=Qt.KeyboardModifier.ControlModifier)
    assert not action.isEnabled()
    sample.click("fovea_capitis")
    sample.click("gluteus_medius_insertion", modifier=Qt.KeyboardModifier.ControlModifier)
    assert not action.isEnabled(), "a passenger has no destination"


# Arrows


def slide_halfway(judge, release=True):
    slider = judge.window.parts.penalty.panel.slider
    start = QPoint(8, slider.height() // 2)
    judge.user.drag(slider, start, slider.rect().center(), release=release)


def test_arrows_grow_with_the_penalty_and_are_not_there_at_0(sample):
    assert sample.all_arrows == ()
    slide_halfway(sample, release=False)
    assert sample.user.editor.is_previewing
    arrows = sample.arrows(left_out=False)
    assert set(arrows) == {pair.name for pair in sample.session.pairs}
    lengths = [np.linalg.norm(np.subtract(a.start, a.end)) for a in arrows.values()]
    residuals = sample.window.parts.warps.result.residuals
    assert lengths == pytest.approx(residuals.tolist())
    QTest.mouseRelease(sample.window.parts.penalty.panel.slider, LEFT)
    sample.user.trigger("undo")
    assert sample.all_arrows == ()


def test_arrows_are_painted_over_the_destination_and_can_be_switched_off(swapped):
    slide_halfway(swapped)
    viewport = swapped.window.viewports[Side.DESTINATION]

    def pictures():
        for _ in range(2):
            picture = QImage(swapped.layer.size(), QImage.Format.Format_ARGB32)
            picture.fill(Qt.GlobalColor.transparent)
            swapped.layer.render(picture)
            yield picture
            swapped.user.press(Qt.Key.Key_A)

    with_arrows, without = pictures()
    assert (
        not swapped.window.actions_by_key["arrows"].isChecked() or swapped.user.editor.view.arrows
    )
    arrow = swapped.arrows(left_out=False)[sorted(SWAPPED)[0]]
    start, end = viewport.project(np.array([arrow.start, arrow.end]))
    assert np.hypot(*(end - start)) > 20
    x, y = ((start + end) / 2).round().astype(int).tolist()
    near = [(x + i, y + j) for i in range(-3, 4) for j in range(-3, 4)]
    assert any(with_arrows.pixelColor(*at) != without.pixelColor(*at) for at in near)


def test_the_selected_landmark_shows_where_the_others_expect_it(swapped):
    name = sorted(SWAPPED)[0]
    swapped.click(name)
    (arrow,) = swapped.arrows(left_out=True).values()
    pairs = [pair for pair in swapped.session.pairs if pair.name != name]
    others = solve(factorise([pair.source for pair in pairs]), [pair.destination for pair in pairs])
    mark = swapped.session.landmark(name)
    assert arrow.start == pytest.approx(others.evaluate([mark.source])[0].tolist())
    assert arrow.end == mark.destination
    swapped.press(Qt.Key.Key_Escape)
    assert swapped.arrows(left_out=True) == {}


def test_both_arrows_follow_a_landmark_that_is_dragged(sample):
    slide_halfway(sample)
    viewport = sample.window.viewports[Side.DESTINATION]
    marker = next(
        marker
        for marker, hidden in zip(sample.layer.markers, sample.layer.hidden(), strict=True)
        if marker.movable and not hidden
    )
    start = sample.user.place_of(Side.DESTINATION, marker.position)
    sample.user.drag(viewport, start, start + QPoint(0, 25), release=False)
    assert sample.user.editor.is_previewing
    here = sample.session.landmark(marker.name).destination
    assert here != marker.position
    for left_out in (False, True):
        arrow = sample.arrows(left_out)[marker.name]
        assert arrow.end == here
    residual = np.linalg.norm(np.subtract(sample.arrows(False)[marker.name].start, here))
    row = [pair.name for pair in sample.session.pairs].index(marker.name)
    assert residual == pytest.approx(sample.window.parts.warps.result.residuals[row])
    QTest.keyClick(viewport, Qt.Key.Key_Escape)
    sample.user.settle()
    assert sample.session.landmark(marker.name).destination == marker.position


def test_an_arrow_is_thin_and_ends_before_the_sign():
    def painted(length, left_out=False):
        picture = QImage(100, 40, QImage.Format.Format_ARGB32)
        picture.fill(QColor("grey"))
        painter = QPainter(picture)
        seen = paint_arrow(
            painter, QPointF(90 - length, 20), QPointF(90, 20), 6.0, left_out=left_out
        )
        painter.end()
        touched = [
            (x, y)
            for x in range(100)
            for y in range(40)
            if picture.pixelColor(x, y) != QColor("grey")
        ]
        return seen, touched, picture

    assert painted(8)[:2] == (False, [])
    seen, touched, picture = painted(70)
    assert seen
    assert max(x for x, _ in touched) <= 86
    assert max(y for _, y in touched) - min(y for _, y in touched) <= 10
    assert picture.pixelColor(50, 20) == QColor(theme.ARROW_COLOUR)
    dashes = {painted(70, left_out=True)[2].pixelColor(x, 20).name() for x in range(30, 70)}
    assert len(dashes) > 1, "dashed"


def crowd_of(sample, places):
    """Bring in pairs with source places that repeat, and ends that disagree."""
    ends = places + np.random.default_rng(1).normal(size=places.shape)
    marks = tuple(
        Landmark(f"q{i}", as_position(a), as_position(b))
        for i, (a, b) in enumerate(zip(places, ends, strict=True))
    )
    editor = sample.user.editor
    editor.commit(edits.import_pairs(editor.committed, marks), "Import")
    sample.user.settle()


def test_of_many_findings_the_gravest_are_shown_and_the_rest_is_counted(sample):
    crowd_of(sample, np.repeat(60 * np.random.default_rng(0).normal(size=(60, 3)), 2, axis=0))
    panel = sample.findings
    assert sum(row.isVisibleTo(panel) for row in panel.rows) == 50
    assert panel.more.isVisibleTo(panel)
    told = int(panel.more.text().split()[1])
    assert told >= 10
    assert sum(int(words.split()[0]) for words in panel.header.text().split(", ")) == 50 + told
    # Beyond the rows there are still findings to step to.
    for _ in range(52):
        sample.window.actions_by_key["next_finding"].trigger()
    sample.user.editor.undo()
    sample.user.settle()
    assert not panel.more.isVisibleTo(panel)


def test_many_pairs_at_one_place_are_one_row(sample):
    crowd_of(sample, np.tile(np.random.default_rng(0).normal(size=3), (200, 1)))
    found = [x for x in sample.findings.rows if "same place" in sample.said_by(x)]
    assert len(found) == 1
    assert "q0, q1, q2 and 197 more lie at the same place" in sample.said_by(found[0])
    assert len(found[0].choice.actions()) == 21
    found[0].choice.actions()[-1].trigger()
    sample.user.settle()
    taking_part = {x.name for x in sample.session.pairs}
    assert {x for x in taking_part if x.startswith("q")} == {"q0"}
