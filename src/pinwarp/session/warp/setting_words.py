"""How a warp is solved and applied, in words: what reports and checks tell."""

from __future__ import annotations

import math
from dataclasses import fields
from enum import StrEnum

from pinwarp.core.basis import Basis
from pinwarp.core.settings import USUAL_SETTINGS, WarpSettings
from pinwarp.session.warp.component_words import applied_in_words

_TITLES = {"penalty": "Warping penalty", "components": "Applied", "planar": "Treated as planar"}
# Told even where they are as usual.
_ALWAYS = ("penalty", "convention", "components")


def settings_in_words(settings: WarpSettings, unit: str) -> tuple[tuple[str, str], ...]:
    """Return the settings as titles and words; what is as usual mostly goes without saying.

    Parameters
    ----------
    settings
        What is told.
    unit
        The unit of the meshes.

    Examples
    --------
    >>> settings_in_words(WarpSettings(2.5), "mm")
    (('Warping penalty', '2.5 mm'), ('Convention', 'regularising'), ('Applied', 'the full warp'))
    """
    told = []
    for field in fields(settings):
        value = getattr(settings, field.name)
        if field.name in _ALWAYS or value != getattr(USUAL_SETTINGS, field.name):
            title = _TITLES.get(field.name, field.name.replace("_", " ").capitalize())
            told.append((title, _words(field.name, value, settings, unit)))
    return tuple(told)


def _words(name: str, value: object, settings: WarpSettings, unit: str) -> str:
    match name, value:
        case "penalty", float():
            told = f"{value:.6g} {settings.penalty_unit(unit)}"
            return "infinite (the affine fit)" if math.isinf(value) else told
        case "basis", Basis():
            return value.formula
        case "components", _:
            return applied_in_words(settings)
        case "blend", float():
            return f"{value:.0%}"
        case _, bool():
            return "yes" if value else "no"
        case _, StrEnum():
            return value.value
        case _:
            return str(value)
