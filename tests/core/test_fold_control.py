from __future__ import annotations

import numpy as np
import pytest
from tests.core.bones import bone, truth

from pinwarp.core.fold_control import LEAST_VOLUME, OWN_VOLUME, FoldControl
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.sampling import spread_places
from pinwarp.core.spline import factorise, solve

MESH = bone(60, 116)
PLACES, _ = spread_places(MESH, 300)


@pytest.mark.parametrize("unit", [1e-30, 1e-3, 1.0, 1e6, 1e30])
@pytest.mark.parametrize("offset", [0.0, 1e5])
def test_single_precision_misses_nothing_that_double_sees(unit, offset):
    # Rough enough that some places fold, some are crushed, and most are well.
    rng = np.random.default_rng(1)
    first = solve(factorise(unit * (PLACES[:20] + offset)), truth(PLACES[:20]))
    there = truth(PLACES) + rng.normal(scale=1.6, size=PLACES.shape)
    spline = solve(factorise(unit * (PLACES + offset)), there)
    judged = unit * (MESH.vertices + offset)
    before, after = (determinants(jacobians(warp, judged)) for warp in (first, spline))
    expected = after < np.minimum(LEAST_VOLUME * np.median(before), OWN_VOLUME * before)
    bad = FoldControl(first, judged).bad(spline)
    assert 5 < np.count_nonzero(expected) < len(judged) / 2
    np.testing.assert_array_equal(bad, judged[expected])


def test_what_the_landmarks_fold_is_not_held_against_the_fit():
    there = truth(PLACES[:20])
    there[[3, 4]] = there[[4, 3]]
    first = solve(factorise(PLACES[:20]), there)
    assert (determinants(jacobians(first, MESH.vertices)) <= 0).any()
    assert len(FoldControl(first, MESH.vertices).bad(first)) == 0
