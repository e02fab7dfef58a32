"""Curves and patches of landmark files: new ones on the source, drawn ones on the destination."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.errors import LandmarkError
from pinwarp.core.groups import MOST_POINTS, USUAL_COUNT, Curve, Group, Handle, Patch
from pinwarp.core.landmarks import Position, Side, as_position
from pinwarp.core.words import counted
from pinwarp.io.landmark_files import LandmarkReading
from pinwarp.io.landmark_formats.reading import ReadGroup
from pinwarp.session.importing.fit import Fit
from pinwarp.session.session import Session

# A place lies at a landmark where it is off by no more than this share of the landmarks' reach.
AT_LANDMARK = 1e-6


def with_groups(
    session: Session, reading: LandmarkReading, side: Side, fit: Fit
) -> tuple[Session, tuple[str, ...]]:
    """Return a session with the curves and patches of a file, and what became of each.

    Parameters
    ----------
    session
        With the file's landmarks already in.
    reading
        The file.
    side
        On the source they are new, or take the place of ones of the same name. On the
        destination a curve is drawn for the one of the same name, or else the one at the same
        place in the list; a patch needs nothing there.
    fit
        How positions are read.

    Returns
    -------
    session, words
    """
    words = []
    curves = [group.name for group in session.groups if isinstance(group, Curve)]
    arriving = [read.name for read in reading.groups if read.is_curve]
    # Formats that only number their curves mean them in order.
    in_order = len(arriving) == len(curves) and not set(arriving) & set(curves)
    targets = dict(zip(arriving, curves, strict=True)) if in_order else {}
    for read in reading.groups:
        places = _places(reading, read, side, fit)
        try:
            if side is Side.SOURCE:
                session, told = _on_source(session, read, places)
            else:
                session, told = _on_destination(session, read, targets, places)
        except LandmarkError as error:
            told = f"Left out: {error}"
        words.append(told)
    return session, tuple(words)


def _places(reading: LandmarkReading, read: ReadGroup, side: Side, fit: Fit) -> list[Position]:
    """Return where the points of a group are, in order; those that are nowhere are left out."""
    of_name = {landmark.name: landmark.position(side) for landmark in reading.landmarks}
    placed = [place for name in read.points if (place := of_name[name]) is not None]
    moved = [as_position(place) for place in fit.moved(placed)] if placed else []
    # A curve that dwells on a place goes on from there.
    return [x for n, x in enumerate(moved) if not read.is_curve or n == 0 or x != moved[n - 1]]


def _on_source(
    session: Session, read: ReadGroup, places: Sequence[Position]
) -> tuple[Session, str]:
    known = session.group(read.name)
    if not read.is_curve:
        name = read.name if isinstance(known, Patch) else _free(session, read.name)
        patch = Patch(name, tuple(places[:MOST_POINTS]))
        return _put(session, patch), f"{name}: a patch of {counted(patch.count, 'point')}."
    handles = tuple(Handle(x, None, name) for x, name in _anchored(session, places))
    free = sum(not handle.landmark for handle in handles)
    count = max(USUAL_COUNT, free) if read.are_handles else free
    if isinstance(known, Curve):
        if len(known.handles) == len(handles):
            handles = tuple(
                replace(new, destination=old.destination)
                for new, old in zip(handles, known.handles, strict=True)
            )
        drawn = known.drawn and len(known.handles) == len(handles)
        curve = replace(known, handles=handles, is_closed=read.is_closed, drawn=drawn)
        return _put(session, curve), f"{read.name}: its curve on the source is replaced."
    name = _free(session, read.name)
    curve = Curve(name, handles, read.is_closed, min(count, MOST_POINTS))
    kind = "closed curve" if read.is_closed else "curve"
    ends = len(handles) - free
    anchors = f", anchored at {counted(ends, 'landmark')}" if ends else ""
    return (
        _put(session, curve),
        f"{name}: a {kind} through {counted(len(handles), 'place')}{anchors}, "
        f"{counted(curve.count, 'point')}.",
    )


def _on_destination(
    session: Session, read: ReadGroup, targets: Mapping[str, str], places: Sequence[Position]
) -> tuple[Session, str]:
    name = targets.get(read.name, read.name)
    curve = session.group(name)
    if not read.is_curve:
        return session, (
            f"{read.name}: left out, since points of a patch find their places on the destination "
            "by sliding."
        )
    if not isinstance(curve, Curve):
        return session, (
            f"{read.name}: left out, since there is no curve of that name on the source. Import "
            "the source's curves first."
        )
    # Told by the same rule as a new curve.
    Curve(name, tuple(map(Handle, places)), read.is_closed)
    if read.is_closed != curve.is_closed:
        raise LandmarkError(f"{read.name} is closed on one bone and open on the other.")
    how = ""
    if len(places) == len(curve.handles):
        there = list(places)
    else:
        there = _at_shares(places, _shares(curve.places(Side.SOURCE), curve.is_closed), curve)
        how = f", its {len(curve.handles)} handles spread over {len(places)} places"
    handles = tuple(
        handle
        # What is a landmark there stays where that is.
        if handle.landmark and handle.destination is not None
        else replace(handle, destination=place)
        for handle, place in zip(curve.handles, there, strict=True)
    )
    waiting = {
        handle.landmark: handle.destination
        for handle in handles
        if handle.landmark and handle.destination is not None
    }
    landmarks = tuple(
        mark.placed(Side.DESTINATION, waiting[mark.name])
        if mark.name in waiting and mark.destination is None
        else mark
        for mark in session.landmarks
    )
    drawn = replace(curve, handles=handles, drawn=True)
    by = "" if name == read.name else f" ({read.name} in the file)"
    return (
        _put(replace(session, landmarks=landmarks), drawn),
        f"{name}{by}: drawn on the destination{how}.",
    )


def _anchored(session: Session, places: Sequence[Position]) -> list[tuple[Position, str]]:
    """Return each place with the landmark that lies there, or none."""
    marks = [x for x in session.landmarks if x.source is not None]
    if not marks:
        return [(place, "") for place in places]
    at = np.array([mark.source for mark in marks])
    near = AT_LANDMARK * max(float(np.ptp(np.vstack([at, places]), axis=0).max()), 1e-300)
    found = []
    for place in places:
        distances = np.linalg.norm(at - place, axis=1)
        closest = marks[int(distances.argmin())]
        is_there = distances.min() <= near and closest.source is not None
        found.append((closest.source or place, closest.name) if is_there else (place, ""))
    return found


def _shares(places: Sequence[Position], is_closed: bool) -> NDArray[np.float64]:
    """Return how far along a line through places each of them is, from 0 to 1."""
    corners = np.array([*places, *places[: int(is_closed)]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    return np.asarray(along[: len(places)] / max(along[-1], 1e-300))


def _at_shares(
    places: Sequence[Position], shares: NDArray[np.float64], curve: Curve
) -> list[Position]:
    """Return the places so far along a line through others."""
    corners = np.array([*places, *places[: int(curve.is_closed)]])
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    columns = [np.interp(shares * along[-1], along, corners[:, axis]) for axis in range(3)]
    return [as_position(place) for place in np.column_stack(columns)]


def _free(session: Session, name: str) -> str:
    name = " ".join(name.split()) or "curve"
    number, free = 2, name
    while session.group(free) is not None:
        free, number = f"{name}_{number}", number + 1
    return free


def _put(session: Session, group: Group) -> Session:
    if session.group(group.name) is None:
        return replace(session, groups=(*session.groups, group))
    groups = (group if x.name == group.name else x for x in session.groups)
    return replace(session, groups=tuple(groups))
