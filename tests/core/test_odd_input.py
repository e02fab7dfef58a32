"""What is no table of numbers is refused in words, wherever it is given."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import pinwarp
from pinwarp.core.errors import (
    LandmarkCountError,
    LandmarkError,
    LandmarkTypeError,
    MeshError,
    PenaltyError,
    PenaltyTypeError,
    SingularSystemError,
)
from pinwarp.core.factor import factorise
from pinwarp.core.mesh import Mesh
from pinwarp.core.quality import leave_one_out, penalty_curve
from pinwarp.tps3d import PenaltyConvention, TPSCoefficients3D, solve_coefficients

SOURCE = np.random.default_rng(0).normal(size=(8, 3))
DESTINATION = SOURCE + 0.2 * np.sin(3 * SOURCE)
HIDDEN = np.ma.array(SOURCE, mask=np.arange(24).reshape(8, 3) == 16)
RECORDS = np.zeros(8, dtype=[("x", float), ("y", float), ("z", float)])


class Frame:
    """As a data frame: no array, but it knows how to become one."""

    def __init__(self, values):
        self._values = values

    def __array__(self, dtype=None, copy=None):
        return np.array(self._values, dtype=dtype)


ODD = {
    "masked": (HIDDEN, "row 5 is masked"),
    "rows that are masked": (list(HIDDEN), "row 5 is masked"),
    "a masked number": ([[0, 0, 0]] * 2 + [[0, np.ma.masked, 0]] * 6, "row 2 is masked"),
    "complex": (SOURCE + 0j, "complex"),
    "complex in a list": ([[1j, 0, 0]] * 8, "complex"),
    "truth": (SOURCE > 0, "true or false"),
    "text": (SOURCE.astype(str), "text"),
    "text in a list": ([["1", "2", "3"]] * 8, "text"),
    "text among objects": (np.array([[0, "1", 2.0]] * 8, dtype=object), "row 0 holds '1'"),
    "nothing": ([[0, 0, None]] * 8, "row 0 holds None"),
    "truth among objects": (np.array([[0, 0, True]] * 8, dtype=object), "row 0 holds True"),
    "dates": (np.zeros((8, 3), "M8[s]"), "dates"),
    "durations": (np.zeros((8, 3), "m8[s]"), "durations"),
    "records": (RECORDS, "records"),
    "masked records": (np.ma.array(RECORDS), "records"),
    "ragged": ([[0, 0, 0]] * 7 + [[0, 0]], "row 7 has 2 instead of 3"),
    "one number": (3.0, "shape"),
    "one line": ([1, 2, 3], "shape"),
    "a word": ("abc", "text"),
    "bytes": (b"abc", "text"),
    "none": (None, "not a table of numbers but one NoneType"),
    "a set": ({1, 2}, "one set"),
    "a generator": ((x for x in SOURCE), "one generator"),
    "a frame with words": (Frame([["a", 0, 0]] * 8), "text"),
    "more dimensions": (SOURCE[None], "shape"),
    "too large an integer": ([[10**400, 0, 0]] * 8, "row 0 is not usable"),
    "too large a long double": (SOURCE.astype(np.longdouble) * np.longdouble(1e200), "row 0"),
}
TAKEN = {
    "lists": SOURCE.tolist(),
    "tuples": tuple(map(tuple, SOURCE.tolist())),
    "rows": list(SOURCE),
    "objects": SOURCE.astype(object),
    "fractions": [[Fraction(x) for x in row] for row in SOURCE.tolist()],
    "decimals": [[Decimal(x) for x in row] for row in SOURCE.tolist()],
    "a frame": Frame(SOURCE),
    "nothing masked": np.ma.array(SOURCE, mask=False),
    "columns first": np.asfortranarray(SOURCE),
    "backwards": SOURCE[::-1][::-1],
    "the other byte order": SOURCE.astype(">f8"),
    "long doubles": SOURCE.astype(np.longdouble),
}


@pytest.mark.parametrize("name", ODD)
@pytest.mark.parametrize("side", ["source", "destination"])
def test_odd_landmarks_are_refused_in_words(name, side):
    odd, words = ODD[name]
    if name == "a generator":
        odd = (x for x in SOURCE)
    pair = {"source": (odd, DESTINATION), "destination": (SOURCE, odd)}[side]
    with pytest.raises(LandmarkError, match=words) as caught:
        solve_coefficients(*pair)
    assert side in str(caught.value)


@pytest.mark.parametrize("name", TAKEN)
def test_whatever_holds_numbers_is_taken(name):
    expected = solve_coefficients(SOURCE, DESTINATION)
    assert solve_coefficients(TAKEN[name], DESTINATION) == expected


@pytest.mark.parametrize("name", ODD)
def test_odd_points_are_refused_in_words(name):
    odd, words = ODD[name]
    if name == "a generator":
        odd = (x for x in SOURCE)
    warp = solve_coefficients(SOURCE, DESTINATION)
    with pytest.raises(LandmarkError, match=words):
        warp.warp_points(odd)


@pytest.mark.parametrize(
    "odd",
    [
        np.ma.array([1.0, 2, 3], mask=[0, 1, 0]),
        [1, np.ma.masked, 3],
        [1j, 0, 0],
        ["1", "2", "3"],
        [True, False, True],
        [1, 2, None],
        "abc",
        None,
        [1, 2],
        [[1, 2, 3]],
        3.0,
        [[1, 2], [3]],
        [10**400, 0, 0],
        [np.nan, 0, 0],
        [1e200, 0, 0],
    ],
)
def test_an_odd_point_is_refused_in_words(odd):
    with pytest.raises(LandmarkError, match="point"):
        solve_coefficients(SOURCE, DESTINATION).warp_point(odd)


@pytest.mark.parametrize("name", ODD)
def test_odd_input_is_refused_by_the_other_public_functions_too(name):
    odd, words = ODD[name]
    if name == "a generator":
        return  # used up by whoever looks first
    factor = factorise(SOURCE)
    for call in (
        lambda: factorise(odd),
        lambda: leave_one_out(factor, odd),
        lambda: penalty_curve(factor, odd),
        lambda: TPSCoefficients3D([0] * 3, [1, 0, 0], [0, 1, 0], [0, 0, 1], odd, SOURCE),
        lambda: TPSCoefficients3D([0] * 3, [1, 0, 0], [0, 1, 0], [0, 0, 1], SOURCE, odd),
    ):
        with pytest.raises(LandmarkError, match=words):
            call()
    with pytest.raises(MeshError):
        Mesh(odd, [[0, 1, 2]])


@pytest.mark.parametrize(
    "faces",
    [
        [[0, 1, 1.5]],
        [[0, 1, 2**40]],
        np.array([[0, 1, 2**32 + 2]]),
        [["0", "1", "2"]],
        np.ma.array([[0, 1, 2]], mask=[[0, 0, 1]]),
        [[0, 1, np.nan]],
        [[0, 1, 2j]],
        [[True, False, True]],
        [[0, 1, -1]],
        "abc",
        None,
    ],
)
def test_odd_faces_are_refused_in_words(faces):
    with pytest.raises(MeshError):
        Mesh(SOURCE, faces)


ODD_PENALTIES = [
    "abc",
    "0.1",
    None,
    [0.1],
    (0.1,),
    True,
    False,
    np.True_,
    b"1",
    1j,
    float("nan"),
    -1,
    np.float32(-1),
    np.array([0.1]),
    np.array("a"),
    np.array(True),
    np.array(None, dtype=object),
    np.ma.masked,
    10**400,
    -(10**400),
    Decimal("NaN"),
    object(),
    {},
]


@pytest.mark.parametrize("penalty", ODD_PENALTIES, ids=range(len(ODD_PENALTIES)))
@pytest.mark.parametrize("convention", list(PenaltyConvention))
def test_odd_penalties_are_refused_in_words(penalty, convention):
    with pytest.raises(PenaltyError, match="penalty"):
        solve_coefficients(SOURCE, DESTINATION, warping_penalty=penalty, convention=convention)
    with pytest.raises(PenaltyError, match="penalty"):
        leave_one_out(factorise(SOURCE), DESTINATION, penalty)


@pytest.mark.parametrize(
    "penalty", [0.5, Fraction(1, 2), Decimal("0.5"), np.float32(0.5), np.array(0.5)]
)
def test_whatever_is_a_number_is_a_penalty(penalty):
    expected = solve_coefficients(SOURCE, DESTINATION, warping_penalty=0.5)
    assert solve_coefficients(SOURCE, DESTINATION, warping_penalty=penalty) == expected


@pytest.mark.parametrize("penalty", [0.0, 0.001])
@pytest.mark.parametrize("member", list(PenaltyConvention))
def test_a_convention_is_accepted_by_its_value(penalty, member):
    by_value, by_member = (
        solve_coefficients(SOURCE, DESTINATION, warping_penalty=penalty, convention=given)
        for given in (member.value, member)
    )
    assert by_value == by_member
    assert by_value.convention is member


@pytest.mark.parametrize("penalty", [0.0, 0.001])
@pytest.mark.parametrize("convention", ["scipy", "OPYNSIM", "", None, 1, 0.5, [], {}, b"opynsim"])
def test_another_convention_is_refused_with_those_that_there_are(penalty, convention):
    with pytest.raises(PenaltyError, match="'regularising' or 'opynsim'"):
        solve_coefficients(SOURCE, DESTINATION, warping_penalty=penalty, convention=convention)


def test_errors_are_of_the_types_that_scripts_for_opynsim_catch():
    with pytest.raises(RuntimeError) as counts:
        solve_coefficients(SOURCE, DESTINATION[:5])
    assert type(counts.value) is LandmarkCountError
    with pytest.raises(RuntimeError):
        solve_coefficients(SOURCE[:0], DESTINATION[:0])
    with pytest.raises(TypeError) as shape:
        solve_coefficients(SOURCE[:, :2], DESTINATION)
    assert type(shape.value) is LandmarkTypeError
    with pytest.raises(TypeError):
        solve_coefficients(SOURCE, DESTINATION).warp_point(np.ones(2))
    with pytest.raises(TypeError) as penalty:
        solve_coefficients(SOURCE, DESTINATION, warping_penalty="abc")
    assert type(penalty.value) is PenaltyTypeError
    for kind in (LandmarkCountError, LandmarkTypeError, PenaltyTypeError):
        assert issubclass(kind, ValueError)
        assert issubclass(kind, pinwarp.PinwarpError)
    assert issubclass(SingularSystemError, RuntimeError)


# The coefficients


def test_equal_coefficients_have_the_same_hash():
    one, same = (solve_coefficients(SOURCE, DESTINATION) for _ in range(2))
    other = solve_coefficients(SOURCE, DESTINATION, warping_penalty=0.1)
    assert hash(one) == hash(same)
    assert {one: "a"}[same] == "a"
    assert len({one, same, other}) == 2


@given(st.lists(st.sampled_from([0.0, -0.0, 1.0]), min_size=3, max_size=3))
def test_a_minus_before_a_zero_does_not_tell_hashes_apart(term):
    plain = solve_coefficients([[0, 0, 0]], [[1, 2, 3]])
    one, same = (
        dataclasses.replace(plain, a1=np.array(x), warping_penalty=x[0])
        for x in (term, np.array(term) + 0.0)
    )
    assert one == same
    assert hash(one) == hash(same)


def test_affine_terms_are_copies_as_in_opynsim():
    warp = solve_coefficients(SOURCE, DESTINATION)
    before, mark = warp.warp_point([1, 2, 3]), hash(warp)
    warp.a1[0] += 1
    mine = warp.a2
    mine *= 7
    assert warp.a1 is not warp.a1
    assert warp.warp_point([1, 2, 3]) == pytest.approx(before, rel=1e-12)
    assert hash(warp) == mark
    moved = dataclasses.replace(warp, a1=warp.a1 + np.eye(3)[0])
    assert moved.warp_point([1, 2, 3]) == pytest.approx(before + np.eye(3)[0])
    with pytest.raises(AttributeError):
        warp.a1 = np.zeros(3)


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))]
)
def test_coefficients_can_be_copied_and_pickled(again):
    warp = solve_coefficients(SOURCE, DESTINATION, warping_penalty=0.1)
    warp.warp_point([0, 0, 0])
    other = again(warp)
    assert other == warp
    assert hash(other) == hash(warp)
    # The compiled way, which begins after some calls, rounds otherwise in the last digit.
    assert other.warp_point([1, 2, 3]) == pytest.approx(warp.warp_point([1, 2, 3]), rel=1e-12)


def test_coefficients_made_by_hand_are_looked_at():
    made = TPSCoefficients3D(*np.vstack([np.zeros(3), np.eye(3)]), [[0, 0, 0]], [[0, 0, 0]])
    assert made.warp_point([1, 2, 3]).tolist() == [1, 2, 3]
    with pytest.raises(LandmarkError, match="a1 has the shape"):
        dataclasses.replace(made, a1=[0, 0])
    with pytest.raises(LandmarkError, match="2 weights for 1"):
        dataclasses.replace(made, weights=np.zeros((2, 3)))
    with pytest.raises(PenaltyError, match="convention"):
        dataclasses.replace(made, convention="none")


def test_the_help_lists_what_differs_from_opynsim_the_convention_first():
    page = pinwarp.tps3d.__doc__.split("Coming from OPynSim")[1]
    first, *others = page.split("\n- ")[1:]
    assert "default convention" in first
    for word in ("hash", "RuntimeError", "TypeError", "a1[0] += 1", "masked", "warp_points"):
        assert any(word in other for other in others), word
