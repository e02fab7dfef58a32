"""The files shipped with the program: sample bones, icons and the user guide."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]


def assets_folder() -> Path:
    """Return the folder with what the program brings along.

    An installed pinwarp has it inside the package, a checkout beside ``src``.

    Examples
    --------
    >>> (assets_folder() / "icons" / "pinwarp.svg").is_file()
    True
    """
    inside = _PACKAGE / "assets"
    return inside if inside.is_dir() else _PACKAGE.parents[1] / "assets"


def sample_session() -> Path:
    """Return the session with the two sample femurs, their pairs and passengers.

    Examples
    --------
    >>> sample_session().name
    'femur_sample.pinwarp.csv'
    """
    return assets_folder() / "femur_sample.pinwarp.csv"


def sample_model() -> Path:
    """Return a small model of OpenSim: a leg with three muscles.

    Examples
    --------
    >>> sample_model().name
    'leg.osim'
    """
    return assets_folder() / "leg_model" / "leg.osim"


def help_folder() -> Path:
    """Return the folder with the pages of the user guide.

    Examples
    --------
    >>> len(list(help_folder().glob("*.md"))) > 5
    True
    """
    return _PACKAGE / "help"
