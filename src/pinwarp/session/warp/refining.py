"""Refining the warp of a session to the whole surface, and checking what that is worth."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from pinwarp.core.basis import Basis
from pinwarp.core.curves import PathFinder
from pinwarp.core.errors import LandmarkError, MeshError, PinwarpError
from pinwarp.core.factor import factorise
from pinwarp.core.gathering import gathered
from pinwarp.core.landmarks import Side, as_position, positions
from pinwarp.core.lengths import rms
from pinwarp.core.mesh import Mesh
from pinwarp.core.quality import leave_one_out
from pinwarp.core.readiness import check_count
from pinwarp.core.refinement import Level, Refinement, refine
from pinwarp.core.refinement_inputs import DrawnPoints, RefinementSettings
from pinwarp.core.spline import Spline
from pinwarp.core.surface import Surface
from pinwarp.core.words import counted, listed
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session.session import Session
from pinwarp.session.warp.refined import drawn_curves, inputs_of

Matrix = NDArray[np.float64]

# With four, none can be left out: the others would no longer fix an affine map.
LEAST_PAIRS = 5


def _silent(_share: float, _words: str) -> None:
    pass


@dataclass(frozen=True)
class RefinementOptions:
    """What the user may choose about a refinement; lengths in the session's unit.

    Parameters
    ----------
    smallest_feature
        Only what is larger is bent; None takes what 1200 places resolve.
    landmark_tolerance
        The penalty of the landmarks meanwhile; None takes the session's, and 0 meets them all.
    turn_destination
        Whether one of the meshes is known to be inside out.

    Examples
    --------
    >>> RefinementOptions(smallest_feature=10.0).turn_destination
    False
    """

    smallest_feature: float | None = None
    landmark_tolerance: float | None = None
    turn_destination: bool = False

    @classmethod
    def of(cls, refined: RefinementRecord) -> RefinementOptions:
        """Return what a refinement was made with."""
        return cls(refined.smallest_feature, refined.landmark_tolerance, refined.turn_destination)


def refined_session(
    session: Session,
    options: RefinementOptions | None = None,
    *,
    told: Callable[[Level], None] = lambda _level: None,
    progress: Callable[[float, str], None] = _silent,
) -> tuple[Session, Refinement]:
    """Refine the warp of a session; nothing but its refinement is another afterwards.

    Parameters
    ----------
    session
        With both meshes and at least four pairs.
    options
        How.
    told, progress
        As for :func:`pinwarp.core.refinement.refine`: what they raise leaves all as it was.

    Returns
    -------
    session, refinement

    Raises
    ------
    PinwarpError
        When something is missing or does not fit; the message says what to do.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> session = read_session(sample_session())
    >>> refined, found = refined_session(session, RefinementOptions(smallest_feature=40.0))
    >>> found.fitted > 100, refined.refinement is not None, session.refinement is None
    (True, True, True)
    """
    given = _Given.of(session, options or RefinementOptions()).with_curves(session)
    _refuse_coincident(session)
    found = given.refine(told, progress)
    record = replace(
        _record(session, found.spline, found.smallest_feature),
        landmark_tolerance=given.settings.landmark_tolerance,
        turn_destination=given.settings.turn_destination,
        places=found.places,
        folding=found.folding,
    )
    return replace(session, refinement=record), found


def record_at(session: Session, level: Level) -> RefinementRecord:
    """Return a refinement that is under way as a level of it stands: to be looked at.

    Parameters
    ----------
    session
        What is refined.
    level
        The level.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> session, seen = read_session(sample_session()), []
    >>> _ = refined_session(
    ...     session,
    ...     RefinementOptions(smallest_feature=60.0),
    ...     told=lambda level: seen.append(record_at(session, level)),
    ... )
    >>> [round(record.smallest_feature) for record in seen]
    [225, 157, 110, 77, 60]
    """
    return _record(session, level.spline, level.feature)


def why_not(session: Session, options: RefinementOptions | None = None) -> str:
    """Say why a refinement cannot begin, and what to do about it; nothing where it can.

    Told at a glance: what only fitting shows is not looked for.

    Parameters
    ----------
    session
        What is to be refined.
    options
        How.

    Examples
    --------
    >>> why_not(Session())
    'There is no source mesh: open the bone that is to be warped.'
    """
    try:
        _Given.of(session, options or RefinementOptions())
        check_count(len(session.pairs))
    except PinwarpError as error:
        return str(error)
    return ""


def _record(session: Session, spline: Spline, feature: float) -> RefinementRecord:
    """Return what is kept of a spline that was fitted: where its places go."""
    return RefinementRecord(
        source=tuple(as_position(place) for place in spline.source),
        destination=tuple(as_position(place) for place in spline.evaluate(spline.source)),
        smallest_feature=feature,
        inputs=inputs_of(session),
    )


@dataclass(frozen=True, eq=False)
class Verification:
    """What a refinement is worth: landmarks left out one by one, and all done anew.

    Attributes
    ----------
    names
        The pairs.
    before, after : (n,) float64
        How far the warp of the others misses each, unrefined and refined, in destination mesh
        units; NaN where the others cannot carry the surface.
    problems
        Why not, as sentences.
    """

    names: tuple[str, ...]
    before: Matrix
    after: Matrix
    problems: tuple[str, ...]

    @property
    def improved(self) -> int:
        """How many are missed by less."""
        return int(np.count_nonzero(self.after < self.before))

    @property
    def judged(self) -> int:
        """How many could be left out."""
        return int(np.count_nonzero(np.isfinite(self.after)))

    def rms(self) -> tuple[float, float]:
        """Return the root mean squares before and after, over the pairs that were judged."""
        both = np.isfinite(self.before) & np.isfinite(self.after)
        if not both.any():
            return math.nan, math.nan
        return rms(self.before[both]), rms(self.after[both])

    def median(self) -> tuple[float, float]:
        """Return the medians before and after, over the pairs that were judged."""
        both = np.isfinite(self.before) & np.isfinite(self.after)
        if not both.any():
            return math.nan, math.nan
        return float(np.median(self.before[both])), float(np.median(self.after[both]))


def verified(
    session: Session,
    options: RefinementOptions | None = None,
    *,
    progress: Callable[[float, str], None] = _silent,
) -> Verification:
    """Refine anew without each landmark in turn, and measure how far the warp misses it.

    Parameters
    ----------
    session
        With both meshes and at least five pairs.
    options
        How; without it as the session was refined.
    progress
        Called with the share done and words; what it raises ends it.

    Returns
    -------
    Verification

    Raises
    ------
    PinwarpError
        When something is missing or does not fit, or there are too few pairs to leave one out.
    """
    if options is None and session.refinement is not None:
        options = RefinementOptions.of(session.refinement)
    given = _Given.of(session, options or RefinementOptions()).with_curves(session)
    _refuse_coincident(session)
    names = tuple(pair.name for pair in session.pairs)
    if len(names) < LEAST_PAIRS:
        raise PinwarpError(
            f"With {counted(len(names), 'pair')} none can be left out: "
            f"place at least {LEAST_PAIRS}."
        )
    u, v = given.landmarks
    left_out = leave_one_out(factorise(u), v, given.settings.landmark_tolerance)
    after, problems = np.full(len(names), np.nan), []
    for row, name in enumerate(names):

        def within(share: float, _words: str, row: int = row) -> None:
            words = f"refining without landmark {row + 1} of {len(names)}"
            progress((row + share) / len(names), words)

        try:
            spline = given.without(row, name).refine(lambda _level: None, within).spline
        except (LandmarkError, MeshError) as error:
            problems.append(f"{name} cannot be left out: {error}")
            continue
        after[row] = np.linalg.norm(spline.evaluate(u[row : row + 1])[0] - v[row])
    return Verification(names, left_out.distances, after, tuple(problems))


@dataclass(frozen=True, eq=False)
class _Given:
    """All that a refinement of a session starts from."""

    source: Mesh
    destination: Mesh
    landmarks: tuple[Matrix, Matrix]
    settings: RefinementSettings
    curves: tuple[DrawnPoints, ...] = ()
    # The landmarks that each of them is anchored to.
    anchors: tuple[frozenset[str], ...] = ()

    @classmethod
    def of(cls, session: Session, options: RefinementOptions) -> _Given:
        source, destination = (_mesh(session, side) for side in Side)
        penalty = session.settings.penalty
        if session.settings.basis is not Basis.R:
            raise PinwarpError("A warp can be refined with the basis r only: choose it first.")
        if not session.settings.is_regular:
            raise PinwarpError(
                "A warp of the OPYNSIM convention can be refined at penalty 0 only: set it to 0, "
                "or choose the regularising convention."
            )
        tolerance = penalty if options.landmark_tolerance is None else options.landmark_tolerance
        if math.isinf(tolerance):
            raise PinwarpError(
                "At an infinite penalty the warp is the affine fit, which nothing bends: lower "
                "the penalty, or give the landmarks a tolerance of their own."
            )
        return cls(
            source,
            destination,
            (positions(session.pairs, Side.SOURCE), positions(session.pairs, Side.DESTINATION)),
            RefinementSettings(options.smallest_feature, tolerance, options.turn_destination),
        )

    def with_curves(self, session: Session) -> _Given:
        """Return the same with the points of the curves that are drawn on both bones."""
        curves = drawn_curves(session)
        if not curves:
            return self
        finders = {
            Side.SOURCE: PathFinder(Surface(self.source)),
            Side.DESTINATION: PathFinder(Surface(self.destination)),
        }
        named = {pair.name: pair.source for pair in session.pairs if pair.source is not None}
        found = gathered(curves, named, finders[Side.SOURCE], lambda: finders[Side.DESTINATION])
        points = []
        for curve in found.semilandmarks.curves:
            own = curve.rows[curve.rows >= len(named)] - len(named)
            assert curve.path is not None, "only what is drawn was gathered"
            points.append(DrawnPoints(found.semilandmarks.source[own], curve.path))
        # One of which no point takes part is not among them.
        held = [x for x, numbers in zip(curves, found.numbers, strict=True) if len(numbers)]
        anchors = tuple(frozenset(handle.landmark for handle in x.anchors) for x in held)
        return replace(self, curves=tuple(points), anchors=anchors)

    def without(self, row: int, name: str) -> _Given:
        """Return the same without a landmark, and without the curves that are anchored to it."""
        u, v = (np.delete(places, row, axis=0) for places in self.landmarks)
        both = zip(self.curves, self.anchors, strict=True)
        kept = [(curve, anchors) for curve, anchors in both if name not in anchors]
        curves, anchors = (tuple(x for x, _ in kept), tuple(x for _, x in kept))
        return replace(self, landmarks=(u, v), curves=curves, anchors=anchors)

    def refine(
        self, told: Callable[[Level], None], progress: Callable[[float, str], None]
    ) -> Refinement:
        # One thread: it is faster for matrices of this size, and the same everywhere bit for bit.
        with threadpool_limits(limits=1, user_api="blas"):
            return refine(
                self.source,
                self.destination,
                *self.landmarks,
                self.settings,
                curves=self.curves,
                told=told,
                progress=progress,
            )


def _mesh(session: Session, side: Side) -> Mesh:
    mesh, file = session.mesh(side), session.mesh_file(side)
    if mesh is not None:
        return mesh
    if file is not None:
        raise PinwarpError(
            f"The {side.value} mesh {file.path} is not there. Was it moved or renamed?"
        )
    what = "that is to be warped" if side is Side.SOURCE else "whose surface is to be fitted"
    raise PinwarpError(f"There is no {side.value} mesh: open the bone {what}.")


def _refuse_coincident(session: Session) -> None:
    """Name the pairs at one place of the source; the solver only knows them by row."""
    pairs = session.pairs
    if not pairs:
        return
    for rows in factorise(positions(pairs, Side.SOURCE)).duplicates:
        raise PinwarpError(
            f"{listed([pairs[row].name for row in rows])} lie at one place of the source: remove "
            f"or disable {'one' if len(rows) == 2 else 'all but one'} of them."
        )
