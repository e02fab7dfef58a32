"""A slide under the hand: planes and tangents are held, the points go on sliding on them.

To slide anew takes too long for a frame. While a landmark is dragged, the surface next to each
point is taken for its plane and each curve for its tangent, as they were at rest: that is one
solve with what is factorised already.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.conditions import ConditionFactor, factorise_conditions
from pinwarp.core.errors import LandmarkError
from pinwarp.core.positions import as_positions
from pinwarp.core.sliding import Slid
from pinwarp.core.spline import Spline

Matrix = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HeldSlide:
    """What came to rest, ready to follow its landmarks.

    Sliding ends where another turn would save next to nothing, not where nothing would move any
    more. What is left of the pull along planes and tangents is kept up, so that the points stay
    where they are until a landmark moves.

    Attributes
    ----------
    factor
        The places, landmarks first, and how they are held.
    destination : (m, 3) float64
        Where they came to rest.
    pulls : (m, 3)
        The weights that were left across what holds them.
    landmarks
        How many of the places are landmarks.

    Examples
    --------
    >>> from pinwarp.core.mesh import Mesh
    >>> from pinwarp.core.sliding import Semilandmarks, slide
    >>> from pinwarp.core.surface import Surface
    >>> square = Mesh([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> source = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [3, 3, 1]])
    >>> points = Semilandmarks(np.array([[1.0, 2.0, 0.0]]), np.array([[0.0, 0.0, 1.0]]))
    >>> held = HeldSlide.of(slide(source, 2 * source, points, Surface(square)))
    >>> np.abs(held.warp(3 * source).evaluate(points.source)).round(9).tolist()
    [[3.0, 6.0, 0.0]]
    """

    factor: ConditionFactor
    destination: Matrix
    pulls: Matrix
    landmarks: int

    @classmethod
    def of(cls, slid: Slid) -> HeldSlide:
        """Return a finished slide with its planes and tangents held."""
        conditions, spline = slid.conditions, slid.spline
        pulls = spline.weights.copy()
        along = np.sum(conditions.directions * pulls[conditions.rows], axis=1, keepdims=True)
        np.subtract.at(pulls, conditions.rows, along * conditions.directions)
        factor = factorise_conditions(spline.source, conditions)
        # Now, in whatever thread this is, and not in the first frame.
        _ = factor.lower
        return cls(
            factor=factor,
            destination=spline.evaluate(spline.source),
            pulls=pulls,
            landmarks=slid.landmarks,
        )

    def warp(self, destination: ArrayLike) -> Spline:
        """Return the warp once landmarks have moved on the destination.

        Parameters
        ----------
        destination
            (n, 3) all landmarks there, moved or not.

        Returns
        -------
        Spline
            An ordinary one; with nothing moved that of the slide.

        Raises
        ------
        LandmarkError
            When there are more or fewer landmarks, or a row cannot be used.
        """
        places = self.destination.copy()
        places[: self.landmarks] = self._checked(destination, "destination landmark")
        return self.factor.solve(places, pulls=self.pulls)

    def with_source(self, source: ArrayLike) -> HeldSlide:
        """Return the same once landmarks have moved on the source: factorised anew.

        Parameters
        ----------
        source
            (n, 3) all landmarks there, moved or not.

        Raises
        ------
        LandmarkError
            When there are more or fewer landmarks, a row cannot be used, or they no longer
            determine a warp.
        """
        places = self.factor.source.copy()
        places[: self.landmarks] = self._checked(source, "source landmark")
        factor = factorise_conditions(places, self.factor.conditions)
        return HeldSlide(factor, self.destination, self.pulls, self.landmarks)

    def _checked(self, positions: ArrayLike, what: str) -> Matrix:
        landmarks = as_positions(positions, what)
        if len(landmarks) != self.landmarks:
            raise LandmarkError(
                f"There are {self.landmarks} landmarks in the slide but {len(landmarks)} here: "
                "slide anew."
            )
        return landmarks
