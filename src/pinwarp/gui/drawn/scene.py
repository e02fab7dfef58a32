"""What is rendered of a scene, in any plotter: a window's view, or a picture's."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pyvista as pv
from numpy.typing import NDArray

from pinwarp.core.landmarks import Side
from pinwarp.gui.drawn.colour_table import colour_table
from pinwarp.gui.drawn.depth import WHOLE_DEPTH
from pinwarp.gui.drawn.folds import DrawnFolds
from pinwarp.gui.drawn.lines import DrawnLines
from pinwarp.gui.drawn.mesh import DrawnMesh
from pinwarp.gui.drawn.section import Section
from pinwarp.gui.drawn.surface import Surface, shaded
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.scene.drawables import (
    Bone,
    Colouring,
    Cut,
    Drawable,
    FoldedSurface,
    GridLines,
    Overlay,
)
from pinwarp.gui.scene.scene import Scene
from pinwarp.gui.style import theme
from pinwarp.gui.style.colour_scale import ColourScale

_COLOURS = {Side.SOURCE: theme.SOURCE_COLOUR, Side.DESTINATION: theme.DESTINATION_COLOUR}
_BONE = {"ambient": 0.2, "diffuse": 0.92, "specular": 0.16, "specular_power": 18}
_OVERLAY = {"specular": 0.2, "specular_power": 20}
# Key, fill and rim light: place relative to the camera, and strength.
_LIGHTS = (((-0.5, 0.7, 1.0), 0.85), ((0.9, 0.1, 0.7), 0.42), ((0.0, 0.8, -1.0), 0.25))
# Where an overlay that shows a map and the bone stand in the picture's depth: else the bone would
# hide the half of the map that lies inside it.
MAP_DEPTH, DEPTH_BEHIND_MAP = (0.0, 0.5), (0.5, 1.0)


class DrawnScene:
    """Draws what is to be rendered of a scene; of the next one, only what is new in it.

    Parameters
    ----------
    plotter
        Where it is drawn.
    side
        Whose scenes these are.
    surfaces
        Where meshes become surfaces.

    Attributes
    ----------
    scene : Scene
        What is drawn now.
    surface : Surface or None
        The bone's.
    section : Section or None
        The cut through the bones, as it stands now.
    """

    def __init__(self, plotter: Any, side: Side, surfaces: Surfaces) -> None:
        self.scene = Scene(side)
        self.surface: Surface | None = None
        self.section: Section | None = None
        self._plotter = plotter
        self._surfaces = surfaces
        self._coarse = False
        self._cut_from: NDArray | None = None
        bone = {"color": _COLOURS[side]} | _BONE
        warped = {"color": theme.OVERLAY_COLOUR} | _OVERLAY
        self._bone = DrawnMesh(plotter, "bone", **bone)
        self._coarse_bone = DrawnMesh(plotter, "bone stand-in", **bone)
        self._overlay = DrawnMesh(plotter, "overlay", **warped)
        self._coarse_overlay = DrawnMesh(plotter, "overlay stand-in", **warped)
        self._folds = DrawnFolds(plotter)
        self._grid = DrawnLines(plotter, "grid", color=theme.INK, opacity=0.4)
        # In this order: a cut goes through what is drawn, and a map colours it.
        self._drawers: dict[type[Drawable], Callable[[Any, Any], None]] = {
            Bone: self._draw_bone,
            Overlay: self._draw_overlay,
            Colouring: self._draw_colouring,
            FoldedSurface: self._draw_folds,
            GridLines: self._draw_grid,
            Cut: self._draw_cut,
        }
        self._set_lights()

    def _set_lights(self) -> None:
        """Key, fill and rim light that move with the camera."""
        self._plotter.remove_all_lights()
        for place, strength in _LIGHTS:
            light = pv.Light(position=place, light_type="camera light", intensity=strength)
            self._plotter.add_light(light)

    def show(self, scene: Scene, cut_from: NDArray | None = None) -> frozenset[type[Drawable]]:
        """Draw another scene.

        Parameters
        ----------
        scene
            What is to be seen; its own side's.
        cut_from
            Unit vector towards the eye for a cut that is switched on; the camera's when None.

        Returns
        -------
        frozenset of type
            The kinds that were drawn anew.
        """
        before, self.scene = self.scene, scene
        changed = scene.changed_since(before) & self.kinds
        self._cut_from = cut_from
        for kind, draw in self._drawers.items():
            if kind in changed:
                draw(scene.of(kind), before.of(kind))
        if changed:
            self._look()
        return changed

    def draw_into(self, plotter: Any, scene: Scene) -> DrawnScene:
        """Draw a scene in another plotter, cut from the same side."""
        other = DrawnScene(plotter, scene.side, self._surfaces)
        other.show(scene, self.section.direction if self.section is not None else None)
        return other

    @property
    def kinds(self) -> frozenset[type[Drawable]]:
        """What is rendered, of all that can be in a scene."""
        return frozenset(self._drawers)

    def set_coarse(self, coarse: bool) -> None:
        """Draw stand-ins where there are any, or everything in full."""
        if coarse != self._coarse:
            self._coarse = coarse
            self._look()

    @property
    def bone(self) -> pv.PolyData | None:
        """What the camera is fitted to: this side's mesh, else the overlay, else None."""
        return self.surface.polydata if self.surface is not None else self._overlay.polydata

    @property
    def overlay_points(self) -> NDArray | None:
        """The vertices of the overlay as drawn, None where there is none."""
        drawn = self._coarse_overlay if self._coarse else self._overlay
        if drawn.polydata is None:
            drawn = self._overlay
        return None if drawn.polydata is None else np.array(drawn.polydata.points)

    @property
    def grid_lines(self) -> NDArray | None:
        """The (lines, samples, 3) positions of the grid as drawn, None where there is none."""
        return self._grid.lines

    # One drawer for each kind: what is new, and what was drawn before

    def _draw_bone(self, bone: Bone | None, _before: Bone | None) -> None:
        surface = self._surfaces.of(bone.mesh) if bone is not None else None
        if bone is not None:
            for drawn in (self._bone, self._coarse_bone):
                drawn.set_wireframe(bone.wireframe)
        if surface is self.surface:
            return
        self.surface = surface
        self._bone.remove()
        self._coarse_bone.remove()
        if surface is not None:
            self._bone.show(surface.polydata)
            if surface.stand_in is not None:
                self._coarse_bone.show(shaded(surface.stand_in.vertices, surface.stand_in.faces))
        if self.section is not None:
            # The other bone is cut from the same side, in its own depth.
            self._cut(self.section.direction, self.section.share)

    def _draw_overlay(self, overlay: Overlay | None, before: Overlay | None) -> None:
        nothing = Overlay(None)
        new, old = overlay or nothing, before or nothing
        for drawn, warp, drawn_before in (
            (self._overlay, new.full, old.full),
            (self._coarse_overlay, new.stand_in, old.stand_in),
        ):
            if warp is None:
                drawn.remove()
            elif warp is not drawn_before:
                # One layer of a translucent bone needs no depth peeling.
                culling = "front" if warp.inside_out else "back"
                drawn.write(warp.mesh, warp.vertices, warp.normals, culling=culling)
        colouring = self.scene.of(Colouring)
        if colouring is not None and not self._overlay.is_coloured:
            # Another mesh comes plain.
            self._draw_colouring(colouring, None)

    def _draw_colouring(self, colouring: Colouring | None, _before: Colouring | None) -> None:
        if colouring is None:
            for drawn in (self._overlay, self._coarse_overlay):
                drawn.colour(None, None)
            return
        table = colour_table(ColourScale(colouring.kind, colouring.range))
        self._overlay.colour(colouring.levels.full, table)
        self._coarse_overlay.colour(colouring.levels.stand_in, table)

    def _draw_folds(self, folded: FoldedSurface | None, _before: FoldedSurface | None) -> None:
        self._folds.show(folded)
        self._folds.set_clip(self.section.plane if self.section is not None else None)

    def _draw_grid(self, grid: GridLines | None, _before: GridLines | None) -> None:
        if grid is None:
            self._grid.remove()
        else:
            self._grid.write(grid.lines)

    def _draw_cut(self, cut: Cut | None, _before: Cut | None) -> None:
        """Move the cross-section; when it is switched on it faces the camera."""
        if cut is None:
            self._cut(None, 0.0)
        elif self.section is not None:
            self.section.move(cut.share)
        else:
            camera = -np.array(self._plotter.camera.direction)
            self._cut(camera if self._cut_from is None else self._cut_from, cut.share)

    def _cut(self, direction: NDArray | None, share: float) -> None:
        self.section = None
        if direction is not None:
            points = self.bone.points if self.bone is not None else np.zeros((1, 3))
            self.section = Section(direction, points)
            self.section.move(share)
        plane = self.section.plane if self.section is not None else None
        for drawn in (self._bone, self._coarse_bone, self._overlay, self._coarse_overlay):
            drawn.set_clip(plane)
        self._folds.set_clip(plane)

    def _look(self) -> None:
        """Say of everything drawn whether it is seen, how clearly, and before what."""
        overlay = self.scene.of(Overlay)
        # Without a bone of its own the warped source is this side's: solid, and never hidden.
        is_alone = self.surface is None
        overlay_visible = overlay is not None and (overlay.visible or is_alone)
        for full, stand_in, visible in (
            (self._bone, self._coarse_bone, True),
            (self._overlay, self._coarse_overlay, overlay_visible),
        ):
            replaced = self._coarse and stand_in.actor is not None
            full.set_visible(visible and not replaced)
            stand_in.set_visible(visible and replaced)
        for drawn in (self._overlay, self._coarse_overlay):
            if overlay is not None and drawn.actor is not None:
                opacity = overlay.map_opacity if drawn.is_coloured else overlay.opacity
                drawn.actor.prop.opacity = 1.0 if is_alone else opacity
                drawn.actor.prop.color = theme.SOURCE_COLOUR if is_alone else theme.OVERLAY_COLOUR
        self._folds.set_visible(overlay_visible)
        shows_map = overlay_visible and self._overlay.is_coloured
        for drawn in (self._bone, self._coarse_bone):
            drawn.set_depth(DEPTH_BEHIND_MAP if shows_map else WHOLE_DEPTH)
        front = MAP_DEPTH if shows_map else WHOLE_DEPTH
        for over in (self._overlay, self._coarse_overlay, self._folds, self._grid):
            over.set_depth(front)
