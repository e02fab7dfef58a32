"""A mesh made of parts that stand somewhere: what scenes of glTF and 3MF come down to."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pinwarp.io.mesh_formats.allowance import Allowance
from pinwarp.io.mesh_formats.surface import BrokenMeshError

MOST = 10_000
"""More parts than any bone has; scenes can repeat one a billion times."""


class Parts:
    """Puts parts together, each at its place.

    Parameters
    ----------
    allowance
        How much all of them may come to.

    Examples
    --------
    >>> parts = Parts(Allowance(100))
    >>> parts.add(np.eye(3), np.array([[0, 1, 2]]), np.diag([-1.0, 1, 1, 1]))
    >>> points, triangles = parts.together()
    >>> points[0].tolist(), triangles.tolist()
    ([-1.0, 0.0, 0.0], [[0, 2, 1]])
    """

    def __init__(self, allowance: Allowance) -> None:
        self._allowance = allowance
        self._points: list[NDArray[np.float64]] = []
        self._triangles: list[NDArray[np.int64]] = []
        self._count = 0
        self._looked_at = 0

    def __len__(self) -> int:
        return len(self._points)

    def take_one(self) -> None:
        """Count a part that is about to be looked at.

        Raises
        ------
        BrokenMeshError
            When there are too many.
        """
        self._looked_at += 1
        if self._looked_at > MOST:
            raise BrokenMeshError(
                f"It has more than {MOST:,} parts, which are no bone. Export the bone alone."
            )

    def add(
        self,
        points: NDArray[np.float64],
        triangles: NDArray[np.int64],
        matrix: NDArray[np.float64],
    ) -> None:
        """Add a part.

        Parameters
        ----------
        points
            (n, 3) positions.
        triangles
            (t, 3) vertex numbers.
        matrix
            (4, 4), to be multiplied with columns. One that mirrors turns the triangles round.

        Raises
        ------
        BrokenMeshError
            When a vertex does not exist, or all parts together are too large.
        """
        self._allowance.take(points.nbytes + triangles.nbytes)
        if triangles.size and not (triangles.min() >= 0 and triangles.max() < len(points)):
            raise BrokenMeshError(
                "A triangle names a vertex that does not exist: the file is damaged. "
                "Export or copy it again."
            )
        # Coordinates that are not moved stay as they are, to the last digit.
        if not np.array_equal(matrix, np.eye(4)):
            points = points @ matrix[:3, :3].T + matrix[:3, 3]
            if np.linalg.det(matrix[:3, :3]) < 0:
                triangles = triangles[:, [0, 2, 1]]
        self._points.append(points)
        self._triangles.append(triangles + self._count)
        self._count += len(points)

    def together(self) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return the points and triangles of all parts."""
        return (
            np.concatenate([np.empty((0, 3)), *self._points]),
            np.concatenate([np.empty((0, 3), dtype=np.int64), *self._triangles]),
        )

    def note(self) -> tuple[str, ...]:
        """Say that there were several."""
        return (f"{len(self):,} parts became one mesh.",) if len(self) > 1 else ()
