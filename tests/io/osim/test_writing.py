"""Warped models written and read again, checked by a kinematics of their own."""

from __future__ import annotations

import numpy as np
import pytest

from pinwarp.core.model_warp import BodyRules, warp_body
from pinwarp.io.meshes import write_mesh
from pinwarp.io.osim.body_parts import body_parts
from pinwarp.io.osim.geometry import read_meshes
from pinwarp.io.osim.reading import read_model
from pinwarp.io.osim.writing import mesh_names, spliced
from tests.osim_kinematics import Kinematics
from tests.osim_models import NAMES, copied_model, edited_model, subject

SPLINE = (
    '<SimmSpline name="function"><x>-2 -0.6 0 0.2</x><y>-0.42 -0.4 -0.396 -0.396</y></SimmSpline>'
)


def warped_copy(path, bodies, rules=None, warp=subject, name="new"):
    """Warp bodies of a model and write it beside itself; return it and the warped bodies."""
    model = read_model(path)
    warped = []
    for body in bodies:
        meshes = [mesh.part for mesh in read_meshes(model, model.body(body))]
        warped.append(warp_body(body_parts(model, model.body(body), meshes), warp, rules))
    meshes = {key: mesh for each in warped for key, mesh in each.meshes.items()}
    names = mesh_names(model, meshes, f"{name}_Geometry")
    (path.parent / f"{name}_Geometry").mkdir()
    for key, mesh in meshes.items():
        write_mesh(path.parent / names[key], mesh)
    new = path.parent / f"{name}.osim"
    new.write_bytes(spliced(model, warped, names))
    return new, warped


def points_on(path, body):
    model = read_model(path)
    return [point.path for point in body_parts(model, model.body(body)).points]


@pytest.mark.parametrize(
    ("name", "body"),
    [("leg", "thigh"), ("leg_splined_knee", "thigh_l"), ("leg_nested_frames", "thigh")],
)
@pytest.mark.parametrize("turns", [False, True])
def test_points_are_where_the_warp_takes_them_when_read_by_another_program(
    tmp_path, name, body, turns
):
    path = copied_model(name, tmp_path)
    before = Kinematics(path)
    new, _ = warped_copy(path, [body], BodyRules(turns=turns))
    after = Kinematics(new)
    points = points_on(path, body)
    assert len(points) >= 2
    for point in points:
        expected = subject(before.point_in_body(point)[None])[0]
        assert np.abs(after.point_in_body(point) - expected).max() < 1e-12, point


@pytest.mark.parametrize("turns", [False, True])
def test_the_shank_stays_with_the_end_of_a_femur_whose_length_is_in_the_knees_splines(
    tmp_path, turns
):
    path = copied_model("leg_splined_knee", tmp_path)
    new, _ = warped_copy(path, ["thigh_r"], BodyRules(turns=turns))
    left_alone, _ = warped_copy(
        path, ["thigh_r"], BodyRules(turns, keep=frozenset({"/jointset/knee_r"})), name="alone"
    )
    far = []
    for angle in np.linspace(-2, 0.2, 23):
        where = {"knee_angle_r": angle}
        models = (Kinematics(file, **where) for file in (path, new, left_alone))
        # The shank's origin as seen from the thigh, before and after.
        before, after, alone = (
            (np.linalg.inv(m.in_ground("/bodyset/thigh_r")) @ m.in_ground("/bodyset/shank_r"))[
                :3, 3
            ]
            for m in models
        )
        expected = subject(before[None])[0]
        far.append([np.linalg.norm(after - expected), np.linalg.norm(alone - expected)])
    assert np.max(far, axis=0)[0] < 5e-5, "0.05 mm"
    assert np.min(far, axis=0)[1] > 0.02, "two centimetres, where only the frames are carried"


def test_a_joint_on_frames_of_stations_stays_between_the_bones(tmp_path):
    path = copied_model("leg_nested_frames", tmp_path)
    new, _ = warped_copy(path, ["thigh"])
    before, after = Kinematics(path), Kinematics(new)
    # The head stays in the socket, and the shank hangs from the middle of the condyles.
    np.testing.assert_allclose(
        after.point_in_ground("/bodyset/thigh/head"),
        before.point_in_ground("/bodyset/thigh/head"),
        atol=1e-12,
    )
    np.testing.assert_allclose(
        after.in_ground("/bodyset/shank")[:3, 3],
        after.point_in_ground("/bodyset/thigh/mid"),
        atol=1e-12,
    )


@pytest.mark.parametrize("name", NAMES)
def test_only_what_was_carried_is_another_line(tmp_path, name):
    path = copied_model(name, tmp_path)
    body = "thigh_r" if "splined" in name else "thigh"
    new, (warped,) = warped_copy(path, [body])
    lines, others = path.read_bytes().split(b"\n"), new.read_bytes().split(b"\n")
    assert len(lines) == len(others)
    changed = {i for i, (a, b) in enumerate(zip(lines, others, strict=True), 1) if a != b}
    model = read_model(path)
    allowed = set()
    for key in (*warped.values, *warped.functions, *warped.meshes):
        element = model.elements[key]
        last = element.line + model.data[element.begin : element.end].count(b"\n")
        allowed |= set(range(element.line, last + 1))
    assert changed
    assert changed <= allowed


@pytest.mark.parametrize("name", NAMES)
def test_a_warp_that_moves_nothing_changes_nothing_but_the_names_of_meshes(tmp_path, name):
    path = copied_model(name, tmp_path)
    body = "thigh_l" if "splined" in name else "thigh"
    model = read_model(path)
    warped = warp_body(body_parts(model, model.body(body)), lambda x: x.copy())
    assert spliced(model, [warped], {}) == path.read_bytes()


def test_meshes_are_drawn_where_the_warp_takes_the_bone_without_factors(tmp_path):
    path = copied_model("leg_splined_knee", tmp_path)
    new, _ = warped_copy(path, ["thigh_r", "thigh_l"])
    old_model, model = read_model(path), read_model(new)
    for side, mirror in (("r", 1), ("l", -1)):
        (old,) = read_meshes(old_model, f"/bodyset/thigh_{side}")
        (mesh,) = read_meshes(model, f"/bodyset/thigh_{side}")
        assert mesh.file.path == tmp_path / "new_Geometry" / f"thigh_{side}_thigh.vtp"
        assert mesh.part.scale.tolist() == [1, 1, 1]
        expected = subject(old.file.mesh.vertices * [1, 1, mirror])
        np.testing.assert_allclose(mesh.part.mesh.vertices, expected, atol=1e-15)
        volume = np.linalg.det(mesh.part.mesh.vertices[mesh.part.mesh.faces]).sum()
        original = np.linalg.det(old.file.mesh.vertices[old.file.mesh.faces]).sum()
        assert np.sign(volume) == np.sign(original), "outside stays outside"


def test_properties_that_opensim_left_out_are_put_in(tmp_path):
    path = edited_model(
        copied_model("leg", tmp_path),
        (
            "<translation>0 0 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame>"
            "</frames></PinJoint>\r\n\t\t\t<PinJoint",
            "</PhysicalOffsetFrame></frames></PinJoint>\r\n\t\t\t<PinJoint",
        ),
        ("<location>0 0 0.06</location>", ""),
        ("<mass_center>0 -0.2 0</mass_center>", "<mass_center />"),
    )
    new, _ = warped_copy(path, ["thigh"], warp=lambda x: x + np.array([0.01, 0.02, 0.03]))
    model = read_model(new)
    frame = model.components["/jointset/hipj/hipj_child"]
    assert model.text(frame, "translation") == "0.01 0.02 0.03"
    assert model.text(model.components["/markerset/HIP"], "location") == "0.01 0.02 0.03"
    assert model.text(model.components["/bodyset/thigh"], "mass_center") == "0.01 0.02 0.03"


def test_a_moving_point_is_carried_at_every_knot(tmp_path):
    path = copied_model("leg", tmp_path)

    def raised(places):
        return places * [1.1, 1.2, 1.3] + 0.2 * places[:, [1, 0, 0]]

    new, _ = warped_copy(path, ["shank"], warp=raised)
    model = read_model(new)
    point = model.components["/forceset/rf/path/rf-P3"]
    found = [model.any_numbers(point.child(f"{axis}_location").children[0], "y") for axis in "xyz"]
    x = [0.02, 0.03, 0.035, 0.036]
    y = [-0.03, -0.025, -0.02, -0.02]
    expected = raised(np.column_stack([x, y, 4 * [0.002]]))
    np.testing.assert_allclose(np.array(found)[:, :4].T[[0, -1]], expected[[0, -1]], atol=1e-12)
    sockets = [model.text(point, f"socket_{axis}_coordinate") for axis in "xyz"]
    assert sockets == 3 * ["/jointset/knee/knee_angle"]


def test_functions_without_knots_are_flagged_and_left_alone(tmp_path):
    path = edited_model(
        copied_model("leg_splined_knee", tmp_path),
        (
            SPLINE,
            '<LinearFunction name="function"><coefficients>1 0</coefficients></LinearFunction>',
        ),
    )
    new, (warped,) = warped_copy(path, ["thigh_r"])
    assert b'LinearFunction name="function"><coefficients>1 0' in new.read_bytes()
    (row,) = (row for row in warped.rows if row.kind == "joint translation")
    assert (row.is_warped, row.outcome.value) == (False, "flagged")
    assert "LinearFunction" in row.words


def test_a_multiplied_function_is_multiplied_out(tmp_path):
    path = edited_model(
        copied_model("leg_splined_knee", tmp_path),
        (
            SPLINE,
            '<MultiplierFunction name="function"><function>'
            + SPLINE.replace(' name="function"', "")
            + "</function><scale>1.5</scale></MultiplierFunction>",
        ),
    )
    plain = edited_model(
        copied_model("leg_splined_knee", tmp_path / "plain"),
        ("<y>-0.42 -0.4 -0.396 -0.396</y>", "<y>-0.63 -0.6 -0.594 -0.594</y>"),
    )
    results = []
    for file in (path, plain):
        new, _ = warped_copy(file, ["thigh_r"])
        model = Kinematics(new, knee_angle_r=-0.7)
        results.append(model.in_ground("/bodyset/shank_r"))
    np.testing.assert_allclose(*results, atol=1e-12)


def test_every_element_that_no_rule_carries_is_named(tmp_path):
    extra = (
        '<ContactGeometrySet name="contactgeometryset"><objects><ContactSphere name="ball">'
        "<socket_frame>/bodyset/thigh</socket_frame></ContactSphere></objects></ContactGeometrySet>"
        '<ConstraintSet name="constraintset"><objects><PointConstraint name="held">'
        "<socket_body_1>/bodyset/thigh</socket_body_1></PointConstraint></objects></ConstraintSet>"
        "</Model>"
    )
    path = edited_model(
        copied_model("leg", tmp_path),
        ("</Model>", extra),
        (
            '<WrapEllipsoid name="head_wrap">',
            '<WrapTorus name="ring"></WrapTorus><WrapEllipsoid name="head_wrap">',
        ),
        (
            '<attached_geometry><Mesh name="thigh_geom">',
            '<attached_geometry><Brick name="block"/><Mesh name="thigh_geom">',
        ),
        (
            "\t\t</objects></ForceSet>",
            '<PointActuator name="push"><body>thigh</body></PointActuator></objects></ForceSet>',
        ),
    )
    _, (warped,) = warped_copy(path, ["thigh"])
    found = {row.path: (row.kind, row.outcome.value) for row in warped.rows}
    assert found["/contactgeometryset/ball"] == ("contact sphere", "flagged")
    assert found["/constraintset/held"] == ("point constraint", "flagged")
    assert found["/bodyset/thigh/wrapobjectset/ring"] == ("wrap torus", "flagged")
    assert found["/bodyset/thigh/block"] == ("drawn shape", "kept")
    assert found["/forceset/push"] == ("point actuator", "flagged")
    assert found["/forceset/rf"] == ("muscle lengths", "kept")
    assert found["/jointset/knee"] == ("joint", "kept")


def test_two_meshes_of_one_file_get_two_names(tmp_path):
    path = edited_model(
        copied_model("leg", tmp_path),
        (
            '<attached_geometry><Mesh name="thigh_geom">',
            '<attached_geometry><Mesh name="again"><mesh_file>thigh.vtp</mesh_file></Mesh>'
            '<Mesh name="thigh_geom">',
        ),
    )
    new, _ = warped_copy(path, ["thigh"])
    names = [mesh.file.path.name for mesh in read_meshes(read_model(new), "/bodyset/thigh")]
    assert names == ["thigh_thigh.vtp", "thigh_thigh_2.vtp"]


def test_a_model_of_odd_elements_saved_by_opensim_has_a_row_for_each(tmp_path):
    path = copied_model("leg_odd_elements", tmp_path)
    _, (warped,) = warped_copy(path, ["thigh"])
    found = {(row.kind, row.path): row for row in warped.rows}
    assert len(found) == len(warped.rows)
    flagged = {kind for (kind, _), row in found.items() if row.flag and not row.is_warped}
    assert flagged == {
        *("bushing force", "contact sphere", "function based path", "imu", "joint"),
        *("point actuator", "point to point spring", "torque actuator", "weld constraint"),
        "wrap torus",
    }
    # Frames that a bushing or a constraint has of its own are carried like any other.
    frames = {path for kind, path in found if kind == "offset frame"}
    assert {"/forceset/bush/thigh_offset", "/constraintset/weld/thigh_offset"} <= frames
    lengths = {path: row.words for (kind, path), row in found.items() if kind == "muscle lengths"}
    assert lengths["/forceset/lig"] == "resting_length 0.1 is the generic muscle's"
    assert "/forceset/spring" in lengths
