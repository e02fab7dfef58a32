"""What can go wrong, as one tree.

::

    PinwarpError
    ├── LandmarkError (ValueError)      coordinates, names or counts that cannot be used
    │   ├── LandmarkTypeError (TypeError)       not a table of three numbers a row
    │   └── LandmarkCountError (RuntimeError)   none, or a landmark without its counterpart
    ├── PenaltyError (ValueError)       a penalty that is negative or NaN
    │   └── PenaltyTypeError (TypeError)        not a number at all
    ├── SingularSystemError (RuntimeError)      the equations have no usable solution
    ├── RangeError (ArithmeticError)    a warp that no number can hold
    ├── MeshError (ValueError)          not a surface, or not a usable one
    ├── FileFormatError (ValueError)    a file that cannot be read; names file and line
    │   └── NewerFileError              written by a newer pinwarp
    └── Cancelled                       stopped by whoever asked for it

    PinwarpWarning (UserWarning)
    ├── ConflictingLandmarksWarning     one place on the source, two on the destination
    ├── NearlyPlanarWarning             the warp is unreliable far from the landmarks
    ├── PoleWarning                     an OPYNSIM penalty near or above a pole
    └── SideConditionsWarning           coefficients made elsewhere that are hardly a spline's
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

LONGEST = 1_000
"""More characters than anybody reads of one message."""


def readable(text: str) -> str:
    """Return a message, its middle cut out where it is too long to be read.

    Examples
    --------
    >>> readable("femur.csv: It is empty.")
    'femur.csv: It is empty.'
    >>> len(readable("a" * 1_000_000))
    1000
    """
    if len(text) <= LONGEST:
        return text
    # What is wrong stands at the beginning, what to do about it at the end.
    end = LONGEST // 3
    return f"{text[: LONGEST - end - 3]} … {text[-end:]}"


class PinwarpError(Exception):
    """Whatever pinwarp raises on purpose: its message is meant for the user, and cut for one.

    Examples
    --------
    >>> from pinwarp.tps3d import solve_coefficients
    >>> try:
    ...     solve_coefficients([[0, 0, 0]], [[0, 0, 1]], warping_penalty=-1)
    ... except PinwarpError as error:
    ...     print(error)
    The warping penalty is -1.0; it must be 0 or more.
    """

    def __str__(self) -> str:
        return readable(super().__str__())


class Cancelled(PinwarpError):
    """Something slow was stopped by whoever asked for it."""


class LandmarkError(PinwarpError, ValueError):
    """Landmarks that cannot be used; the message names the row or the landmark."""


class LandmarkTypeError(LandmarkError, TypeError):
    """Landmarks that are no table of three real numbers a row."""


class LandmarkCountError(LandmarkError, RuntimeError):
    """No landmarks, or not as many on either side."""


class PenaltyError(PinwarpError, ValueError):
    """A warping penalty that is negative or not a number, or a convention that is none."""


class PenaltyTypeError(PenaltyError, TypeError):
    """A warping penalty that is no real number: text, a list, a truth value."""


class SingularSystemError(PinwarpError, RuntimeError):
    """The spline's equations have no usable solution at this penalty."""


class RangeError(PinwarpError, ArithmeticError):
    """A warp that leaves the range of numbers; the message says where."""


class MeshError(PinwarpError, ValueError):
    """Arrays that do not make a triangle surface."""


class FileFormatError(PinwarpError, ValueError):
    """A file that cannot be read.

    Parameters
    ----------
    path
        The file.
    reason
        What is wrong with it and what to do about it, as one or two sentences.
    line
        The line it happened at, counted from 1, where there is one.
    """

    def __init__(self, path: str | Path, reason: str, line: int | None = None) -> None:
        self.path = Path(path)
        self.reason = readable(reason)
        self.line = line
        place = f"{self.path.name}, line {line}" if line is not None else self.path.name
        super().__init__(f"{place}: {self.reason}")

    def __reduce__(self) -> tuple[Any, ...]:
        # Its only argument would be the whole message, of which no other process can make it.
        return type(self), (self.path, self.reason, self.line)


class NewerFileError(FileFormatError):
    """A session written by a newer pinwarp: refused rather than half-read."""


def words_of(error: Exception) -> str:
    """Return what the user should read about an error.

    Examples
    --------
    >>> words_of(PermissionError(13, "Permission denied", "bone.stl"))
    'bone.stl: Permission denied.'
    """
    if isinstance(error, OSError) and error.strerror:
        return readable(f"{error.filename or 'The file'}: {error.strerror}.")
    return readable(str(error))


class PinwarpWarning(UserWarning):
    """A result that can be used but should be looked at.

    Examples
    --------
    >>> import warnings
    >>> from pinwarp.tps3d import solve_coefficients
    >>> with warnings.catch_warnings():
    ...     warnings.simplefilter("error", PinwarpWarning)
    ...     try:
    ...         solve_coefficients([[0, 0, 0], [0, 0, 0]], [[0, 0, 0], [1, 0, 0]])
    ...     except PinwarpWarning as warning:
    ...         print(type(warning).__name__)
    ConflictingLandmarksWarning
    """


class ConflictingLandmarksWarning(PinwarpWarning):
    """Landmarks at one place on the source that lie apart on the destination."""


class NearlyPlanarWarning(PinwarpWarning):
    """The source landmarks lie nearly in one plane."""


class SideConditionsWarning(PinwarpWarning):
    """Coefficients made elsewhere whose weights are hardly those of a spline."""


class PoleWarning(PinwarpWarning):
    """An OPYNSIM penalty so large that it no longer smooths."""
