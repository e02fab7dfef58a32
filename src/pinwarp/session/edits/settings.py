"""How the warp is solved and applied, and the unit it is told in."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pinwarp.core.basis import Basis
from pinwarp.core.components import Components
from pinwarp.core.factor import factorise
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import PenaltyConvention
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session.session import Session

__all__ = [
    "UNITS",
    "set_basis",
    "set_blend",
    "set_components",
    "set_convention",
    "set_penalty",
    "set_planar",
    "set_refinement",
    "set_unit",
]

UNITS = ("mm", "cm", "m")


def set_penalty(session: Session, penalty: float) -> Session:
    """Set the warping penalty, in mesh units; with the basis ``r^2 log r`` in their square.

    Raises
    ------
    PenaltyError
        When it is negative or NaN.
    """
    return _with(session, replace(session.settings, penalty=penalty))


def set_convention(session: Session, convention: PenaltyConvention) -> Session:
    """Choose the equation that the penalty enters."""
    return _with(session, replace(session.settings, convention=convention))


def set_basis(session: Session, basis: Basis) -> Session:
    """Choose what the spline is built of; the penalty leaves as much flexibility as before.

    A penalty of one basis is a length, of the other an area: the number alone says nothing. Nearly
    planar landmarks are treated as planar with the basis r only.
    """
    before = session.settings
    penalty = before.penalty
    source = np.array([pair.source for pair in session.pairs])
    if basis is not before.basis and 0 < penalty < np.inf and len(source):
        now, then = (factorise(source, basis=which) for which in (before.basis, basis))
        if len(now.poles):
            penalty = then.penalty_at(now.flexibility(penalty))
    planar = before.planar and basis is Basis.R
    return _with(session, replace(before, basis=basis, penalty=penalty, planar=planar))


def set_planar(session: Session, planar: bool) -> Session:
    """Treat nearly planar landmarks as planar, or not.

    Raises
    ------
    PinwarpError
        When the basis is another than r.
    """
    return _with(session, replace(session.settings, planar=planar))


def set_components(session: Session, components: Components) -> Session:
    """Choose what of the warp is applied, on the screen and in exports."""
    return _with(session, replace(session.settings, components=components))


def set_blend(session: Session, blend: float) -> Session:
    """Apply the components in part: 0 is the aligned source, 1 all of them.

    Raises
    ------
    PinwarpError
        When the blend is not from 0 to 1.
    """
    return _with(session, replace(session.settings, blend=blend))


def set_refinement(session: Session, refinement: RefinementRecord | None) -> Session:
    """Warp as a refinement does while it belongs to the session; None as the landmarks do."""
    return replace(session, refinement=refinement)


def set_unit(session: Session, unit: str) -> Session:
    """Name the unit of the meshes."""
    return replace(session, unit=unit)


def _with(session: Session, settings: WarpSettings) -> Session:
    return replace(session, settings=settings)
