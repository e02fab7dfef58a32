"""What OpenSim says of a warped model: that it loads, and what became of its muscles.

OpenSim is needed for nothing else; without it everything but this can be done.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pinwarp.core.errors import PinwarpError
from pinwarp.core.words import counted
from pinwarp.session.model.warped import WarpedModel
from pinwarp.session.model.writing import write_model

MISSING = (
    "OpenSim is not installed: install pinwarp[opensim], with a Python that opensim has wheels for."
)
# Metres by which a length differs that differs by no more than rounding.
SAME = 1e-9
# Postures of a coordinate at which moment arms are compared, over its range.
POSTURES = 5


@dataclass(frozen=True)
class MuscleFigures:
    """What became of the length and the moment arms of one path; lengths in metres.

    Parameters
    ----------
    path
        Of the muscle or ligament in the model.
    before, after
        Its length in the default posture.
    moment_arm
        By how much the moment arm changed that changed most; NaN where none was compared.
    coordinate, value
        About which coordinate, and where.
    """

    path: str
    before: float
    after: float
    moment_arm: float = math.nan
    coordinate: str = ""
    value: float = math.nan

    @property
    def ratio(self) -> float:
        """How many times as long it is."""
        return self.after / self.before if self.before > 0 else 1.0


@dataclass(frozen=True)
class OpenSimCheck:
    """What OpenSim says.

    Parameters
    ----------
    version
        Of OpenSim.
    muscles
        Every muscle and ligament whose length or moment arms changed.
    unchanged
        How many did not.
    """

    version: str
    muscles: tuple[MuscleFigures, ...]
    unchanged: int

    def in_words(self) -> tuple[str, ...]:
        """Return what a person wants to know first, as sentences."""
        if not self.muscles:
            return (f"OpenSim {self.version} loads it; no muscle changed.",)
        far = [1e3 * abs(each.after - each.before) for each in self.muscles]
        arms = [1e3 * abs(x.moment_arm) for x in self.muscles if not math.isnan(x.moment_arm)]
        longest = max(self.muscles, key=lambda each: abs(each.ratio - 1))
        told = [
            f"OpenSim {self.version} loads it; {counted(len(self.muscles), 'path')} changed by "
            f"{np.mean(far):.1f} mm on average and {max(far):.1f} mm at most.",
            f"The ratio furthest from 1 is {longest.ratio:.3f}, of {longest.path}.",
        ]
        if arms:
            most = max(self.muscles, key=lambda x: np.nan_to_num(abs(x.moment_arm)))
            told.append(
                f"Moment arms changed by {max(arms):.1f} mm at most: {most.path} about "
                f"{most.coordinate} at {most.value:.2f}."
            )
        return tuple(told)

    def as_json(self) -> dict[str, Any]:
        """Return all of it as plain values for JSON, lengths in millimetres."""
        return {
            "version": self.version,
            "unchanged": self.unchanged,
            "muscles": [
                {
                    "path": each.path,
                    "before_mm": 1e3 * each.before,
                    "after_mm": 1e3 * each.after,
                    "ratio": each.ratio,
                    "moment_arm_change_mm": (
                        None if math.isnan(each.moment_arm) else 1e3 * each.moment_arm
                    ),
                    "coordinate": each.coordinate,
                    "value": None if math.isnan(each.value) else each.value,
                }
                for each in self.muscles
            ],
        }


def check_in_opensim(
    warped: WarpedModel, told: Callable[[float], None] = lambda _share: None
) -> OpenSimCheck:
    """Load a warped model in OpenSim and compare its muscles with the generic model's.

    Parameters
    ----------
    warped
        The model; it is written into a temporary folder.
    told
        Told the share that is done; what it raises ends the work.

    Returns
    -------
    OpenSimCheck
        Lengths in the default posture; moment arms about the coordinates of the joints that
        stand on warped bodies, over their ranges, one at a time.

    Raises
    ------
    PinwarpError
        When OpenSim is not installed, or does not load one of the models; the message says why.
    """
    opensim = _opensim()
    _silence(opensim)
    with tempfile.TemporaryDirectory() as folder:
        new = Path(folder, "warped.osim")
        write_model(warped, new)
        before = _Loaded(opensim, warped.study.model.path)
        after = _Loaded(opensim, new)
        lengths = {path: (before.length(path), after.length(path)) for path in before.paths}
        changed = [path for path, (a, b) in lengths.items() if abs(a - b) > SAME]
        largest = _moment_arms(before, after, changed, _coordinates(warped, before), told)
    muscles = tuple(MuscleFigures(x, lengths[x][0], lengths[x][1], *largest[x]) for x in changed)
    version = str(opensim.GetVersion()).split("-")[0]
    return OpenSimCheck(version, muscles, len(lengths) - len(changed))


class _Loaded:
    """A model in OpenSim in its default posture."""

    def __init__(self, opensim: Any, path: Path) -> None:
        try:
            self.model = opensim.Model(str(path))
            self.state = self.model.initSystem()
            self.model.realizePosition(self.state)
        except RuntimeError as error:
            reason = " ".join(str(error).split())
            raise PinwarpError(f"OpenSim does not load {path.name}: {reason}") from None
        self.paths: dict[str, Any] = {}
        forces = self.model.getForceSet()
        for index in range(forces.getSize()):
            force = forces.get(index)
            kinds = (opensim.PathActuator, opensim.Ligament, opensim.PathSpring)
            found = next((x for kind in kinds if (x := kind.safeDownCast(force))), None)
            if found is not None:
                self.paths[force.getAbsolutePathString()] = found
        every = self.model.getCoordinateSet()
        self.coordinates = {
            every.get(i).getAbsolutePathString(): every.get(i) for i in range(every.getSize())
        }

    def length(self, path: str) -> float:
        return float(self.paths[path].getLength(self.state))

    def at(self, coordinate: str, value: float) -> None:
        self.coordinates[coordinate].setValue(self.state, value)
        self.model.realizePosition(self.state)

    def moment_arm(self, path: str, coordinate: str) -> float:
        arm = self.paths[path].computeMomentArm(self.state, self.coordinates[coordinate])
        return float(arm)


def _coordinates(warped: WarpedModel, loaded: _Loaded) -> list[str]:
    """Return the coordinates that can be set of the joints on warped bodies."""
    joints = {row.path for row in warped.rows if row.kind == "joint"}
    return [
        path
        for path, coordinate in loaded.coordinates.items()
        if path.rsplit("/", 1)[0] in joints
        and not coordinate.isDependent(loaded.state)
        and not coordinate.getLocked(loaded.state)
    ]


def _moment_arms(
    before: _Loaded,
    after: _Loaded,
    paths: list[str],
    coordinates: list[str],
    told: Callable[[float], None],
) -> dict[str, tuple[float, str, float]]:
    """Return for each path the largest change of a moment arm, about what, and where."""
    largest = dict.fromkeys(paths, (math.nan, "", math.nan))
    for number, coordinate in enumerate(coordinates):
        told(number / len(coordinates))
        one = before.coordinates[coordinate]
        rest = one.getValue(before.state)
        for value in np.linspace(one.getRangeMin(), one.getRangeMax(), POSTURES):
            for model in (before, after):
                model.at(coordinate, float(value))
            for path in paths:
                if not hasattr(before.paths[path], "computeMomentArm"):
                    continue
                change = after.moment_arm(path, coordinate) - before.moment_arm(path, coordinate)
                if not abs(change) <= abs(largest[path][0]):
                    name = coordinate.rsplit("/", 1)[-1]
                    largest[path] = (change, name, float(value))
        for model in (before, after):
            model.at(coordinate, rest)
    return largest


def _opensim() -> Any:
    try:
        import opensim
    except ImportError:
        raise PinwarpError(MISSING) from None
    return opensim


def _silence(opensim: Any) -> None:
    """Keep OpenSim from talking, and from leaving opensim.log where the command was run.

    For good: to be given its voice back it says so, in the middle of what a program reads.
    """
    opensim.Logger.removeFileSink()
    opensim.Logger.setLevelString("Off")
