"""The same landmarks in OPynSim's model warper, pre-aligned; skipped where it is not installed.

Its affine rotation and translation are applied, which leaves the pose out only because the
subject's landmarks were brought over the bone before.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest
from tests.osim_models import copied_model, session_on

from pinwarp.core.alignment import fit_similarity
from pinwarp.io.meshes import read_mesh
from pinwarp.io.osim.reading import read_model
from pinwarp.session.model.study import study_of
from pinwarp.session.model.warped import warped_model

COMMON = (
    "<landmarks_frame>/bodyset/thigh</landmarks_frame>"
    "<source_landmarks_file>source.csv</source_landmarks_file>"
    "<destination_landmarks_file>destination.csv</destination_landmarks_file>"
    "<apply_affine_translation>true</apply_affine_translation>"
    "<apply_affine_rotation>true</apply_affine_rotation>"
)


def document(points: list[str], markers: list[str]) -> str:
    """Return the steps of a model warper."""
    steps = (
        ("PathPoints", f"<path_points>{' '.join(points)}</path_points>"),
        ("Stations", f"<stations>{' '.join(markers)}</stations>"),
        ("Meshes", "<meshes>/bodyset/thigh/thigh_geom</meshes>"),
    )
    inner = "".join(
        f'<ThinPlateSpline{kind}ScalingStep name="{kind}">{COMMON}{what}'
        f"</ThinPlateSpline{kind}ScalingStep>"
        for kind, what in steps
    )
    return (
        '<?xml version="1.0" encoding="UTF-8" ?><OpenSimDocument Version="40600">'
        f'<ModelWarperV3Document name="parity"><components>{inner}</components>'
        "</ModelWarperV3Document></OpenSimDocument>"
    )


def test_points_and_meshes_are_those_of_opynsims_model_warper(tmp_path):
    opynsim = pytest.importorskip("opynsim")
    leg = copied_model("leg", tmp_path)
    session = session_on(leg, "thigh")
    source = np.array([pair.source for pair in session.pairs])
    there = np.array([pair.destination for pair in session.pairs])
    pose = fit_similarity(source, there, scaling=False)
    aligned = (there - pose.translation) @ pose.rotation
    for name, places in (("source", source), ("destination", aligned)):
        rows = "".join(f"p{i},{x!r},{y!r},{z!r}\n" for i, (x, y, z) in enumerate(places.tolist()))
        (tmp_path / f"{name}.csv").write_text(f"name,x,y,z\n{rows}")
    warped = warped_model(study_of(read_model(leg), {"thigh": session}))
    places = warped.bodies[0].places
    points = [path for path in places if path.startswith("/forceset")]
    markers = [path for path in places if path.startswith("/markerset")]
    (tmp_path / "steps.xml").write_text(document(points, markers))
    specification = opynsim.read_osim(str(leg))
    theirs = opynsim.solvers.ModelWarper.from_xml(str(tmp_path / "steps.xml")).warp(specification)
    theirs.flush_in_memory_resources_to("theirs")
    root = ET.fromstring(theirs.to_osim())
    located = [element for element in root.iter() if element.find("location") is not None]
    named = {element.get("name"): element.findtext("location") for element in located}
    for path, place in places.items():
        found = np.array(named[path.rsplit("/", 1)[-1]].split(), dtype=float)
        assert np.abs(found - place).max() < 1e-5, "a hundredth of a millimetre"
    (mesh,) = warped.meshes.values()
    drawn = read_mesh(tmp_path / "theirs" / "thigh_geom.obj").mesh
    assert len(drawn.vertices) == len(mesh.vertices)
    assert np.abs(drawn.vertices - mesh.vertices).max() < 1e-5
