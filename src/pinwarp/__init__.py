"""Pair landmarks on two meshes and warp one into the other with a 3D thin-plate spline."""

from pinwarp.core.errors import PinwarpError, PinwarpWarning
from pinwarp.tps3d import PenaltyConvention, TPSCoefficients3D, solve_coefficients

__version__ = "0.1.0"

__all__ = [
    "PenaltyConvention",
    "PinwarpError",
    "PinwarpWarning",
    "TPSCoefficients3D",
    "__version__",
    "solve_coefficients",
]
