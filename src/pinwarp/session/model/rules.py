"""What can be chosen for an element of a body: carried, turned with the bone, or left as it is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from enum import StrEnum

from pinwarp.core.frame_warp import BodyRules
from pinwarp.core.model_parts import BodyParts, OffsetPart


class Rule(StrEnum):
    """What is done with an element.

    Examples
    --------
    >>> Rule("keep").name
    'KEEP'
    """

    CARRY = "carry"
    TURN = "turn"
    KEEP = "keep"


def choices(parts: BodyParts, path: str) -> tuple[Rule, ...]:
    """Return the rules that an element can have; none where nothing can be chosen.

    Parameters
    ----------
    parts
        The body.
    path
        Of the element.
    """
    if path in parts.frames:
        # A frame that OpenSim makes of stations follows those.
        return tuple(Rule) if isinstance(parts.frames[path], OffsetPart) else ()
    return (Rule.CARRY, Rule.KEEP) if path in parts.paths else ()


def rule_of(parts: BodyParts, rules: BodyRules, path: str) -> Rule:
    """Return the rule of an element as things are."""
    if path in rules.keep:
        return Rule.KEEP
    turned = path in parts.frames and (rules.turns or path in rules.turn)
    return Rule.TURN if turned else Rule.CARRY


def with_rule(parts: BodyParts, rules: BodyRules, paths: Iterable[str], rule: Rule) -> BodyRules:
    """Return the rules with another one for some elements, as far as those can have it.

    Parameters
    ----------
    parts
        The body.
    rules
        As they are.
    paths
        Of the elements.
    rule
        What is to become of them.

    Examples
    --------
    >>> from pinwarp.io.osim.body_parts import body_parts
    >>> from pinwarp.io.osim.reading import read_model
    >>> from pinwarp.io.samples import sample_model
    >>> thigh = body_parts(read_model(sample_model()), "/bodyset/thigh")
    >>> rules = with_rule(thigh, BodyRules(), ["/markerset/KNEE"], Rule.KEEP)
    >>> rules.keep, rule_of(thigh, rules, "/markerset/KNEE").value
    (frozenset({'/markerset/KNEE'}), 'keep')
    """
    chosen = frozenset(path for path in paths if rule in choices(parts, path))
    if not chosen:
        return rules
    keep = rules.keep - chosen
    if rule is Rule.KEEP:
        return replace(rules, keep=keep | chosen)
    if rule is Rule.TURN:
        extra = frozenset() if rules.turns else chosen
        return replace(rules, keep=keep, turn=rules.turn | extra)
    if rules.turns and chosen & parts.frames.keys():
        # What held for all holds for the others now.
        offsets = {path for path, one in parts.frames.items() if isinstance(one, OffsetPart)}
        return BodyRules(False, (rules.turn | offsets) - chosen, keep)
    return replace(rules, keep=keep, turn=rules.turn - chosen)
