"""What may be written with a mesh besides its places and triangles."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

# What every format takes for a name.
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


@dataclass(frozen=True, eq=False)
class VertexData:
    """Normals and scalars of a mesh's vertices, and how they came about.

    Parameters
    ----------
    normals
        (m, 3) unit vectors, or None.
    scalars
        (m,) numbers by name; names are letters, digits and underscores.
    remarks
        Lines for people, such as what made the mesh; they go where a format has comments.

    Raises
    ------
    ValueError
        When a name cannot be written.

    Examples
    --------
    >>> VertexData(scalars={"distance_mm": np.zeros(3)}).scalars["distance_mm"].shape
    (3,)
    """

    normals: NDArray[np.float64] | None = None
    scalars: Mapping[str, NDArray[np.floating]] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for name in self.scalars:
            if not _NAME.fullmatch(name):
                raise ValueError(f"{name!r} cannot be the name of a mesh's scalars.")

    @property
    def plain_remarks(self) -> tuple[str, ...]:
        r"""The remarks as every format takes them: a line each, of ASCII.

        Examples
        --------
        >>> VertexData(remarks=("of the fémur\nleft",)).plain_remarks
        ('of the f?mur left',)
        """
        return tuple(
            " ".join(remark.split()).encode("ascii", "replace").decode() for remark in self.remarks
        )


NO_DATA = VertexData()
