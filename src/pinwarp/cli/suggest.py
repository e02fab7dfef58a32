"""``pinwarp suggest``: place the landmarks that are missing on the destination, marked as such."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from pinwarp.cli.bars import stage_bar
from pinwarp.cli.options import Force, SessionFile
from pinwarp.cli.telling import refuse_existing, tell, tell_error, tell_json, tell_notes
from pinwarp.core.errors import words_of
from pinwarp.core.first_guess import FirstGuess, Verdict
from pinwarp.core.lengths import Ruler
from pinwarp.core.pose import Mirror, PoseSettings
from pinwarp.core.words import counted, some_of
from pinwarp.io.backup import write_keeping_previous
from pinwarp.session import suggesting
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.suggesting import SuggestedPlace

NOTHING, ASKED = 1, 3

MirrorOption = Annotated[
    Mirror,
    typer.Option(
        metavar="ask|no|yes",
        help="Whether the destination is the other side of the body: found out, and asked about "
        "where the shapes do not tell; known not to be; known to be.",
        case_sensitive=False,
    ),
]
Partial = Annotated[
    bool,
    typer.Option(
        "--partial",
        help="The destination is only a part of the bone, as of a scan that ends. The units of "
        "the two meshes must be the same, or a thousand apart.",
    ),
]


def suggest(
    session: SessionFile,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help="Where the session with the suggestions goes; without it into SESSION itself, "
            "whose last version stays beside it as SESSION.bak.",
            show_default=False,
        ),
    ] = None,
    mirror: MirrorOption = Mirror.ASK,
    partial: Partial = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print figures for a program.")] = False,
    force: Force = False,
) -> None:
    """Suggest every landmark that is missing on the destination, from the shapes of the bones.

    Each is noted as "suggested" until somebody has looked at it: in the window Space confirms
    one and goes on to the next. Pairs that are there already are met.

    The exit code is 0 where the suggestions were written, 3 where the shapes leave open which
    side of the body or which way round is meant, and 1 where they tell nothing. Nothing is
    written then.
    """
    if out is not None:
        refuse_existing([out], force)
    target = session if out is None else out
    opened = read_session(session)
    with stage_bar() as progress:
        guess = suggesting.suggest(
            suggesting.SuggestInputs.of(opened), PoseSettings(mirror, partial), progress=progress
        )
    if guess.verdict is not Verdict.SURE:
        if as_json:
            tell_json(_figures(guess))
        tell_error(_undecided(guess))
        raise typer.Exit(ASKED if guess.verdict is Verdict.ASK else NOTHING)
    turned, reading = suggesting.mirrored_first(opened, guess.readings[0])
    ghosts = suggesting.ghosts_of(reading, turned)
    placed = suggesting.with_ghosts(turned, ghosts)
    beyond = [landmark.name for landmark in suggesting.missing_of(placed)]
    problem = write_keeping_previous(target, lambda path: write_session(path, placed))
    if problem is not None:
        tell_notes([f"The previous version was not kept: {words_of(problem)}"], target.name)
    tell_notes(_notes(guess, beyond))
    if as_json:
        found = _figures(guess) | {
            "unit": placed.unit,
            "doubt": ghosts[0].radius if ghosts else None,
            "suggested": {ghost.name: ghost.position for ghost in ghosts},
            "beyond_the_rim": beyond,
        }
        tell_json(found)
        return
    for label, words in _lines(guess, ghosts, placed.unit):
        tell(f"{label:<22}{words}")
    tell(f"Wrote {target}")


def _undecided(guess: FirstGuess) -> str:
    """Say why nothing was written, and what decides."""
    words = f"Nothing was written. {guess.words}"
    if guess.verdict is Verdict.NONE:
        return words
    if any(reading.mirrored != guess.readings[0].mirrored for reading in guess.readings):
        return f"{words} Decide with --mirror no (the same side) or --mirror yes (the other)."
    return f"{words} Place three pairs in the window, or choose there between the pictures."


def _notes(guess: FirstGuess, beyond: list[str]) -> list[str]:
    notes = []
    if guess.readings[0].mirrored:
        notes.append("The destination is the other side of the body: the source was mirrored.")
    if beyond:
        notes.append(
            f"{counted(len(beyond), 'landmark')} would lie beyond the rim of the destination and "
            f"{'was' if len(beyond) == 1 else 'were'} left out: {some_of(beyond)}."
        )
    return notes


def _lines(
    guess: FirstGuess, ghosts: tuple[SuggestedPlace, ...], unit: str
) -> list[tuple[str, str]]:
    lines = [
        ("Suggested", f"{counted(len(ghosts), 'landmark')}: look at each, in the window by Space"),
        ("Surfaces apart", f"{guess.fit:.1%} of the bone's size, as a mean"),
        ("The other side fits", _worse(guess.other_hand)),
        ("Another way round", _worse(guess.other_pose)),
    ]
    if ghosts:
        lines.insert(1, ("Doubt of each", Ruler(unit).text(ghosts[0].radius, 3)))
    return lines


def _worse(ratio: float) -> str:
    return f"{ratio:.2f} times as badly" if math.isfinite(ratio) else "nowhere near, or not asked"


def _figures(guess: FirstGuess) -> dict[str, Any]:
    return {
        "verdict": guess.verdict.value,
        "words": guess.words,
        "mirrored": guess.readings[0].mirrored if guess.readings else None,
        "fit": _known(guess.fit),
        "other_hand": _known(guess.other_hand),
        "other_pose": _known(guess.other_pose),
    }


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
