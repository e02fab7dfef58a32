"""What the Edit menu does to whole bones: swapping the sides, mirroring the source."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from pinwarp.core.landmarks import Side
from pinwarp.core.mirror import AXES
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session


class BoneEdits(Capability):
    """What changes a whole side.

    Parameters
    ----------
    editor
        The truth.
    say
        Tells what cannot be done, and why.
    """

    def __init__(self, editor: Editor, say: Callable[[str], None]) -> None:
        self._editor = editor
        self._say = say
        self.actions = (
            Action(
                "swap_sides",
                "S&wap Source and Destination",
                self.swap,
                at="Edit.72",
                tip="Warp the other way round",
                possible=lambda: any(editor.session.mesh_file(side) for side in Side),
            ),
            *(
                Action(
                    f"mirror_{axis}",
                    f"Across &{axis.upper()}",
                    partial(self.mirror, axis),
                    at=f"mirror.1{number}",
                    tip=f"Left becomes right along {axis}",
                    possible=self.can_mirror,
                )
                for number, axis in enumerate(AXES, 1)
            ),
        )

    def can_mirror(self) -> bool:
        """Whether there is a source mesh to be mirrored."""
        return self._editor.session.mesh(Side.SOURCE) is not None

    def swap(self) -> None:
        """Warp the other way round."""
        self._try(edits.swap_sides, "Swap source and destination")

    def mirror(self, axis: str) -> None:
        """Make a left source a right one."""
        self._try(partial(edits.mirror_source, axis=axis), f"Mirror source across {axis}")

    def _try(self, edit: Callable[[Session], Session], label: str) -> None:
        problem = self._editor.attempt(edit, label)
        if problem:
            self._say(problem)
