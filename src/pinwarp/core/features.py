"""How fine a refinement bends: the places that a smallest feature takes, and the levels to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pinwarp.core.mesh import Mesh
from pinwarp.core.sampling import triangle_areas

# Without a smallest feature given, so many places are spread; never fewer or more than these.
PLACES = 1200
FEWEST_PLACES, MOST_PLACES = 150, 3000
# The first level's wavelength as a share of the source's diagonal, and from level to level.
COARSEST = 0.5
SHRINK = 0.7
NEXT = 1.1
# A feature that was read from a file must not take a place more for its last digit.
_ROUNDING = 1e-6


@dataclass(frozen=True)
class FeatureRange:
    """Which smallest features make sense on a mesh, in its unit.

    Attributes
    ----------
    finest
        What the most places resolve.
    usual
        What is taken without a choice.
    coarsest
        With this there is a single level.
    """

    finest: float
    usual: float
    coarsest: float

    @classmethod
    def of(cls, source: Mesh) -> FeatureRange:
        """Return the range for a source mesh.

        Examples
        --------
        >>> square = Mesh([[0, 0, 0], [60, 0, 0], [60, 80, 0]], [[0, 1, 2]])
        >>> found = FeatureRange.of(square)
        >>> round(found.usual, 3), found.coarsest
        (1.414, 50.0)
        """
        area = float(triangle_areas(source).sum())
        finest, usual = (float(np.sqrt(area / count)) for count in (MOST_PLACES, PLACES))
        return cls(finest, usual, max(COARSEST * source.diagonal, usual))


def places_for(area: float, feature: float | None) -> int:
    """Return how many places are spread for a smallest feature.

    Examples
    --------
    >>> places_for(4800.0, None), places_for(4800.0, 2.0), places_for(4800.0, 1e-3)
    (1200, 1200, 3000)
    """
    if feature is None:
        return PLACES
    # As many as a level of that wavelength uses, but no more than resolve it where it is small.
    wanted = min(4 * area / feature**2, max(PLACES, area / feature**2))
    return int(np.clip(np.ceil(wanted - _ROUNDING), FEWEST_PLACES, MOST_PLACES))


def levels_to(smallest: float, diagonal: float) -> tuple[float, ...]:
    """Return the wavelengths of the levels, from the coarsest to the smallest feature.

    Examples
    --------
    >>> levels_to(20.0, 100.0)
    (50.0, 35.0, 24.5, 20.0)
    """
    features = [max(COARSEST * diagonal, smallest)]
    # A level just above the last one would only be done twice.
    while features[-1] * SHRINK > NEXT * smallest:
        features.append(features[-1] * SHRINK)
    return (*features, smallest) if features[-1] > smallest else tuple(features)
