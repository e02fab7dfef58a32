"""What a solve noticed about its landmarks: facts as data, turned into words on demand."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum


class FindingKind(StrEnum):
    """What was noticed."""

    CONFLICT = "conflict"
    CLOSE = "close"
    NEARLY_PLANAR = "nearly planar"
    POLE = "pole"


@dataclass(frozen=True, slots=True)
class Finding:
    """One fact about a set of pairs.

    Parameters
    ----------
    kind
        What was noticed.
    rows
        The pairs concerned, by their row in the solve.
    value
        The figure that goes with it: for a conflict or close landmarks the distance on the
        destination or source (mesh units), for nearly planar landmarks the ratio of the
        smallest to the largest extent, for a pole its penalty (mesh units).
    """

    kind: FindingKind
    rows: tuple[int, ...]
    value: float

    def describe(self, names: Sequence[str] | None = None, unit: str = "") -> str:
        """Say it in a sentence.

        Parameters
        ----------
        names
            The landmarks' names by row; without them the rows are counted from 0.
        unit
            The unit put behind lengths.

        Examples
        --------
        >>> Finding(FindingKind.CONFLICT, (0, 1), 2.5).describe(["apex", "tip"], "mm")
        'apex and tip lie at the same place on the source but 2.5 mm apart on the destination.'
        """
        who = " and ".join(names[row] if names else f"landmark {row}" for row in self.rows)
        length = f"{self.value:.4g} {unit}".rstrip()
        match self.kind:
            case FindingKind.CONFLICT:
                return (
                    f"{who} lie at the same place on the source but {length} apart "
                    "on the destination."
                )
            case FindingKind.CLOSE:
                return f"{who} are only {length} apart on the source: the warp bends hard there."
            case FindingKind.NEARLY_PLANAR:
                return (
                    "The source landmarks lie nearly in one plane: "
                    "far from the landmarks the warp is unreliable."
                )
            case FindingKind.POLE:
                return (
                    f"The penalty is near or above the pole at {length}: under the OPYNSIM "
                    "convention it over-warps there instead of smoothing."
                )
