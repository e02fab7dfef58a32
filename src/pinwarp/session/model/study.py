"""The study of a model: which body is warped by which session, and what is kept or turned."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pinwarp.core.errors import PinwarpError
from pinwarp.core.frame_warp import BodyRules
from pinwarp.io.model_study import BodyRow, StudyRecord, read_model_study, write_model_study
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.reading import read_model
from pinwarp.session.keeping.files import read_session
from pinwarp.session.session import Session


@dataclass(frozen=True)
class StudyBody:
    """A body and the session that warps it.

    Parameters
    ----------
    body
        Path of the body.
    session
        Its landmarks, on the bone and on the subject; meshes need not have been read.
    turns
        Whether its frames turn with the bone; otherwise they keep their orientation.
    enabled
        Whether it is warped.
    note
        Free text.
    path
        The session's file; None where it has none yet.
    """

    body: str
    session: Session
    turns: bool = False
    enabled: bool = True
    note: str = ""
    path: Path | None = None


@dataclass(frozen=True)
class ModelStudy:
    """A model and what is to become of it; frozen, changed by ``dataclasses.replace``.

    Parameters
    ----------
    model
        The generic model.
    bodies
        Those that have a session, each once.
    turn, keep
        Paths of frames that turn with their bone whatever the body says, and of elements that
        are left as they are.
    folders
        Where meshes are looked for, beside the model's own places.
    notes
        What was noticed when it was read, as sentences.

    Raises
    ------
    PinwarpError
        When a body has two sessions.
    """

    model: OsimModel
    bodies: tuple[StudyBody, ...] = ()
    turn: frozenset[str] = frozenset()
    keep: frozenset[str] = frozenset()
    folders: tuple[Path, ...] = ()
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        seen: set[str] = set()
        for each in self.bodies:
            if each.body in seen:
                name = each.body.rsplit("/", 1)[-1]
                raise PinwarpError(f"{name} has two sessions: leave one of them out.")
            seen.add(each.body)

    def rules_of(self, body: StudyBody) -> BodyRules:
        """Return what is chosen for one of its bodies."""
        return BodyRules(body.turns, self.turn, self.keep)


def study_of(
    model: OsimModel,
    sessions: Mapping[str, Session | str | Path] | Sequence[tuple[str, Session | str | Path]],
    *,
    turn: Iterable[str] = (),
    keep: Iterable[str] = (),
    turns: bool = False,
    folders: Iterable[str | Path] = (),
) -> ModelStudy:
    """Put a study together.

    Parameters
    ----------
    model
        The generic model.
    sessions
        For bodies, by name or path: the session, or its file.
    turn, keep
        Paths of frames that turn with their bone, and of elements that are left as they are.
    turns
        Whether all frames of these bodies turn.
    folders
        Where meshes are looked for, too.

    Raises
    ------
    PinwarpError
        When there is no such body, a body comes twice, or a session cannot be read.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_model
    >>> study_of(read_model(sample_model()), {"thigh": Session()}).bodies[0].body
    '/bodyset/thigh'
    """
    pairs = sessions.items() if isinstance(sessions, Mapping) else sessions
    bodies = []
    for name, given in pairs:
        body = model.body(name)
        if isinstance(given, Session):
            bodies.append(StudyBody(body, given, turns))
        else:
            path = Path(os.path.abspath(given))
            bodies.append(StudyBody(body, read_session(path, meshes=()), turns, path=path))
    return ModelStudy(model, tuple(bodies), frozenset(turn), frozenset(keep), _absolute(folders))


def read_study(path: str | Path, *, folders: Iterable[str | Path] = ()) -> ModelStudy:
    """Read a study with its model and the sessions that are enabled.

    Parameters
    ----------
    path
        The file, named ``NAME.pinwarp-model.csv`` by custom.
    folders
        Where meshes are looked for, too.

    Raises
    ------
    FileFormatError
        When the study, its model or a session cannot be read.

    Returns
    -------
    ModelStudy
        Says in a note where the model has changed since the study was written.
    """
    record = read_model_study(path)
    model = read_model(record.model)
    changed = record.sha256 and record.sha256.lower() != model.sha256
    note = f"{model.path.name} has changed since the study was written."
    return ModelStudy(
        model,
        tuple(
            StudyBody(
                model.body(row.body),
                read_session(row.session, meshes=()),
                row.turns,
                row.enabled,
                row.note,
                row.session,
            )
            for row in record.bodies
        ),
        frozenset(record.turn),
        frozenset(record.keep),
        _absolute(folders),
        (note,) if changed else (),
    )


def _absolute(folders: Iterable[str | Path]) -> tuple[Path, ...]:
    # Workers of a cohort look from another folder.
    return tuple(Path(os.path.abspath(folder)) for folder in folders)


def write_study(path: str | Path, study: ModelStudy) -> None:
    """Write a study; its sessions are named in it, not written.

    Parameters
    ----------
    path
        The file.
    study
        What to write.

    Raises
    ------
    PinwarpError
        When a session has no file yet.
    OSError
        When the file cannot be written; an older one is untouched.
    """
    rows = []
    for each in study.bodies:
        name = each.body.rsplit("/", 1)[-1]
        if each.path is None:
            raise PinwarpError(f"The session of {name} has no file yet: save it first.")
        rows.append(BodyRow(name, each.path, each.turns, each.enabled, each.note))
    model = study.model
    rules = (tuple(sorted(study.turn)), tuple(sorted(study.keep)))
    write_model_study(path, StudyRecord(model.path, model.sha256, tuple(rows), *rules))
