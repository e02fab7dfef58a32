"""Repeats of a set of landmarks: what differs is told, and nothing is guessed silently."""

from __future__ import annotations

from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from pinwarp.core.basis import Basis
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark, Side
from pinwarp.io.samples import sample_session
from pinwarp.session import edits
from pinwarp.session.judging.check import check
from pinwarp.session.judging.report import report_of
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.repeat.comparing import OtherFrameError, compared, labels_of
from pinwarp.session.repeat.level import (
    about_session,
    penalty_of_noise,
    with_penalty,
    with_spreads_of,
    without_spreads,
)
from pinwarp.session.repeat.reading import Repeat, read_repeat
from pinwarp.session.repeat.spreads import spreads_on_destination
from pinwarp.session.warp.solved import solved


@pytest.fixture(scope="module")
def session():
    return read_session(sample_session(), meshes=())


def jittered(session, name, seed, size=0.4, side=Side.DESTINATION, change=lambda x: x):
    """Return one more repeat of a side, as a file of that name would hold it."""
    rng = np.random.default_rng(seed)
    places = {
        x.name: tuple(change(np.array(x.position(side)) + size * rng.normal(size=3)).tolist())
        for x in session.pairs
    }
    return Repeat(Path(name), places)


def repeats_of(session, side=Side.DESTINATION, size=0.4):
    return compared([jittered(session, x, i, size, side) for i, x in enumerate("ab")])


def notes_of(*repeats, **how):
    return "\n".join(compared(repeats, **how).notes)


def test_what_is_missing_reordered_or_spelt_otherwise_is_named(session):
    one, two = jittered(session, "a.csv", 1), jittered(session, "b.csv", 2)
    assert notes_of(one, two) == ""
    names = list(two.places)
    turned = {x: two.places[x] for x in reversed(names[1:])} | {names[0].upper(): (0, 0, 0)}
    notes = notes_of(one, replace(two, places=turned))
    assert f"b.csv lacks {names[0]}." in notes
    assert f"b.csv has {names[0].upper()!r}: is it {names[0]!r}?" in notes
    assert "b.csv lists its landmarks in another order: they were matched by name." in notes
    assert "in one file only" in notes


def test_names_that_nobody_shares_are_refused_and_matched_by_order_when_asked(session):
    one, two = jittered(session, "a.csv", 1), jittered(session, "b.csv", 2)
    other = replace(two, places={f"p{i}": x for i, x in enumerate(two.places.values())})
    with pytest.raises(PinwarpError, match=r"No name is in two of the files: .* their order"):
        compared([one, other])
    by_order = compared([one, other], by_order=True)
    assert np.array_equal(by_order.figures.spreads, compared([one, two]).figures.spreads)
    shorter = replace(other, places=dict(list(other.places.items())[1:]))
    with pytest.raises(PinwarpError, match="cannot be matched"):
        compared([one, shorter], by_order=True)


@pytest.mark.parametrize("change", [(-1, -1, 1), (0.001,) * 3, (-1e3, -1e3, 1e3)])
def test_another_frame_or_unit_is_refused_and_undone_only_when_asked(session, change):
    one, two = jittered(session, "a.csv", 1), jittered(session, "b.csv", 2)
    other = jittered(session, "b.csv", 2, change=lambda x: x * change)
    with pytest.raises(OtherFrameError, match=r"b\.csv seems to be in another frame or unit"):
        compared([one, other])
    adapted = compared([one, other], adapt=True)
    assert adapted.figures.spreads == pytest.approx(compared([one, two]).figures.spreads)
    assert "b.csv was taken " in "\n".join(adapted.notes)


def test_what_two_files_say_of_frame_and_unit_is_believed(session):
    one = replace(jittered(session, "a.csv", 1), unit="mm", frame="LPS")
    plain = jittered(session, "b.csv", 2)
    other = jittered(session, "b.csv", 2, change=lambda x: x * [-0.1, -0.1, 0.1])
    other = replace(other, unit="cm", frame="RAS")
    found = compared([one, other])
    assert found.figures.spreads == pytest.approx(compared([one, plain]).figures.spreads)
    assert found.notes == (
        "b.csv was converted from cm to mm and from RAS to LPS, as a.csv says it is.",
    )


def test_copies_are_named_and_nothing_but_copies_refused(session):
    one, two = jittered(session, "a.csv", 1), jittered(session, "b.csv", 2)
    copy = replace(one, path=Path("c.csv"))
    assert "a.csv and c.csv hold the same positions: a copy" in notes_of(one, two, copy)
    with pytest.raises(PinwarpError, match=r"a\.csv and c\.csv hold the same positions"):
        compared([one, copy])
    with pytest.raises(PinwarpError, match="given twice"):
        compared([one, one])
    name = next(iter(one.places))
    partly = replace(two, places={**two.places, name: one.places[name]})
    assert f"{name} lies at the very same place in a.csv and b.csv" in notes_of(one, partly)


def test_a_bone_that_was_moved_between_is_told_from_noise(session):
    one = jittered(session, "a.csv", 1)
    moved = jittered(session, "b.csv", 2, change=lambda x: np.add(x, (5, 0, 2)))
    assert "b.csv stands otherwise than a.csv" in notes_of(one, moved)
    assert "Was the bone moved" in notes_of(one, moved)


def test_exchanged_names_and_what_stands_out_are_named_with_their_file(session):
    files = [jittered(session, f"{x}.csv", i) for i, x in enumerate("abc")]
    first, second, third = list(files[0].places)[:3]
    wrong = dict(files[1].places)
    wrong[first], wrong[second] = wrong[second], wrong[first]
    files[1] = replace(files[1], places=wrong)
    off = dict(files[2].places)
    off[third] = (off[third][0] + 9, *off[third][1:])
    files[2] = replace(files[2], places=off)
    notes = notes_of(*files)
    assert f"In b.csv, {first} and {second} seem to be exchanged." in notes
    assert f"{third} stands out" in notes
    assert "c.csv has it farthest from the others." in notes
    assert "Without these the pooled spread would be" in notes
    of_two = notes_of(files[0], files[1])
    assert f"In one of the files, {first} and {second} seem to be exchanged." in of_two


def test_files_of_one_name_are_called_by_their_folder(tmp_path):
    assert labels_of([tmp_path / "ann" / "x.csv", tmp_path / "bob" / "x.csv"]) == (
        "ann/x.csv",
        "bob/x.csv",
    )


def test_a_session_and_a_file_are_compared_once_the_side_is_known(session, tmp_path):
    path = tmp_path / "femur.pinwarp.csv"
    write_session(path, session)
    with pytest.raises(PinwarpError, match="holds both sides"):
        read_repeat(path)
    there = {x.name: x.source for x in session.landmarks if x.source is not None}
    assert read_repeat(path, Side.SOURCE).places == there


def test_the_noise_of_both_sides_adds_up(session):
    destination = repeats_of(session)
    source = repeats_of(session, Side.SOURCE)
    alone = penalty_of_noise(session, Side.DESTINATION, destination)
    kept = with_spreads_of(session, Side.SOURCE, source)
    both = penalty_of_noise(kept, Side.DESTINATION, destination)
    assert both.sides == tuple(Side)
    assert "counts as exact" in alone.words
    assert "counts as exact" not in both.words
    assert both.noise > 1.2 * alone.noise
    assert both.penalty > alone.penalty
    assert alone.low < alone.penalty < alone.high
    assert with_penalty(session, alone.penalty).settings.penalty == alone.penalty
    few = replace(session, landmarks=session.landmarks[:4])
    with pytest.raises(PinwarpError, match="five in general position"):
        penalty_of_noise(few, Side.DESTINATION, destination)
    with pytest.raises(PinwarpError, match="for the basis r only"):
        penalty_of_noise(edits.set_basis(session, Basis.R2_LOG_R), Side.DESTINATION, destination)


def test_repeats_of_the_other_side_another_unit_or_other_names_are_told(session):
    repeats = repeats_of(session, Side.SOURCE)
    told = "\n".join(about_session(session, Side.DESTINATION, repeats))
    assert "is it the source that was digitised again?" in told
    assert "digitised again?" not in "\n".join(about_session(session, Side.SOURCE, repeats))
    files = [jittered(session, x, i, change=lambda x: x / 1000) for i, x in enumerate("ab")]
    for ask in (penalty_of_noise, with_spreads_of):
        with pytest.raises(PinwarpError, match="in another unit, or of another bone"):
            ask(session, Side.DESTINATION, compared(files))
    renamed = replace(session, landmarks=(Landmark("strange"),))
    with pytest.raises(PinwarpError, match="has no landmark called"):
        with_spreads_of(renamed, Side.DESTINATION, repeats)
    assert "strange has no spread." in about_session(renamed, Side.DESTINATION, repeats)


def test_spreads_follow_their_landmark_through_every_edit(session):
    repeats = repeats_of(session)
    kept = with_spreads_of(session, Side.DESTINATION, repeats)
    first = kept.pairs[0]
    assert first.destination_spread == repeats.spreads[first.name]
    renamed = edits.rename(kept, first.name, "renamed")
    assert renamed.landmark("renamed").destination_spread == first.destination_spread
    swapped = edits.swap_sides(kept)
    assert swapped.landmark(first.name).source_spread == first.destination_spread
    assert edits.swap_sides(swapped).landmarks == kept.landmarks
    gone = edits.remove(kept, [first.name])
    assert first.name not in spreads_on_destination(gone)
    assert without_spreads(kept).landmarks == session.landmarks
    assert len(spreads_on_destination(kept)) == len(kept.pairs)


def test_check_and_report_tell_residuals_in_units_of_the_spread(session):
    kept = with_spreads_of(with_penalty(session, 5.0), Side.DESTINATION, repeats_of(session))
    checked = check(kept)
    first = checked.pairs[0]
    assert first.spread == kept.pairs[0].destination_spread
    assert checked.as_json()["pairs"][0]["spread"] == first.spread
    assert check(session).as_json()["pairs"][0]["spread"] is None
    report = report_of("femur", solved(kept), datetime(2026, 1, 1, tzinfo=UTC))
    rows = {(x.item, x.quantity): x.value for x in report.figures}
    assert rows[first.name, "residual / spread"] == pytest.approx(first.residual / first.spread)
    assert dict(report.facts)["Spread of the destination"].endswith("mm, as digitised again")


def test_check_and_report_say_in_units_of_the_spread_how_far_a_pair_is_off(session):
    kept = with_spreads_of(session, Side.DESTINATION, repeats_of(session))
    name, (x, y, z) = kept.pairs[3].name, kept.pairs[3].destination
    kept = edits.move(kept, name, Side.DESTINATION, (x, y, z + 60))
    (found,) = [one for one in check(kept).findings if one.names == (name,)]
    times = found.finding.others[0] / kept.landmark(name).destination_spread
    assert f" expect it, {times:.0f} times its own spread; " in found.sentence
    report = report_of("femur", solved(kept), datetime(2026, 1, 1, tzinfo=UTC))
    assert found.sentence in report.findings
    (plain,) = [one for one in check(without_spreads(kept)).findings if one.names == (name,)]
    assert "spread" not in plain.sentence
