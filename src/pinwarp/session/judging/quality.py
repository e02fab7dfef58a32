"""How far the pairs of a session are to be trusted: figures and findings, with their landmarks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.alignment import AffineParts, decompose
from pinwarp.core.basis import Basis
from pinwarp.core.components import Components, applied, as_drawn
from pinwarp.core.errors import RangeError
from pinwarp.core.factor import SourceFactor
from pinwarp.core.findings import Finding, FindingKind, Severity, gravest_first
from pinwarp.core.isolation import isolated
from pinwarp.core.landmarks import Position
from pinwarp.core.lengths import Ruler, rms
from pinwarp.core.mirror import MIRRORED, reflection_misfit
from pinwarp.core.quality import (
    LeaveOneOut,
    PenaltyCurve,
    bending_energy,
    leave_one_out,
    penalty_curve,
)
from pinwarp.core.spline import Spline, solve
from pinwarp.core.suspects import suspects
from pinwarp.session.repeat.spreads import spreads_on_destination
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session
from pinwarp.session.warp.pair_names import pair_names
from pinwarp.session.warp.result import WarpInputs, WarpResult
from pinwarp.session.warp.sliding import SlidGroups

Matrix = NDArray[np.float64]

# With fewer there is nothing to leave out: an affine map meets four.
LEAST_PAIRS = 5
_DIRECTIONS = 3


@dataclass(frozen=True)
class NamedFinding:
    """A finding about landmarks of a session.

    Attributes
    ----------
    finding
        The fact.
    names
        The landmarks concerned, the more suspicious first; none where it concerns all.
    sentence
        The fact in words.
    """

    finding: Finding
    names: tuple[str, ...]
    sentence: str

    @property
    def severity(self) -> Severity:
        """How bad it is."""
        return self.finding.severity


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
    judgement
        What the pairs say about one another: a mirrored set, or swapped and displaced pairs, what
        is worth a look and what is only isolated. None while something moves: it takes longer.
    noticed
        What the solve noticed besides.
    affine
        The best affine fit of the pairs, taken apart about the middle of the source landmarks.
    energy : (3,) float64
        The warp's bending energy in x, y and z.
    rms_by_components
        How far each part of the warp leaves the pairs apart, as root mean square in destination
        mesh units: what it does not explain. Without its pose the warp leaves as much as in full.
    rank
        How many directions the source landmarks span; below 3 a similarity fills in the rest.
    """

    inputs: WarpInputs
    left_out: LeaveOneOut | None
    curve: PenaltyCurve | None
    judgement: tuple[Finding, ...] | None
    noticed: tuple[Finding, ...]
    affine: AffineParts
    energy: Matrix
    rms_by_components: Mapping[Components, float]
    rank: int

    @property
    def findings(self) -> tuple[Finding, ...]:
        """All that is known so far, the gravest first."""
        return gravest_first((*(self.judgement or ()), *self.noticed))

    def judged_as(self, before: Quality | None) -> Quality:
        """Return these figures with an earlier judgement, until there is one of these pairs."""
        if before is None or len(before.inputs.source) != len(self.inputs.source):
            return self
        return replace(self, judgement=before.judgement)

    def findings_in(self, session: Session, ruler: Ruler | None = None) -> tuple[NamedFinding, ...]:
        """Return the findings by name, as far as their pairs are still there.

        Parameters
        ----------
        session
            The session as it is now, which may have moved on since the pairs were judged.
        ruler
            How lengths are told; without it as in the files.

        Examples
        --------
        >>> from pinwarp.core.landmarks import Landmark
        >>> from pinwarp.session.warp.solver import WarpSolver
        >>> places = [(0, 0, 0), (0, 0, 0), (9, 0, 0), (0, 9, 0), (0, 0, 9)]
        >>> ends = [(0, 0, 0), (2, 0, 0), *places[2:]]
        >>> session = Session(landmarks=tuple(map(Landmark, "abcde", places, ends)))
        >>> judged = quality_of(WarpSolver().solve(WarpInputs.of(session)))
        >>> judged.findings_in(session)[0].sentence
        'a and b lie at the same place on the source but 2 mm apart on the destination.'
        """
        return named_findings(self.findings, self.inputs, session, ruler)


def judged_at(session: Session, ruler: Ruler) -> str:
    """Say at which penalty pairs are judged where that is another than the warp's; else nothing.

    Nothing, too, where they are too few to be judged.

    Examples
    --------
    >>> from dataclasses import replace
    >>> from pinwarp.core.settings import WarpSettings
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> session = read_session(sample_session())
    >>> judged_at(replace(session, settings=WarpSettings(2.5)), Ruler("mm"))
    'Which pairs look wrong is judged at penalty 0, not at 2.5 mm, which spreads an error.'
    >>> judged_at(session, Ruler("mm"))
    ''
    """
    settings = session.settings
    if len(session.pairs) < LEAST_PAIRS:
        return ""
    basis = "" if settings.basis is Basis.R else " and with the basis r"
    if settings.penalty == 0:
        return f"Which pairs look wrong is judged{basis.removeprefix(' and')}." if basis else ""
    own = settings.penalty_ruler(ruler).text(settings.penalty)
    own = "infinity" if math.isinf(settings.penalty) else own
    return (
        f"Which pairs look wrong is judged at penalty 0{basis}, not at {own}, which spreads an "
        "error."
    )


def energy_unit(quality: Quality, unit: str) -> str:
    """Return the unit of the bending energy: a length squared per length, or by its square."""
    return unit if quality.inputs.settings.basis is Basis.R else ""


def named_findings(
    findings: Iterable[Finding],
    inputs: WarpInputs,
    session: Session,
    ruler: Ruler | None = None,
) -> tuple[NamedFinding, ...]:
    """Return findings by name, as far as their pairs are still there.

    Parameters
    ----------
    findings
        About the pairs of a warp.
    inputs
        What that warp was computed from.
    session
        The session as it is now. Where it has landmark spreads, what a pair is off is told in
        units of its own, too.
    ruler
        How lengths are told; without it as in the files.

    Examples
    --------
    >>> from pinwarp.core.landmarks import Landmark
    >>> session = Session(landmarks=(Landmark("fovea", (0, 0, 0), (1, 0, 0)),))
    >>> finding = Finding(FindingKind.ISOLATED, (0,), 70.0, (3.0,))
    >>> [x.names for x in named_findings([finding], WarpInputs.of(session), session)]
    [('fovea',)]
    """
    names = pair_names(inputs, session)
    words = [name or "" for name in names]
    spreads = spreads_on_destination(session)
    named = []
    for finding in findings:
        concerned = tuple(name for row in finding.rows if (name := names[row]) is not None)
        if len(concerned) == len(finding.rows):
            sentence = finding.describe(words, ruler or rulers_of(session).session, spreads)
            named.append(NamedFinding(finding, concerned, sentence))
    return tuple(named)


def quality_of(result: WarpResult, *, judge: bool = True) -> Quality | None:
    """Judge the pairs of a warp.

    Parameters
    ----------
    result
        A solved warp.
    judge
        False for the figures alone, while something moves.

    Returns
    -------
    Quality or None
        None where there is no warp, or one beyond all figures.
    """
    try:
        return _judged(result, judge)
    except RangeError:
        # A part of the warp leaves the range of numbers: there is nothing to say in figures.
        return None


def _judged(result: WarpResult, judge: bool) -> Quality | None:
    factor, spline, inputs = result.factor, result.spline, result.inputs
    if factor is None or spline is None:
        return None
    destination = np.array(inputs.destination)
    left_out = curve = None
    enough = len(inputs.source) >= LEAST_PAIRS and len(factor.poles) > 0
    at_rest = result.semilandmarks
    if enough:
        # Where semilandmarks slide, nobody knows what another penalty would do to them.
        curve = penalty_curve(factor, destination) if at_rest is None else None
        if inputs.settings.is_regular:
            left_out = leave_one_out(factor, destination, inputs.settings.penalty)
            if at_rest is not None and not math.isinf(inputs.settings.penalty):
                left_out = _while_others_slide(left_out, at_rest, inputs.settings.penalty)
    assert result.fit is not None, "what has a spline was solved from something"
    fit = spline
    if not math.isinf(inputs.settings.penalty):
        fit = solve(*result.fit, np.inf)
    judgement: tuple[Finding, ...] | None = () if judge else None
    if judge and enough:
        # Of the pairs alone: a semilandmark is never wrong, since nobody placed it.
        judgement = _about_pairs(factor.in_basis_r, inputs.source, destination)
    return Quality(
        inputs=inputs,
        left_out=left_out,
        curve=curve,
        judgement=judgement,
        noticed=(*_about_plane(factor, inputs), *spline.findings),
        affine=decompose(fit.affine, factor.centre),
        energy=bending_energy(spline),
        rms_by_components=_rms_by_components(result, spline, fit),
        rank=factor.rank,
    )


def _about_plane(factor: SourceFactor, inputs: WarpInputs) -> tuple[Finding, ...]:
    """Say that the landmarks leave directions open that so many could settle.

    Three settle how a bone lies and how large it is, unless they lie on one line.
    """
    settled = min(len(inputs.source) - 1, _DIRECTIONS)
    if factor.rank >= settled or inputs.settings.planar:
        return ()
    return (Finding(FindingKind.PLANAR, (), factor.rank),)


def _while_others_slide(alone: LeaveOneOut, at_rest: SlidGroups, penalty: float) -> LeaveOneOut:
    """Return leave-one-out errors of the pairs while semilandmarks keep their planes and lines.

    How far each may be expected to miss stays what the pairs say: it finds isolated landmarks.
    """
    errors = at_rest.left_out(penalty)
    distances = np.linalg.norm(errors, axis=1)
    return replace(alone, errors=errors, distances=distances, rms=rms(distances))


def _rms_by_components(result: WarpResult, spline: Spline, fit: Spline) -> dict[Components, float]:
    assert result.fit is not None, "what has a spline was solved from something"
    source, destination = np.array(result.inputs.source), np.array(result.inputs.destination)
    left = {}
    for part in {as_drawn(part) for part in Components}:
        # The affine fit is known already.
        is_fit = part is Components.AFFINE
        warp = fit if is_fit else applied(spline, *result.fit, part)
        left[part] = rms(np.linalg.norm(warp.evaluate(source) - destination, axis=1))
    return {part: left[as_drawn(part)] for part in Components}


def penalty_advice(curve: PenaltyCurve, unit: Ruler | str = "") -> str:
    """Say how much a suggested penalty matters, or why a curve suggests none.

    Parameters
    ----------
    curve
        The figures over the penalty.
    unit
        Of the penalties, or how lengths are told.

    Returns
    -------
    str
        Empty where no pair can be left out.

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
    if curve.as_good is not None:
        return _as_good_in_words(*curve.as_good, Ruler.of(unit))
    if not (np.isfinite(first) and np.isfinite(last)):
        return ""
    if first <= last:
        return "The least leave-one-out error is at no penalty: the pairs ask for none."
    return "The least leave-one-out error is at the affine fit: the pairs ask for no bending."


def _as_good_in_words(low: float, high: float, ruler: Ruler) -> str:
    start, end = (ruler.text(figure, 2) for figure in (low, high))
    match low > 0, math.isfinite(high):
        case True, True:
            return f"Anything from {start} to {end} does as well as the suggested penalty."
        case True, False:
            return f"Anything from {start} on does as well, even the affine fit."
        case False, True:
            return f"Anything up to {end} does as well, even no penalty."
    return "The pairs do not tell one penalty from another: anything does as well."


def _about_pairs(
    factor: SourceFactor, source: tuple[Position, ...], destination: Matrix
) -> tuple[Finding, ...]:
    """Find what is wrong, at penalty 0: a penalty would spread one pair's error over others.

    In the basis r, for which the levels are known.
    """
    left = reflection_misfit(source, destination)
    if left < MIRRORED:
        # Nothing else can be said before that is put right.
        return (Finding(FindingKind.MIRRORED, (), left),)
    found = suspects(factor, destination)
    named = {row for finding in found for row in finding.rows}
    alone = isolated(factor, leave_one_out(factor, destination))
    return (*found, *(x for x in alone if not named.intersection(x.rows)))
