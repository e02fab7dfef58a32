"""Repeats of one set of landmarks put side by side: what differs beside their places is told."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Position, as_position
from pinwarp.core.lengths import rms, rounding_among
from pinwarp.core.repeatability import Repeatability, repeatability
from pinwarp.core.words import listed, some_of
from pinwarp.session.importing.fit import SHARPLY, Fit
from pinwarp.session.naming import is_automatic
from pinwarp.session.repeat.reading import Repeat

Matrix = NDArray[np.float64]

UNITS_IN_MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}
_TURNED = (-1.0, -1.0, 1.0)
# A few landmarks may lie anywhere by chance.
LEAST_TO_TELL = 3
# With fewer a rigid motion alone takes up most of what differs.
LEAST_TO_STAND = 6
# So many times closer when moved as a whole: the bone stood otherwise.
STANDS_OTHERWISE = 3.0


class OtherFrameError(PinwarpError):
    """A repeat seems to be in another frame or unit than the first, and says nothing of that."""


@dataclass(frozen=True, eq=False)
class Repeats:
    """The same landmarks, digitised several times.

    Attributes
    ----------
    labels
        What the files are called.
    names
        Of all landmarks, in the order of the first file.
    places : (k, n, 3) float64
        In the frame and unit of the first file; NaN where a file lacks one.
    figures
        How precise they are.
    unit
        Their unit, where a file says it; else empty.
    notes
        What the user should know, as sentences.
    """

    labels: tuple[str, ...]
    names: tuple[str, ...]
    places: Matrix
    figures: Repeatability
    unit: str
    notes: tuple[str, ...]

    @property
    def spreads(self) -> Mapping[str, float]:
        """The spread of each landmark that was placed at least twice."""
        found = zip(self.names, self.figures.spreads.tolist(), strict=True)
        return {name: spread for name, spread in found if spread == spread}

    @property
    def worst_first(self) -> tuple[int, ...]:
        """The rows of landmarks with a spread, the largest first."""
        spreads = self.figures.spreads
        order = np.argsort(-np.where(np.isnan(spreads), -1.0, spreads), kind="stable")
        return tuple(int(row) for row in order if not np.isnan(spreads[row]))


def compared(repeats: Sequence[Repeat], *, by_order: bool = False, adapt: bool = False) -> Repeats:
    """Put repeats side by side, by name, without aligning them: it is the same bone.

    Parameters
    ----------
    repeats
        Two or more.
    by_order
        Match the landmarks by their order in the files, whatever their names are.
    adapt
        Bring a repeat that seems to be in another frame (x and y negated) or unit (a factor of
        1,000) to that of the first. Where both files say what they are in, that is always done.

    Raises
    ------
    PinwarpError
        With fewer than two repeats, the same file twice, no landmark in common, or nothing but
        copies.
    OtherFrameError
        Where one seems to be in another frame or unit, and is not to be adapted.

    Examples
    --------
    >>> one = Repeat(Path("a.csv"), {"fovea": (0, 0, 0), "apex": (9, 0, 0)})
    >>> two = Repeat(Path("b.csv"), {"apex": (9, 4, 0), "fovea": (2, 0, 0)})
    >>> found = compared([one, two])
    >>> found.figures.spreads.round(2).tolist(), found.notes
    ([1.41, 2.83], ('b.csv lists its landmarks in another order: they were matched by name.',))
    """
    if len(repeats) < 2:
        raise PinwarpError("One file has nothing to compare with: give two repeats or more.")
    paths = [repeat.path.absolute() for repeat in repeats]
    if twice := [repeat.path.name for repeat in repeats if paths.count(repeat.path.absolute()) > 1]:
        raise PinwarpError(f"{twice[0]} is given twice: each repeat is a file of its own.")
    labels = labels_of([repeat.path for repeat in repeats])
    notes = [f"{label}: {x}" for label, one in zip(labels, repeats, strict=True) for x in one.notes]
    repeats, told = _in_one_frame(repeats, labels)
    notes += told
    if by_order:
        repeats = _named_by_order(repeats, labels)
    else:
        notes += _about_names(repeats, labels)
    names = tuple(dict.fromkeys(name for repeat in repeats for name in repeat.places))
    missing = (np.nan,) * 3
    places = np.array([[x.places.get(name, missing) for name in names] for x in repeats])
    for row in range(1, len(repeats)):
        places[row], told = _adapted(places[0], places[row], labels[0], labels[row], adapt)
        notes += told
    notes += _copies(names, places, labels)
    for row in range(1, len(repeats)):
        notes += _standing(places[0], places[row], labels[0], labels[row])
    figures = repeatability(places)
    notes += _exchanged(names, places, labels)
    notes += _about_outstanding(names, places, figures, labels)
    unit = next((repeat.unit for repeat in repeats if repeat.unit), "")
    return Repeats(labels, names, places, figures, unit, tuple(notes))


def labels_of(paths: Sequence[Path]) -> tuple[str, ...]:
    """Return what files are called: by their folder, too, where two have one name.

    Examples
    --------
    >>> labels_of([Path("ann/set.csv"), Path("bob/set.csv"), Path("c.csv")])
    ('ann/set.csv', 'bob/set.csv', 'c.csv')
    """
    names = [path.name for path in paths]
    return tuple(
        f"{path.absolute().parent.name}/{path.name}" if names.count(path.name) > 1 else path.name
        for path in paths
    )


def _in_one_frame(
    repeats: Sequence[Repeat], labels: Sequence[str]
) -> tuple[list[Repeat], list[str]]:
    """Bring what two files say of themselves together: that is no guess."""
    first, notes = repeats[0], []
    result = [first]
    for repeat, label in zip(repeats[1:], labels[1:], strict=True):
        ways, factors = [], np.ones(3)
        if first.unit and repeat.unit and first.unit != repeat.unit:
            factors *= UNITS_IN_MM[repeat.unit] / UNITS_IN_MM[first.unit]
            ways.append(f"from {repeat.unit} to {first.unit}")
        if first.frame and repeat.frame and first.frame != repeat.frame:
            factors *= _TURNED
            ways.append(f"from {repeat.frame} to {first.frame}")
        if ways:
            places = {
                name: as_position(factors * np.array(at)) for name, at in repeat.places.items()
            }
            notes.append(f"{label} was converted {listed(ways)}, as {labels[0]} says it is.")
            repeat = replace(repeat, places=places, unit=first.unit, frame=first.frame)
        result.append(repeat)
    return result, notes


def _named_by_order(repeats: Sequence[Repeat], labels: Sequence[str]) -> list[Repeat]:
    names = list(repeats[0].places)
    for repeat, label in zip(repeats, labels, strict=True):
        if len(repeat.places) != len(names):
            raise PinwarpError(
                f"{label} has {len(repeat.places)} landmarks and {labels[0]} {len(names)}: by "
                "their order they cannot be matched."
            )
    return [
        replace(repeat, places=dict(zip(names, repeat.places.values(), strict=True)))
        for repeat in repeats
    ]


def _about_names(repeats: Sequence[Repeat], labels: Sequence[str]) -> list[str]:
    """Say which landmarks are not everywhere, and how the others were matched."""
    first = repeats[0].places
    everything = dict.fromkeys(name for repeat in repeats for name in repeat.places)
    often = {x: sum(x in repeat.places for repeat in repeats) for x in everything}
    if max(often.values()) < 2:
        raise PinwarpError(
            f"No name is in two of the files: {labels[0]} has {some_of(list(first))}, {labels[1]} "
            f"{some_of(list(repeats[1].places))}. If they stand in the same order, match them by "
            "their order."
        )
    notes = []
    for repeat, label in zip(repeats, labels, strict=True):
        lacking = [x for x in everything if x not in repeat.places]
        if lacking:
            notes.append(f"{label} lacks {some_of(lacking)}.")
        alike = {_plain(x): x for x in lacking}
        notes += [
            f"{label} has {name!r}: is it {other!r}? Names must be the same."
            for name in repeat.places
            if (other := alike.get(_plain(name)))
        ]
        both = [x for x in repeat.places if x in first]
        if both != [x for x in first if x in repeat.places]:
            notes.append(
                f"{label} lists its landmarks in another order: they were matched by name."
            )
    if alone := [x for x, count in often.items() if count == 1]:
        what = "is in one file only: it has" if len(alone) == 1 else "are in one file only: without"
        notes.append(f"{some_of(alone)} {what} {'no spread' if len(alone) == 1 else 'a spread'}.")
    if all(map(is_automatic, (x for x, count in often.items() if count > 1))):
        notes.append("No landmark has a name that somebody chose: they were matched by number.")
    return notes


def _plain(name: str) -> str:
    return "".join(letter for letter in name.casefold() if letter.isalnum())


def _adapted(
    first: Matrix, other: Matrix, label: str, other_label: str, adapt: bool
) -> tuple[Matrix, list[str]]:
    """Look whether a repeat is in another frame or unit, and bring it to that of the first."""
    both = np.isfinite(first[:, 0]) & np.isfinite(other[:, 0])
    if both.sum() < LEAST_TO_TELL:
        return other, []
    # What shrinks to nothing comes near to all: only a size that is right then is an argument.
    ratio = _size(first[both]) / max(_size(other[both]), np.finfo(np.float64).tiny)
    factors = [1.0, *(x for x in (1000.0, 0.001) if 0.5 < ratio / x < 2)]
    ways = [Fit(flips, factor) for factor in factors for flips in (False, True)]
    apart = [_apart(first[both], way.moved(_places(other[both]))) for way in ways]
    best = int(np.argmin(apart))
    # A copy in another unit is 0 apart: what is not sharply closer is as it is stored.
    if best == 0 or not apart[0] > SHARPLY * apart[best]:
        return other, []
    words = ways[best].describe()
    words = words[0].lower() + words[1:]
    found = f"{apart[best]:.3g} from those of {label} in the mean square, as stored {apart[0]:.3g}"
    if not adapt:
        raise OtherFrameError(
            f"{other_label} seems to be in another frame or unit than {label}: {words}, its "
            f"landmarks lie {found}. If it is, have it brought to the first file's."
        )
    moved = np.full_like(other, np.nan)
    there = np.isfinite(other[:, 0])
    moved[there] = ways[best].moved(_places(other[there]))
    return moved, [f"{other_label} was taken {words}: so its landmarks lie {found}."]


def _places(matrix: Matrix) -> list[Position]:
    return [as_position(row) for row in matrix]


def _size(places: Matrix) -> float:
    return float(np.linalg.norm(places - places.mean(axis=0)))


def _apart(one: Matrix, other: Matrix) -> float:
    return rms(np.linalg.norm(one - other, axis=1))


def _copies(names: Sequence[str], places: Matrix, labels: Sequence[str]) -> list[str]:
    """Say which files, or landmarks of them, are not digitised anew."""
    notes, known, copied = [], 0, 0
    for later in range(1, len(labels)):
        for earlier in range(later):
            apart = np.linalg.norm(places[later] - places[earlier], axis=1)
            both = np.isfinite(apart)
            same = both & (apart <= rounding_among(np.nan_to_num(places)))
            known, copied = known + int(both.sum()), copied + int(same.sum())
            pair = f"{labels[earlier]} and {labels[later]}"
            if both.any() and same.sum() == both.sum():
                notes.append(f"{pair} hold the same positions: a copy says nothing of precision.")
            elif same.any():
                these = some_of([names[row] for row in np.flatnonzero(same).tolist()])
                lies = "lies" if same.sum() == 1 else "lie"
                notes.append(f"{these} {lies} at the very same place in {pair}: copied?")
    if known and known == copied:
        raise PinwarpError(
            f"{listed(labels)} hold the same positions: copies say nothing of precision."
        )
    return notes


def _standing(first: Matrix, other: Matrix, label: str, other_label: str) -> Iterable[str]:
    """Say where a repeat lies as if the bone had been moved."""
    both = np.isfinite(first[:, 0]) & np.isfinite(other[:, 0])
    if both.sum() < LEAST_TO_STAND:
        return
    apart = _apart(first[both], other[both])
    similarity = fit_similarity(other[both], first[both], scaling=False)
    aligned = _apart(first[both], similarity.apply(other[both]))
    if apart > STANDS_OTHERWISE * aligned:
        yield (
            f"{other_label} stands otherwise than {label}: as it is its landmarks lie {apart:.3g} "
            f"away, moved as a whole {aligned:.3g}. Was the bone moved between? The spreads "
            "count that as noise."
        )


def _exchanged(names: Sequence[str], places: Matrix, labels: Sequence[str]) -> list[str]:
    """Say which two landmarks one file seems to hold under each other's names."""
    notes = []
    # Of two files neither can be told to be the wrong one.
    files = ("one of the files",) if len(labels) == 2 else labels
    for row, label in enumerate(files):
        others = np.delete(places, row, axis=0)
        there = np.isfinite(places[row, :, 0]) & np.isfinite(others[:, :, 0]).any(axis=0)
        rows = np.flatnonzero(there)
        usual = np.nanmedian(others[:, rows], axis=0)
        apart = np.linalg.norm(places[row, rows][:, None] - usual[None], axis=2)
        nearest = apart.argmin(axis=1)
        notes += [
            f"In {label}, {names[rows[one]]} and {names[rows[other]]} seem to be exchanged."
            for one, other in enumerate(nearest.tolist())
            if one < other and nearest[other] == one
        ]
    return notes


def _about_outstanding(
    names: Sequence[str], places: Matrix, figures: Repeatability, labels: Sequence[str]
) -> list[str]:
    rows = np.flatnonzero(figures.outstanding)
    if not len(rows):
        return []
    usual = float(np.nanmedian(figures.spreads))
    notes = []
    for row in rows[np.argsort(-figures.spreads[rows])].tolist():
        words = f"{names[row]} stands out: its spread is {figures.spreads[row]:.3g}, "
        words += f"{figures.spreads[row] / usual:.1f} times the median."
        if figures.counts[row] > 2:
            middle = np.nanmedian(places[:, row], axis=0)
            furthest = int(np.nanargmax(np.linalg.norm(places[:, row] - middle, axis=1)))
            words += f" {labels[furthest]} has it farthest from the others."
        notes.append(words)
    without = float(np.sqrt(3 * figures.variance_without))
    notes.append(
        f"Without {'it' if len(rows) == 1 else 'these'} the pooled spread would be {without:.3g} "
        f"instead of {figures.spread:.3g}."
    )
    return notes
