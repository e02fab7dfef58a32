"""Landmarks and semilandmarks of one side as rows of one table, as other programs number them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

from pinwarp.core.landmarks import Landmark, Position, Side
from pinwarp.io.landmark_formats.writing import in_millimetres

NamedPlace = tuple[str, Position | None]


@dataclass(frozen=True)
class CurveRows:
    """A curve among the rows of a :class:`PointSet`.

    Attributes
    ----------
    name
        The curve.
    is_closed
        Whether it goes on from its last row to its first.
    rows
        From 0, in order along it: landmarks that it is anchored to, and its points.
    points
        Those of them that are its own points, not landmarks.
    """

    name: str
    is_closed: bool
    rows: tuple[int, ...]
    points: tuple[int, ...]

    @cached_property
    def steps(self) -> tuple[tuple[int, int], ...]:
        """Each row and the next one."""
        steps = list(pairwise(self.rows))
        if self.is_closed and len(self.rows) > 2:
            steps.append((self.rows[-1], self.rows[0]))
        return tuple(steps)

    @cached_property
    def sliders(self) -> tuple[tuple[int, int, int], ...]:
        """The row before, the point that slides between, the row after; ends do not slide."""
        before = {b: a for a, b in self.steps}
        after = dict(self.steps)
        return tuple((before[x], x, after[x]) for x in self.points if x in before and x in after)


@dataclass(frozen=True)
class PatchRows:
    """A patch among the rows of a :class:`PointSet`: its name, and its points."""

    name: str
    points: tuple[int, ...]


@dataclass(frozen=True)
class PointSet:
    """Landmarks and semilandmarks of one side, in one order for every specimen.

    Attributes
    ----------
    places
        Names and places; None for one that has none here: it is written as missing, so that
        the rows of another specimen are the same ones.
    landmarks
        How many of them are landmarks: the first.
    curves, patches
        What the others belong to.
    unit
        The unit the positions are in.

    Examples
    --------
    >>> tip, crest = ("tip", (0.0, 0.0, 0.0)), ("crest_1", (1.0, 0.0, 0.0))
    >>> points = PointSet((tip, crest), 1, (CurveRows("crest", False, (0, 1), (1,)),))
    >>> points.sliding, points.curves[0].steps
    ((), ((0, 1),))
    """

    places: tuple[NamedPlace, ...]
    landmarks: int
    curves: tuple[CurveRows, ...] = ()
    patches: tuple[PatchRows, ...] = ()
    unit: str = "mm"

    @property
    def sliding(self) -> tuple[int, ...]:
        """The rows that slide: ends of curves do not, since nothing tells a direction there."""
        rows = [x for curve in self.curves for _, x, _ in curve.sliders]
        rows += self.on_surfaces
        # One on two curves slides once.
        return tuple(sorted(set(rows)))

    @property
    def on_surfaces(self) -> list[int]:
        """The rows of the points of patches."""
        return [x for patch in self.patches for x in patch.points]

    @property
    def missing(self) -> int:
        """How many have no place here."""
        return sum(place is None for _, place in self.places)

    def in_millimetres(self) -> PointSet:
        """Return the same in millimetres; see the function of that name."""
        marks = (
            Landmark(f"{row}").placed(Side.SOURCE, place)
            for row, (_, place) in enumerate(self.places)
        )
        placed = in_millimetres(marks, self.unit)
        names = (name for name, _ in self.places)
        return replace(
            self, places=tuple(zip(names, (mark.source for mark in placed), strict=True))
        )


@dataclass(frozen=True)
class OutputFile:
    """A file to be written: what follows the name of the first one, and its text."""

    suffix: str
    text: str


def from_one(rows: Iterable[int]) -> str:
    """Return rows as R and its kin count them.

    Examples
    --------
    >>> from_one([0, 4])
    '1, 5'
    """
    return ", ".join(str(row + 1) for row in rows)
