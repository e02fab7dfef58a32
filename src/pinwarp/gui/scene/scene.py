"""All that one viewport shows, besides from where: a side, and at most one drawable of a kind."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeVar

from pinwarp.core.landmarks import Side
from pinwarp.gui.scene.drawables import Drawable

Kind = TypeVar("Kind", bound=Drawable)


@dataclass(frozen=True)
class Scene:
    """All that one viewport shows.

    Parameters
    ----------
    side
        Whose viewport it is.
    drawables
        In any order.

    Raises
    ------
    ValueError
        When two are of one kind: only one of them would be seen.

    Examples
    --------
    >>> from pinwarp.gui.scene.drawables import Badge, Hint
    >>> before = Scene(Side.SOURCE, (Hint("Drop a mesh here"), Badge("new")))
    >>> before.of(Badge)
    Badge(words='new')
    >>> after = before.without(Badge)
    >>> after.of(Badge)
    >>> [kind.__name__ for kind in after.changed_since(before)]
    ['Badge']
    """

    side: Side
    drawables: tuple[Drawable, ...] = ()

    def __post_init__(self) -> None:
        kinds = [type(one).__name__ for one in self.drawables]
        twice = {kind for kind in kinds if kinds.count(kind) > 1}
        if twice:
            raise ValueError(f"more than one drawable of a kind: {', '.join(sorted(twice))}")

    def of(self, kind: type[Kind]) -> Kind | None:
        """Return the drawable of a kind, None where there is none."""
        return next((one for one in self.drawables if isinstance(one, kind)), None)

    def with_(self, *drawables: Drawable) -> Scene:
        """Return the scene with these in place of those of their kinds."""
        return Scene(self.side, (*self.without(*map(type, drawables)).drawables, *drawables))

    def without(self, *kinds: type[Drawable]) -> Scene:
        """Return the scene without some kinds."""
        return Scene(self.side, tuple(x for x in self.drawables if not isinstance(x, kinds)))

    def only(self, *kinds: type[Drawable]) -> Scene:
        """Return the scene with nothing but some kinds."""
        return Scene(self.side, tuple(x for x in self.drawables if isinstance(x, kinds)))

    def changed_since(self, before: Scene) -> frozenset[type[Drawable]]:
        """Return the kinds that are drawn otherwise than in another scene."""
        kinds: Iterable[type[Drawable]] = {type(x) for x in (*self.drawables, *before.drawables)}
        return frozenset(kind for kind in kinds if self.of(kind) != before.of(kind))
