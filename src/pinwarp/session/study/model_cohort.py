"""One model made that of many subjects: what is to be done, and doing it for one."""

from __future__ import annotations

import functools
import hashlib
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Side
from pinwarp.core.model_rows import Outcome
from pinwarp.core.words import counted
from pinwarp.io.landmark_files import read_landmarks
from pinwarp.io.meshes import read_mesh
from pinwarp.io.model_manifest import BodyFiles, ModelManifest, ModelSubject
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.reading import read_model
from pinwarp.io.summary_file import SummaryRow
from pinwarp.session.model.study import ModelStudy, StudyBody
from pinwarp.session.model.warped import WarpedModel, warped_model
from pinwarp.session.model.writing import write_model
from pinwarp.session.outputs.replacing import refuse_to_replace
from pinwarp.session.session import Session, to_record
from pinwarp.session.study.running import (
    DONE,
    FAILED,
    SUMMARY,
    Kind,
    failed_row,
    why_it_failed,
)
from pinwarp.session.study.subject import content_hash, groups_told, places_of, with_destinations
from pinwarp.version import __version__


@dataclass(frozen=True)
class ModelTask:
    """All that is needed to make the model a subject's; small, to be sent to a worker.

    Parameters
    ----------
    subject
        The row of the manifest.
    manifest
        Where that row is, for messages.
    model, sha256
        The generic model's file and its hash.
    bodies
        Of the study, with their sessions: landmarks on the bones, and how they are warped.
    turn, keep, folders
        As of the study.
    out
        Where the new model goes.
    """

    subject: ModelSubject
    manifest: Path
    model: Path
    sha256: str
    bodies: tuple[StudyBody, ...]
    turn: frozenset[str]
    keep: frozenset[str]
    folders: tuple[Path, ...]
    out: Path

    @property
    def outputs(self) -> tuple[Path, ...]:
        """The model, and the report beside it."""
        return self.out, self.out.with_name(f"{self.out.stem}_report.csv")


@dataclass(frozen=True)
class ModelOutcome:
    """What came of a task.

    Attributes
    ----------
    made_from
        The hash of everything it was made from.
    seconds
        How long it took.
    pairs
        How many pairs all bodies have together.
    counts
        How many elements were warped, kept and flagged.
    notes
        What is to be known, as sentences.
    error
        Why it failed, as a sentence; empty where it did not.
    """

    made_from: str
    seconds: float
    pairs: int = 0
    counts: tuple[int, int, int] = (0, 0, 0)
    notes: tuple[str, ...] = ()
    error: str = ""


def plan_models(
    manifest: ModelManifest, study: ModelStudy, folder: Path, *, inputs: Iterable[Path] = ()
) -> tuple[ModelTask, ...]:
    """Return what is to be done for each subject; nothing is written yet.

    Parameters
    ----------
    manifest
        The subjects.
    study
        The model, and for each body a session with its landmarks on the bone; what they have on
        another subject does not matter.
    folder
        Where the models go.
    inputs
        Further files that must not be overwritten.

    Raises
    ------
    PinwarpError
        When an output would replace an input.
    """
    tasks = tuple(
        ModelTask(
            subject,
            manifest.path,
            study.model.path,
            study.model.sha256,
            tuple(replace(each, session=_on_source(each.session)) for each in study.bodies),
            study.turn,
            study.keep,
            study.folders,
            folder / f"{subject.name}.osim",
        )
        for subject in manifest.subjects
    )
    read = [manifest.path, study.model.path, *inputs]
    for subject in manifest.subjects:
        for files in subject.bodies:
            read += [path for path in files.paths if path is not None]
    refuse_to_replace(read, [folder / SUMMARY, *(path for task in tasks for path in task.outputs)])
    return tasks


def warp_model_of(task: ModelTask) -> ModelOutcome:
    """Make the model one subject's and write it with its meshes and its report.

    Returns
    -------
    ModelOutcome
        Whatever goes wrong is told in it, never raised: the other subjects go on.
    """
    start = time.perf_counter()
    try:
        hashed = made_from(task)
        warped, notes = _warped(task)
        task.out.parent.mkdir(parents=True, exist_ok=True)
        write_model(warped, task.out, force=True)
        found = warped.counts
        return ModelOutcome(
            hashed,
            time.perf_counter() - start,
            sum(warp.pairs for warp in warped.warps),
            (found[Outcome.WARPED], found[Outcome.KEPT], found[Outcome.FLAGGED]),
            (*notes, *warped.notes),
        )
    except Exception as error:  # a fault of ours in one subject must not end the night's batch
        return ModelOutcome("", time.perf_counter() - start, error=why_it_failed(error))


def _warped(task: ModelTask) -> tuple[WarpedModel, tuple[str, ...]]:
    """Return the model in the shape of a subject, and what was noticed about its files."""
    notes: list[str] = []
    bodies = []
    given = {files.body: files for files in task.subject.bodies}
    for each in task.bodies:
        name = each.body.rsplit("/", 1)[-1]
        files = given.get(name)
        if files is None:
            notes.append(f"{name} stays generic: there are no landmarks of it.")
            continue
        session, about = _of_subject(each.session, files)
        notes += [f"{name}: {note}" for note in about]
        bodies.append(replace(each, session=session))
    study = ModelStudy(
        _model(task.model, task.sha256), tuple(bodies), task.turn, task.keep, task.folders
    )
    return warped_model(study), tuple(notes)


def _of_subject(session: Session, files: BodyFiles) -> tuple[Session, tuple[str, ...]]:
    reading = read_landmarks(files.landmarks, Side.DESTINATION)
    session, notes = with_destinations(session, reading, files.landmarks)
    if files.mesh is not None and session.groups:
        session = session.with_mesh(Side.DESTINATION, read_mesh(files.mesh))
    return session, notes


# All subjects of a process have the same model: it is read once.
@functools.lru_cache(maxsize=1)
def _model(path: Path, sha256: str) -> OsimModel:
    model = read_model(path)
    if model.sha256 != sha256:
        raise FileFormatError(path, "The model changed meanwhile. Run the cohort again.")
    return model


def _on_source(session: Session) -> Session:
    """Return a session as a cohort begins with it: small, and on the bone only."""
    return replace(
        session,
        source=to_record(session).source_mesh,
        destination=None,
        landmarks=places_of(session.landmarks),
        refinement=None,
        slid=None,
    )


def made_from(task: ModelTask) -> str:
    """Return a hash of all that a subject's model depends on.

    Raises
    ------
    FileFormatError
        When a file is missing or the row cannot be used; the message names the line of the
        manifest.
    """
    subject = task.subject
    if subject.problem:
        raise FileFormatError(task.manifest, subject.problem, subject.line)
    parts = (
        __version__,
        task.sha256,
        sorted(task.turn),
        sorted(task.keep),
        task.out.name,
        [(each.body, each.turns, each.enabled, _told(each.session)) for each in task.bodies],
        [
            (files.body, *(content_hash(task.manifest, subject.line, x) for x in files.paths))
            for files in subject.bodies
        ],
    )
    return f"sha256:{hashlib.sha256(repr(parts).encode()).hexdigest()[:32]}"


def _told(session: Session) -> tuple[object, ...]:
    source = session.source
    return (
        None if source is None else (source.sha256, source.mirrored, source.scaled),
        tuple((x.name, x.source, x.role.value, x.enabled) for x in session.landmarks),
        session.settings,
        groups_told(session),
    )


def _row(task: ModelTask, result: ModelOutcome | Exception) -> SummaryRow:
    """Return a row of the table."""
    name = task.subject.name
    if isinstance(result, Exception):
        return failed_row(name, result)
    row = {"name": name, "seconds": f"{result.seconds:.3f}", "made_from": result.made_from}
    if result.error:
        return row | {"status": FAILED, "error": result.error}
    warped, kept, flagged = result.counts
    elements = counted(flagged, "element is flagged", "elements are flagged")
    return row | {
        "status": DONE,
        "pairs": str(result.pairs),
        "findings": f"{elements}: see {task.outputs[1].name}." if flagged else "",
        "notes": " ".join((f"{warped} warped, {kept} kept, {flagged} flagged.", *result.notes)),
    }


MODELS = Kind(warp_model_of, made_from, _row)
