"""The columns of the landmark table: what each is called, shows, sorts by and lets one type.

A new column, such as one of a quality, is one entry in :data:`COLUMNS` and a call of
``LandmarkModel.show_values`` with its numbers.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from qtpy.QtGui import QIcon

from pinwarp.core.errors import LandmarkError
from pinwarp.core.findings import FindingKind
from pinwarp.core.landmarks import Landmark, LandmarkState, Side
from pinwarp.gui.painted.markers import state_icon
from pinwarp.gui.style import theme
from pinwarp.gui.style.icons import icon
from pinwarp.session import edits
from pinwarp.session.coordinates import position_text, typed_position
from pinwarp.session.judging.quality import NamedFinding
from pinwarp.session.naming import natural
from pinwarp.session.repeat.spreads import times_spread
from pinwarp.session.rulers import Rulers
from pinwarp.session.session import Session
from pinwarp.session.warp.solver import is_rounding


@dataclass(frozen=True)
class Row:
    """A landmark, the numbers found for it by the key of their column, and what was noticed.

    ``rulers`` say how lengths are shown.
    """

    landmark: Landmark
    values: Mapping[str, float]
    findings: Sequence[NamedFinding] = ()
    rulers: Rulers = field(default_factory=Rulers)


@dataclass(frozen=True)
class Column:
    """One column.

    Parameters
    ----------
    key
        Its name in the program.
    title, tip
        What its header says, and in full.
    text
        What a cell says.
    sort_key
        What it sorts by; None always comes last.
    cell_tip
        What a cell says in full; the column's own tip where there is none.
    icon, checked
        A picture, and a tick, in front of the text.
    edit
        Session, name, typed text and the rulers it is typed by to a session; raises a
        LandmarkError with the reason.
    edit_text, can_edit, label
        What editing begins with, whether it may, and what Undo calls it.
    side
        Which side of the landmark a click on a cell means.
    header_icon
        The name of an icon that says the title in less room.
    short_title
        Letters that do so.
    is_length
        Whether its numbers are lengths: the header then says their unit.
    has_bar
        Whether a bar behind the number shows how large it is beside the others.
    is_numeric
        Whether it is written flush right.
    widest
        A text as wide as they come.
    on_demand
        Whether it is hidden at first.
    """

    key: str
    title: str
    tip: str
    text: Callable[[Row], str]
    sort_key: Callable[[Row], Any]
    cell_tip: Callable[[Row], str] | None = None
    icon: Callable[[Row], QIcon | None] | None = None
    checked: Callable[[Row], bool | None] | None = None
    edit: Callable[[Session, str, str, Rulers], Session] | None = None
    edit_text: Callable[[Row], str] | None = None
    can_edit: Callable[[Row], bool] = lambda _row: True
    label: str = "Edit {}"
    side: Side | None = None
    header_icon: str = ""
    short_title: str = ""
    is_length: bool = False
    has_bar: bool = False
    is_numeric: bool = False
    widest: str = ""
    on_demand: bool = False


def number_column(
    key: str,
    title: str,
    tip: str,
    text: Callable[[float, Row], str] | None = None,
    **more: Any,
) -> Column:
    """Return a column of numbers that the model was shown under its key.

    Parameters
    ----------
    key, title, tip
        As of a :class:`Column`.
    text
        What is shown of a number.
    more
        Further parameters of the column.

    Examples
    --------
    >>> column = number_column("spread", "Spread", "How far apart")
    >>> column.text(Row(Landmark("fovea"), {"spread": 0.12345})), column.title
    ('0.123', 'Spread')
    """

    def shown(row: Row) -> str:
        value = row.values.get(key)
        if value is None or not math.isfinite(value):
            return ""
        return f"{value:.3g}" if text is None else text(value, row)

    return Column(
        key=key,
        title=title,
        tip=tip,
        text=shown,
        # What is shown as 0 is 0: the noise below sorts nothing.
        sort_key=lambda row: 0.0 if shown(row) == "0" else row.values.get(key),
        is_numeric=True,
        widest="0.00123",
        **more,
    )


def _name_tip(row: Row) -> str:
    landmark = row.landmark
    lock = ", locked" if landmark.locked else ""
    note = f"\n{landmark.note}" if landmark.note else ""
    return f"{landmark.name}: {landmark.state.value}{lock}{note}"


def _tick(row: Row) -> bool | None:
    is_passenger = row.landmark.state is LandmarkState.PASSENGER
    return None if is_passenger else row.landmark.enabled


def _lock_icon(row: Row) -> QIcon:
    return icon("locked" if row.landmark.locked else "unlock")


def _lock_tip(row: Row) -> str:
    if row.landmark.locked:
        return "Locked: it cannot be moved by accident. A click unlocks it."
    return "A click locks it where it is."


def _placed(side: Side) -> Callable[[Row], str]:
    def text(row: Row) -> str:
        passenger = row.landmark.state is LandmarkState.PASSENGER
        if passenger and side is Side.DESTINATION and row.landmark.source is not None:
            return "→"
        return "–" if row.landmark.position(side) is None else "✓"

    return text


def _placed_tip(side: Side) -> Callable[[Row], str]:
    def tip(row: Row) -> str:
        if _placed(side)(row) == "→":
            return "A passenger: the warp carries it over."
        return position_text(row.landmark.position(side), row.rulers.on(side))

    return tip


def _length_text(length: float, row: Row) -> str:
    place = row.landmark.destination
    if place is not None and is_rounding(length, place):
        return "0"
    return row.rulers.destination.number(length, 3)


def _residual_tip(row: Row) -> str:
    length = row.values.get("residual")
    unit = row.rulers.destination.unit
    told = "" if length is None else f"{_length_text(length, row)} {unit}".rstrip()
    return "\n".join(filter(None, (told, _in_spreads(row, "residual"))))


def _in_spreads(row: Row, key: str) -> str:
    """Say a length in units of how precisely the landmark was digitised, where that is known."""
    length = row.values.get(key)
    words = "" if length is None else times_spread(length, row.values.get("spread"))
    return f"{row.landmark.name}: {words}" if words else ""


def _left_out_tip(row: Row) -> str:
    told = [found.sentence for found in row.findings] or [_usual(row)]
    return "\n".join(filter(None, (*told, _in_spreads(row, "left_out"))))


def _usual(row: Row) -> str:
    missed, times = row.values.get("left_out"), row.values.get("standardised")
    if missed is None or times is None or not math.isfinite(missed):
        return ""
    length = row.rulers.destination.text(missed, 3)
    return (
        f"{row.landmark.name} lies {length} from where the other pairs expect it, "
        f"{times:.1f} times what is usual for its surroundings."
    )


def _sign(row: Row) -> QIcon | None:
    return finding_icon(row.findings) if row.findings else None


def finding_icon(findings: Sequence[NamedFinding]) -> QIcon:
    """Return the sign of the gravest of some findings."""
    if any(found.finding.is_grave for found in findings):
        return icon("warning", theme.WARNING_COLOUR)
    quiet = theme.quiet_text_colour().name()
    if any(found.finding.kind is not FindingKind.ISOLATED for found in findings):
        return icon("look", quiet)
    return icon("isolated", quiet)


def _side_column(side: Side) -> Column:
    return Column(
        key=side.value,
        title=side.value.capitalize(),
        tip=f"Whether it is placed on the {side.value} mesh; the tip shows where",
        text=_placed(side),
        sort_key=lambda row: row.landmark.position(side) is None,
        cell_tip=_placed_tip(side),
        side=side,
        short_title=side.value[0].upper(),
        widest="→",
    )


def _coordinate_column(side: Side, short: str, axis: int) -> Column:
    letter = "xyz"[axis]

    def value(row: Row) -> float | None:
        position = row.landmark.position(side)
        return None if position is None else position[axis]

    def shown(row: Row) -> float | None:
        number = value(row)
        return None if number is None else row.rulers.on(side).factor * number

    def edit(session: Session, name: str, text: str, rulers: Rulers) -> Session:
        landmark = session.landmark(name)
        if landmark is None:
            raise LandmarkError(f"There is no landmark called {name}.")
        place = typed_position(landmark, side, axis, text, rulers.on(side))
        return edits.move(session, name, side, place)

    return Column(
        key=f"{side.value}_{letter}",
        title=f"{short} {letter}",
        tip=f"{letter} on the {side.value} mesh: double-click to type it, or all three (1 2 3)",
        text=lambda row: "" if (number := shown(row)) is None else f"{number:.6g}",
        sort_key=value,
        edit=edit,
        edit_text=lambda row: "" if (number := shown(row)) is None else repr(number),
        can_edit=lambda row: not row.landmark.locked,
        label="Move {}",
        side=side,
        is_length=True,
        is_numeric=True,
        widest="-1234.56",
        on_demand=True,
    )


NAME, LOCKED = "name", "locked"

COLUMNS: tuple[Column, ...] = (
    Column(
        key=NAME,
        title="Landmark",
        tip="Double-click or F2 renames; the tick lets the pair take part",
        text=lambda row: row.landmark.name,
        sort_key=lambda row: natural(row.landmark.name),
        cell_tip=_name_tip,
        icon=lambda row: state_icon(row.landmark.state),
        checked=_tick,
        edit=lambda session, name, text, _rulers: edits.rename(session, name, text),
        edit_text=lambda row: row.landmark.name,
        label="Rename {}",
    ),
    _side_column(Side.SOURCE),
    *(_coordinate_column(Side.SOURCE, "Source", axis) for axis in range(3)),
    _side_column(Side.DESTINATION),
    *(_coordinate_column(Side.DESTINATION, "Dest.", axis) for axis in range(3)),
    number_column(
        "residual",
        "Residual",
        "Distance from the warped source landmark to its destination",
        _length_text,
        cell_tip=_residual_tip,
        is_length=True,
        has_bar=True,
    ),
    number_column(
        "left_out",
        "Left out",
        "How far the destination lies from where the other pairs alone would put the landmark; "
        "a refinement is no part of that",
        _length_text,
        cell_tip=_left_out_tip,
        icon=_sign,
        is_length=True,
        has_bar=True,
    ),
    Column(
        key=LOCKED,
        title="Lock",
        tip="A locked landmark cannot be moved by accident; a click locks and unlocks",
        text=lambda _row: "",
        sort_key=lambda row: not row.landmark.locked,
        cell_tip=_lock_tip,
        icon=_lock_icon,
        header_icon="locked",
    ),
)


_NUMBERS = {column.key: number for number, column in enumerate(COLUMNS)}


def column_number(key: str) -> int:
    """Return where a column stands.

    Raises
    ------
    KeyError
        When there is no such column.
    """
    return _NUMBERS[key]
