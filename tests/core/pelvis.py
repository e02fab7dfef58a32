"""The two hemipelves of one triangulation: what truly answers to what is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pinwarp.core.mesh import Mesh
from pinwarp.io.meshes import read_mesh

DIRECTIONS = np.array(
    [
        *np.vstack([np.eye(3), -np.eye(3)])[[0, 3, 1, 4, 2, 5]],
        *[[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)],
    ]
)


def pelvis_meshes(shared_data: Path) -> tuple[Mesh, Mesh]:
    """Template and target in millimetres; vertex i of one answers to vertex i of the other."""
    folder = shared_data / "msk-morph-pelvis"
    meshes = [read_mesh(folder / f"{name}_pelvis_r.stl").mesh for name in ("template", "target")]
    corners = [mesh.vertices[mesh.faces].reshape(-1, 3) for mesh in meshes]
    _, first, inverse = np.unique(
        corners[0].round(6), axis=0, return_index=True, return_inverse=True
    )
    faces = inverse.reshape(-1, 3)
    # The template is in metres.
    return Mesh(1000 * corners[0][first], faces), Mesh(corners[1][first], faces)


def pelvis_landmarks(mesh: Mesh, count: int = 12) -> np.ndarray:
    """Rows of vertices that stand out, as somebody would click them."""
    about = mesh.vertices - mesh.vertices.mean(axis=0)
    _, _, axes = np.linalg.svd(about, full_matrices=False)
    along = about @ axes.T
    along /= along.std(axis=0)
    rows = list(dict.fromkeys(int((along @ way).argmax()) for way in DIRECTIONS))[:count]
    while len(rows) < count:
        apart = np.linalg.norm(mesh.vertices[:, None] - mesh.vertices[rows], axis=2)
        rows.append(int(apart.min(axis=1).argmax()))
    return np.array(rows)
