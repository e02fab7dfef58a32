"""Pair landmarks on two meshes and warp one into the other with a 3D thin-plate spline.

Everything a script needs is here; what a name stands on is loaded when it is first used, VTK
only with meshes that need it, Qt never.

Sessions
    :class:`Session`, :class:`WarpSettings`, :func:`read_session`, :func:`write_session`,
    :func:`warped_mesh`, :func:`warped_passengers`, :func:`check`, :class:`Check`,
    :func:`refined_session`, :class:`RefinementOptions`
Landmarks and meshes
    :class:`Landmark`, :class:`Side`, :class:`Role`, :func:`read_landmarks`,
    :func:`write_landmarks`, :class:`Mesh`, :class:`MeshFile`, :func:`read_mesh`,
    :func:`write_mesh`, :func:`compare_surfaces`
Models of OpenSim
    :func:`read_model`, :func:`warp_model`, :func:`write_model`, :class:`OsimModel`,
    :class:`WarpedModel`, :class:`ElementRow`
The spline
    :func:`solve_coefficients`, :class:`TPSCoefficients3D`, :class:`PenaltyConvention`,
    :class:`Basis`, :class:`Components`, :func:`factorise`, :func:`leave_one_out`,
    :func:`suspects`, :func:`penalty_curve`, :func:`repeatability`, :func:`noise_level`
What can go wrong
    :class:`PinwarpError`, :class:`PinwarpWarning`

Examples
--------
>>> import pinwarp
>>> from pinwarp.io.samples import sample_session
>>> session = pinwarp.read_session(sample_session())
>>> warped = pinwarp.warped_mesh(session)
>>> pinwarp.compare_surfaces(warped, session.destination.mesh).forward_figures.maximum < 4  # mm
True
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pinwarp.core.components import Components
    from pinwarp.core.errors import PinwarpError, PinwarpWarning
    from pinwarp.core.factor import factorise
    from pinwarp.core.landmarks import Landmark, Role, Side
    from pinwarp.core.mesh import Mesh
    from pinwarp.core.model_rows import ElementRow
    from pinwarp.core.noise import noise_level
    from pinwarp.core.quality import leave_one_out, penalty_curve
    from pinwarp.core.repeatability import repeatability
    from pinwarp.core.settings import WarpSettings
    from pinwarp.core.surface_comparison import compare_surfaces
    from pinwarp.core.suspects import suspects
    from pinwarp.io.landmark_files import read_landmarks, write_landmarks
    from pinwarp.io.meshes import MeshFile, read_mesh, write_mesh
    from pinwarp.io.osim.model import OsimModel
    from pinwarp.io.osim.reading import read_model
    from pinwarp.session.judging.check import Check, check
    from pinwarp.session.keeping.files import read_session, write_session
    from pinwarp.session.model.library import warp_model
    from pinwarp.session.model.warped import WarpedModel
    from pinwarp.session.model.writing import write_model
    from pinwarp.session.outputs.exports import warped_mesh, warped_passengers
    from pinwarp.session.session import Session
    from pinwarp.session.warp.refining import RefinementOptions, refined_session
    from pinwarp.tps3d import Basis, PenaltyConvention, TPSCoefficients3D, solve_coefficients

from pinwarp.version import __version__

__all__ = [
    "Basis",
    "Check",
    "Components",
    "ElementRow",
    "Landmark",
    "Mesh",
    "MeshFile",
    "OsimModel",
    "PenaltyConvention",
    "PinwarpError",
    "PinwarpWarning",
    "RefinementOptions",
    "Role",
    "Session",
    "Side",
    "TPSCoefficients3D",
    "WarpSettings",
    "WarpedModel",
    "__version__",
    "check",
    "compare_surfaces",
    "factorise",
    "leave_one_out",
    "noise_level",
    "penalty_curve",
    "read_landmarks",
    "read_mesh",
    "read_model",
    "read_session",
    "refined_session",
    "repeatability",
    "solve_coefficients",
    "suspects",
    "warp_model",
    "warped_mesh",
    "warped_passengers",
    "write_landmarks",
    "write_mesh",
    "write_model",
    "write_session",
]

_HOMES = {
    "core.components": ("Components",),
    "core.errors": ("PinwarpError", "PinwarpWarning"),
    "core.factor": ("factorise",),
    "core.landmarks": ("Landmark", "Role", "Side"),
    "core.mesh": ("Mesh",),
    "core.model_rows": ("ElementRow",),
    "core.noise": ("noise_level",),
    "core.quality": ("leave_one_out", "penalty_curve"),
    "core.repeatability": ("repeatability",),
    "core.settings": ("WarpSettings",),
    "core.surface_comparison": ("compare_surfaces",),
    "core.suspects": ("suspects",),
    "io.landmark_files": ("read_landmarks", "write_landmarks"),
    "io.meshes": ("MeshFile", "read_mesh", "write_mesh"),
    "io.osim.model": ("OsimModel",),
    "io.osim.reading": ("read_model",),
    "session.judging.check": ("Check", "check"),
    "session.model.library": ("warp_model",),
    "session.model.warped": ("WarpedModel",),
    "session.model.writing": ("write_model",),
    "session.outputs.exports": ("warped_mesh", "warped_passengers"),
    "session.keeping.files": ("read_session", "write_session"),
    "session.session": ("Session",),
    "session.warp.refining": ("RefinementOptions", "refined_session"),
    "tps3d": ("Basis", "PenaltyConvention", "TPSCoefficients3D", "solve_coefficients"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    """Load a public name at its first use."""
    if name not in _HOME_OF:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOME_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Return the public names, loaded or not."""
    return sorted({*globals(), *__all__})
