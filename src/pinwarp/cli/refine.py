"""``pinwarp refine``: fit the warp of a session to the whole surface."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pinwarp.cli.bars import stage_bar
from pinwarp.cli.options import Force, SessionFile
from pinwarp.cli.telling import refuse_existing, tell, tell_json, tell_notes
from pinwarp.core.errors import words_of
from pinwarp.core.lengths import Ruler
from pinwarp.core.words import counted
from pinwarp.io.backup import write_keeping_previous
from pinwarp.session.judging.check import Check, check
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session
from pinwarp.session.warp.refining import (
    RefinementOptions,
    Verification,
    refined_session,
    verified,
)

Feature = Annotated[
    float | None,
    typer.Option(
        metavar="LENGTH",
        help="Bend only what is larger, in the unit of the mesh; without it what 1200 places "
        "over the bone resolve.",
        show_default=False,
    ),
]
Tolerance = Annotated[
    float | None,
    typer.Option(
        metavar="LENGTH",
        help="A penalty of the landmarks, which may then miss; without it the session's, and 0 "
        "meets them all. Worth a try where landmarks are uncertain or the warp folds.",
        show_default=False,
    ),
]
Turn = Annotated[
    bool,
    typer.Option("--turn", help="One of the meshes is inside out: take it the other way round."),
]


def refine(
    session: SessionFile,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="Where the refined session goes; without it into SESSION itself, whose last "
            "version stays beside it as SESSION.bak.",
            show_default=False,
        ),
    ] = None,
    feature: Feature = None,
    tolerance: Tolerance = None,
    turn: Turn = False,
    verify: Annotated[
        bool,
        typer.Option(
            "--verify",
            help="Refine again without each landmark in turn, and tell how far the warp then "
            "misses it: what the refinement is worth. Takes as long for each.",
        ),
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print figures for a program.")] = False,
    force: Force = False,
) -> None:
    """Refine the warp of a session to the whole surface of the destination.

    Places all over the source are drawn to the destination, large features first, while the
    landmarks are met. The session then holds what was fitted, until a landmark, a mesh or the
    penalty changes.

    The distance between the surfaces proves nothing afterwards: it is what was fitted. Ask
    --verify for what the refinement is worth.
    """
    target = session if out is None else out
    if out is not None:
        refuse_existing([out], force)
    opened = read_session(session)
    options = RefinementOptions(feature, tolerance, turn)
    before = check(replace(opened, refinement=None))
    with stage_bar() as progress:
        refined, found = refined_session(opened, options, progress=progress)
    after = check(refined)
    with stage_bar() as progress:
        worth = verified(refined, options, progress=progress) if verify else None
    problem = write_keeping_previous(target, lambda path: write_session(path, refined))
    if problem is not None:
        tell_notes([f"The previous version was not kept: {words_of(problem)}"], target.name)
    if found.folding:
        tell_notes(
            [
                f"{counted(found.folding, 'vertex', 'vertices')} would have folded: an earlier "
                "step was kept. Look at the landmarks there, or give them a tolerance."
            ]
        )
    tell_notes((*after.notes, *(() if worth is None else worth.problems)))
    if as_json:
        tell_json(_as_json(refined, before, after, worth))
        return
    console = Console()
    console.print(_table(refined, before, after))
    record = refined.refinement
    assert record is not None, "it was refined"
    console.print(
        f"{found.fitted:,} of {found.places:,} places fitted, features larger than "
        f"{rulers_of(refined).session.text(record.smallest_feature)}. "
        "A small distance then proves nothing.",
        markup=False,
        highlight=False,
    )
    if worth is not None:
        console.print(_worth(refined, worth))
        tell(f"Refined without them, {worth.improved} of {worth.judged} pairs are missed by less.")
    tell(f"Wrote {target}")


def _table(session: Session, before: Check, after: Check) -> Table:
    table = Table("", title=f"Lengths in {session.unit}")
    for column in ("Landmarks", "Refined (fitted)"):
        table.add_column(column, justify="right")
    ruler = rulers_of(session).session
    for label, one, two in _figures(before, after):
        table.add_row(label, _number(one, ruler), _number(two, ruler))
    return table


def _figures(before: Check, after: Check) -> list[tuple[str, float | None, float | None]]:
    rows: list[tuple[str, float | None, float | None]] = []
    if before.distance is not None and after.distance is not None:
        rows = [
            (f"Distance, {words}", getattr(before.distance, key), getattr(after.distance, key))
            for words, key in (("mean", "mean"), ("95 %", "percentile_95"), ("max", "maximum"))
        ]
    rows.append(("RMS residual of the pairs", before.rms_residual, after.rms_residual))
    rows.append(("Folded vertices", before.folded_vertices, after.folded_vertices))
    return rows


def _worth(session: Session, worth: Verification) -> Table:
    table = Table("Pair", title=f"Left out, in {session.unit}")
    for column in ("Landmarks", "Refined"):
        table.add_column(column, justify="right")
    ruler = rulers_of(session).session
    for name, one, two in zip(worth.names, worth.before, worth.after, strict=True):
        # Names are the user's: brackets in them are no markup.
        table.add_row(escape(name), _number(one, ruler), _number(two, ruler))
    table.add_section()
    for label, figures in (("RMS", worth.rms()), ("Median", worth.median())):
        table.add_row(label, *(_number(x, ruler) for x in figures), style="bold")
    return table


def _number(value: float | None, ruler: Ruler) -> str:
    return "" if value is None or math.isnan(value) else ruler.number(value)


def _as_json(
    session: Session, before: Check, after: Check, worth: Verification | None
) -> dict[str, Any]:
    record = session.refinement
    assert record is not None, "it was refined"
    found: dict[str, Any] = {
        "unit": session.unit,
        "fitted": after.fitted,
        "places": record.places,
        "smallest_feature": record.smallest_feature,
        "landmark_tolerance": record.landmark_tolerance,
        "folding": record.folding,
        "before": before.as_json(),
        "after": after.as_json(),
    }
    if worth is not None:
        found["left_out"] = {
            "improved": worth.improved,
            "judged": worth.judged,
            "rms": [_known(x) for x in worth.rms()],
            "median": [_known(x) for x in worth.median()],
            "pairs": [
                {"name": name, "before": _known(one), "after": _known(two)}
                for name, one, two in zip(worth.names, worth.before, worth.after, strict=True)
            ],
        }
    return found


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
