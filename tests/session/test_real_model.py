"""A real model, Rajagopal2016, its right femur carried to a made-up subject; skipped without it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.osim_models import session_on

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.frame_warp import BodyRules, CarriedFrames
from pinwarp.core.model_rows import Outcome
from pinwarp.io.osim.body_parts import body_parts
from pinwarp.io.osim.bone import bone_of
from pinwarp.io.osim.reading import read_model
from pinwarp.io.osim.splicing import Splicer
from pinwarp.session.model.opensim_check import check_in_opensim
from pinwarp.session.model.study import study_of
from pinwarp.session.model.warped import warped_model
from pinwarp.session.model.writing import write_model

PAIRS = 40


def truth(places: np.ndarray) -> np.ndarray:
    """Return where the femur is on the subject: sizes of its own, 18° of torsion, and a bow."""
    x, y, z = (np.asarray(places) * [0.92, 1.07, 1.05]).T
    along = np.clip(-y / 0.43, -0.2, 1.2)
    c, s = np.cos(np.radians(18) * along), np.sin(np.radians(18) * along)
    bow = 0.008 * np.sin(np.pi * along)
    return np.column_stack([c * x + s * z + bow, y, -s * x + c * z])


@pytest.fixture(scope="module")
def path(shared_data) -> Path:
    return shared_data / "opensim-rajagopal2016" / "Rajagopal2016.osim"


@pytest.fixture(scope="module")
def model(path):
    return read_model(path)


@pytest.fixture(scope="module")
def warped(path, model):
    session = session_on(path, "femur_r", warp=truth, count=PAIRS)
    return warped_model(study_of(model, {"femur_r": session}))


@pytest.fixture(scope="module")
def expected(warped):
    """Where the points of the femur are on the subject, its pose left out as the warp does."""
    (body,) = warped.study.bodies
    pairs = np.array([[pair.source for pair in body.session.pairs]])[0]
    pose = fit_similarity(pairs, truth(pairs), scaling=False)
    parts = warped.bodies[0].parts

    def aligned(places: np.ndarray) -> np.ndarray:
        return (truth(places) - pose.translation) @ pose.rotation

    frames = CarriedFrames(parts, aligned, BodyRules())
    return {point.path: frames.new_place(point) for point in parts.points}


def test_a_real_model_that_is_not_edited_is_written_to_the_byte(path, model):
    assert Splicer(model.document).spliced() == path.read_bytes()
    assert len(model.bodies) == 22


def test_path_points_of_a_real_femur_come_out_within_half_a_millimetre(warped, expected):
    points = [point for point in warped.bodies[0].parts.points if point.is_of_path]
    places = warped.bodies[0].places
    far = [1e3 * np.linalg.norm(places[p.path] - expected[p.path]) for p in points]
    assert len(far) == 35
    assert np.mean(far) < 0.5
    assert max(far) < 2.5
    # What is said of the error is of its size.
    told = [row.plus_minus for row in warped.rows if row.kind == "path point"]
    assert 0.1 < np.mean(told) / (np.mean(far) / 1e3) < 10


def test_the_knee_of_a_real_model_stays_on_the_warped_way(warped):
    ways = [row for row in warped.rows if row.kind == "joint translation"]
    assert len(ways) == 2
    assert {row.outcome for row in ways} == {Outcome.WARPED}
    assert {row.outcome for row in warped.rows if row.kind == "offset frame"} == {Outcome.FLAGGED}


def test_nothing_but_the_femurs_elements_is_another_line(path, warped):
    lines = path.read_bytes().split(b"\n")
    others = warped.data("new_Geometry").split(b"\n")
    # One line of a function that was a constant became four.
    assert len(others) - len(lines) < 10
    gone = set(lines) - set(others)
    allowed = (b"location", b"translation", b"xyz_body_rotation", b"radius", b"length", b"<x>")
    allowed += (b"<y>", b"mass_center", b"mesh_file", b"coordinates", b"value", b"Constant")
    assert gone
    assert all(any(word in line for word in allowed) for line in gone)


def test_points_of_other_bodies_stay_where_they_are(model, warped, tmp_path):
    write_model(warped, tmp_path / "new.osim")
    new = read_model(tmp_path / "new.osim")
    for name in ("pelvis", "tibia_r", "femur_l"):
        body = model.body(name)
        before, after = body_parts(model, body), body_parts(new, body)
        for one, other in zip(before.points, after.points, strict=True):
            assert (one.path, one.frame) == (other.path, other.frame)
            assert (one.location == other.location).all()


def test_a_pelvis_of_three_meshes_is_one_bone(model):
    bone = bone_of(model, model.body("pelvis"))
    assert len(bone.meshes) == 3
    assert len(bone.mesh.vertices) == sum(len(mesh.part.mesh.vertices) for mesh, _ in bone.meshes)


def test_opensim_finds_every_muscle_as_it_was_after_a_warp_that_moves_nothing(path, model):
    pytest.importorskip("opensim")
    session = session_on(path, "femur_r", warp=lambda places: places, count=PAIRS)
    check = check_in_opensim(warped_model(study_of(model, {"femur_r": session})))
    assert (check.muscles, check.unchanged) == ((), 80)


def test_opensim_finds_the_muscles_of_the_subject_changed_and_no_others(warped):
    pytest.importorskip("opensim")
    check = check_in_opensim(warped)
    assert len(check.muscles) == 31
    named = {row.path for row in warped.rows if row.kind == "muscle lengths"}
    assert {each.path for each in check.muscles} <= named
