"""The pages of the user guide: read, searched, and filled with what actions are called."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pinwarp.gui.scene.key_words import with_own_keys

_FIELD = re.compile(r"\{([a-z_0-9]+)((?:\.[a-z]+)?)\}")
_MARKS = re.compile(r"!\[([^\]]*)\]\([^)]*\)|\[([^\]]*)\]\([^)]*\)|[*`|#]")


@dataclass(frozen=True)
class Page:
    """One page.

    Parameters
    ----------
    name
        Of its file; pages link to one another by it.
    text
        Markdown. ``{save}`` stands for what the action of that key is called, where it is found
        and its shortcut, ``{save.keys}`` for the shortcut alone, ``{save.name}`` for its name.
    """

    name: str
    text: str

    @property
    def title(self) -> str:
        """Its first heading."""
        return self.text.partition("\n")[0].lstrip("# ")

    @property
    def fields(self) -> list[tuple[str, str]]:
        """The keys of the actions that it names, each with what is told of it.

        Examples
        --------
        >>> Page("a.md", "Press {save.keys} or choose {save}.").fields
        [('save', 'keys'), ('save', '')]
        """
        return [(key, what.lstrip(".")) for key, what in _FIELD.findall(self.text)]

    def filled(self, words: Callable[[str, str], str]) -> Page:
        """Return the page as it is read.

        Parameters
        ----------
        words
            Returns what is told of an action, by its key and what is asked for.

        Examples
        --------
        >>> Page("a.md", "Press {save.keys}.").filled(lambda key, what: f"{key}: {what}").text
        'Press save: keys.'
        """
        text = _FIELD.sub(lambda found: words(found[1], found[2].lstrip(".")), self.text)
        return Page(self.name, with_own_keys(text))

    @property
    def plain(self) -> str:
        """What it says, without marks, in small letters: what a search looks through.

        Examples
        --------
        >>> Page("a.md", "# The *sign*").plain.strip()
        'the sign'
        """
        return _MARKS.sub(lambda found: found[1] or found[2] or "", self.text).casefold()


def read_pages(folder: Path) -> tuple[Page, ...]:
    """Return the pages of a folder in the order of their file names.

    Examples
    --------
    >>> from pinwarp.io.samples import help_folder
    >>> read_pages(help_folder())[0].title
    'The first warp'
    """
    return tuple(
        Page(path.name, path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.md"))
    )


def pages_about(pages: Sequence[Page], query: str) -> list[Page]:
    r"""Return the pages in which every word of a query occurs; those whose title has one first.

    Examples
    --------
    >>> pages = [Page("a.md", "# Maps\nof folds"), Page("b.md", "# Folds\nin maps")]
    >>> [page.name for page in pages_about(pages, "FOLD")]
    ['b.md', 'a.md']
    """
    words = query.casefold().split()
    found = [page for page in pages if all(word in page.plain for word in words)]
    return sorted(found, key=lambda page: not any(x in page.title.casefold() for x in words))
