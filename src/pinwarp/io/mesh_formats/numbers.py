"""Numbers as programs of other languages write them in text."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

_NOT_A_NUMBER = re.compile(rb"[-+]?(?:1\.#[a-z]+\d*|nan\([^)\s]*\))", re.I)
_FORTRAN = re.compile(rb"(\d\.?)[dD]([-+]?\d)")


def mended(text: bytes) -> bytes:
    """Return text with its numbers as Python reads them.

    Fortran writes the exponent of a double as D, and what Microsoft's libraries write for no
    number is several words.

    Parameters
    ----------
    text
        Numbers among other words. To be asked only where they could not be read.

    Examples
    --------
    >>> mended(b"v 1.5D+00 -1.#IND00 nan(ind)")
    b'v 1.5e+00 nan nan'
    """
    return _FORTRAN.sub(rb"\1e\2", _NOT_A_NUMBER.sub(b"nan", text))


def numbers_of(
    words: Sequence[bytes], kind: np.dtype[np.generic] | type[np.generic] = np.float64
) -> NDArray[np.generic]:
    """Return words as numbers, mended where that is needed.

    Parameters
    ----------
    words
        One number each.
    kind
        Of which type.

    Raises
    ------
    ValueError, OverflowError
        When one is no number of that type.

    Examples
    --------
    >>> numbers_of([b"1.5", b"2d1"]).tolist()
    [1.5, 20.0]
    """
    try:
        return np.array(words, dtype=kind)
    except ValueError:
        return np.array([mended(word) for word in words], dtype=kind)
