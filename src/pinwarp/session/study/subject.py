"""One subject of a batch, from its files to its files: a pure function of a task."""

from __future__ import annotations

import functools
import hashlib
import time
from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError, PinwarpError, RangeError
from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.core.names import look_alike_notes
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.core.words import counted, some_of
from pinwarp.io.group_record import METHOD as SLIDING_METHOD
from pinwarp.io.landmark_files import LandmarkReading, located, read_landmarks, write_landmarks
from pinwarp.io.manifest import Subject
from pinwarp.io.mesh_formats.vertex_data import VertexData
from pinwarp.io.meshes import MeshFile, read_mesh, write_mesh
from pinwarp.io.osim.bone import read_any_mesh
from pinwarp.io.reading import hash_of
from pinwarp.io.refinement_record import METHOD
from pinwarp.io.session_file import MeshReference
from pinwarp.session.importing.conversion import frame_notes
from pinwarp.session.judging.check import Check, check
from pinwarp.session.keeping.files import write_session
from pinwarp.session.outputs.exports import warped_mesh, warped_passengers
from pinwarp.session.session import Session, as_seen
from pinwarp.session.study.first_pass import (
    DoubtfulError,
    FirstPass,
    Suggestion,
    earlier_pass,
    first_passed,
)
from pinwarp.session.study.running import why_it_failed
from pinwarp.session.suggesting import METHOD as GUESS_METHOD
from pinwarp.session.suggesting import missing_of
from pinwarp.session.warp.provenance import provenance
from pinwarp.session.warp.refining import RefinementOptions, refined_session
from pinwarp.session.warp.solved import solved
from pinwarp.version import __version__


@dataclass(frozen=True)
class Task:
    """All that is needed to warp the source to one subject; small, to be sent to a worker.

    Parameters
    ----------
    subject
        The row of the manifest.
    manifest
        Where that row is, for messages.
    session
        The source as a reference, its landmarks without destinations, and how it is warped.
    mesh
        Where the warped mesh goes.
    passengers
        Where the warped passengers go; None where there are none.
    refinement
        How the warp is refined to the subject's surface; None where it is not.
    suggestion
        How landmarks that the subject lacks are suggested; None where they are not.
    """

    subject: Subject
    manifest: Path
    session: Session
    mesh: Path
    passengers: Path | None
    refinement: RefinementOptions | None = None
    suggestion: Suggestion | None = None

    @property
    def outputs(self) -> tuple[Path, ...]:
        """All files that are written."""
        suggested = None if self.suggestion is None else self.suggestion.session
        return tuple(x for x in (self.mesh, self.passengers, suggested) if x is not None)


@dataclass(frozen=True)
class Outcome:
    """What came of a task.

    Attributes
    ----------
    made_from
        The hash of everything it was made from; see :func:`made_from`.
    seconds
        How long it took.
    check
        The figures; None where it failed.
    notes
        What was left out, as sentences.
    error
        Why it failed, as a sentence; empty where it did not.
    first_pass
        What the shapes told where landmarks were suggested, or could not be.
    """

    made_from: str
    seconds: float
    check: Check | None = None
    notes: tuple[str, ...] = ()
    error: str = ""
    first_pass: FirstPass | None = None


def warp_subject(task: Task) -> Outcome:
    """Warp the source to one subject and write the mesh and the passengers.

    Parameters
    ----------
    task
        What to do. The files it names are read and written here.

    Returns
    -------
    Outcome
        Whatever goes wrong is told in it, never raised: the other subjects go on.
    """
    start = time.perf_counter()
    try:
        hashed = made_from(task)
        checked, notes, first_pass = _warp(task)
        if task.suggestion is not None:
            # From now on it is an input, too.
            hashed = made_from(task)
        return Outcome(hashed, time.perf_counter() - start, checked, notes, first_pass=first_pass)
    except DoubtfulError as error:
        seconds = time.perf_counter() - start
        return Outcome("", seconds, error=str(error), first_pass=error.first_pass)
    except Exception as error:  # a fault of ours in one subject must not end the night's batch
        return Outcome("", time.perf_counter() - start, error=why_it_failed(error))


def _warp(task: Task) -> tuple[Check, tuple[str, ...], FirstPass | None]:
    session, notes = _begun(task)
    first_pass = None
    if task.suggestion is not None:
        if missing_of(session):
            session, first_pass = first_passed(session, task.suggestion.settings)
        to_be_seen = session
    if task.refinement is not None:
        session, refined = refined_session(session, task.refinement)
        if refined.folding:
            folding = counted(refined.folding, "vertex", "vertices")
            notes = (*notes, f"{folding} would have folded: refined less.")
    warp = solved(session)
    if task.refinement is None and warp.result.not_sliding is not None:
        # Where the others are warped with semilandmarks, one without would not be comparable.
        raise PinwarpError(warp.result.not_sliding)
    reference = task.session.source
    known = _source_index(reference) if isinstance(reference, MeshReference) else None
    checked = check(warp, known)
    made = provenance(warp.session)
    write_mesh(task.mesh, warped_mesh(warp), VertexData(remarks=made))
    if task.passengers is not None:
        carried = warped_passengers(warp)
        write_landmarks(task.passengers, carried, Side.DESTINATION, remarks=made)
    # What somebody may have worked on since is never replaced.
    if task.suggestion is not None and not task.suggestion.session.exists():
        write_session(task.suggestion.session, to_be_seen)
    return checked, notes, first_pass


def _begun(task: Task) -> tuple[Session, tuple[str, ...]]:
    """Return the session of a subject with all that is known of it, and notes."""
    subject = task.subject
    if task.suggestion is not None and task.suggestion.session.exists():
        return earlier_pass(task.suggestion.session, task.session), ()
    session, notes = task.session, tuple[str, ...]()
    if subject.destination_landmarks is not None:
        reading = read_landmarks(subject.destination_landmarks, Side.DESTINATION)
        session, notes = with_destinations(session, reading, subject.destination_landmarks)
    if isinstance(session.source, MeshReference):
        session = session.with_mesh(Side.SOURCE, _source(session.source))
    if subject.destination_mesh is not None:
        session = session.with_mesh(Side.DESTINATION, read_mesh(subject.destination_mesh))
    return session, notes


# All subjects of a process have the same source: it is read once.
@functools.lru_cache(maxsize=1)
def _source(reference: MeshReference) -> MeshFile:
    file = read_any_mesh(reference.path)
    if file.sha256 != reference.sha256:
        raise FileFormatError(file.path, "The source mesh changed meanwhile. Run the batch again.")
    return as_seen(file, reference)


@functools.lru_cache(maxsize=1)
def _source_index(reference: MeshReference) -> SurfaceIndex | None:
    try:
        return SurfaceIndex(_source(reference).mesh)
    except RangeError:
        return None


def with_destinations(
    session: Session, reading: LandmarkReading, path: Path
) -> tuple[Session, tuple[str, ...]]:
    """Place the source's landmarks on a subject, by name.

    Parameters
    ----------
    session
        The source; what its landmarks have as destinations is forgotten.
    reading
        The subject's landmarks.
    path
        The file they are from, for messages.

    Returns
    -------
    session, notes
        What has no counterpart is told in the notes.

    Raises
    ------
    FileFormatError
        When not a single name is known.

    Examples
    --------
    >>> source = Session(landmarks=(Landmark("apex", (0, 0, 0)), Landmark("tip", (1, 0, 0))))
    >>> reading = LandmarkReading((Landmark("tip", destination=(2, 0, 0)),), False, ())
    >>> session, notes = with_destinations(source, reading, Path("anna.csv"))
    >>> [pair.name for pair in session.pairs], notes
    (['tip'], ('1 landmark is not in anna.csv: apex.',))
    """
    placed = {x.name: x for x in reading.landmarks if x.destination is not None}
    landmarks, missing = [], []
    for landmark in session.landmarks:
        is_passenger = landmark.role is Role.PASSENGER
        found = None if is_passenger else placed.pop(landmark.name, None)
        landmarks.append(_with_destination(landmark, found))
        if found is None and landmark.enabled and not is_passenger:
            missing.append(landmark.name)
        elif is_passenger:
            placed.pop(landmark.name, None)
    session = replace(session, landmarks=tuple(landmarks))
    if not session.pairs:
        raise FileFormatError(
            path,
            "None of its names is that of a landmark on the source. "
            f"It has {some_of(list(reading.names))}; the source has {some_of(missing)}.",
        )
    notes = [*reading.notes, *frame_notes(reading, session.unit)]
    if missing:
        notes.append(f"{_are(missing)} not in {path.name}: {some_of(missing)}.")
    if placed:
        unknown = list(placed)
        notes.append(f"{_are(unknown)} not on the source: {some_of(unknown)}.")
    notes += look_alike_notes((*missing, *placed))
    notes += [f"{path.name}, line {x.line} was skipped: {x.reason}." for x in reading.skipped]
    return session, tuple(notes)


def _with_destination(landmark: Landmark, found: Landmark | None) -> Landmark:
    if found is None or found.destination is None:
        return replace(landmark, destination=None)
    # Nobody has looked at it by reading it from a file.
    if found.is_suggested:
        return landmark.suggested(found.destination)
    return replace(landmark, destination=found.destination)


def _are(names: Sequence[str]) -> str:
    return f"{counted(len(names), 'landmark')} {'is' if len(names) == 1 else 'are'}"


def made_from(task: Task) -> str:
    """Return a hash of all that the outputs depend on: files by their content, and options.

    Parameters
    ----------
    task
        What is done.

    Returns
    -------
    str
        The same wherever the files are.

    Raises
    ------
    FileFormatError
        When a file is missing or the row cannot be used; the message names the line of the
        manifest.
    """
    subject, session = task.subject, task.session
    if subject.problem:
        raise FileFormatError(task.manifest, subject.problem, subject.line)
    source = session.source
    parts = (
        __version__,
        None if source is None else (source.sha256, source.mirrored, source.scaled),
        tuple((x.name, x.source, x.role.value, x.enabled) for x in session.landmarks),
        session.settings,
        session.unit,
        *groups_told(session),
        content_hash(task.manifest, subject.line, subject.destination_landmarks),
        content_hash(task.manifest, subject.line, subject.destination_mesh),
        task.mesh.suffix,
        *(() if task.refinement is None else (astuple(task.refinement), METHOD)),
        *_of_suggestion(task),
    )
    return f"sha256:{hashlib.sha256(repr(parts).encode()).hexdigest()[:32]}"


def groups_told(session: Session) -> tuple[object, ...]:
    """Return what of a session's curves and patches a warp depends on, for a hash."""
    # Sets have no order of their own; without groups the hash is what it always was.
    groups = [(replace(x, excluded=frozenset()), sorted(x.excluded)) for x in session.groups]
    return (groups, SLIDING_METHOD) if groups else ()


def _of_suggestion(task: Task) -> tuple[object, ...]:
    if (suggestion := task.suggestion) is None:
        return ()
    there = suggestion.session.exists()
    looked_at = content_hash(task.manifest, task.subject.line, suggestion.session) if there else ""
    return (astuple(suggestion.settings), GUESS_METHOD, looked_at)


def content_hash(manifest: Path, line: int, path: Path | None) -> str:
    """Return the hash of a file that a row of a manifest names; nothing where it names none.

    Raises
    ------
    FileFormatError
        When the file is missing or cannot be read; the message names the line of the manifest.
    """
    if path is None:
        return ""
    # Of a file of several specimens, each is another input.
    path, specimen = located(path)
    found = hash_of(path)
    if found is not None and specimen:
        return f"{found}#{specimen}"
    if found is None:
        words = "cannot be read." if path.exists() else "is not there. Was it moved or renamed?"
        raise FileFormatError(manifest, f"The file {path} {words}", line)
    return found


def places_of(landmarks: Sequence[Landmark]) -> tuple[Landmark, ...]:
    """Return landmarks as a batch begins with them: on the source only.

    Examples
    --------
    >>> places_of([Landmark("apex", (1, 2, 3), (4, 5, 6)), Landmark("tip")])[0].is_complete
    False
    """
    return tuple(replace(x, destination=None) for x in landmarks if x.source is not None)
