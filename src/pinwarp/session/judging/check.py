"""How good the warp of a session is, in figures and sentences: what a report prints."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from pinwarp.core.findings import FindingKind, Severity, gravest_first
from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Side
from pinwarp.core.lengths import rms
from pinwarp.core.names import look_alike_notes
from pinwarp.core.surface_comparison import DistanceFigures
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.meshes import MeshFile
from pinwarp.session.judging.different_units import different_units
from pinwarp.session.judging.elsewhere import Elsewhere, elsewhere
from pinwarp.session.judging.quality import NamedFinding, judged_at, named_findings, quality_of
from pinwarp.session.judging.suggested import about_suggested
from pinwarp.session.repeat.spreads import spreads_on_destination
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session
from pinwarp.session.warp.refined import OUT_OF_DATE, is_out_of_date
from pinwarp.session.warp.result import WarpResult
from pinwarp.session.warp.slid_words import kind_of, not_sliding_note
from pinwarp.session.warp.solved import SolvedWarp, solved


@dataclass(frozen=True)
class PairFigures:
    """What is known about one pair; lengths in the unit of the session, NaN where unknown.

    Attributes
    ----------
    name
        The landmark.
    residual
        Distance of the warped source landmark from its destination.
    leave_one_out
        The same with the pair left out of the solve.
    standardised
        That error by how far it may be expected to be: 1 is ordinary, 3 is suspicious.
    spread
        How far the pair may be off because of how it was digitised, where that was measured.
    """

    name: str
    residual: float
    leave_one_out: float = math.nan
    standardised: float = math.nan
    spread: float = math.nan


@dataclass(frozen=True)
class GroupFigures:
    """What became of one curve or patch; lengths in the unit of the session.

    Attributes
    ----------
    name, kind
        The group, and what it is.
    drawn
        Whether its points follow what was drawn on the destination.
    points, excluded, freed
        How many it has, how many of them somebody excluded, and how many have no counterpart.
    used
        How many the warp was solved from.
    largest_slide
        How far the point slid that slid furthest; NaN where none did here.
    """

    name: str
    kind: str
    drawn: bool
    points: int
    excluded: int
    freed: int
    used: int
    largest_slide: float = math.nan


@dataclass(frozen=True)
class Check:
    """The figures of a session; lengths in its unit, None where there is no such figure.

    Attributes
    ----------
    pairs
        In the order of the session.
    rms_residual, rms_leave_one_out
        Root mean squares over the pairs.
    flexibility
        The share of non-affine freedom that the penalty leaves.
    suggested_penalty
        The penalty with the least leave-one-out error; None too where the data ask for none.
    as_good
        Between which penalties around it the error is no larger than by chance.
    folded_vertices
        How many vertices of the source mesh lie where the warp folds.
    distance
        Of the warped source from the surface of the destination.
    fitted
        How many places were fitted to that surface, semilandmarks among them, so that the
        distance proves little; None where none were.
    groups
        The curves and patches whose semilandmarks slid.
    elsewhere
        The sides whose landmarks do not lie on their mesh; they are among the findings, too.
    findings
        What was noticed, the gravest first; what is wrong is flagged.
    notes
        What was noticed about the files.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> checked = check(read_session(sample_session()))
    >>> checked.pairs[0].name, round(checked.distance.mean, 2), checked.as_json()["flagged"]
    ('fovea_capitis', 0.73, False)
    """

    pairs: tuple[PairFigures, ...]
    rms_residual: float
    rms_leave_one_out: float | None
    flexibility: float | None
    suggested_penalty: float | None
    as_good: tuple[float, float] | None
    folded_vertices: int | None
    distance: DistanceFigures | None
    fitted: int | None
    findings: tuple[NamedFinding, ...]
    notes: tuple[str, ...] = ()
    groups: tuple[GroupFigures, ...] = ()
    elsewhere: tuple[Elsewhere, ...] = ()

    @property
    def freed(self) -> int | None:
        """How many semilandmarks have no counterpart; None where none slid."""
        return sum(group.freed for group in self.groups) if self.groups else None

    @property
    def suggested(self) -> int:
        """How many destinations were only suggested: nobody has looked at them yet."""
        kind = FindingKind.SUGGESTED
        return sum(len(found.names) for found in self.findings if found.finding.kind is kind)

    @property
    def is_flagged(self) -> bool:
        """Whether anything should be put right before the warp is used."""
        return any(named.severity is Severity.WRONG for named in self.findings)

    def as_json(self) -> dict[str, Any]:
        """Return all of it as plain values for JSON; figures that are not known are None."""
        return {
            "flagged": self.is_flagged,
            "rms_residual": self.rms_residual,
            "rms_leave_one_out": self.rms_leave_one_out,
            "flexibility": self.flexibility,
            "suggested_penalty": self.suggested_penalty,
            # The affine fit's penalty is no number to JSON.
            "as_good": None
            if self.as_good is None
            else ["inf" if math.isinf(end) else end for end in self.as_good],
            "folded_vertices": self.folded_vertices,
            "distance": None if self.distance is None else asdict(self.distance),
            "fitted": self.fitted,
            "suggested": self.suggested,
            "findings": [
                {
                    "kind": named.finding.kind.value,
                    "flagged": named.severity is Severity.WRONG,
                    "landmarks": list(named.names),
                    "words": named.sentence,
                }
                for named in self.findings
            ],
            "notes": list(self.notes),
            "groups": [_plain(group) for group in self.groups],
            "pairs": [_plain(pair) for pair in self.pairs],
        }


def check(session: Session | SolvedWarp, source_index: SurfaceIndex | None = None) -> Check:
    """Judge the warp of a session: its pairs, and what it does to the meshes that are there.

    Parameters
    ----------
    session
        Folds are looked for where its source mesh is there, distances measured where both are.
        Or its warp, solved.
    source_index
        The surface of its source mesh, where it is ready for measuring.

    Raises
    ------
    PinwarpError
        When there is no pair, or the solve fails.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> checked = check(read_session(sample_session()))
    >>> len(checked.pairs), checked.is_flagged, checked.folded_vertices
    (16, False, 0)
    """
    warp = solved(session)
    session, result = warp.session, warp.result
    quality = quality_of(result)
    assert quality is not None, "what is solved can be judged"
    names = [pair.name for pair in session.pairs]
    spreads = spreads_on_destination(session)
    left_out = quality.left_out
    unknown = np.full(len(names), np.nan)
    columns = (
        warp.residuals,
        unknown if left_out is None else left_out.distances,
        unknown if left_out is None else left_out.standardised,
        [spreads.get(name, math.nan) for name in names],
    )
    folds, distances = warp.folds, warp.distances()
    findings = [*different_units(session), *quality.findings_in(session)]
    findings += about_suggested(session)
    if folds is not None:
        patches = (patch.finding for patch in folds.patches)
        findings += named_findings(patches, result.inputs, session)
    indexes = {Side.SOURCE: source_index, Side.DESTINATION: warp.destination_index}
    astray = elsewhere(session, indexes)
    findings += astray
    return Check(
        elsewhere=astray,
        pairs=tuple(
            PairFigures(name, *(float(x) for x in row))
            for name, row in zip(names, np.column_stack(columns), strict=True)
        ),
        rms_residual=rms(warp.residuals),
        rms_leave_one_out=_known(None if left_out is None else left_out.rms),
        flexibility=_known(result.flexibility),
        suggested_penalty=None if quality.curve is None else quality.curve.suggested,
        as_good=None if quality.curve is None else quality.curve.as_good,
        folded_vertices=None if folds is None else folds.count,
        distance=None
        if distances is None
        else DistanceFigures.of(distances[warp.source.on_surface]),
        fitted=warp.fitted,
        findings=gravest_first(findings),
        notes=(
            *filter(None, [judged_at(session, rulers_of(session).session)]),
            *_about_refinement(session),
            *not_sliding_note(result),
            *_about_files(session),
            *look_alike_notes(x.name for x in session.landmarks),
        ),
        groups=groups_of(result),
    )


def groups_of(result: WarpResult) -> tuple[GroupFigures, ...]:
    """Return what became of the curves and patches of a warp; none where they have no part."""
    at_rest = result.semilandmarks
    if at_rest is None:
        return ()
    return tuple(
        GroupFigures(
            name=slid.group.name,
            kind=kind_of(slid.group),
            drawn=isinstance(slid.group, Curve) and slid.group.is_drawn,
            points=slid.group.count,
            excluded=len(slid.group.excluded),
            freed=slid.freed,
            used=len(slid.numbers) - slid.freed,
            # What was read at rest says nothing of the way there.
            largest_slide=math.nan if at_rest.is_kept else slid.largest_slide,
        )
        for slid in at_rest.groups
    )


def _plain(figures: PairFigures | GroupFigures) -> dict[str, Any]:
    return {
        key: value if isinstance(value, str) or math.isfinite(value) else None
        for key, value in asdict(figures).items()
    }


def _about_refinement(session: Session) -> tuple[str, ...]:
    return (OUT_OF_DATE,) if is_out_of_date(session) else ()


def _about_files(session: Session) -> tuple[str, ...]:
    notes = []
    for file in (session.source, session.destination):
        if isinstance(file, MeshFile):
            notes += [f"{file.path.name}: {note}" for note in file.notes]
        elif file is not None:
            notes.append(f"{file.path.name}: It is not there. Was it moved or renamed?")
    return tuple(notes)


def _known(value: float | None) -> float | None:
    return None if value is None or math.isnan(value) else float(value)
