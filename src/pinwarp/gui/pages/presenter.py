"""Help > User Guide, and the entries that open it at a page."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from qtpy.QtWidgets import QWidget

from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.pages.browser import GuideWindow
from pinwarp.gui.pages.library import Page, read_pages
from pinwarp.io.samples import help_folder

FIRST = "01-first-warp.md"
# What is looked up most, with the pages that tell it.
_ABOUT = (
    ("penalty", "About the Warping &Penalty", "03-penalty.md"),
    ("quality", "About the &Quality Figures", "04-trust.md"),
    ("semilandmarks", "About Semi&landmarks and Refining", "06-semilandmarks.md"),
    ("models", "About &Models", "07-models.md"),
    ("suggesting", "About &Ghosts and Suggestions", "02-landmarks.md"),
)


class UserGuide(Capability):
    """Shows the pages that are shipped with the program.

    Parameters
    ----------
    words
        Returns what is told of an action, by its key and what is asked for: what it is called,
        where it is found, its keys.
    window
        What the guide is closed with.
    """

    def __init__(self, words: Callable[[str, str], str], window: QWidget) -> None:
        self._words = words
        self._parent = window
        self.window: GuideWindow | None = None
        self.actions = (
            Action(
                "user_guide",
                "&User Guide",
                partial(self.read, ""),
                at="Help.11",
                keys="F1",
                deed="Open User Guide",
                tip="How everything is done, page by page, with a search",
            ),
            *(
                Action(f"about_{key}", text, partial(self.read, page), at=f"Help.2{number}")
                for number, (key, text, page) in enumerate(_ABOUT, 1)
            ),
        )

    def pages(self) -> tuple[Page, ...]:
        """Return all pages as they are read."""
        return tuple(page.filled(self._words) for page in read_pages(help_folder()))

    def read(self, page: str) -> None:
        """Show a page by its name; without one that which was read last."""
        if self.window is None:
            # Not before it is asked for: most starts need no guide.
            self.window = GuideWindow(self.pages(), help_folder(), self._parent)
        self.window.read(page or self.window.page or FIRST)

    def shut_down(self) -> None:
        """Close it with the window."""
        if self.window is not None:
            self.window.close()
            self.window.deleteLater()
            self.window = None
