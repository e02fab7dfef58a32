"""Small models of our own, and a leg's bones to warp; each test gets files of its own."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np

from pinwarp.io.samples import sample_model

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
