"""User stories: what the Help menu says."""

from __future__ import annotations

from qtpy.QtCore import Qt, QTimer
from qtpy.QtGui import QGuiApplication
from qtpy.QtWidgets import QApplication, QMessageBox

from pinwarp.gui.files.file_dialogs import FileDialogs
from pinwarp.version import __version__


def test_bibtex_for_a_paper_is_copied_by_a_button(user):
    def press():
        box = QApplication.activeModalWidget()
        assert isinstance(box, QMessageBox)
        assert "pinwarp check" in box.informativeText()
        (button,) = (button for button in box.buttons() if button.text() == "Copy BibTeX")
        user.qtbot.mouseClick(button, Qt.MouseButton.LeftButton)

    user.dialogs.choose = FileDialogs(user.window).choose
    QTimer.singleShot(100, user.window, press)
    user.trigger("cite")
    text = QGuiApplication.clipboard().text()
    assert text.startswith("@software{pinwarp,")
    assert f"{{{__version__}}}" in text
    assert text.count("{") == text.count("}")
