"""The coefficients of a warp in a file that a stranger can evaluate: JSON or NumPy's .npz."""

from __future__ import annotations

import io
import json
import math
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.basis import Basis
from pinwarp.core.errors import FileFormatError, PinwarpError
from pinwarp.core.settings import USUAL_SETTINGS, WarpSettings
from pinwarp.core.spline import Spline
from pinwarp.io.atomic import atomic_path
from pinwarp.io.csv_cells import shortened
from pinwarp.io.json_text import read_json
from pinwarp.io.reading import read_content
from pinwarp.io.setting_keys import plain_settings, settings_of

COEFFICIENT_SUFFIXES = (".json", ".npz")
FORMAT = "pinwarp-coefficients"
# Told apart by readers; raised when an older reader would misread.
FORMAT_VERSION = 2
# With the basis r, older ones read rightly.
_FORMAT_OF = {Basis.R: 1, Basis.R2_LOG_R: 2}
_TERMS = {
    Basis.R: ("|u_i - v|", "U(r) = +r"),
    Basis.R2_LOG_R: (
        "U(|u_i - v|)",
        "U(r) = +r^2 log r, with the natural logarithm and U(0) = 0",
    ),
}
EQUATION = (
    "f(v) = a1 + a2 * v_x + a3 * v_y + a4 * v_z + sum over i of w_i * {term}, where v is a "
    "place of the source, u_i are the rows of source_landmarks, w_i the rows of weights, a1 to "
    "a4 the rows of affine, and |.| is the Euclidean length. The basis is {basis}. f(v) is in "
    "the frame and unit of the destination; with the components 'without pose' it is in the "
    "frame of the source. No penalty and no blend is to be added: they are in the coefficients. "
    "A mesh that is scaled is multiplied by that number first; one that is mirrored across an "
    "axis is then mirrored about the middle of its bounds."
)

# A landmark takes some hundred bytes, whichever way it is written.
_LARGEST = 64 << 20
_ARRAYS = ("source_landmarks", "weights", "affine")
_TEXTS = (
    "unit",
    "source_sha256",
    "destination_sha256",
    "source_mirrored",
    "destination_mirrored",
    "pinwarp",
)


_DAMAGE = (
    KeyError,
    ValueError,
    TypeError,
    ArithmeticError,
    OSError,
    EOFError,
    NotImplementedError,
    RuntimeError,
    MemoryError,
    zipfile.BadZipFile,
    zlib.error,
)
"""What Python and numpy raise over bytes that are no coefficients."""


@dataclass(frozen=True, eq=False)
class Coefficients:
    """A solved warp and what explains it.

    Parameters
    ----------
    spline
        The warp as applied: its landmarks, weights for the basis and affine rows ``a1 ... a4``.
    names
        Of the landmarks, row by row.
    unit
        Of both meshes.
    settings
        How it was solved, and what of it this is.
    source_sha256, destination_sha256
        The hashes of the mesh files; empty where there was none.
    source_mirrored, destination_mirrored
        The axes across which a mesh is mirrored after reading, such as ``"x"``.
    source_scaled, destination_scaled
        What the coordinates of a mesh are multiplied by after reading.
    version
        The pinwarp that wrote it.
    session
        The hash of the session that it is of; empty where it is of none.
    """

    spline: Spline
    names: tuple[str, ...]
    unit: str = ""
    settings: WarpSettings = USUAL_SETTINGS
    source_sha256: str = ""
    destination_sha256: str = ""
    source_mirrored: str = ""
    destination_mirrored: str = ""
    source_scaled: float = 1.0
    destination_scaled: float = 1.0
    version: str = ""
    session: str = ""


def write_coefficients(path: str | Path, coefficients: Coefficients) -> None:
    """Write coefficients as JSON or .npz, by the file's suffix; every number exactly.

    Parameters
    ----------
    path
        The file. JSON has lists of numbers, and an infinite penalty as the text ``"infinity"``;
        .npz has arrays, and single values as arrays without dimensions. Names are the same.
    coefficients
        What is written.

    Raises
    ------
    FileFormatError
        When the suffix is another.
    OSError
        When the file cannot be written; an older one is untouched.

    Examples
    --------
    >>> import tempfile
    >>> from pinwarp.core.spline import factorise, solve
    >>> spline = solve(factorise([[0, 0, 0]]), [[1, 2, 3]])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "shift.json")
    ...     write_coefficients(path, Coefficients(spline, ("apex",), "mm"))
    ...     read_coefficients(path).spline.affine.tolist()
    [[1.0, 2.0, 3.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    suffix = _suffix(path)
    fields = _fields(coefficients)
    with atomic_path(path) as temporary:
        if suffix == ".json":
            temporary.write_text(_json(fields), encoding="utf-8")
        else:
            arrays: dict[str, Any] = {key: np.array(value) for key, value in fields.items()}
            with temporary.open("wb") as file:
                np.savez(file, **arrays)


def read_coefficients(path: str | Path) -> Coefficients:
    """Read what :func:`write_coefficients` wrote.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    Coefficients

    Raises
    ------
    FileFormatError
        When the file is missing, of another kind, of a newer version, or damaged.
    """
    read = _read_json if _suffix(path) == ".json" else _read_npz
    content = read_content(path, what="coefficients", largest=_LARGEST)
    try:
        return _coefficients(read(content.data))
    except FileFormatError:
        raise
    except (*_DAMAGE, PinwarpError) as error:
        reason = f"{error.args[0]!r} is missing" if isinstance(error, KeyError) else str(error)
        raise FileFormatError(
            path, f"These are no coefficients of a warp ({reason}). Export them again."
        ) from error


def equation_of(basis: Basis) -> str:
    """Return the equation of a warp in words and signs that any program can follow.

    Examples
    --------
    >>> "The basis is U(r) = +r." in equation_of(Basis.R)
    True
    """
    term, name = _TERMS[basis]
    return EQUATION.format(term=term, basis=name)


def _suffix(path: str | Path) -> str:
    suffix = Path(path).suffix.lower()
    if suffix not in COEFFICIENT_SUFFIXES:
        raise FileFormatError(
            path,
            f"Coefficients of the type {suffix or 'without a suffix'!r} are not supported. "
            f"Choose one of {', '.join(COEFFICIENT_SUFFIXES)}.",
        )
    return suffix


def _fields(coefficients: Coefficients) -> dict[str, Any]:
    """Return all that is written, in the order in which a person wants to read it."""
    spline = coefficients.spline
    return {
        "format": FORMAT,
        "format_version": _FORMAT_OF[spline.basis],
        "pinwarp": coefficients.version,
        "session": coefficients.session,
        "equation": equation_of(spline.basis),
        "unit": coefficients.unit,
        **plain_settings(coefficients.settings),
        "source_sha256": coefficients.source_sha256,
        "source_scaled": float(coefficients.source_scaled),
        "source_mirrored": coefficients.source_mirrored,
        "destination_sha256": coefficients.destination_sha256,
        "destination_scaled": float(coefficients.destination_scaled),
        "destination_mirrored": coefficients.destination_mirrored,
        "names": list(coefficients.names),
        "affine": spline.affine.tolist(),
        "source_landmarks": spline.source.tolist(),
        "weights": spline.weights.tolist(),
    }


def _json(fields: Mapping[str, Any]) -> str:
    """Return JSON with a landmark per line; Python writes the shortest exact numbers."""
    penalty = fields["warping_penalty"]
    # JSON knows no infinity.
    written = {**fields, "warping_penalty": "infinity" if math.isinf(penalty) else penalty}
    lines = []
    for key, value in written.items():
        if isinstance(value, list):
            rows = ",\n    ".join(json.dumps(row, ensure_ascii=False) for row in value)
            lines.append(f"  {json.dumps(key)}: [\n    {rows}\n  ]")
        else:
            lines.append(f"  {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def _read_json(data: bytes) -> dict[str, Any]:
    fields, repeated = read_json(data.decode("utf-8"))
    if not isinstance(fields, dict):
        raise ValueError("it is not an object")
    if repeated:
        # Which of the two was meant, nobody knows; a wrong warp would look like any other.
        raise ValueError(f"{shortened(repeated[0])} is there twice")
    return fields


def _read_npz(data: bytes) -> dict[str, Any]:
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        if sum(entry.file_size for entry in archive.infolist()) > _LARGEST:
            raise ValueError("it unpacks to more than any warp has")
    # Without pickles: a file from a stranger must not run code.
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        return {key: file[key].tolist() for key in file.files}


def _coefficients(fields: Mapping[str, Any]) -> Coefficients:
    if fields["format"] != FORMAT:
        raise ValueError(f"its format is {fields['format']!r}")
    if int(fields["format_version"]) > FORMAT_VERSION:
        raise ValueError("it was written by a newer pinwarp")
    names = tuple(str(name) for name in fields["names"])
    arrays = {key: np.array(fields[key], dtype=np.float64) for key in _ARRAYS}
    texts = {key: str(fields[key]) for key in _TEXTS}
    rows = {"affine": 4, "source_landmarks": len(names), "weights": len(names)}
    for key, array in arrays.items():
        _check(key, array, rows[key])
    settings = settings_of(fields)
    spline = Spline(
        source=arrays["source_landmarks"],
        weights=arrays["weights"],
        affine=arrays["affine"],
        penalty=settings.penalty,
        convention=settings.convention,
        basis=settings.basis,
    )
    return Coefficients(
        spline=spline,
        names=names,
        unit=texts["unit"],
        settings=settings,
        source_sha256=texts["source_sha256"],
        destination_sha256=texts["destination_sha256"],
        source_mirrored=texts["source_mirrored"],
        destination_mirrored=texts["destination_mirrored"],
        source_scaled=float(fields["source_scaled"]),
        destination_scaled=float(fields["destination_scaled"]),
        version=texts["pinwarp"],
        # Older files do not say it.
        session=str(fields.get("session", "")),
    )


def _check(key: str, array: NDArray[np.float64], rows: int) -> None:
    if array.shape != (rows, 3):
        raise ValueError(f"{key!r} has the shape {array.shape} instead of ({rows}, 3)")
    if not np.isfinite(array).all():
        raise ValueError(f"{key!r} has numbers that are not finite")
