"""``pinwarp warp``: meshes and landmarks through a session's warp."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pinwarp.cli.bars import progress_bar
from pinwarp.cli.options import (
    Applied,
    BasisOption,
    Blend,
    Force,
    Penalty,
    SessionFile,
    with_options,
)
from pinwarp.cli.telling import BAD_USAGE, refuse_existing, tell, tell_error, tell_notes
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.session.keeping.files import read_session, with_meshes
from pinwarp.session.outputs.warp_files import FileWarper, outputs_of, warp_each
from pinwarp.session.warp.refined import OUT_OF_DATE, is_out_of_date, warp_in_words
from pinwarp.session.warp.rested import rest_in_use
from pinwarp.session.warp.slid_words import not_sliding_note, semilandmarks_in_words
from pinwarp.session.warp.solved import solved


def warp(
    session: SessionFile,
    out: Annotated[
        Path,
        typer.Option(
            "--out", "-o", metavar="OUT", help="A folder, or a file where there is one input."
        ),
    ],
    inputs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="INPUT",
            help="Meshes and landmark files in the frame of the source; without any, the "
            "session's source mesh.",
            show_default=False,
        ),
    ] = None,
    penalty: Penalty = None,
    components: Applied = None,
    blend: Blend = None,
    basis: BasisOption = None,
    force: Force = False,
) -> None:
    """Warp meshes and landmark files as a session warps its source.

    In a folder femur.ply becomes femur_warped.ply. Inputs are never replaced.
    """
    # Only what is to be warped is read, or looked for where it has moved.
    meshes = () if inputs else (Side.SOURCE,)
    read = read_session(session, meshes=meshes)
    opened = with_options(read, penalty, components, blend, basis)
    if not inputs and opened.source is None:
        raise PinwarpError(f"{session.name} has no source mesh: name the files to warp.")
    if opened.groups and rest_in_use(opened) is None:
        opened = with_meshes(opened, Side, session.absolute().parent)
    sources = inputs or ([] if opened.source is None else [opened.source.path])
    files = [file.path for file in (opened.source, opened.destination) if file is not None]
    outputs = outputs_of(sources, out, kept=[session, *files])
    refuse_existing(outputs, force)
    if opened.source is not None and (axes := opened.source.mirrored):
        opened = with_meshes(opened, [Side.SOURCE], session.absolute().parent)
        tell_notes([f"The session mirrors its source ({axes}): so are the inputs."])
    if opened.source is not None and (factor := opened.source.scaled) != 1:
        tell_notes([f"The session scales its source by {factor:g}: so are the inputs."])
    if is_out_of_date(opened):
        tell_notes([OUT_OF_DATE])
    warped = solved(opened)
    tell_notes(not_sliding_note(warped.result))
    warper = FileWarper(warped)
    failed = 0
    with progress_bar() as progress:
        for file in progress.track(
            warp_each(warper, sources, outputs), total=len(sources), description="Warping"
        ):
            if file.error:
                tell_error(file.error)
                failed += 1
                continue
            tell_notes(file.notes, file.source.name)
            applied = warp_in_words(opened)
            points = semilandmarks_in_words(warped.result)
            count = counted(len(opened.pairs), "pair") + (f", {points}" if points else "")
            tell(f"{file.output}: {applied}, {count}")
    if failed:
        raise typer.Exit(BAD_USAGE)
