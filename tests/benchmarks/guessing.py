"""The first guess on real and made bones in random poses, units and hands: what it says and misses.

Landmark RMS are shares of the destination's size, in percent, unless a unit is named.
"""

from __future__ import annotations

import functools
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyvista as pv
from assets import make_bones
from scipy.spatial.transform import Rotation

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.factor import factorise
from pinwarp.core.first_guess import FirstGuess, Verdict, first_guess
from pinwarp.core.guessed import guessed
from pinwarp.core.landmarks import Landmark, Side, as_position, positions
from pinwarp.core.lengths import rms
from pinwarp.core.mesh import Mesh
from pinwarp.core.plain_surface import PlainSurface
from pinwarp.core.pose import Mirror, PoseSettings
from pinwarp.core.quality import leave_one_out
from pinwarp.core.sampling import spread_places
from pinwarp.io.manifest import read_manifest
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.io.summary_file import read_summary
from pinwarp.session.keeping.files import read_session
from pinwarp.session.session import Session
from pinwarp.session.study import batch
from pinwarp.session.study.workers import cores, on_this_machine
from tests.core import bones
from tests.core.femur import femur_landmarks, femur_meshes
from tests.core.pelvis import pelvis_meshes

Row = dict[str, Any]
SHARED = Path(__file__).resolve().parents[2].parent / "shared" / "data"
POSES = 20
# A reading whose landmarks lie further off than this share of the size is another pose.
FOUND = 0.2
UNITS = (1.0, 1000.0, 0.001)


@dataclass(frozen=True, eq=False)
class Bones:
    """A source and a destination, and places that answer to one another."""

    name: str
    source: Mesh
    destination: Mesh
    u: np.ndarray
    v: np.ndarray


def hand_femur() -> Bones:
    """The femur with twenty landmarks that somebody placed by hand."""
    _, u, v = femur_landmarks(SHARED)
    return Bones("femur, by hand", *femur_meshes(SHARED), u, v)


def hemipelvis() -> Bones:
    """The hemipelvis with sixty vertices of its shared triangulation."""
    source, destination = pelvis_meshes(SHARED)
    places, triangles = spread_places(source, 60)
    corners = source.faces[triangles]
    off = np.linalg.norm(source.vertices[corners] - places[:, None], axis=2)
    rows = corners[np.arange(60), off.argmin(axis=1)]
    return Bones(
        "hemipelvis", source, destination, source.vertices[rows], destination.vertices[rows]
    )


def bent(name: str) -> Bones:
    """A bone of the full-body model and itself, bent: the truth is known everywhere."""
    mesh = read_mesh(SHARED / "opensim-rajagopal2016" / "Geometry" / f"{name}.vtp").mesh
    size = PlainSurface.of(mesh).size

    def truth(points: np.ndarray) -> np.ndarray:
        x = points / size
        waves = np.sin(1.3 * x[:, [1, 2, 0]] + [0.3, 1.1, 2.0]) * [0.10, 0.08, 0.12]
        return size * (x * [1.05, 0.95, 1.0] + waves)

    u, _ = spread_places(mesh, 40)
    return Bones(f"{name}, bent", mesh, mesh.with_vertices(truth(mesh.vertices)), u, truth(u))


def tube() -> Bones:
    """Our bowed and bumpy tube: nearly the same mirrored, and either way up."""
    mesh = bones.bone(40, 80)
    u = bones.named_places(40)
    return Bones("tube", mesh, mesh.with_vertices(bones.truth(mesh.vertices)), u, bones.truth(u))


@functools.cache
def made_femur(seed: int | None) -> tuple[Mesh, np.ndarray]:
    """One of our femurs with its landmarks; without a seed the usual one."""
    make_bones.VOXEL = 2.4
    bone = make_bones.GENERIC if seed is None else random_femur(seed)
    fine = make_bones.fine_surface(bone)
    placed = [x for x in make_bones.LANDMARKS if not x.passenger]
    places = bone.pose(np.array([landmark.on(bone, fine) for landmark in placed]))
    return Mesh(bone.pose(np.asarray(fine.points, float)), fine.regular_faces), places


def random_femur(seed: int) -> make_bones.Femur:
    """A femur as they differ among grown-up people."""
    rng = np.random.default_rng(seed)
    head = rng.normal(46, 2.5)
    width = head / 46 * rng.normal(81, 2.5)
    return make_bones.Femur(
        length=rng.normal(420, 22),
        head_diameter=head,
        neck_length=rng.normal(54, 3),
        neck_angle=rng.normal(129, 4),
        torsion=rng.normal(14, 7),
        bow=rng.normal(12, 2.5),
        shaft_girth=rng.normal(1.0, 0.05),
        condyle_width=width,
        condyle_depth=width * rng.normal(0.76, 0.02),
        turn=(0, 0, 0),
        shift=(0, 0, 0),
    )


def made(seed: int) -> Bones:
    """Two of our femurs."""
    (source, u), (destination, v) = made_femur(None), made_femur(seed)
    return Bones("femurs, made", source, destination, u, v)


def posed(given: Bones, seed: int) -> tuple[Bones, float, bool]:
    """The destination in a random pose, every other one mirrored, in three units."""
    rng = np.random.default_rng(seed)
    unit, mirrored = UNITS[seed % 3], bool(seed % 2)
    linear = unit * Rotation.random(random_state=rng).as_matrix()
    linear = linear @ np.diag([-1.0 if mirrored else 1.0, 1, 1])
    offset = unit * 300 * rng.normal(size=3)
    faces = given.destination.faces[:, ::-1] if mirrored else given.destination.faces
    destination = Mesh(given.destination.vertices @ linear.T + offset, faces)
    return (
        Bones(given.name, given.source, destination, given.u, given.v @ linear.T + offset),
        unit,
        mirrored,
    )


def is_right(guess: FirstGuess, given: Bones, mirrored: bool) -> bool:
    """Whether the best reading is the true one."""
    best = guess.readings[0]
    return best.mirrored == mirrored and _off(best.evaluate(given.u), given) < FOUND


def _off(places: np.ndarray, given: Bones) -> float:
    size = PlainSurface.of(given.destination).size
    return rms(np.linalg.norm(places - given.v, axis=1)) / size


def guessing(poses: int = POSES) -> Iterator[Row]:
    """Every bone in random poses: verdicts, hands, errors at every stage, discs, seconds."""
    cases: list[Callable[[int], Bones]] = [made, lambda _seed: tube()]
    if SHARED.exists():
        cases = [lambda _seed: hand_femur(), lambda _seed: hemipelvis(), *cases]
        names = ("r_tibia", "r_fibula", "sacrum", "r_pelvis")
        cases += [lambda _seed, name=name: bent(name) for name in names]
    for case in cases:
        yield _over(case, poses)


def _over(case: Callable[[int], Bones], poses: int) -> Row:
    told = dict.fromkeys(Verdict, 0)
    found = sure_wrong = hands = 0
    stages: list[tuple[float, ...]] = []
    inside, margins, seconds = [], [], []
    name = ""
    for seed in range(poses):
        given, _, mirrored = posed(case(seed), seed)
        name = given.name
        begin = time.process_time()
        guess = first_guess(given.source, given.destination)
        seconds.append(time.process_time() - begin)
        told[guess.verdict] += 1
        margins.append((guess.fit, guess.other_hand, guess.other_pose))
        if not guess.readings:
            continue
        hands += guess.readings[0].mirrored == mirrored
        right = is_right(guess, given, mirrored)
        found += right
        sure_wrong += guess.verdict is Verdict.SURE and not right
        # Whoever is asked picks the true one.
        picked = next((x for x in guess.readings if x.mirrored == mirrored), None)
        if picked is None or _off(picked.evaluate(given.u), given) > FOUND:
            continue
        mirror = np.diag([-1.0 if mirrored else 1.0, 1, 1])
        similarity = fit_similarity(given.u @ mirror, given.v)
        left_out = leave_one_out(factorise(given.u), given.v, 0.0).distances
        stages.append(
            (
                _off(similarity.apply(given.u @ mirror), given),
                _off(picked.pose.apply(given.u), given),
                _off(picked.evaluate(given.u), given),
                rms(left_out) / picked.size,
            )
        )
        places = guessed(picked, given.u)
        off = np.linalg.norm(places.positions - given.v, axis=1)[~places.beyond_rim]
        inside.append([float(np.mean(off < k * places.radii[0])) for k in (1, 2, 3)])
    middle = np.mean(stages, axis=0) if stages else np.full(4, np.nan)
    covered = np.mean(inside, axis=0) if inside else np.full(3, np.nan)
    fit, hand, pose = np.median(margins, axis=0)
    return {
        "what": name,
        "sure/ask/none": "/".join(str(told[verdict]) for verdict in Verdict),
        "sure, wrong": str(sure_wrong),
        "best right": f"{found}",
        "hand right": f"{hands}",
        "fit %": 100 * fit,
        "other hand": hand,
        "other pose": pose,
        **dict(zip(("similarity", "pose", "guess", "left out"), 100 * middle, strict=True)),
        **dict(zip(("in 1", "in 2", "in 3"), covered, strict=True)),
        "cpu s": float(np.median(seconds)),
    }


def halves() -> Iterator[Row]:
    """Half of a destination, cut open and capped, without and with its being told."""
    cases = [made(3), *([hand_femur(), hemipelvis()] if SHARED.exists() else [])]
    for given in cases:
        for end in (1, -1):
            for capped in (False, True):
                half, there = _half(given, end, capped)
                for partial in (False, True):
                    yield _of_half(half, there, end, capped=capped, partial=partial)


def _half(given: Bones, end: int, capped: bool) -> tuple[Bones, np.ndarray]:
    about = given.destination.vertices - given.destination.vertices.mean(axis=0)
    along = np.linalg.svd(about, full_matrices=False)[2][0] * end
    faces = np.hstack([np.full((len(given.destination.faces), 1), 3), given.destination.faces])
    surface = pv.PolyData(given.destination.vertices, faces.ravel()).clean()
    origin = given.destination.vertices.mean(axis=0)
    cut = surface.clip_closed_surface if capped else functools.partial(surface.clip, invert=False)
    part = (
        cut(normal=along, origin=origin)
        .extract_surface(algorithm="dataset_surface")
        .triangulate()
        .clean()
    )
    mesh = Mesh(part.points, part.regular_faces)
    there = (given.v - origin) @ along > 0
    return Bones(given.name, given.source, mesh, given.u, given.v), there


def _of_half(half: Bones, there: np.ndarray, end: int, *, capped: bool, partial: bool) -> Row:
    guess = first_guess(half.source, half.destination, PoseSettings(Mirror.ASK, partial))
    row: Row = {
        "what": f"{half.name}, end {end:+d}{', capped' if capped else ''}",
        "partial": str(partial),
        "verdict": guess.verdict.value,
        "fit %": 100 * guess.fit,
        "other hand": guess.other_hand,
        "other pose": guess.other_pose,
    }
    if guess.readings:
        best = guess.readings[0]
        places = guessed(best, half.u)
        off = np.linalg.norm(places.positions - half.v, axis=1)
        shown = there & ~places.beyond_rim
        row |= {
            "mirrored": str(best.mirrored),
            "pose (mm)": rms(np.linalg.norm(best.pose.apply(half.u) - half.v, axis=1)[there]),
            "guess (mm)": rms(off[shown]) if shown.any() else np.nan,
            "shown": f"{shown.sum()} of {there.sum()}",
            "shown beyond": f"{(~there & ~places.beyond_rim).sum()} of {(~there).sum()}",
            "disc (mm)": places.radii[0],
        }
    return row


def cohort(subjects: int = 20) -> Iterator[Row]:
    """A batch's first pass over made femurs: one is half a bone, one is a ball, a quarter mirrored.

    Errors are in millimetres.
    """
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        rows, true = _first_pass(Path(folder), subjects)
        seconds = time.perf_counter() - begin
        errors = []
        for name, row in rows.items():
            if row["status"] == "done":
                session = read_session(Path(folder, "out", f"{name}.pinwarp.csv"))
                places = positions(session.landmarks, Side.DESTINATION)
                errors.append(rms(np.linalg.norm(places - true[name], axis=1)))
    verdicts = [row["verdict"] for row in rows.values()]
    yield {
        "what": f"{subjects} subjects",
        "sure/ask/none": "/".join(str(verdicts.count(verdict.value)) for verdict in Verdict),
        "first rows": ", ".join(list(rows)[:3]),
        "median RMS": float(np.median(errors)),
        "largest RMS": max(errors),
        "seconds": seconds,
    }


def _first_pass(folder: Path, subjects: int) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    source, u = made_femur(None)
    write_mesh(folder / "source.ply", source)
    marks = [Landmark(f"p{k}", as_position(place)) for k, place in enumerate(u)]
    lines, true = ["name,destination_mesh"], {}
    for seed in range(subjects):
        given, _, _ = posed(made(seed), 6 * seed + 3 * (seed % 4 == 3))
        if seed == 7:
            given, _ = _half(given, 1, capped=False)
        if seed == 13:
            ball = pv.Icosphere(radius=50.0, nsub=4)
            given = Bones("ball", source, Mesh(ball.points, ball.regular_faces), u, given.v)
        name = {7: "half", 13: "ball"}.get(seed, f"s{seed}")
        write_mesh(folder / f"{name}.ply", given.destination)
        lines.append(f"{name},{name}.ply")
        true[name] = given.v
    (folder / "study.csv").write_text("\n".join(lines))
    tasks = batch.plan(
        read_manifest(folder / "study.csv", suggested=True),
        Session(read_mesh(folder / "source.ply"), landmarks=tuple(marks)),
        folder / "out",
        suggestion=PoseSettings(),
    )
    tally = batch.run(tasks, folder / "out", functools.partial(on_this_machine, jobs=cores()))
    return read_summary(tally.summary), true
