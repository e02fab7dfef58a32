"""Landmarks in another frame or unit than their mesh."""

from __future__ import annotations

import numpy as np
import pytest

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.landmark_files import read_landmarks
from pinwarp.io.meshes import read_mesh
from pinwarp.io.samples import assets_folder, sample_session
from pinwarp.io.session_file import read_session
from pinwarp.session.importing.fit import Fit, fits_of, fitted
from pinwarp.session.session import Session

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
WAYS = [Fit(flips, factor) for factor in (1.0, 0.001, 1000.0) for flips in (False, True)]


@pytest.fixture(scope="module")
def bones():
    names = {SOURCE: "femur_generic.ply", DESTINATION: "femur_subject.ply"}
    return {side: SurfaceIndex(read_mesh(assets_folder() / x).mesh) for side, x in names.items()}


@pytest.fixture(scope="module")
def landmarks():
    return read_session(sample_session()).landmarks


def undoing(fit: Fit) -> tuple[bool, float]:
    return fit.flips, 1 / fit.factor


@pytest.mark.parametrize("side", Side)
@pytest.mark.parametrize("way", WAYS, ids=str)
def test_whatever_was_done_to_them_is_found(bones, landmarks, side, way):
    spoilt = way.applied(landmarks, side)
    stored, *others = fits_of(spoilt, side, bones[side])
    assert stored.is_as_stored
    if way.is_as_stored:
        assert others == []
        assert stored.distance < 0.01
        return
    best = others[0]
    assert (best.flips, best.factor) == undoing(way)
    assert best.distance < 0.01 < 1 < stored.distance
    back = best.applied(spoilt, side)
    for before, after in zip(landmarks, back, strict=True):
        if before.position(side) is not None:
            assert np.allclose(before.position(side), after.position(side), rtol=1e-12)
        assert before.position(side.other) == after.position(side.other)


@pytest.mark.parametrize("way", WAYS, ids=str)
def test_landmarks_of_another_bone_raise_no_question(bones, landmarks, way):
    """Nothing makes them fit: to ask would be to guess."""
    swapped = [Landmark(x.name, x.destination, x.source) for x in landmarks]
    for side in Side:
        assert len(fits_of(way.applied(swapped, side), side, bones[side])) == 1


def test_real_femurs_in_metres(shared_data):
    folder = shared_data / "opensim-creator-femur"
    index = SurfaceIndex(read_mesh(folder / "femur_r.obj").mesh)
    # Stations on and off the bone.
    for name in ("femur_r_warp.landmarks.csv", "femur_r.landmarks.csv"):
        landmarks = read_landmarks(folder / name, SOURCE).landmarks
        for way in WAYS:
            _, *others = fits_of(way.applied(landmarks, SOURCE), SOURCE, index)
            assert [(x.flips, x.factor) for x in others] == (
                [] if way.is_as_stored else [undoing(way)]
            )
    others = read_landmarks(folder / "subject_femur_r.landmarks.csv", SOURCE).landmarks
    for way in WAYS:
        assert len(fits_of(way.applied(others, SOURCE), SOURCE, index)) == 1


def ball(centre=(0.0, 0.0, 0.0)):
    import pyvista as pv

    found = pv.Icosphere(radius=10.0, nsub=2, center=centre)
    return Mesh(found.points, found.regular_faces)


def test_what_shrinks_to_a_place_near_the_bone_is_no_fit():
    """Divided by 1000 anything lies at the origin, where a bone often is."""
    index = SurfaceIndex(ball((10.0, 0.0, 0.0)))
    far = [Landmark(str(i), (100.0 + i, 40.0, 0.0)) for i in range(10)]
    assert len(fits_of(far, SOURCE, index)) == 1


def test_a_bone_that_looks_the_same_turned_by_half_raises_no_question():
    index = SurfaceIndex(ball())
    marks = [Landmark(str(i), tuple(v)) for i, v in enumerate(index.mesh.vertices[:12] * 1.2)]
    assert len(fits_of(marks, SOURCE, index)) == 1


def test_one_landmark_is_enough_where_it_is_clear():
    index = SurfaceIndex(ball((20.0, 0.0, 0.0)))
    x, y, z = index.mesh.vertices[0]
    _, best = fits_of([Landmark("a", (-x, -y, z)), Landmark("unset")], SOURCE, index)
    assert best.flips


def test_without_a_position_there_is_nothing_to_judge(bones):
    assert fits_of([Landmark("a", None, (1, 2, 3))], SOURCE, bones[SOURCE]) == ()


def test_numbers_that_are_no_place_do_not_count(bones, landmarks):
    wild = Landmark("wild", (1e306, 0, 0))
    assert fits_of([wild], SOURCE, bones[SOURCE]) == ()
    assert fits_of([wild, *landmarks], SOURCE, bones[SOURCE]) == fits_of(
        landmarks, SOURCE, bones[SOURCE]
    )


def test_a_whole_side_of_a_session_is_read_anew():
    session = Session(landmarks=(Landmark("a", (1, 2, 3), (4, 5, 6)), Landmark("b", (7, 8, 9))))
    after = fitted(session, SOURCE, Fit(True))
    assert [x.source for x in after.landmarks] == [(-1, -2, 3), (-7, -8, 9)]
    assert after.landmarks[0].destination == (4, 5, 6)


def test_ways_are_put_in_words():
    assert [fit.describe("RAS") for fit in WAYS] == [
        "As stored",
        "With x and y negated (RAS to LPS)",
        "Divided by 1,000 (mm to m)",
        "With x and y negated (RAS to LPS) and divided by 1,000 (mm to m)",
        "Multiplied by 1,000 (m to mm)",
        "With x and y negated (RAS to LPS) and multiplied by 1,000 (m to mm)",
    ]
