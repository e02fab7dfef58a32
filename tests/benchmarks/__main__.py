"""Run the benchmark: ``make bench``, or ``make bench ARGS="--json out.json"``."""

from __future__ import annotations

import argparse
import itertools
import json
import os
import platform
import warnings
from importlib.metadata import version
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table
from threadpoolctl import threadpool_limits

from pinwarp.core import kernel
from pinwarp.core.errors import PinwarpWarning

PACKAGES = ("pinwarp", "numpy", "scipy", "numba", "vtk", "pyvista", "PySide6-Essentials")


def machine() -> dict[str, Any]:
    """What the figures were measured on."""
    return {
        "machine": platform.node(),
        "processor": _processor(),
        "cores": os.cpu_count(),
        "python": platform.python_version(),
        "versions": {name: version(name) for name in (*PACKAGES, "thin-plate-spline")},
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        return platform.processor()
    return next((line.split(":")[1].strip() for line in lines if "model name" in line), "?")


def show(console: Console, title: str, rows: list[dict[str, Any]]) -> None:
    """Print rows as one table: our milliseconds, and each peer's time as a multiple of ours."""
    keys = ("what", "vertices", "triangles", "pairs")
    sizes = [key for key in keys if any(key in row for row in rows)]
    figures = list(dict.fromkeys(key for row in rows for key in row if key not in sizes))
    ours = "pinwarp" in figures
    table = Table(title=title, title_justify="left", title_style="bold")
    for key in sizes:
        table.add_column(key, justify="left" if key == "what" else "right")
    for key in figures:
        peer = ours and not key.startswith("pinwarp")
        table.add_column(
            f"{key} / ours" if peer else f"{key} (ms)" if ours else key, justify="right"
        )
    for row in rows:
        given = (row.get(key, "") for key in sizes)
        cells = [f"{value:,}" if isinstance(value, int) else value for value in given]
        for key in figures:
            value = row.get(key)
            if value is None:
                cells.append("–")
            elif ours and not key.startswith("pinwarp"):
                cells.append(f"{value / row['pinwarp']:.1f} x")
            else:
                cells.append(f"{value * 1e3:.3g}" if ours else f"{value:.3g}")
        table.add_row(*cells)
    console.print(table)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(prog="make bench")
    parser.add_argument("--json", type=Path, help="write the figures to this file as well")
    parser.add_argument(
        "--only",
        nargs="*",
        help="solve, point, evaluate, live, quality, suspects, slide, refine, refined, guess, "
        "half, cohort, memory, frames, refresh",
    )
    options = parser.parse_args()
    from tests.benchmarks import core, frames, guessing, peers, quality, refinement, suspects

    parts = {
        "solve": ("One solve", core.solving),
        "point": ("One point in a call", core.warping_points),
        "evaluate": ("Evaluation at all vertices", core.evaluating),
        "live": ("What the hand feels, against the fastest peer's solve + evaluate", core.living),
        "quality": ("Is this warp right?", quality.judging),
        "suspects": ("Which pair is wrong: per cent of made-up sets", suspects.rates),
        "slide": ("Semilandmarks, on one thread", refinement.sliding),
        "refine": ("Refining to the whole surface", refinement.refining),
        "refined": ("What came of it (mm)", refinement.refined),
        "guess": ("The first guess, RMS in % of the bone's size", guessing.guessing),
        "half": ("The first guess on half a bone", guessing.halves),
        "cohort": ("A cohort's first pass, errors in mm", guessing.cohort),
        "memory": ("Peak memory beyond the meshes (MB)", core.remembering),
        "frames": ("In the window", frames.framing),
        "refresh": ("Figures after a drag, 200 pairs", frames.refreshing),
    }
    console = Console(width=140)
    about = machine()
    console.print(
        f"{about['processor']}, {about['cores']} cores, Python {about['python']}; ", end=""
    )
    console.print(", ".join(f"{name} {number}" for name, number in about["versions"].items()))
    for name in peers.ABSENT:
        console.print(f"Not compared with {name}, which is not installed (Python 3.12 or later).")
    kernel.warm_up()
    warnings.simplefilter("ignore", PinwarpWarning)
    figures: dict[str, Any] = {"about": about}
    # One BLAS thread for all: on few cores more make every one of them slower at these sizes.
    with threadpool_limits(limits=1, user_api="blas"):
        for key, (title, measure) in parts.items():
            if options.only and key not in options.only:
                continue
            figures[key] = list(itertools.chain(measure()))
            show(console, title, figures[key])
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
