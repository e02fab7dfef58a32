"""What several commands ask for in the same words."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from pinwarp.core.components import Components
from pinwarp.session import edits
from pinwarp.session.session import Session
from pinwarp.version import __version__

SessionFile = Annotated[
    Path, typer.Argument(metavar="SESSION", help="A saved session (.pinwarp.csv).")
]
Penalty = Annotated[
    float | None,
    typer.Option(
        metavar="LENGTH",
        help="Warping penalty in the unit of the mesh, 0 to inf, instead of the session's.",
        show_default=False,
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


def _tell_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"pinwarp {__version__}")
        raise typer.Exit


Version = Annotated[
    bool,
    typer.Option("--version", callback=_tell_version, is_eager=True, help="Show the version."),
]


def with_options(
    session: Session, penalty: float | None, components: Components | None, blend: float | None
) -> Session:
    """Return the session with what was asked for on the command line.

    Raises
    ------
    PinwarpError
        When the penalty is negative, or the blend is not from 0 to 1.
    """
    if penalty is not None:
        session = edits.set_penalty(session, penalty)
    if components is not None:
        session = edits.set_components(session, components)
    return session if blend is None else edits.set_blend(session, blend)
