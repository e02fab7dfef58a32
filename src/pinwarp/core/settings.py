"""How a warp is solved and applied, as one value: all that is chosen, and nothing of the pairs."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pinwarp.core.basis import Basis, check_basis
from pinwarp.core.components import Components, as_drawn
from pinwarp.core.errors import PinwarpError
from pinwarp.core.factor import check_planar
from pinwarp.core.lengths import Ruler
from pinwarp.core.spline import PenaltyConvention, check_penalty


@dataclass(frozen=True)
class WarpSettings:
    """What is chosen about a warp.

    Parameters
    ----------
    penalty
        The warping penalty, a length in source mesh units, or an area with the basis ``r^2 log r``;
        infinity is the affine fit.
    convention
        The equation that the penalty enters. With the basis ``r^2 log r`` there is but one, which
        then counts as the regularising.
    components, blend
        What of the warp is applied, to what is shown and to what is exported; see
        :func:`~pinwarp.core.components.applied`.
    planar
        Whether nearly planar landmarks are treated as planar: with the basis r only.
    basis
        What the spline is built of.

    Raises
    ------
    PenaltyError
        When the penalty is negative or NaN.
    PinwarpError
        When the blend is not from 0 to 1, or planar landmarks meet another basis than r.

    Examples
    --------
    >>> WarpSettings(2).penalty, WarpSettings(blend=0.5).is_whole
    (2.0, False)
    """

    penalty: float = 0.0
    convention: PenaltyConvention = PenaltyConvention.REGULARISING
    components: Components = Components.FULL
    blend: float = 1.0
    planar: bool = False
    basis: Basis = Basis.R

    def __post_init__(self) -> None:
        object.__setattr__(self, "penalty", check_penalty(self.penalty))
        object.__setattr__(self, "basis", check_basis(self.basis))
        object.__setattr__(self, "convention", self.convention.within(self.basis))
        check_planar(self.planar, self.basis)
        if not 0 <= self.blend <= 1:
            raise PinwarpError(f"The blend is {self.blend:.6g}; it must be from 0 to 1.")
        object.__setattr__(self, "blend", float(self.blend))

    @property
    def is_whole(self) -> bool:
        """Whether the warp is applied as it is solved."""
        return self.components is Components.FULL and self.blend == 1

    @property
    def whole(self) -> WarpSettings:
        """The same with all of the warp applied: what it is solved by, and nothing else."""
        return replace(self, components=Components.FULL, blend=1.0)

    def penalty_unit(self, unit: str) -> str:
        """Return the unit of the penalty, of that of the source."""
        return self.basis.penalty_unit(unit)

    def penalty_ruler(self, ruler: Ruler) -> Ruler:
        """Return how the penalty is told, of how lengths of the source are."""
        return ruler.to_the(self.basis.power)

    @property
    def is_regular(self) -> bool:
        """Whether the figures of the regularising convention hold: at no penalty both are one."""
        return self.convention is PenaltyConvention.REGULARISING or self.penalty == 0

    @property
    def drawn(self) -> WarpSettings:
        """The same for what is shown over the destination: with the pose put back."""
        return replace(self, components=as_drawn(self.components))


USUAL_SETTINGS = WarpSettings()
