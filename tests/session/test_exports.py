"""What leaves a session besides the warped mesh."""

from __future__ import annotations

import math
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import pinwarp
from pinwarp.core.alignment import fit_similarity
from pinwarp.core.components import Components
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark, Side, positions
from pinwarp.core.mesh import Mesh
from pinwarp.core.prediction import prediction_of
from pinwarp.core.spline import PenaltyConvention, factorise
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.meshes import read_mesh
from pinwarp.io.samples import assets_folder, sample_session
from pinwarp.session import edits
from pinwarp.session.judging.mesh_data import warped_mesh_data
from pinwarp.session.keeping.files import read_session
from pinwarp.session.mesh_units import scale_side
from pinwarp.session.outputs.exports import (
    session_coefficients,
    warped_landmarks,
    warped_mesh,
)
from pinwarp.session.outputs.script import script_of
from pinwarp.session.session import Session


@pytest.fixture(scope="module")
def sample() -> Session:
    return read_session(sample_session())


# Figures of the mesh


def test_distances_are_those_of_the_exported_vertices(sample):
    warped = warped_mesh(sample)
    data = warped_mesh_data(sample)
    expected = SurfaceIndex(sample.mesh(Side.DESTINATION)).distances(warped.vertices)
    assert np.array_equal(data.scalars["distance_mm"], expected)
    assert 0.05 < expected.max() < 4


def test_without_pose_distances_are_measured_where_the_destination_is(sample):
    """The exported vertices stay in the source's frame, far from the destination's surface."""
    whole = warped_mesh_data(sample).scalars
    session = edits.set_components(sample, Components.WITHOUT_POSE)
    data = warped_mesh_data(session).scalars
    assert np.array_equal(data["distance_mm"], whole["distance_mm"])
    for name in ("det_j", "largest_stretch", "smallest_stretch", "deviation_mm"):
        assert np.allclose(data[name], whole[name], rtol=1e-9)


def test_stretches_enclose_the_cube_root_of_the_volume(sample):
    data = warped_mesh_data(sample).scalars
    mean = np.cbrt(data["det_j"])
    assert (data["smallest_stretch"] <= mean + 1e-12).all()
    assert (mean <= data["largest_stretch"] + 1e-12).all()


def test_the_similarity_stretches_alike_everywhere(sample):
    session = edits.set_components(sample, Components.SIMILARITY)
    data = warped_mesh_data(session).scalars
    scale = fit_similarity(
        positions(sample.pairs, Side.SOURCE), positions(sample.pairs, Side.DESTINATION)
    ).scale
    assert np.allclose(data["largest_stretch"], scale)
    assert np.allclose(data["smallest_stretch"], scale)
    assert np.allclose(data["det_j"], scale**3)


def test_deviations_belong_to_what_is_applied(sample):
    source = positions(sample.pairs, Side.SOURCE)
    destination = positions(sample.pairs, Side.DESTINATION)
    places = sample.mesh(Side.SOURCE).vertices

    def deviations(session: Session) -> np.ndarray | None:
        return warped_mesh_data(session).scalars.get("deviation_mm")

    for session, penalty in (
        (edits.set_penalty(sample, 2.0), 2.0),
        (edits.set_components(sample, Components.AFFINE), math.inf),
    ):
        size = sample.mesh(Side.SOURCE).diagonal
        prediction = prediction_of(factorise(source), destination, penalty, size)
        assert np.allclose(deviations(session), prediction.standard_deviation(places))
    # Of these nothing is known: better no figure than a wrong one.
    assert deviations(edits.set_blend(sample, 0.5)) is None
    assert deviations(edits.set_components(sample, Components.RIGID)) is None
    opynsim = edits.set_penalty(edits.set_convention(sample, PenaltyConvention.OPYNSIM), 0.01)
    assert deviations(opynsim) is None


def test_few_pairs_and_no_destination_give_fewer_figures(sample):
    few = replace(sample, landmarks=sample.pairs[:2], destination=None)
    data = warped_mesh_data(few)
    assert set(data.scalars) == {"det_j", "largest_stretch", "smallest_stretch"}
    assert data.normals.shape == few.mesh(Side.SOURCE).vertices.shape
    # Of three it is what bones of that size are known for.
    three = warped_mesh_data(replace(few, landmarks=sample.pairs[:3])).scalars["deviation_mm"]
    assert 1 < np.median(three) < 150


@pytest.mark.parametrize(
    ("unit", "name"),
    [
        ("m", "distance_m"),
        ("µm", "distance_um"),
        ("", "distance"),
        ("1/10 inch", "distance_1_10_inch"),
    ],
)
def test_every_unit_makes_a_name_that_can_be_written(sample, unit, name):
    session = replace(sample, unit=unit)
    assert name in warped_mesh_data(session).scalars


def test_an_export_can_be_cancelled_at_every_stage(sample):
    stages: list[str] = []
    warped_mesh_data(sample, progress=lambda _s, stage: stages.append(stage))
    assert len(set(stages)) == 4
    for wanted in set(stages):

        def cancel(_share: float, stage: str, wanted: str = wanted) -> None:
            if stage == wanted:
                raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            warped_mesh_data(sample, progress=cancel)


# Landmarks and coefficients


def test_the_warped_landmarks_are_the_destinations_at_penalty_0(sample):
    carried = warped_landmarks(sample)
    assert [x.name for x in carried] == [pair.name for pair in sample.pairs]
    expected = positions(sample.pairs, Side.DESTINATION)
    assert np.allclose(positions(carried, Side.DESTINATION), expected, rtol=0, atol=1e-9)


def test_the_warped_landmarks_follow_what_is_applied(sample):
    session = edits.set_components(sample, Components.RIGID)
    source = positions(sample.pairs, Side.SOURCE)
    fit = fit_similarity(source, positions(sample.pairs, Side.DESTINATION), scaling=False)
    carried = positions(warped_landmarks(session), Side.DESTINATION)
    assert np.allclose(carried, fit.apply(source), rtol=0, atol=1e-9)


def test_without_pairs_nothing_is_carried():
    with pytest.raises(PinwarpError, match="no pair"):
        warped_landmarks(Session(landmarks=(Landmark("half", (0, 0, 0)),)))


@pytest.mark.parametrize("components", list(Components))
def test_the_coefficients_are_those_of_the_exported_mesh(sample, components):
    session = edits.set_blend(edits.set_components(sample, components), 0.75)
    coefficients = session_coefficients(session)
    evaluated = coefficients.spline.evaluate(session.mesh(Side.SOURCE).vertices)
    assert np.array_equal(evaluated, warped_mesh(session).vertices)
    assert coefficients.settings == session.settings
    assert (session.settings.components, session.settings.blend) == (components, 0.75)
    assert coefficients.source_sha256 == session.source.sha256
    assert coefficients.version == pinwarp.__version__


# The script


def run_script(session: Session, folder: Path) -> tuple[Mesh, str]:
    script = folder / "warp.py"
    script.write_text(script_of(session, folder), encoding="utf-8")
    source_tree = Path(pinwarp.__file__).resolve().parents[1]
    done = subprocess.run(
        [sys.executable, "-W", "error", str(script)],
        # Somewhere else: the script must not depend on where it is started.
        cwd="/",
        env={**os.environ, "PYTHONPATH": str(source_tree)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return read_mesh(folder / "femur_generic_warped.ply").mesh, done.stdout


@pytest.fixture
def beside(sample, tmp_path) -> Session:
    """The sample with its source in the folder of the script."""
    path = Path(shutil.copy(assets_folder() / "femur_generic.ply", tmp_path))
    return replace(sample, source=read_mesh(path))


@pytest.mark.parametrize(
    "change",
    [
        lambda session: session,
        lambda session: edits.set_penalty(session, 12.3456789),
        lambda session: edits.set_penalty(session, math.inf),
        lambda session: edits.set_penalty(
            edits.set_convention(session, PenaltyConvention.OPYNSIM), 0.015
        ),
        lambda session: edits.set_blend(
            edits.set_components(session, Components.WITHOUT_POSE), 1 / 3
        ),
        lambda session: edits.set_planar(session, True),
        lambda session: edits.mirror_source(session, "x"),
        lambda session: scale_side(edits.mirror_source(session, "x"), Side.SOURCE, 0.001),
    ],
    ids=["whole", "penalty", "affine", "opynsim", "in part", "planar", "mirrored", "scaled"],
)
def test_the_script_writes_the_mesh_that_is_exported(beside, tmp_path, change):
    session = change(beside)
    mesh, said = run_script(session, tmp_path)
    expected = warped_mesh(session)
    assert np.abs(mesh.vertices - expected.vertices).max() <= 1e-12
    assert np.array_equal(mesh.faces, expected.faces)
    assert "is not the file" not in said


def test_the_script_says_when_the_mesh_is_another(beside, tmp_path):
    with beside.source.path.open("ab") as file:
        file.write(b"\n")
    _, said = run_script(beside, tmp_path)
    assert "femur_generic.ply is not the file that the landmarks were placed on" in said


def test_names_are_harmless_in_a_script(beside, tmp_path):
    first, *others = beside.landmarks
    odd = replace(first, name="""it's "odd" \\ # \N{GREEK SMALL LETTER ALPHA}""")
    session = replace(beside, landmarks=(odd, *others))
    mesh, _ = run_script(session, tmp_path)
    assert np.array_equal(mesh.vertices, warped_mesh(session).vertices)


def test_a_mesh_elsewhere_is_named_by_its_whole_path(sample, tmp_path):
    script = script_of(sample, tmp_path)
    assert f"Path({sample.source.path.as_posix()!r})" in script


def test_without_a_mesh_or_a_pair_there_is_no_script(sample, tmp_path):
    with pytest.raises(PinwarpError, match="no source mesh"):
        script_of(replace(sample, source=None), tmp_path)
    with pytest.raises(PinwarpError, match="no pair"):
        script_of(replace(sample, landmarks=()), tmp_path)
