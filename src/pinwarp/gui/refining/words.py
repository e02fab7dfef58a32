"""What is said about a refinement: under way, done, out of date, and checked."""

from __future__ import annotations

import html
import math

from pinwarp.core.lengths import Ruler
from pinwarp.core.refinement import Level
from pinwarp.core.words import counted
from pinwarp.gui.refining.fit import Fit
from pinwarp.gui.scene.key_words import with_own_keys
from pinwarp.gui.style import theme
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session.warp.refining import Verification

ABOUT = (
    "Draws places all over the source to the destination's surface, large features first, and "
    "slides them on it. Every landmark is met, unless it gets a tolerance."
)
NOT_REFINED = "Not refined yet."
CANCELLED = "Cancelled: the warp is as it was."
CHANGED = "Landmarks, drawn curves, a mesh or the penalty changed: the refinement was cancelled."
CHECK_CHANGED = "Landmarks, drawn curves, a mesh or the penalty changed: the check was cancelled."
CHECK_CANCELLED = "The check was cancelled."
NOTHING_TO_COMPARE = with_own_keys("The warp is not refined: Ctrl+R refines it to the surface.")
STARTING = "Spreading places over the source"
CHECKING = "Checking the refinement"
FAILED = "The refinement failed: Help > Copy Details says what went wrong. The warp is as it was."
BUSY = "A refinement or its check is under way already."
TURN, TURN_BACK = "Turn It Round and Refine", "Refine Them as They Are"
ALREADY_TURNED = "Taken the other way round, the surfaces face opposite ways: they fit as they are."

# Of the places; where fewer were fitted, a part of the destination is missing.
COVERED = 0.9


def level_in_words(level: Level, ruler: Ruler) -> str:
    """Say which level is drawn.

    Examples
    --------
    >>> level_in_words(Level(3, 8, 42.13, None, 150, 150, 0, 0.1), Ruler("mm"))
    'Level 3 of 8: features larger than 42.1 mm'
    """
    feature = ruler.text(level.feature, 3)
    return f"Level {level.number} of {level.count}: features larger than {feature}"


def refined_in_words(
    refined: RefinementRecord, pairs: int, ruler: Ruler, fit: Fit | None, folds: int | None
) -> str:
    """Say what was fitted, and how.

    Parameters
    ----------
    refined
        A refinement in use.
    pairs
        How many landmarks take part.
    ruler
        How lengths are told.
    fit, folds
        What was measured; None while it is not known.

    Examples
    --------
    >>> record = RefinementRecord(((0, 0, 0),) * 16, ((0, 0, 0),) * 16, 6.5, places=13)
    >>> print(refined_in_words(record, 4, Ruler("mm"), Fit(record, 2.37, 0.264), 0))
    Refined: 12 of 13 places fitted, features larger than 6.5 mm. No folds.
    Mean distance 2.37 → 0.264 mm (fitted): it proves nothing.
    """
    fitted = len(refined.source) - pairs
    feature = ruler.text(refined.smallest_feature, 3)
    words = [
        f"Refined: {fitted:,} of {counted(refined.places, 'place')} fitted, features larger than "
        f"{feature}."
    ]
    if fitted < COVERED * refined.places:
        words.append(
            f"{refined.places - fitted:,} have no counterpart: the warp is a guess around them."
        )
    if refined.landmark_tolerance > 0:
        words.append(f"Landmark tolerance {ruler.text(refined.landmark_tolerance, 3)}.")
    if refined.folding:
        words.append(
            f"{counted(refined.folding, 'vertex', 'vertices')} would have folded, so that an "
            "earlier step was kept: look at the landmarks there, or give them a tolerance."
        )
    if folds is not None:
        words.append(
            f"{counted(folds, 'folded vertex', 'folded vertices')}." if folds else "No folds."
        )
    lines = [" ".join(words)]
    if fit is not None and fit.before is not None and fit.after is not None:
        before, after = ruler.number(fit.before, 3), ruler.text(fit.after, 3)
        lines.append(f"Mean distance {before} → {after} (fitted): it proves nothing.")
    return "\n".join(lines)


def worth_in_words(worth: Verification, ruler: Ruler) -> str:
    """Say what a refinement is worth, in a sentence."""
    if not worth.judged:
        return "No landmark could be left out: see why below."
    (rms_before, rms_after), (before, after) = worth.rms(), worth.median()
    return (
        f"Left out one by one, {worth.improved} of {counted(worth.judged, 'landmark')} "
        f"{'is' if worth.improved == 1 else 'are'} missed by less: RMS "
        f"{ruler.number(rms_before, 3)} → {ruler.text(rms_after, 3)}, "
        f"median {ruler.number(before, 3)} → {ruler.text(after, 3)}."
    )


def worth_as_html(worth: Verification, ruler: Ruler) -> str:
    """Return a small table: by how much each landmark is missed, unrefined and refined."""
    head = ("Left out", f"Before, {ruler.unit}", f"Refined, {ruler.unit}")
    rows = [_row(head, "th")]
    for name, before, after in zip(
        worth.names, worth.before.tolist(), worth.after.tolist(), strict=True
    ):
        numbers = ("–" if math.isnan(x) else ruler.number(x, 3) for x in (before, after))
        rows.append(_row((name, *numbers), "td", worse=after > before))
    problems = "".join(f"<p>{html.escape(problem)}</p>" for problem in worth.problems)
    return f'<table cellspacing="0" cellpadding="2">{"".join(rows)}</table>{problems}'


def _row(cells: tuple[str, ...], tag: str, *, worse: bool = False) -> str:
    name, *numbers = (html.escape(cell).replace(" ", "&nbsp;") for cell in cells)
    # Not by colour alone: a sign as well.
    colour = f' style="color:{theme.warning_text_colour().name()}"' if worse else ""
    right = [f'<{tag} align="right" style="padding-left:18px">{x}</{tag}>' for x in numbers]
    sign = f"<td{colour}>&nbsp;{'worse' if worse else ''}</td>"
    return f'<tr><{tag} align="left">{name}</{tag}>{"".join(right)}{sign}</tr>'
