"""What an import of landmarks would do, before it is done: which becomes which, and how."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.core.names import visible
from pinwarp.io.landmark_files import LandmarkReading
from pinwarp.session import edits
from pinwarp.session.importing.fit import AS_STORED, Fit
from pinwarp.session.importing.groups import with_groups
from pinwarp.session.naming import free_names, is_automatic
from pinwarp.session.session import Session


class Pairing(StrEnum):
    """How landmarks of a file find those of the session."""

    BY_NAME = "by name"
    BY_ORDER = "by order"
    AS_NEW = "as new"
    AS_PASSENGERS = "as passengers"
    ONLY_KNOWN = "only known names"


class Fate(StrEnum):
    """What becomes of a landmark that arrives; the value is said of one and of several."""

    PAIRS = "pairs up"
    PLACES = "is placed"
    REPLACES = "replaces a position"
    SAME = "is there already"
    NEW = "is new"
    LEFT_OUT = "is left out"

    @property
    def of_several(self) -> str:
        """The same, said of several."""
        return {
            Fate.PAIRS: "pair up",
            Fate.PLACES: "are placed",
            Fate.REPLACES: "replace a position",
            Fate.SAME: "are there already",
            Fate.NEW: "are new",
            Fate.LEFT_OUT: "are left out",
        }[self]


@dataclass(frozen=True)
class Arrival:
    """One landmark of a file and what becomes of it.

    Parameters
    ----------
    landmark
        As the file has it, read in the chosen way.
    target
        The name it has in the session then.
    fate, words
        What happens, as a kind and in words.
    """

    landmark: Landmark
    target: str
    fate: Fate
    words: str


@dataclass(frozen=True)
class Arriving:
    """A landmark file that was read, on its way into a session.

    Parameters
    ----------
    path, reading
        The file and what is in it.
    side
        The side that it belongs to; None where it holds pairs.
    fits
        For each side with a mesh, the ways to read its positions: as they are stored first,
        and others only where they lie much better on the mesh.
    is_chosen
        Whether somebody said which of several specimens it is.
    pairing
        How its landmarks find those of the session, where somebody said so.
    """

    path: Path
    reading: LandmarkReading
    side: Side | None
    fits: Mapping[Side, tuple[Fit, ...]] = field(default_factory=dict)
    is_chosen: bool = False
    pairing: Pairing | None = None

    @property
    def must_choose(self) -> bool:
        """Whether the file holds several specimens, and nobody said which."""
        return len(self.reading.specimens) > 1 and not self.is_chosen

    @property
    def landmarks(self) -> tuple[Landmark, ...]:
        """Its landmarks, without the points of curves and patches."""
        return self.reading.single

    @property
    def sides(self) -> tuple[Side, ...]:
        """The sides that it fills."""
        return tuple(Side) if self.side is None else (self.side,)

    @property
    def doubtful(self) -> tuple[Side, ...]:
        """The sides where positions seem to be in another frame or unit than the mesh."""
        return tuple(side for side in self.sides if len(self.fits.get(side, ())) > 1)

    @property
    def label(self) -> str:
        """What Undo calls the import."""
        return "Import pairs" if self.side is None else f"Import {self.side.value} landmarks"


@dataclass(frozen=True)
class ImportChoice:
    """How a file is brought in.

    Parameters
    ----------
    pairing
        How its landmarks find those of the session.
    fits
        How the positions of a side are read; as they are stored where nothing is said.
    """

    pairing: Pairing
    fits: Mapping[Side, Fit] = field(default_factory=dict)


def awaiting(session: Session, side: Side) -> tuple[str, ...]:
    """Return the names of the pairs that lack a position on one side, in order.

    Examples
    --------
    >>> awaiting(Session(landmarks=(Landmark("a", (1, 2, 3)),)), Side.DESTINATION)
    ('a',)
    """
    return tuple(
        landmark.name
        for landmark in session.landmarks
        if landmark.role is Role.PAIR and landmark.position(side) is None
    )


def default_pairing(session: Session, arriving: Arriving) -> Pairing:
    """Return how a file most likely means its landmarks.

    By name where names match; else by order, where as many landmarks wait for a position, or
    where the names are mere numbers that the file may not even have had. As passengers where they
    come for the source of a session that is paired and knows none of them.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head", (1, 2, 3)),))
    >>> reading = LandmarkReading((Landmark("S000", None, (4, 5, 6)),), False, ())
    >>> default_pairing(session, Arriving(Path("a.pts"), reading, Side.DESTINATION)).value
    'by order'
    """
    names = [landmark.name for landmark in arriving.landmarks]
    waiting = () if arriving.side is None else awaiting(session, arriving.side)
    if _are_stations(session, arriving):
        return Pairing.AS_PASSENGERS
    if not waiting or not names or set(names) & set(waiting):
        return Pairing.BY_NAME
    are_numbers = all(is_automatic(name) for name in names)
    if len(names) == len(waiting) or are_numbers:
        return Pairing.BY_ORDER
    return Pairing.BY_NAME


def is_paired(session: Session) -> bool:
    """Whether a session has pairs, and nothing that waits to become one.

    Examples
    --------
    >>> head = Landmark("head", (1, 2, 3), (4, 5, 6))
    >>> is_paired(Session(landmarks=(head,))), is_paired(Session())
    (True, False)
    """
    marks = [landmark for landmark in session.landmarks if landmark.role is Role.PAIR]
    return bool(marks) and all(landmark.is_complete for landmark in marks)


def _are_stations(session: Session, arriving: Arriving) -> bool:
    """Whether landmarks are likely not to be paired, but carried: muscle attachments, say."""
    known = {landmark.name for landmark in session.landmarks if landmark.role is Role.PAIR}
    names = {landmark.name for landmark in arriving.landmarks}
    return bool(names) and arriving.side is Side.SOURCE and is_paired(session) and not known & names


def can_pair(session: Session, arriving: Arriving, pairing: Pairing) -> bool:
    """Whether a way of pairing is possible.

    An order needs landmarks that wait for a position; passengers are on the source; of known names
    there must be one.
    """
    if pairing is Pairing.ONLY_KNOWN:
        return any(session.landmark(landmark.name) for landmark in arriving.landmarks)
    if pairing is Pairing.AS_PASSENGERS:
        return arriving.side is Side.SOURCE and bool(arriving.landmarks)
    if pairing is not Pairing.BY_ORDER:
        return True
    return arriving.side is not None and bool(awaiting(session, arriving.side))


def arrivals(session: Session, arriving: Arriving, choice: ImportChoice) -> tuple[Arrival, ...]:
    """Return what becomes of each landmark of a file.

    Parameters
    ----------
    session
        As it is before.
    arriving
        The file.
    choice
        How it would be brought in.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head", (1, 2, 3)),))
    >>> found = LandmarkReading((Landmark("head", None, (4, 5, 6)), Landmark("tip")), False, ())
    >>> file = Arriving(Path("a.csv"), found, Side.DESTINATION)
    >>> [x.words for x in arrivals(session, file, ImportChoice(Pairing.BY_NAME))]
    ['pairs with head', 'new, to be placed']
    """
    landmarks = _read(arriving, choice)
    names = [landmark.name for landmark in landmarks]
    targets = _targets(session, arriving.side, names, choice.pairing)
    known = {landmark.name: landmark for landmark in session.landmarks}
    looks = {visible(name): name for name in known}
    result = []
    for landmark, target in zip(landmarks, targets, strict=True):
        there, alike = known.get(target), looks.get(visible(target))
        if there is not None:
            fate, words = _change(landmark, there, arriving.sides)
        elif choice.pairing is Pairing.ONLY_KNOWN:
            fate, words = Fate.LEFT_OUT, _with_alike("left out: none here is called so", alike)
        else:
            fate, words = _newcomer(landmark, target, alike)
        result.append(Arrival(landmark, target, fate, words))
    return tuple(result)


def imported(session: Session, arriving: Arriving, choice: ImportChoice) -> Session:
    """Return the session with a file brought in.

    Raises
    ------
    LandmarkError
        When a coordinate becomes too large for a number.

    Examples
    --------
    >>> session = Session(landmarks=(Landmark("head", (1, 2, 3)),))
    >>> found = LandmarkReading((Landmark("S000", None, (4, 5, 6)),), False, ())
    >>> file = Arriving(Path("a.pts"), found, Side.DESTINATION)
    >>> imported(session, file, ImportChoice(Pairing.BY_ORDER)).landmark("head").destination
    (4.0, 5.0, 6.0)
    """
    renamed = _renamed(session, arriving, choice)
    if arriving.side is None:
        return edits.import_pairs(session, renamed)
    session = edits.import_side(session, arriving.side, renamed)
    fit = choice.fits.get(arriving.side, AS_STORED)
    return with_groups(session, arriving.reading, arriving.side, fit)[0]


def group_words(session: Session, arriving: Arriving, choice: ImportChoice) -> tuple[str, ...]:
    """Say what becomes of each curve and patch of a file, as sentences.

    Parameters
    ----------
    session, arriving, choice
        As in :func:`imported`.
    """
    if arriving.side is None or not arriving.reading.groups:
        return ()
    landmarks = edits.import_side(session, arriving.side, _renamed(session, arriving, choice))
    fit = choice.fits.get(arriving.side, AS_STORED)
    return with_groups(landmarks, arriving.reading, arriving.side, fit)[1]


def _renamed(session: Session, arriving: Arriving, choice: ImportChoice) -> list[Landmark]:
    """Return what arrives by the names that it gets."""
    landmarks = _read(arriving, choice)
    names = [landmark.name for landmark in landmarks]
    targets = _targets(session, arriving.side, names, choice.pairing)
    renamed = [replace(x, name=name) for x, name in zip(landmarks, targets, strict=True)]
    if choice.pairing is Pairing.ONLY_KNOWN:
        return [landmark for landmark in renamed if session.landmark(landmark.name)]
    return renamed


def _read(arriving: Arriving, choice: ImportChoice) -> tuple[Landmark, ...]:
    landmarks = arriving.landmarks
    for side, fit in choice.fits.items():
        landmarks = fit.applied(landmarks, side)
    if choice.pairing is Pairing.AS_PASSENGERS:
        return tuple(replace(landmark, role=Role.PASSENGER) for landmark in landmarks)
    return landmarks


def _targets(
    session: Session, side: Side | None, names: Sequence[str], pairing: Pairing
) -> list[str]:
    """Return the name in the session of each landmark that arrives."""
    if pairing in (Pairing.BY_NAME, Pairing.ONLY_KNOWN):
        return list(names)
    if pairing is Pairing.AS_PASSENGERS:
        # One that is a passenger already gets its place; a pair stays what it is.
        pairs = [landmark.name for landmark in session.landmarks if landmark.role is Role.PAIR]
        clashing = [name for name in names if name in pairs]
        taken = [*names, *(landmark.name for landmark in session.landmarks)]
        free = dict(zip(clashing, free_names(clashing, taken), strict=True))
        return [free.get(name, name) for name in names]
    waiting = () if side is None or pairing is Pairing.AS_NEW else awaiting(session, side)
    taken = [landmark.name for landmark in session.landmarks]
    targets = list(waiting[: len(names)])
    return targets + free_names(names[len(targets) :], taken)


def _newcomer(landmark: Landmark, target: str, alike: str | None) -> tuple[Fate, str]:
    what = "a new passenger" if landmark.role is Role.PASSENGER else "new"
    words = what if target == landmark.name else f"{what}, called {target}"
    if landmark.source is None and landmark.destination is None:
        words += ", to be placed"
    return Fate.NEW, _with_alike(words, alike)


def _with_alike(words: str, alike: str | None) -> str:
    return words if alike is None else f"{words}, though it looks like {alike}"


def _change(landmark: Landmark, there: Landmark, sides: Sequence[Side]) -> tuple[Fate, str]:
    """Say what an arriving landmark does to the one that it becomes."""
    name = there.name
    changed = [
        side
        for side in sides
        if (at := landmark.position(side)) is not None and at != there.position(side)
    ]
    if not changed:
        return Fate.SAME, f"changes nothing of {name}"
    replaced = [side for side in changed if there.position(side) is not None]
    locked = ", which is locked" if there.locked else ""
    if replaced:
        which = "both positions" if len(replaced) > 1 else f"the {replaced[0].value} position"
        which = "the position" if len(sides) == 1 else which
        return Fate.REPLACES, f"replaces {which} of {name}{locked}"
    both = all(there.position(side) is not None or side in changed for side in Side)
    if both and there.role is Role.PAIR:
        return Fate.PAIRS, f"pairs with {name}"
    return Fate.PLACES, f"places {name}"
