"""What is asked about a model before it is written."""

from __future__ import annotations

from qtpy.QtCore import Qt
from qtpy.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QLabel,
    QPlainTextEdit,
    QVBoxLayout,
    QWidget,
)

from pinwarp.core.words import counted
from pinwarp.gui.tasks.dialogs import Dialogs
from pinwarp.io.model_report import report_text
from pinwarp.session.model.warped import WarpedModel


class DryRunDialog(QDialog):
    """Shows what would become of everything, and asks whether to write it.

    Parameters
    ----------
    warped
        The model, carried and not written.
    parent
        Over what it stands.
    """

    def __init__(self, warped: WarpedModel, parent: QWidget | None) -> None:
        super().__init__(parent)
        self.setWindowTitle("Export the model: dry run")
        counts = {outcome.value: count for outcome, count in warped.counts.items()}
        bodies = counted(len(warped.bodies), "body", "bodies")
        self.summary = QLabel(
            f"{warped.study.model.path.name}: {bodies} carried. {counts['warped']} elements are "
            f"warped, {counts['kept']} kept, {counts['flagged']} flagged. Nothing is written yet."
        )
        self.summary.setWordWrap(True)
        self.text = QPlainTextEdit(report_text(warped.rows, warped.notes))
        self.text.setReadOnly(True)
        self.text.setAccessibleName("What would become of everything")
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Cancel)
        self.export = buttons.addButton("Export…", QDialogButtonBox.ButtonRole.AcceptRole)
        self.export.setDefault(True)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        column = QVBoxLayout(self)
        column.addWidget(self.summary)
        column.addWidget(self.text, 1)
        column.addWidget(buttons)
        self.resize(760, 560)
        self.setWindowModality(Qt.WindowModality.WindowModal)


class ModelDialogs(Dialogs):
    """The real dialog, over one window."""

    def ask_dry_run(self, warped: WarpedModel) -> bool:
        """Show what would become of everything; say whether it is to be written."""
        dialog = DryRunDialog(warped, self.window)
        accepted = dialog.exec()
        dialog.deleteLater()
        return bool(accepted)
