"""Curves that are accepted on the destination."""

from __future__ import annotations

import numpy as np
import pytest

from pinwarp.core.gathering import course_of, path_of
from pinwarp.core.groups import Handle
from pinwarp.core.landmarks import Side, as_position
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.keeping.files import read_session
from pinwarp.session.warp.accepting import accepted
from pinwarp.session.warp.expected import destination_path
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.sliding import Finders
from pinwarp.session.warp.solver import WarpSolver


@pytest.fixture(scope="module")
def bones():
    """The sample, its warp, and what finds ways over both bones."""
    session, finders = read_session(sample_session()), Finders()
    spline = WarpSolver().solve(WarpInputs.of(session)).spline
    return session, spline, [finders.of(side, session.mesh(side)) for side in Side]


def around_the_neck(session, count):
    """Handles around the bone below its head, which few of them do not hold there."""
    mesh = session.mesh(Side.SOURCE)
    up = int(np.argmax(np.ptp(mesh.vertices, axis=0)))
    height = np.quantile(mesh.vertices[:, up], 0.7)
    level = mesh.vertices[np.abs(mesh.vertices[:, up] - height) < 3]
    apart = level - level.mean(axis=0)
    across = [axis for axis in range(3) if axis != up]
    angles = np.arctan2(apart[:, across[1]], apart[:, across[0]])
    wanted = np.linspace(-2.9, 2.9, count)
    return [Handle(as_position(level[np.abs(angles - angle).argmin()])) for angle in wanted]


def test_an_accepted_curve_runs_where_it_was_expected_and_through_its_own_handles(bones):
    session, spline, (source, destination) = bones
    drawn, name = edits.add_curve(session, around_the_neck(session, 3), source)
    curve = drawn.group(name)
    expected = destination_path(curve, course_of(curve, source), spline, destination)
    after = accepted(drawn, name, spline, source, destination).group(name)
    assert after.is_drawn
    assert set(curve.places(Side.SOURCE)) <= set(after.places(Side.SOURCE))
    path = path_of(after, destination, Side.DESTINATION)
    off = np.linalg.norm(expected[:, None] - path.places, axis=2).min(axis=1)
    assert off.max() < 0.1 * path.length
    # Once is enough.
    again = accepted(edits.rename_group(drawn, name, "b"), name, spline, source, destination)
    assert again.group(name) is None


def test_handles_come_behind_those_that_they_are_added_to(bones):
    session, _, (source, _) = bones
    first, second, third = around_the_neck(session, 3)
    drawn, name = edits.add_curve(session, [first, third], source)
    assert edits.add_handles(drawn, name, {0: [second]}).group(name).handles == (
        first,
        second,
        third,
    )
    assert edits.add_handles(drawn, name, {}) == drawn


def test_what_finds_ways_is_kept_for_the_bones_that_are_worked_on(bones):
    session, _, _ = bones
    finders, mesh = Finders(), session.mesh(Side.SOURCE)
    kept = finders.of(Side.SOURCE, mesh)
    assert finders.of(Side.DESTINATION, mesh) is kept
    finders.keep_only([mesh, None])
    assert finders.of(Side.SOURCE, mesh) is kept
    finders.keep_only([None])
    assert finders.of(Side.SOURCE, mesh) is not kept
