"""Where every place of the source lies on the destination, before anybody has clicked there.

The poses that may be meant (:mod:`pinwarp.core.pose`) are warped coarsely and judged by how far
both surfaces then lie apart; the best is refined to the surface (:mod:`pinwarp.core.refinement`).
How much better it fits than its rivals, another way round or mirrored, says whether it can be
trusted: a bone that is nearly its own mirror image carries no evidence of its hand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinwarp.core.alignment import fit_similarity
from pinwarp.core.errors import MeshError
from pinwarp.core.factor import factorise
from pinwarp.core.guessed import Reading, doubt_of, guessed, posed_first
from pinwarp.core.lengths import rms
from pinwarp.core.mesh import Mesh
from pinwarp.core.plain_surface import PlainSurface
from pinwarp.core.pose import Pose, PoseSettings, find_poses
from pinwarp.core.positions import as_positions
from pinwarp.core.refinement import refine
from pinwarp.core.refinement_inputs import RefinementSettings, Start
from pinwarp.core.sampling import even_places, spread_places, triangle_areas
from pinwarp.core.spline import PenaltyConvention, Spline
from pinwarp.core.surface import Surface
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.core.words import counted

Matrix = NDArray[np.float64]
Progress = Callable[[float, str], None]

# The surfaces may lie apart by this share of the destination's size, as a mean; the other hand
# and another pose must do so by so many times more.
LARGEST_FIT = 0.03
OTHER_HAND = 1.4
OTHER_POSE = 1.3
# Poses are judged once warped, where their cost is not so many times the best; of a hand so many.
RIVALS = 1.6
MOST_RIVALS = 3
# What the finite number of places costs in any pose, so that a copy has rivals, too.
SMALLEST_COST = 0.03
# Warps whose places lie closer than this share of the size are one reading.
SAME_READING = 0.1
# Either end up and either hand can be asked about; more readings say that the bone is too round.
MOST_SHOWN = 4
# Rims longer than this share of the root of the area, more than the source's, mean a cut bone.
CUT = 0.3
# Places of a coarse warp and of the last one, and those by which the fit is measured.
COARSE, FINE, JUDGED = 150, 1000, 3000
# Places that hold a warp loosely, and their penalty in sizes of the destination.
LOOSE, LOOSENESS = 40, 1e5
# Pairs that fix a pose.
ENOUGH = 3
# Below this share of the size a fit is rounding, and no fit is better than another.
SMALLEST_FIT = 0.002

NOTHING_FITS = "The source could not be laid on the destination."
PAIRS_IN_DOUBT = (
    "Look at the pairs that are there, which the warp had to meet, or place three more."
)
WAY_OUT = "Place three pairs by hand, or check that the meshes are the same bone."


class Verdict(StrEnum):
    """What may be done with a first guess: show it, ask which reading is meant, or nothing."""

    SURE = "sure"
    ASK = "ask"
    NONE = "none"


@dataclass(frozen=True, eq=False)
class FirstGuess:
    """What came of it.

    Attributes
    ----------
    readings : tuple of Reading
        The best first, then what it may be confused with.
    verdict : Verdict
    words : str
        A sentence or two that say why it must be asked or nothing can be shown; empty when sure.
    fit : float
        That of the best reading.
    other_hand, other_pose : float
        How many times the best fit that of the best mirrored reading is, and that of the next of
        the same hand; infinite where none was tried or none came near.
    """

    readings: tuple[Reading, ...]
    verdict: Verdict
    words: str
    fit: float
    other_hand: float
    other_pose: float


def _silent(_share: float, _words: str) -> None:
    pass


def first_guess(
    source: Mesh,
    destination: Mesh,
    settings: PoseSettings | None = None,
    *,
    given: tuple[ArrayLike, ArrayLike] | None = None,
    progress: Progress = _silent,
) -> FirstGuess:
    """Guess where all places of the source lie on the destination.

    Parameters
    ----------
    source, destination
        Surfaces of one bone each, in any units.
    settings
        What is known: the hand, or that the destination is a part.
    given
        (n, 3) places that are known on both sides. The warp meets them; three that are not on one
        line tell the pose, four that are not in one plane the hand.
    progress
        Called with the share done and words; what it raises ends it.

    Returns
    -------
    FirstGuess

    Raises
    ------
    MeshError
        When a mesh has no area, or one is in more large parts than the other.
    LandmarkError
        When what is given cannot be used.

    Examples
    --------
    >>> import pyvista as pv
    >>> egg = pv.ParametricSuperEllipsoid(1, 2, 4, u_res=40, v_res=40).triangulate().clean()
    >>> bent = Mesh(egg.points + 0.3 * egg.points[:, [2, 0, 1]] ** 2, egg.regular_faces)
    >>> guess = first_guess(bent, Mesh(9 + bent.vertices[:, [1, 2, 0]], bent.faces))
    >>> guess.verdict.value, guess.readings[0].evaluate(bent.vertices[:1]).shape
    ('sure', (1, 3))
    """
    settings = settings or PoseSettings()
    u, v = given if given is not None else (np.zeros((0, 3)), np.zeros((0, 3)))
    pairs = as_positions(u, "source landmark"), as_positions(v, "destination landmark")
    progress(0.0, "looking at the meshes")
    sides = _Sides.of(source, destination, pairs, partial=settings.partial)
    sides.refuse_parts()

    def within(begin: float, end: float) -> Progress:
        return lambda share, words: progress(begin + (end - begin) * share, words)

    poses = _poses_of(pairs, settings.mirror.hands) or find_poses(
        sides.source.mesh, sides.destination.mesh, settings, progress=within(0.05, 0.4)
    )
    rivals = _rivals(poses)
    steps = np.linspace(0.4, 0.7, len(rivals) + 1)
    readings = [
        sides.read(pose, COARSE, within(steps[k], steps[k + 1])) for k, pose in enumerate(rivals)
    ]
    judged = sides.judged([reading for reading in readings if reading is not None])
    steps = np.linspace(0.7, 1.0, len(judged.readings) + 1)
    fine = [
        sides.refined(reading, within(steps[k], steps[k + 1]))
        for k, reading in enumerate(judged.readings)
    ]
    return replace(judged, readings=tuple(fine))


def _poses_of(pairs: tuple[Matrix, Matrix], hands: Sequence[bool]) -> tuple[Pose, ...]:
    """Return the pose of each hand that pairs tell; none where these are too few."""
    u, v = pairs
    if len(u) < ENOUGH or min(factorise(u).rank, factorise(v).rank) < 2:
        return ()
    poses = []
    for mirrored in hands:
        mirror = np.diag([1.0, 1.0, -1.0 if mirrored else 1.0])
        fit = fit_similarity(u @ mirror, v)
        poses.append(Pose(fit.scale, fit.rotation @ mirror, fit.translation))
    return tuple(poses)


def _rivals(poses: Sequence[Pose]) -> list[Pose]:
    """Return the poses that may be meant: the best of each hand, and what comes near the best."""
    rivals: list[Pose] = []
    for pose in poses:
        alike = sum(other.mirrored == pose.mirrored for other in rivals)
        near = pose.cost <= RIVALS * max(poses[0].cost, SMALLEST_COST)
        if not alike or (alike < MOST_RIVALS and near):
            rivals.append(pose)
    return rivals


@dataclass(frozen=True, eq=False)
class _Sides:
    """Both surfaces as they are searched, the destination's as it is, and what is known."""

    source: PlainSurface
    destination: PlainSurface
    searched: Surface
    surface: Surface
    pairs: tuple[Matrix, Matrix]
    partial: bool

    @classmethod
    def of(
        cls, source: Mesh, destination: Mesh, pairs: tuple[Matrix, Matrix], *, partial: bool
    ) -> _Sides:
        plain = PlainSurface.of(destination)
        surface = Surface(destination)
        searched = surface if plain.mesh is destination else Surface(plain.mesh)
        return cls(PlainSurface.of(source), plain, searched, surface, pairs, partial)

    def refuse_parts(self) -> None:
        """Say so where one side is more than one bone and the other is not."""
        one, other = self.source.parts, self.destination.parts
        if one != other:
            raise MeshError(
                f"The source is in {counted(one, 'large part')}, the destination in {other}: a "
                "first guess needs the same bone on both sides. Take out what is not of the bone."
            )

    def read(self, pose: Pose, count: int, progress: Progress) -> Reading | None:
        """Return a pose warped to the surface by so many places; None where nothing comes of it."""
        spline = self._warped(pose, self.pairs, count, progress)
        if spline is None:
            return None
        u, v = self.pairs
        missed = rms(np.linalg.norm(spline.evaluate(u) - v, axis=1)) if len(u) else 0.0
        vertices = spline.evaluate(self.source.mesh.vertices)
        apart = self._apart(self.source.mesh.with_vertices(vertices))
        fit = float(np.hypot(apart, missed)) / self.destination.size
        # Of a part the whole says how large the bone is.
        size = pose.scale * self.source.size if self.partial else self.destination.size
        return Reading(pose, spline, self.surface, size, fit, size * doubt_of(fit), met=self.pairs)

    def refined(self, reading: Reading, progress: Progress) -> Reading:
        """Return a reading warped finely; its fit stays that by which it was judged."""
        spline = self._warped(
            reading.pose, self.pairs, FINE, lambda share, words: progress(0.9 * share, words)
        )
        found = reading if spline is None else replace(reading, spline=spline)
        if not len(self.pairs[0]):
            return found
        # How far the given pairs lie from where the shape alone would have put them.
        none = np.zeros((0, 3)), np.zeros((0, 3))
        blind = self._warped(
            reading.pose, none, COARSE, lambda share, words: progress(0.9 + 0.1 * share, words)
        )
        if blind is None:
            return found
        radius = guessed(replace(reading, spline=blind, met=none), self.pairs[0], *self.pairs).radii
        return replace(found, radius=float(radius[0]))

    def _warped(
        self, pose: Pose, pairs: tuple[Matrix, Matrix], count: int, progress: Progress
    ) -> Spline | None:
        posed = pose.posed(self.source.mesh)
        loose, _ = spread_places(posed, LOOSE)
        still = np.vstack([np.zeros(3), np.eye(3)])
        none = np.zeros((0, 3))
        identity = Spline(none, none, still, 0.0, PenaltyConvention.REGULARISING)
        try:
            found = refine(
                posed,
                self.searched,
                pose.apply(pairs[0]),
                pairs[1],
                RefinementSettings(2 * float(np.sqrt(triangle_areas(posed).sum() / count))),
                start=Start(identity, loose, LOOSENESS * self.destination.size),
                progress=progress,
            )
        except MeshError:
            # The surfaces do not face alike in this pose: it is none.
            return None
        return posed_first(found.spline, pose)

    def _apart(self, warped: Mesh) -> float:
        """Return how far the surfaces lie apart: both ways, but from a part only to the whole."""
        ways = [SurfaceIndex(warped).distances(even_places(self.destination.mesh, JUDGED)[0])]
        if not self.partial:
            ways.append(self.searched.index.distances(even_places(warped, JUDGED)[0]))
        return float(np.mean([way.mean() for way in ways]))

    def judged(self, readings: Sequence[Reading]) -> FirstGuess:
        """Return what may be done with readings."""
        different = self._different(sorted(readings, key=lambda reading: reading.fit))
        if not different:
            return FirstGuess(
                (), Verdict.NONE, f"{NOTHING_FITS} {self._way_out}", np.inf, np.inf, np.inf
            )
        best, *others = different
        least = max(best.fit, SMALLEST_FIT)
        others = [replace(x, margin=max(x.fit, SMALLEST_FIT) / least) for x in others]
        hand = min((x.margin for x in others if x.mirrored != best.mirrored), default=np.inf)
        pose = min((x.margin for x in others if x.mirrored == best.mirrored), default=np.inf)
        near = [
            x
            for x in others
            if x.margin < (OTHER_POSE if x.mirrored == best.mirrored else OTHER_HAND)
        ]
        verdict, words = self._verdict(best, near, hand, pose)
        shown = () if verdict is Verdict.NONE else (replace(best, margin=min(hand, pose)), *near)
        return FirstGuess(shown, verdict, words, best.fit, hand, pose)

    def _different(self, readings: Sequence[Reading]) -> list[Reading]:
        """Return readings without those that take all places nearly where a better one does."""
        places, _ = even_places(self.source.mesh, LOOSE)
        chosen: list[Reading] = []
        for reading in readings:
            at = reading.spline.evaluate(places)
            if not any(
                reading.mirrored == other.mirrored
                and rms(np.linalg.norm(other.spline.evaluate(places) - at, axis=1))
                < SAME_READING * reading.size
                for other in chosen
            ):
                chosen.append(reading)
        return chosen

    @property
    def _way_out(self) -> str:
        return PAIRS_IN_DOUBT if len(self.pairs[0]) else WAY_OUT

    def _verdict(
        self, best: Reading, near: Sequence[Reading], hand: float, pose: float
    ) -> tuple[Verdict, str]:
        is_cut = not self.partial and self.destination.rim - self.source.rim > CUT
        if is_cut:
            return Verdict.NONE, (
                "The destination ends at a rim where the source goes on: say so if only a part of "
                f"the bone is there. {self._way_out}"
            )
        if best.fit > LARGEST_FIT:
            return Verdict.NONE, (
                f"{NOTHING_FITS} At best they lie {best.fit:.1%} of the bone's size apart, where "
                f"no more than {LARGEST_FIT:.0%} can be trusted. {self._way_out}"
            )
        if 1 + len(near) > MOST_SHOWN:
            return Verdict.NONE, (
                f"The source fits in {len(near) + 1} ways about as well, as something round does: "
                f"no pose can be told. {self._way_out}"
            )
        words = []
        if hand < OTHER_HAND:
            words.append(
                "The bone fits about as well mirrored: say whether it is the same side of the "
                "body or the other."
            )
        if pose < OTHER_POSE:
            words.append("It fits about as well another way round: say which is meant.")
        return (Verdict.ASK if words else Verdict.SURE), " ".join(words)
