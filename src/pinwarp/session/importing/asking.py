"""Whether an import leaves something to ask or tell before it is done."""

from __future__ import annotations

from pinwarp.core.names import look_alikes
from pinwarp.session.importing.landmarks import (
    Arriving,
    Fate,
    ImportChoice,
    Pairing,
    arrivals,
    awaiting,
    default_pairing,
    is_paired,
)
from pinwarp.session.session import Session

# So many landmarks are seldom placed by hand: where none lies on the mesh they are none.
MANY = 100


def doubts_of(session: Session, arriving: Arriving) -> tuple[str, ...]:
    """Say what makes one doubt that a file holds landmarks at all, as sentences.

    Parameters
    ----------
    session
        Its meshes tell how far off so many landmarks may be.
    arriving
        The file.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.core.landmarks import Landmark, Side
    >>> from pinwarp.io.landmark_files import LandmarkReading
    >>> reading = LandmarkReading((Landmark("a", (1, 2, 3)),), False, (), doubts=("It is a log.",))
    >>> doubts_of(Session(), Arriving(Path("a.csv"), reading, Side.SOURCE))
    ('It is a log.',)
    """
    doubts = list(arriving.reading.doubts)
    for side, fits in arriving.fits.items():
        mesh = session.mesh(side)
        if mesh is None or len(fits) != 1 or len(arriving.landmarks) < MANY:
            continue
        if fits[0].distance > mesh.diagonal:
            doubts.append(
                f"{len(arriving.landmarks):,} landmarks, and most of them lie farther from the "
                f"{side.value} mesh than it is long."
            )
    return tuple(doubts)


def brings_strangers(session: Session, arriving: Arriving) -> bool:
    """Whether a file for one side names landmarks that are not here, where all is paired.

    They would be halves that wait for ever, so that somebody has to say what they are.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.core.landmarks import Landmark, Side
    >>> from pinwarp.io.landmark_files import LandmarkReading
    >>> session = Session(landmarks=(Landmark("head", (1, 2, 3), (4, 5, 6)),))
    >>> reading = LandmarkReading((Landmark("soleus", (1, 2, 3)),), False, ())
    >>> brings_strangers(session, Arriving(Path("a.csv"), reading, Side.SOURCE))
    True
    """
    return (
        arriving.side is not None
        and is_paired(session)
        and any(session.landmark(landmark.name) is None for landmark in arriving.landmarks)
    )


def is_plain(session: Session, arriving: Arriving) -> bool:
    """Whether an import leaves nothing to ask and nothing to tell before it is done.

    That is a whole file without remarks, whose positions lie as well on the mesh as any, and
    whose landmarks all match ones that wait for a position, or are all new where there is nothing
    yet that they could have been meant for.
    """
    reading = arriving.reading
    # What becomes of curves is worth a look.
    if reading.skipped or reading.notes or reading.groups or arriving.doubtful:
        return False
    if doubts_of(session, arriving):
        return False
    if default_pairing(session, arriving) is not Pairing.BY_NAME:
        return False
    fates = {x.fate for x in arrivals(session, arriving, ImportChoice(Pairing.BY_NAME))}
    if Fate.REPLACES in fates:
        return False
    if look_alikes(x.name for x in (*session.landmarks, *reading.landmarks)):
        return False
    if fates == {Fate.NEW}:
        # Where pairs are there already they may be halves that wait for ever.
        has_pairs = any(x.is_complete for x in session.landmarks)
        return arriving.side is None or not (has_pairs or awaiting(session, arriving.side))
    return Fate.NEW not in fates
