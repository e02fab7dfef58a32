"""How an output came about: program, session and settings, told in the output itself."""

from __future__ import annotations

from dataclasses import replace

from pinwarp.core.landmarks import Side
from pinwarp.core.words import counted
from pinwarp.io.session_file import session_text
from pinwarp.session.session import Session, to_record
from pinwarp.session.warp.fingerprint import fingerprint, mesh_parts
from pinwarp.session.warp.refined import refinement_in_words
from pinwarp.session.warp.setting_words import settings_in_words
from pinwarp.version import __version__


def session_hash(session: Session) -> str:
    """Return a hash of all that a session holds, wherever its files are.

    Meshes count by their content and not by their name. Where semilandmarks have come to rest
    follows from the rest and does not count.

    Examples
    --------
    >>> session_hash(Session())[:7]
    'sha256:'
    """
    record = replace(to_record(session), source_mesh=None, destination_mesh=None, slid=None)
    return fingerprint((session_text(record), *mesh_parts(session)))


def provenance(session: Session) -> tuple[str, ...]:
    """Return how what leaves a session came about, a line each: what others need to repeat it.

    Parameters
    ----------
    session
        As it was when the output was made.

    Returns
    -------
    tuple of str
        The program and the session's hash first: some formats have room for one line.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> print(provenance(read_session(sample_session()))[1])
    16 pairs. Warping penalty: 0 mm. Convention: regularising. Applied: the full warp
    """
    told = [counted(len(session.pairs), "pair")]
    if session.groups:
        told.append(counted(len(session.groups), "curve or patch", "curves and patches"))
    settings = settings_in_words(session.settings, session.unit)
    told += [f"{title}: {words}" for title, words in settings]
    if refined := refinement_in_words(session):
        told.append(refined)
    return (
        f"Made by pinwarp {__version__}, session {session_hash(session)}",
        ". ".join(told),
        *(
            f"{side.value.capitalize()}: {file.path.name}, SHA-256 {file.sha256}"
            for side in Side
            if (file := session.mesh_file(side)) is not None
        ),
    )
