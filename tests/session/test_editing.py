"""The session by its verbs, and as a machine that can be driven anywhere and back."""

from __future__ import annotations

import math
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule

from pinwarp.core.errors import LandmarkError, PinwarpError
from pinwarp.core.groups import Curve, Handle, Patch
from pinwarp.core.landmarks import Landmark, LandmarkState, Role, Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention
from pinwarp.io.clipboard_table import clipboard_text, read_clipboard
from pinwarp.io.meshes import MeshFile
from pinwarp.io.session_file import read_session, write_session
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.guide import with_template
from pinwarp.session.naming import names_by_pattern
from pinwarp.session.outputs.exports import warped_mesh
from pinwarp.session.session import Session, from_record, to_record
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


def pair(name, shift=0.0):
    return Landmark(name, (shift, 0.0, 0.0), (shift, 1.0, 0.0))


def file_of(scale):
    mesh = Mesh(np.eye(3) * scale, [[0, 1, 2]])
    return MeshFile(Path("/tmp/m.stl"), mesh, "0" * 64, ())


# Placing


def test_a_new_landmark_fills_the_first_that_lacks_this_side():
    session = Session(landmarks=(pair("a"), Landmark("b", (1, 2, 3)), Landmark("c", (4, 5, 6))))
    session, name = edits.place(session, DESTINATION, (7, 8, 9))
    assert name == "b"
    assert session.landmark("b").destination == (7, 8, 9)


def test_disabled_landmarks_and_passengers_are_not_filled():
    session = Session(
        landmarks=(
            Landmark("off", (1, 2, 3), enabled=False),
            Landmark("carried", (1, 2, 3), role=Role.PASSENGER),
        )
    )
    _, name = edits.place(session, DESTINATION, (7, 8, 9))
    assert name == "landmark_0"


def test_new_names_go_on_from_the_largest_number():
    session = Session(landmarks=(pair("landmark_7"), pair("landmark_2")))
    assert edits.next_name(session) == "landmark_8"


# Removing


def test_removing_the_last_side_removes_a_landmark_that_nobody_named():
    session = Session(landmarks=(Landmark("landmark_0", (1, 2, 3)), Landmark("fovea", (1, 2, 3))))
    assert edits.remove_side(session, "landmark_0", SOURCE).landmark("landmark_0") is None
    kept = edits.remove_side(session, "fovea", SOURCE).landmark("fovea")
    assert kept.state is LandmarkState.EMPTY


# Renaming


@pytest.mark.parametrize("name", ["", "   ", "b"])
def test_an_empty_or_taken_name_is_refused(name):
    session = Session(landmarks=(pair("a"), pair("b")))
    with pytest.raises(LandmarkError):
        edits.rename(session, "a", name)


def test_a_landmark_that_is_not_there_is_said_so():
    with pytest.raises(LandmarkError, match="no landmark called x"):
        edits.move(Session(), "x", SOURCE, (0, 0, 0))


# Several at once


def test_landmarks_may_take_each_others_names_but_not_those_of_others():
    session = Session(landmarks=tuple(map(pair, "abc")))
    swapped = edits.rename_many(session, {"a": "b", "b": "a"})
    assert [x.name for x in swapped.landmarks] == ["b", "a", "c"]
    with pytest.raises(LandmarkError, match="already a landmark called c"):
        edits.rename_many(session, {"a": "d", "b": "c"})
    with pytest.raises(LandmarkError, match="Two landmarks would be called d"):
        edits.rename_many(session, {"a": "d", "b": "d"})


@pytest.mark.parametrize("pattern", ["{x}", "{", "a}", "{n:0.2f}", "{name.__class__}"])
def test_braces_that_mean_nothing_are_refused(pattern):
    with pytest.raises(LandmarkError, match=r"use \{name\}, \{n\} or \{n:02\}"):
        names_by_pattern(["a"], pattern)


def test_a_passenger_keeps_its_destination_for_the_way_back():
    session = Session(landmarks=(pair("a"), pair("b")))
    carried = edits.set_role(session, ["a"], Role.PASSENGER)
    assert carried.landmark("a").state is LandmarkState.PASSENGER
    assert [x.name for x in carried.pairs] == ["b"]
    assert edits.set_role(carried, ["a"], Role.PAIR) == session


@pytest.mark.parametrize(
    ("moving", "row", "expected"),
    [
        ("c", 0, "cabde"),
        ("ad", 2, "badce"),
        ("a", 5, "bcdea"),
        ("ab", 1, "abcde"),
        ("", 3, "abcde"),
    ],
)
def test_reordering_keeps_the_order_of_what_moves_and_of_what_stays(moving, row, expected):
    session = Session(landmarks=tuple(map(pair, "abcde")))
    moved = edits.reorder(session, list(moving), row)
    assert "".join(x.name for x in moved.landmarks) == expected


@pytest.mark.parametrize(
    "edit",
    [
        lambda session: edits.set_locked(session, ["a", "x"], True),
        lambda session: edits.set_role(session, ["x"], Role.PAIR),
        lambda session: edits.reorder(session, ["x"], 0),
    ],
)
def test_all_of_several_landmarks_must_be_there(edit):
    with pytest.raises(LandmarkError, match="no landmark called x"):
        edit(Session(landmarks=(pair("a"),)))


# Importing


def test_an_import_pairs_by_name_and_adds_what_is_new():
    session = Session(landmarks=(Landmark("b", (1, 1, 1)), Landmark("a", (2, 2, 2))))
    arriving = [Landmark("a", None, (3, 3, 3)), Landmark("c", None, (4, 4, 4))]
    session = edits.import_side(session, DESTINATION, arriving)
    assert [x.name for x in session.landmarks] == ["b", "a", "c"]
    assert session.landmark("a").destination == (3, 3, 3)
    assert session.landmark("c").state is LandmarkState.DESTINATION_ONLY


def test_imported_pairs_keep_their_halves():
    arriving = [pair("a"), Landmark("b", None, (4, 4, 4))]
    session = edits.import_pairs(Session(), arriving)
    assert session.landmark("a").is_pair
    assert session.landmark("b").source is None


def test_a_name_without_a_position_takes_none_away():
    session = Session(landmarks=(pair("a"),))
    names = [Landmark("a"), Landmark("b")]
    for imported in (
        edits.import_side(session, SOURCE, names),
        edits.import_pairs(session, names),
    ):
        assert imported.landmarks == (pair("a"), Landmark("b"))


def test_a_pair_that_is_switched_off_arrives_so_but_switches_no_other_off():
    off = replace(pair("b"), enabled=False)
    session = edits.import_pairs(
        Session(landmarks=(pair("a"),)), [replace(pair("a"), enabled=False), off]
    )
    assert session.landmarks == (pair("a"), off)


# Units


def test_the_first_mesh_says_whether_the_session_is_in_metres():
    assert edits.set_mesh(Session(), SOURCE, file_of(0.4)).unit == "m"
    assert edits.set_mesh(Session(), SOURCE, file_of(400.0)).unit == "mm"


def test_a_second_mesh_does_not_change_the_unit():
    session = edits.set_mesh(Session(), SOURCE, file_of(400.0))
    assert edits.set_mesh(session, DESTINATION, file_of(0.4)).unit == "mm"


# Undo


def test_undo_restores_a_deleted_pair_in_its_place():
    editor = Editor(Session(landmarks=(pair("a"), pair("b"), pair("c"))))
    editor.commit(edits.remove(editor.session, ["b"]), "Delete b")
    editor.undo()
    assert [x.name for x in editor.session.landmarks] == ["a", "b", "c"]


def test_a_preview_leaves_no_step_and_a_cancelled_one_no_trace():
    editor = Editor()
    before = editor.session
    for penalty in (1.0, 2.0, 3.0):
        editor.preview(edits.set_penalty(editor.committed, penalty))
    assert editor.session.settings.penalty == 3.0
    assert editor.undo_label is None
    editor.cancel_preview()
    assert editor.session == before


def test_a_drag_of_many_previews_is_one_step():
    editor = Editor()
    for penalty in (1.0, 2.0, 3.0):
        editor.preview(edits.set_penalty(editor.committed, penalty))
    editor.commit(editor.session, "Change penalty")
    editor.undo()
    assert editor.session.settings.penalty == 0.0
    assert editor.undo_label is None


def test_an_edit_that_changes_nothing_leaves_no_step():
    editor = Editor(Session(landmarks=(pair("a"),)))
    editor.commit(edits.rename(editor.session, "a", "a"), "Rename a")
    assert editor.undo_label is None
    assert not editor.is_dirty


def test_undoing_to_what_was_saved_is_no_longer_unsaved():
    editor = Editor()
    editor.commit(edits.set_penalty(editor.session, 1.0), "Change penalty")
    assert editor.is_dirty
    editor.undo()
    assert not editor.is_dirty


def test_commits_with_one_merge_key_become_one_step():
    editor = Editor()
    for penalty in (1.0, 2.0):
        editor.commit(edits.set_penalty(editor.session, penalty), "Change penalty", "penalty")
    editor.undo()
    assert editor.session == Session()


def test_a_commit_after_an_undo_is_a_step_of_its_own_even_with_the_same_merge_key():
    editor = Editor()
    editor.commit(edits.set_penalty(editor.session, 1.0), "Change penalty", "penalty")
    editor.commit(edits.set_unit(editor.session, "m"), "Change unit")
    editor.undo()
    editor.commit(edits.set_penalty(editor.session, 2.0), "Change penalty", "penalty")
    assert editor.redo_label is None
    editor.undo()
    assert editor.session == edits.set_penalty(Session(), 1.0)


def test_a_landmark_that_is_gone_is_no_longer_selected():
    editor = Editor(Session(landmarks=(pair("a"), pair("b"))))
    editor.select("a", "b")
    editor.commit(edits.remove(editor.session, ["a"]), "Delete a")
    assert editor.selection.names == ("b",)


def test_listeners_hear_only_of_what_changed():
    editor = Editor(Session(landmarks=(pair("a"),)))
    heard = []
    editor.selection_changed.connect(heard.append)
    editor.select("a")
    editor.select("a")
    editor.look(overlay=True)
    assert len(heard) == 1


# Results


def five_pairs():
    rng = np.random.default_rng(0)
    return tuple(
        Landmark(f"p{i}", tuple(rng.normal(size=3)), tuple(rng.normal(size=3))) for i in range(6)
    )


def test_nothing_is_computed_twice():
    solver = WarpSolver()
    session = Session(source=file_of(1.0), landmarks=five_pairs())
    first = solver.solve(WarpInputs.of(session))
    assert (solver.factorisations, solver.solves, solver.evaluations) == (1, 1, 1)
    renamed = edits.rename(session, "p0", "apex")
    assert solver.solve(WarpInputs.of(renamed)) is first
    assert (solver.factorisations, solver.solves, solver.evaluations) == (1, 1, 1)
    solver.solve(WarpInputs.of(edits.set_penalty(renamed, 0.5)))
    assert (solver.factorisations, solver.solves, solver.evaluations) == (1, 2, 2)
    solver.solve(WarpInputs.of(edits.move(renamed, "p1", DESTINATION, (0, 0, 0))))
    assert solver.factorisations == 1
    solver.solve(WarpInputs.of(edits.move(renamed, "p1", SOURCE, (0, 0, 0))))
    assert solver.factorisations == 2


def test_a_residual_that_is_only_rounding_is_none():
    rng = np.random.default_rng(0)
    places = 100 + 50 * rng.normal(size=(20, 2, 3))
    pairs = tuple(Landmark(f"p{i}", tuple(a), tuple(b)) for i, (a, b) in enumerate(places))
    result = WarpSolver().solve(WarpInputs.of(Session(landmarks=pairs)))
    missed = np.linalg.norm(result.landmarks - places[:, 1], axis=1)
    assert 0 < missed.max() < 1e-9
    assert not result.residuals.any()
    stiff = WarpSolver().solve(
        WarpInputs.of(Session(landmarks=pairs, settings=WarpSettings(penalty=1e-3)))
    )
    assert stiff.residuals.all()


def test_a_session_without_pairs_has_no_warp_and_says_what_to_do():
    assert WarpSolver().solve(WarpInputs.of(Session())).spline is None
    with pytest.raises(PinwarpError, match="open one first"):
        warped_mesh(Session())
    with pytest.raises(PinwarpError, match="no pair yet"):
        warped_mesh(Session(source=file_of(1.0)))


def test_an_opynsim_penalty_on_a_pole_becomes_a_message():
    session = Session(source=file_of(1.0), landmarks=five_pairs())
    solver = WarpSolver()
    pole = float(solver.solve(WarpInputs.of(session)).factor.poles[0])
    session = edits.set_convention(edits.set_penalty(session, pole), PenaltyConvention.OPYNSIM)
    result = solver.solve(WarpInputs.of(session))
    assert "pole" in result.problem
    assert result.spline is None


def test_passengers_are_warped_with_the_mesh():
    rider = Landmark("rider", (0.5, 0.5, 0.5), role=Role.PASSENGER)
    session = Session(landmarks=(*five_pairs(), rider))
    result = WarpSolver().solve(WarpInputs.of(session))
    assert np.allclose(result.passengers, result.spline.evaluate([[0.5, 0.5, 0.5]]))


def test_the_exported_mesh_meets_the_landmarks():
    session = Session(landmarks=five_pairs())
    vertices = [landmark.source for landmark in session.landmarks]
    mesh = Mesh(vertices, [[0, 1, 2], [3, 4, 5]])
    session = session.with_mesh(SOURCE, MeshFile(Path("/tmp/m.stl"), mesh, "", ()))
    expected = [landmark.destination for landmark in session.landmarks]
    assert np.allclose(warped_mesh(session).vertices, expected)


# Anywhere and back

coordinates = st.tuples(*[st.floats(-1e3, 1e3, allow_nan=False) for _ in range(3)])
sides = st.sampled_from(list(Side))
names = st.text(min_size=1, max_size=8).filter(lambda text: text.strip() == text and text)


class EditingMachine(RuleBasedStateMachine):
    """Every verb in any order; undo leads back to the start, a file gives back the same."""

    def __init__(self):
        super().__init__()
        self.editor = Editor()
        self.start = self.editor.session
        self.steps = [self.start]
        self.folder = Path(tempfile.mkdtemp())

    def commit(self, session, label):
        self.editor.commit(session, label)
        if session != self.steps[-1]:
            self.steps.append(session)

    def some(self, data):
        return data.draw(st.sampled_from([x.name for x in self.editor.session.landmarks]))

    def several(self, data):
        found = st.sampled_from([x.name for x in self.editor.session.landmarks])
        return data.draw(st.lists(found, unique=True))

    has_landmarks = precondition(lambda self: self.editor.session.landmarks)

    @rule(side=sides, position=coordinates)
    def place(self, side, position):
        session, _ = edits.place(self.editor.session, side, position)
        self.commit(session, "place")

    @has_landmarks
    @rule(data=st.data(), side=sides, position=coordinates)
    def place_what_is_asked_for(self, data, side, position):
        asked = self.some(data)
        session, name = edits.place(self.editor.session, side, position, target=asked)
        assert name == asked
        self.commit(session, "place asked")

    @rule(position=coordinates)
    def add_passenger(self, position):
        session, name = edits.add_passenger(self.editor.session, position)
        assert session.landmark(name).state is LandmarkState.PASSENGER
        self.commit(session, "passenger")

    @rule(template=st.lists(names, max_size=4))
    def load_template(self, template):
        session = with_template(self.editor.session, template)
        assert {x.name for x in session.landmarks} >= set(template)
        self.commit(session, "template")

    @rule()
    def swap(self):
        groups = self.editor.session.groups
        if any(isinstance(group, Patch) or not group.is_drawn for group in groups):
            with pytest.raises(LandmarkError, match="cannot change sides"):
                edits.swap_sides(self.editor.session)
            return
        swapped = edits.swap_sides(self.editor.session)
        assert edits.swap_sides(swapped) == self.editor.session
        self.commit(swapped, "swap")

    @rule(unit=st.sampled_from(edits.UNITS))
    def measure_in(self, unit):
        self.commit(edits.set_unit(self.editor.session, unit), "unit")

    @has_landmarks
    @rule(data=st.data(), side=sides, position=coordinates)
    def move(self, data, side, position):
        self.commit(edits.move(self.editor.session, self.some(data), side, position), "move")

    @has_landmarks
    @rule(data=st.data(), side=sides)
    def remove_side(self, data, side):
        self.commit(edits.remove_side(self.editor.session, self.some(data), side), "remove side")

    @has_landmarks
    @rule(data=st.data())
    def remove(self, data):
        self.commit(edits.remove(self.editor.session, [self.some(data)]), "remove")

    @has_landmarks
    @rule(data=st.data(), name=names)
    def rename(self, data, name):
        try:
            self.commit(edits.rename(self.editor.session, self.some(data), name), "rename")
        except LandmarkError:
            assert self.editor.session.index_of(name) is not None

    @has_landmarks
    @rule(data=st.data(), pattern=st.sampled_from(["{name}_l", "p{n}", "{n:02}", "same", "{name}"]))
    def rename_many(self, data, pattern):
        before = self.editor.session
        new_names = names_by_pattern(self.several(data), pattern)
        others = {x.name for x in before.landmarks} - set(new_names)
        try:
            self.commit(edits.rename_many(before, new_names), "rename many")
        except LandmarkError:
            given = list(new_names.values())
            assert len(set(given)) < len(given) or others & set(given)

    @has_landmarks
    @rule(data=st.data())
    def copy_and_paste(self, data):
        """Onto itself it changes nothing; what was deleted comes back as it was, at the end."""
        before = self.editor.session
        chosen = [x for x in before.landmarks if x.name in self.several(data)]
        table = read_clipboard(clipboard_text(chosen))
        assert edits.paste(before, table.rows) == before
        gone = edits.remove(before, [x.name for x in chosen])
        pasted = edits.paste(gone, table.rows)
        expected = [replace(x, locked=False) for x in chosen]
        assert list(pasted.landmarks[len(gone.landmarks) :]) == expected
        self.commit(pasted, "paste")

    @has_landmarks
    @rule(data=st.data(), enabled=st.booleans())
    def enable(self, data, enabled):
        self.commit(edits.set_enabled(self.editor.session, self.several(data), enabled), "enable")

    @has_landmarks
    @rule(data=st.data(), locked=st.booleans())
    def lock(self, data, locked):
        self.commit(edits.set_locked(self.editor.session, self.several(data), locked), "lock")

    @has_landmarks
    @rule(data=st.data(), role=st.sampled_from(Role))
    def give_role(self, data, role):
        self.commit(edits.set_role(self.editor.session, self.several(data), role), "role")

    @has_landmarks
    @rule(data=st.data(), note=st.text(st.characters(exclude_categories=["C"])))
    def write_note(self, data, note):
        self.commit(edits.set_note(self.editor.session, self.some(data), note), "note")

    @has_landmarks
    @rule(data=st.data())
    def reorder(self, data):
        before = self.editor.session
        row = data.draw(st.integers(0, len(before.landmarks)))
        self.commit(edits.reorder(before, self.several(data), row), "reorder")
        assert set(self.editor.session.landmarks) == set(before.landmarks)

    def a_group(self, data, kind=(Curve, Patch)):
        found = [x.name for x in self.editor.session.groups if isinstance(x, kind)]
        return data.draw(st.sampled_from(found)) if found else None

    @rule(data=st.data(), name=names, is_closed=st.booleans())
    def draw_curve(self, data, name, is_closed):
        """Through places, some of which are landmarks."""
        here = self.editor.session
        places = data.draw(st.lists(coordinates, min_size=3, max_size=4, unique=True))
        handles = [Handle(place) for place in places]
        anchors = [x for x in here.landmarks if x.source is not None]
        if anchors:
            one = data.draw(st.sampled_from(anchors))
            handles[data.draw(st.integers(0, 2))] = Handle(one.source, one.destination, one.name)
        self.add(name, lambda: Curve(name, tuple(handles), is_closed, 3))

    @rule(data=st.data(), name=names, points=st.lists(coordinates, max_size=3))
    def spread_patch(self, data, name, points):
        self.add(name, lambda: Patch(name, tuple(points), self.a_group(data, Curve) or ""))

    def add(self, name, make):
        here = self.editor.session
        if here.group(name) is not None:
            return
        try:
            group = make()
        except LandmarkError:
            assert name != " ".join(name.splitlines())
            return
        self.commit(replace(here, groups=(*here.groups, group)), "group")

    @rule(data=st.data(), side=sides, position=coordinates)
    def move_handle(self, data, side, position):
        if (name := self.a_group(data, Curve)) is None:
            return
        moved = edits.move_handle(self.editor.session, name, 1, side, position)
        assert moved.group(name).handles[1].position(side) == position
        self.commit(moved, "move handle")

    @rule(data=st.data(), place=coordinates)
    def accept_or_take_back(self, data, place):
        if (name := self.a_group(data, Curve)) is None:
            return
        curve = self.editor.session.group(name)
        if curve.is_drawn:
            self.commit(edits.undraw_curve(self.editor.session, name), "take back")
            return
        drawn = edits.accept_curve(self.editor.session, name, [place] * len(curve.handles))
        assert drawn.group(name).is_drawn
        self.commit(drawn, "accept")

    @rule(data=st.data(), source=coordinates, destination=coordinates)
    def pin(self, data, source, destination):
        name = self.a_group(data)
        if name is None or not self.editor.session.group(name).count:
            return
        pinned, mark = edits.pin_point(self.editor.session, name, 0, source, destination)
        assert pinned.landmark(mark).is_pair
        assert 0 in pinned.group(name).excluded
        self.commit(pinned, "pin")

    @rule(data=st.data(), new_name=names)
    def rename_group(self, data, new_name):
        if (name := self.a_group(data)) is None:
            return
        try:
            self.commit(edits.rename_group(self.editor.session, name, new_name), "rename group")
        except LandmarkError:
            taken = self.editor.session.group(new_name.strip()) is not None
            assert taken or new_name != " ".join(new_name.splitlines())

    @rule(data=st.data())
    def remove_group(self, data):
        if (name := self.a_group(data)) is not None:
            self.commit(edits.remove_groups(self.editor.session, [name]), "remove group")

    @rule(penalty=st.one_of(st.floats(0, 1e6), st.just(math.inf)))
    def penalise(self, penalty):
        self.commit(edits.set_penalty(self.editor.session, penalty), "penalty")

    @rule(convention=st.sampled_from(list(PenaltyConvention)), planar=st.booleans())
    def choose(self, convention, planar):
        session = edits.set_convention(self.editor.session, convention)
        self.commit(edits.set_planar(session, planar), "choose")

    @rule(side=sides, arriving=st.lists(st.tuples(names, coordinates), max_size=3))
    def bring_in(self, side, arriving):
        unique = dict(arriving)
        landmarks = [Landmark(name).placed(side, place) for name, place in unique.items()]
        self.commit(edits.import_side(self.editor.session, side, landmarks), "import")

    @rule(penalty=st.floats(0, 1))
    def preview_and_cancel(self, penalty):
        before = self.editor.session
        self.editor.preview(edits.set_penalty(self.editor.committed, penalty))
        self.editor.cancel_preview()
        assert self.editor.session == before

    @rule()
    def undo_and_redo(self):
        before = self.editor.session
        if self.editor.undo_label is not None:
            self.editor.undo()
            assert self.editor.session == self.steps[-2]
            self.editor.redo()
        assert self.editor.session == before

    @rule()
    def undo_for_good(self):
        if self.editor.undo_label is not None:
            self.editor.undo()
            self.steps.pop()

    @rule()
    def save_and_load(self):
        path = self.folder / "session.pinwarp.csv"
        write_session(path, to_record(self.editor.session))
        assert from_record(read_session(path), None, None) == self.editor.session

    @invariant()
    def the_current_session_is_the_last_step(self):
        assert self.editor.session == self.steps[-1]

    @invariant()
    def names_are_unique(self):
        found = [landmark.name for landmark in self.editor.session.landmarks]
        assert len(found) == len(set(found))
        groups = [group.name for group in self.editor.session.groups]
        assert len(groups) == len(set(groups))

    @invariant()
    def handles_at_landmarks_are_where_these_are(self):
        here = self.editor.session
        for group in here.groups:
            for handle in group.anchors if isinstance(group, Curve) else ():
                landmark = here.landmark(handle.landmark)
                assert (handle.source, handle.destination) == (
                    landmark.source,
                    landmark.destination,
                )

    def teardown(self):
        end = self.editor.session
        while self.editor.undo_label is not None:
            self.editor.undo()
        assert self.editor.session == self.start
        while self.editor.redo_label is not None:
            self.editor.redo()
        # Steps undone for good may be redone too: what was last must be on the way.
        assert end in self.steps
        shutil.rmtree(self.folder)


TestEditing = EditingMachine.TestCase
TestEditing.settings = settings(max_examples=40, stateful_step_count=30, deadline=None)
