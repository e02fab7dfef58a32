from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.core.bones import bone, landmarks, shape, truth
from tests.core.pelvis import pelvis_landmarks, pelvis_meshes

from pinwarp.core.conditions import across, factorise_conditions
from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import LandmarkError
from pinwarp.core.factor import factorise
from pinwarp.core.gathering import gathered, with_points_over
from pinwarp.core.groups import Curve, Handle, Patch
from pinwarp.core.held_slide import HeldSlide
from pinwarp.core.patches import patch
from pinwarp.core.sliding import slide
from pinwarp.core.spline import solve
from pinwarp.core.surface import Surface

MESH = bone()
SOURCE = PathFinder(Surface(MESH))
TRUTH = Surface(MESH.with_vertices(truth(MESH.vertices)))
U = landmarks(14)
V = truth(U)
_HANDLES = tuple(map(Handle, shape(np.arange(6) * np.pi / 3, np.full(6, 1.3))))
RING = Curve("ring", _HANDLES, is_closed=True, count=12)
NAMED = {f"landmark_{row}": place for row, place in enumerate(U)}
WHOLE = with_points_over(Patch("whole"), 60, SOURCE, NAMED.values(), [RING])
POINTS = gathered([RING, WHOLE], NAMED, SOURCE, lambda: SOURCE).semilandmarks
SLID = slide(U, V, POINTS, TRUTH)
HELD = HeldSlide.of(SLID)


def apart(a, b, places=MESH.vertices):
    return np.abs(a.evaluate(places) - b.evaluate(places)).max()


def moved(places, seed, size=4.0):
    rng = np.random.default_rng(seed)
    rows = rng.choice(len(places), rng.integers(1, 4), replace=False)
    out = places.copy()
    out[rows] += rng.normal(scale=size, size=(len(rows), 3))
    return out


def tangents_of(slid):
    """Rows of places and the unit tangents along which they may slide."""
    rows, tangents = [], []
    for row in range(slid.landmarks, len(slid.used)):
        own = slid.conditions.directions[slid.conditions.rows == row]
        ways = np.vstack(across(own)) if len(own) == 1 else np.cross(own[:1], own[1:])
        rows += [row] * len(ways)
        tangents.append(ways)
    return np.array(rows), np.vstack(tangents)


def brute_force(source, rest_source, rest, landmarks_now, slid):
    """Least bending over all tangent coordinates at once, less what pulled at rest."""

    def bending(places):
        # The weights of an interpolating spline are linear in its values, three columns at a time.
        factor, unit = factorise(places), np.pad(np.eye(len(places)), ((0, 0), (0, 2)))
        parts = [solve(factor, unit[:, i : i + 3]).weights for i in range(0, len(places), 3)]
        return -np.hstack(parts)[:, : len(places)]

    rows, T = tangents_of(slid)
    B = bending(source)
    pulled = bending(rest_source) @ rest
    y = rest.copy()
    y[: slid.landmarks] = landmarks_now
    A = B[np.ix_(rows, rows)] * (T @ T.T)
    t = np.linalg.solve(A, np.sum(T * (pulled - B @ y)[rows], axis=1))
    np.add.at(y, rows, T * t[:, None])
    return solve(factorise(source), y)


def test_with_nothing_moved_it_is_the_warp_of_the_slide():
    assert apart(HELD.warp(V), SLID.spline) < 1e-9
    assert apart(HELD.with_source(U).warp(V), SLID.spline) < 1e-9


@settings(max_examples=15)
@given(st.integers(0, 10_000))
def test_moved_landmarks_are_met_and_the_points_stay_on_their_planes(seed):
    u, v = moved(U, seed), moved(V, seed + 1)
    rest = SLID.spline.evaluate(SLID.spline.source)
    for held, landmarks_now in ((HELD, U), (HELD.with_source(u), u)):
        warp = held.warp(v)
        np.testing.assert_allclose(warp.evaluate(landmarks_now), v, atol=1e-8)
        conditions = SLID.conditions
        gone = (warp.evaluate(warp.source) - rest)[conditions.rows]
        off = np.sum(conditions.directions * gone, axis=1)[conditions.rows >= len(U)]
        assert np.abs(off).max() < 1e-8
        # An ordinary spline: of its own pairs, with weights that know nothing of affine maps.
        again = solve(factorise(warp.source), warp.evaluate(warp.source))
        assert apart(again, warp) < 1e-7
        assert np.abs(warp.weights.sum(axis=0)).max() < 1e-9 * np.abs(warp.weights).sum()


@pytest.mark.parametrize("seed", range(4))
def test_it_is_the_least_bending_of_all_tangents_as_brute_force_finds_it(seed):
    rest_source, rest = SLID.spline.source, SLID.spline.evaluate(SLID.spline.source)
    u, v = moved(U, seed), moved(V, seed + 50)
    expected = brute_force(rest_source, rest_source, rest, v, SLID)
    assert apart(HELD.warp(v), expected) < 1e-7
    source = rest_source.copy()
    source[: len(U)] = u
    expected = brute_force(source, rest_source, rest, v, SLID)
    assert apart(HELD.with_source(u).warp(v), expected) < 1e-7


def test_a_short_drag_lands_where_sliding_anew_does():
    v = V.copy()
    v[5] += [0.2, 0.1, -0.2]
    anew = slide(U, v, POINTS, TRUTH).spline
    assert apart(HELD.warp(v), anew) < 0.35 * apart(SLID.spline, anew)


def test_on_coarse_bones_nothing_jumps_as_the_drag_begins(shared_data):
    template, target = pelvis_meshes(shared_data)
    rows = pelvis_landmarks(template)
    u, v = template.vertices[rows], target.vertices[rows]
    slid = slide(u, v, patch(Surface(template), 300, away_from=u), Surface(target))
    assert apart(HeldSlide.of(slid).warp(v), slid.spline, template.vertices) < 1e-7
    # Without what pulled at rest it does: the planes were not those of the last place.
    factor = factorise_conditions(slid.spline.source, slid.conditions)
    slipped = factor.solve(slid.spline.evaluate(slid.spline.source))
    assert apart(slipped, slid.spline, template.vertices) > 0.1


def test_another_number_of_landmarks_is_another_slide():
    with pytest.raises(LandmarkError, match="14 landmarks in the slide but 13 here: slide anew"):
        HELD.warp(V[:-1])
    with pytest.raises(LandmarkError, match="slide anew"):
        HELD.with_source(U[:-1])
    with pytest.raises(LandmarkError, match="not usable"):
        HELD.warp(V * np.nan)
