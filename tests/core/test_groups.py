from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.core.bones import bone, landmarks, shape

from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import LandmarkError
from pinwarp.core.gathering import course_of, gathered, with_points_over
from pinwarp.core.groups import (
    MOST_POINTS,
    Curve,
    Handle,
    Patch,
    anchored,
    moved_group,
    renamed_anchors,
)
from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.surface import Surface

FINDER = PathFinder(Surface(bone()))


def on_bone(angles, heights):
    """Places on the surface itself."""
    places = shape(np.asarray(angles, float), np.asarray(heights, float))
    return [as_position(place) for place in FINDER.surface.closest(places).positions]


def handles_of(places, anchors=()):
    return tuple(
        Handle(place, landmark=f"lm_{row}" if row in anchors else "")
        for row, place in enumerate(places)
    )


def along(path, points):
    """How far along a path each of its points is, found from the path's corners alone."""
    corners = np.vstack([path.places, path.places[:1]]) if path.is_closed else path.places
    ways = np.diff(corners, axis=0)
    lengths = np.linalg.norm(ways, axis=1)
    found, last = [], 0.0
    for point in points:
        shares = np.clip(np.sum((point - corners[:-1]) * ways, axis=1) / lengths**2, 0, 1)
        off = np.linalg.norm(corners[:-1] + shares[:, None] * ways - point, axis=1)
        at = np.concatenate([[0.0], np.cumsum(lengths)])[:-1] + shares * lengths
        # A path may come near itself: points follow one another.
        off[at < last - 1e-6] = np.inf
        # It cuts corners of the surface that the point is laid on.
        assert off.min() < 0.2
        # Where it closes, the end is the beginning.
        last = float(at[np.flatnonzero(off <= off.min() + 1e-9)[0]])
        found.append(last)
    return np.array(found), float(lengths.sum())


seeds = st.integers(0, 10_000)


def lengthwise(seed, count):
    """Places one after another along the bone."""
    rng = np.random.default_rng(seed)
    heights = 0.5 + 2.1 * (np.arange(count) + 0.5 * rng.random(count)) / count
    return on_bone(rng.uniform(0, 1.0, count), heights)


def around(seed, count, height=1.3):
    rng = np.random.default_rng(seed)
    angles = 2 * np.pi * (np.arange(count) + 0.4 * rng.random(count)) / count
    return on_bone(angles, height + rng.uniform(-0.1, 0.1, count))


# Points along a curve


@settings(max_examples=8)
@given(seeds, st.integers(2, 5), st.integers(2, 25))
def test_points_of_an_open_curve_stand_at_even_distances_from_end_to_end(seed, handles, count):
    places = lengthwise(seed, handles)
    course = course_of(Curve("c", handles_of(places), count=count), FINDER)
    assert len(course.points) == count
    assert course.spans == (course.points,)
    np.testing.assert_allclose([course.points[0], course.points[-1]], [places[0], places[-1]])
    assert FINDER.surface.index.distances(course.points).max() < 1e-9
    at, length = along(course.path, course.points)
    np.testing.assert_allclose(at, np.linspace(0, length, count), atol=1e-3 * length)


@settings(max_examples=8)
@given(seeds, st.integers(3, 6), st.integers(1, 25))
def test_points_of_a_closed_curve_stand_at_even_distances_all_around(seed, handles, count):
    places = around(seed, handles)
    course = course_of(Curve("c", handles_of(places), is_closed=True, count=count), FINDER)
    assert len(course.points) == count
    np.testing.assert_allclose(course.points[0], places[0])
    at, length = along(course.path, course.points)
    np.testing.assert_allclose(at, np.arange(count) * length / count, atol=1e-3 * length)


@settings(max_examples=15)
@given(st.data(), seeds, st.integers(2, 5), st.integers(0, 30), st.booleans())
def test_between_anchors_stand_their_share_of_the_points_and_none_on_an_anchor(
    data, seed, handles, count, is_closed
):
    handles += is_closed
    rows = data.draw(st.sets(st.integers(0, handles - 1), min_size=1))
    places = around(seed, handles) if is_closed else lengthwise(seed, handles)
    curve = Curve("c", handles_of(places, rows), is_closed, count)
    course = course_of(curve, FINDER)
    assert len(course.points) == count
    # One span before the first anchor and one behind each; all around there is no before.
    first = [] if is_closed else [0.0]
    begin = min(rows) if is_closed else 0
    ordered = [*places[begin:], *places[:begin]] if is_closed else places
    is_anchor = [i in rows for i in range(handles)]
    is_anchor = [*is_anchor[begin:], *is_anchor[:begin]]
    at_handles, length = along(course.path, ordered)
    stops = first + [at for at, it_is in zip(at_handles, is_anchor, strict=True) if it_is]
    ends = [*stops[1:], length]
    for span, low, high in itertools.zip_longest(course.spans, stops, ends):
        # An anchor that ends an open curve has nothing behind it.
        if span is None:
            assert low == pytest.approx(length)
            continue
        assert abs(len(span) - count * (high - low) / length) <= 1
        if not span:
            continue
        inside, _ = along(course.path, span)
        assert inside.min() >= low - 0.1
        assert inside.max() <= high + 0.1
        gaps = np.diff(inside)
        np.testing.assert_allclose(gaps, gaps[:1].repeat(len(gaps)), atol=2e-3 * length)
    anchors = [place for row, place in enumerate(places) if row in rows]
    if course.points:
        apart = np.linalg.norm(np.array(course.points)[:, None] - np.array(anchors), axis=2)
        assert apart.min() > 1e-6


def test_a_curve_through_one_place_twice_is_refused_by_its_name():
    place = on_bone([0], [1])[0]
    curve = Curve("crest", handles_of([place, place]), count=3)
    with pytest.raises(LandmarkError, match="crest, on the source: A curve needs at least 2"):
        gathered([curve], {}, FINDER, lambda: FINDER)


# Patches


@settings(max_examples=15)
@given(st.integers(1, 60), st.integers(1, 60))
def test_a_patch_with_fewer_points_has_the_first_of_one_with_more(a, b):
    fewer, more = sorted((a, b))
    taken = [as_position(place) for place in landmarks(6)]
    large = with_points_over(Patch("p"), more, FINDER, taken, ())
    small = with_points_over(Patch("p"), fewer, FINDER, taken, ())
    assert small.points == large.points[:fewer]
    # The slider there and back.
    assert with_points_over(large, fewer, FINDER, taken, ()) == small
    grown = with_points_over(small, more, FINDER, taken, ())
    assert grown.points[:fewer] == small.points
    assert len(set(grown.points)) == more


def test_what_is_excluded_goes_with_its_point():
    patch = with_points_over(Patch("p"), 10, FINDER, (), ())
    patch = replace(patch, excluded=frozenset({2, 7}))
    assert with_points_over(patch, 5, FINDER, (), ()).excluded == {2}
    assert with_points_over(patch, 12, FINDER, (), ()).excluded == {2, 7}


def test_a_patch_inside_a_curve_stays_inside_and_keeps_away_from_its_points():
    ring = Curve("ring", handles_of(around(0, 8, height=0.7)), is_closed=True, count=24)
    top = as_position(on_bone([0], [0.02])[0])
    patch = with_points_over(Patch("cap", (), "ring", top), 30, FINDER, (), (ring,))
    places = np.array(patch.points)
    assert places[:, 2].min() > 100 * np.cos(0.85)
    edge = np.array(course_of(ring, FINDER).points)
    assert np.linalg.norm(places[:, None] - edge, axis=2).min() > 1.0


@pytest.mark.parametrize(
    ("patch", "words"),
    [
        (Patch("cap", (), "none"), "cap: there is no curve called none"),
        (Patch("cap", (), "line", (0, 0, 100)), "Only a closed curve"),
        (Patch("cap", (), "ring"), "Which side of the curve"),
    ],
)
def test_a_patch_that_cannot_be_spread_says_why(patch, words):
    line = Curve("line", handles_of(lengthwise(0, 3)))
    ring = Curve("ring", handles_of(around(0, 5)), is_closed=True)
    with pytest.raises(LandmarkError, match=words):
        with_points_over(patch, 10, FINDER, (), (line, ring))


# Groups put together


@settings(max_examples=12)
@given(st.data(), seeds)
def test_what_takes_part_is_gathered_in_order_and_what_is_excluded_is_not(data, seed):
    count = data.draw(st.integers(1, 12))
    excluded = data.draw(st.frozensets(st.integers(0, count - 1)))
    anchors = data.draw(st.sets(st.integers(0, 3)))
    curve = Curve("c", handles_of(lengthwise(seed, 4), anchors), count=count, excluded=excluded)
    patch = with_points_over(Patch("p"), 6, FINDER, (), ())
    patch = replace(patch, excluded=data.draw(st.frozensets(st.integers(0, 5))))
    groups = data.draw(st.permutations([curve, patch]))
    # One of the anchors may be switched off.
    used = sorted(anchors)[data.draw(st.integers(0, 1)) :]
    places = {f"lm_{row}": curve.handles[row].source for row in used}
    found = gathered(groups, places | {"other": (0.0, 0.0, 200.0)}, FINDER, lambda: FINDER)
    rows = {name: k for k, name in enumerate([*places, "other"])}
    points = {"c": course_of(curve, FINDER).points, "p": patch.points}
    expected = [
        points[group.name][n]
        for group in groups
        for n in range(group.count)
        if n not in group.excluded
    ]
    np.testing.assert_array_equal(
        found.semilandmarks.source, np.array(expected, float).reshape(-1, 3)
    )
    assert [list(numbers) for numbers in found.numbers] == [
        [n for n in range(group.count) if n not in group.excluded] for group in groups
    ]
    along_it = [x for sliding in found.semilandmarks.curves for x in sliding.rows]
    assume(along_it)
    places = {k: curve.handles[row].source for k, row in enumerate(used)}
    own = {len(rows) + k: place for k, place in enumerate(expected)}
    at, _ = along(course_of(curve, FINDER).path, [(places | own)[row] for row in along_it])
    assert (np.diff(at) > 0).all()
    assert set(along_it) >= {rows[f"lm_{row}"] for row in used}
    assert len(along_it) == len(used) + count - len(excluded)


def test_a_closed_curve_begins_at_its_first_anchor_and_meets_each_once():
    curve = Curve("c", handles_of(around(3, 5), {1, 3}), is_closed=True, count=10)
    places = {name: curve.handles[row].source for name, row in (("lm_1", 1), ("lm_3", 3))}
    found = gathered([curve], places, FINDER, lambda: FINDER)
    (sliding,) = found.semilandmarks.curves
    rows = sliding.rows.tolist()
    assert sliding.is_closed
    assert rows[0] == 0
    assert sorted(rows) == list(range(12))
    assert [row for row in rows if row > 1] == list(range(2, 12))
    first = len(found.courses[0].spans[0])
    assert rows.index(1) == 1 + first


def test_the_destination_is_asked_for_only_where_a_curve_is_drawn_there():
    def never():
        raise AssertionError("nobody drew on the destination")

    places = lengthwise(1, 3)
    ghost = Curve("c", handles_of(places), count=4)
    (sliding,) = gathered([ghost], {}, FINDER, never).semilandmarks.curves
    assert sliding.path is None
    there = replace(ghost, handles=tuple(Handle(place, place) for place in places))
    (sliding,) = gathered([there], {}, FINDER, never).semilandmarks.curves
    assert sliding.path is None
    drawn = replace(there, drawn=True)
    (sliding,) = gathered([drawn], {}, FINDER, lambda: FINDER).semilandmarks.curves
    np.testing.assert_allclose(sliding.path.places[[0, -1]], [places[0], places[-1]])


# Values


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Patch(" "), "needs a name"),
        (lambda: Patch(" p"), "without blanks around it"),
        (lambda: Patch("a\nb"), "one line"),
        (lambda: Curve("c", handles_of(lengthwise(0, 2))[:1]), "c: a curve goes through at least"),
        (
            lambda: Curve("c", handles_of(lengthwise(0, 2)), is_closed=True),
            "c: a closed curve goes through at least 3",
        ),
        (lambda: Curve("c", handles_of(lengthwise(0, 2)), count=-1), "c: -1 points"),
        (lambda: Curve("c", handles_of(lengthwise(0, 2)), count=MOST_POINTS + 1), "5,001 points"),
        (
            lambda: Curve("c", handles_of(lengthwise(0, 2)), count=3, excluded=frozenset({3})),
            "c has no point 4",
        ),
        (lambda: Patch("p", excluded=frozenset({0})), "p has no point 1"),
    ],
)
def test_what_is_no_group_is_refused_in_words(make, words):
    with pytest.raises(LandmarkError, match=words):
        make()


def test_anchors_follow_their_landmarks_and_let_go_of_those_that_are_gone():
    curve = Curve("c", handles_of(lengthwise(0, 3), {0, 2}))
    first = Landmark("lm_0", (1, 2, 3), (4, 5, 6))
    moved = anchored(curve, {"lm_0": first})
    assert moved.handles[0] == Handle((1, 2, 3), (4, 5, 6), "lm_0")
    assert moved.handles[2] == Handle(curve.handles[2].source)
    assert anchored(moved, {"lm_0": first}) == moved
    # Without its place on the source a landmark is no place to end at.
    assert anchored(moved, {"lm_0": first.placed(Side.SOURCE, None)}).anchors == ()
    assert [h.landmark for h in renamed_anchors(curve, {"lm_0": "apex"}).handles] == [
        "apex",
        "",
        "lm_2",
    ]


@pytest.mark.parametrize("side", list(Side))
def test_a_group_moves_on_one_side_only(side):
    places = lengthwise(0, 3)
    curve = Curve("c", (Handle(places[0], places[1]), *handles_of(places[1:])))
    patch = Patch("p", tuple(places), "ring", places[0])

    def doubled(positions):
        return 2 * np.array(positions)

    moved = moved_group(curve, side, doubled)
    here = side is Side.SOURCE
    assert moved.places(side) == tuple(tuple(2 * x for x in p) for p in curve.places(side))
    assert moved.places(side.other) == curve.places(side.other)
    flat = moved_group(patch, side, doubled)
    assert (flat.points == patch.points) is not here
    assert (flat.inside == patch.inside) is not here
