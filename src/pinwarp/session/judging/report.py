"""What a report says about a session: figures, findings, and what they belong to."""

from __future__ import annotations

import math
import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import datetime

import numpy as np

from pinwarp.core.findings import gravest_first
from pinwarp.core.folds import Folds
from pinwarp.core.landmarks import Side
from pinwarp.core.lengths import Ruler
from pinwarp.core.model_rows import ElementRow, counts
from pinwarp.core.quality import PenaltyCurve
from pinwarp.core.surface_comparison import SurfaceComparison
from pinwarp.io.chart import Band, Line, Mark, line_chart
from pinwarp.io.meshes import MeshFile
from pinwarp.io.refinement_record import RefinementRecord
from pinwarp.io.report import Report, ReportRow
from pinwarp.session.judging.check import groups_of
from pinwarp.session.judging.different_units import different_units
from pinwarp.session.judging.elsewhere import elsewhere
from pinwarp.session.judging.methods import methods_of
from pinwarp.session.judging.quality import (
    Quality,
    energy_unit,
    judged_at,
    penalty_advice,
    quality_of,
)
from pinwarp.session.judging.suggested import about_suggested
from pinwarp.session.repeat.spreads import kept_variance, spreads_on_destination
from pinwarp.session.rulers import rulers_of
from pinwarp.session.session import Session
from pinwarp.session.warp.provenance import session_hash
from pinwarp.session.warp.refined import OUT_OF_DATE, is_out_of_date, refinement_in_use
from pinwarp.session.warp.result import WarpResult
from pinwarp.session.warp.setting_words import settings_in_words
from pinwarp.session.warp.slid_words import not_sliding_note, semilandmarks_in_words
from pinwarp.session.warp.solved import SolvedWarp
from pinwarp.version import __version__

LEFT_OUT_COLOUR, RESIDUAL_COLOUR, SUGGESTED_COLOUR = "#0072B2", "#8b919a", "#009E73"
_AXES = "xyz"
FITTED = (
    " The warp was fitted to the surface: a small distance proves nothing, least of all that "
    "places lie where they belong. What the pairs say about one another is of the warp of the "
    "landmarks alone."
)


SLID = (
    " Semilandmarks were fitted to the surface: a small distance proves little. A point that is "
    "freed has no counterpart on the destination, and no part in the warp. Left out tells how far "
    "a pair is missed while the semilandmarks slide on."
)


def report_of(
    title: str,
    warp: SolvedWarp,
    made: datetime,
    *,
    quality: Quality | None = None,
    elements: Sequence[ElementRow] = (),
    told: Callable[[float, str], None] = lambda _share, _stage: None,
) -> Report:
    """Collect what is known about a session's warp.

    Parameters
    ----------
    title
        What the session is called.
    warp
        The session, solved.
    made
        When the report is made.
    quality
        What its pairs say about one another, where that is known already.
    elements
        What became of the elements of the model's body, where the source is one.
    told
        Told the share that is done and what is going on; may raise to cancel.

    Returns
    -------
    Report
    """
    session, result = warp.session, warp.result
    told(0.0, "judging the pairs")
    if quality is None or quality.inputs != result.inputs:
        quality = quality_of(result)
    assert quality is not None, "what is solved can be judged"
    names = [pair.name for pair in session.pairs]
    unit, ruler = session.unit, rulers_of(session).session
    also = "" if result.semilandmarks is None else " and semilandmarks"
    told(0.3, "measuring distances")
    folds, compared = warp.folds, warp.comparison
    patches = () if folds is None else (patch.finding for patch in folds.patches)
    # Folds come behind what causes them, what is only isolated last.
    suggested = (named.finding for named in about_suggested(session))
    found = gravest_first((*quality.findings, *suggested, *patches))
    spreads = spreads_on_destination(session)
    astray = elsewhere(session, {Side.DESTINATION: warp.destination_index})
    return Report(
        title=title,
        made=f"Made by pinwarp {__version__} on {made:%d %B %Y at %H:%M} "
        f"(Python {platform.python_version()}, numpy {np.__version__})",
        facts=(*_facts(session, result), *_model_fact(elements)),
        methods=methods_of(warp, quality),
        findings=(
            *(one.sentence for one in astray),
            *(one.sentence for one in different_units(session)),
            *(finding.describe(names, ruler, spreads) for finding in found),
            *(f"{row.path}: {row.flag}" for row in elements if row.flag),
        ),
        figures=tuple(
            # What is only rounding is 0.
            replace(row, value=ruler.shown(row.value)) if row.unit == unit else row
            for row in (
                *_of_pairs(warp, quality, spreads),
                *_of_groups(result, unit),
                *_of_surfaces(compared, folds, unit),
                *_of_warp(quality, unit),
                *_of_model(elements),
            )
        ),
        remarks=(
            ("To check", judged_at(session, ruler)),
            ("Warping penalty", _advice(quality.curve, session.settings.penalty_unit(unit))),
            (
                "Pairs",
                "Residual: how far the warped source landmark is from its destination. "
                "Left out: the same when the pair is left out of the solve. Standardised: that "
                "error in units of what is usual for its surroundings; from 2.5 on it is "
                "suspicious. Spread, where the landmarks were digitised again: how far a pair may "
                "be off for that alone, of source and destination together.",
            ),
            (
                "Distances",
                "Between the surfaces as applied: from every vertex of one to the nearest place on "
                "the other, not weighted by area."
                + ("" if refinement_in_use(session) is None else FITTED)
                + ("" if result.semilandmarks is None else SLID),
            ),
            (
                "Affine part",
                f"The best affine fit of the pairs{also}, taken apart: it stretches, turns "
                "and moves. Translation is that of the middle of the source landmarks.",
            ),
            (
                "Model",
                "What stands on the body, carried by the warp without its pose: how far it moves, "
                "how far that may be off (the standard deviation of one coordinate), and by how "
                "much the bone turns there. What is kept has no figures.",
            ),
        ),
        chart="" if quality.curve is None else _chart(quality.curve, session, result),
    )


def _facts(session: Session, result: WarpResult) -> tuple[tuple[str, str], ...]:
    unit, ruler = session.unit, rulers_of(session).session
    facts = [(f"{side.value.capitalize()} mesh", _mesh_text(session, side)) for side in Side]
    facts += [
        ("Pairs", _pairs_text(session)),
        ("Session", session_hash(session)),
        ("Unit", unit),
        *settings_in_words(session.settings, unit),
    ]
    if (refined := refinement_in_use(session)) is not None:
        facts.append(("Refined", _fitted_text(refined, len(session.pairs), ruler)))
    elif is_out_of_date(session):
        facts.append(("Refined", OUT_OF_DATE))
    if words := semilandmarks_in_words(result):
        facts.append(("Semilandmarks", words))
    facts += [("Semilandmarks", note) for note in not_sliding_note(result)]
    for side in Side:
        if (variance := kept_variance(session.landmarks, side)) is not None:
            words = f"{ruler.text(math.sqrt(3 * variance))}, as digitised again"
            facts.append((f"Spread of the {side.value}", words))
    if result.flexibility is not None:
        facts.append(("Flexibility", f"{result.flexibility:.0%}"))
    if result.rms_residual is not None:
        facts.append(("RMS residual", ruler.text(result.rms_residual)))
    return tuple(facts)


def _model_fact(elements: Sequence[ElementRow]) -> list[tuple[str, str]]:
    if not elements:
        return []
    found = ", ".join(f"{count} {outcome.value}" for outcome, count in counts(elements).items())
    return [("Model", f"{elements[0].body}: {found} elements")]


def _of_model(elements: Sequence[ElementRow]) -> list[ReportRow]:
    figures = []
    for row in elements:
        item = f"{row.path} ({row.kind})"
        figures.append(ReportRow("Model", item, "moved", 1e3 * row.moved, "mm"))
        figures.append(ReportRow("Model", item, "±", 1e3 * row.plus_minus, "mm"))
        figures.append(ReportRow("Model", item, "turned", row.turned, "°"))
    return figures


def _pairs_text(session: Session) -> str:
    suggested = sum(pair.is_suggested for pair in session.pairs)
    only = f", {suggested} of them only suggested" if suggested else ""
    accepted = sum(pair.is_accepted for pair in session.pairs)
    only += f", {accepted} as proposed (accepted unmoved)" if accepted else ""
    return f"{len(session.pairs)} of {len(session.landmarks)} landmarks{only}"


def _fitted_text(refined: RefinementRecord, pairs: int, ruler: Ruler) -> str:
    met = (
        "every landmark met"
        if refined.landmark_tolerance == 0
        else f"landmarks with a penalty of {ruler.text(refined.landmark_tolerance)}"
    )
    return (
        f"{len(refined.source) - pairs:,} of {refined.places:,} places fitted to the destination, "
        f"features larger than {ruler.text(refined.smallest_feature)} bent, {met}"
    )


def _mesh_text(session: Session, side: Side) -> str:
    file = session.mesh_file(side)
    if not isinstance(file, MeshFile):
        return "none" if file is None else f"{file.path.name} (not found)"
    mirrored = f", mirrored across {file.mirrored}" if file.mirrored else ""
    scaled = f", scaled by {file.scaled:g}" if file.scaled != 1 else ""
    return (
        f"{file.path.name}: {len(file.mesh.vertices):,} vertices, "
        f"{len(file.mesh.faces):,} triangles{mirrored}{scaled}; SHA-256 {file.sha256}"
    )


def _of_pairs(warp: SolvedWarp, quality: Quality, spreads: Mapping[str, float]) -> list[ReportRow]:
    unit, left_out = warp.session.unit, quality.left_out
    figures = []
    for row, pair in enumerate(warp.session.pairs):
        residual = float(warp.residuals[row])
        figures.append(ReportRow("Pairs", pair.name, "residual", residual, unit))
        if left_out is not None:
            missed, unusual = float(left_out.distances[row]), float(left_out.standardised[row])
            figures.append(ReportRow("Pairs", pair.name, "left out", missed, unit))
            figures.append(ReportRow("Pairs", pair.name, "standardised", unusual))
        if (spread := spreads.get(pair.name)) is not None:
            figures.append(ReportRow("Pairs", pair.name, "spread", spread, unit))
            figures.append(ReportRow("Pairs", pair.name, "residual / spread", residual / spread))
            if left_out is not None:
                times = float(left_out.distances[row]) / spread
                figures.append(ReportRow("Pairs", pair.name, "left out / spread", times))
        for side in Side:
            for axis, number in zip(_AXES, pair.position(side) or (), strict=False):
                figures.append(ReportRow("Pairs", pair.name, f"{side.value} {axis}", number, unit))
    return figures


def _of_groups(result: WarpResult, unit: str) -> list[ReportRow]:
    figures = []
    for group in groups_of(result):
        for quantity, count in (
            ("points", group.points),
            ("excluded", group.excluded),
            ("freed", group.freed),
            ("used", group.used),
        ):
            figures.append(ReportRow("Semilandmarks", group.name, quantity, count))
        if not math.isnan(group.largest_slide):
            slide = ("largest slide", group.largest_slide, unit)
            figures.append(ReportRow("Semilandmarks", group.name, *slide))
    return figures


def _of_surfaces(
    compared: SurfaceComparison | None, folds: Folds | None, unit: str
) -> list[ReportRow]:
    figures = []
    if compared is not None:
        for item, found in (
            ("source to destination", compared.forward_figures),
            ("destination to source", compared.backward_figures),
        ):
            for quantity, value in (
                ("mean", found.mean),
                ("RMS", found.rms),
                ("95 % are below", found.percentile_95),
                ("maximum", found.maximum),
            ):
                figures.append(ReportRow("Distances", item, quantity, value, unit))
    if folds is not None:
        figures.append(ReportRow("Folds", "vertices", "folded", folds.count))
    return figures


def _of_warp(quality: Quality, unit: str) -> list[ReportRow]:
    parts = quality.affine
    figures = [ReportRow("Affine part", "rotation", "angle", parts.angle, "°")]
    for item, values, what in (
        ("translation", parts.translation, unit),
        ("rotation axis", parts.axis, ""),
        ("scale", parts.scales, ""),
        ("principal stretch", parts.principal, ""),
    ):
        for axis, value in zip(_AXES, values.tolist(), strict=True):
            figures.append(ReportRow("Affine part", item, axis, value, what))
    for axes, value in zip(("xy", "xz", "yz"), parts.shears.tolist(), strict=True):
        figures.append(ReportRow("Affine part", "shear", axes, value))
    for axis, value in zip(_AXES, quality.energy.tolist(), strict=True):
        figures.append(ReportRow("Bending energy", "warp", axis, value, energy_unit(quality, unit)))
    return figures


def _advice(curve: PenaltyCurve | None, unit: str) -> str:
    """Say how much the suggested penalty matters, and what is shaded."""
    if curve is None or not (words := penalty_advice(curve, unit)):
        return ""
    return words if curve.as_good is None else f"{words} That range is shaded."


def _chart(curve: PenaltyCurve, session: Session, result: WarpResult) -> str:
    """Draw the curve on the slider's scale: what flexibility is given up."""
    stiff = (100 * (1 - curve.flexibility)).tolist()
    marks = []
    if curve.suggested is not None:
        at = float(np.interp(curve.suggested, curve.penalties, stiff))
        ruler = session.settings.penalty_ruler(rulers_of(session).session)
        words = f"suggested: {ruler.text(curve.suggested)}"
        marks.append(Mark(at, words, SUGGESTED_COLOUR))
    elif result.flexibility is not None:
        marks.append(Mark(100 * (1 - result.flexibility), "this warp"))
    band = None
    if curve.as_good is not None:
        # Infinity is the affine fit, where nothing bends.
        low, high = (
            100.0 if math.isinf(x) else float(np.interp(x, curve.penalties, stiff))
            for x in curve.as_good
        )
        band = Band(low, high, SUGGESTED_COLOUR)
    return line_chart(
        [
            Line("leave-one-out error", LEFT_OUT_COLOUR, stiff, curve.leave_one_out.tolist()),
            Line("residual", RESIDUAL_COLOUR, stiff, curve.residual.tolist(), dashed=True),
        ],
        x_title="flexibility: 100 % interpolates, 0 % is affine",
        y_title=f"RMS ({session.unit})",
        x_ticks=[(float(x), f"{100 - x} %") for x in (0, 20, 40, 60, 80, 100)],
        marks=marks,
        band=band,
    )
