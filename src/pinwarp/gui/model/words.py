"""Bodies and elements of a model in words."""

from __future__ import annotations

import math

from pinwarp.core.lengths import Ruler
from pinwarp.core.model_rows import ElementRow
from pinwarp.session.model.bench import BodyWork, Progress, progress_of
from pinwarp.session.model.elements import muscle_of
from pinwarp.session.model.rules import Rule
from pinwarp.session.rulers import rulers_of
from pinwarp.session.view import LengthUnit

EMPTY = (
    "A generic model of OpenSim becomes a subject's: its bones are warped one after the other, "
    "and all that stands on them goes along.\n\n"
    "File > Open Model… opens an .osim, or drop one onto a view."
)
NO_BODY = "Choose a body: its bone becomes the source."
NO_PAIRS = "Pair the bone with the subject's: then it is seen where everything goes."
NO_ELEMENT = "Choose an element: it is shown on both bones."
WITHOUT_WRAPPING = (
    "Muscles are drawn straight from point to point, without wrapping; dashed where they go on "
    "to another body."
)
RULES = {
    Rule.CARRY: "Carried by the bone",
    Rule.TURN: "Carried and turned with the bone",
    Rule.KEEP: "Left as it is",
}
TURN_KEPT = "Carried, orientation kept"

BONE, FRAMES, WRAPS, MARKERS, MUSCLES, JOINTS, OTHERS = (
    *("Bone", "Frames", "Wraps", "Markers", "Muscles", "Joints", "Others"),
)
GROUPS = (FRAMES, WRAPS, MUSCLES, MARKERS, JOINTS, BONE, OTHERS)
_BY_KIND = {
    "mesh": BONE,
    "mass centre": BONE,
    "origin": BONE,
    "mass and inertia": BONE,
    "offset frame": FRAMES,
    "station-defined frame": FRAMES,
    "marker": MARKERS,
    "station": MARKERS,
    "joint": JOINTS,
    "joint translation": JOINTS,
    "muscle lengths": MUSCLES,
}


def group_of(row: ElementRow) -> str:
    """Return the heading that an element stands under."""
    if row.kind.startswith("wrap "):
        return WRAPS
    return MUSCLES if muscle_of(row.path) else _BY_KIND.get(row.kind, OTHERS)


def name_of(row: ElementRow) -> str:
    """Return what an element is called in the list."""
    segments = row.path.split("/")
    if row.kind in ("mass centre", "origin", "mass and inertia", "joint translation"):
        return row.kind if row.kind != "joint translation" else f"{segments[-1]}: translation"
    # Frames of one name stand in many joints.
    return "/".join(segments[-2:]) if "frame" in row.kind else segments[-1]


def outcome_in_words(row: ElementRow) -> str:
    """Return in a word what becomes of an element."""
    if not row.is_warped:
        return "kept"
    if row.kind == "station-defined frame":
        return "made anew"
    return "turned" if "turned with" in row.words else "carried"


def length_in_words(metres: float, ruler: Ruler) -> str:
    """Return a length of the model as text, to a tenth of a millimetre; a dash if not known."""
    decimals = 4 - round(math.log10(ruler.factor))
    return "–" if math.isnan(metres) else f"{ruler.shown(metres):.{decimals}f}"


def meshes_in_words(one: BodyWork) -> str:
    """Return how many meshes a body has."""
    about = one.overview
    if about.missing:
        return "missing"
    return f"{len(about.meshes)}" if about.meshes else "–"


def count_of(one: BodyWork, *kinds: str) -> int:
    """Return how many elements of some kinds are on a body, by how their kind begins."""
    counts = one.overview.counts
    return sum(count for kind, count in counts.items() if kind.startswith(kinds))


def state_in_words(one: BodyWork) -> str:
    """Return how far a body is, with a mark where that is not saved."""
    progress = progress_of(one.current)
    return f"{progress.value}*" if one.is_unsaved and progress is not Progress.NONE else progress


def worst_in_words(one: BodyWork, wanted: LengthUnit) -> str:
    """Return the worst leave-one-out error of a body."""
    session = one.current
    if session is None or math.isnan(one.worst):
        return "–"
    return rulers_of(session, wanted).session.text(one.worst, 3)
