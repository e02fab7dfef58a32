"""Muscle lengths after a warp: flagged by their ratio, or scaled with it as ScaleTool does."""

from __future__ import annotations

from dataclasses import replace

from pinwarp.core.model_rows import ElementRow
from pinwarp.io.osim.kept_parts import LENGTHS
from pinwarp.session.model.opensim_check import MuscleFigures, OpenSimCheck
from pinwarp.session.model.warped import WarpedModel

KIND = "muscle lengths"
LARGE_CHANGE = 0.05
"""A path that is longer or shorter by a larger share is flagged where its lengths are kept."""


def with_lengths(warped: WarpedModel, check: OpenSimCheck, *, scale: bool = False) -> WarpedModel:
    """Return a warped model whose muscles know how much longer their paths have become.

    Parameters
    ----------
    warped
        The model.
    check
        What OpenSim says of it.
    scale
        Whether fibre, tendon and resting lengths are multiplied by the ratio of the path's
        lengths in the default posture, as OpenSim's ScaleTool does; otherwise they are kept, and
        flagged where the ratio is far from 1.

    Returns
    -------
    WarpedModel
        With a row for every muscle whose path has another length.
    """
    model = warped.study.model
    figures = {each.path: each for each in check.muscles}
    rows, lengths = list(warped.rows), dict(warped.lengths)
    told = {row.path: number for number, row in enumerate(rows) if row.kind == KIND}
    for path, each in figures.items():
        element = model.components.get(path)
        if element is None:
            continue
        old = {
            name: model.numbers(element, name, 0.0) for name in LENGTHS if model.text(element, name)
        }
        if not old or abs(each.after - each.before) <= 0:
            continue
        row = (
            rows[told[path]]
            if path in told
            else ElementRow(warped.bodies[0].parts.name, path, KIND, element.line, False, "")
        )
        if scale:
            lengths[element.number] = {name: each.ratio * value for name, value in old.items()}
        changed = _row(row, each, list(old), scale)
        if path in told:
            rows[told[path]] = changed
        else:
            rows.append(changed)
    return replace(warped, rows=tuple(rows), lengths=lengths)


def _row(row: ElementRow, each: MuscleFigures, names: list[str], scale: bool) -> ElementRow:
    ratio = f"the path is {each.ratio:.3f} times as long"
    listed = " and ".join(names)
    if scale:
        return replace(row, is_warped=True, words=f"{listed} multiplied: {ratio}", flag="")
    flag = (
        f"Its path is {each.ratio:.3f} times as long and its {listed} are the generic muscle's: "
        "scale them, or fit them to the subject."
    )
    return replace(
        row,
        words=f"{listed} kept: {ratio}",
        flag=flag if abs(each.ratio - 1) > LARGE_CHANGE else "",
    )
