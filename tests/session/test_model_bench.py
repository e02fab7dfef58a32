"""A model that is open: rules, elements to be drawn, and the study that the work makes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from tests.osim_models import copied_model, session_file, session_on

from pinwarp.core.frame_warp import BodyRules
from pinwarp.core.landmarks import Side
from pinwarp.io.osim.bone import bone_of
from pinwarp.io.osim.reading import read_model
from pinwarp.io.samples import sample_model
from pinwarp.session.editor import Editor, Work
from pinwarp.session.history import History
from pinwarp.session.model.bench import Progress, open_bench, progress_of
from pinwarp.session.model.body_figures import body_figures
from pinwarp.session.model.elements import MusclePaths, OutlineKind
from pinwarp.session.model.rules import Rule, choices, rule_of, with_rule
from pinwarp.session.model.study import ModelStudy, StudyBody, write_study
from pinwarp.session.session import Session
from pinwarp.session.warp.solved import solved

THIGH, KNEE = "/bodyset/thigh", "/markerset/KNEE"


@pytest.fixture(scope="module")
def thigh():
    return bone_of(read_model(sample_model()), THIGH)


@pytest.fixture(scope="module")
def muscles():
    return MusclePaths.of(read_model(sample_model()))


@pytest.fixture(scope="module")
def session():
    return session_on(sample_model(), THIGH)


def test_work_that_was_set_aside_is_taken_up_with_its_steps_and_rules():
    editor = Editor()
    editor.commit(Session(unit="m"), "Unit m")
    editor.commit(editor.session, "Keep KNEE", rules=BodyRules(keep=frozenset({KNEE})))
    aside = editor.work
    editor.take_up(Work(History(Session(unit="cm"))))
    assert (editor.session.unit, editor.undo_label, editor.rules) == ("cm", None, BodyRules())
    editor.take_up(aside)
    assert editor.rules.keep == {KNEE}
    editor.undo()
    assert (editor.rules, editor.session.unit) == (BodyRules(), "m")
    editor.undo()
    assert editor.session.unit == "mm"


def test_one_frame_stays_as_it_is_where_all_others_go_on_turning(thigh):
    first, second = thigh.parts.frames
    rules = with_rule(thigh.parts, BodyRules(turns=True), [first], Rule.CARRY)
    assert rule_of(thigh.parts, rules, first) is Rule.CARRY
    assert rule_of(thigh.parts, rules, second) is Rule.TURN


@pytest.mark.parametrize("rule", Rule)
def test_a_rule_that_is_chosen_is_the_rule_where_it_can_be(thigh, rule):
    for path in thigh.parts.paths:
        rules = with_rule(thigh.parts, BodyRules(), [path], rule)
        if rule in choices(thigh.parts, path):
            assert rule_of(thigh.parts, rules, path) is rule
        else:
            assert rules == BodyRules()


def test_elements_lie_on_the_destination_where_the_warp_takes_them(thigh, muscles, session):
    figures = body_figures(session, thigh, BodyRules(), muscles)
    assert figures.problem == ""
    carried = solved(session).spline.evaluate(figures.before.points)
    np.testing.assert_allclose(figures.after.points, carried, atol=1e-9)


def test_an_element_that_is_kept_stays_on_the_bone_without_its_shape(thigh, muscles, session):
    rules = BodyRules(keep=frozenset({KNEE}))
    figures = body_figures(session, thigh, rules, muscles)
    row = figures.after.paths.index(KNEE)
    carried = solved(session).spline.evaluate(figures.before.points)
    apart = np.linalg.norm(figures.after.points - carried, axis=1)
    assert apart[row] > 0.005
    assert np.delete(apart, row).max() < 1e-9


def test_without_a_pair_all_elements_are_listed_without_figures(thigh, muscles):
    figures = body_figures(Session(thigh.file), thigh, BodyRules(), muscles)
    assert not figures.is_warped
    assert {row.path for row in figures.rows} >= thigh.parts.paths
    assert np.isnan([row.moved for row in figures.rows]).all()


def test_a_session_in_another_unit_is_told_and_its_elements_stay_on_the_source(thigh, muscles):
    session = session_on(sample_model(), THIGH, unit=1000.0)
    figures = body_figures(session, thigh, BodyRules(), muscles)
    assert "1,0" in figures.problem
    assert figures.after is None
    assert len(figures.before.points)


def test_a_muscle_goes_on_towards_the_body_that_its_next_point_is_on(thigh, muscles):
    figures = body_figures(Session(thigh.file), thigh, BodyRules(), muscles)
    stubs = [one for one in figures.before.outlines if one.kind is OutlineKind.STUB]
    (up, down) = (one for one in stubs if one.path == "/forceset/rf")
    # From its point on the thigh to the hip, and to the shank.
    assert up.places[-1, 1] > up.places[0, 1]
    assert down.places[-1, 1] < down.places[0, 1]


def test_a_body_is_done_with_eight_pairs_and_nothing_that_waits(session):
    assert progress_of(session) is Progress.DONE
    seven = replace(session, landmarks=session.landmarks[:7])
    assert progress_of(seven) is Progress.STARTED
    waiting = session.landmarks[0].placed(Side.DESTINATION, None)
    more = replace(session, landmarks=(waiting, *session.landmarks[1:]))
    assert progress_of(more) is Progress.STARTED


def test_a_study_that_is_read_says_the_same_when_it_is_saved(tmp_path):
    path = copied_model("leg", tmp_path)
    model = read_model(path)
    file = session_file(path, "thigh")
    frame = next(iter(bone_of(model, THIGH).parts.frames))
    study = ModelStudy(
        model,
        (StudyBody(THIGH, Session(), turns=True, enabled=False, note="a note", path=file),),
        frozenset({frame}),
        frozenset({KNEE, "/nowhere"}),
    )
    place = tmp_path / "leg.pinwarp-model.csv"
    write_study(place, study)
    written = place.read_bytes()
    bench = open_bench(place)
    body = bench.bodies[THIGH]
    assert body.rules == BodyRules(True, frozenset({frame}), frozenset({KNEE}))
    assert body.worst > 0
    assert not bench.is_dirty
    bench.save(place)
    assert place.read_bytes() == written
    body.enabled = True
    assert bench.is_dirty
