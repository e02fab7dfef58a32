"""``pinwarp convert``: landmarks from one program's format into another's."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pinwarp.cli.options import Force
from pinwarp.cli.telling import refuse_existing, tell, tell_notes
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.io.file_names import as_file_name, is_session
from pinwarp.io.landmark_files import ALL, LANDMARK_SUFFIXES, format_of, located
from pinwarp.io.semilandmark_files import (
    SEMILANDMARK_SUFFIXES,
    format_of_semilandmarks,
    semilandmark_files,
    write_all,
)
from pinwarp.session.importing.conversion import (
    Conversion,
    Meant,
    convert_landmarks,
    convert_specimens,
)
from pinwarp.session.keeping.files import read_session
from pinwarp.session.outputs.replacing import refuse_to_replace
from pinwarp.session.outputs.semilandmarks import semilandmarks_on


def convert(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="IN",
            help="A landmark file of any format, or a session. Of several specimens FILE#NAME or "
            "FILE#NUMBER takes one, FILE#all each, to OUT_NAME.",
        ),
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
    frame: Annotated[
        str,
        typer.Option(
            metavar="LPS|RAS",
            help="The frame of IN, where it does not say: 3D Slicer's files are in LPS.",
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
    file, which = located(source)
    known = None if to is None else format_of(f"landmarks.{to.lower().removeprefix('.')}")
    meant = Meant(unit, frame, landmarks=force)

    def convert_one(one: Path, out: Path) -> Conversion:
        refuse_to_replace([file], [out])
        refuse_existing([out], force)
        return convert_landmarks(one, out, side=side, known=known, meant=meant)

    if which == ALL:
        done = convert_specimens(file, lambda name: _beside(output, name), convert_one)
    else:
        done = {output: convert_one(source, output)}
    for path, one in done.items():
        tell_notes(one.notes, source.name)
        tell(f"{path}: {counted(one.count, 'landmark')}, {one.read_as} to {one.written_as}")
        if not which and one.specimens > 1:
            tell_notes([f"{file.name}#NAME takes another, {file.name}#{ALL} each."])


def _beside(output: Path, specimen: str) -> Path:
    """Return the file of a specimen: called as the output is, its name in front of the suffix."""
    stem, dot, suffix = output.name.partition(".")
    return output.with_name(f"{stem}_{as_file_name(specimen)}{dot}{suffix}")


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
        tell(f"{path}: {counted(points.landmarks, 'landmark')}, {count}")
