"""What a script may rely on: these names, each with an example that runs."""

from __future__ import annotations

import inspect
import subprocess
import sys

import numpy as np
import pytest

import pinwarp

NAMES = [
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


def test_the_public_names_are_these():
    assert pinwarp.__all__ == NAMES
    assert set(NAMES) <= set(dir(pinwarp))


@pytest.mark.parametrize("name", [name for name in NAMES if name != "__version__"])
def test_every_public_name_is_documented_with_an_example(name):
    thing = getattr(pinwarp, name)
    # A class's own: what it inherits does not count.
    words = vars(thing).get("__doc__") if inspect.isclass(thing) else thing.__doc__
    assert words
    assert ">>> " in words


def test_a_name_that_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'pinwarp' has no attribute 'warp_drive'"):
        _ = pinwarp.warp_drive


def test_importing_it_loads_nothing_heavy_and_meshes_need_no_vtk():
    code = (
        "import sys, pinwarp\n"
        "heavy = ('numpy', 'scipy', 'numba', 'vtk', 'vtkmodules', 'pyvista', 'qtpy')\n"
        "assert not [name for name in heavy if name in sys.modules]\n"
        "from pinwarp.io.samples import sample_session\n"
        "pinwarp.warped_mesh(pinwarp.read_session(sample_session()))\n"
        "assert not [name for name in heavy[3:] if name in sys.modules]\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_a_script_reads_warps_judges_and_writes(tmp_path):
    mesh = pinwarp.Mesh(np.vstack([np.zeros(3), np.eye(3)]), [[0, 2, 1], [0, 1, 3], [1, 2, 3]])
    pinwarp.write_mesh(tmp_path / "source.stl", mesh)
    rng = np.random.default_rng(0)
    marks = [
        pinwarp.Landmark(f"p{row}", tuple(a.tolist()), tuple((2 * a + 1).tolist()))
        for row, a in enumerate(rng.normal(size=(6, 3)))
    ]
    session = pinwarp.Session(pinwarp.read_mesh(tmp_path / "source.stl"), landmarks=tuple(marks))
    pinwarp.write_session(tmp_path / "a.pinwarp.csv", session)
    again = pinwarp.read_session(tmp_path / "a.pinwarp.csv")
    warped = pinwarp.warped_mesh(again).vertices
    assert warped == pytest.approx(2 * again.mesh(pinwarp.Side.SOURCE).vertices + 1)
    assert pinwarp.check(again).rms_residual == pytest.approx(0, abs=1e-9)
    pinwarp.write_landmarks(tmp_path / "a.fcsv", marks, pinwarp.Side.DESTINATION)
    reading = pinwarp.read_landmarks(tmp_path / "a.fcsv", pinwarp.Side.DESTINATION)
    assert [x.destination for x in reading.landmarks] == [x.destination for x in marks]
