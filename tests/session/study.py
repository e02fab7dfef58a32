"""A small made-up study: one source bone, and subjects whose bones differ from it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from pinwarp.core.curves import PathFinder
from pinwarp.core.groups import Handle
from pinwarp.core.landmarks import Landmark, Role, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.core.surface import Surface
from pinwarp.io.landmark_files import write_landmarks
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.session import edits
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.session import Session

PAIRS = 8


def bone() -> Mesh:
    """Return a lumpy ball of 10 cm."""
    u, v = np.meshgrid(np.linspace(0, 2 * np.pi, 13)[:-1], np.linspace(0.2, np.pi - 0.2, 9))
    points = np.stack([np.cos(u) * np.sin(v), np.sin(u) * np.sin(v), 1.4 * np.cos(v)], axis=-1)
    index = np.arange(points.shape[0] * 12).reshape(-1, 12)
    a, b = index[:-1], index[1:]
    c, d = np.roll(a, -1, axis=1), np.roll(b, -1, axis=1)
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([c, b, d], -1)]).reshape(-1, 3)
    return Mesh(50 * points.reshape(-1, 3), faces)


def shape(points: np.ndarray, number: int) -> np.ndarray:
    """Return points of the source where they are on a subject."""
    bent = points * [1 + 0.05 * number, 1.0, 0.9] + [100.0 * number, 0, 0]
    return bent + 3 * np.sin(points[:, [1, 2, 0]] / 40 + number)


def landmarks() -> tuple[Landmark, ...]:
    """Return the source's landmarks: pairs to be, and one passenger."""
    rows = np.random.default_rng(3).choice(len(bone().vertices), PAIRS, replace=False)
    places = bone().vertices[rows]
    named = tuple(Landmark(f"p{i}", as_position(place)) for i, place in enumerate(places))
    return (*named, Landmark("muscle", (1.0, 2.0, 60.0), role=Role.PASSENGER))


def make_study(folder: Path, subjects: int, *, meshes: bool = True) -> Path:
    """Write source, session, subjects and a manifest; return the manifest."""
    folder.mkdir(parents=True, exist_ok=True)
    source = folder / "source.ply"
    write_mesh(source, bone())
    marks = landmarks()
    write_landmarks(folder / "source.csv", marks[:PAIRS], Side.SOURCE)
    write_landmarks(folder / "muscle.csv", marks[PAIRS:], Side.SOURCE)
    lines = ["name,destination_landmarks,destination_mesh"]
    for number in range(subjects):
        places = shape(np.array([x.source for x in marks[:PAIRS]]), number)
        placed = [x.placed(Side.DESTINATION, y) for x, y in zip(marks[:PAIRS], places, strict=True)]
        if number == 0:
            session = Session(read_mesh(source), landmarks=(*placed, marks[PAIRS]))
            write_session(folder / "study.pinwarp.csv", session)
        write_landmarks(folder / f"s{number}.csv", placed, Side.DESTINATION)
        mesh = f"s{number}.stl" if meshes else ""
        if meshes:
            write_mesh(folder / mesh, Mesh(shape(bone().vertices, number), bone().faces))
        lines.append(f"s{number},s{number}.csv,{mesh}")
    manifest = folder / "study.csv"
    manifest.write_text("\n".join(lines) + "\n")
    return manifest


def add_groups(folder: Path) -> Session:
    """Give the study's session a patch and a ring, drawn on its own destination; return it."""
    session = read_session(folder / "study.pinwarp.csv")
    session = edits.set_mesh(session, Side.DESTINATION, read_mesh(folder / "s0.stl"))
    surface = Surface(session.mesh(Side.SOURCE))
    finder = PathFinder(surface)
    angles = np.arange(5) * 2 * np.pi / 5
    ring = np.column_stack([48 * np.cos(angles), 48 * np.sin(angles), 0 * angles])
    ring = surface.closest(ring).positions
    handles = [
        Handle(as_position(a), as_position(b)) for a, b in zip(ring, shape(ring, 0), strict=True)
    ]
    session, _ = edits.add_curve(session, handles, finder, is_closed=True, count=9, name="ring")
    session = edits.accept_curve(session, "ring", [handle.source for handle in handles])
    session, _ = edits.add_patch(session, finder, count=25, name="ball")
    write_session(folder / "study.pinwarp.csv", session)
    return session
