"""The landmarks of the real femur."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from pinwarp.core.mesh import Mesh
from pinwarp.io.meshes import read_mesh


def femur_landmarks(shared_data: Path) -> tuple[list[str], np.ndarray, np.ndarray]:
    """Names, source and destination landmarks in millimetres."""
    folder = shared_data / "opensim-creator-femur"
    source = _read(folder / "femur_r_warp.landmarks.csv")
    destination = _read(folder / "subject_femur_r.landmarks.csv")
    names = sorted(source)
    metres = (np.array([side[name] for name in names]) for side in (source, destination))
    return names, *(1000 * side for side in metres)


def _read(path):
    with path.open() as file:
        return {row[0]: [float(x) for x in row[1:4]] for row in list(csv.reader(file))[1:] if row}


def femur_meshes(shared_data: Path) -> tuple[Mesh, Mesh]:
    """Source and destination in millimetres."""
    folder = shared_data / "opensim-creator-femur"
    names = ("femur_r.obj", "subject_femur_r.obj")
    metres = (read_mesh(folder / name).mesh for name in names)
    source, destination = (mesh.with_vertices(1000 * mesh.vertices) for mesh in metres)
    return source, destination
