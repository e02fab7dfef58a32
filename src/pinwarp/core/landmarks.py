"""The landmark: a named place with a source position, a destination position, or both."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import LandmarkError

Position = tuple[float, float, float]

# What a note says of a destination that nobody has looked at yet, beside what else it says.
SUGGESTED = "suggested"
# And of a pair where somebody has looked, and left it where the program had put it.
ACCEPTED = "accepted unmoved"
_BETWEEN_REMARKS = ";"


class Side(StrEnum):
    """Which of the two meshes a position is on.

    Examples
    --------
    >>> Side.SOURCE.other.value
    'destination'
    """

    SOURCE = "source"
    DESTINATION = "destination"

    @property
    def other(self) -> Side:
        """The opposite side."""
        return Side.DESTINATION if self is Side.SOURCE else Side.SOURCE


class Role(StrEnum):
    """What a landmark is for: a pair is solved for, a passenger only carried along.

    Examples
    --------
    >>> Landmark("muscle_insertion", source=(1, 2, 3), role=Role.PASSENGER).is_pair
    False
    """

    PAIR = "pair"
    PASSENGER = "passenger"


class LandmarkState(StrEnum):
    """How far a landmark has come; every state is drawn with its own shape."""

    PAIRED = "paired"
    SUGGESTED = "suggested"
    SOURCE_ONLY = "source only"
    DESTINATION_ONLY = "destination only"
    EMPTY = "not placed"
    PASSENGER = "passenger"
    DISABLED = "disabled"


@dataclass(frozen=True, slots=True)
class Landmark:
    """One named place.

    Parameters
    ----------
    name
        Unique within a session, not empty.
    source, destination
        Position on either mesh in that mesh's own frame and unit, or None where not placed yet.
    role
        A pair takes part in the solve; a passenger is only carried along by the warp.
    enabled
        A disabled pair is kept but does not take part.
    note
        Free text. Its remark "suggested", alone or behind a semicolon, says that nobody has looked
        at the destination yet; "accepted unmoved", that it was left where it was expected.
    extra
        Columns of a session file that this version does not know, kept as they came.
    locked
        A locked landmark is not moved by accident: the mouse and the arrow keys leave it alone.
    source_spread, destination_spread
        How far apart it comes to lie when it is digitised again: the root mean square distance
        from the mean, in the unit of the position; None where nobody measured it.

    Raises
    ------
    LandmarkError
        For an empty name, a coordinate that is not finite, or a spread that is no length.

    Examples
    --------
    >>> fovea = Landmark("fovea_capitis", source=(1.0, 2.0, 3.0))
    >>> fovea.state.value
    'source only'
    >>> fovea.placed(Side.DESTINATION, (4.0, 5.0, 6.0)).is_pair
    True
    """

    name: str
    source: Position | None = None
    destination: Position | None = None
    role: Role = Role.PAIR
    enabled: bool = True
    note: str = ""
    extra: tuple[tuple[str, str], ...] = ()
    locked: bool = False
    source_spread: float | None = None
    destination_spread: float | None = None

    def __post_init__(self) -> None:
        if not self.name.strip():
            raise LandmarkError("A landmark needs a name.")
        for side in Side:
            position = self.position(side)
            if position is not None and not all(math.isfinite(x) for x in position):
                raise LandmarkError(
                    f"{self.name}: the {side.value} position {position} is not finite."
                )
            spread = self.spread(side)
            if spread is not None and not (math.isfinite(spread) and spread >= 0):
                raise LandmarkError(f"{self.name}: the {side.value} spread {spread} is no length.")

    def position(self, side: Side) -> Position | None:
        """Return the position on one side, or None."""
        return self.source if side is Side.SOURCE else self.destination

    def spread(self, side: Side) -> float | None:
        """Return how precisely it was digitised on one side, or None."""
        return self.source_spread if side is Side.SOURCE else self.destination_spread

    def with_spread(self, side: Side, spread: float | None) -> Landmark:
        """Return this landmark with the spread on one side replaced (None removes it)."""
        if side is Side.SOURCE:
            return replace(self, source_spread=spread)
        return replace(self, destination_spread=spread)

    def placed(self, side: Side, position: Iterable[float] | None) -> Landmark:
        """Return this landmark with the position on one side replaced (None removes it)."""
        value = None if position is None else as_position(position)
        if side is Side.SOURCE:
            return replace(self, source=value)
        return replace(self, destination=value)

    @property
    def is_complete(self) -> bool:
        """Whether both positions are there."""
        return self.source is not None and self.destination is not None

    @property
    def is_pair(self) -> bool:
        """Whether it takes part in the solve: complete, enabled and not a passenger."""
        # Spelt out: it is asked of every landmark at every frame.
        return (
            self.enabled
            and self.role is Role.PAIR
            and self.source is not None
            and self.destination is not None
        )

    @property
    def is_suggested(self) -> bool:
        """Whether its destination was only suggested, and nobody has looked at it yet."""
        return (
            self.destination is not None
            # In two steps: it is asked of every landmark at every frame.
            and SUGGESTED in self.note
            and SUGGESTED in self._remarks()
        )

    def suggested(self, position: Iterable[float]) -> Landmark:
        """Return it with a destination that is only suggested; what its note says is kept.

        Examples
        --------
        >>> fovea = Landmark("fovea", source=(0, 0, 0), note="deep").suggested((1, 0, 0))
        >>> fovea.note, fovea.state.value, fovea.accepted().note
        ('deep; suggested', 'suggested', 'deep; accepted unmoved')
        """
        return self.placed(Side.DESTINATION, position)._with_remark(SUGGESTED)

    @property
    def is_accepted(self) -> bool:
        """Whether it was left where the program had put it: a pair that proves nothing."""
        return self.is_complete and ACCEPTED in self.note and ACCEPTED in self._remarks()

    @property
    def is_by_hand(self) -> bool:
        """Whether somebody has placed it: neither suggested only, nor accepted unmoved."""
        return not (self.is_suggested or self.is_accepted)

    def accepted(self) -> Landmark:
        """Return it with the places that it has, looked at by somebody and left unmoved."""
        return self._with_remark(ACCEPTED)

    def by_hand(self) -> Landmark:
        """Return it with the places that it has, chosen by somebody."""
        return self._with_remark(None)

    def _with_remark(self, remark: str | None) -> Landmark:
        """Say of its places this, and nothing else."""
        before = self._remarks()
        after = [one for one in before if one not in (SUGGESTED, ACCEPTED)]
        after += [remark] if remark is not None else []
        return self if after == before else replace(self, note=f"{_BETWEEN_REMARKS} ".join(after))

    def _remarks(self) -> list[str]:
        return [remark for part in self.note.split(_BETWEEN_REMARKS) if (remark := part.strip())]

    @property
    def state(self) -> LandmarkState:
        """How far it has come."""
        if self.role is Role.PASSENGER:
            return LandmarkState.PASSENGER
        if not self.enabled:
            return LandmarkState.DISABLED
        match self.source is not None, self.destination is not None:
            case True, True:
                return LandmarkState.SUGGESTED if self.is_suggested else LandmarkState.PAIRED
            case True, False:
                return LandmarkState.SOURCE_ONLY
            case False, True:
                return LandmarkState.DESTINATION_ONLY
            case _:
                return LandmarkState.EMPTY


def as_position(values: Iterable[float]) -> Position:
    """Turn three numbers of any kind into a position of Python floats."""
    x, y, z = (float(value) for value in values)
    return (x, y, z)


def pairs_of(landmarks: Iterable[Landmark]) -> tuple[Landmark, ...]:
    """Return the landmarks that take part in the solve, in order."""
    return tuple(landmark for landmark in landmarks if landmark.is_pair)


def positions(landmarks: Sequence[Landmark], side: Side) -> NDArray[np.float64]:
    """Return the (n, 3) positions of landmarks that all have one on that side."""
    found = [landmark.position(side) for landmark in landmarks]
    return np.array([p for p in found if p is not None], dtype=np.float64).reshape(-1, 3)


def duplicate_names(landmarks: Iterable[Landmark]) -> list[str]:
    """Return every name that occurs more than once, in order of first repetition."""
    seen: set[str] = set()
    repeated: dict[str, None] = {}
    for landmark in landmarks:
        if landmark.name in seen:
            repeated[landmark.name] = None
        seen.add(landmark.name)
    return list(repeated)


def flipped(landmarks: Iterable[Landmark], side: Side) -> tuple[Landmark, ...]:
    """Turn the positions on one side from LPS to RAS or back: x and y change their sign.

    Parameters
    ----------
    landmarks
        Those without a position there stay as they are.
    side
        The side to turn.

    Examples
    --------
    >>> flipped([Landmark("nasion", source=(1.0, 2.0, 3.0))], Side.SOURCE)[0].source
    (-1.0, -2.0, 3.0)
    """
    return tuple(
        landmark if (at := landmark.position(side)) is None else landmark.placed(side, _turned(at))
        for landmark in landmarks
    )


def _turned(position: Position) -> Position:
    x, y, z = position
    return (-x, -y, z)


def scaled(
    landmarks: Iterable[Landmark], factor: float, side: Side | None = None
) -> tuple[Landmark, ...]:
    """Multiply every position and spread that is there, as a change of unit does.

    Parameters
    ----------
    landmarks
        Those without a position there stay as they are.
    factor
        1000 from metres to millimetres.
    side
        The side to scale; None scales both.

    Raises
    ------
    LandmarkError
        When a coordinate becomes too large for a number.

    Examples
    --------
    >>> scaled([Landmark("nasion", source=(0.5, 0.25, -1.0))], 1000)[0].source
    (500.0, 250.0, -1000.0)
    """
    result = []
    for landmark in landmarks:
        for one in Side if side is None else (side,):
            position = landmark.position(one)
            if position is not None:
                landmark = landmark.placed(one, (factor * value for value in position))
            if (spread := landmark.spread(one)) is not None:
                landmark = landmark.with_spread(one, abs(factor) * spread)
        result.append(landmark)
    return tuple(result)
