"""Keys in sentences, as the keyboard has them that one sits before."""

from __future__ import annotations

import sys


def with_own_keys(words: str, system: str = sys.platform) -> str:
    """Return a sentence with its keys called as on this system.

    Qt takes the command key of a Mac for Ctrl, in shortcuts as with the mouse, and calls it so in
    menus.

    Parameters
    ----------
    words
        With keys such as ``Ctrl+click``.
    system
        As ``sys.platform`` has it.

    Examples
    --------
    >>> with_own_keys("open it with Ctrl+1", "linux"), with_own_keys("Ctrl+click", "darwin")
    ('open it with Ctrl+1', '⌘click')
    """
    return words.replace("Ctrl+", "⌘") if system == "darwin" else words
