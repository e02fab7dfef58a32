"""``pinwarp model``: a generic model of OpenSim made a subject's."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from pinwarp.cli.many import Jobs, Scheduler, do_all
from pinwarp.cli.options import Force
from pinwarp.cli.telling import refuse_existing, tell, tell_json, tell_notes
from pinwarp.core.errors import PinwarpError
from pinwarp.core.model_rows import Outcome
from pinwarp.core.words import counted, some_of
from pinwarp.io.file_names import MODEL_SUFFIX
from pinwarp.io.model_manifest import read_model_manifest
from pinwarp.io.model_report import report_json, report_text
from pinwarp.io.osim.reading import read_model
from pinwarp.session.model.muscle_lengths import with_lengths
from pinwarp.session.model.opensim_check import check_in_opensim
from pinwarp.session.model.overview import overview
from pinwarp.session.model.study import ModelStudy, read_study, study_of
from pinwarp.session.model.warped import WarpedModel, warped_model
from pinwarp.session.model.writing import outputs_of, write_model
from pinwarp.session.study.model_cohort import MODELS, plan_models
from pinwarp.session.study.running import run_all
from pinwarp.session.study.scheduler import address_of
from pinwarp.version import __version__

FLAGGED = 1


def model(
    model: Annotated[
        Path,
        typer.Argument(
            metavar="MODEL",
            help="A model (.osim), or a study of one (.pinwarp-model.csv) that names it, the "
            "sessions of its bodies, and what is kept or turned.",
        ),
    ],
    body: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME=SESSION",
            help="A body and the session that warps it; as often as there are bodies.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="OUT", help="The new model, NEW.osim; with --subjects a folder."
        ),
    ] = None,
    turn: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FRAME",
            help="The path of a frame that turns with the bone; as often as wanted. Others keep "
            "their orientation.",
        ),
    ] = None,
    turn_all: Annotated[
        bool, typer.Option("--turn-all", help="All frames of the given bodies turn.")
    ] = False,
    keep: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PATH", help="The path of an element that is left as it is; as often as wanted."
        ),
    ] = None,
    geometry: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="DIR", help="A folder with meshes, beside the model's own Geometry folder."
        ),
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what would become of everything; write nothing.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print every element for a program.")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with 1 where an element is flagged.")
    ] = False,
    check: Annotated[
        bool,
        typer.Option(
            "--check",
            help="Load the result in OpenSim and compare muscle lengths and moment arms before "
            "and after. Needs pinwarp\\[opensim].",
        ),
    ] = False,
    scale_lengths: Annotated[
        bool,
        typer.Option(
            "--scale-lengths",
            help="Multiply fibre and tendon lengths by how much longer OpenSim finds the path, as "
            "its ScaleTool does; they are kept otherwise. Needs pinwarp\\[opensim].",
        ),
    ] = False,
    subjects: Annotated[
        Path | None,
        typer.Option(
            metavar="MANIFEST.csv",
            help="Make the model that of many subjects: one row for each, with name and, in a "
            "column called as the body, the file of its landmarks on the subject (and BODY_mesh "
            "where semilandmarks slide). OUT is then a folder for NAME.osim and summary.csv.",
        ),
    ] = None,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    force: Force = False,
) -> None:
    """Warp the bones of a model to a subject's, with all that stands on them.

    Without a body it lists what is on each. The new model's meshes go into NEW_Geometry beside
    it, and NEW_report.csv says of every element whether it was warped, kept or flagged.
    """
    scheduler = None if scheduler is None else address_of(scheduler)
    is_model = model.suffix.lower() == MODEL_SUFFIX
    if is_model and not body:
        _list(model, geometry or [], as_json)
        return
    if out is None and not dry_run and subjects is None:
        raise PinwarpError("Name the new model: -o NEW.osim, or look first with --dry-run.")
    if is_model:
        sessions = [_split(each) for each in body or []]
        study = study_of(
            read_model(model),
            sessions,
            turn=turn or (),
            keep=keep or (),
            turns=turn_all,
            folders=geometry or (),
        )
    else:
        if body or turn or keep or turn_all:
            raise PinwarpError(
                "A study says itself which bodies are warped and what is kept or turned: change "
                "it there."
            )
        study = read_study(model, folders=geometry or ())
    if subjects is not None:
        if out is None or dry_run or as_json or strict or check or scale_lengths:
            raise PinwarpError(
                "With --subjects name a folder with -o; a dry run, --json, --strict, --check and "
                "--scale-lengths are of one model."
            )
        _cohort(study, subjects, out, [model], jobs, scheduler, force)
        return
    warped = warped_model(study)
    found = None
    if check or scale_lengths:
        found = check_in_opensim(warped)
        warped = with_lengths(warped, found, scale=scale_lengths)
    if out is not None and not dry_run:
        outputs = outputs_of(warped, out)
        refuse_existing(outputs, force)
        write_model(warped, out, force=True)
    if as_json:
        about = _about(warped, None if dry_run else out)
        if found is not None:
            about["opensim"] = found.as_json()
        told = report_json(warped.rows, about)
        tell_json(told)
    else:
        notes = (*warped.notes, *(found.in_words() if found is not None else ()))
        tell(report_text(warped.rows, notes))
        if out is not None and not dry_run:
            meshes = counted(len(warped.meshes), "mesh", "meshes")
            tell(f"{out}: {meshes} beside it, {outputs[1].name} says all of it")
    if strict and warped.counts[Outcome.FLAGGED]:
        raise typer.Exit(FLAGGED)


def _split(words: str) -> tuple[str, Path]:
    name, separator, session = words.partition("=")
    if not (name and separator and session):
        raise PinwarpError(f"--body {words}: name a body and its session, as in thigh=thigh.csv.")
    return name, Path(session)


def _cohort(
    study: ModelStudy,
    path: Path,
    out: Path,
    inputs: list[Path],
    jobs: int | None,
    scheduler: str | None,
    force: bool,
) -> None:
    enabled = [each.body.rsplit("/", 1)[-1] for each in study.bodies if each.enabled]
    manifest = read_model_manifest(path, enabled)
    folder = out.absolute()
    sessions = [each.path for each in study.bodies if each.path is not None]
    tasks = plan_models(manifest, study, folder, inputs=[*inputs, *sessions])
    do_all(
        lambda runner, told: run_all(MODELS, tasks, folder, runner, force=force, told=told),
        len(tasks),
        out,
        jobs,
        scheduler,
    )


def _list(path: Path, folders: list[Path], as_json: bool) -> None:
    opened = read_model(path)
    bodies = overview(opened, folders)
    if as_json:
        about = {"pinwarp": __version__, "model": str(opened.path), "version": opened.version}
        told = {**about, "bodies": [each.as_json() for each in bodies]}
        tell_json(told)
        return
    tell(f"{opened.name}: {counted(len(bodies), 'body', 'bodies')}, version {opened.version}")
    for each in bodies:
        missing = f" ({len(each.missing)} not found)" if each.missing else ""
        tell(f"{each.name}: {some_of(each.meshes) or 'no mesh'}{missing}")
        if each.counts:
            tell(f"  is warped: {each.in_words}")
        if each.kept:
            kept = [f"{name} ({kind}: {words})" for kind, name, words in each.kept]
            tell(f"  cannot be: {some_of(kept)}")
    if any(each.missing for each in bodies):
        tell_notes(["Meshes that are missing are needed only of bodies that are warped."])


def _about(warped: WarpedModel, out: Path | None) -> dict[str, Any]:
    study: ModelStudy = warped.study
    return {
        "pinwarp": __version__,
        "model": str(study.model.path),
        "sha256": study.model.sha256,
        "written": None if out is None else str(out),
        "bodies": [
            {"body": body.parts.name, "pairs": warp.pairs, "size_ratio": warp.ratio}
            for body, warp in zip(warped.bodies, warped.warps, strict=True)
        ],
        "notes": list(warped.notes),
    }
