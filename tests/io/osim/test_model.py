"""Models: their components, sockets and frames, and what is wrong with them."""

from __future__ import annotations

import contextlib
import os

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.errors import FileFormatError
from pinwarp.core.frame_warp import BodyRules, CarriedFrames
from pinwarp.core.placement import HERE
from pinwarp.io.osim.body_parts import body_parts
from pinwarp.io.osim.geometry import joined, read_meshes
from pinwarp.io.osim.reading import read_model
from tests.osim_kinematics import Kinematics
from tests.osim_models import NAMES, copied_model, edited_model, model_file


@pytest.fixture
def leg(tmp_path):
    return copied_model("leg", tmp_path)


@pytest.fixture
def nested(tmp_path):
    return copied_model("leg_nested_frames", tmp_path)


def test_components_have_the_paths_that_opensim_gives_them():
    assert {
        "/bodyset/thigh",
        "/bodyset/thigh/thigh_geom",
        "/bodyset/thigh/wrapobjectset/knee_wrap",
        "/jointset/knee/knee_parent",
        "/jointset/knee/knee_angle",
        "/forceset/rf/path/rf-P3",
        "/forceset/rf/path/w0",
        "/markerset/KNEE",
    } <= set(read_model(model_file("leg")).components)


def test_the_path_of_a_muscle_is_called_path_whatever_its_name_says():
    old = read_model(model_file("leg_splined_knee"))
    assert "/forceset/vas_r/path/vas-P1" in old.components
    point = old.components["/forceset/vas_r/path/vas-P1"]
    assert old.frame_of(point, "socket_parent_frame") == "/bodyset/thigh_r"


@pytest.mark.parametrize(
    ("name", "body", "expected"),
    [
        (
            "leg",
            "thigh",
            {
                "path point": ["rf-P2", "add-P2"],
                "conditional path point": ["ham-P2"],
                "marker": ["KNEE", "HIP"],
            },
        ),
        ("leg_splined_knee", "thigh_l", {"path point": ["vas-P1"], "marker": ["KNEE_l"]}),
        (
            "leg_nested_frames",
            "thigh",
            {
                "path point": ["rf-P2", "g-P3"],
                "station": ["head", "lat", "med", "mid"],
                "marker": ["KNEE"],
            },
        ),
        ("leg_nested_frames", "hip", {"path point": ["rf-P1", "g-P1", "g-P2"]}),
    ],
)
def test_points_are_found_on_their_body_through_every_frame(name, body, expected):
    model = read_model(model_file(name))
    found: dict[str, list[str]] = {}
    for point in body_parts(model, model.body(body)).points:
        found.setdefault(point.kind, []).append(point.path.rsplit("/", 1)[-1])
    assert found == expected


def test_frames_of_one_name_in_two_joints_are_told_apart_by_their_sockets():
    model = read_model(model_file("leg_splined_knee"))
    for side in "rl":
        frames = body_parts(model, f"/bodyset/thigh_{side}").frames
        assert set(frames) == {
            f"/jointset/hip_{side}/hip_{side}_child",
            f"/jointset/knee_{side}/thigh_offset",
        }


def test_all_meshes_of_a_body_are_read_in_its_frame_mirrored_where_a_factor_says_so(tmp_path):
    model = read_model(copied_model("leg_splined_knee", tmp_path))
    (right,), (left,) = (read_meshes(model, f"/bodyset/thigh_{side}") for side in "rl")
    assert right.file.path == left.file.path
    one, other = right.part.on(HERE), left.part.on(HERE)
    assert (one.vertices * [1, 1, -1] == other.vertices).all()
    assert (one.faces[:, ::-1] == other.faces).all()
    assert len(joined([one, other]).faces) == 2 * len(one.faces)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([("OpenSimDocument", "Document")], "no model of OpenSim"),
        ([('"40500"', '"30516"')], "Open it once in OpenSim 4 and save it"),
        ([('"40500"', '"new"')], "which version"),
        ([("<Model name", "<Tool name"), ("</Model>", "</Tool>")], "no model of OpenSim"),
        (
            [
                (
                    '<PhysicalOffsetFrame name="knee_child"><socket_parent>/bodyset/shank',
                    '<PhysicalOffsetFrame name="knee_child"><socket_parent>/bodyset/shin',
                )
            ],
            "/jointset/knee/knee_child: Its socket_parent is '/bodyset/shin'",
        ),
        (
            [
                (
                    '<PhysicalOffsetFrame name="knee_child"><socket_parent>/bodyset/shank',
                    '<PhysicalOffsetFrame name="knee_child"><socket_parent>/forceset/rf',
                )
            ],
            "is a Thelen2003Muscle, which is no frame",
        ),
        # OpenSim takes no sibling's name either.
        (
            [
                (
                    "<socket_parent_frame>/bodyset/hip</socket_parent_frame><location>0.05 0 0.05",
                    "<socket_parent_frame>hip</socket_parent_frame><location>0.05 0 0.05",
                )
            ],
            "rf-P1: .* 'hip'",
        ),
    ],
)
def test_what_is_no_model_that_can_be_warped_is_refused(leg, changes, words):
    with pytest.raises(FileFormatError, match=words):
        read_model(edited_model(leg, *changes))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([("<location>0.03 -0.37 0<", "<location>0.03 -0.37<")], "rf-P2: location has 2 numbers"),
        ([("<location>0.03 -0.37 0<", "<location>0.03 nan 0<")], "rf-P2: location is '0.03 nan 0'"),
        ([("<location>0.03 -0.37 0<", "<location>0.03 1_0 0<")], "rf-P2: location is '0.03 1_0"),
        ([("<radius>0.022<", "<radius>0<")], "knee_wrap: Its size is not above 0"),
        (
            [("<orientation>0.05 0.1 0<", "<orientation>one 0 0<")],
            "knee_parent: orientation is 'one 0 0'",
        ),
    ],
)
def test_a_number_that_cannot_be_used_is_named_with_its_element(leg, changes, words):
    model = read_model(edited_model(leg, *changes))
    with pytest.raises(FileFormatError, match=words) as found:
        body_parts(model, "/bodyset/thigh")
    assert found.value.line


def test_frames_that_stand_on_each_other_in_a_circle_are_refused(nested):
    edited_model(
        nested,
        (
            "<socket_parent>..</socket_parent><attached",
            "<socket_parent>/bodyset/thigh/hip_frame</socket_parent><attached",
        ),
    )
    model = read_model(nested)
    with pytest.raises(FileFormatError, match="stands on itself"):
        body_parts(model, "/bodyset/thigh")


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ([("<ab_axis>+y<", "<ab_axis>up<")], "hip_frame: Of its axes"),
        (
            [("<socket_point_a>/bodyset/thigh/mid<", "<socket_point_a>/bodyset/thigh/top<")],
            "nothing of that path",
        ),
        ([("<socket_point_a>/bodyset/thigh/mid<", "<socket_point_a>/bodyset/hip<")], "no station"),
    ],
)
def test_a_frame_of_stations_that_are_none_is_refused(nested, changes, words):
    model = read_model(edited_model(nested, *changes))
    with pytest.raises(FileFormatError, match=words):
        body_parts(model, "/bodyset/thigh")


def test_a_missing_mesh_is_an_error_that_names_element_and_folder(leg):
    os.remove(leg.parent / "Geometry" / "thigh.vtp")
    with pytest.raises(FileFormatError, match=r"thigh_geom: Its mesh thigh\.vtp .*Geometry"):
        read_meshes(read_model(leg), "/bodyset/thigh")


def test_an_unknown_body_is_told_with_those_that_are_there():
    with pytest.raises(FileFormatError, match=r"no body 'femur' in it\. It has hip, thigh, shank"):
        read_model(model_file("leg")).body("femur")


@pytest.mark.parametrize("name", NAMES)
def test_frames_are_where_an_independent_kinematics_has_them(name):
    model, other = read_model(model_file(name)), Kinematics(model_file(name))
    for body in model.bodies:
        parts = body_parts(model, body)
        frames = CarriedFrames(parts, lambda x: x, BodyRules())
        for path in parts.frames:
            expected = other.in_body(path)
            assert abs(frames.before(path).rotation - expected[:3, :3]).max() < 1e-15
            assert abs(frames.before(path).origin - expected[:3, 3]).max() < 1e-15


@given(st.integers(0, 6000), st.binary(min_size=1, max_size=6))
def test_a_damaged_model_is_read_or_refused_in_words(tmp_path_factory, place, junk):
    path = tmp_path_factory.getbasetemp() / "damaged.osim"
    data = model_file("leg").read_bytes()
    path.write_bytes(data[:place] + junk + data[place + len(junk) :])
    with contextlib.suppress(FileFormatError):
        # Any other error fails the test.
        model = read_model(path)
        for body in model.bodies:
            body_parts(model, body)


@given(st.integers(0, 6800))
def test_a_model_that_was_cut_off_is_refused_in_words(tmp_path_factory, size):
    path = tmp_path_factory.getbasetemp() / "cut.osim"
    path.write_bytes(model_file("leg").read_bytes()[:size])
    with pytest.raises(FileFormatError, match=r"cut\.osim"):
        read_model(path)
