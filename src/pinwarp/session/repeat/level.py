"""The warping penalty of a session that the noise of its landmarks asks for."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.basis import Basis
from pinwarp.core.errors import PinwarpError
from pinwarp.core.factor import factorise
from pinwarp.core.landmarks import Side, positions
from pinwarp.core.noise import carried_variance, noise_level
from pinwarp.core.spline import PenaltyConvention
from pinwarp.core.words import counted, some_of
from pinwarp.session import edits
from pinwarp.session.repeat.comparing import Repeats
from pinwarp.session.repeat.spreads import kept_variance
from pinwarp.session.session import Session

Matrix = NDArray[np.float64]

# Repeats lie where the session's landmarks are, but for so many times their spread.
FAR = 5.0
# The same landmarks of one bone never differ so much in size.
UNLIKELY = 2.0


@dataclass(frozen=True)
class PenaltyOfNoise:
    """What the noise of the landmarks asks for; lengths in mesh units.

    Attributes
    ----------
    penalty
        Infinity where the noise alone explains all that is not affine.
    low, high
        The same with the ends of the interval in which the measured variance lies.
    noise
        Standard deviation of one coordinate on the destination: both sides', as far as known.
    field
        The scale of the warp's own variance, in destination units squared per source unit.
    sides
        Whose spread is in the noise.
    """

    penalty: float
    low: float
    high: float
    noise: float
    field: float
    sides: tuple[Side, ...]

    @property
    def words(self) -> str:
        """What it rests on, as a sentence."""
        both = len(self.sides) == 2
        sides = " and ".join(side.value for side in self.sides)
        only = "" if both else f"; the {self.sides[0].other.value} counts as exact"
        return f"For landmarks digitised once, with the spread of the {sides}{only}."


def penalty_of_noise(session: Session, side: Side, repeats: Repeats) -> PenaltyOfNoise:
    """Return the penalty that belongs to the noise of a session's landmarks.

    Parameters
    ----------
    session
        Its pairs say how much the warp itself varies. Where spreads of the other side are kept
        with it, they count, too.
    side
        The side that was digitised again.
    repeats
        How precise it is, in the frame and unit of that side.

    Raises
    ------
    PinwarpError
        With fewer than five pairs in general position, when the repeats are in another unit, or
        with another basis than r.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> from pinwarp.session.repeat.comparing import compared
    >>> from pinwarp.session.repeat.reading import Repeat
    >>> session = read_session(sample_session(), meshes=())
    >>> first = {x.name: x.destination for x in session.pairs}
    >>> again = {name: (x + 0.5, y, z) for name, (x, y, z) in first.items()}
    >>> repeats = compared([Repeat(Path("a.csv"), first), Repeat(Path("b.csv"), again)])
    >>> found = penalty_of_noise(session, Side.DESTINATION, repeats)
    >>> 0 < found.low < found.penalty < found.high
    True
    """
    _refuse_other_unit(session, side, repeats)
    if session.settings.basis is not Basis.R:
        raise PinwarpError(
            "The penalty that noise asks for is known for the basis r only: choose it first."
        )
    pairs, measured = session.pairs, repeats.figures
    source, destination = (positions(pairs, one) for one in Side)
    factor = factorise(source, planar=session.settings.planar) if len(pairs) else None
    other = kept_variance(session.landmarks, side.other)
    sides = (side,) if other is None else tuple(Side)

    def on_destination(one: Side, variance: float) -> float:
        if one is Side.DESTINATION:
            return variance
        return carried_variance(source, destination, variance)

    beside = 0.0 if other is None else on_destination(side.other, other)
    variances = (measured.variance, *measured.variance_interval)
    totals = [beside + on_destination(side, variance) for variance in variances]
    levels = [None if factor is None else noise_level(factor, destination, x) for x in totals]
    level, low, high = levels
    if level is None or low is None or high is None:
        raise PinwarpError(
            f"{counted(len(pairs), 'pair')} cannot tell how much the warp itself varies: five in "
            "general position are the least."
        )
    return PenaltyOfNoise(
        level.penalty, low.penalty, high.penalty, math.sqrt(totals[0]), level.field, sides
    )


def with_penalty(session: Session, penalty: float) -> Session:
    """Return the session with a penalty of the regularising convention, which noise asks for."""
    return edits.set_penalty(edits.set_convention(session, PenaltyConvention.REGULARISING), penalty)


def with_spreads_of(session: Session, side: Side, repeats: Repeats) -> Session:
    """Return the session with what was measured kept by the landmarks of those names.

    Raises
    ------
    PinwarpError
        When it has none of them, or is in another unit.
    """
    _refuse_other_unit(session, side, repeats)
    spreads = repeats.spreads
    if not any(x.name in spreads for x in session.landmarks):
        raise PinwarpError(f"The session has no landmark called {some_of(list(spreads))}.")
    landmarks = (
        x.with_spread(side, spreads[x.name]) if x.name in spreads else x for x in session.landmarks
    )
    return replace(session, landmarks=tuple(landmarks))


def without_spreads(session: Session) -> Session:
    """Return the session without any spread."""
    return replace(
        session,
        landmarks=tuple(
            replace(x, source_spread=None, destination_spread=None) for x in session.landmarks
        ),
    )


def about_session(session: Session, side: Side, repeats: Repeats) -> tuple[str, ...]:
    """Say how the repeats and the landmarks of a session belong together, as sentences.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.core.landmarks import Landmark
    >>> from pinwarp.session.repeat.comparing import compared
    >>> from pinwarp.session.repeat.reading import Repeat
    >>> repeats = compared([Repeat(Path(x), {"apex": (0, 0, i)}) for i, x in enumerate("ab")])
    >>> about_session(Session(landmarks=(Landmark("apex"), Landmark("tip"))), Side.SOURCE, repeats)
    ('tip has no spread.',)
    """
    notes = []
    known = {x.name for x in session.landmarks}
    if strange := [x for x in repeats.spreads if x not in known]:
        notes.append(f"The session has no {some_of(strange)}.")
    placed = [x.name for x in session.landmarks if x.position(side) is not None]
    if lacking := [x for x in placed or known if x not in repeats.spreads]:
        notes.append(
            f"{some_of(sorted(lacking))} {'has' if len(lacking) == 1 else 'have'} no spread."
        )
    away, other = (_away(session, one, repeats) for one in (side, side.other))
    if away is None or away <= FAR * repeats.figures.spread:
        return tuple(notes)
    if other is not None and other * FAR < away:
        notes.append(
            f"The repeats lie {other:.3g} from the {side.other.value} landmarks, but {away:.3g} "
            f"from those of the {side.value}: is it the {side.other.value} that was digitised "
            "again?"
        )
    else:
        notes.append(
            f"The repeats lie {away:.3g} from the session's {side.value} landmarks, far more than "
            "their spread: are they of this bone, in its frame?"
        )
    return tuple(notes)


def _away(session: Session, side: Side, repeats: Repeats) -> float | None:
    """Return how far the repeats lie from the landmarks of a side, in the median."""
    own, means = _in_common(session, side, repeats)
    return float(np.median(np.linalg.norm(own - means, axis=1))) if len(own) else None


def _in_common(session: Session, side: Side, repeats: Repeats) -> tuple[Matrix, Matrix]:
    """Return where a session and its repeats have the same landmarks."""
    rows = {name: row for row, name in enumerate(repeats.names)}
    both = [x for x in session.landmarks if x.name in rows and x.position(side) is not None]
    return positions(both, side), repeats.figures.means[[rows[x.name] for x in both]]


def _refuse_other_unit(session: Session, side: Side, repeats: Repeats) -> None:
    """Raise where repeats are so large or small beside a session that their unit is another."""
    sizes = [
        float(np.linalg.norm(x - x.mean(axis=0))) if len(x) > 1 else 0.0
        for x in _in_common(session, side, repeats)
    ]
    own, measured = sizes
    if own * measured == 0 or 1 / UNLIKELY < measured / own < UNLIKELY:
        return
    raise PinwarpError(
        f"The repeats are {measured / own:.3g} times as large as the session's {side.value} "
        "landmarks: they are in another unit, or of another bone. Convert them first."
    )
