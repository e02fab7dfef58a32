"""First guesses of small bones, made up at once: a test has the verdict that it is about."""

from __future__ import annotations

import threading
import time
from dataclasses import replace

import numpy as np
from tests.core.bones import bone, landmarks, truth

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.factor import factorise
from pinwarp.core.first_guess import FirstGuess, Verdict
from pinwarp.core.guessed import Reading
from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.lengths import rms
from pinwarp.core.pose import Pose
from pinwarp.core.spline import solve
from pinwarp.core.surface import Surface
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.session.keeping.files import write_session
from pinwarp.session.session import Session

COUNT = 10


def bones(folder, count=COUNT, destination=True):
    """A session file of two small bones; the landmarks are on the source alone."""
    source = bone(24, 40)
    write_mesh(folder / "source.ply", source)
    write_mesh(folder / "destination.ply", source.with_vertices(truth(source.vertices)))
    marks = tuple(Landmark(f"p{i}", as_position(at)) for i, at in enumerate(landmarks(count)))
    sides = [read_mesh(folder / "source.ply")]
    if destination:
        sides.append(read_mesh(folder / "destination.ply"))
    write_session(folder / "bones.pinwarp.csv", Session(*sides, landmarks=marks))
    return folder / "bones.pinwarp.csv"


def true_places(count=COUNT):
    """Where the landmarks lie on the destination, by name."""
    return {f"p{i}": at for i, at in enumerate(truth(landmarks(count)))}


def reading_of(source, destination, *, off=(0.0, 0.0, 4.0), mirrored=False, fit=0.01) -> Reading:
    """A reading that misses every place by about the same; a mirrored one by more."""
    places = landmarks(60)
    ends = truth(places) + np.array(off)
    if mirrored:
        centre = source.bounds.sum(axis=0)
        # The bone is nearly its own mirror image.
        ends = truth(np.column_stack([centre[0] - places[:, 0], places[:, 1:]]))
    mirror = np.diag([-1.0 if mirrored else 1.0, 1.0, 1.0])
    found = fit_similarity(places @ mirror, ends)
    pose = Pose(found.scale, found.rotation @ mirror, found.translation)
    vertices = destination.vertices
    size = rms(np.linalg.norm(vertices - vertices.mean(axis=0), axis=1))
    spline = solve(factorise(places), ends)
    return Reading(pose, spline, Surface(destination), size, fit, radius=0.06 * size)


class Guesser:
    """Stands in for what takes seconds: answers as it is told to, and remembers what was asked.

    Attributes
    ----------
    asked
        Inputs and settings, call by call.
    held
        While it is clear, an answer is waited for, as long as nobody cancels.
    """

    def __init__(self) -> None:
        self.verdict, self.words = Verdict.SURE, ""
        self.both_hands = False
        self.error: Exception | None = None
        self.asked: list[tuple[object, object]] = []
        self.held = threading.Event()
        self.held.set()
        self.off = (0.0, 0.0, 4.0)

    def __call__(self, inputs, settings, *, progress):
        self.asked.append((inputs, settings))
        progress(0.1, "looking for the pose")
        while not self.held.is_set():
            progress(0.2, "looking for the pose")
            time.sleep(0.005)
        if self.error is not None:
            raise self.error
        one = reading_of(inputs.source, inputs.destination, off=self.off)
        readings = [one]
        if self.both_hands:
            other = reading_of(inputs.source, inputs.destination, mirrored=True)
            readings.append(replace(other, fit=0.012, margin=1.2))
        if self.verdict is Verdict.NONE:
            readings = []
        return FirstGuess(tuple(readings), self.verdict, self.words, 0.01, 1.2, np.inf)


def opened(user, path):
    """Open a session file."""
    user.dialogs.opens.append(path)
    user.trigger("open_session")


def part(user):
    """The capability under test."""
    return user.window.parts.suggesting


def ghosts(user):
    """What is expected now, by name."""
    return {ghost.name: ghost for ghost in part(user).expected.ghosts()}


def following(user):
    """The ghost that is accepted next."""
    return user.window.parts.ghosts.at(Side.DESTINATION)


def bare_place(user, side):
    """A place on the screen where the bone of a side is seen and no sign is near."""
    view = user.window.viewports[side]
    on_bone = landmarks(60) if side is Side.SOURCE else truth(landmarks(60))
    for position in on_bone:
        at = user.place_of(side, position).toPointF()
        near = view.layer.nearest(at, 25) or view.layer.nearest_ghost(at, 25)
        hit = view.pick(at.toPoint().toPointF())
        # Not at its edge, nor behind it.
        if near is None and hit is not None and np.linalg.norm(hit - position) < 2:
            return at.toPoint()
    raise AssertionError("no bare place on the bone")


def status(user):
    return user.window.statusBar().currentMessage()
