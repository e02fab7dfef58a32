"""What of a warp is applied: each part is what it says, and a blend leads from one to the other."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.components import Components, applied, as_drawn
from pinwarp.core.factor import factorise
from pinwarp.core.spline import solve

COUNT = 12


def made_up(seed, penalty=0.0):
    rng = np.random.default_rng(seed)
    source = rng.normal(size=(COUNT, 3)) * 40
    turn = Rotation.random(random_state=seed).as_matrix()
    destination = 1.3 * (source + 3 * np.sin(source / 20)) @ turn.T + rng.normal(size=3) * 100
    factor = factorise(source)
    return source, destination, factor, solve(factor, destination, penalty)


@given(st.integers(0, 2**31 - 1), st.sampled_from([0.0, 1.0, 50.0]))
def test_without_pose_differs_from_the_full_warp_only_by_a_rigid_motion(seed, penalty):
    source, destination, factor, spline = made_up(seed, penalty)
    elsewhere = source + 7
    full = spline.evaluate(elsewhere)
    kept = applied(spline, factor, destination, Components.WITHOUT_POSE).evaluate(elsewhere)
    fit = fit_similarity(full, kept, scaling=False)
    assert np.allclose(fit.apply(full), kept, atol=1e-6)


@given(st.integers(0, 2**31 - 1), st.sampled_from([0.0, 1.0, 50.0]))
def test_without_pose_is_the_warp_to_the_destination_that_was_aligned_to_the_source(seed, penalty):
    source, destination, factor, spline = made_up(seed, penalty)
    aligned = fit_similarity(destination, source, scaling=False).apply(destination)
    expected = solve(factor, aligned, penalty).evaluate(source + 7)
    kept = applied(spline, factor, destination, Components.WITHOUT_POSE)
    assert np.allclose(kept.evaluate(source + 7), expected, atol=1e-6)


@given(st.integers(0, 2**31 - 1))
def test_each_simpler_part_fits_the_pairs_as_well_as_its_kind_can(seed):
    source, destination, factor, spline = made_up(seed)
    misses = []
    for part in (Components.RIGID, Components.SIMILARITY, Components.AFFINE, Components.FULL):
        warp = applied(spline, factor, destination, part)
        misses.append(np.linalg.norm(warp.evaluate(source) - destination))
    assert misses == sorted(misses, reverse=True)
    rigid = fit_similarity(source, destination, scaling=False).apply(source)
    assert misses[0] == pytest.approx(np.linalg.norm(rigid - destination))


@pytest.mark.parametrize("part", list(Components))
def test_a_blend_goes_in_a_straight_line_from_the_aligned_source(part):
    source, destination, factor, spline = made_up(3)
    begin, half, end = (
        applied(spline, factor, destination, part, blend).evaluate(source + 7)
        for blend in (0, 0.5, 1)
    )
    assert np.allclose(half, (begin + end) / 2)
    if part is Components.WITHOUT_POSE:
        assert np.allclose(begin, source + 7)
    else:
        rigid = fit_similarity(source, destination, scaling=False)
        assert np.allclose(begin, rigid.apply(source + 7))


def test_the_full_warp_is_left_as_it_is():
    _, destination, factor, spline = made_up(0)
    assert applied(spline, factor, destination) is spline


@pytest.mark.parametrize("blend", [-0.1, 1.5, float("nan")])
def test_a_blend_beyond_its_ends_is_refused(blend):
    _, destination, factor, spline = made_up(0)
    with pytest.raises(ValueError, match="from 0 to 1"):
        applied(spline, factor, destination, blend=blend)


def test_only_the_pose_is_put_back_for_the_eye():
    assert [as_drawn(part) for part in Components] == [
        Components.FULL,
        Components.FULL,
        Components.AFFINE,
        Components.SIMILARITY,
        Components.RIGID,
    ]
