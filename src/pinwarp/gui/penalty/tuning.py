"""Everything about tuning the penalty that is not the slider: suggestion, comparison, snapshots."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from qtpy.QtCore import QObject
from qtpy.QtGui import QAction
from qtpy.QtWidgets import QWidget

from pinwarp.core.landmarks import Side
from pinwarp.gui.penalty.comparison import PenaltyComparison
from pinwarp.gui.penalty.panel import PenaltyPanel
from pinwarp.gui.penalty.snapshot_strip import SnapshotStrip
from pinwarp.gui.penalty.snapshots import Snapshots
from pinwarp.gui.views.viewport import Viewport
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.gui.warp.warps import Presenter
from pinwarp.session.editor import Editor
from pinwarp.session.judging.quality import Quality
from pinwarp.session.view import ViewState


class PenaltyTuning(QObject):
    """Wires editor and figures to the panel of the penalty and the strip of snapshots.

    Parameters
    ----------
    editor, presenter, quality
        The truth, its warps and their figures.
    viewports
        One per side.
    panel, strip
        What it fills.
    actions
        The window's actions by key.
    say
        Shows a message in the status bar.
    window
        Where the keys count.
    """

    def __init__(
        self,
        editor: Editor,
        presenter: Presenter,
        quality: QualityPresenter,
        viewports: Mapping[Side, Viewport],
        panel: PenaltyPanel,
        strip: SnapshotStrip,
        actions: Mapping[str, QAction],
        say: Callable[[str], None],
        window: QWidget,
    ) -> None:
        super().__init__(window)
        self._editor = editor
        self._quality = quality
        self._panel = panel
        self._actions = actions
        canvas = viewports[Side.DESTINATION]
        self.comparison = PenaltyComparison(
            editor, actions["swap_penalty"], canvas.layer, say, window
        )
        self.snapshots = Snapshots(editor, presenter, quality, canvas, strip, actions, say, self)
        actions["take_suggested"].triggered.connect(panel.take_suggested)
        actions["show_curve"].toggled.connect(self._on_curve)
        quality.quality_changed.connect(self._on_quality)
        editor.view_changed.connect(self._on_view)
        self._on_quality(quality.quality)
        self._on_view(editor.view)

    def shut_down(self) -> None:
        """Let go of everything that outlives the window."""
        self.comparison.shut_down()
        self.snapshots.shut_down()
        self._quality.quality_changed.disconnect(self._on_quality)
        self._editor.view_changed.disconnect(self._on_view)

    @property
    def is_settled(self) -> bool:
        """Whether no sweep is under way."""
        return not self.snapshots.is_sweeping

    def _on_quality(self, quality: Quality | None) -> None:
        editor = self._editor
        if editor.is_previewing and editor.session.landmarks != editor.committed.landmarks:
            # While a landmark moves nobody looks at the curve: it follows when that is dropped.
            return
        self._panel.show_quality(quality)
        self._actions["take_suggested"].setEnabled(self._panel.suggestion is not None)

    def _on_curve(self, shown: bool) -> None:
        self._editor.look(curve=shown)

    def _on_view(self, view: ViewState) -> None:
        self._actions["show_curve"].setChecked(view.curve)
        self._panel.show_plot(view.curve)
