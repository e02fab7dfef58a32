"""The same warp elsewhere: VTK, scipy and thin-plate-spline live, R by stored figures."""

from __future__ import annotations

import csv
import re
import warnings
from math import gamma, pi
from pathlib import Path

import numpy as np
import pytest
import tps
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import RBFInterpolator
from scipy.spatial.distance import cdist
from tests.core.strategies import landmark_pairs
from tests.core.test_tps3d import diagonal, probes
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonTransforms import vtkThinPlateSplineTransform

from pinwarp import tps3d
from pinwarp.core.basis import Basis
from pinwarp.core.errors import LandmarkError, PinwarpError, PoleWarning, SideConditionsWarning
from pinwarp.tps3d import TPSCoefficients3D, solve_coefficients

STORED = Path(__file__).parents[1] / "data" / "fields_tps.csv"
pytestmark = pytest.mark.filterwarnings("ignore::pinwarp.core.errors.NearlyPlanarWarning")

# The landmarks of the documentation's equivalences.
U = [[0, 0, 0], [10, 0, 0], [0, 12, 0], [0, 0, 14], [9, 8, 7], [3, 5, 11], [6, 1, 4]]
V = [[0, 1, 0], [12, 0, 1], [1, 13, 0], [0, 2, 15], [9, 9, 9], [2, 6, 11], [7, 1, 5]]


def vtk_points(rows):
    points = vtkPoints()
    points.SetDataTypeToDouble()
    for row in rows:
        points.InsertNextPoint(row)
    return points


def by_vtk(source, destination, v, basis, sigma=1.0):
    transform = vtkThinPlateSplineTransform()
    transform.SetSourceLandmarks(vtk_points(source))
    transform.SetTargetLandmarks(vtk_points(destination))
    transform.SetSigma(sigma)
    transform.SetBasisToR() if basis is Basis.R else transform.SetBasisToR2LogR()
    return np.array([transform.TransformDoublePoint(*row) for row in v])


def by_scipy(source, destination, v, basis, smoothing):
    kernel = "linear" if basis is Basis.R else "thin_plate_spline"
    return RBFInterpolator(source, destination, kernel=kernel, degree=1, smoothing=smoothing)(v)


def by_fields(source, destination, v, lambda_):
    """What ``fields::Tps(m = 2, scale.type = "unscaled")`` documents, solved densely.

    Its kernel is ``radbas.constant(m, d) * r^(2 m - d)``, and lambda is added to its diagonal as it
    is: so checks the package itself (tests/Tps.test.R, "sanity check", there in the plane).
    """
    constant = gamma(3 / 2 - 2) / (2**4 * pi ** (3 / 2) * gamma(2))
    P = np.column_stack([np.ones(len(source)), source])
    K = constant * cdist(source, source) + lambda_ * np.eye(len(source))
    system = np.block([[K, P], [P.T, np.zeros((4, 4))]])
    found = np.linalg.solve(system, np.vstack([destination, np.zeros((4, 3))]))
    rows = np.hstack([constant * cdist(v, source), np.ones((len(v), 1)), v])
    return rows @ found


def close(ours, theirs, destination):
    box = diagonal(np.vstack([destination, theirs]))
    return np.abs(ours - theirs).max() <= 1e-9 * box


def eased(pairs):
    """About the origin and of unit size: bordered systems lose digits elsewhere, not the warp."""
    source, destination = pairs
    size = diagonal(source)
    return (source - source.mean(axis=0)) / size, destination / size


@given(landmark_pairs(), st.sampled_from(Basis), st.sampled_from([1.0, 7.0]))
def test_vtk_makes_the_same_warp_whatever_its_sigma(pairs, basis, sigma):
    source, destination = eased(pairs)
    v = probes(source, 10)
    ours = solve_coefficients(source, destination, basis=basis).warp_points(v)
    assert close(ours, by_vtk(source, destination, v, basis, sigma), destination)


@given(landmark_pairs(), st.sampled_from(Basis), st.floats(0, 2))
def test_scipy_smooths_as_the_penalty_does(pairs, basis, share):
    source, destination = pairs
    s = share * diagonal(source) ** basis.power
    v = probes(source)
    ours = solve_coefficients(source, destination, warping_penalty=s, basis=basis).warp_points(v)
    assert close(ours, by_scipy(source, destination, v, basis, s), destination)


@given(landmark_pairs(), st.floats(0, 1))
def test_the_documented_formula_of_fields_is_eight_pi_lambda(pairs, lambda_):
    source, destination = eased(pairs)
    v = probes(source)
    ours = solve_coefficients(source, destination, warping_penalty=8 * pi * lambda_)
    assert close(ours.warp_points(v), by_fields(source, destination, v, lambda_), destination)


def test_the_stored_figures_of_the_formula_of_fields_are_met():
    # R was not at hand: made once from the documented formula in 50 digits, not by R.
    with STORED.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    assert len(rows) == 9
    for row in rows:
        warp = solve_coefficients(U, V, warping_penalty=8 * pi * float(row["lambda"]))
        v, expected = ([float(row[key]) for key in keys.split()] for keys in ("x y z", "fx fy fz"))
        assert close(warp.warp_point(v), np.array([expected]), np.array(V))


def test_the_documentation_prints_what_the_others_make():
    found = re.findall(r">>> f\((.+)\)\n(\[.+\])", tps3d.__doc__)
    u, v, point = np.array(U, float), np.array(V, float), np.array([[5.0, 4.0, 3.0]])
    r, log = Basis
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", PoleWarning)
        expected = {
            'alpha, convention="opynsim"': tps.ThinPlateSpline(alpha=0.1)
            .fit(u, v)
            .transform(point),
            "alpha": tps.ThinPlateSpline(alpha=-0.1).fit(u, v).transform(point),
            "smoothing": by_scipy(u, v, point, r, 0.1),
            'smoothing, basis="r2logr"': by_scipy(u, v, point, log, 0.1),
            "8 * pi * lambda_": by_fields(u, v, point, 0.1),
            "8 * pi * mu": by_fields(u, v, point, 0.1),
            "sigma**2": by_scipy(u, v, point, r, 0.1**2),
            "0": by_vtk(u, v, point, r),
            '0, basis="r2logr"': by_vtk(u, v, point, log),
        }
    assert {call: eval(printed) for call, printed in found} == {
        call: pytest.approx(values[0], abs=2e-6) for call, values in expected.items()
    }


# Coefficients made elsewhere


def solved_elsewhere(basis=Basis.R, count=9):
    rng = np.random.default_rng(count)
    u, v = rng.normal(size=(count, 3)), rng.normal(size=(count, 3))
    return solve_coefficients(u, v, basis=basis)


@pytest.mark.parametrize("basis", Basis)
@pytest.mark.parametrize("constant", ["first", "last"])
@pytest.mark.parametrize("columns", [(), ("affine",), ("weights", "source"), ("affine", "weights")])
def test_coefficients_are_taken_however_they_are_laid_out(basis, constant, columns):
    warp = solved_elsewhere(basis)
    terms = [warp.a1, warp.a2, warp.a3, warp.a4]
    arrays = {
        "source": warp.source_landmarks,
        "weights": warp.weights,
        "affine": np.array(terms if constant == "first" else [*terms[1:], terms[0]]),
    }
    for name in columns:
        arrays[name] = arrays[name].T
    layouts = {f"{name}_layout": "columns" for name in columns}
    given_back = TPSCoefficients3D.from_arrays(
        *arrays.values(), basis=basis.value, constant=constant, **layouts
    )
    assert given_back == warp


def test_the_weights_of_other_forms_of_the_kernel_are_turned_as_the_documentation_says():
    warp, log = solved_elsewhere(), solved_elsewhere(Basis.R2_LOG_R)
    v = np.array([[0.3, 0.2, -0.4]])
    r = cdist(v, warp.source_landmarks)
    fields = -8 * pi * warp.weights
    by_hand = v @ [warp.a2, warp.a3, warp.a4] + warp.a1 - r @ fields / (8 * pi)
    affine = np.array([warp.a1, warp.a2, warp.a3, warp.a4])
    taken = TPSCoefficients3D.from_arrays(warp.source_landmarks, -fields / (8 * pi), affine)
    assert np.allclose(taken.warp_points(v), by_hand)
    half = log.weights / 2
    by_hand = v @ [log.a2, log.a3, log.a4] + log.a1 + (r**2 * np.log(r**2)) @ half
    affine = np.array([log.a1, log.a2, log.a3, log.a4])
    taken = TPSCoefficients3D.from_arrays(log.source_landmarks, 2 * half, affine, basis="r2logr")
    assert np.allclose(taken.warp_points(v), by_hand)


def test_an_array_of_another_shape_is_refused_with_the_way_out():
    warp = solved_elsewhere()
    u, w, A = warp.source_landmarks, warp.weights, np.ones((4, 3))
    take = TPSCoefficients3D.from_arrays
    with pytest.raises(
        LandmarkError, match=r"\(3, 9\) instead of \(9, 3\); .* weights_layout='col"
    ):
        take(u, w.T, A)
    with pytest.raises(
        LandmarkError, match=r"terms have the shape \(4, 3\) .* affine_layout='rows'"
    ):
        take(u, w, A, affine_layout="columns")
    with pytest.raises(LandmarkError, match=r"\(8, 3\) instead of \(9, 3\)\."):
        take(u, w[:8], A)
    with pytest.raises(PinwarpError, match="source_layout is 'C'; it must be 'rows' or 'columns'"):
        take(u, w, A, source_layout="C")
    with pytest.raises(PinwarpError, match="constant is 'top'"):
        take(u, w, A, constant="top")
    with pytest.raises(LandmarkError, match="nan"):
        take(u, np.where(w == w[2, 1], np.nan, w), A)


def test_landmarks_in_another_order_than_their_weights_are_noticed_and_printed_digits_are_not():
    warp = solved_elsewhere()
    affine = np.array([warp.a1, warp.a2, warp.a3, warp.a4])
    printed = np.array([[float(f"{x:.5g}") for x in row] for row in warp.weights])
    TPSCoefficients3D.from_arrays(warp.source_landmarks, printed, affine)
    with pytest.warns(SideConditionsWarning, match="order of the landmarks"):
        TPSCoefficients3D.from_arrays(warp.source_landmarks[::-1], warp.weights, affine)
    three = solve_coefficients(*[np.random.default_rng(k).normal(size=(5, 3)) for k in (1, 2)])
    with pytest.warns(SideConditionsWarning):
        TPSCoefficients3D.from_arrays(np.eye(3), three.weights[:3], affine)
