"""The editor: the one holder of the current session, its history and what is selected."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType

from psygnal import Signal

from pinwarp.core.landmarks import Side
from pinwarp.core.maps import MapKind, Range
from pinwarp.session.edits import NAME_PATTERN
from pinwarp.session.history import History
from pinwarp.session.session import Session


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
    map_ranges
        The legends that the user fixed, so that warps and sessions can be compared by colour.
    """

    overlay: bool = True
    opacity: float = 0.55
    arrows: bool = True
    hovered: str | None = None
    locked: bool = False
    guided: str | None = None
    name_pattern: str = NAME_PATTERN
    nudge: float | None = None
    link: LinkMode = LinkMode.LINKED
    marker_radius: float = 6.0
    wireframe: bool = False
    section: float | None = None
    grid: GridKind = GridKind.NONE
    grid_share: float = 0.5
    curve: bool = True
    map: MapKind | None = None
    map_opacity: float = 1.0
    map_relative: bool = False
    map_ranges: Mapping[MapKind, Range] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def map_range(self) -> Range | None:
        """The fixed legend of the map that is shown; None where it follows the map."""
        return None if self.map is None else self.map_ranges.get(self.map)


class Editor:
    """Holds the truth; views render it and ask for changes.

    ``path`` is the file of the session and ``file_sha256`` its hash when it was read or written
    here; both are None where there is none.

    Signals are in the past tense: ``session_changed`` (also while previewing a drag),
    ``selection_changed``, ``view_changed`` and ``saved`` (the file or the unsaved mark changed).

    Examples
    --------
    >>> from pinwarp.session import edits
    >>> editor = Editor()
    >>> editor.commit(edits.set_unit(editor.session, "m"), "Change unit")
    >>> editor.session.unit, editor.is_dirty
    ('m', True)
    >>> editor.undo()
    >>> editor.session.unit
    'mm'
    """

    session_changed = Signal(Session)
    selection_changed = Signal(Selection)
    view_changed = Signal(ViewState)
    saved = Signal()

    def __init__(self, session: Session | None = None) -> None:
        self._history = History(session or Session())
        self._preview: Session | None = None
        self.selection = Selection()
        self.view = ViewState()
        self.path: Path | None = None
        self.file_sha256: str | None = None

    @property
    def session(self) -> Session:
        """What is shown: the preview of a drag under way, else the committed session."""
        return self._preview if self._preview is not None else self._history.session

    @property
    def committed(self) -> Session:
        """The session without a drag under way."""
        return self._history.session

    @property
    def is_previewing(self) -> bool:
        """Whether a drag is under way."""
        return self._preview is not None

    @property
    def is_dirty(self) -> bool:
        """Whether there is work that no file holds."""
        return self._history.is_dirty

    @property
    def undo_label(self) -> str | None:
        """What undo would take back."""
        return self._history.undo_label

    @property
    def redo_label(self) -> str | None:
        """What redo would do again."""
        return self._history.redo_label

    def preview(self, session: Session) -> None:
        """Show a session while something is dragged, without a step in the history."""
        self._preview = session
        self.session_changed.emit(session)

    def cancel_preview(self) -> None:
        """Put back what was there before the drag."""
        if self._preview is not None:
            self._preview = None
            self._announce()

    def commit(self, session: Session, label: str, merge_key: str | None = None) -> None:
        """Make a session the current one, as a step that can be undone."""
        self._preview = None
        self._history.commit(session, label, merge_key)
        self._announce()

    def undo(self) -> None:
        """Take the last step back."""
        self._preview = None
        self._history.undo()
        self._announce()

    def redo(self) -> None:
        """Do the next step again."""
        self._preview = None
        self._history.redo()
        self._announce()

    def replace_all(
        self,
        session: Session,
        path: Path | None,
        *,
        sha256: str | None = None,
        saved: bool = True,
    ) -> None:
        """Start over with another session: nothing before it can be undone.

        Parameters
        ----------
        session
            The session.
        path, sha256
            Its file, and the hash of that when it was read.
        saved
            False for a session that no file holds as it is.
        """
        self._history = History(session)
        self._history.mark_saved(saved=saved)
        self._preview = None
        self.path, self.file_sha256 = path, sha256
        self._announce()
        self.saved.emit()

    def mark_saved(self, path: Path, sha256: str | None = None) -> None:
        """Remember where the session was saved, and the hash of the file."""
        self.path, self.file_sha256 = path, sha256
        self._history.mark_saved()
        self.saved.emit()

    def select(self, *names: str, side: Side | None = None) -> None:
        """Select landmarks; without a side the previous one stays."""
        selection = Selection(names, side or self.selection.side)
        if selection != self.selection:
            self.selection = selection
            self.selection_changed.emit(selection)

    def look(self, **changes: object) -> None:
        """Change how the session is looked at; keywords as in :class:`ViewState`."""
        view = replace(self.view, **changes)  # type: ignore[arg-type]  # keywords of ViewState
        if view != self.view:
            self.view = view
            self.view_changed.emit(view)

    def _announce(self) -> None:
        there = {landmark.name for landmark in self.session.landmarks}
        kept = tuple(name for name in self.selection.names if name in there)
        self.select(*kept)
        self.session_changed.emit(self.session)
