"""What several commands ask for in the same words."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

import typer

from pinwarp.core.basis import Basis
from pinwarp.core.components import Components
from pinwarp.core.errors import PinwarpError
from pinwarp.session import edits
from pinwarp.session.session import Session

SessionFile = Annotated[
    Path, typer.Argument(metavar="SESSION", help="A saved session (.pinwarp.csv).")
]
Penalty = Annotated[
    float | None,
    typer.Option(
        metavar="LENGTH",
        help="Warping penalty in the unit of the mesh, 0 to inf, instead of the session's. With "
        "the basis r2logr in its square.",
        show_default=False,
    ),
]
BasisOption = Annotated[
    Basis | None,
    typer.Option(
        "--basis",
        metavar="BASIS",
        help="What the spline is built of, instead of what the session says: r, or r2logr for "
        "Bookstein's r² log r, to compare with results made elsewhere.",
        show_default=False,
        case_sensitive=False,
    ),
]
Applied = Annotated[
    Components | None,
    typer.Option(
        metavar="WHAT",
        help="What of the warp is applied, instead of what the session says: "
        f"{', '.join(part.value for part in Components)}.",
        show_default=False,
        case_sensitive=False,
    ),
]
Blend = Annotated[
    float | None,
    typer.Option(
        metavar="0..1",
        help="How far from the aligned source (0) to the components in full (1).",
        show_default=False,
    ),
]
Force = Annotated[bool, typer.Option("--force", help="Replace outputs that are there already.")]


def with_options(
    session: Session,
    penalty: float | None,
    components: Components | None,
    blend: float | None,
    basis: Basis | None = None,
) -> Session:
    """Return the session with what was asked for on the command line.

    Raises
    ------
    PinwarpError
        When the penalty is negative, the blend is not from 0 to 1, or with another basis the
        session's penalty says nothing.
    """
    if basis is not None:
        session = with_basis(session, basis, penalty)
    if penalty is not None:
        session = edits.set_penalty(session, penalty)
    if components is not None:
        session = edits.set_components(session, components)
    return session if blend is None else edits.set_blend(session, blend)


def with_basis(session: Session, basis: Basis, penalty: float | None = None) -> Session:
    """Return the session with another basis, where its penalty or the one given means something.

    Raises
    ------
    PinwarpError
        When the session's penalty was chosen for the other basis.
    """
    settings = session.settings
    if basis is settings.basis:
        return session
    if settings.planar:
        raise PinwarpError(
            "The session treats its landmarks as planar, which is for the basis r only."
        )
    if penalty is None and 0 < settings.penalty < math.inf:
        unit = settings.penalty_unit(session.unit)
        raise PinwarpError(
            f"The session's penalty of {settings.penalty:.6g} {unit} is for the basis "
            f"{settings.basis.formula}: say --penalty in {basis.penalty_unit(session.unit)}, too."
        )
    return edits.set_basis(session, basis)
