"""What the commands say: results on standard output, everything else beside it."""

from __future__ import annotations

import codecs
import json
import sys
from collections.abc import Iterable, Sequence
from io import TextIOWrapper
from pathlib import Path
from typing import Any

from pinwarp.core.errors import PinwarpError, readable

BAD_USAGE = 2
INTERRUPTED = 130

_SPELT = "pinwarp.spelt"
# What the program itself says beyond ASCII, and how one types it.
_TYPED = {
    "…": "...",
    "–": "-",
    "−": "-",
    "×": "x",
    "²": "^2",
    "µ": "u",
    "μ": "u",
    "±": "+/-",
    "°": " deg",
}


def spell_what_is_not_in_the_encoding() -> None:
    """Let both outputs take every letter: an old Windows encoding, or ASCII, has only some.

    Pipes and files have such an encoding on Windows, and where the locale says so.
    """
    codecs.register_error(_SPELT, _spelt)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors=_SPELT)


def _spelt(error: UnicodeError) -> tuple[str | bytes, int]:
    """Spell the first letter that could not be encoded, as :mod:`codecs` asks for it."""
    if not isinstance(error, UnicodeEncodeError):
        raise error
    letter, end = error.object[error.start], error.start + 1
    return _TYPED.get(letter) or letter.encode("ascii", "backslashreplace").decode(), end


def tell(words: str) -> None:
    """Say a result, at once."""
    # Not typer's echo: it writes UTF-8 where ASCII was asked for.
    print(words, flush=True)


def tell_json(value: Any) -> None:
    """Say a result to a program, in letters that every encoding has."""
    tell(json.dumps(value, indent=2, allow_nan=False))


def tell_error(words: str) -> None:
    """Say on one line what went wrong."""
    _tell_beside(f"pinwarp: {readable(' '.join(words.splitlines()))}")


def _tell_beside(words: str) -> None:
    print(words, file=sys.stderr, flush=True)


def tell_notes(notes: Iterable[str], about: str = "") -> None:
    """Say what the user should know beside the result, a line each."""
    for note in notes:
        _tell_beside(readable(f"{about}: {note}" if about else note))


def refuse_existing(outputs: Sequence[Path], force: bool) -> None:
    """Raise where an output is there already and replacing it was not asked for.

    Raises
    ------
    PinwarpError
        With the first of them and the way out.
    """
    there = [path for path in outputs if path.exists()]
    if there and not force:
        more = f" (and {len(there) - 1} more)" if len(there) > 1 else ""
        raise PinwarpError(f"{there[0]}{more} is there already: use --force to replace it.")
