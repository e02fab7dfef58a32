"""How the project's own files are called, and how files name others."""

from __future__ import annotations

import os
import re
from pathlib import Path

SESSION_SUFFIX = ".pinwarp.csv"
BACKUP_SUFFIX = ".bak"
MODEL_SUFFIX = ".osim"
STUDY_SUFFIX = ".pinwarp-model.csv"


def is_session(path: Path) -> bool:
    """Say by its name whether a file is a session.

    Examples
    --------
    >>> is_session(Path("left.pinwarp.csv")), is_session(Path("left.csv"))
    (True, False)
    """
    return path.name.lower().endswith(SESSION_SUFFIX)


def is_model_file(path: Path) -> bool:
    """Say by its name whether a file is a model of OpenSim or the study of one.

    Examples
    --------
    >>> [is_model_file(Path(name)) for name in ("leg.osim", "leg.pinwarp-model.csv", "leg.stl")]
    [True, True, False]
    """
    return path.name.lower().endswith((MODEL_SUFFIX, STUDY_SUFFIX))


def session_name(path: Path | None) -> str:
    """Return what a session is called by its file, or without one.

    Examples
    --------
    >>> session_name(Path("/bones/left femur.pinwarp.csv")), session_name(None)
    ('left femur', 'Untitled')
    """
    return path.name.removesuffix(SESSION_SUFFIX) if path is not None else "Untitled"


def backup_of(path: Path) -> Path:
    """Return where the previous version of a session is kept; file dialogs do not show it.

    Examples
    --------
    >>> backup_of(Path("left.pinwarp.csv")).name
    'left.pinwarp.csv.bak'
    """
    return path.with_name(path.name + BACKUP_SUFFIX)


def is_backup(path: Path) -> bool:
    """Say by its name whether a file is the previous version of another.

    Examples
    --------
    >>> is_backup(Path("left.pinwarp.csv.bak")), is_backup(Path("left.pinwarp.csv"))
    (True, False)
    """
    return path.name.lower().endswith(BACKUP_SUFFIX)


def as_spelt_here(text: str) -> str:
    """Return the name that a file gives to another as this system can look for it.

    Where the locale has too few letters, Python holds stand-ins for the bytes of a name.

    Raises
    ------
    ValueError
        When there is a zero in it, which would end the name for the system.

    Examples
    --------
    >>> as_spelt_here("left femur.stl")
    'left femur.stl'
    """
    try:
        known = os.fsencode(text)
    except UnicodeEncodeError:
        known = text.encode(errors="replace")
    if b"\0" in known:
        raise ValueError("no file's name holds a zero")
    return os.fsdecode(known)


def as_spelt_everywhere(name: str) -> str:
    """Return a name of this system's as it is written into a file, which may be read elsewhere.

    Examples
    --------
    >>> as_spelt_everywhere("left femur.stl")
    'left femur.stl'
    """
    try:
        # Stand-ins for bytes that are letters after all.
        return os.fsencode(name).decode()
    except UnicodeError:
        return name


def with_slashes(text: str, folder: Path) -> str:
    r"""Return the path that a text names, its parts parted as on this system.

    People write paths as Windows does, and open what they wrote elsewhere. Where a file's name
    truly holds a backslash, and the file is there, it is meant.

    Parameters
    ----------
    text
        As it is written in a file.
    folder
        From where it is seen.

    Examples
    --------
    >>> Path(with_slashes("bones\\femur.stl", Path("/study"))).name
    'femur.stl'
    """
    text = as_spelt_here(text)
    # On Windows both kinds part names, and lexists would only ask the disk for nothing.
    if "\\" not in text or os.sep == "\\" or os.path.lexists(folder / text):
        return text
    return text.replace("\\", "/")


def session_of_body(beside: Path, whole: str, body: str) -> Path:
    """Return where the session of a model's body is kept: beside the model or its study.

    Parameters
    ----------
    beside
        The file of the model, or of its study.
    whole, body
        How these are called; a model may call a body as no file can be.

    Examples
    --------
    >>> session_of_body(Path("leg.osim"), "leg", "femur:r").name
    'leg_femur_r.pinwarp.csv'
    """
    return beside.with_name(f"{whole}_{as_file_name(body)}{SESSION_SUFFIX}")


def as_file_name(name: str) -> str:
    """Return a name with what no file may be called by replaced.

    Examples
    --------
    >>> as_file_name("linea aspera: left/1"), as_file_name("..")
    ('linea_aspera_left_1', '_')
    """
    return re.sub(r"[^\w-]+", "_", name)[:80] or "_"
