"""What the maps are called and what they mean, for menu, legend and panel."""

from __future__ import annotations

from pinwarp.core.lengths import Ruler
from pinwarp.core.maps import MapKind, SurfaceMap

_RATIO = Ruler()
TITLES = {
    MapKind.DISTANCE: "Distance to the destination",
    MapKind.VOLUME: "Volume change",
    MapKind.LARGEST_STRETCH: "Largest stretch",
    MapKind.SMALLEST_STRETCH: "Smallest stretch",
    MapKind.UNCERTAINTY: "Uncertainty of the warp",
}
# In the menu: what it is called there, in more words, and where it stands.
MENU_WORDS = {
    None: ("&No Map", "The warped source in one colour", 11),
    MapKind.DISTANCE: ("&Distance to the Destination", "Where it misses", 21),
    MapKind.VOLUME: ("&Volume Change", "Where it swells and shrinks", 22),
    MapKind.LARGEST_STRETCH: ("&Largest Stretch", "In the direction that grows most", 23),
    MapKind.SMALLEST_STRETCH: ("&Smallest Stretch", "In the direction that grows least", 24),
    MapKind.UNCERTAINTY: ("&Uncertainty", "Where landmarks are missing", 25),
}
MEANINGS = {
    None: "Colour the warped source by how well it fits, how it is deformed, or how sure it is.",
    MapKind.DISTANCE: (
        "How far the two surfaces lie apart: from every vertex of one to the nearest place on "
        "the other. The colours show the way from source to destination."
    ),
    MapKind.VOLUME: (
        "How the volume around a place changes: 1 keeps it, ½ halves it, 0 or less folds the "
        "surface (determinant of the warp's derivative)."
    ),
    MapKind.LARGEST_STRETCH: (
        "How much longer a short line on the source becomes, in the direction that is stretched "
        "most: 1 keeps its length."
    ),
    MapKind.SMALLEST_STRETCH: (
        "How much longer a short line on the source becomes, in the direction that is stretched "
        "least: below 1 it is squeezed."
    ),
    MapKind.UNCERTAINTY: (
        "Standard deviation of one coordinate of the full warp, told from how well the pairs "
        "foretell one another and from what bones of this size are known for: largest where "
        "landmarks are far away. About three in four true places lie within twice of it, one in "
        "ten beyond three times."
    ),
}

# What was fitted does not judge itself, and leaving landmarks out tells of their own warp.
_FITTED_TITLES = {
    MapKind.DISTANCE: "Distance to the destination (fitted)",
    MapKind.UNCERTAINTY: "Uncertainty of the landmarks' warp",
}
_FITTED_MEANINGS = {
    MapKind.DISTANCE: "The warp was fitted to this surface: a small distance proves nothing.",
    MapKind.UNCERTAINTY: "What was fitted does not count here: the landmarks' own warp is judged.",
}


def title_of(kind: MapKind, *, fitted: bool) -> str:
    """Return what a map is called.

    Parameters
    ----------
    kind
        Which.
    fitted
        Whether the warp was fitted to the surface that distances are measured to.
    """
    return _FITTED_TITLES.get(kind, TITLES[kind]) if fitted else TITLES[kind]


def meaning_of(kind: MapKind | None, *, fitted: bool) -> str:
    """Return what a map means, in sentences; parameters as of :func:`title_of`."""
    more = _FITTED_MEANINGS.get(kind, "") if fitted and kind is not None else ""
    return f"{MEANINGS[kind]} {more}".rstrip()


def note_of(found: SurfaceMap, unit: str) -> str:
    """Return the unit of a map, or what its ratios are relative to."""
    if found.kind is MapKind.UNCERTAINTY:
        return f"± {unit}"
    if not found.kind.is_ratio:
        return f"in {unit}"
    if found.overall == 1:
        return ""
    return f"relative to the overall size (lengths × {found.overall:.3g})"


def figure(value: float, ruler: Ruler = _RATIO) -> str:
    """Return a figure of a map in three digits.

    Examples
    --------
    >>> figure(2.2493, Ruler("mm")), figure(0.00769, Ruler("mm", 1000.0)), figure(12345.6)
    ('2.25 mm', '7.69 mm', '12346')
    >>> figure(1.275e-19, Ruler("mm", 1000.0, 4e-10)), figure(0.0)
    ('0 mm', '0')
    """
    value = ruler.shown(value)
    text = f"{value:.0f}" if abs(value) >= 1000 or not value else f"{value:#.3g}".rstrip(".")
    return f"{text} {ruler.unit}".rstrip()
