"""Sessions on bodies of models, and the models that come of them."""

from __future__ import annotations

import csv
import os
from dataclasses import replace

import numpy as np
import pytest
from tests.osim_kinematics import Kinematics
from tests.osim_models import (
    copied_model,
    edited_model,
    paired,
    session_file,
    session_on,
    subject,
)

from pinwarp.core.components import Components
from pinwarp.core.errors import FileFormatError, PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.mirror import mirrored_points
from pinwarp.core.settings import WarpSettings
from pinwarp.io.mesh_reference import MeshReference
from pinwarp.io.meshes import read_mesh
from pinwarp.io.osim.bone import bone_of, bone_path, read_bone
from pinwarp.io.osim.reading import read_model
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session.keeping.files import read_session
from pinwarp.session.model.body_warp import body_warp
from pinwarp.session.model.study import (
    ModelStudy,
    StudyBody,
    read_study,
    study_of,
    write_study,
)
from pinwarp.session.model.warped import warped_model
from pinwarp.session.model.writing import write_model
from pinwarp.session.session import Session
from pinwarp.session.warp.refined import inputs_of
from pinwarp.session.warp.solved import solved


@pytest.fixture
def leg(tmp_path):
    return copied_model("leg", tmp_path)


def bone_in(path, body="thigh"):
    model = read_model(path)
    return bone_of(model, model.body(body))


def agree(one, other, places):
    return np.abs(one.warp(places) - other.warp(places)).max()


def test_a_warp_leaves_out_the_pose_and_keeps_what_is_paired_in_shape(leg):
    bone = bone_in(leg)
    session = session_on(leg, "thigh", count=60)
    warp = body_warp(session, bone)
    places = np.array([pair.source for pair in session.pairs])
    carried, expected = warp.warp(places), subject(places)
    # What the subject is, but for where it lies: all distances are right, and it is not turned.
    np.testing.assert_allclose(
        np.linalg.norm(carried - carried[0], axis=1),
        np.linalg.norm(expected - expected[0], axis=1),
        atol=1e-9,
    )
    np.testing.assert_allclose(carried.mean(axis=0), places.mean(axis=0), atol=1e-9)
    assert warp.pairs == 60
    assert 1.0 < warp.ratio < 1.2
    assert warp.notes == ()


@pytest.mark.parametrize("components", list(Components))
def test_what_the_session_applies_makes_no_difference(leg, components):
    bone, session = bone_in(leg), session_on(leg, "thigh")
    other = replace(session, settings=WarpSettings(components=components, blend=0.5))
    places = bone.mesh.vertices
    assert agree(body_warp(session, bone), body_warp(other, bone), places) < 1e-12


def test_a_session_in_millimetres_makes_the_same_of_the_body(leg):
    bone, session = bone_in(leg), session_on(leg, "thigh")
    mesh = bone.file.mesh
    file = replace(bone.file, mesh=mesh.with_vertices(1000 * mesh.vertices), scaled=1000.0)
    landmarks = tuple(
        replace(
            each,
            source=tuple(1000 * np.array(each.source)),
            destination=tuple(1000 * np.array(each.destination)),
        )
        for each in session.landmarks
    )
    in_mm = Session(file, landmarks=landmarks, settings=WarpSettings(2.0))
    in_m = replace(session, settings=WarpSettings(0.002))
    one, other = body_warp(in_m, bone), body_warp(in_mm, bone)
    places = bone.mesh.vertices
    assert agree(one, other, places) < 1e-12
    np.testing.assert_allclose(one.deviation(places), other.deviation(places), rtol=1e-6)


def raw_session(folder, warp=subject, **options):
    """A session on the mesh's file as it is, in the file's frame."""
    file = read_mesh(folder / "Geometry" / "thigh.vtp")
    return Session(file, landmarks=paired(file.mesh.vertices, warp, **options))


def test_a_session_on_the_mesh_file_goes_through_its_frame(tmp_path):
    path = copied_model("leg_nested_frames", tmp_path)
    bone = bone_in(path)
    ((_, at),) = bone.meshes
    raw = raw_session(tmp_path)
    moved = [replace(each, source=tuple(at.out([each.source])[0])) for each in raw.landmarks]
    on_body = Session(bone.file, landmarks=tuple(moved))
    assert agree(body_warp(raw, bone), body_warp(on_body, bone), bone.mesh.vertices) < 1e-9


@pytest.mark.parametrize("is_other_side", [False, True])
@pytest.mark.parametrize("scale", ["1 1.1 1", "0.9 1.1 -1.05", "1.1 1.1 1.1", "1 1 -1"])
def test_a_session_on_the_mesh_file_goes_through_the_factors_it_is_drawn_with(
    tmp_path, scale, is_other_side
):
    path = edited_model(
        copied_model("leg", tmp_path),
        ("<mesh_file>thigh.vtp", f"<scale_factors>{scale}</scale_factors><mesh_file>thigh.vtp"),
    )
    factors = np.array(scale.split(), dtype=float)
    mirror = np.array([1, 1, -1 if is_other_side and factors[2] < 0 else 1])
    # Where the model mirrors the mesh, the file may be paired with either of the subject's legs.
    raw = raw_session(tmp_path, lambda places: subject(places * factors) * mirror)
    places = np.array([each.source for each in raw.landmarks]) * factors
    carried, expected = body_warp(raw, bone_in(path)).warp(places), subject(places)
    np.testing.assert_allclose(
        np.linalg.norm(carried[:, None] - carried, axis=-1),
        np.linalg.norm(expected[:, None] - expected, axis=-1),
        atol=1e-9,
    )
    # Not only the distances: it is no mirror image.
    one, other = (np.linalg.det(x[1:4] - x[0]) for x in (carried, expected))
    assert np.sign(one) == np.sign(other)


def test_a_session_that_mirrors_its_source_makes_the_same_of_the_body(leg):
    bone, session = bone_in(leg), session_on(leg, "thigh")
    mesh = bone.file.mesh
    mirrored = tuple(
        replace(
            each,
            source=tuple(mirrored_points([each.source], mesh, "z")[0]),
            destination=tuple(np.array(each.destination) * [1, -1, 1]),
        )
        for each in session.landmarks
    )
    seen = replace(
        bone.file, mesh=mesh.with_vertices(mirrored_points(mesh.vertices, mesh, "z")), mirrored="z"
    )
    one = body_warp(session, bone)
    other = body_warp(Session(seen, landmarks=mirrored), bone)
    assert agree(one, other, mesh.vertices) < 1e-9


def test_a_session_on_a_bone_is_saved_and_opened_with_the_models_mesh(leg):
    path = session_file(leg, "thigh")
    text = path.read_text()
    assert "leg.osim#/bodyset/thigh sha256=" in text
    opened = read_session(path)
    assert len(opened.mesh(Side.SOURCE).vertices) == 92
    assert opened.source.path == bone_path(leg, "/bodyset/thigh")
    assert opened.source.notes == ()
    assert solved(opened).mesh is not None
    # Anything else of the model may change, but not the mesh.
    edited_model(leg, ("<mass>2</mass>", "<mass>3</mass>"))
    assert read_session(path).source.notes == ()
    (leg.parent / "Geometry" / "shank.obj").rename(leg.parent / "Geometry" / "thigh.vtp2")
    edited_model(leg, ("thigh.vtp", "hip.obj"))
    assert "has changed" in read_session(path).source.notes[0]


def test_landmarks_that_nobody_has_looked_at_are_told(leg):
    session = session_on(leg, "thigh")
    first, *rest = session.landmarks
    session = replace(session, landmarks=(first.suggested(first.destination), *rest))
    (note,) = body_warp(session, bone_in(leg)).notes
    assert note == "thigh: 1 landmark was only suggested: nobody has looked there yet."


def test_a_warp_that_folds_is_told(leg):
    session = session_on(leg, "thigh")
    first, second, *rest = session.landmarks
    swapped = (
        replace(first, destination=second.destination),
        replace(second, destination=first.destination),
    )
    notes = body_warp(replace(session, landmarks=(*swapped, *rest)), bone_in(leg)).notes
    assert "The warp folds at" in notes[0]


def test_a_session_whose_model_is_gone_keeps_its_reference(leg):
    path = session_file(leg, "thigh")
    leg.unlink()
    assert isinstance(read_session(path).source, MeshReference)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda leg: replace(session_on(leg, "thigh"), landmarks=()), "no pair"),
        (lambda leg: session_on(leg, "shank"), "was made on /bodyset/shank"),
        (
            lambda leg: session_on(leg, "thigh", unit=1000.0),
            "1,079 times as large .* scale the source by 1000",
        ),
        (lambda leg: session_on(leg, "thigh", unit=0.1), "0.11 times as large"),
        (lambda leg: session_on(leg, "thigh", unit=12.0), "Check that both are the same bone"),
        (
            lambda leg: replace(session_on(leg, "hip"), source=None),
            "landmarks of its session lie on that body's mesh",
        ),
    ],
)
def test_a_session_that_does_not_fit_the_body_is_refused(leg, make, words):
    with pytest.raises(PinwarpError, match=words):
        body_warp(make(leg), bone_in(leg))


def test_a_mesh_file_that_the_body_does_not_have_is_told(leg):
    session = replace(session_on(leg, "thigh"), source=read_mesh(leg.parent / "Geometry/hip.obj"))
    assert "hip.obj is none of its meshes" in body_warp(session, bone_in(leg)).notes[0]
    none = replace(session, source=None, landmarks=session.landmarks[:3])
    assert len(body_warp(none, bone_in(leg)).notes) == 2, "no mesh, and few pairs"


def test_two_sessions_for_one_body_are_refused(leg):
    session = session_on(leg, "thigh")
    with pytest.raises(PinwarpError, match="thigh has two sessions"):
        study_of(read_model(leg), [("thigh", session), ("/bodyset/thigh", session)])


@pytest.mark.parametrize(
    ("rules", "words"),
    [
        ({"keep": ["/forceset/rf/path/rf-P9"]}, "rf-P9 cannot be kept"),
        ({"turn": ["/forceset/rf/path/rf-P2"]}, "rf-P2 cannot be turned: it is no frame"),
        (
            {"keep": ["/forceset/rf/path/rf-P3"]},
            "rf-P3 cannot be kept",
        ),
    ],
)
def test_a_rule_for_what_is_not_there_is_refused(leg, rules, words):
    study = study_of(read_model(leg), {"thigh": session_on(leg, "thigh")}, **rules)
    with pytest.raises(PinwarpError, match=words):
        warped_model(study)


def test_several_bodies_are_carried_from_the_same_model_and_nothing_is_told_twice(leg, tmp_path):
    sessions = {name: session_on(leg, name) for name in ("hip", "thigh", "shank")}
    warped = warped_model(study_of(read_model(leg), sessions))
    keys = [(row.path, row.kind) for row in warped.rows]
    assert len(keys) == len(set(keys))
    new = tmp_path / "anna.osim"
    write_model(warped, new)
    before, after = Kinematics(leg), Kinematics(new)
    for body, each in zip(warped.bodies, warped.warps, strict=True):
        for point in body.parts.points:
            expected = each.warp(before.point_in_body(point.path)[None])[0]
            assert np.abs(after.point_in_body(point.path) - expected).max() < 1e-12
    # One after the other makes the same: no body's warp depends on another's.
    alone = warped_model(study_of(read_model(leg), {"thigh": sessions["thigh"]}))
    for key, values in alone.bodies[0].values.items():
        for name, value in values.items():
            np.testing.assert_array_equal(warped.bodies[1].values[key][name], value)


def test_a_model_is_written_with_its_meshes_and_a_row_for_every_element(leg, tmp_path):
    warped = warped_model(study_of(read_model(leg), {"thigh": session_on(leg, "thigh")}))
    files = write_model(warped, tmp_path / "anna.osim")
    assert [file.relative_to(tmp_path).as_posix() for file in files] == [
        "anna.osim",
        "anna_report.csv",
        "anna_Geometry/thigh_thigh.vtp",
    ]
    with files[1].open(newline="") as report:
        rows = list(csv.DictReader(report))
    assert len(rows) == len(warped.rows)
    knee = next(row for row in rows if row["path"] == "/markerset/KNEE")
    assert knee["outcome"] == "warped"
    assert float(knee["moved_mm"]) > 1
    assert float(knee["plus_minus_mm"]) > 0
    # The new model is one whose bone can be opened, and it is the warped bone.
    bone = read_bone(bone_path(files[0], "/bodyset/thigh"))
    np.testing.assert_allclose(
        bone.mesh.vertices, warped.warps[0].warp(bone_in(leg).mesh.vertices), atol=1e-12
    )


def test_what_is_there_is_replaced_only_when_asked_for_and_inputs_never(leg, tmp_path):
    path = session_file(leg, "thigh")
    warped = warped_model(study_of(read_model(leg), {"thigh": path}))
    (tmp_path / "anna_report.csv").write_text("mine")
    with pytest.raises(PinwarpError, match=r"anna_report\.csv is there already"):
        write_model(warped, tmp_path / "anna.osim")
    assert sorted(os.listdir(tmp_path)) == [
        *("Geometry", "anna_report.csv", "leg.osim", "thigh.pinwarp.csv"),
    ]
    write_model(warped, tmp_path / "anna.osim", force=True)
    with pytest.raises(PinwarpError, match="would be replaced, but it is read"):
        write_model(warped, leg, force=True)
    with pytest.raises(PinwarpError, match=r"ends in \.osim"):
        write_model(warped, tmp_path / "anna.csv")


def test_a_failure_half_way_leaves_nothing_behind(leg, tmp_path, monkeypatch):
    warped = warped_model(study_of(read_model(leg), {"thigh": session_on(leg, "thigh")}))

    def full(*_arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pinwarp.session.model.writing.write_atomically", full)
    with pytest.raises(OSError, match="No space"):
        write_model(warped, tmp_path / "anna.osim")
    assert sorted(os.listdir(tmp_path)) == ["Geometry", "leg.osim"]


def test_a_mesh_that_is_missing_is_an_error_only_for_a_body_that_is_warped(leg):
    study = study_of(read_model(leg), {"thigh": session_on(leg, "thigh")})
    (leg.parent / "Geometry" / "hip.obj").unlink()
    warped_model(study)
    (leg.parent / "Geometry" / "thigh.vtp").rename(leg.parent / "thigh.vtp2")
    with pytest.raises(FileFormatError, match=r"thigh_geom: Its mesh thigh\.vtp"):
        warped_model(study)
    elsewhere = leg.parent / "more"
    elsewhere.mkdir()
    (leg.parent / "thigh.vtp2").rename(elsewhere / "thigh.vtp")
    warped_model(replace(study, folders=(elsewhere,)))


def test_a_study_is_written_and_read_again(leg, tmp_path):
    path = session_file(leg, "thigh")
    hip = session_file(leg, "hip")
    frame, kept = "/jointset/knee/knee_parent", "/markerset/KNEE"
    model = read_model(leg)
    study = ModelStudy(
        model,
        (
            StudyBody("/bodyset/thigh", read_session(path), turns=True, note="=1+1", path=path),
            StudyBody("/bodyset/hip", read_session(hip), enabled=False, path=hip),
        ),
        frozenset({frame}),
        frozenset({kept}),
    )
    write_study(tmp_path / "leg.pinwarp-model.csv", study)
    again = read_study(tmp_path / "leg.pinwarp-model.csv")
    assert (again.turn, again.keep, again.notes) == (study.turn, study.keep, ())
    for one, other in zip(study.bodies, again.bodies, strict=True):
        assert (one.body, one.turns, one.enabled, one.note, one.path) == (
            *(other.body, other.turns, other.enabled, other.note, other.path),
        )
    warped = warped_model(again)
    assert [body.parts.name for body in warped.bodies] == ["thigh"], "the hip is not enabled"
    edited_model(leg, ("<mass>2</mass>", "<mass>3</mass>"))
    assert "has changed" in read_study(tmp_path / "leg.pinwarp-model.csv").notes[0]


def test_a_session_without_a_file_cannot_be_named_by_a_study(leg, tmp_path):
    study = study_of(read_model(leg), {"thigh": session_on(leg, "thigh")})
    with pytest.raises(PinwarpError, match="save it first"):
        write_study(tmp_path / "leg.pinwarp-model.csv", study)


def test_a_muscle_that_spans_a_warped_body_without_touching_it_is_named_too(leg):
    # It runs from the hip to the shank; its length changes with the thigh's.
    edited_model(
        leg,
        ("<location>0.03 -0.37 0</location>", "<location>0.05 -0.1 0.05</location>"),
        (
            "<socket_parent_frame>/bodyset/thigh</socket_parent_frame><location>0.05",
            "<socket_parent_frame>/bodyset/hip</socket_parent_frame><location>0.05",
        ),
    )
    model = read_model(leg)
    thigh, hip = (bone_of(model, f"/bodyset/{name}").parts for name in ("thigh", "hip"))
    assert not any(point.path.startswith("/forceset/rf") for point in thigh.points)
    for parts in (thigh, hip):
        assert "/forceset/rf" in {part.path for part in parts.kept}
    shank = bone_of(model, "/bodyset/shank").parts
    assert "/forceset/add" not in {part.path for part in shank.kept}


def refined(session: Session, places: np.ndarray) -> Session:
    """Return a session as it is when it was refined: fitted to further places of its surface."""
    landmarks = session.landmarks
    fitted = paired(places, count=60)
    every = (*landmarks, *fitted[len(landmarks) :])
    both = [[each.position(side) for each in every] for side in Side]
    record = RefinementRecord(*map(tuple, both), 0.01, inputs=inputs_of(session))
    return replace(session, refinement=record)


def test_a_refined_warp_is_carried_through_the_frame_of_its_mesh(tmp_path):
    bone = bone_in(copied_model("leg_nested_frames", tmp_path))
    ((_, at),) = bone.meshes
    plain = raw_session(tmp_path, count=8)
    session = refined(plain, plain.mesh(Side.SOURCE).vertices)
    warp = body_warp(session, bone)
    # What the session itself makes of a place, in the frame of the mesh.
    places = bone.mesh.vertices
    itself = solved(session).part(Components.WITHOUT_POSE)
    np.testing.assert_allclose(warp.warp(places), at.out(itself.evaluate(at.into(places))))
    assert agree(warp, body_warp(plain, bone), places) > 1e-4
    assert warp.deviation is None, "what was fitted to a surface says nothing of its error"


def test_a_refined_session_on_a_file_that_is_drawn_stretched_is_refused(tmp_path):
    path = edited_model(
        copied_model("leg", tmp_path),
        ("<mesh_file>thigh.vtp", "<scale_factors>1 1.1 1</scale_factors><mesh_file>thigh.vtp"),
    )
    plain = raw_session(tmp_path, count=8)
    session = refined(plain, plain.mesh(Side.SOURCE).vertices)
    with pytest.raises(PinwarpError, match="Open the body itself as the source: thigh of leg"):
        body_warp(session, bone_in(path))
