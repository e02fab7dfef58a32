"""The penalty: its panel, what is asked for there, and what is suggested."""

from __future__ import annotations

from qtpy.QtCore import Signal
from qtpy.QtWidgets import QVBoxLayout, QWidget

from pinwarp.core.basis import Basis
from pinwarp.core.spline import PenaltyConvention
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import BOTTOM, Capability, Panel
from pinwarp.gui.penalty.panel import PenaltyPanel
from pinwarp.gui.penalty.snapshots import Snapshots
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.gui.warp.warps import Warps
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.quality import Quality
from pinwarp.session.session import Session
from pinwarp.session.view import ViewState
from pinwarp.session.warp.result import WarpResult


class PenaltyTuning(Capability):
    """Everything between editor, figures and the panel of the penalty.

    Parameters
    ----------
    editor, warps, quality
        The truth, its warps and their figures.
    snapshots
        Their button is in the panel, their strip above it.
    """

    def __init__(
        self, editor: Editor, warps: Warps, quality: QualityPresenter, snapshots: Snapshots
    ) -> None:
        self._editor = editor
        self._warps = warps
        self._quality = quality
        curve = Action(
            "show_curve",
            "Penalty C&urve",
            switches=lambda on: editor.look(curve=on),
            checked=lambda: editor.view.curve,
            at="View.52",
            tip="Leave-one-out error and residual",
            button="Curve",
        )
        self.panel = PenaltyPanel(curve, snapshots.actions)
        self._take = Action(
            "take_suggested",
            "Take &Suggested Penalty",
            self.panel.take_suggested,
            at="Warp.11",
            keys="T",
            tip="The one with the least leave-one-out error",
            possible=lambda: self.panel.suggestion is not None,
        )
        self.actions = (self._take, curve)
        self._dock = _Dock(snapshots.strip, self.panel)
        snapshots.strip.height_changed.connect(self._dock.height_changed)
        self.panels = (
            Panel("penalty", "Warping penalty", self._dock, BOTTOM, self._dock.height_changed),
        )
        self._connect()
        self.panel.show_rulers(editor.rulers)
        self._on_session(editor.session)
        self._on_quality(quality.quality)
        self.panel.show_plot(editor.view.curve)

    def _connect(self) -> None:
        editor, panel = self._editor, self.panel
        panel.penalty_previewed.connect(
            lambda penalty: editor.preview(edits.set_penalty(editor.committed, penalty))
        )
        panel.penalty_requested.connect(self._on_penalty)
        panel.equation_requested.connect(self._on_equation)
        panel.planar_requested.connect(self._on_planar)
        panel.unit_requested.connect(
            lambda unit: editor.commit(edits.set_unit(editor.committed, unit), "Change unit")
        )
        editor.rulers_changed.connect(panel.show_rulers)
        editor.session_changed.connect(self._on_session)
        editor.view_changed.connect(self._on_view)
        self._warps.result_changed.connect(self._on_result)
        self._warps.figures_changed.connect(panel.show_result)
        self._quality.quality_changed.connect(self._on_quality)

    def shut_down(self) -> None:
        """Let go of the editor, the warps and the figures."""
        self._editor.rulers_changed.disconnect(self.panel.show_rulers)
        self._editor.session_changed.disconnect(self._on_session)
        self._editor.view_changed.disconnect(self._on_view)
        self._warps.result_changed.disconnect(self._on_result)
        self._warps.figures_changed.disconnect(self.panel.show_result)
        self._quality.quality_changed.disconnect(self._on_quality)

    # What changed

    def _on_session(self, session: Session) -> None:
        self.panel.show_session(session)
        if not self._editor.is_previewing:
            # What the pairs by hand say alone takes a solve: none under a hand that moves.
            self.panel.figures.show_session(session, self._editor.rulers.destination)

    def _on_result(self, result: WarpResult) -> None:
        # Of a landmark that moves the figures follow when it is dropped: only the slider's is live.
        if result.inputs.settings.penalty != self._editor.committed.settings.penalty:
            self.panel.show_result(result)

    def _on_quality(self, quality: Quality | None) -> None:
        editor = self._editor
        if editor.is_previewing and editor.session.landmarks != editor.committed.landmarks:
            # While a landmark moves nobody looks at the curve: it follows when that is dropped.
            return
        self.panel.show_quality(quality)
        self._take.renew()

    def _on_view(self, view: ViewState) -> None:
        if self.panel.plot.isHidden() == view.curve:
            self.panel.show_plot(view.curve)
            self._dock.height_changed.emit()

    # What the user does

    def _on_penalty(self, penalty: float) -> None:
        session = edits.set_penalty(self._editor.committed, penalty)
        self._editor.commit(session, "Change penalty")

    def _on_equation(self, convention: PenaltyConvention, basis: Basis) -> None:
        before = self._editor.committed
        session = edits.set_convention(edits.set_basis(before, basis), convention)
        same = basis is before.settings.basis
        self._editor.commit(session, "Change penalty convention" if same else "Change basis")

    def _on_planar(self, planar: bool) -> None:
        label = "Treat as planar" if planar else "Do not treat as planar"
        self._editor.commit(edits.set_planar(self._editor.committed, planar), label)


class _Dock(QWidget):
    """The strip of snapshots above the panel."""

    height_changed = Signal()

    def __init__(self, strip: QWidget, panel: QWidget) -> None:
        super().__init__()
        rows = QVBoxLayout(self)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.setSpacing(0)
        rows.addWidget(strip)
        rows.addWidget(panel, 1)
