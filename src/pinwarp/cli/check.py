"""``pinwarp check``: how good the warp of a session is."""

from __future__ import annotations

import math
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from pinwarp.cli.options import BasisOption, SessionFile, with_basis
from pinwarp.cli.telling import tell_json
from pinwarp.core.findings import Severity
from pinwarp.core.lengths import Ruler
from pinwarp.core.words import counted
from pinwarp.io.setting_keys import plain_settings
from pinwarp.session.judging import check as checking
from pinwarp.session.keeping.files import read_session
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session
from pinwarp.session.warp.provenance import session_hash
from pinwarp.session.warp.setting_words import settings_in_words
from pinwarp.version import __version__

FLAGGED = 1
FITTED = "{:,} places: a small distance then proves nothing; figures of pairs are the landmarks'"

SLID = "{:,} semilandmarks: a small distance then proves little"


def check(
    session: SessionFile,
    basis: BasisOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print figures for a program.")] = False,
    strict: Annotated[
        bool,
        typer.Option(
            "--strict",
            help="Exit with 1 where pairs look wrong (displaced, one of two, swapped, mirrored, "
            "in conflict), landmarks are in another frame or unit than their mesh, or the warp "
            "folds.",
        ),
    ] = False,
) -> None:
    """Print how good a session's warp is: residuals, leave-one-out errors, findings, distances."""
    opened = read_session(session)
    if basis is not None:
        opened = with_basis(opened, basis)
    checked = checking.check(opened)
    if as_json:
        about = _about(opened)
        # The affine fit's penalty is no number to JSON; session files say "inf", too.
        if math.isinf(opened.settings.penalty):
            about["warping_penalty"] = "inf"
        words = about | checked.as_json()
        tell_json(words)
    else:
        _print(Console(), session.name, opened, checked)
    if strict and checked.is_flagged:
        raise typer.Exit(FLAGGED)


def _about(session: Session) -> dict[str, Any]:
    return {
        "pinwarp": __version__,
        "session": session_hash(session),
        "unit": session.unit,
        **plain_settings(session.settings),
    }


def _print(console: Console, name: str, session: Session, checked: checking.Check) -> None:
    ruler = rulers_of(session).session
    count = counted(len(checked.pairs), "pair")
    pairs = Table("Pair", title=f"{name}: {count}, lengths in {ruler.unit}")
    measured = any(not math.isnan(pair.spread) for pair in checked.pairs)
    in_spreads = ("Spread", "Left out / spread") if measured else ()
    for column in ("Residual", "Left out", "Standardised", *in_spreads):
        pairs.add_column(column, justify="right")
    named = {name for x in checked.findings if x.severity is Severity.WRONG for name in x.names}
    lengths = [x for pair in checked.pairs for x in (pair.residual, pair.leave_one_out)]
    decimals = _decimals(max((ruler.shown(x) for x in lengths if not math.isnan(x)), default=0.0))
    for pair in checked.pairs:
        times = _number(pair.leave_one_out / pair.spread, 1)
        cells = (_number(ruler.shown(pair.spread), decimals), times)
        pairs.add_row(
            # Names are the user's: brackets in them are no markup.
            escape(pair.name),
            _number(ruler.shown(pair.residual), decimals),
            _number(ruler.shown(pair.leave_one_out), decimals),
            _number(pair.standardised, 2),
            *cells[: len(in_spreads)],
            style="bold" if pair.name in named else None,
        )
    console.print(pairs)
    if checked.groups:
        console.print(_of_groups(checked, decimals, ruler))
    for label, words in _figures(session, checked):
        console.print(f"{label:<22}{words}", markup=False, highlight=False)
    for found in checked.findings:
        mark = "!" if found.severity is Severity.WRONG else "-"
        console.print(f"{mark} {found.sentence}", markup=False, highlight=False)
    for note in checked.notes:
        console.print(f"- {note}", markup=False, highlight=False)


def _of_groups(checked: checking.Check, decimals: int, ruler: Ruler) -> Table:
    groups = Table("Curve or patch")
    for column in ("Kind", "Points", "Excluded", "Freed", "Largest slide"):
        groups.add_column(column, justify="left" if column == "Kind" else "right")
    for group in checked.groups:
        kind = f"{group.kind}, drawn" if group.drawn else group.kind
        counts = (str(group.points), str(group.excluded), str(group.freed))
        groups.add_row(
            escape(group.name), kind, *counts, _number(ruler.shown(group.largest_slide), decimals)
        )
    return groups


def _figures(session: Session, checked: checking.Check) -> list[tuple[str, str]]:
    ruler = rulers_of(session).session
    of_penalty = session.settings.penalty_ruler(ruler)
    figures = [
        ("Session", session_hash(session)),
        *settings_in_words(session.settings, session.unit),
        ("Suggested penalty", _length(checked.suggested_penalty, of_penalty, "none")),
        *_flatness(checked, of_penalty),
        (
            "Flexibility",
            "not defined" if checked.flexibility is None else f"{checked.flexibility:.1%}",
        ),
        ("RMS residual", _length(checked.rms_residual, ruler)),
        (
            "RMS left out",
            _length(checked.rms_leave_one_out, ruler),
        ),
    ]
    if checked.folded_vertices is not None:
        figures.append(("Folded vertices", f"{checked.folded_vertices:,}"))
    if (far := checked.distance) is not None:
        figures.append(
            (
                "To the destination" if checked.fitted is None else "To it (fitted)",
                f"mean {ruler.number(far.mean)}, 95% {ruler.number(far.percentile_95)}, "
                f"max {ruler.text(far.maximum)}",
            )
        )
    if checked.fitted is not None:
        told = SLID if checked.groups else FITTED
        figures.append(("Fitted to the surface", told.format(checked.fitted)))
    return figures


def _flatness(checked: checking.Check, ruler: Ruler) -> list[tuple[str, str]]:
    """Say which penalties do as well as the suggested one."""
    if checked.as_good is None:
        return []
    low, high = checked.as_good
    return [("As good", f"{ruler.number(low, 2)} to {ruler.text(high, 2)}")]


def _number(value: float, decimals: int) -> str:
    return "" if math.isnan(value) else f"{value:.{decimals}f}"


def _decimals(largest: float) -> int:
    """Return after how many decimals the largest of some lengths has four digits."""
    return max(0, 3 - math.floor(math.log10(largest))) if largest > 0 else 0


def _length(value: float | None, ruler: Ruler, otherwise: str = "not known") -> str:
    return otherwise if value is None else ruler.text(value)
