"""Draw the picture of the penalty's sign: the landmark residual under both conventions.

    python assets/make_penalty_picture.py SOURCE.csv DESTINATION.csv [UNIT_IN_MM]

The picture in the README was made from the femur of OpenSim Creator's tutorial (20 pairs, in
metres, so with 1000 as the last argument). Its poles lie where the published system is singular:
at the eigenvalues of the projected landmark distances.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

from pinwarp.core.errors import SingularSystemError
from pinwarp.core.factor import SourceFactor, factorise
from pinwarp.core.landmarks import Side
from pinwarp.core.spline import PenaltyConvention, solve
from pinwarp.io.chart import Line, Mark, line_chart
from pinwarp.io.landmark_formats.opensim_creator import read_landmarks

SAMPLES = 1200
# Beyond the top of the picture a line only needs to be outside.
HIGHEST, OUTSIDE = 45.0, 200.0


def main(source_file: str, destination_file: str, unit: float = 1.0) -> None:
    """Read the landmarks, pair them by name, and write the picture beside this script."""
    sides = {}
    for side, path in ((Side.SOURCE, source_file), (Side.DESTINATION, destination_file)):
        landmarks = read_landmarks(path, side).landmarks
        sides[side] = {x.name: np.multiply(x.position(side), unit) for x in landmarks}
    names = [name for name in sides[Side.SOURCE] if name in sides[Side.DESTINATION]]
    factor = factorise([sides[Side.SOURCE][name] for name in names])
    destination = np.array([sides[Side.DESTINATION][name] for name in names])
    poles = factor.poles
    low, high = np.floor(np.log10(poles[0] / 20)), np.ceil(np.log10(poles[-1] * 20))
    exponents = np.linspace(low, high, SAMPLES)
    lines = [
        Line(
            "regularising: K − sI", "#0072B2", exponents, residuals(factor, destination, exponents)
        ),
        Line(
            "published: K + αI",
            "#D55E00",
            exponents,
            residuals(factor, destination, exponents, PenaltyConvention.OPYNSIM),
        ),
    ]
    picture = line_chart(
        lines,
        x_title="warping penalty (mm)",
        y_title="RMS landmark residual (mm)",
        x_ticks=[(x, f"{10.0**x:g}") for x in np.arange(low, high + 1)],
        highest=HIGHEST,
        marks=[Mark(float(np.log10(pole))) for pole in poles],
        size=(760, 340),
    )
    (Path(__file__).parent / "penalty_sign.svg").write_text(picture + "\n", encoding="utf-8")


def residuals(
    factor: SourceFactor,
    destination: np.ndarray,
    exponents: np.ndarray,
    convention: PenaltyConvention = PenaltyConvention.REGULARISING,
) -> list[float]:
    """Return the RMS distance that the warp leaves between the pairs, penalty by penalty."""
    found = []
    for penalty in 10.0**exponents:
        try:
            warp = solve(factor, destination, penalty, convention)
        except SingularSystemError:
            found.append(OUTSIDE)
            continue
        misses = np.linalg.norm(warp.evaluate(factor.source) - destination, axis=1)
        found.append(min(float(np.sqrt(np.mean(misses**2))), OUTSIDE))
    return found


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], *map(float, sys.argv[3:4]))
