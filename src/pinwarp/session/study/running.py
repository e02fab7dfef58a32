"""Doing the same for many subjects, and the table of results: what is done stays done."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

from pinwarp.core.errors import FileFormatError, PinwarpError, words_of
from pinwarp.core.first_guess import Verdict
from pinwarp.io.summary_file import SummaryRow, read_summary, write_summary
from pinwarp.session.study.workers import Runner, WorkEnded

SUMMARY = "summary.csv"
DONE, FAILED = "done", "failed"
# Verdicts of the first pass with which a subject is not warped.
DOUBTFUL = (Verdict.ASK.value, Verdict.NONE.value)
# The table is written again as often; what a power cut takes away is done again.
SECONDS_BETWEEN_SAVES = 1.0


class Job(Protocol):
    """Something to be done for a subject."""

    @property
    def subject(self) -> Named:
        """The subject."""

    @property
    def outputs(self) -> tuple[Path, ...]:
        """All files that are written."""


class Named(Protocol):
    """What has a name of its own in a table."""

    @property
    def name(self) -> str:
        """The name."""


J = TypeVar("J", bound=Job)
R = TypeVar("R")
Told = Callable[[Any, str, str], None]


@dataclass(frozen=True)
class Kind(Generic[J, R]):
    """A kind of work, to be done for every subject.

    Parameters
    ----------
    work
        Does it; importable by its name.
    made_from
        The hash of everything that a task depends on.
    row
        The row of the table for what came of a task.
    """

    work: Callable[[J], R]
    made_from: Callable[[J], str]
    row: Callable[[J, R | Exception], SummaryRow]


@dataclass(frozen=True)
class Tally:
    """How a batch ended.

    Attributes
    ----------
    done, unchanged, failed
        Numbers of subjects.
    total
        All of them; more than the sum of the others where something is left to do.
    summary
        The table of results.
    ended
        Why the work ended before all was done, as a sentence; empty where it did not, or was
        stopped.
    """

    done: int
    unchanged: int
    failed: int
    total: int
    summary: Path
    ended: str = ""

    @property
    def is_interrupted(self) -> bool:
        """Whether something is left to do."""
        return self.done + self.unchanged + self.failed < self.total


def why_it_failed(error: Exception) -> str:
    """Say why a subject failed, whatever it was: the others of the night go on.

    Examples
    --------
    >>> why_it_failed(PinwarpError("There is no pair.")), why_it_failed(KeyError("x"))
    ('There is no pair.', "Unexpectedly, KeyError: 'x'")
    """
    match error:
        case PinwarpError() | OSError():
            return words_of(error)
        case MemoryError():
            return "There is too little memory for it. Run fewer at once."
        case _:
            return f"Unexpectedly, {type(error).__name__}: {error}"


def failed_row(name: str, error: Exception) -> SummaryRow:
    """Return the row of a subject whose task never came back."""
    return {"name": name, "status": FAILED, "error": words_of(error) or repr(error)}


def run_all(
    kind: Kind[J, R],
    tasks: Sequence[J],
    folder: Path,
    runner: Runner,
    *,
    force: bool = False,
    told: Told = lambda _task, _status, _words: None,
) -> Tally:
    """Do what is to be done and keep the table of results up to date.

    A task is passed over where its row in the table says that it was made from the same inputs
    and options, and its outputs are there. Where the runner is stopped or its cluster is gone,
    what was done stays.

    Parameters
    ----------
    kind
        What is done.
    tasks
        For whom.
    folder
        Where the table goes; it is made where it is missing.
    runner
        Where the work is done; see :mod:`pinwarp.session.study.workers`.
    force
        Do everything again.
    told
        Called after each task with "done", "unchanged" or "failed", and the reason.

    Returns
    -------
    Tally

    Raises
    ------
    OSError
        When the table cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    summary = _Summary(folder / SUMMARY, tasks, kind.made_from)
    # Whether it can be written is better known before a night of work than after it.
    summary.save()
    waiting = [task for task in tasks if force or not summary.is_unchanged(task)]
    rest = {task.subject.name for task in waiting}
    for task in tasks:
        if task.subject.name not in rest:
            told(task, "unchanged", "")
    count = {DONE: 0, FAILED: 0}
    ended = ""
    try:
        with closing(runner(kind.work, waiting)) as results:
            for task, result in results:
                row = kind.row(task, result)
                summary.take(row)
                count[row["status"]] += 1
                told(task, row["status"], row.get("error", ""))
    except WorkEnded as error:
        ended = str(error)
    finally:
        summary.save()
    return Tally(
        done=count[DONE],
        unchanged=len(tasks) - len(waiting),
        failed=count[FAILED],
        total=len(tasks),
        summary=summary.path,
        ended=ended,
    )


class _Summary:
    """The table of results, with what an earlier run left in it."""

    def __init__(self, path: Path, tasks: Sequence[Job], made_from: Callable[[Any], str]) -> None:
        self.path = path
        self._made_from = made_from
        earlier = read_summary(path)
        self._order = [task.subject.name for task in tasks]
        # What was done for another manifest into this folder stays behind the subjects of this.
        self._order += [
            name
            for name, row in earlier.items()
            if name not in set(self._order) and row.get("status") == DONE
        ]
        self._rows = {name: earlier[name] for name in self._order if name in earlier}
        self._saved = time.monotonic()

    def is_unchanged(self, task: Job) -> bool:
        """Whether the task's outputs are there, made from what they would be made from now."""
        row = self._rows.get(task.subject.name, {})
        if row.get("status") != DONE or not all(path.is_file() for path in task.outputs):
            return False
        try:
            return row.get("made_from") == self._made_from(task)
        except (FileFormatError, OSError):
            return False

    def take(self, row: SummaryRow) -> None:
        self._rows[row["name"]] = row
        if time.monotonic() - self._saved > SECONDS_BETWEEN_SAVES:
            self.save()

    def save(self) -> None:
        rows = [self._rows[x] for x in self._order if x in self._rows]
        # What has to be looked into stands where it is seen.
        write_summary(self.path, sorted(rows, key=lambda row: row.get("verdict") not in DOUBTFUL))
        self._saved = time.monotonic()
