"""One source warped to many subjects: what is to be done, and the rows of its table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pinwarp.core.errors import PinwarpError
from pinwarp.core.groups import on_source_only
from pinwarp.core.landmarks import Role
from pinwarp.core.pose import PoseSettings
from pinwarp.core.settings import WarpSettings
from pinwarp.io.landmark_files import located
from pinwarp.io.manifest import Manifest, Subject
from pinwarp.io.meshes import MESH_SUFFIXES
from pinwarp.io.osim.bone import mesh_suffix
from pinwarp.io.summary_file import SummaryRow
from pinwarp.session.outputs.replacing import refuse_to_replace
from pinwarp.session.session import Session, to_record
from pinwarp.session.study.first_pass import Suggestion
from pinwarp.session.study.running import (
    DONE,
    FAILED,
    SUMMARY,
    Kind,
    Tally,
    Told,
    failed_row,
    run_all,
)
from pinwarp.session.study.subject import Outcome, Task, made_from, places_of, warp_subject
from pinwarp.session.study.workers import Runner
from pinwarp.session.warp.refining import RefinementOptions


def plan(
    manifest: Manifest,
    source: Session,
    folder: Path,
    *,
    suffix: str | None = None,
    inputs: Iterable[Path] = (),
    refinement: RefinementOptions | None = None,
    suggestion: PoseSettings | None = None,
) -> tuple[Task, ...]:
    """Return what is to be done for each subject; nothing is written yet.

    Parameters
    ----------
    manifest
        The subjects; what a row leaves open is taken from the source.
    source
        With its mesh read, landmarks, curves, patches, penalty and so on. Where its landmarks
        lie on another destination does not matter, nor what was drawn there.
    folder
        Where the outputs go.
    suffix
        The format of the warped meshes; without it, the source's.
    inputs
        Further files that must not be overwritten.
    refinement
        How each warp is refined to its subject's surface; without it none is.
    suggestion
        What is known of the bones where landmarks that a subject lacks are to be suggested;
        without it none are.

    Raises
    ------
    PinwarpError
        When the source has no mesh or no landmark for pairs, the format is not known, an output
        would replace an input, or a subject has no mesh to be refined to, or for semilandmarks
        to slide on.

    Examples
    --------
    >>> from pinwarp.io.manifest import Subject
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> anna = Subject("anna", 2, Path("/study/anna.csv"), penalty=0.5)
    >>> (task,) = plan(
    ...     Manifest(Path("/study/manifest.csv"), (anna,)),
    ...     read_session(sample_session()),
    ...     Path("/study/warped"),
    ... )
    >>> task.mesh.name, task.session.settings.penalty
    ('anna_warped.ply', 0.5)
    """
    record = to_record(source)
    if source.source is None or record.source_mesh is None:
        raise PinwarpError("There is no source mesh to warp: name one.")
    landmarks = places_of(source.landmarks)
    if not any(x.role is Role.PAIR and x.enabled for x in landmarks):
        raise PinwarpError("The source has no landmark to be paired with the subjects'.")
    suffix = suffix or mesh_suffix(source.source.path)
    if suffix not in MESH_SUFFIXES:
        known = ", ".join(MESH_SUFFIXES)
        raise PinwarpError(f"Meshes of the type {suffix!r} are not supported: choose of {known}.")
    has_passengers = any(x.role is Role.PASSENGER for x in landmarks)
    # Small enough to be sent to a worker, which reads the mesh itself.
    # A refinement of the source belongs to the destination it has, not to the subjects.
    shared = replace(
        source,
        source=record.source_mesh,
        destination=None,
        landmarks=landmarks,
        refinement=None,
        groups=tuple(map(on_source_only, source.groups)),
        slid=None,
    )
    needed = "refine to" if refinement is not None else "slide on" if source.groups else ""
    without = next((x for x in manifest.subjects if x.destination_mesh is None), None)
    if needed and without is not None:
        raise PinwarpError(
            f"{without.name} has no destination_mesh in {manifest.path.name}: without one "
            f"there is no surface to {needed}."
        )
    tasks = tuple(
        Task(
            subject=subject,
            manifest=manifest.path,
            session=replace(
                shared,
                settings=_settings(shared.settings, subject),
            ),
            mesh=folder / f"{subject.name}_warped{suffix}",
            passengers=(
                folder / f"{subject.name}_passengers.landmarks.csv" if has_passengers else None
            ),
            refinement=refinement,
            suggestion=(
                None
                if suggestion is None
                else Suggestion(suggestion, folder / f"{subject.name}.pinwarp.csv")
            ),
        )
        for subject in manifest.subjects
    )
    read = [manifest.path, source.source.path, *inputs]
    for task in tasks:
        files = (task.subject.destination_landmarks, task.subject.destination_mesh)
        read += [located(path)[0] for path in files if path is not None]
    refuse_to_replace(read, [folder / SUMMARY, *(path for task in tasks for path in task.outputs)])
    return tasks


def _settings(shared: WarpSettings, subject: Subject) -> WarpSettings:
    """Return the settings for one subject: its row of the manifest goes before the source's."""
    return replace(
        shared,
        penalty=shared.penalty if subject.penalty is None else subject.penalty,
        components=subject.components or shared.components,
    )


def run(
    tasks: Sequence[Task],
    folder: Path,
    runner: Runner,
    *,
    force: bool = False,
    told: Told = lambda _task, _status, _words: None,
) -> Tally:
    """Warp the source to every subject; see :func:`run_all`.

    Parameters
    ----------
    tasks
        From :func:`plan`.
    folder, runner, force, told
        As there.

    Raises
    ------
    OSError
        When the table cannot be written.
    """
    kind = Kind(warp_subject, made_from, _row)
    return run_all(kind, tasks, folder, runner, force=force, told=told)


def _row(task: Task, result: Outcome | Exception) -> SummaryRow:
    """Return a row of the table."""
    name = task.subject.name
    if isinstance(result, Exception):
        return failed_row(name, result)
    row = {"name": name, "seconds": f"{result.seconds:.3f}", "made_from": result.made_from}
    if (guess := result.first_pass) is not None:
        told = {"misfit": guess.fit, "other_hand": guess.other_hand, "other_pose": guess.other_pose}
        row |= {"verdict": guess.verdict.value, **_digits(told)}
    checked = result.check
    if checked is None:
        return row | {"status": FAILED, "error": result.error}
    distance = checked.distance
    figures = {
        "pairs": len(checked.pairs),
        "penalty": task.session.settings.penalty,
        "rms_residual": checked.rms_residual,
        "rms_leave_one_out": checked.rms_leave_one_out,
        "suggested_penalty": checked.suggested_penalty,
        "flexibility": checked.flexibility,
        "folded_vertices": checked.folded_vertices,
        "distance_mean": None if distance is None else distance.mean,
        "distance_95": None if distance is None else distance.percentile_95,
        "distance_max": None if distance is None else distance.maximum,
        "fitted": checked.fitted,
        "freed": checked.freed,
        "suggested": checked.suggested or None,
    }
    return (
        row
        | {"status": DONE}
        | _digits(figures)
        | {
            "frame_or_unit": " ".join(
                f"{one.side.value}: {one.fit.action}?"
                for one in checked.elsewhere
                if one.fit is not None
            ),
            "findings": " ".join(named.sentence for named in checked.findings),
            "notes": " ".join((*result.notes, *checked.notes)),
        }
    )


def _digits(figures: Mapping[str, float | None]) -> dict[str, str]:
    """Return the figures that are known, as a table has them."""
    return {key: f"{value:.6g}" for key, value in figures.items() if value is not None}
