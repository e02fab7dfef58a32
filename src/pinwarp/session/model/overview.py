"""What is on the bodies of a model, before anything is warped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pinwarp.core.model_parts import BodyParts
from pinwarp.core.words import counted
from pinwarp.io.osim.body_parts import body_parts
from pinwarp.io.osim.geometry import find_mesh_file, mesh_elements
from pinwarp.io.osim.model import OsimModel


@dataclass(frozen=True)
class BodyOverview:
    """One body.

    Parameters
    ----------
    path
        Of the body.
    meshes
        The files of its meshes as the model names them.
    missing
        Those of them that were not found.
    paths
        Those of its elements that rules are for, meshes aside.
    counts
        How many elements there are of each kind that a rule carries.
    kept
        The kind, path and reason of every element that no rule carries and that is to be looked
        at after a warp.
    """

    path: str
    meshes: tuple[str, ...]
    missing: tuple[str, ...]
    paths: frozenset[str]
    counts: dict[str, int]
    kept: tuple[tuple[str, str, str], ...]

    @property
    def name(self) -> str:
        """The body's name."""
        return self.path.rsplit("/", 1)[-1]

    @property
    def in_words(self) -> str:
        """What a rule carries, as a list."""
        return ", ".join(counted(count, kind) for kind, count in self.counts.items())

    def as_json(self) -> dict[str, Any]:
        """Return all of it as plain values for JSON."""
        return {
            "body": self.name,
            "path": self.path,
            "meshes": list(self.meshes),
            "missing_meshes": list(self.missing),
            "counts": self.counts,
            "not_warped": [
                {"kind": kind, "path": path, "reason": words} for kind, path, words in self.kept
            ],
        }


def overview(model: OsimModel, folders: Iterable[str | Path] = ()) -> tuple[BodyOverview, ...]:
    """Return what is on every body of a model; meshes are looked for and not read.

    Parameters
    ----------
    model
        The model.
    folders
        Where meshes are looked for, beside the model's own places.

    Raises
    ------
    FileFormatError
        When something on a body cannot be used.

    Examples
    --------
    >>> from pinwarp.io.osim.reading import read_model
    >>> from pinwarp.io.samples import sample_model
    >>> hip, thigh, shank = overview(read_model(sample_model()))
    >>> thigh.name, thigh.meshes, thigh.counts["wrap cylinder"]
    ('thigh', ('thigh.vtp',), 1)
    """
    places = [Path(folder) for folder in folders]
    found = []
    for body in model.bodies:
        elements = mesh_elements(model, body)
        names = [(model.text(e, "mesh_file"), find_mesh_file(model, e, places)) for e in elements]
        parts = body_parts(model, body)
        found.append(
            BodyOverview(
                body,
                tuple(dict.fromkeys(name for name, _ in names)),
                tuple(dict.fromkeys(name for name, place in names if place is None)),
                parts.paths,
                _counts(parts),
                tuple((x.kind, x.path, x.words) for x in parts.kept if x.flag),
            )
        )
    return tuple(found)


def _counts(parts: BodyParts) -> dict[str, int]:
    groups = (parts.frames.values(), parts.points, parts.trajectories, parts.wraps)
    return dict(Counter(part.kind for group in groups for part in group))
