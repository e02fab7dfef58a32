"""``pinwarp convert``: landmarks from one program's format into another's."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pinwarp.cli.options import Force
from pinwarp.cli.telling import refuse_existing, tell_notes
from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES, format_of
from pinwarp.session.importing.conversion import convert_landmarks
from pinwarp.session.outputs.replacing import refuse_to_replace


def convert(
    source: Annotated[
        Path, typer.Argument(metavar="IN", help="A landmark file of any format, or a session.")
    ],
    output: Annotated[Path, typer.Argument(metavar="OUT", help="The file to write.")],
    to: Annotated[
        str | None,
        typer.Option(
            metavar="SUFFIX",
            help=f"The format, where the suffix of OUT does not tell it: one of "
            f"{', '.join(LANDMARK_SUFFIXES)}.",
            show_default=False,
        ),
    ] = None,
    side: Annotated[
        Side | None,
        typer.Option(
            help="The side to write, where IN holds pairs and OUT one side.", show_default=False
        ),
    ] = None,
    unit: Annotated[
        str,
        typer.Option(
            metavar="mm|cm|m",
            help="The unit of IN, where it does not say: 3D Slicer's files are in millimetres.",
            show_default=False,
        ),
    ] = "",
    force: Force = False,
) -> None:
    """Convert landmarks between programs: OpenSim Creator, 3D Slicer, MeshLab, BigWarp, ..."""
    refuse_to_replace([source], [output])
    refuse_existing([output], force)
    known = None if to is None else format_of(f"landmarks.{to.lower().removeprefix('.')}")
    done = convert_landmarks(source, output, side=side, known=known, unit=unit)
    tell_notes(done.notes, source.name)
    typer.echo(f"{output}: {counted(done.count, 'landmark')}, {done.read_as} to {done.written_as}")
