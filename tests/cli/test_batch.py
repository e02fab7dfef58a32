"""Many subjects at once: all that can go wrong with one must not touch the others."""

from __future__ import annotations

import csv
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from tests.session.study import bone, make_study, shape

from pinwarp.core.landmarks import Side, scaled
from pinwarp.io.landmark_files import read_landmarks, write_landmarks
from pinwarp.io.meshes import read_mesh
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.session import Session
from pinwarp.session.study.workers import WorkEnded


@pytest.fixture
def out(tmp_path):
    return tmp_path / "out"


@pytest.fixture
def run(pinwarp_command, study, out):
    """Run the study's batch in this process, or as told."""

    def run_(*options, exit_code=0, manifest=study / "study.csv"):
        return pinwarp_command(
            *("batch", manifest, "-o", out, "--session", study / "study.pinwarp.csv"),
            *("--jobs", 1, *options),
            exit_code=exit_code,
        )

    return run_


def rows_of(out):
    with (out / "summary.csv").open(newline="") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def stamps(out):
    return {
        path.name: path.stat().st_mtime_ns for path in out.iterdir() if "summary" not in str(path)
    }


def test_every_subject_gets_its_mesh_its_passengers_and_a_row_of_figures(run, out):
    assert "3 done, 0 unchanged, 0 failed of 3" in run().stdout
    rows = rows_of(out)
    assert list(rows) == ["s0", "s1", "s2"]
    for number in range(3):
        row = rows[f"s{number}"]
        warped = read_mesh(out / f"s{number}_warped.ply").mesh
        apart = np.linalg.norm(warped.vertices - shape(bone().vertices, number), axis=1)
        assert apart.mean() < 3
        muscle = read_landmarks(out / f"s{number}_passengers.landmarks.csv", Side.SOURCE)
        assert muscle.names == ("muscle",)
        assert (row["status"], row["pairs"], row["error"]) == ("done", "8", "")
        assert float(row["rms_residual"]) == pytest.approx(0, abs=1e-9)
        assert float(row["rms_leave_one_out"]) > 0.1
        assert float(row["flexibility"]) == 1
        assert 0 < float(row["distance_mean"]) <= float(row["distance_95"])
        assert float(row["distance_95"]) <= float(row["distance_max"])
        assert row["folded_vertices"] == "0"
        assert float(row["seconds"]) > 0


def test_the_source_can_be_given_without_a_session(pinwarp_command, study, out, tmp_path):
    pinwarp_command(
        *("batch", study / "study.csv", "-o", out, "--jobs", 1, "--source", study / "source.ply"),
        *("--source-landmarks", study / "source.csv", "--passengers", study / "muscle.csv"),
    )
    other = tmp_path / "other"
    pinwarp_command(
        *("batch", study / "study.csv", "-o", other, "--jobs", 1),
        *("--session", study / "study.pinwarp.csv"),
    )
    names = sorted(path.name for path in out.iterdir())
    assert names == sorted(path.name for path in other.iterdir())
    for name in names:
        if name != "summary.csv":
            assert (out / name).read_bytes() == (other / name).read_bytes()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([], "Name the source"),
        (["--source", "source.ply"], "Name the source"),
        (["--session", "study.pinwarp.csv", "--source", "source.ply"], "either --session, or"),
        (["--session", "study.pinwarp.csv", "--format", "doc"], "'.doc' are not supported"),
        (["--session", "study.pinwarp.csv", "--passengers", "source.csv"], "p0 is a landmark"),
        (["--session", "study.pinwarp.csv", "--penalty", "nan"], "must be 0 or more"),
        (["--session", "gone.pinwarp.csv"], "There is no such file"),
    ],
)
def test_a_source_that_is_not_clear_is_refused(
    pinwarp_command, study, out, monkeypatch, options, words
):
    monkeypatch.chdir(study)
    outcome = pinwarp_command("batch", "study.csv", "-o", out, *options, exit_code=2)
    assert words in outcome.stderr
    assert outcome.stderr.startswith("pinwarp: ")
    assert not out.exists()


def test_a_manifest_with_a_mistake_is_refused_with_its_line(run, study, out):
    manifest = study / "bad.csv"
    manifest.write_text("name,destination_landmarks\ns0,s0.csv\na/b,s1.csv\n")
    outcome = run(manifest=manifest, exit_code=2)
    assert outcome.stderr.startswith("pinwarp: bad.csv, line 3: The name 'a/b' holds '/'")
    assert not out.exists()


def test_a_row_that_cannot_be_used_fails_and_the_others_are_done(run, study, out):
    manifest = study / "bad.csv"
    manifest.write_text(
        "name,destination_landmarks,penalty\ns0,s0.csv,much\ns1,~nosuchuser/x.csv,\ns2,s2.csv,\n"
    )
    outcome = run(manifest=manifest, exit_code=1)
    assert "1 done, 0 unchanged, 2 failed of 3" in outcome.stdout
    assert "s0: bad.csv, line 2: In the column 'penalty': 'much' is not a number." in outcome.stderr
    rows = rows_of(out)
    assert [row["status"] for row in rows.values()] == ["failed", "failed", "done"]
    assert "line 3: In the column 'destination_landmarks': there is no user" in rows["s1"]["error"]
    manifest.write_text(manifest.read_text().replace("much", "2"))
    assert "1 done, 1 unchanged, 1 failed" in run(manifest=manifest, exit_code=1).stdout


def test_a_name_that_only_looks_like_one_of_the_source_is_told(run, study, out):
    marks = study / "s0.csv"
    lines = marks.read_text().splitlines()
    name = lines[1].partition(",")[0]
    text = "\n".join([lines[0], "\u200b" + lines[1], *lines[2:]]) + "\n"
    marks.write_text(text, encoding="utf-8")
    run()
    assert f"'{name}' and '\\u200b{name}' look alike" in rows_of(out)["s0"]["notes"]


def test_a_subject_that_fails_is_told_and_the_others_are_done(run, study, out):
    (study / "s0.csv").unlink()
    (study / "s1.stl").write_text("nonsense")
    outcome = run(exit_code=1)
    assert "1 done, 0 unchanged, 2 failed of 3" in outcome.stdout
    assert "pinwarp: s0: study.csv, line 2: The file" in outcome.stderr
    rows = rows_of(out)
    assert [row["status"] for row in rows.values()] == ["failed", "failed", "done"]
    assert "line 2: The file" in rows["s0"]["error"]
    assert rows["s1"]["error"].startswith("s1.stl: ")
    assert not (out / "s1_warped.ply").exists()


def test_a_cell_that_is_no_number_fails_its_row_and_names_its_column(run, study, out):
    manifest = study / "own.csv"
    head = "name,destination_landmarks,penalty"
    manifest.write_text(f"{head}\ns0,s0.csv,1\ns1,s1.csv,0.5\n")
    run(manifest=manifest)
    # Its outputs of before are there, and it is not unchanged all the same.
    manifest.write_text(f"{head}\ns0,s0.csv,much\ns1,s1.csv,0.5\n")
    outcome = run(manifest=manifest, exit_code=1)
    words = "own.csv, line 2: In the column 'penalty': 'much' is not a number."
    assert outcome.stderr == f"pinwarp: s0: {words}\n"
    assert "0 done, 1 unchanged, 1 failed of 2" in outcome.stdout
    rows = rows_of(out)
    assert (rows["s0"]["status"], rows["s0"]["error"]) == ("failed", words)
    assert rows["s1"]["status"] == "done"


def test_what_was_done_stays_when_the_cluster_is_lost(pinwarp_command, study, out, monkeypatch):
    def lost_after_one(function, tasks):
        yield tasks[0], function(tasks[0])
        raise WorkEnded("The scheduler is gone.")

    arguments = ("batch", study / "study.csv", "-o", out, "--session", study / "study.pinwarp.csv")
    with monkeypatch.context() as patch:
        patch.setattr("pinwarp.cli.many.runner_of", lambda *_: lost_after_one)
        outcome = pinwarp_command(*arguments, "--scheduler", "tcp://node7:8786", exit_code=3)
    assert outcome.stdout.startswith("1 done, 0 unchanged, 0 failed of 3: see ")
    assert outcome.stderr == (
        "pinwarp: The scheduler is gone. What was done stays: "
        "the same command goes on from there.\n"
    )
    assert list(rows_of(out)) == ["s0"]
    assert "2 done, 1 unchanged" in pinwarp_command(*arguments, "--jobs", 1).stdout


def test_a_malformed_address_is_refused_before_anything_is_read_or_written(pinwarp_command, out):
    outcome = pinwarp_command(
        "batch", "gone.csv", "-o", out, "--scheduler", "tcp://node7", exit_code=2
    )
    assert outcome.stderr.startswith("pinwarp: 'tcp://node7' is no address of a scheduler: ")
    assert not out.exists()


def test_an_interruption_that_is_meant_ends_in_words(run, monkeypatch):
    def interrupt(*_arguments, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr("pinwarp.session.study.batch.run", interrupt)
    assert run(exit_code=130).stderr == "pinwarp: Interrupted.\n"


def test_a_second_run_does_only_what_failed(run, study, out):
    text = (study / "s1.csv").read_text()
    (study / "s1.csv").write_text("nonsense")
    run(exit_code=1)
    before = stamps(out)
    (study / "s1.csv").write_text(text)
    assert "1 done, 2 unchanged, 0 failed" in run().stdout
    after = stamps(out)
    assert {name: after[name] for name in before} == before
    assert rows_of(out)["s1"]["status"] == "done"


def test_a_second_run_without_any_change_does_nothing(run, out):
    run()
    before, figures = stamps(out), rows_of(out)
    assert "0 done, 3 unchanged" in run().stdout
    assert (stamps(out), rows_of(out)) == (before, figures)
    assert "3 done" in run("--force").stdout
    assert not stamps(out).items() & before.items()


@pytest.mark.parametrize("changed", ["s1.csv", "s1.stl"])
def test_a_subject_whose_input_changed_is_done_again(run, study, out, changed):
    run()
    before = stamps(out)
    (study / changed).write_bytes((study / "s2").with_suffix(changed[2:]).read_bytes())
    assert "1 done, 2 unchanged" in run().stdout
    again = {name for name, stamp in stamps(out).items() if stamp != before[name]}
    assert again == {"s1_warped.ply", "s1_passengers.landmarks.csv"}


def test_an_input_that_was_only_touched_is_not_a_change(run, study):
    run()
    for path in study.iterdir():
        os.utime(path, (0, 0))
    assert "3 unchanged" in run().stdout


@pytest.mark.parametrize(
    "options",
    [["--penalty", 2], ["--components", "affine"], ["--blend", 0.5], ["--format", "stl"]],
)
def test_other_options_are_a_change(run, options):
    run()
    assert "3 done" in run(*options).stdout


def test_a_source_that_changed_is_a_change_for_all(run, study):
    run()
    session = read_session(study / "study.pinwarp.csv")
    moved = session.landmarks[0].placed(Side.SOURCE, (1, 2, 3))
    write_session(
        study / "study.pinwarp.csv", replace(session, landmarks=(moved, *session.landmarks[1:]))
    )
    assert "3 done" in run().stdout


def test_an_output_that_is_missing_is_made_again(run, out):
    run()
    (out / "s2_warped.ply").unlink()
    assert "1 done, 2 unchanged" in run().stdout
    assert (out / "s2_warped.ply").is_file()


def test_a_row_goes_before_the_options_and_these_before_the_session(run, study, out):
    manifest = study / "own.csv"
    manifest.write_text(
        "name,destination_landmarks,penalty,components\ns0,s0.csv,inf,\ns1,s1.csv,,rigid\n"
    )
    run("--penalty", 3, manifest=manifest)
    rows = rows_of(out)
    assert (rows["s0"]["penalty"], rows["s1"]["penalty"]) == ("inf", "3")
    assert float(rows["s0"]["flexibility"]) == 0
    rigid = read_mesh(out / "s1_warped.ply").mesh.vertices
    assert np.linalg.norm(np.ptp(rigid, axis=0)) > 0
    lengths = [np.linalg.norm(x[1:] - x[:-1], axis=1) for x in (rigid, bone().vertices)]
    assert lengths[0] == pytest.approx(lengths[1])


def test_landmarks_without_a_counterpart_are_told_in_the_summary(run, study, out):
    path = study / "s0.csv"
    lines = path.read_text().splitlines()
    path.write_text("\n".join([*lines[:-1], "unheard_of,1,2,3", "bad,1,2,nan"]) + "\n")
    run()
    row = rows_of(out)["s0"]
    assert row["pairs"] == "7"
    assert "1 landmark is not in s0.csv: p7." in row["notes"]
    assert "1 landmark is not on the source: unheard_of." in row["notes"]
    assert "line 10 was skipped" in row["notes"]


def test_a_passenger_in_the_subjects_own_file_is_no_unknown_landmark(run, study, out):
    path = study / "s0.csv"
    path.write_text(path.read_text().rstrip("\n") + "\nmuscle,1,2,3\n")
    run()
    row = rows_of(out)["s0"]
    assert (row["pairs"], row["notes"]) == ("8", "")


def test_a_subject_without_any_known_name_fails_with_both_lists(run, study, out):
    (study / "s0.csv").write_text("name,x,y,z\na,1,2,3\nb,4,5,6\n")
    run(exit_code=1)
    assert "It has a, b; the source has p0, p1, p2 and 5 more." in rows_of(out)["s0"]["error"]


def test_names_that_a_spreadsheet_would_run_are_quoted_and_found_again(run, study, out):
    manifest = study / "formulas.csv"
    manifest.write_text("name,destination_landmarks\n'=1+1,s0.csv\n-7,s1.csv\n")
    run(manifest=manifest)
    assert list(rows_of(out)) == ["'=1+1", "'-7"]
    assert (out / "=1+1_warped.ply").is_file()
    assert "2 unchanged" in run(manifest=manifest).stdout


def test_a_summary_that_a_spreadsheet_saved_again_is_still_known(run, out):
    run()
    path = out / "summary.csv"
    rows = list(csv.reader(path.read_text().splitlines()))
    with path.open("w", newline="", encoding="utf-8-sig") as file:
        csv.writer(file, delimiter=";").writerows(rows)
    assert "3 unchanged" in run().stdout


def test_a_damaged_summary_only_costs_time(run, out):
    run()
    (out / "summary.csv").write_bytes(b"\0\1\2")
    assert "3 done" in run().stdout


def test_another_manifest_into_the_same_folder_keeps_what_was_done(run, study, out):
    run()
    manifest = study / "one.csv"
    manifest.write_text("name,destination_landmarks\nonly,s1.csv\n")
    run(manifest=manifest)
    assert list(rows_of(out)) == ["only", "s0", "s1", "s2"]
    assert "3 unchanged" in run().stdout


@pytest.mark.parametrize("name", ["source.ply", "s1.stl", "s1.csv", "study.pinwarp.csv"])
def test_no_input_is_ever_replaced(pinwarp_command, study, name):
    # A link in the folder of outputs leads to the input.
    out = study / "out"
    out.mkdir()
    output = "s0_warped.ply"
    (out / output).symlink_to(study / name)
    before = (study / name).read_bytes()
    outcome = pinwarp_command(
        *("batch", study / "study.csv", "-o", out, "--jobs", 1, "--force"),
        *("--session", study / "study.pinwarp.csv"),
        exit_code=2,
    )
    assert "would be replaced, but it is read" in outcome.stderr
    assert (study / name).read_bytes() == before


def test_a_manifest_called_like_the_summary_is_not_replaced(pinwarp_command, study):
    manifest = (study / "study.csv").rename(study / "summary.csv")
    before = manifest.read_bytes()
    pinwarp_command(
        *("batch", manifest, "-o", study, "--session", study / "study.pinwarp.csv"), exit_code=2
    )
    assert manifest.read_bytes() == before


def test_columns_that_mean_nothing_are_named(run, study):
    manifest = study / "more.csv"
    manifest.write_text("name,destination_landmarks,age,penality\ns0,s0.csv,7,2\n")
    assert "not used: age, penality" in run(manifest=manifest).stderr


def test_a_source_without_landmarks_is_refused(run, study):
    session = read_session(study / "study.pinwarp.csv")
    write_session(study / "study.pinwarp.csv", Session(source=session.source))
    assert "no landmark to be paired" in run(exit_code=2).stderr


def command(study, out, *options):
    return [
        *(sys.executable, "-m", "pinwarp", "batch", str(study / "study.csv"), "-o", str(out)),
        *("--session", str(study / "study.pinwarp.csv"), *options),
    ]


def test_processes_of_their_own_make_the_same(run, study, out, tmp_path):
    run()
    other = tmp_path / "other"
    outcome = subprocess.run(
        command(study, other, "--jobs", "2"), capture_output=True, text=True, timeout=120
    )
    assert outcome.returncode == 0, outcome.stderr
    assert outcome.stdout.startswith("3 done, 0 unchanged, 0 failed of 3: see ")
    for name in stamps(out):
        assert (out / name).read_bytes() == (other / name).read_bytes()


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX")
@pytest.mark.parametrize("ending", ["SIGINT", "SIGTERM"])
def test_what_was_done_stays_when_a_batch_is_stopped(tmp_path, ending):
    study, out = tmp_path / "study", tmp_path / "out"
    make_study(study, 300, meshes=False)
    batch = subprocess.Popen(
        command(study, out, "--jobs", "2"),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    while batch.poll() is None and not list(out.glob("*.ply")):
        time.sleep(0.02)
    # Ctrl+C reaches all processes of a terminal at once, other signals only one.
    if ending == "SIGINT":
        os.killpg(batch.pid, signal.SIGINT)
    else:
        batch.terminate()
    told, errors = batch.communicate(timeout=120)
    assert batch.returncode == 130, errors
    assert "Traceback" not in errors
    assert "the same command goes on from there" in errors
    rows = rows_of(out)
    assert 0 < len(rows) < 300
    assert {row["status"] for row in rows.values()} == {"done"}
    assert told.startswith(f"{len(rows)} done, 0 unchanged, 0 failed of 300")
    assert not [path for path in out.iterdir() if path.name.startswith(".")]


def test_landmarks_in_another_frame_or_unit_have_a_column_of_their_own(run, study, out):
    placed = read_landmarks(study / "s1.csv", Side.DESTINATION).landmarks
    write_landmarks(study / "s1.csv", scaled(placed, 0.001), Side.DESTINATION)
    run()
    rows = rows_of(out)
    assert rows["s0"]["frame_or_unit"] == ""
    assert rows["s1"]["frame_or_unit"] == "destination: Multiply by 1,000?"
    assert "The destination landmarks lie" in rows["s1"]["findings"]


def as_tps(study, *numbers):
    """The subjects' landmarks as the specimens of one file, and the source's names by its rows."""
    texts = []
    for number in numbers:
        path = study / "one.tps"
        marks = read_landmarks(study / f"s{number}.csv", Side.DESTINATION).landmarks
        write_landmarks(path, marks, Side.DESTINATION)
        texts.append(path.read_text().replace("ID=one", f"ID=s{number}"))
    (study / "all.tps").write_text("".join(texts))
    source = study / "source.csv"
    source.write_text(source.read_text().replace("\np", "\nlandmark_"))


def test_specimens_of_one_file_are_subjects_by_name_or_all(pinwarp_command, study, out):
    as_tps(study, 0, 1, 2)
    manifest = study / "study.csv"
    manifest.write_text("name,destination_landmarks\none,all.tps#s1\nby,all.tps#all\n")
    source = ("--source", study / "source.ply", "--source-landmarks", study / "source.csv")
    command = ("batch", manifest, "-o", out, *source, "--jobs", 1)
    assert "4 done, 0 unchanged, 0 failed of 4" in pinwarp_command(*command).stdout
    rows = rows_of(out)
    assert list(rows) == ["one", "by_s0", "by_s1", "by_s2"]
    one, other = (read_mesh(out / f"{x}_warped.ply").mesh for x in ("one", "by_s1"))
    assert np.array_equal(one.vertices, other.vertices)
    assert "4 unchanged" in pinwarp_command(*command).stdout


def test_both_sides_may_come_from_two_specimens_of_one_file(pinwarp_command, study, out):
    as_tps(study, 0, 1)
    manifest = study / "study.csv"
    manifest.write_text("name,destination_landmarks\none,all.tps#s1\n")
    source = ("--source", study / "s0.stl", "--source-landmarks", study / "all.tps#s0")
    pinwarp_command("batch", manifest, "-o", out, *source, "--jobs", 1)
    assert rows_of(out)["one"]["pairs"] == "8"


def test_all_specimens_need_rows_of_their_own_where_they_have_meshes(run, study, out):
    as_tps(study, 0, 1)
    manifest = study / "study.csv"
    manifest.write_text(
        "name,destination_landmarks,destination_mesh\na,all.tps#all,s0.stl\nb,s0.csv#all,\n"
    )
    run(exit_code=1)
    rows = rows_of(out)
    assert "write a row for each, all.tps#NAME" in rows["a"]["error"]
    assert "s0.csv holds no specimens: leave out '#all'" in rows["b"]["error"]
