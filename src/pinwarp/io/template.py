"""Templates: lists of names to be placed, from any file that has landmarks' names in it."""

from __future__ import annotations

from pathlib import Path

from pinwarp.core.errors import FileFormatError
from pinwarp.core.landmarks import Side
from pinwarp.io.file_names import is_session
from pinwarp.io.landmark_files import read_landmarks, recognised
from pinwarp.io.session_file import read_session
from pinwarp.io.text import lines_of, read_text


def read_template(path: Path) -> tuple[str, ...]:
    r"""Return the names in a session, a landmark file, or a text with one name a line.

    Parameters
    ----------
    path
        The file. In a plain text blank lines and lines that start with ``#`` are passed over.

    Raises
    ------
    FileFormatError
        When there is no name in it.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "femur.txt")
    ...     _ = path.write_text("# proximal\nfovea\nlesser_trochanter\n")
    ...     read_template(path)
    ('fovea', 'lesser_trochanter')
    """
    if is_session(path):
        return tuple(landmark.name for landmark in read_session(path).landmarks)
    text = read_text(path, "template")
    lines = [line.strip() for line in lines_of(text)]
    names = [line for line in lines if line and not line.startswith("#")]
    if recognised(text) or any(separator in line for line in names for separator in ",;\t"):
        return tuple(x.name for x in read_landmarks(path, Side.SOURCE).landmarks)
    if not names:
        raise FileFormatError(path, "There is no name in it. Write one name on each line.")
    return tuple(dict.fromkeys(names))
