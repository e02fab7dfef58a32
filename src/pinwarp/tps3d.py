r"""The thin-plate spline in three dimensions: solve its coefficients, warp points.

The names and keywords are those of OPynSim's ``tps3d``: a script written for it runs here by
changing the import. A warp is

.. math:: f(v) = a_1 + a_2 v_x + a_3 v_y + a_4 v_z + \sum_{i=1}^n w_i \|u_i - v\|

with the source landmarks :math:`u_i` and coefficients :math:`a_j, w_i \in R^3` (Bookstein,
"Principal warps", IEEE PAMI 11 (1989) 567-585; the basis ``U(r) = r`` for three dimensions:
Gunz, Mitteroecker and Bookstein, "Semilandmarks in three dimensions", 2005).

The sign of the penalty
-----------------------
A warping penalty is meant to trade fit for smoothness: 0 meets every landmark, more makes the
warp more affine. The published way adds it to the diagonal of the system,

.. math:: \begin{bmatrix} K + \alpha I & P \\ P^T & 0 \end{bmatrix}
          \begin{bmatrix} w \\ a \end{bmatrix} = \begin{bmatrix} v \\ 0 \end{bmatrix},
          \qquad K_{ij} = U(\|u_i - u_j\|),

which smooths if, and only if, K is positive definite on the weights that the side conditions
:math:`P^T w = 0` allow. For the two-dimensional basis :math:`r^2 \log r` it is. For the
three-dimensional basis ``U = +r`` it is **negative** definite there: adding :math:`\alpha` first
cancels the bending that holds the warp together and then takes over with the wrong sign. With
:math:`\lambda_1 \dots \lambda_{n-4} > 0` the eigenvalues of -K on that space, the residual of each
mode, relative to the affine fit, is

===========================  ==============================  ================================
system                       residual of mode i              behaviour
===========================  ==============================  ================================
``K + alpha I`` (published)  ``alpha / (alpha - lambda_i)``  n - 4 poles at alpha = lambda_i;
                                                             over-warps below each, worse
                                                             than the affine fit above it
``K - s I`` (regularising)   ``s / (s + lambda_i)``          monotone from interpolation to
                                                             the affine fit
===========================  ==============================  ================================

On a real femur (20 pairs in metres, poles from 0.0083 to 0.213, RMS residual of the affine fit
10.96 mm) the RMS residual in mm is (0.0083 lies beside the first pole, 0.00828344):

================  =====  =====  ======  =====  =====  =====  =====
penalty           0      0.001  0.0083  0.01   0.1    1      100
================  =====  =====  ======  =====  =====  =====  =====
``OPYNSIM``       0      0.469  1366    17.4   37.3   12.2   11.0
``REGULARISING``  0      0.390  2.13    2.40   6.74   10.1   10.9
================  =====  =====  ======  =====  =====  =====  =====

(``assets/penalty_sign.svg`` in the repository draws both over five decades of the penalty.)

Hence ``PenaltyConvention.REGULARISING`` is the default. It minimises
:math:`\sum |y_i - f(u_i)|^2 + \mu \cdot` bending energy with :math:`s = 8 \pi \mu`, and equals
scipy's ``RBFInterpolator(kernel="linear", degree=1, smoothing=s)``, Morpho (R), and
``tps.ThinPlateSpline(alpha=-s)`` of thin-plate-spline >= 1.2.
``PenaltyConvention.OPYNSIM`` reproduces the published numbers, those of OPynSim and of
``tps.ThinPlateSpline(alpha=+alpha)``, for people who must match results made elsewhere. It warns
(:class:`~pinwarp.core.errors.PoleWarning`) above a tenth of the first pole.

The penalty is a length in the unit of the mesh: divide it by 1000 when millimetres become metres.

The basis
---------
Another basis makes another warp, which meets the same landmarks and bends otherwise between and
beyond them. ``basis="r2logr"`` is Bookstein's :math:`U = r^2 \log r`, the thin-plate spline of the
plane, which programs offer in space as well. Its K is *positive* definite under the side
conditions: there ``K + alpha I`` regularises, and both conventions are that one equation. It is
not homogeneous, but in other units its K changes by a multiple of :math:`r^2` alone, of which the
side conditions leave a constant: the warp is the same in millimetres and in metres. The penalty is
then an area, to be divided by 1000 squared. The weights belong to ``+r^2 log r``, per unit of
length, and the bending energy is no integral of second derivatives. Nearly planar landmarks can
be treated as planar with the basis r only. :meth:`TPSCoefficients3D.from_arrays` takes what other
programs solved.

What other programs call the penalty
------------------------------------
==================================  ==============  ======================================
elsewhere                           its parameter   here
==================================  ==============  ======================================
OPynSim, thin-plate-spline >= 1.2   ``alpha``       ``alpha``, ``convention="opynsim"``
thin-plate-spline <= 1.1.1          ``alpha``       ``alpha``
scipy, ``linear``                   ``smoothing``   ``smoothing``
scipy, ``thin_plate_spline``        ``smoothing``   ``smoothing``, ``basis="r2logr"``
Morpho in R                         ``lambda``      ``lambda``
fields in R                         ``lambda``      ``8 pi lambda``
textbooks                           ``mu``          ``8 pi mu``
kriging                             ``sigma``       ``sigma^2`` over the covariance's slope
VTK                                 none            0, ``basis="r2logr"`` where it is so there
==================================  ==============  ======================================

For the same landmarks every line makes the warp of the program that is named, and shows where it
takes one point, to compare:

>>> u = [[0, 0, 0], [10, 0, 0], [0, 12, 0], [0, 0, 14], [9, 8, 7], [3, 5, 11], [6, 1, 4]]
>>> v = [[0, 1, 0], [12, 0, 1], [1, 13, 0], [0, 2, 15], [9, 9, 9], [2, 6, 11], [7, 1, 5]]
>>> def f(penalty, **chosen):
...     warp = solve_coefficients(u, v, warping_penalty=penalty, **chosen)
...     return warp.warp_point([5.0, 4.0, 3.0]).round(6).tolist()
>>> from math import pi
>>> alpha = smoothing = lambda_ = mu = sigma = 0.1

OPynSim's ``warping_penalty``, and ``alpha`` of thin-plate-spline >= 1.2 (``K + alpha I``):

>>> f(alpha, convention="opynsim")
[5.651486, 4.397275, 3.779086]

``alpha`` of thin-plate-spline <= 1.1.1, or of a later one with ``alpha=-0.1``:

>>> f(alpha)
[5.650687, 4.406847, 3.776708]

scipy, ``RBFInterpolator(u, v, kernel="linear", degree=1, smoothing=0.1)``; ``lambda`` of Morpho's
``tps3d`` in R:

>>> f(smoothing)
[5.650687, 4.406847, 3.776708]

scipy, ``kernel="thin_plate_spline"``, the others as before:

>>> f(smoothing, basis="r2logr")
[5.636337, 4.28452, 3.783775]

``lambda`` of ``fields::Tps(u, v, m = 2, scale.type = "unscaled")`` in R, whose kernel in space is
``-r / (8 pi)`` (by default it scales every axis to its range first, and is another warp):

>>> f(8 * pi * lambda_)
[5.653579, 4.480587, 3.76137]

Textbooks' ``mu``, of the sum of squares plus ``mu`` times the bending energy (of the mean of
squares: times the number of landmarks as well):

>>> f(8 * pi * mu)
[5.653579, 4.480587, 3.76137]

``sigma``, the standard deviation of the noise in kriging with a linear drift and the covariance
``-r``, its slope 1 (of another slope: the variance divided by it):

>>> f(sigma**2)
[5.651007, 4.40264, 3.777742]

VTK, ``vtkThinPlateSplineTransform`` with ``SetBasisToR()``; it knows no penalty, and its ``Sigma``
changes nothing:

>>> f(0)
[5.651046, 4.402163, 3.77786]

VTK with ``SetBasisToR2LogR()``:

>>> f(0, basis="r2logr")
[5.636683, 4.283801, 3.784049]

Coming from OPynSim
-------------------
Compared with OPynSim 0.0.8. At penalty 0 both make the same warp, to a millionth of the bone:
OPynSim rounds the distances to single precision, here all is double. What differs:

- **The default convention of the penalty.** Above penalty 0 ``solve_coefficients`` solves
  ``K - s I`` unless it is told otherwise (see above). OPynSim's numbers come with
  ``convention="opynsim"``, and near its poles with a warning.
- One to three landmarks, or all in a line or a plane, leave the affine part open. OPynSim takes
  the smallest one, which flattens whatever else is warped; here it is taken from a similarity.
- What has no answer is refused, not answered with NaN: coordinates that are not finite, that are
  masked, or beyond 1e150; a negative penalty or NaN; a point that is not finite. An infinite
  penalty is the affine fit there is, and NaN in OPynSim.
- Landmarks at one place with different destinations are met half way by both; here with a
  :class:`~pinwarp.core.errors.ConflictingLandmarksWarning`. Nearly planar landmarks are warned
  about, too. ``warnings.simplefilter("ignore", pinwarp.PinwarpWarning)`` silences all of these.
- Lists, tuples and data frames are accepted like arrays. ``True`` is no penalty and truth values
  are no coordinates, which OPynSim takes for 1 and 0.
- Errors say in words what is wrong and in which row. They are all
  :class:`~pinwarp.core.errors.PinwarpError`, mostly ``ValueError``, and those that OPynSim raises
  are of its types as well: ``RuntimeError`` when the counts differ or there are no landmarks,
  ``TypeError`` for another shape, for what is not numbers, and for a penalty that is none.
- ``a1`` ... ``a4`` are copies in both: ``c.a1[0] += 1`` changes the copy, never the warp. To change
  a warp, make another: ``dataclasses.replace(c, a1=c.a1 + [1, 0, 0])``.
- Coefficients are equal by value in both. Here ``hash(c)`` goes by value too (by identity there),
  and they are unequal to anything else (``TypeError`` there).
- They can be made by hand, copied and pickled, show their ``weights``, ``source_landmarks``,
  ``warping_penalty`` and ``convention``, and warp many points at once: ``warp_points(points)``
  does in one call what takes a loop over ``warp_point`` there, and a mesh in milliseconds.
- ``repr(c)`` reads differently, and the module is ``pinwarp.tps3d``.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core import printed, small
from pinwarp.core.basis import Basis, check_basis
from pinwarp.core.errors import (
    ConflictingLandmarksWarning,
    LandmarkCountError,
    LandmarkTypeError,
    NearlyPlanarWarning,
    PinwarpWarning,
    PoleWarning,
    SideConditionsWarning,
)
from pinwarp.core.factor import factorise
from pinwarp.core.findings import FindingKind
from pinwarp.core.positions import as_numbers, as_positions
from pinwarp.core.printed import Layout
from pinwarp.core.spline import (
    PenaltyConvention,
    Spline,
    check_convention,
    check_penalty,
    solve,
)

__all__ = ["Basis", "PenaltyConvention", "TPSCoefficients3D", "solve_coefficients"]

_WARNINGS: Final[dict[FindingKind, type[PinwarpWarning]]] = {
    FindingKind.CONFLICT: ConflictingLandmarksWarning,
    FindingKind.CLOSE: ConflictingLandmarksWarning,
    FindingKind.NEARLY_PLANAR: NearlyPlanarWarning,
    FindingKind.POLE: PoleWarning,
}


_ARRAYS: Final = ("a1", "a2", "a3", "a4", "weights", "source_landmarks")


class _Term:
    """An affine coefficient: kept once, handed out as a copy that scripts may change."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        self.__doc__ = f"The affine coefficient {name}, (3,) float64: a copy."

    def __get__(self, instance: Any, owner: type | None = None) -> NDArray[np.float64]:
        if instance is None:
            # For a dataclass this is a field without a default.
            raise AttributeError(self._name)
        return np.array(instance.__dict__[self._name])

    def __set__(self, instance: Any, value: ArrayLike) -> None:
        instance.__dict__[self._name] = value


@dataclass(frozen=True, eq=False, repr=False)
class TPSCoefficients3D:
    """The coefficients of a solved thin-plate spline; made by :func:`solve_coefficients`.

    Attributes
    ----------
    a1, a2, a3, a4 : (3,) float64
        The constant term (mesh units) and the coefficients of x, y and z; each time a copy.
    weights : (n, 3) float64
        ``w_i``, for ``U = +r`` or ``+r^2 log r``; read-only.
    source_landmarks : (n, 3) float64
        ``u_i``, in mesh units; read-only.
    warping_penalty : float
        A length in mesh units; an area with the basis ``r^2 log r``.
    convention : PenaltyConvention
        The equation that the penalty entered; for the basis ``r^2 log r`` there is but one.
    basis : Basis
        ``U``.

    Two are equal when all of these are, and then have the same hash.

    Examples
    --------
    >>> warp = solve_coefficients([[0, 0, 0], [0, 0, 1]], [[5, 0, 0], [5, 0, 2]])
    >>> warp.warp_points([[0, 0, 0.5]]).round(9).tolist()
    [[5.0, 0.0, 1.0]]
    """

    a1: NDArray[np.float64] = _Term()  # type: ignore[assignment]
    a2: NDArray[np.float64] = _Term()  # type: ignore[assignment]
    a3: NDArray[np.float64] = _Term()  # type: ignore[assignment]
    a4: NDArray[np.float64] = _Term()  # type: ignore[assignment]
    weights: NDArray[np.float64]  # type: ignore[misc]  # the terms above are no defaults
    source_landmarks: NDArray[np.float64]  # type: ignore[misc]
    warping_penalty: float = 0.0
    convention: PenaltyConvention = PenaltyConvention.REGULARISING
    basis: Basis = Basis.R

    def __post_init__(self) -> None:
        for name in ("a1", "a2", "a3", "a4"):
            term = as_numbers(self.__dict__[name], f"{name} coefficient")
            if term.shape != (3,):
                raise LandmarkTypeError(f"{name} has the shape {term.shape} instead of (3,).")
            object.__setattr__(self, name, term)
        for name, what in (("weights", "weight"), ("source_landmarks", "source landmark")):
            array = as_positions(getattr(self, name), what)
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        if len(self.weights) != len(self.source_landmarks):
            raise LandmarkCountError(
                f"There are {len(self.weights)} weights for {len(self.source_landmarks)} "
                "source landmarks."
            )
        object.__setattr__(self, "warping_penalty", check_penalty(self.warping_penalty))
        object.__setattr__(self, "basis", check_basis(self.basis))
        convention = check_convention(self.convention).within(self.basis)
        object.__setattr__(self, "convention", convention)

    @classmethod
    def from_arrays(
        cls,
        source_landmarks: ArrayLike,
        weights: ArrayLike,
        affine: ArrayLike,
        *,
        basis: Basis | str = Basis.R,
        source_layout: Layout = "rows",
        weights_layout: Layout = "rows",
        affine_layout: Layout = "rows",
        constant: Literal["first", "last"] = "first",
        warping_penalty: float = 0.0,
        convention: PenaltyConvention | str = PenaltyConvention.REGULARISING,
    ) -> TPSCoefficients3D:
        """Take coefficients that another program solved, as it printed them.

        What is which is never guessed from the shapes: three landmarks are as many as axes.

        Parameters
        ----------
        source_landmarks, weights
            A landmark per row (n, 3), or per column (3, n) with the layout ``"columns"``.
        affine
            A term per row (4, 3), the axes of the destination side by side, or a term per column
            (3, 4) with the layout ``"columns"``; the terms of x, y and z in this order.
        basis
            ``U``. For weights of ``-r`` give ``-weights``, of ``-r / (8 pi)`` (R's fields)
            ``-weights / (8 * pi)``, of ``r^2 log(r^2)`` ``2 * weights``.
        source_layout, weights_layout, affine_layout
            ``"rows"`` or ``"columns"``.
        constant
            Whether the constant term is the ``"first"`` of the affine part, or the ``"last"``.
        warping_penalty, convention
            What it was solved with, if that is known: kept beside the coefficients.

        Returns
        -------
        TPSCoefficients3D

        Raises
        ------
        LandmarkError
            When a shape is another, the counts differ, or a row is not finite.
        PinwarpError
            When a layout, the constant's place or the basis is none.

        Warns
        -----
        SideConditionsWarning
            The weights do not balance, as those of a spline with these landmarks do.

        Examples
        --------
        One matrix with the weights above the affine part, as MATLAB codes solve for it:

        >>> u = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 2.0]])
        >>> P = np.hstack([np.ones((5, 1)), u])
        >>> K = np.linalg.norm(u[:, None] - u, axis=2)
        >>> right = np.vstack([u**2, np.zeros((4, 3))])
        >>> solved = np.linalg.solve(np.block([[K, P], [P.T, np.zeros((4, 4))]]), right)
        >>> warp = TPSCoefficients3D.from_arrays(u, solved[:5], solved[5:])
        >>> warp.warp_point([1, 1, 2]).round(9).tolist()
        [1.0, 1.0, 4.0]
        """
        source = printed.rows_of(
            source_landmarks, "source landmark", source_layout, "source_layout"
        )
        count = len(source)
        bent = printed.rows_of(weights, "weight", weights_layout, "weights_layout", count)
        terms = printed.terms_of(affine, affine_layout, constant)
        if not printed.is_balanced(source, bent):
            warnings.warn(printed.UNBALANCED, SideConditionsWarning, stacklevel=2)
        penalty, kind = check_penalty(warping_penalty), check_convention(convention)
        a1, a2, a3, a4 = terms
        return cls(a1, a2, a3, a4, bent, source, penalty, kind, check_basis(basis))

    @cached_property
    def _table(self) -> NDArray[np.float64]:
        return small.table_of(self._spline)

    @property
    def _spline(self) -> Spline:
        affine = np.vstack([self.a1, self.a2, self.a3, self.a4])
        return Spline(
            self.source_landmarks,
            self.weights,
            affine,
            self.warping_penalty,
            self.convention,
            basis=self.basis,
        )

    def warp_point(self, point: ArrayLike) -> NDArray[np.float64]:
        """Warp one point.

        Parameters
        ----------
        point
            (3,) coordinates in the source's frame and unit.

        Returns
        -------
        (3,) float64
            In the destination's frame and unit.

        Raises
        ------
        LandmarkError
            When the point is not three finite numbers.

        Examples
        --------
        >>> moved = solve_coefficients([[0, 0, 0]], [[1, 2, 3]])
        >>> moved.warp_point([10, 10, 10]).tolist()
        [11.0, 12.0, 13.0]
        """
        array = point if small.is_point(point) else as_numbers(point, "point", fresh=False)
        if array.shape != (3,):
            raise LandmarkTypeError(f"The point has the shape {array.shape} instead of (3,).")
        warped = small.warp_point(self._table, array) if self.basis is Basis.R else None
        return np.array(self.warp_points(array[None])[0]) if warped is None else warped

    def warp_points(self, points: ArrayLike) -> NDArray[np.float64]:
        """Warp (m, 3) points in double precision; see :meth:`warp_point`.

        Examples
        --------
        >>> moved = solve_coefficients([[0, 0, 0]], [[1, 2, 3]])
        >>> moved.warp_points([[0, 0, 0], [1, 1, 1]]).tolist()
        [[1.0, 2.0, 3.0], [2.0, 3.0, 4.0]]
        """
        return self._spline.evaluate(points)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TPSCoefficients3D):
            return NotImplemented
        return (
            self.warping_penalty == other.warping_penalty
            and self.convention == other.convention
            and self.basis == other.basis
            and all(np.array_equal(getattr(self, name), getattr(other, name)) for name in _ARRAYS)
        )

    def __hash__(self) -> int:
        arrays = (getattr(self, name) for name in _ARRAYS)
        # Adding 0 makes -0 and 0, which are equal, the same bytes.
        values = tuple((array + 0.0).tobytes() for array in arrays)
        return hash((self.warping_penalty, self.convention, self.basis, values))

    def __repr__(self) -> str:
        terms = ", ".join(f"{name} = {getattr(self, name)}" for name in ("a1", "a2", "a3", "a4"))
        return (
            f"<pinwarp.tps3d.TPSCoefficients3D {terms}, {len(self.weights)} weights, "
            f"warping_penalty = {self.warping_penalty:g} ({self.convention.value}), "
            f"basis = {self.basis.value}>"
        )


def solve_coefficients(
    source_landmarks: ArrayLike,
    destination_landmarks: ArrayLike,
    *,
    warping_penalty: float = 0.0,
    convention: PenaltyConvention | str = PenaltyConvention.REGULARISING,
    basis: Basis | str = Basis.R,
) -> TPSCoefficients3D:
    """Solve the spline that takes source landmarks to destination landmarks.

    Where the pairs leave the affine part open it is taken from a similarity: one pair
    translates, two or three make a similarity, collinear and coplanar pairs do not flatten what
    is warped.

    Parameters
    ----------
    source_landmarks, destination_landmarks
        (n, 3) positions, row by row the same places, n >= 1; lists and integers are accepted.
    warping_penalty
        A length in mesh units, 0 or more: 0 meets every landmark, infinity is the affine fit.
        With the basis ``r^2 log r`` it is an area.
    convention
        The equation that the penalty enters, or its value, such as ``"opynsim"``; see the
        module's documentation. With the basis ``r^2 log r`` both are one.
    basis
        ``"r"``, or ``"r2logr"`` for Bookstein's ``r^2 log r``.

    Returns
    -------
    TPSCoefficients3D

    Raises
    ------
    LandmarkError
        When the counts differ, there are none, a row is masked or not finite (the message names
        it), or they are not numbers.
    PenaltyError
        When the penalty is negative or no number, or there is no such convention or basis.
    SingularSystemError
        When an OPYNSIM penalty lies on a pole.

    Warns
    -----
    ConflictingLandmarksWarning
        Landmarks at (nearly) one source place; the message names the rows.
    NearlyPlanarWarning
        The source landmarks lie nearly in one plane.
    PoleWarning
        An OPYNSIM penalty above a tenth of the first pole.

    Examples
    --------
    >>> source = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]
    >>> destination = [[0, 0, 0], [2, 0, 0], [0, 2, 0], [0, 0, 2], [2, 2, 3]]
    >>> warp = solve_coefficients(source, destination)
    >>> warp.warp_point([1, 1, 1]).round(9).tolist()
    [2.0, 2.0, 3.0]
    >>> affine_fit = solve_coefficients(source, destination, warping_penalty=float("inf"))
    >>> bool(abs(affine_fit.weights).max() == 0)
    True
    """
    penalty, kind = check_penalty(warping_penalty), check_convention(convention)
    spline, chosen = None, check_basis(basis)
    if chosen is Basis.R:
        # One pass where there is nothing to refuse: numpy takes longer to be called than to reckon.
        spline = small.solve_ordinary(source_landmarks, destination_landmarks, penalty, kind)
    if spline is None:
        factor = factorise(source_landmarks, basis=chosen)
        spline = solve(factor, destination_landmarks, penalty, kind)
    for finding in spline.findings:
        warnings.warn(finding.describe(), _WARNINGS[finding.kind], stacklevel=2)
    return coefficients_of(spline)


def coefficients_of(spline: Spline) -> TPSCoefficients3D:
    """Return a solved spline's coefficients under their documented names; both share the arrays.

    Examples
    --------
    >>> from pinwarp.core.spline import identity
    >>> coefficients_of(identity()).a2.tolist()
    [1.0, 0.0, 0.0]
    """
    made = object.__new__(TPSCoefficients3D)
    a1, a2, a3, a4 = spline.affine
    spline.weights.setflags(write=False)
    spline.source.setflags(write=False)
    # What was solved needs no second look, which would take longer than a small solve.
    made.__dict__.update(
        a1=a1,
        a2=a2,
        a3=a3,
        a4=a4,
        weights=spline.weights,
        source_landmarks=spline.source,
        warping_penalty=spline.penalty,
        convention=spline.convention,
        basis=spline.basis,
    )
    return made
