"""``pinwarp repeat``: how precisely landmarks were digitised, and the penalty that asks for."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pinwarp.cli.telling import tell_json, tell_notes
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.io.file_names import is_session
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.repeat.comparing import OtherFrameError, Repeats, compared
from pinwarp.session.repeat.level import (
    PenaltyOfNoise,
    about_session,
    penalty_of_noise,
    with_spreads_of,
)
from pinwarp.session.repeat.reading import read_repeat
from pinwarp.session.session import Session

WORST = 10


def repeat(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="A B [C ...]",
            help="The same landmarks of one bone, digitised two or more times: landmark files of "
            "any format (FILE#SPECIMEN takes one of several) or sessions. Nothing is aligned.",
        ),
    ],
    side: Annotated[
        Side | None,
        typer.Option(
            help="The side that was digitised again; needed for files of both, and for a penalty.",
            show_default=False,
        ),
    ] = None,
    session: Annotated[
        Path | None,
        typer.Option(
            metavar="SESSION",
            help="The session whose pairs say which warping penalty the noise asks for; without "
            "it the first of the files that is one.",
            show_default=False,
        ),
    ] = None,
    keep: Annotated[
        bool, typer.Option("--keep", help="Keep the spreads with SESSION, in its file.")
    ] = False,
    by_order: Annotated[
        bool,
        typer.Option(
            "--by-order", help="Match landmarks by their order, whatever they are called."
        ),
    ] = False,
    adapt: Annotated[
        bool,
        typer.Option(
            "--adapt",
            help="Bring files that seem to be in another frame (LPS or RAS) or unit (a factor of "
            "1,000) to the first one's; else such a file is refused.",
        ),
    ] = False,
    whole: Annotated[
        bool, typer.Option("--all", help=f"Print all landmarks, not the {WORST} worst.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print figures for a program.")] = False,
) -> None:
    """Print how precisely landmarks were digitised, and the warping penalty for that noise."""
    chosen = session or next((x for x in files if is_session(x)), None)
    if keep and session is None:
        raise PinwarpError("--keep writes into a session: say which by --session.")
    if session is not None and side is None:
        raise PinwarpError(
            "Which side of the session was digitised again? Say --side source or --side "
            "destination."
        )
    try:
        repeats = compared(
            [read_repeat(path, side) for path in files], by_order=by_order, adapt=adapt
        )
    except OtherFrameError as error:
        raise PinwarpError(f"{error} --adapt does that.") from None
    tell_notes(repeats.notes)
    opened = None if chosen is None else read_session(chosen, meshes=())
    found, reason = None, ""
    if opened is not None and side is not None:
        tell_notes(about_session(opened, side, repeats))
        try:
            found = penalty_of_noise(opened, side, repeats)
        except PinwarpError as error:
            reason = str(error)
    if as_json:
        words = _as_json(repeats, side, found)
        tell_json(words)
    else:
        _print(Console(), repeats, opened, found, whole)
    tell_notes([reason] if reason else [])
    if keep and opened is not None and side is not None and session is not None:
        write_session(session, with_spreads_of(opened, side, repeats))
        tell_notes([f"The spreads are kept with {session.name}."])


def _as_json(repeats: Repeats, side: Side | None, found: PenaltyOfNoise | None) -> dict[str, Any]:
    figures = repeats.figures
    rows = zip(
        repeats.names,
        figures.counts.tolist(),
        figures.spreads.tolist(),
        figures.shares.tolist(),
        figures.outstanding.tolist(),
        strict=True,
    )
    return {
        "files": list(repeats.labels),
        "side": None if side is None else side.value,
        "unit": repeats.unit or None,
        "spread": figures.spread,
        "spread_interval": list(figures.interval),
        "variance": figures.variance,
        "degrees_of_freedom": figures.freedom,
        "axis_shares": _axis_shares(repeats),
        "penalty": None
        if found is None
        else {
            "penalty": _finite(found.penalty),
            "interval": [_finite(found.low), _finite(found.high)],
            "noise": found.noise,
            "field": found.field,
            "sides": [one.value for one in found.sides],
        },
        "landmarks": [
            {
                "name": name,
                "repeats": count,
                "spread": None if math.isnan(spread) else spread,
                "axis_shares": None if math.isnan(shares[0]) else shares,
                "stands_out": out,
            }
            for name, count, spread, shares, out in rows
        ],
        "notes": list(repeats.notes),
    }


def _finite(value: float) -> float | str:
    return "inf" if math.isinf(value) else value


def _axis_shares(repeats: Repeats) -> list[float]:
    variances = repeats.figures.axis_variances
    return [float(x) for x in variances / variances.sum()]


def _print(
    console: Console,
    repeats: Repeats,
    session: Session | None,
    found: PenaltyOfNoise | None,
    whole: bool,
) -> None:
    figures = repeats.figures
    unit = repeats.unit or ("" if session is None else session.unit)
    worst = repeats.worst_first if whole else repeats.worst_first[:WORST]
    lengths = f", lengths in {unit}" if unit else ""
    these = "largest spread first" if len(worst) == len(repeats.spreads) else f"the {WORST} worst"
    table = Table(
        "Landmark",
        title=f"{counted(len(repeats.spreads), 'landmark')} in "
        f"{counted(len(repeats.labels), 'repeat')}: {these}{lengths}",
    )
    for column in ("Repeats", "Spread", "x", "y", "z"):
        table.add_column(column, justify="right")
    for row in worst:
        shares = figures.shares[row]
        table.add_row(
            # Names are the user's: brackets in them are no markup.
            escape(repeats.names[row]),
            str(figures.counts[row]),
            f"{figures.spreads[row]:.3g}",
            *("" if math.isnan(share) else f"{share:.0%}" for share in shares),
            style="bold" if figures.outstanding[row] else None,
        )
    console.print(table)
    low, high = figures.interval
    axes = ", ".join(
        f"{axis} {share:.0%}" for axis, share in zip("xyz", _axis_shares(repeats), strict=True)
    )
    told = [
        ("Pooled spread", f"{_length(figures.spread, unit)} (95%: {low:.3g} to {high:.3g})"),
        (
            "Of one coordinate",
            f"{_length(math.sqrt(figures.variance), unit)}, {figures.freedom} degrees of freedom",
        ),
        ("Share of each axis", axes),
    ]
    if found is not None:
        words = f"{_length(found.penalty, unit)} ({found.low:.3g} to {found.high:.3g})"
        told.append(("Penalty for this noise", words))
    for label, words in told:
        console.print(f"{label:<24}{words}", markup=False, highlight=False)
    if found is not None:
        console.print(f"- {found.words}", markup=False, highlight=False, soft_wrap=True)


def _length(value: float, unit: str) -> str:
    return f"{value:.3g} {unit}".rstrip()
