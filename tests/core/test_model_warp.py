"""Bodies carried through known warps, part by part."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.coordinate_function import CoordinateFunction, FunctionKind
from pinwarp.core.inside import is_inside
from pinwarp.core.local_affine import directions, local_affine
from pinwarp.core.mesh import Mesh
from pinwarp.core.model_parts import (
    BodyParts,
    JointPart,
    KeptPart,
    MeshPart,
    OffsetPart,
    PointPart,
    StationFramePart,
    TrajectoryPart,
    WrapPart,
    WrapShape,
)
from pinwarp.core.model_rows import Outcome
from pinwarp.core.model_warp import BodyRules, warp_body
from pinwarp.core.placement import Placement, turn_in_degrees

BODY = "/bodyset/thigh"
ANGLES = st.tuples(*[st.floats(-1.4, 1.4)] * 3)
PLACES = st.tuples(*[st.floats(-0.4, 0.4)] * 3)
TURN = Placement.from_angles([0.1, -0.2, 0.15], [0.01, 0.02, -0.03])


def stretched(places):
    """Scale by 0.9, 1.1 and 1.05, turn and move."""
    return TURN.out(np.asarray(places) * [0.9, 1.1, 1.05])


def bent(places):
    x, y, z = np.asarray(places).T
    return np.column_stack([x + 0.05 * np.sin(8 * y), 1.1 * y, z + 0.3 * x * y])


def about(key, path, kind="thing"):
    return {"key": key, "path": path, "kind": kind, "line": key}


def point(key, location, frame=BODY, **more):
    return PointPart(
        **about(key, f"/p{key}", "path point"), frame=frame, location=np.array(location), **more
    )


def offset(key, path, placement, frame=BODY):
    return OffsetPart(**about(key, path, "offset frame"), frame=frame, placement=placement)


def body(**parts):
    return BodyParts(BODY, point(0, [0.0, -0.2, 0.0]), **parts)


def row_of(warped, path):
    (row,) = (row for row in warped.rows if row.path == path)
    return row


def box(size=1.0):
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * size
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return Mesh(corners, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


@given(ANGLES, PLACES, ANGLES, PLACES, PLACES, st.booleans())
def test_a_point_in_nested_frames_lands_where_the_warp_takes_it(a, p, b, q, place, turns):
    outer, inner = Placement.from_angles(a, p), Placement.from_angles(b, q)
    parts = body(
        frames={"/a": offset(1, "/a", outer), "/b": offset(2, "/b", inner, "/a")},
        points=(point(3, place, "/b"),),
    )
    warped = warp_body(parts, bent, BodyRules(turns=turns))
    location = warped.values.get(3, {}).get("location", np.array(place))
    # Put together again from the new values alone.
    placed = []
    for key, old in ((1, outer), (2, inner)):
        new = warped.values.get(key, {})
        placed.append(
            Placement.from_angles(
                new.get("orientation", old.angles), new.get("translation", old.origin)
            )
        )
    after = placed[0].holding(placed[1]).out(location[None])
    expected = bent(outer.holding(inner).out(np.array([place])))
    np.testing.assert_allclose(after, expected, atol=1e-12)


def test_a_warp_that_moves_nothing_changes_nothing():
    parts = body(
        frames={"/a": offset(1, "/a", TURN)},
        points=(point(2, [0.1, 0.2, 0.3], "/a"),),
        wraps=(wrap(3, WrapShape.CYLINDER, [0.02, 0.1], "/a"),),
        trajectories=(way(4, [spline(0, 0.1, 0.3, 0.1), constant(0.1), constant(0)]),),
    )
    warped = warp_body(parts, lambda x: x.copy())
    assert (warped.values, warped.functions) == ({}, {})


def test_frames_keep_their_orientation_and_a_large_turn_is_flagged():
    def turned(places):
        return Placement.from_angles([0, 0.2, 0], [0, 0, 0]).out(places)

    frames = {"/a": offset(1, "/a", TURN)}
    kept = warp_body(body(frames=frames), turned)
    assert "orientation" not in kept.values[1]
    row = row_of(kept, "/a")
    assert (row.outcome, row.is_warped) == (Outcome.FLAGGED, True)
    assert row.turned == pytest.approx(np.degrees(0.2))
    assert "turns by 11.5°" in row.flag
    followed = warp_body(body(frames=frames), turned, BodyRules(turn=frozenset({"/a"})))
    expected = Placement.from_angles([0, 0.2, 0], [0, 0, 0]).rotation @ TURN.rotation
    np.testing.assert_allclose(followed.frames["/a"].rotation, expected, atol=1e-12)
    assert row_of(followed, "/a").outcome is Outcome.WARPED


def test_a_frame_of_stations_is_left_to_opensim_and_its_children_go_with_it():
    places = np.array([[0, -0.4, 0], [0, 0, 0], [0, -0.4, 0.05], [0, 0, 0.01]])
    points = tuple(point(key, place) for key, place in enumerate(places, 1))
    frame = StationFramePart(
        **about(5, "/s"), stations=(1, 2, 3, 4), ab_axis="+y", ab_x_ac_axis="-x"
    )
    warped = warp_body(
        body(frames={"/s": frame}, points=(*points, point(6, [0.01, 0, 0], "/s"))), bent
    )
    assert 5 not in warped.values
    new = np.array([warped.values.get(k, {}).get("location", places[k - 1]) for k in (1, 2, 3, 4)])
    long = new[1] - new[0]
    np.testing.assert_allclose(warped.frames["/s"].rotation[:, 1], long / np.linalg.norm(long))
    carried = warped.frames["/s"].out(warped.values[6]["location"][None])
    before = warp_body(body(frames={"/s": frame}, points=points), lambda x: x).frames["/s"]
    np.testing.assert_allclose(
        before.out([[0.01, 0, 0]])[0], before.origin + 0.01 * before.rotation[:, 0]
    )
    np.testing.assert_allclose(carried, bent(before.out([[0.01, 0, 0]])), atol=1e-12)


def wrap(key, shape, size, frame=BODY, placement=TURN):
    return WrapPart(
        **about(key, f"/w{key}", f"wrap {shape.value[4:].lower()}"),
        shape=shape,
        frame=frame,
        placement=placement,
        size=np.array(size, dtype=float),
    )


@pytest.mark.parametrize(
    ("shape", "size"),
    [
        (WrapShape.CYLINDER, [0.02, 0.1]),
        (WrapShape.SPHERE, [0.02]),
        (WrapShape.ELLIPSOID, [0.03, 0.02, 0.01]),
    ],
)
def test_a_wrap_grows_and_turns_with_a_bone_that_grows_and_turns(shape, size):
    rotation = Placement.from_angles([0.3, 0.1, -0.2], [0.1, 0, 0])
    parts = body(wraps=(wrap(1, shape, size),))
    warped = warp_body(parts, lambda x: rotation.out(1.2 * x))
    new = warped.values[1]
    grown = (
        [new["dimensions"]]
        if shape is WrapShape.ELLIPSOID
        else [new["radius"], new.get("length", [])]
    )
    np.testing.assert_allclose(np.concatenate(grown), 1.2 * np.array(size), rtol=1e-9)
    np.testing.assert_allclose(new["translation"], rotation.out(1.2 * TURN.origin[None])[0])
    turned = Placement.from_angles(new["xyz_body_rotation"], [0, 0, 0]).rotation
    axes = slice(2, 3) if shape is WrapShape.CYLINDER else slice(None)
    np.testing.assert_allclose(
        turned[:, axes], (rotation.rotation @ TURN.rotation)[:, axes], atol=1e-9
    )
    assert row_of(warped, "/w1").outcome is Outcome.WARPED


def test_a_cylinder_that_becomes_oval_is_flagged_with_its_range():
    across = Placement.from_angles([0, 0, 0], [0, 0, 0])
    parts = body(wraps=(wrap(1, WrapShape.CYLINDER, [0.02, 0.1], placement=across),))
    warped = warp_body(parts, lambda x: x * [1.0, 1.5, 2.0])
    row = row_of(warped, "/w1")
    assert "no cylinder any more" in row.flag
    np.testing.assert_allclose(warped.values[1]["length"], 0.2)
    assert 0.02 < warped.values[1]["radius"][0] < 0.03


def test_a_muscle_point_that_gets_into_its_wrap_or_the_bone_is_flagged():
    sphere = wrap(1, WrapShape.SPHERE, [0.02], placement=Placement(np.eye(3), np.zeros(3)))
    bone = MeshPart(**about(2, "/m"), frame=BODY, mesh=box(0.05), scale=np.ones(3))
    close = point(3, [0.0, 0.0, 0.025], is_of_path=True, wraps=("/w1",))
    other = point(4, [0.0, 0.0, 0.025], is_of_path=True)
    near = point(5, [0.02, 0.02, 0.055], is_of_path=True)
    parts = body(wraps=(sphere,), meshes=(bone,), points=(close, other, near))

    def pushed(places):
        # What lies just above is pushed in, all else stays.
        places = np.array(places)
        high = (np.abs(places[:, 2] - 0.025) < 1e-9) & (np.abs(places[:, :2]).max(axis=1) < 1e-9)
        places[high, 2] = 0.015
        places[np.abs(places[:, 2] - 0.055) < 1e-9, 2] = 0.045
        return places

    warped = warp_body(parts, pushed)
    assert "inside of w1" in row_of(warped, "/p3").flag
    assert row_of(warped, "/p4").flag == ""
    assert "inside of the warped bone" in row_of(warped, "/p5").flag


def test_a_mirrored_mesh_stays_outside_out():
    bone = MeshPart(**about(1, "/m"), frame=BODY, mesh=box(), scale=np.array([1.0, 1, -1]))
    warped = warp_body(body(meshes=(bone,)), lambda x: 2 * x)
    mesh = warped.meshes[1]

    def volume(mesh):
        return np.linalg.det(mesh.vertices[mesh.faces]).sum() / 6

    assert volume(mesh) == pytest.approx(8 * volume(box()))
    np.testing.assert_allclose(mesh.vertices, 2 * box().vertices * [1, 1, -1])


def constant(value):
    return CoordinateFunction(FunctionKind.CONSTANT, [], [value])


def spline(*values, knots=(-2, -1, 0, 0.5)):
    return CoordinateFunction(FunctionKind.SPLINE, knots, values)


def way(key, functions, frame=BODY, coordinates=None, axes=None):
    named = tuple("" if f.is_constant else "knee" for f in functions)
    return TrajectoryPart(
        **about(key, f"/t{key}", "joint translation"),
        frame=frame,
        axes=np.eye(3) if axes is None else np.array(axes, dtype=float),
        functions=tuple(functions),
        coordinates=coordinates or named,
        function_keys=(10 * key, 10 * key + 1, 10 * key + 2),
    )


@given(ANGLES, st.lists(st.floats(-0.01, 0.01), min_size=8, max_size=8))
def test_a_joint_moves_along_the_warped_way_between_its_knots_too(angles, numbers):
    # Axes need not be x, y and z in turn, nor at right angles.
    axes = np.array([[0, 0.1, 1], [1, 0, 0], [0.2, 1, 0]])
    functions = [
        spline(*numbers[:4]),
        spline(*(numbers[4:] - np.array(0.4)), knots=(-2, -0.6, 0.2, 0.5)),
        constant(0.01),
    ]
    frame = Placement.from_angles(angles, [0.01, 0, 0])
    part = way(2, functions, "/a", axes=axes)
    warped = warp_body(body(frames={"/a": offset(1, "/a", frame)}, trajectories=(part,)), bent)
    where = np.linspace(-2, 0.5, 41)
    old = frame.out(np.array([f(where) for f in functions]).T @ axes.T)
    now = [
        warped.functions[key].function if key in warped.functions else f
        for key, f in zip(part.function_keys, functions, strict=True)
    ]
    new = warped.frames["/a"].out(np.array([f(where) for f in now]).T @ axes.T)
    assert np.linalg.norm(new - bent(old), axis=1).max() < 5e-5
    assert row_of(warped, "/t2").outcome is Outcome.WARPED


def test_a_constant_that_must_move_becomes_a_function_of_the_same_coordinate():
    part = way(1, [constant(0.0), spline(-0.42, -0.4, -0.39, -0.39), constant(0.0)])
    changes = warp_body(body(trajectories=(part,)), bent).functions
    assert changes[10].function.kind is FunctionKind.SPLINE
    assert changes[10].coordinate == "knee"
    assert 12 not in changes, "z stays where x is 0 and nothing is bent"


def test_a_place_that_nothing_moves_stays_constant():
    part = way(1, [constant(0.0), constant(-0.4), constant(0.0)])
    changes = warp_body(body(trajectories=(part,)), stretched).functions
    assert {change.function.kind for change in changes.values()} == {FunctionKind.CONSTANT}
    new = [changes[key].function.values[0] for key in part.function_keys]
    np.testing.assert_allclose(new, stretched([[0, -0.4, 0]])[0])


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (
            {
                "functions": [spline(0, 1, 2, 4), spline(1, 2, 4, 5), constant(0)],
                "coordinates": ("knee", "hip", ""),
            },
            "depends on hip and knee",
        ),
        (
            {
                "functions": [spline(0, 1, 2, 4), constant(0), constant(0)],
                "coordinates": ("knee hip", "", ""),
            },
            "depends on hip and knee",
        ),
        (
            {
                "functions": [
                    spline(0, 1, 2, 4),
                    CoordinateFunction(FunctionKind.LINEAR, [0, 1], [0, 1]),
                    constant(0),
                ]
            },
            "several kinds",
        ),
        (
            {
                "functions": [spline(0, 1, 2, 4), constant(0), constant(0)],
                "axes": [[1, 1, 0], [0, 0, 1], [0, 0, 0]],
            },
            "do not span space",
        ),
    ],
)
def test_a_way_that_cannot_be_carried_is_kept_and_flagged(part, words):
    warped = warp_body(body(trajectories=(way(1, **part),)), stretched)
    row = row_of(warped, "/t1")
    assert (row.outcome, row.is_warped, warped.functions) == (Outcome.FLAGGED, False, {})
    assert words in row.words


def test_what_is_kept_as_asked_for_stays_and_says_so():
    parts = body(
        frames={"/a": offset(1, "/a", TURN)},
        points=(point(2, [0.1, 0, 0]), point(3, [0.1, 0, 0], "/a")),
        wraps=(wrap(4, WrapShape.SPHERE, [0.02]),),
        meshes=(MeshPart(**about(5, "/m"), frame=BODY, mesh=box(), scale=np.ones(3)),),
        trajectories=(way(6, [spline(0, 1, 2, 4), constant(0), constant(0)]),),
    )
    keep = frozenset({"/a", "/p2", "/w4", "/m", "/t6"})
    warped = warp_body(parts, stretched, BodyRules(keep=keep))
    assert set(warped.values) == {0, 3}, "the mass centre and the point that is not kept"
    assert (warped.meshes, warped.functions) == ({}, {})
    assert {row_of(warped, path).outcome for path in keep} == {Outcome.KEPT}
    # The point in the frame that stays goes where the warp takes it all the same.
    at = warped.frames["/a"].out(warped.values[3]["location"][None])
    np.testing.assert_allclose(at, stretched(TURN.out([[0.1, 0, 0]])))


def test_a_joint_on_the_bodys_own_frame_is_flagged_by_how_far_the_bone_moves_there():
    warped = warp_body(body(joints=(JointPart(**about(1, "/j", "joint")),)), lambda x: x + 0.02)
    row = row_of(warped, "/j")
    assert row.moved == pytest.approx(0.02 * np.sqrt(3))
    assert "34.6 mm" in row.flag
    still = warp_body(body(joints=(JointPart(**about(1, "/j", "joint")),)), lambda x: 1.2 * x)
    assert row_of(still, "/j").outcome is Outcome.KEPT


def test_no_part_is_silent_and_the_deviation_is_told_in_the_bodys_unit():
    kept = KeptPart(**about(9, "/k"), words="no rule", flag="Look at it.")
    parts = body(points=(point(1, [0.1, 0, 0]),), kept=(kept,))
    warped = warp_body(parts, stretched, deviation=lambda x: 0.001 * np.ones(len(x)))
    assert sorted((row.path, row.outcome.value) for row in warped.rows) == [
        ("/k", "flagged"),
        ("/p0", "kept"),
        ("/p0", "warped"),
        ("/p1", "warped"),
    ], "the body's own row is there for its origin and its mass centre"
    assert row_of(warped, "/p1").plus_minus == 0.001
    assert row_of(warped, "/k").as_json()["moved"] is None


@given(st.tuples(*[st.floats(-0.5, 1.5)] * 3))
def test_inside_of_a_box_is_inside_of_its_sides(place):
    margin = min(min(place), min(1 - x for x in place))
    if abs(margin) > 1e-6:
        assert is_inside(box(), [place])[0] == (margin > 0)


def test_the_local_turn_is_that_of_the_object_not_of_the_cone_at_a_landmark():
    def cone(places):
        # As a spline is at a landmark: its derivative at the tip is anything.
        return places + 0.3 * np.linalg.norm(places, axis=1)[:, None] * [1.0, 0, 0]

    fit = local_affine(cone, np.zeros(3), 0.02 * directions())
    assert turn_in_degrees(fit.rotation) < 1e-6
    assert fit.misfit > 0
