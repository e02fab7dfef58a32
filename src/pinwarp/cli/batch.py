"""``pinwarp batch``: one source warped to many subjects."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from pinwarp.cli.many import Again, Jobs, Scheduler, do_all
from pinwarp.cli.options import Applied, BasisOption, Blend, Penalty, with_options
from pinwarp.cli.refine import Feature, Tolerance, Turn
from pinwarp.cli.suggest import MirrorOption, Partial
from pinwarp.cli.telling import tell_notes
from pinwarp.core.errors import PinwarpError
from pinwarp.core.groups import Curve
from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.core.pose import Mirror, PoseSettings
from pinwarp.core.words import listed
from pinwarp.io.landmark_files import located, read_landmarks
from pinwarp.io.manifest import read_manifest
from pinwarp.io.meshes import read_mesh
from pinwarp.session import edits
from pinwarp.session.importing.conversion import frame_notes
from pinwarp.session.keeping.files import read_session
from pinwarp.session.session import Session
from pinwarp.session.study import batch as batches
from pinwarp.session.study.scheduler import address_of
from pinwarp.session.study.specimens import with_specimens
from pinwarp.session.warp.refining import RefinementOptions


def batch(
    manifest: Annotated[
        Path,
        typer.Argument(
            metavar="MANIFEST.csv",
            help="One row for each subject: name, destination_landmarks and, where wanted, "
            "destination_mesh, penalty, components. Paths are seen from its folder. Of landmarks "
            "of several specimens FILE#NAME takes one, FILE#all each. With --suggest "
            "destination_landmarks may be empty.",
        ),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            "-o",
            metavar="DIR",
            help="Where NAME_warped.ply, NAME_passengers.landmarks.csv and summary.csv go; with "
            "--suggest NAME.pinwarp.csv, too.",
        ),
    ],
    source: Annotated[
        Path | None, typer.Option(metavar="MESH", help="The mesh to warp.", show_default=False)
    ] = None,
    source_landmarks: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Its landmarks, to be paired by name."),
    ] = None,
    passengers: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Landmarks on it to be carried, not solved for."),
    ] = None,
    session: Annotated[
        Path | None,
        typer.Option(
            metavar="SESSION",
            help="A session instead: its source mesh, landmarks, passengers and settings.",
        ),
    ] = None,
    penalty: Penalty = None,
    components: Applied = None,
    blend: Blend = None,
    basis: BasisOption = None,
    suffix: Annotated[
        str | None,
        typer.Option(
            "--format",
            metavar="SUFFIX",
            help="Of the warped meshes, such as stl, ply, vtp or glb; without it the source's.",
            show_default=False,
        ),
    ] = None,
    suggest: Annotated[
        bool,
        typer.Option(
            "--suggest",
            help="Suggest the landmarks that a subject lacks, from the shapes of the bones. "
            "NAME.pinwarp.csv then is the session in which to look at them: the next run warps the "
            "subject by what you made of it, and never replaces it. Subjects that the shapes "
            "leave in doubt are not warped and come first in summary.csv.",
        ),
    ] = False,
    mirror: MirrorOption = Mirror.ASK,
    partial: Partial = False,
    refine: Annotated[
        bool,
        typer.Option("--refine", help="Refine each warp to the surface of the subject's mesh."),
    ] = False,
    feature: Feature = None,
    tolerance: Tolerance = None,
    turn: Turn = False,
    jobs: Jobs = None,
    scheduler: Scheduler = None,
    force: Again = False,
) -> None:
    """Warp one source to many subjects and gather the figures in one table.

    A second run does only what failed, is missing or has changed.

    Where a subject fails the others are done all the same. The exit code is 0 when all are done, 1
    when one failed, 2 when nothing could begin, 3 when the cluster's scheduler was lost, and 130
    after Ctrl+C; after the last two the same command goes on from there.
    """
    scheduler = None if scheduler is None else address_of(scheduler)
    known = PoseSettings(mirror, partial)
    if known != PoseSettings() and not suggest:
        raise PinwarpError("--mirror and --partial are about suggesting: add --suggest.")
    subjects = with_specimens(read_manifest(manifest, suggested=suggest))
    shared = _source(source, source_landmarks, passengers, session)
    shared = with_options(shared, penalty, components, blend, basis)
    files = (source_landmarks, passengers, session)
    given = [located(path)[0] for path in files if path is not None]
    tasks = batches.plan(
        subjects,
        shared,
        out.absolute(),
        suffix=None if suffix is None else f".{suffix.lower().removeprefix('.')}",
        inputs=given,
        refinement=_refinement(refine, feature, tolerance, turn),
        suggestion=known if suggest else None,
    )
    tell_notes(_about_groups(shared, refine))
    if subjects.unused:
        tell_notes([f"{manifest.name}: not used: {', '.join(subjects.unused)}."])
    folder = out.absolute()
    do_all(
        lambda runner, told: batches.run(tasks, folder, runner, force=force, told=told),
        len(tasks),
        out,
        jobs,
        scheduler,
    )


def _about_groups(session: Session, refine: bool) -> list[str]:
    """Say what of curves and patches does not hold on subjects."""
    if refine and session.groups:
        return [
            "Curves and patches have no part: each warp is fitted to the surface by places all "
            "over it instead."
        ]
    drawn = [x.name for x in session.groups if isinstance(x, Curve) and x.drawn]
    if not drawn:
        return []
    return [
        f"{listed(drawn)}: drawn on the session's own destination, which no subject is. On each "
        "subject the points slide along their tangents."
    ]


def _refinement(
    wanted: bool, feature: float | None, tolerance: float | None, turn: bool
) -> RefinementOptions | None:
    options = RefinementOptions(feature, tolerance, turn)
    if not wanted and options != RefinementOptions():
        raise PinwarpError("--feature, --tolerance and --turn are about refining: add --refine.")
    return options if wanted else None


def _source(
    mesh: Path | None, landmarks: Path | None, passengers: Path | None, session: Path | None
) -> Session:
    """Return the source with its mesh and landmarks, however it was given."""
    if session is not None:
        if mesh is not None or landmarks is not None:
            raise PinwarpError("Give either --session, or --source and --source-landmarks.")
        found = read_session(session, meshes=[Side.SOURCE])
        if found.source is not None and found.mesh(Side.SOURCE) is None:
            raise PinwarpError(
                f"The source mesh {found.source.path} is not there. Was it moved or renamed?"
            )
    elif mesh is None or landmarks is None:
        raise PinwarpError("Name the source: --source with --source-landmarks, or --session.")
    else:
        found = edits.set_mesh(Session(), Side.SOURCE, read_mesh(mesh))
        found = replace(found, landmarks=_read(landmarks, Role.PAIR, found.unit))
    if passengers is not None:
        arriving = _read(passengers, Role.PASSENGER, found.unit)
        if taken := {x.name for x in found.landmarks} & {x.name for x in arriving}:
            raise PinwarpError(
                f"{passengers.name}: {min(taken)} is a landmark of the source already. "
                "Rename or remove one."
            )
        found = replace(found, landmarks=(*found.landmarks, *arriving))
    return found


def _read(path: Path, role: Role, unit: str) -> tuple[Landmark, ...]:
    reading = read_landmarks(path, Side.SOURCE)
    skipped = (f"line {x.line} was skipped: {x.reason}." for x in reading.skipped)
    tell_notes((*reading.notes, *frame_notes(reading, unit), *skipped), path.name)
    return tuple(replace(x, role=role) for x in reading.landmarks)
