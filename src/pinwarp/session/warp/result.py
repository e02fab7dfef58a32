"""What a warp is computed from, and what comes of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pinwarp.core.factor import SourceFactor
from pinwarp.core.landmarks import Position, Side
from pinwarp.core.lengths import rms
from pinwarp.core.mesh import Mesh
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import Spline
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.session.session import Session
from pinwarp.session.warp.refined import refinement_in_use
from pinwarp.session.warp.rested import rest_in_use
from pinwarp.session.warp.sliding import SlidGroups, SlidingInputs

Matrix = NDArray[np.float64]


# So many pairs an affine map meets.
_MET_BY_AFFINE = 4


@dataclass(frozen=True)
class WarpInputs:
    """All that a warp depends on, and nothing that it does not (such as names)."""

    source: tuple[Position, ...]
    destination: tuple[Position, ...]
    settings: WarpSettings
    mesh: Mesh | None
    stand_in: Mesh | None
    passengers: tuple[Position, ...]
    refinement: RefinementRecord | None = None
    sliding: SlidingInputs | None = None

    @classmethod
    def of(cls, session: Session, stand_in: Mesh | None = None) -> WarpInputs:
        """Collect the inputs from a session.

        Parameters
        ----------
        session
            What is to be warped.
        stand_in
            A coarse source mesh, drawn while something moves; None where the mesh itself will do.
        """
        pairs = session.pairs
        source = tuple(pair.source for pair in pairs if pair.source is not None)
        destination = tuple(pair.destination for pair in pairs if pair.destination is not None)
        refinement = refinement_in_use(session)
        sliding = None
        if session.groups:
            has_both = all(session.mesh(side) is not None for side in Side)
            sliding = SlidingInputs.of(session, None if has_both else rest_in_use(session))
        return cls(
            source=source,
            destination=destination,
            settings=session.settings.drawn,
            mesh=session.mesh(Side.SOURCE),
            stand_in=stand_in,
            passengers=tuple(
                passenger.source for passenger in session.passengers if passenger.source is not None
            ),
            refinement=refinement,
            sliding=sliding,
        )

    @property
    def without_meshes(self) -> WarpInputs:
        """The same with no mesh in it, for whoever remembers a warp and keeps no mesh alive."""
        sliding = self.sliding
        if sliding is not None:
            sliding = replace(sliding, mesh=None, target=None)
        return replace(self, mesh=None, stand_in=None, sliding=sliding)


@dataclass(frozen=True, eq=False)
class WarpResult:
    """A solved warp and what it does to the session it was solved for.

    Attributes
    ----------
    inputs
        What it was computed from.
    factor, spline
        Of the pairs, and the warp: None when there are no pairs or the solve failed.
    semilandmarks
        Where they are at rest, or were when something began to move; None without groups, and
        where they cannot slide.
    not_sliding
        Why they cannot, in words for the user: the warp is then that of the pairs alone.
    fit
        What the warp was solved from: factor and (k, 3) destinations of the pairs and, below
        them, of the semilandmarks.
    shown
        What is applied of the spline: all that follows here is its doing.
    landmarks : (n, 3) float64
        The warped source landmarks.
    residuals : (n,) float64
        Distance of each warped source landmark from its destination, in mesh units.
    vertices : (m, 3) float32 or None
        The warped source mesh, for the screen; None too in a preview that warps the stand-in.
    stand_in : (k, 3) float32 or None
        The warped stand-in.
    passengers : (p, 3) float64
        The warped passengers.
    problem
        Why there is no warp, in words for the user, where that is an error.
    """

    inputs: WarpInputs
    factor: SourceFactor | None = None
    spline: Spline | None = None
    semilandmarks: SlidGroups | None = None
    not_sliding: str | None = None
    fit: tuple[SourceFactor, Matrix] | None = None
    shown: Spline | None = None
    landmarks: Matrix | None = None
    residuals: Matrix | None = None
    vertices: NDArray[np.float32] | None = None
    stand_in: NDArray[np.float32] | None = None
    passengers: Matrix | None = None
    problem: str | None = None

    @property
    def is_fitted(self) -> bool:
        """Whether it was fitted to the surface: how near it comes then proves nothing."""
        return self.semilandmarks is not None or self.inputs.refinement is not None

    @property
    def rms_residual(self) -> float | None:
        """Root mean square of the residuals, in mesh units."""
        return None if self.residuals is None else rms(self.residuals)

    @property
    def flexibility(self) -> float | None:
        """Share of non-affine freedom left; None where the penalty has nothing to act on."""
        if self.factor is None or not self.factor.has_modes or not len(self.factor.poles):
            return None
        # Four can only bend if they lie in a plane, off which they say nothing.
        if len(self.inputs.source) <= _MET_BY_AFFINE:
            return None
        if not self.inputs.settings.is_regular:
            return None
        return self.factor.flexibility(self.inputs.settings.penalty)
