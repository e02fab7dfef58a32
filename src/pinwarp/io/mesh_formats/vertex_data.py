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
    """Normals and scalars of a mesh's vertices.

    Parameters
    ----------
    normals
        (m, 3) unit vectors, or None.
    scalars
        (m,) numbers by name; names are letters, digits and underscores.

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

    def __post_init__(self) -> None:
        for name in self.scalars:
            if not _NAME.fullmatch(name):
                raise ValueError(f"{name!r} cannot be the name of a mesh's scalars.")


NO_DATA = VertexData()
