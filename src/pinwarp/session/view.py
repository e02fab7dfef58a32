"""What is selected and how the session is looked at: neither is saved or undone."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from types import MappingProxyType
from typing import TypedDict

from pinwarp.core.landmarks import Side
from pinwarp.core.maps import MapKind, Range
from pinwarp.session.naming import NAME_PATTERN


@dataclass(frozen=True)
class Selection:
    """Selected landmarks by name, and the side that Delete and the arrow keys act on."""

    names: tuple[str, ...] = ()
    side: Side = Side.SOURCE


class LinkMode(StrEnum):
    """How the cameras of the two sides move together."""

    LINKED = "linked"
    ROTATION = "rotation only"
    FREE = "free"


class Background(StrEnum):
    """What is behind the bones."""

    THEME = "theme"
    LIGHT = "light"
    DARK = "dark"


class GridKind(StrEnum):
    """Which regular grid is drawn through the source and, warped, over the destination."""

    NONE = "none"
    BOX = "box"
    PLANE_X = "plane x"
    PLANE_Y = "plane y"
    PLANE_Z = "plane z"

    @property
    def axis(self) -> str | None:
        """The axis of the source across the plane; None where it is no plane.

        Examples
        --------
        >>> GridKind.PLANE_Y.axis, GridKind.BOX.axis
        ('y', None)
        """
        return self.value[-1] if self.value.startswith("plane") else None


class LengthUnit(StrEnum):
    """In which unit lengths are shown."""

    AUTOMATIC = "automatic"
    FILE = "as in the file"
    MM = "mm"
    CM = "cm"
    M = "m"


@dataclass(frozen=True)
class ViewState:
    """How the session is looked at and worked on: not undone, not part of what is saved.

    Parameters
    ----------
    overlay, opacity
        Whether and how the warped source is drawn.
    arrows
        Whether arrows show where the warp misses its destinations.
    hovered
        The landmark under the mouse.
    locked
        Whether all landmarks are frozen.
    guided
        The landmark that the guide asks for; None without a guide.
    group
        The curve or patch that is worked on; empty for none.
    slides
        Whether arrows show how far semilandmarks slid.
    name_pattern
        What new landmarks are called.
    nudge
        How far an arrow key moves a landmark, in mesh units; None for a share of the bone.
    link
        How the cameras of the two sides move together.
    marker_radius
        Of the landmarks' signs, in logical pixels.
    wireframe
        Whether the bones are drawn as edges only.
    background
        What is behind the bones.
    section
        Share of the depth that the cross-section clips away; None without a cross-section.
    grid, grid_share
        The grid that is drawn, and where a plane of it crosses its axis: from 0, the low side of
        the source, to 1.
    curve
        Whether the figures over the penalty are drawn above its slider.
    map, map_opacity
        What the warped source is coloured by, if anything, and its opacity then.
    map_relative
        Whether the overall difference in size is taken out of maps of ratios.
    lengths
        In which unit lengths are shown.
    map_ranges
        The legends that the user fixed, so that warps and sessions can be compared by colour.
    """

    overlay: bool = True
    opacity: float = 0.55
    arrows: bool = True
    hovered: str | None = None
    locked: bool = False
    guided: str | None = None
    group: str = ""
    slides: bool = False
    name_pattern: str = NAME_PATTERN
    nudge: float | None = None
    link: LinkMode = LinkMode.LINKED
    marker_radius: float = 6.0
    wireframe: bool = False
    background: Background = Background.THEME
    section: float | None = None
    grid: GridKind = GridKind.NONE
    grid_share: float = 0.5
    curve: bool = True
    map: MapKind | None = None
    map_opacity: float = 1.0
    map_relative: bool = False
    lengths: LengthUnit = LengthUnit.AUTOMATIC
    map_ranges: Mapping[MapKind, Range] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def map_range(self) -> Range | None:
        """The fixed legend of the map that is shown; None where it follows the map."""
        return None if self.map is None else self.map_ranges.get(self.map)


class ViewChanges(TypedDict, total=False):
    """Some fields of a :class:`ViewState`, which a test compares with it."""

    overlay: bool
    opacity: float
    arrows: bool
    hovered: str | None
    locked: bool
    guided: str | None
    group: str
    slides: bool
    name_pattern: str
    nudge: float | None
    link: LinkMode
    marker_radius: float
    wireframe: bool
    background: Background
    section: float | None
    grid: GridKind
    grid_share: float
    curve: bool
    map: MapKind | None
    map_opacity: float
    map_relative: bool
    lengths: LengthUnit
    map_ranges: Mapping[MapKind, Range]
