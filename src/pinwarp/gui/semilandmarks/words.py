"""What is said of semilandmarks."""

from __future__ import annotations

from pinwarp.core.groups import Curve, Group
from pinwarp.core.words import counted
from pinwarp.gui.semilandmarks.shown import Shown, ShownGroup

REFINED = "The warp is refined to the surface: semilandmarks take no part in it."


def kind_of(group: Group) -> str:
    """Return what a group is, in one or two words."""
    if isinstance(group, Curve):
        return "closed" if group.is_closed else "curve"
    return "patch"


def state_of(group: Group) -> str:
    """Say whether a curve is drawn on the destination; nothing of a patch."""
    if not isinstance(group, Curve):
        return ""
    return "drawn" if group.is_drawn else "ghost"


def why_not(shown: Shown) -> str:
    """Say why semilandmarks take no part in the warp; empty where they do."""
    result = shown.asked.result
    problem = next((f"{x.group.name}: {x.problem}" for x in shown.groups if x.problem), "")
    if not shown.groups or result is None:
        return problem
    if result.inputs.refinement is not None:
        return REFINED
    return result.not_sliding or problem


def freed_words(shown: Shown, chosen: ShownGroup | None = None) -> str:
    """Say how many points have no counterpart, of one group or of all; empty for none."""
    several = shown.groups if chosen is None else (chosen,)
    freed, count = (sum(getattr(x, key) for x in several) for key in ("freed", "taking_part"))
    if not freed:
        return ""
    have = "has" if freed == 1 else "have"
    words = f"{freed:,} of {count:,} {have} no counterpart"
    return words if chosen is None else f"{chosen.group.name}: {words}"


def in_short(shown: Shown) -> str:
    """Say what there is, for the status bar.

    Examples
    --------
    >>> from pinwarp.gui.semilandmarks.shown import Asked
    >>> in_short(Shown(Asked((), None, None, None)))
    ''
    """
    if not shown.groups:
        return ""
    count, freed = (sum(getattr(x, key) for x in shown.groups) for key in ("taking_part", "freed"))
    words = counted(count, "semilandmark")
    if why_not(shown):
        return f"{words}, not sliding"
    return f"{words}, {freed:,} without counterpart" if freed else words
