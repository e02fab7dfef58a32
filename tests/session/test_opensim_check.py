"""Warped models in OpenSim itself; skipped where it is not installed."""

from __future__ import annotations

import os
import sys

import numpy as np
import pytest
from tests.osim_models import copied_model, session_on

from pinwarp.core.errors import PinwarpError
from pinwarp.core.model_rows import Outcome
from pinwarp.io.osim.reading import read_model
from pinwarp.session.model.muscle_lengths import with_lengths
from pinwarp.session.model.opensim_check import MuscleFigures, OpenSimCheck, check_in_opensim
from pinwarp.session.model.study import study_of
from pinwarp.session.model.warped import warped_model
from pinwarp.session.model.writing import write_model


@pytest.fixture
def warped_leg(tmp_path):
    """The leg with its thigh warped."""
    leg = copied_model("leg", tmp_path)
    return warped_model(study_of(read_model(leg), {"thigh": session_on(leg, "thigh")}))


def figures(ratio=1.1):
    """What OpenSim might say of two muscles."""
    return OpenSimCheck(
        "4.6",
        (
            MuscleFigures("/forceset/rf", 0.5, 0.5 * ratio, 0.002, "knee_angle", -1.0),
            MuscleFigures("/forceset/ham", 0.4, 0.404),
        ),
        1,
    )


def test_without_opensim_it_is_said_what_to_install(warped_leg, monkeypatch):
    monkeypatch.setitem(sys.modules, "opensim", None)
    with pytest.raises(PinwarpError, match=r"install pinwarp\[opensim\]"):
        check_in_opensim(warped_leg)


def test_lengths_that_are_kept_are_flagged_where_the_path_is_much_longer(warped_leg):
    rows = {row.path: row for row in with_lengths(warped_leg, figures()).rows}
    assert "1.100 times as long" in rows["/forceset/rf"].flag
    assert rows["/forceset/ham"].outcome is Outcome.KEPT
    assert "1.010" in rows["/forceset/ham"].words


def test_lengths_are_scaled_with_the_path_when_asked_for(warped_leg, tmp_path):
    scaled = with_lengths(warped_leg, figures(), scale=True)
    assert {row.path: row.outcome for row in scaled.rows}["/forceset/rf"] is Outcome.WARPED
    write_model(scaled, tmp_path / "new.osim")
    model = read_model(tmp_path / "new.osim")
    for path, ratio in (("/forceset/rf", 1.1), ("/forceset/ham", 1.01), ("/forceset/add", 1)):
        element = model.components[path]
        np.testing.assert_allclose(model.numbers(element, "optimal_fiber_length", 0), 0.1 * ratio)
        np.testing.assert_allclose(model.numbers(element, "tendon_slack_length", 0), 0.2 * ratio)


def test_the_figures_are_told_in_short():
    first, second, third = figures().in_words()
    assert (
        first == "OpenSim 4.6 loads it; 2 paths changed by 27.0 mm on average and 50.0 mm at most."
    )
    assert "1.100, of /forceset/rf" in second
    assert "2.0 mm at most: /forceset/rf about knee_angle at -1.00" in third
    assert OpenSimCheck("4.6", (), 3).in_words() == ("OpenSim 4.6 loads it; no muscle changed.",)
    assert figures().as_json()["muscles"][1]["moment_arm_change_mm"] is None


@pytest.fixture
def opensim():
    return pytest.importorskip("opensim")


def test_opensim_loads_the_leg_and_finds_its_muscles_changed(opensim, warped_leg, tmp_path):
    before = sorted(os.listdir(tmp_path))
    check = check_in_opensim(warped_leg)
    assert {each.path for each in check.muscles} == {
        "/forceset/rf",
        "/forceset/ham",
        "/forceset/add",
    }
    assert all(abs(each.moment_arm) > 1e-5 for each in check.muscles)
    assert sorted(os.listdir(tmp_path)) == before
    assert not os.path.exists("opensim.log")


def test_a_warp_that_moves_nothing_changes_no_muscle(opensim, tmp_path):
    leg = copied_model("leg", tmp_path)
    session = session_on(leg, "thigh", warp=lambda places: places)
    check = check_in_opensim(warped_model(study_of(read_model(leg), {"thigh": session})))
    assert (check.muscles, check.unchanged) == ((), 3)


@pytest.mark.parametrize(
    ("name", "body"), [("leg_splined_knee", "thigh_l"), ("leg_nested_frames", "thigh")]
)
@pytest.mark.parametrize("turns", [False, True])
def test_points_are_where_the_warp_takes_them_when_read_by_opensim(
    opensim, tmp_path, name, body, turns
):
    path = copied_model(name, tmp_path)
    study = study_of(read_model(path), {body: session_on(path, body)}, turns=turns)
    warped = warped_model(study)
    write_model(warped, tmp_path / "new.osim")
    model = opensim.Model(str(tmp_path / "new.osim"))
    state = model.initSystem()
    there = model.getBodySet().get(body)
    for where, place in warped.bodies[0].places.items():
        component = model.getComponent(where)
        station = opensim.PathPoint.safeDownCast(component) or opensim.Station.safeDownCast(
            component
        )
        found = model.getGround().findStationLocationInAnotherFrame(
            state, station.getLocationInGround(state), there
        )
        assert max(abs(found.get(i) - place[i]) for i in range(3)) < 1e-12


def test_scaled_lengths_are_what_opensim_reads(opensim, warped_leg, tmp_path):
    check = check_in_opensim(warped_leg)
    write_model(with_lengths(warped_leg, check, scale=True), tmp_path / "new.osim")
    model = opensim.Model(str(tmp_path / "new.osim"))
    model.initSystem()
    for each in check.muscles:
        muscle = model.getMuscles().get(each.path.rsplit("/", 1)[-1])
        assert muscle.getOptimalFiberLength() == pytest.approx(0.1 * each.ratio)


def test_a_model_that_opensim_does_not_load_is_told_in_words(opensim, warped_leg):
    data = warped_leg.study.model.path
    data.write_bytes(data.read_bytes().replace(b"PinJoint", b"PinnedJoint"))
    with pytest.raises(PinwarpError, match=r"OpenSim does not load leg\.osim"):
        check_in_opensim(warped_leg)
