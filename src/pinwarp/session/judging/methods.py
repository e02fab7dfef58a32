"""The paragraph that a paper needs about a warp: what was done, by which equation, with what."""

from __future__ import annotations

import math
import platform

import numpy as np
import scipy

from pinwarp.core.basis import Basis
from pinwarp.core.landmarks import Side
from pinwarp.core.lengths import Ruler
from pinwarp.core.spline import PenaltyConvention
from pinwarp.core.words import counted
from pinwarp.io.meshes import MeshFile
from pinwarp.session.judging.quality import Quality
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session
from pinwarp.session.warp.provenance import session_hash
from pinwarp.session.warp.refined import refinement_in_use, warp_in_words
from pinwarp.session.warp.slid_words import semilandmarks_in_words
from pinwarp.session.warp.solved import SolvedWarp
from pinwarp.version import __version__

_SPLINE = (
    "thin-plate spline, f(v) = a1 + a2 v_x + a3 v_y + a4 v_z + Σ w_i U(|u_i − v|) with the basis"
)
_BASES = {
    Basis.R: (
        f"by a three-dimensional {_SPLINE} U(r) = r (Bookstein 1989; Gunz, Mitteroecker and "
        "Bookstein 2005)"
    ),
    Basis.R2_LOG_R: (
        f"by a {_SPLINE} U(r) = r² log r, which is that of two dimensions (Bookstein 1989), "
        "applied in three"
    ),
}
_PENALISED = {
    PenaltyConvention.REGULARISING: (
        "was subtracted from the diagonal of the kernel matrix (K − sI, which penalises bending; "
        "Wahba 1990)"
    ),
    PenaltyConvention.OPYNSIM: (
        "was added to the diagonal of the kernel matrix (K + αI, the equation as published with "
        "OPynSim, which does not smooth with this basis)"
    ),
}
_ADDED = (
    "was added to the diagonal of the kernel matrix (K + sI, which penalises bending with this "
    "basis; Wahba 1990)"
)
REFERENCES = (
    "Bookstein FL (1989). Principal warps: thin-plate splines and the decomposition of "
    "deformations. IEEE Trans Pattern Anal Mach Intell 11, 567–585.",
    "Gunz P, Mitteroecker P, Bookstein FL (2005). Semilandmarks in three dimensions. In: Modern "
    "Morphometrics in Physical Anthropology, 73–98.",
    "Wahba G (1990). Spline Models for Observational Data. SIAM.",
)


def methods_of(warp: SolvedWarp, quality: Quality) -> tuple[str, ...]:
    """Return what a paper says about a warp, and what it cites, a paragraph each.

    Parameters
    ----------
    warp
        The session, solved.
    quality
        What its pairs say about one another.

    Returns
    -------
    tuple of str
        The paragraph of methods first, then the references, the program itself last.

    Examples
    --------
    >>> from pinwarp.io.samples import sample_session
    >>> from pinwarp.session.keeping.files import read_session
    >>> from pinwarp.session.judging.quality import quality_of
    >>> from pinwarp.session.warp.solved import solved
    >>> warp = solved(read_session(sample_session()))
    >>> methods_of(warp, quality_of(warp.result))[0].split(" (")[0]
    'A source surface'
    """
    session = warp.session
    basis = _BASES[session.settings.basis]
    sentences = [
        f"{_surface(session, Side.SOURCE)} was warped to {_destination(session)} {basis}, solved "
        f"from {counted(len(session.pairs), 'pair')} of homologous landmarks.",
        _penalty(session),
        *_further(warp),
        *_applied(session),
        *_errors(quality, rulers_of(session).session),
        f"This was done with pinwarp {__version__} (Python {platform.python_version()}, numpy "
        f"{np.__version__}, scipy {scipy.__version__}; session {session_hash(session)}).",
    ]
    words = " ".join(sentences)
    cited = [work for work in REFERENCES if work.partition(" ")[0] in words]
    program = f"The pinwarp developers. pinwarp, version {__version__} [computer program]."
    return (words, *cited, program)


def _surface(session: Session, side: Side) -> str:
    file = session.mesh_file(side)
    if file is None:
        return f"A set of {side.value} points" if side is Side.SOURCE else "landmarks"
    size = f", {len(file.mesh.vertices):,} vertices" if isinstance(file, MeshFile) else ""
    article = "A" if side is Side.SOURCE else "a"
    return f"{article} {side.value} surface ({file.path.name}{size})"


def _destination(session: Session) -> str:
    surface = _surface(session, Side.DESTINATION)
    return surface if session.destination is not None else f"{surface} without a surface"


def _penalty(session: Session) -> str:
    settings = session.settings
    if math.isinf(settings.penalty):
        return "The warping penalty was infinite, which leaves the affine fit by least squares."
    if settings.penalty == 0:
        return "Without a penalty, the warp meets every landmark."
    unit = settings.penalty_unit(session.unit)
    entered = _PENALISED[settings.convention] if settings.basis is Basis.R else _ADDED
    return f"A warping penalty of {settings.penalty:.6g} {unit} {entered}."


def _further(warp: SolvedWarp) -> list[str]:
    session, found = warp.session, []
    if words := semilandmarks_in_words(warp.result):
        found.append(f"With them went {words}, which slid to where the bending energy is least.")
    refined = refinement_in_use(session)
    if refined is not None:
        found.append(
            f"The warp was then refined to the destination's surface by "
            f"{counted(warp.fitted or 0, 'place')}, features larger than "
            f"{rulers_of(session).session.text(refined.smallest_feature)} first."
        )
    return found


def _applied(session: Session) -> list[str]:
    return [] if session.settings.is_whole else [f"Of it was applied: {warp_in_words(session)}."]


def _errors(quality: Quality, ruler: Ruler) -> list[str]:
    left_out = quality.left_out
    if left_out is None or not np.isfinite(left_out.rms):
        return []
    # Pairs that alone fix a direction of the affine part have none.
    distances = left_out.distances[np.isfinite(left_out.distances)]
    return [
        f"The leave-one-out error of the landmarks was {ruler.text(left_out.rms, 3)} (RMS; median "
        f"{ruler.number(float(np.median(distances)), 3)}, "
        f"largest {ruler.text(float(distances.max()), 3)})."
    ]
