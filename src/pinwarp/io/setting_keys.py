"""The settings of a warp in files: what each is called there and how it is written."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import fields
from enum import StrEnum
from typing import Any, NamedTuple

from pinwarp.core.basis import Basis
from pinwarp.core.components import Components
from pinwarp.core.settings import USUAL_SETTINGS, WarpSettings
from pinwarp.core.spline import PenaltyConvention
from pinwarp.io.csv_cells import YES_NO, number_of, shortened


def penalty_of(text: str, separator: str = ",") -> float:
    """Read a warping penalty; ``inf`` is the affine fit.

    Raises
    ------
    ValueError
        With the reason as its message.

    Examples
    --------
    >>> penalty_of("0.0042"), penalty_of("inf"), penalty_of("0,5", ";")
    (0.0042, inf, 0.5)
    """
    if text.lower() == "inf":
        return math.inf
    value = number_of(text, separator)
    if value < 0:
        raise ValueError(f"the warping penalty {text} is negative")
    return value


def _convention(text: str) -> PenaltyConvention:
    if text not in set(PenaltyConvention):
        raise ValueError(
            f"the convention {shortened(text)} is none of {', '.join(PenaltyConvention)}"
        )
    return PenaltyConvention(text)


def _components(text: str) -> Components:
    if text not in set(Components):
        raise ValueError(f"the components {shortened(text)} are none of {', '.join(Components)}")
    return Components(text)


def _basis(text: str) -> Basis:
    if text not in set(Basis):
        raise ValueError(f"the basis {shortened(text)} is none of {', '.join(Basis)}")
    return Basis(text)


def _blend(text: str) -> float:
    value = number_of(text, ",")
    if not 0 <= value <= 1:
        raise ValueError(f"the blend {text} is not from 0 to 1")
    return value


def _planar(text: str) -> bool:
    if text.lower() not in YES_NO:
        raise ValueError(f"treat_as_planar is {shortened(text)} and neither yes nor no")
    return YES_NO[text.lower()]


class SettingKey(NamedTuple):
    """How a setting is kept in the header of a session.

    Attributes
    ----------
    field
        Of :class:`~pinwarp.core.settings.WarpSettings`.
    read
        Returns the value of a text, or raises a ValueError with the reason.
    always
        Whether it is written where it is as usual; most files need no word about the others.
    """

    field: str
    read: Callable[[str], Any]
    always: bool = False


SETTING_KEYS = {
    "warping_penalty": SettingKey("penalty", penalty_of, always=True),
    "penalty_convention": SettingKey("convention", _convention, always=True),
    "treat_as_planar": SettingKey("planar", _planar),
    "components": SettingKey("components", _components),
    "blend": SettingKey("blend", _blend),
    "basis": SettingKey("basis", _basis),
}
# What older files do not say was as usual.
_NEWER = frozenset({"basis"})
# Files of coefficients and figures call them by their fields, but for these.
_PLAIN_NAMES = {"penalty": "warping_penalty", "convention": "penalty_convention"}


def setting_lines(settings: WarpSettings, *, always: bool) -> Iterable[tuple[str, str]]:
    """Return key and text of those settings that are always written, or of the others.

    Examples
    --------
    >>> list(setting_lines(WarpSettings(planar=True), always=False))
    [('treat_as_planar', 'yes')]
    """
    for key, (field, _, is_always) in SETTING_KEYS.items():
        value = getattr(settings, field)
        if is_always is always and (always or value != getattr(USUAL_SETTINGS, field)):
            yield key, _text(value)


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return str(value) if isinstance(value, StrEnum) else repr(value)


def plain_settings(settings: WarpSettings) -> dict[str, float | bool | str]:
    """Return the settings as plain values, by the names that they have in JSON.

    Examples
    --------
    >>> plain_settings(WarpSettings(planar=True))["penalty_convention"]
    'regularising'
    """
    found = {
        _PLAIN_NAMES.get(field.name, field.name): getattr(settings, field.name)
        for field in fields(settings)
    }
    return {
        key: value.value if isinstance(value, StrEnum) else value for key, value in found.items()
    }


def settings_of(plain: Mapping[str, Any]) -> WarpSettings:
    """Return what :func:`plain_settings` took apart; numbers may come as text.

    Raises
    ------
    KeyError, ValueError, TypeError, PinwarpError
        When one is missing, or is no such setting.

    Examples
    --------
    >>> settings_of(plain_settings(WarpSettings(blend=0.5))).blend
    0.5
    """
    return WarpSettings(
        **{
            # An enum, a number or a bool is made by its kind.
            field.name: type(getattr(USUAL_SETTINGS, field.name))(
                plain[_PLAIN_NAMES.get(field.name, field.name)]
            )
            for field in fields(WarpSettings)
            if field.name in plain or field.name not in _NEWER
        }
    )
