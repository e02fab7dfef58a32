"""How far the pairs of a session are to be trusted: figures and findings, with their landmarks."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.alignment import AffineParts, decompose
from pinwarp.core.factor import SourceFactor
from pinwarp.core.findings import Finding, FindingKind
from pinwarp.core.landmarks import Position
from pinwarp.core.quality import (
    LeaveOneOut,
    PenaltyCurve,
    bending_energy,
    leave_one_out,
    penalty_curve,
)
from pinwarp.core.spline import PenaltyConvention, solve
from pinwarp.core.suspects import is_mirrored, suspects, swapped_pairs
from pinwarp.session.results import WarpInputs, WarpResult

Matrix = NDArray[np.float64]

# With fewer there is nothing to leave out: an affine map meets four.
LEAST_PAIRS = 5


@dataclass(frozen=True, eq=False)
class Quality:
    """What the pairs say about one another.

    Attributes
    ----------
    inputs
        The warp that is judged.
    left_out
        Leave-one-out errors at the session's penalty; None with fewer than five pairs, and
        where the published convention at a penalty above 0 has no such figure.
    curve
        Leave-one-out error, residual and flexibility over the penalty of the regularising
        convention.
    findings
        About the pairs, the gravest first: a mirrored set, swapped pairs, inconsistent
        neighbours and suspects, then what the solve noticed, then isolated landmarks.
    affine
        The best affine fit of the pairs, taken apart about the middle of the source landmarks.
    energy : (3,) float64
        The warp's bending energy in x, y and z.
    """

    inputs: WarpInputs
    left_out: LeaveOneOut | None
    curve: PenaltyCurve | None
    findings: tuple[Finding, ...]
    affine: AffineParts
    energy: Matrix

    def finding_rows(self, row: int) -> tuple[Finding, ...]:
        """Return the findings that a pair has a part in."""
        return tuple(finding for finding in self.findings if row in finding.rows)


def quality_of(result: WarpResult) -> Quality | None:
    """Judge the pairs of a warp.

    Parameters
    ----------
    result
        A solved warp.

    Returns
    -------
    Quality or None
        None where there is no warp.
    """
    factor, spline, inputs = result.factor, result.spline, result.inputs
    if factor is None or spline is None:
        return None
    destination = np.array(inputs.destination)
    left_out = curve = None
    enough = len(inputs.source) >= LEAST_PAIRS and len(factor.poles) > 0
    if enough:
        curve = penalty_curve(factor, destination)
        regular = inputs.convention is PenaltyConvention.REGULARISING or inputs.penalty == 0
        if regular:
            left_out = leave_one_out(factor, destination, inputs.penalty)
    found = _about_pairs(factor, inputs.source, destination) if enough else ()
    isolated = tuple(finding for finding in found if finding.kind is FindingKind.ISOLATED)
    grave = tuple(finding for finding in found if finding.kind is not FindingKind.ISOLATED)
    return Quality(
        inputs=inputs,
        left_out=left_out,
        curve=curve,
        findings=(*grave, *spline.findings, *isolated),
        affine=decompose(solve(factor, destination, np.inf).affine, factor.centre),
        energy=bending_energy(spline),
    )


def penalty_advice(curve: PenaltyCurve) -> str:
    """Say why a curve suggests no penalty, in words for the user.

    Parameters
    ----------
    curve
        The figures over the penalty.

    Returns
    -------
    str
        Empty where a penalty is suggested, or where no pair can be left out.

    Examples
    --------
    >>> from pinwarp.core.factor import factorise
    >>> source = np.random.default_rng(0).normal(size=(30, 3))
    >>> penalty_advice(penalty_curve(factorise(source), source + 0.1 * source**2))
    'The least leave-one-out error is at no penalty: the pairs ask for none.'
    """
    if curve.is_affine:
        return "An affine map meets every pair: the penalty changes nothing."
    first, last = curve.leave_one_out[[0, -1]].tolist()
    if curve.suggested is not None or not (np.isfinite(first) and np.isfinite(last)):
        return ""
    if first <= last:
        return "The least leave-one-out error is at no penalty: the pairs ask for none."
    return "The least leave-one-out error is at the affine fit: the pairs ask for no bending."


def _about_pairs(
    factor: SourceFactor, source: tuple[Position, ...], destination: Matrix
) -> tuple[Finding, ...]:
    """Find what is wrong, at penalty 0: a penalty would spread one pair's error over others."""
    if is_mirrored(source, destination):
        # Nothing else can be said before that is put right.
        return (Finding(FindingKind.MIRRORED, (), 0.0),)
    swapped = swapped_pairs(factor, destination)
    explained = {row for finding in swapped for row in finding.rows}
    others = suspects(factor, destination)
    return (*swapped, *(x for x in others if not explained.intersection(x.rows)))
