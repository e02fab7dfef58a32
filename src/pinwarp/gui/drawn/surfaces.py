"""The surfaces of the meshes that are shown, each made once."""

from __future__ import annotations

import weakref

from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.surface import Surface


class Surfaces:
    """Remembers the surface of every mesh for as long as something uses it."""

    def __init__(self) -> None:
        self._known: weakref.WeakKeyDictionary[Mesh, Surface] = weakref.WeakKeyDictionary()

    def keep(self, mesh: Mesh, surface: Surface) -> None:
        """Remember a surface made in a loading job for when its mesh is shown."""
        self._known[mesh] = surface

    def of(self, mesh: Mesh) -> Surface:
        """Return the surface of a mesh, made here where it is not known yet."""
        if mesh not in self._known:
            self._known[mesh] = Surface(mesh)
        return self._known[mesh]
