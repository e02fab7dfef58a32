"""Solving, evaluating, live ticks and memory, against the peers."""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from pinwarp.core import small
from pinwarp.core.factor import factorise
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.live import PreviewPoints, preview
from pinwarp.core.mesh import Mesh
from pinwarp.core.settings import WarpSettings
from pinwarp.core.spline import solve
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.solver import WarpSolver
from pinwarp.tps3d import solve_coefficients
from tests.benchmarks.peers import PEERS
from tests.benchmarks.shapes import landmark_pairs, surface_points
from tests.benchmarks.timing import in_turn

Row = dict[str, Any]
LIVE_SIZES = ((100_000, 50), (100_000, 200), (1_000_000, 200), (1_000_000, 1000))


def solving() -> Iterator[Row]:
    """One solve at penalty 0, from arrays to coefficients."""
    small.warm_up()
    for count in (10, 20, 50, 100, 200, 400, 1000, 5000):
        source, destination = landmark_pairs(count)
        ways = {"pinwarp": lambda s=source, d=destination: solve_coefficients(s, d)}
        for peer in PEERS:
            if count <= peer.most_landmarks:
                ways[peer.name] = lambda p=peer, s=source, d=destination: p.solve(s, d)
        yield {"what": "solve", "pairs": count} | in_turn(ways)


def warping_points() -> Iterator[Row]:
    """One point in a call, as scripts for OPynSim must; a hundred calls for a time."""
    small.warm_up()
    for count in (10, 50, 200):
        source, destination = landmark_pairs(count)
        points = surface_points(100)
        ways = {"pinwarp": _each(solve_coefficients(source, destination).warp_point, points)}
        for peer in PEERS:
            if count <= peer.most_landmarks and peer.points_in_a_loop:
                ways[peer.name] = _each(peer.solve(source, destination).one, points)
            elif count <= peer.most_landmarks:
                evaluate = peer.solve(source, destination)
                ways[peer.name] = _each(lambda p, e=evaluate: e(p[None]), points)
        times = in_turn(ways, 1.0)
        row = {"what": "warp_point", "pairs": count}
        yield row | {name: time / len(points) for name, time in times.items()}


def _each(warp: Callable[[np.ndarray], object], points: np.ndarray) -> Callable[[], None]:
    def all_of_them() -> None:
        for point in points:
            warp(point)

    return all_of_them


def evaluating() -> Iterator[Row]:
    """One evaluation at all vertices: in double precision, and as previews do it."""
    for vertices, count in itertools.product((10_000, 100_000, 1_000_000), (10, 50, 200, 1000)):
        source, destination = landmark_pairs(count)
        points = surface_points(vertices)
        warp = solve_coefficients(source, destination)
        spline, ready = solve(factorise(source), destination), PreviewPoints.of(points)
        ways = {
            "pinwarp": lambda s=spline, r=ready: preview(s, r),
            "pinwarp float64": lambda w=warp, p=points: w.warp_points(p),
        }
        for peer in PEERS:
            if count <= peer.most_landmarks and vertices * count <= peer.most_distances:
                evaluate = peer.solve(source, destination)
                ways[peer.name] = lambda e=evaluate, p=points: e(p)
        yield {"what": "evaluate", "vertices": vertices, "pairs": count} | in_turn(ways, 1.0)


def session_of(vertices: int, count: int) -> Session:
    """A session of that size, with a mesh of as many vertices."""
    source, destination = landmark_pairs(count)
    points = surface_points(vertices)
    mesh = Mesh(points, np.arange(vertices // 3 * 3).reshape(-1, 3))
    landmarks = tuple(
        Landmark(f"landmark_{i}", tuple(u), tuple(v))
        for i, (u, v) in enumerate(zip(source.tolist(), destination.tolist(), strict=True))
    )
    file = MeshFile(Path("/benchmark.ply"), mesh, "", ())
    return Session(file, landmarks=landmarks, settings=WarpSettings(1.0))


class Hand:
    """Moves one thing a little further at every call, through the solver the window uses."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.solver = WarpSolver()
        self.solver.refine(self.solver.solve(WarpInputs.of(session)))
        self._turn = 0

    def _next(self) -> float:
        self._turn += 1
        return 0.01 * self._turn

    def _preview(self, session: Session) -> None:
        result = self.solver.preview(WarpInputs.of(session))
        assert result.vertices is not None

    def slide(self) -> None:
        self._preview(edits.set_penalty(self.session, 1.0 + self._next()))

    def _drag(self, side: Side) -> None:
        landmark = self.session.landmarks[3]
        x, y, z = landmark.position(side)
        place = (x + self._next(), y, z)
        self._preview(edits.move(self.session, landmark.name, side, place))

    def drag_destination(self) -> None:
        self._drag(Side.DESTINATION)

    def drag_source(self) -> None:
        self._drag(Side.SOURCE)

    def add_pair(self) -> None:
        place = (5.0 + self._next(), 0.0, 12.0)
        added = edits.import_pairs(self.session, [Landmark("new", place, place)])
        self._preview(added)


def living() -> Iterator[Row]:
    """What the hand feels, against the fastest peer's whole solve and evaluation."""
    for vertices, count in LIVE_SIZES:
        hand = Hand(session_of(vertices, count))
        source, destination = landmark_pairs(count)
        points = surface_points(vertices)
        peers = {
            peer.name: lambda p=peer, s=source, d=destination, v=points: p.solve(s, d)(v)
            for peer in PEERS
            if count <= peer.most_landmarks and vertices * count <= peer.most_distances
        }
        # One kind of motion after the other, as a hand does: each keeps a shortcut of its own.
        times = in_turn(peers, budget=1.0)
        fastest = min(times, key=times.__getitem__)
        for name, move in (
            ("penalty tick", hand.slide),
            ("destination drag", hand.drag_destination),
            ("source drag", hand.drag_source),
            ("add a pair", hand.add_pair),
        ):
            ours = in_turn({"pinwarp": move, fastest: peers[fastest]}, budget=1.0, most=9)
            yield {"what": name, "vertices": vertices, "pairs": count} | ours


_MEMORY = """
import json, resource
from tests.benchmarks.core import Hand, session_of
from pinwarp.core import kernel
kernel.warm_up()
small = Hand(session_of(1000, 1000)); small.slide(); small.drag_destination()
session = session_of(1_000_000, 1000)
open('/proc/self/clear_refs', 'w').write('5')
def peak():
    status = open('/proc/self/status').read()
    return int(status.split('VmHWM:')[1].split()[0]) / 1024
before = peak()
hand = Hand(session)
hand.slide(); hand.slide(); hand.drag_destination(); hand.drag_destination(); hand.drag_source()
print(json.dumps(peak() - before))
"""


def remembering() -> Iterator[Row]:
    """Peak memory beyond the meshes while sliding and dragging, in a process of its own."""
    outcome = subprocess.run(
        [sys.executable, "-c", _MEMORY], capture_output=True, text=True, check=True
    )
    megabytes = json.loads(outcome.stdout)
    yield {"what": "memory", "vertices": 1_000_000, "pairs": 1000, "megabytes": megabytes}
