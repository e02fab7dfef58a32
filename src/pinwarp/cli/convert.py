"""``pinwarp convert``: landmarks from one program's format into another's."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pinwarp.cli.options import Force
from pinwarp.cli.telling import refuse_existing, tell_notes
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.io.file_names import is_session
from pinwarp.io.landmark_files import LANDMARK_SUFFIXES, format_of
from pinwarp.io.semilandmark_files import (
    SEMILANDMARK_SUFFIXES,
    format_of_semilandmarks,
    semilandmark_files,
    write_all,
)
from pinwarp.session.importing.conversion import convert_landmarks
from pinwarp.session.keeping.files import read_session
from pinwarp.session.outputs.replacing import refuse_to_replace
from pinwarp.session.outputs.semilandmarks import semilandmarks_on


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
    semilandmarks: Annotated[
        bool,
        typer.Option(
            "--semilandmarks",
            help="Write a session's curves and patches along with its landmarks. OUT is one of "
            f"{', '.join(SEMILANDMARK_SUFFIXES)}; --side is needed. Some formats are several "
            "files, called as OUT is.",
        ),
    ] = False,
    force: Force = False,
) -> None:
    """Convert landmarks between programs: OpenSim Creator, 3D Slicer, MeshLab, BigWarp, ..."""
    if semilandmarks:
        _with_semilandmarks(source, output, to, side, force)
        return
    refuse_to_replace([source], [output])
    refuse_existing([output], force)
    known = None if to is None else format_of(f"landmarks.{to.lower().removeprefix('.')}")
    done = convert_landmarks(source, output, side=side, known=known, unit=unit)
    tell_notes(done.notes, source.name)
    typer.echo(f"{output}: {counted(done.count, 'landmark')}, {done.read_as} to {done.written_as}")


def _with_semilandmarks(
    source: Path, output: Path, to: str | None, side: Side | None, force: bool
) -> None:
    """Write landmarks, curves and patches of one side of a session."""
    if not is_session(source):
        raise PinwarpError(f"{source.name} is no session: only sessions have curves and patches.")
    if side is None:
        raise PinwarpError(
            f"{source.name} holds both sides: choose by --side source or --side destination."
        )
    known = None if to is None else format_of_semilandmarks(Path(f"x.{to.removeprefix('.')}"))
    points, left = semilandmarks_on(read_session(source), side)
    texts, notes = semilandmark_files(output, points, known)
    refuse_to_replace([source], texts)
    refuse_existing(list(texts), force)
    write_all(texts)
    tell_notes((*left, *notes), source.name)
    count = counted(len(points.places) - points.landmarks, "semilandmark")
    for path in texts:
        typer.echo(f"{path}: {counted(points.landmarks, 'landmark')}, {count}")
