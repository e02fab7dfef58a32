"""The basis of the spline as a setting of the session: kept, told, and never taken silently."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import RBFInterpolator

from pinwarp.core.basis import Basis
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side, positions
from pinwarp.core.lengths import Ruler
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention
from pinwarp.io.coefficients import equation_of, read_coefficients, write_coefficients
from pinwarp.io.samples import sample_session
from pinwarp.io.setting_keys import plain_settings, settings_of
from pinwarp.session import edits
from pinwarp.session.judging.methods import methods_of
from pinwarp.session.judging.quality import judged_at, quality_of
from pinwarp.session.judging.warp_figures import warp_figures
from pinwarp.session.keeping.files import read_session
from pinwarp.session.mesh_units import scale_side
from pinwarp.session.outputs.exports import session_coefficients, warped_mesh
from pinwarp.session.session import Session
from pinwarp.session.warp.provenance import provenance, session_hash
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solved import solved
from pinwarp.session.warp.solver import WarpSolver

LOG = Basis.R2_LOG_R


@pytest.fixture(scope="module")
def sample() -> Session:
    return read_session(sample_session())


@pytest.fixture(scope="module")
def other(sample) -> Session:
    return edits.set_basis(edits.set_penalty(sample, 3.0), LOG)


def test_the_mesh_is_warped_as_scipy_does(sample, other):
    source, destination = (positions(sample.pairs, side) for side in Side)
    theirs = RBFInterpolator(
        source,
        destination,
        kernel="thin_plate_spline",
        degree=1,
        smoothing=other.settings.penalty,
    )
    vertices = sample.source.mesh.vertices[::50]
    ours = warped_mesh(other).vertices[::50]
    assert np.abs(ours - theirs(vertices)).max() < 1e-9 * np.ptp(destination)


def test_another_basis_keeps_the_flexibility_and_its_penalty_is_an_area(sample, other):
    inputs = (WarpInputs.of(edits.set_penalty(sample, 3.0)), WarpInputs.of(other))
    before, after = (WarpSolver().solve_landmarks(x) for x in inputs)
    assert after.flexibility == pytest.approx(before.flexibility)
    assert ("Warping penalty", f"{other.settings.penalty:.6g} mm²") in [
        tuple(part.split(": ")) for part in provenance(other)[1].split(". ")
    ]
    back = edits.set_basis(other, Basis.R)
    assert back.settings.penalty == pytest.approx(3.0)
    for penalty in (0.0, np.inf):
        assert edits.set_basis(edits.set_penalty(sample, penalty), LOG).settings.penalty == penalty
    alone = Session(settings=WarpSettings(2.0))
    assert edits.set_basis(alone, LOG).settings == WarpSettings(2.0, basis=LOG)


def test_there_is_one_equation_for_it_and_no_plane(sample):
    published = edits.set_convention(sample, PenaltyConvention.OPYNSIM)
    assert edits.set_basis(published, LOG).settings.convention is PenaltyConvention.REGULARISING
    planar = edits.set_planar(sample, True)
    assert not edits.set_basis(planar, LOG).settings.planar
    with pytest.raises(PinwarpError, match="basis r only"):
        edits.set_planar(edits.set_basis(sample, LOG), True)


def test_a_side_in_another_unit_is_warped_alike(sample, other):
    metres = other
    for side in Side:
        metres = scale_side(metres, side, 1e-3)
    assert metres.settings.penalty == pytest.approx(other.settings.penalty * 1e-6)
    apart = 1000 * warped_mesh(metres).vertices - warped_mesh(other).vertices
    assert np.abs(apart).max() < 1e-6


def test_older_coefficients_are_of_the_basis_r_and_others_say_theirs(tmp_path, sample, other):
    plain = plain_settings(sample.settings)
    del plain["basis"]
    assert settings_of(plain).basis is Basis.R
    for session, version in ((sample, 1), (other, 2)):
        path = tmp_path / f"warp{version}.json"
        write_coefficients(path, session_coefficients(session))
        assert f'"format_version": {version}' in path.read_text()
        read = read_coefficients(path)
        vertices = sample.source.mesh.vertices[:20]
        assert np.array_equal(
            read.spline.evaluate(vertices), solved(session).applied.evaluate(vertices)
        )
    assert "U(r) = +r^2 log r" in path.read_text()
    assert "|u_i - v|, where" in equation_of(Basis.R)


def test_reports_and_papers_say_the_basis(sample, other):
    warp = solved(other)
    quality = quality_of(warp.result)
    words = methods_of(warp, quality)[0]
    assert "U(r) = r² log r" in words
    assert "K + sI" in words
    assert "mm² was added" in words
    assert "Basis: r² log r" in provenance(other)[1]
    assert "U(r) = r " in methods_of(solved(sample), quality)[0]
    energy = warp_figures(quality, "mm")[-1]
    assert energy.title == "Bending energy"
    assert {figure.unit for figure in energy.figures} == {""}
    assert session_hash(other) != session_hash(replace(other, settings=sample.settings))


def test_pairs_are_judged_in_the_basis_r_and_that_is_said(sample, other):
    swapped = list(sample.landmarks)
    swapped[2], swapped[9] = (
        replace(swapped[2], destination=swapped[9].destination),
        replace(swapped[9], destination=swapped[2].destination),
    )
    wrong = replace(sample, landmarks=tuple(swapped))
    judged = [
        quality_of(WarpSolver().solve_landmarks(WarpInputs.of(s))).judgement
        for s in (wrong, edits.set_basis(wrong, LOG))
    ]
    assert judged[0]
    assert judged[0] == judged[1]
    assert "at penalty 0 and with the basis r, not at" in judged_at(other, Ruler("mm"))
    exact = replace(other, settings=WarpSettings(basis=LOG))
    assert judged_at(exact, Ruler("mm")).endswith("judged with the basis r.")
