"""Bones and landmarks of the session in the scene, as the view state wants them."""

from __future__ import annotations

from collections.abc import Iterable

from pinwarp.core.landmarks import Side
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.scene.drawables import Drawable
from pinwarp.gui.scene.session_scene import session_drawables
from pinwarp.gui.views.scenes import Scenes
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.gui.warp.warps import Warps
from pinwarp.session.editor import Editor


class ShownSession(Capability):
    """Puts the session into the scene, anew whenever it may look otherwise.

    Parameters
    ----------
    editor
        The truth.
    scenes
        Where it is shown.
    warps, quality
        Where the warp carries landmarks, and where the other pairs expect them.
    """

    def __init__(
        self, editor: Editor, scenes: Scenes, warps: Warps, quality: QualityPresenter
    ) -> None:
        self._editor = editor
        self._scenes = scenes
        self._warps = warps
        self._quality = quality
        self._changes = (editor.session_changed, editor.selection_changed, editor.view_changed)
        for signal in (*self._changes, quality.quality_changed):
            signal.connect(scenes.renew)

    def drawables(self, side: Side) -> Iterable[Drawable]:
        """Return bones, landmarks and arrows."""
        editor = self._editor
        return session_drawables(
            side,
            editor.session,
            editor.selection,
            editor.view,
            self._warps.result,
            self._quality.quality,
        )

    def shut_down(self) -> None:
        """Let go of the editor and the figures."""
        for signal in (*self._changes, self._quality.quality_changed):
            signal.disconnect(self._scenes.renew)
