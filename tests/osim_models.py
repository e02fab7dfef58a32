"""Small models of our own, and a leg's bones to warp; each test gets files of its own."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from pinwarp.core.landmarks import Landmark, as_position
from pinwarp.io.osim.bone import bone_of
from pinwarp.io.osim.reading import read_model
from pinwarp.io.samples import sample_model
from pinwarp.session.keeping.files import write_session
from pinwarp.session.session import Session

MODELS = Path(__file__).parent / "data" / "osim_models"
NAMES = ("leg", "leg_splined_knee", "leg_nested_frames")


def model_file(name: str) -> Path:
    """Return a model where it is kept, without its meshes beside it but for the leg."""
    return sample_model() if name == "leg" else MODELS / f"{name}.osim"


def copied_model(name: str, folder: Path) -> Path:
    """Copy a model with its meshes into a folder; return the model."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copytree(sample_model().parent / "Geometry", folder / "Geometry", dirs_exist_ok=True)
    shutil.copyfile(model_file(name), folder / f"{name}.osim")
    return folder / f"{name}.osim"


def edited_model(path: Path, *changes: tuple[str, str]) -> Path:
    """Change the text of a model in place; return it."""
    text = path.read_bytes().decode()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    path.write_bytes(text.encode())
    return path


def subject(places: np.ndarray) -> np.ndarray:
    """Return where places of a thigh are on a subject: another size, twisted and bent."""
    x, y, z = np.asarray(places, dtype=float).T
    twist = 0.5 * y
    c, s = np.cos(twist), np.sin(twist)
    bow = 0.02 * np.sin(np.pi * y / 0.4)
    return np.column_stack([0.95 * (c * x + s * z) + bow, 1.08 * y, 1.04 * (-s * x + c * z)])


POSE = Rotation.from_euler("xyz", [0.7, -0.4, 1.9]).as_matrix()


def paired(
    places: np.ndarray,
    warp: Callable[[np.ndarray], np.ndarray] = subject,
    *,
    unit: float = 1.0,
    count: int = 24,
) -> tuple[Landmark, ...]:
    """Return landmarks spread over a bone, with their places on a subject that lies elsewhere.

    ``unit`` is what the subject's lengths are multiplied by: 1000 for millimetres.
    """
    chosen = [0]
    far = np.linalg.norm(places - places[0], axis=1)
    while len(chosen) < min(count, len(places)):
        chosen.append(int(far.argmax()))
        far = np.minimum(far, np.linalg.norm(places - places[chosen[-1]], axis=1))
    there = unit * (warp(places[chosen]) @ POSE.T + [0.3, -1.2, 0.8])
    return tuple(
        Landmark(f"p{i}", as_position(a), as_position(b))
        for i, (a, b) in enumerate(zip(places[chosen], there, strict=True))
    )


def session_on(model: Path, body: str, **options) -> Session:
    """Return a session on the bone of a body, as the window makes it."""
    read = read_model(model)
    bone = bone_of(read, read.body(body)).file
    return Session(bone, landmarks=paired(bone.mesh.vertices, **options), unit="m")


def session_file(model: Path, body: str, **options) -> Path:
    """Write such a session beside the model; return it."""
    path = model.parent / f"{body}.pinwarp.csv"
    write_session(path, session_on(model, body, **options))
    return path
