"""The window of the user guide: titles and a search at the left, the page at the right."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from qtpy.QtCore import QEvent, QSize, Qt, QUrl
from qtpy.QtGui import (
    QColor,
    QDesktopServices,
    QKeySequence,
    QShortcut,
    QTextBlockFormat,
    QTextCharFormat,
    QTextCursor,
    QTextDocument,
)
from qtpy.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QSplitter,
    QTextBrowser,
    QTextEdit,
    QVBoxLayout,
    QWidget,
)

from pinwarp.gui.pages.library import Page, pages_about
from pinwarp.gui.style import theme
from pinwarp.gui.style.icons import icon

SIZE = QSize(980, 700)
_MARGIN = 16
# Of the lines of a page, in per cent, and of the titles beside it, in pixels.
_LINE_HEIGHT, _TITLE_PADDING = 130, 5
_LINK = {False: "#1d5fa8", True: "#7db8ee"}
# What was searched for, on either theme.
_FOUND = {False: "#ffe08a", True: "#6b5200"}


class GuideWindow(QWidget):
    """A window of its own beside the bones, so that one can read and do.

    Parameters
    ----------
    pages
        All of them, filled.
    folder
        Where their pictures are.
    parent
        The window that it is closed with.
    """

    def __init__(self, pages: Sequence[Page], folder: Path, parent: QWidget) -> None:
        super().__init__(parent, Qt.WindowType.Window)
        self._pages = {page.name: page for page in pages}
        self._shown = ""
        self.setWindowTitle("User guide – pinwarp")
        self.setWindowIcon(icon("pinwarp"))
        self.search = QLineEdit(placeholderText="Search the guide", clearButtonEnabled=True)
        self.search.addAction(icon("search"), QLineEdit.ActionPosition.LeadingPosition)
        self.search.setAccessibleName("Search the guide")
        self.titles = QListWidget()
        self.titles.setAccessibleName("Pages")
        self.titles.setStyleSheet(f"QListWidget::item {{ padding: {_TITLE_PADDING}px; }}")
        self.nothing = QLabel("No page has these words.", alignment=Qt.AlignmentFlag.AlignCenter)
        self.nothing.setWordWrap(True)
        theme.make_quiet(self.nothing)
        self.nothing.hide()
        self.text = QTextBrowser(openLinks=False)
        self.text.setAccessibleName("Page")
        self.text.setSearchPaths([str(folder)])
        self.text.document().setDocumentMargin(_MARGIN)
        self._lay_out()
        self.search.textChanged.connect(self._on_search)
        self.search.returnPressed.connect(self.find_next)
        self.titles.currentItemChanged.connect(self._on_chosen)
        self.text.anchorClicked.connect(self._on_link)
        for keys, does in (
            (QKeySequence.StandardKey.Find, self._begin_search),
            (QKeySequence.StandardKey.Close, self.close),
            (QKeySequence(Qt.Key.Key_Escape), self._on_escape),
        ):
            QShortcut(QKeySequence(keys), self, does)
        self._list(list(self._pages.values()))

    def _lay_out(self) -> None:
        left = QWidget()
        column = QVBoxLayout(left)
        column.setContentsMargins(theme.SPACE, theme.SPACE, 0, theme.SPACE)
        for widget in (self.search, self.titles, self.nothing):
            column.addWidget(widget)
        splitter = QSplitter(Qt.Orientation.Horizontal, childrenCollapsible=False)
        splitter.addWidget(left)
        splitter.addWidget(self.text)
        splitter.setStretchFactor(1, 1)
        splitter.setSizes([270, SIZE.width() - 270])
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(splitter)
        room = self.screen().availableGeometry().size()
        self.resize(SIZE.boundedTo(room))

    def read(self, name: str) -> None:
        """Show a page, and come to the front."""
        self.search.clear()
        self._choose(name)
        self.show()
        self.raise_()
        self.activateWindow()

    @property
    def page(self) -> str:
        """The name of the page that is shown."""
        return self._shown

    def find_next(self) -> None:
        """Go to the next place of what was searched for, at the end back to the first."""
        words = self.search.text().split()
        if words and not self.text.find(words[0]):
            self.text.moveCursor(QTextCursor.MoveOperation.Start)
            self.text.find(words[0])

    def changeEvent(self, event: QEvent) -> None:
        """Mark what was found in the colours of the theme."""
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange:
            self._dress()
            self._mark()

    def _list(self, pages: Sequence[Page]) -> None:
        self.titles.blockSignals(True)
        self.titles.clear()
        for page in pages:
            item = QListWidgetItem(page.title)
            item.setData(Qt.ItemDataRole.UserRole, page.name)
            self.titles.addItem(item)
        self.titles.blockSignals(False)
        self.nothing.setVisible(not pages)
        if pages:
            names = [page.name for page in pages]
            self._choose(self._shown if self._shown in names else names[0])

    def _choose(self, name: str) -> None:
        for row in range(self.titles.count()):
            if self.titles.item(row).data(Qt.ItemDataRole.UserRole) == name:
                self.titles.setCurrentRow(row)
                self._show(name)

    def _show(self, name: str) -> None:
        if name != self._shown:
            self._shown = name
            dialect = QTextDocument.MarkdownFeature.MarkdownDialectGitHub
            self.text.document().setMarkdown(self._pages[name].text, dialect)
            self._dress()
            self.text.moveCursor(QTextCursor.MoveOperation.Start)
        self._mark()

    def _dress(self) -> None:
        """Space the lines, and write links in a colour that can be read: Markdown has no sheet."""
        link, loose = QTextCharFormat(), QTextBlockFormat()
        link.setForeground(QColor(_LINK[theme.is_dark()]))
        loose.setLineHeight(_LINE_HEIGHT, QTextBlockFormat.LineHeightTypes.ProportionalHeight.value)
        block = self.text.document().begin()
        while block.isValid():
            formats = [piece.fragment().charFormat() for piece in block]
            # A line as high as a picture is high enough.
            if not any(x.isImageFormat() for x in formats):
                QTextCursor(block).mergeBlockFormat(loose)
            for piece in block:
                fragment = piece.fragment()
                if fragment.charFormat().isAnchor():
                    place = QTextCursor(block)
                    place.setPosition(fragment.position())
                    end = fragment.position() + fragment.length()
                    place.setPosition(end, QTextCursor.MoveMode.KeepAnchor)
                    place.mergeCharFormat(link)
            block = block.next()

    def _mark(self) -> None:
        """Mark every place of the words that are searched for."""
        marked = QTextCharFormat()
        marked.setBackground(QColor(_FOUND[theme.is_dark()]))
        selections = []
        for word in self.search.text().split():
            cursor = self.text.document().find(word)
            while not cursor.isNull():
                selection = QTextEdit.ExtraSelection()
                selection.cursor, selection.format = cursor, marked
                selections.append(selection)
                cursor = self.text.document().find(word, cursor)
        self.text.setExtraSelections(selections)

    def _on_search(self, query: str) -> None:
        self._list(pages_about(list(self._pages.values()), query))
        self._mark()

    def _on_chosen(self, item: QListWidgetItem | None) -> None:
        if item is not None:
            self._show(item.data(Qt.ItemDataRole.UserRole))

    def _on_link(self, url: QUrl) -> None:
        if url.fileName() in self._pages:
            self.read(url.fileName())
        elif url.scheme() in ("http", "https"):
            QDesktopServices.openUrl(url)

    def _begin_search(self) -> None:
        self.search.setFocus()
        self.search.selectAll()

    def _on_escape(self) -> None:
        if self.search.text():
            self.search.clear()
        else:
            self.close()
