"""Sliding semilandmarks and refining to the surface, against trimesh's non-rigid fit."""

from __future__ import annotations

import functools
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import trimesh

from pinwarp.core.curves import PathFinder
from pinwarp.core.factor import factorise
from pinwarp.core.held_slide import HeldSlide
from pinwarp.core.jacobian import determinants, jacobians
from pinwarp.core.mesh import Mesh
from pinwarp.core.patches import patch
from pinwarp.core.refinement import refine
from pinwarp.core.sampling import even_places
from pinwarp.core.sliding import slide
from pinwarp.core.spline import solve
from pinwarp.core.surface import Surface
from pinwarp.core.surface_distance import SurfaceIndex
from tests.benchmarks.timing import in_turn
from tests.core.bones import bone, landmarks, named_places, shape, truth

Row = dict[str, Any]
PAIRS = 20
# Vertices around and along the bone: 7,000 and 100,000.
SIZES = ((60, 116), (230, 434))
# The peer holds a sparse matrix of every vertex's affine map, and searches without a tree of ours.
MOST_FOR_PEER = 10_000


def sliding() -> Iterator[Row]:
    """A whole slide, as after a landmark's drop, and what leads to it; 90,000 vertices."""
    source = bone(220, 408)
    surface, target = Surface(source), Surface(source.with_vertices(truth(source.vertices)))
    u = landmarks(100)
    v = truth(u)
    sizes = {"vertices": len(source.vertices), "pairs": 100}
    for count in (100, 300, 1000, 2000):
        points = patch(surface, count, away_from=u)
        ways = {"pinwarp": lambda p=points: slide(u, v, p, target)}
        yield {"what": f"slide {count}"} | sizes | in_turn(ways, 1.0, 5)
    points = patch(surface, 300, away_from=u)
    held = HeldSlide.of(slide(u, v, points, target))
    ends = surface.closest(shape(np.array([0.0, 2.5]), np.array([0.6, 2.2]))).positions
    around = shape(np.linspace(0, 2 * np.pi, 9)[:-1], np.full(8, 1.2))
    finder = PathFinder(surface)
    ring = finder.through(surface.closest(around).positions, is_closed=True)
    steps: dict[str, Callable[[], Any]] = {
        "surface made ready": lambda: Surface(source).index,
        "ways made ready": lambda: PathFinder(surface),
        "spread 300": lambda: patch(surface, 300, away_from=u),
        "spread 300 inside": lambda: patch(surface, 300, around=ring, inside=[0, 0, 100]),
        # Once more from the start: what was found is remembered.
        "curve segment": lambda: finder._found(ends[0], ends[1]),
        "drag frame 300": lambda: held.warp(v),
        "drag frame 300, source": lambda: held.with_source(u).warp(v),
    }
    for what, step in steps.items():
        yield {"what": what} | sizes | in_turn({"pinwarp": step}, 1.0, 5)


@dataclass(frozen=True, eq=False)
class _Outcome:
    """Where the vertices went, how places that are no landmarks miss the truth, and how long."""

    vertices: np.ndarray
    off_truth: float
    folded: int
    seconds: float


def refining() -> Iterator[Row]:
    """The whole refinement."""
    for size in SIZES:
        found = _outcomes(size)
        row = {"what": "refine", "vertices": len(bone(*size).vertices), "pairs": PAIRS}
        times = {name: found[name].seconds for name in ("pinwarp", "trimesh") if name in found}
        yield row | times


def refined() -> Iterator[Row]:
    """What came of it: millimetres to the surface, to the truth, and folded vertices."""
    for size in SIZES:
        mesh = bone(*size)
        places, triangles = even_places(mesh, 5000)
        index = SurfaceIndex(mesh.with_vertices(truth(mesh.vertices)))
        for name, outcome in _outcomes(size).items():
            distances = index.distances(_carried(mesh, outcome.vertices, places, triangles))
            yield {
                "what": {"pinwarp": "refined"}.get(name, name),
                "vertices": len(mesh.vertices),
                "distance": float(distances.mean()),
                "95 %": float(np.percentile(distances, 95)),
                "off the truth": outcome.off_truth,
                "folded": outcome.folded,
            }


@functools.cache
def _outcomes(size: tuple[int, int]) -> dict[str, _Outcome]:
    source = bone(*size)
    target = source.with_vertices(truth(source.vertices))
    u = landmarks(PAIRS)
    v = truth(u)
    surfaces = Surface(source), Surface(target)
    ways: dict[str, Callable[[], Any]] = {
        "landmarks": lambda: solve(factorise(u), v),
        "300 slid": lambda: slide(u, v, patch(surfaces[0], 300, away_from=u), surfaces[1]).spline,
        "pinwarp": lambda: refine(source, target, u, v).spline,
    }
    # What is compiled at its first use is compiled by then.
    small = bone(16, 24)
    refine(small, small.with_vertices(truth(small.vertices)), u, v)
    found = {}
    for name, way in ways.items():
        begin = time.perf_counter()
        spline = way()
        seconds = time.perf_counter() - begin
        off = spline.evaluate(named_places()) - truth(named_places())
        folded = int((determinants(jacobians(spline, source.vertices)) <= 0).sum())
        found[name] = _Outcome(spline.evaluate(source.vertices), _rms(off), folded, seconds)
    if len(source.vertices) <= MOST_FOR_PEER:
        found["trimesh"] = _peer(source, target, u, v)
    return found


def _peer(source: Mesh, target: Mesh, u: np.ndarray, v: np.ndarray) -> _Outcome:
    """Amberg's optimal step fit, begun with the landmarks' affine map, as its users do."""
    begun = solve(factorise(u), v, np.inf)
    meshes = [
        trimesh.Trimesh(vertices, source.faces, process=False)
        for vertices in (begun.evaluate(source.vertices), target.vertices)
    ]
    surface = SurfaceIndex(source.with_vertices(begun.evaluate(source.vertices)))
    at, rows = surface.closest(begun.evaluate(u))
    shares = trimesh.triangles.points_to_barycentric(meshes[0].triangles[rows], at)
    begin = time.perf_counter()
    vertices = np.asarray(
        trimesh.registration.nricp_amberg(meshes[0], meshes[1], (rows, shares), v)
    )
    seconds = time.perf_counter() - begin
    places, triangles = SurfaceIndex(source).closest(named_places())
    off = _carried(source, vertices, places, triangles) - truth(named_places())
    fitted = trimesh.Trimesh(vertices, source.faces, process=False)
    turned = np.sum(meshes[1].face_normals * fitted.face_normals, axis=1) < 0
    return _Outcome(vertices, _rms(off), int(turned.sum()), seconds)


def _carried(
    mesh: Mesh, vertices: np.ndarray, places: np.ndarray, triangles: np.ndarray
) -> np.ndarray:
    """Carry places of a mesh along with its vertices, straight within each triangle."""
    shares = trimesh.triangles.points_to_barycentric(mesh.vertices[mesh.faces[triangles]], places)
    return np.einsum("mk,mkc->mc", shares, vertices[mesh.faces[triangles]])


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.sum(errors**2, axis=1))))
