"""What a session file says about a refinement: how it was made, from what, and its pairs."""

from __future__ import annotations

import re
from dataclasses import dataclass

from pinwarp.core.landmarks import Position
from pinwarp.io.csv_cells import number_of, shortened

# Of what the line says; a newer method may make other pairs of the same inputs.
METHOD = 1
_FIELDS = ("method", "feature", "tolerance", "turned", "places", "folding", "inputs")


@dataclass(frozen=True)
class RefinementRecord:
    """A refined warp as it is kept: the ordinary spline of its pairs, at penalty 0.

    Parameters
    ----------
    source, destination
        The pairs: first those of the landmarks, then the fitted places.
    smallest_feature, landmark_tolerance, turn_destination
        How it was made; see :class:`~pinwarp.core.refinement.RefinementSettings`. Lengths are in
        source mesh units.
    places
        How many places were spread; more than were fitted.
    folding
        How many vertices would have folded at the end, so that an earlier step was kept.
    inputs
        A hash of what it was made from: where that has changed, the refinement is out of date.
    method
        Which version of the method made it.
    """

    source: tuple[Position, ...]
    destination: tuple[Position, ...]
    smallest_feature: float
    landmark_tolerance: float = 0.0
    turn_destination: bool = False
    places: int = 0
    folding: int = 0
    inputs: str = ""
    method: int = METHOD


def refinement_text(record: RefinementRecord) -> str:
    """Return the text of the header line; the pairs are rows of the table.

    Examples
    --------
    >>> refinement_text(RefinementRecord((), (), 6.5, inputs="sha256:ab"))
    'method=1 feature=6.5 tolerance=0.0 turned=0 places=0 folding=0 inputs=sha256:ab'
    """
    values = (
        record.method,
        repr(float(record.smallest_feature)),
        repr(float(record.landmark_tolerance)),
        int(record.turn_destination),
        record.places,
        record.folding,
        record.inputs,
    )
    return " ".join(f"{field}={value}" for field, value in zip(_FIELDS, values, strict=True))


def refinement_of(text: str) -> RefinementRecord:
    """Read a header line; the pairs are still to be filled in.

    Raises
    ------
    ValueError
        With the reason as its message.

    Examples
    --------
    >>> refinement_of(refinement_text(RefinementRecord((), (), 6.5, inputs="x"))).smallest_feature
    6.5
    """
    found = dict(re.findall(r"(\w+)=(\S+)", text))
    if missing := [field for field in _FIELDS if field not in found]:
        raise ValueError(f"the refinement {shortened(text)} does not say its {missing[0]}")
    feature, tolerance = (number_of(found[field], ",") for field in ("feature", "tolerance"))
    if not feature > 0 or tolerance < 0:
        raise ValueError(f"the refinement {shortened(text)} has a length below 0")
    counts = {}
    for field in ("method", "places", "folding"):
        if not re.fullmatch(r"[0-9]{1,9}", found[field]):
            raise ValueError(f"{field} of the refinement is {shortened(found[field])}, no number")
        counts[field] = int(found[field])
    if found["turned"] not in ("0", "1"):
        raise ValueError(f"turned of the refinement is {shortened(found['turned'])}, not 0 or 1")
    return RefinementRecord(
        source=(),
        destination=(),
        smallest_feature=feature,
        landmark_tolerance=tolerance,
        turn_destination=found["turned"] == "1",
        inputs=found["inputs"],
        **counts,
    )
