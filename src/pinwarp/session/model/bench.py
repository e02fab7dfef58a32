"""A model that is open: the work on each of its bodies, and the study that all of it makes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

import numpy as np

from pinwarp.core.errors import PinwarpError
from pinwarp.core.frame_warp import BodyRules
from pinwarp.core.landmarks import LandmarkState
from pinwarp.io.file_names import MODEL_SUFFIX, STUDY_SUFFIX
from pinwarp.io.osim.bone import split_bone_path
from pinwarp.io.osim.geometry import mesh_elements
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.reading import read_model
from pinwarp.session.editor import Work
from pinwarp.session.history import NO_RULES
from pinwarp.session.judging.quality import quality_of
from pinwarp.session.model.elements import MusclePaths
from pinwarp.session.model.overview import BodyOverview, overview
from pinwarp.session.model.study import ModelStudy, StudyBody, read_study, write_study
from pinwarp.session.session import Session
from pinwarp.session.warp.solved import solved

# With fewer pairs the size along every axis is a guess.
ENOUGH = 8


class Progress(StrEnum):
    """How far the work on a body is.

    Examples
    --------
    >>> Progress.DONE.value
    'done'
    """

    NONE = "none"
    STARTED = "started"
    DONE = "done"


def progress_of(session: Session | None) -> Progress:
    """Return how far a body is: done with eight pairs, when no landmark waits for its counterpart.

    Examples
    --------
    >>> progress_of(None).value, progress_of(Session()).value
    ('none', 'none')
    """
    if session is None or not session.landmarks:
        return Progress.NONE
    is_waiting = any(
        landmark.state in (LandmarkState.SOURCE_ONLY, LandmarkState.DESTINATION_ONLY)
        for landmark in session.landmarks
    )
    is_done = len(session.pairs) >= ENOUGH and not is_waiting
    return Progress.DONE if is_done else Progress.STARTED


def worst_left_out(session: Session) -> float:
    """Return the largest leave-one-out error of a session, in its unit; NaN where there is none."""
    try:
        quality = quality_of(solved(session).result)
    except PinwarpError:
        return math.nan
    if quality is None or quality.left_out is None:
        return math.nan
    known = quality.left_out.distances[np.isfinite(quality.left_out.distances)]
    return float(known.max()) if len(known) else math.nan


@dataclass(eq=False)
class BodyWork:
    """A body of the open model and the work on it.

    Attributes
    ----------
    overview
        What is on it.
    own
        The paths that only this body's rules can name.
    session, path, rules
        As the study has them; None and no rules where it says nothing of this body.
    enabled, note
        As in the study.
    work
        What was done on it here; None where it was not chosen yet.
    worst
        The largest leave-one-out error, in the session's unit; NaN where it is not known.
    """

    overview: BodyOverview
    own: frozenset[str]
    session: Session | None = None
    path: Path | None = None
    rules: BodyRules = NO_RULES
    enabled: bool = True
    note: str = ""
    work: Work | None = None
    worst: float = math.nan

    @property
    def name(self) -> str:
        """The body's name."""
        return self.overview.name

    @property
    def current(self) -> Session | None:
        """Its session as it is now."""
        return self.session if self.work is None else self.work.history.session

    @property
    def current_rules(self) -> BodyRules:
        """Its rules as they are now."""
        return self.rules if self.work is None else self.work.history.rules

    @property
    def current_path(self) -> Path | None:
        """The file of its session."""
        return self.path if self.work is None else self.work.path

    @property
    def is_unsaved(self) -> bool:
        """Whether no file holds its session as it is."""
        return self.work is not None and self.work.history.is_dirty

    @property
    def is_worth_saving(self) -> bool:
        """Whether there is anything to be saved of it."""
        session = self.current
        return session is not None and bool(session.landmarks or session.destination)

    def renounce(self) -> None:
        """Forget the work on it: what its file holds counts again, and the rules stay."""
        if self.work is not None:
            history = self.work.history
            self.path, self.rules = self.work.path, history.rules
            self.session = history.saved if self.path is not None else None
            self.work = None


class Bench:
    """A model with the work on each of its bodies.

    Parameters
    ----------
    study
        The model, and what is known of its bodies.
    bodies
        All of them.
    muscles
        The paths of its muscles.
    path
        The study's file; None where it has none yet.
    """

    def __init__(
        self,
        study: ModelStudy,
        bodies: Iterable[BodyWork],
        muscles: MusclePaths,
        path: Path | None = None,
    ) -> None:
        self.model: OsimModel = study.model
        self.folders, self.notes = study.folders, study.notes
        self.muscles, self.path = muscles, path
        self.bodies = {one.overview.path: one for one in bodies}
        own = frozenset[str]().union(*(one.own for one in self.bodies.values()))
        # What no body can use is kept as it is: the command line says what is wrong with it.
        self._others = (study.turn - own, study.keep - own)
        self._saved = self._marks()

    @property
    def name(self) -> str:
        """What it is called: by the study's file, or the model's."""
        if self.path is not None:
            return self.path.name.removesuffix(STUDY_SUFFIX)
        return self.model.path.stem

    def body_of(self, session: Session) -> str:
        """Return the body whose bone is the source of a session; empty where it is none of these.

        Parameters
        ----------
        session
            Any.
        """
        named = None if session.source is None else split_bone_path(session.source.path)
        if named is None or named[0] != self.model.path or named[1] not in self.bodies:
            return ""
        return named[1]

    def study(self, *, to_export: bool = False) -> ModelStudy:
        """Return the study as it is now.

        Parameters
        ----------
        to_export
            Leave out bodies without a pair.
        """
        found, turn, keep = [], set(self._others[0]), set(self._others[1])
        for path, one in self.bodies.items():
            session, rules = one.current, one.current_rules
            if to_export and (session is None or not session.pairs):
                continue
            turn |= rules.turn
            keep |= rules.keep
            if session is not None and (to_export or one.is_worth_saving or one.current_path):
                found.append(
                    StudyBody(path, session, rules.turns, one.enabled, one.note, one.current_path)
                )
        rules_of_all = (frozenset(turn), frozenset(keep))
        return ModelStudy(self.model, tuple(found), *rules_of_all, self.folders, self.notes)

    @property
    def unsaved(self) -> tuple[BodyWork, ...]:
        """The bodies whose session no file holds as it is."""
        return tuple(one for one in self.bodies.values() if one.is_unsaved)

    @property
    def is_dirty(self) -> bool:
        """Whether the study's file holds less than there is, sessions aside."""
        return self._marks() != self._saved

    def save(self, path: Path) -> None:
        """Write the study; every session has its file by now.

        Raises
        ------
        PinwarpError, OSError
            As :func:`~pinwarp.session.model.study.write_study`; nothing is lost then.
        """
        write_study(path, self.study())
        self.path = path
        self._saved = self._marks()

    def _marks(self) -> object:
        """Return what the study's file would say, to be compared."""
        study = self.study()
        rows = [(one.body, one.path, one.turns, one.enabled, one.note) for one in study.bodies]
        return (tuple(rows), study.turn, study.keep)


def open_bench(
    path: Path,
    folders: Iterable[Path] = (),
    told: Callable[[float, str], None] = lambda _share, _stage: None,
) -> Bench:
    """Read a model or a study of one, and look at what is on its bodies.

    Parameters
    ----------
    path
        ``.osim`` or ``.pinwarp-model.csv``.
    folders
        Where meshes are looked for, too.
    told
        Told how far it is; what it raises ends the reading.

    Raises
    ------
    FileFormatError
        When the study, the model or a session cannot be read; the message names file and line.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_model
    >>> bench = open_bench(sample_model())
    >>> [one.name for one in bench.bodies.values()], bench.is_dirty
    (['hip', 'thigh', 'shank'], False)
    """
    told(0.05, "reading the model")
    is_model = path.suffix.lower() == MODEL_SUFFIX
    study = (
        ModelStudy(read_model(path), folders=tuple(folders))
        if is_model
        else read_study(path, folders=folders)
    )
    told(0.3, "looking at its bodies")
    bodies = {one.path: _body(study, one) for one in overview(study.model, study.folders)}
    told(0.6, "following its muscles")
    muscles = MusclePaths.of(study.model)
    for number, each in enumerate(study.bodies):
        told(0.8 + 0.2 * number / len(study.bodies), "judging its sessions")
        one = bodies[each.body]
        rules = BodyRules(each.turns, study.turn & one.own, study.keep & one.own)
        bodies[each.body] = replace(
            one,
            session=each.session,
            path=each.path,
            rules=rules,
            enabled=each.enabled,
            note=each.note,
            worst=worst_left_out(each.session),
        )
    return Bench(study, bodies.values(), muscles, None if is_model else path)


def _body(study: ModelStudy, about: BodyOverview) -> BodyWork:
    meshes = (study.model.path_of(element) for element in mesh_elements(study.model, about.path))
    own = about.paths | frozenset(meshes)
    rules = BodyRules(False, study.turn & own, study.keep & own)
    return BodyWork(about, own, rules=rules)
