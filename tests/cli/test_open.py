"""Which words open the window, and on what."""

from __future__ import annotations

import pytest


def test_without_words_the_window_opens_empty(pinwarp_command):
    pinwarp_command()
    assert pinwarp_command.opened == [{}]


def test_two_meshes_and_their_landmarks_open_in_the_window(pinwarp_command, study):
    source, destination, marks = study / "source.ply", study / "s0.stl", study / "source.csv"
    pinwarp_command(source, destination, "--source-landmarks", marks)
    pinwarp_command("--source-landmarks", marks, source, destination)
    pinwarp_command("open", source, destination, "--source-landmarks", marks)
    assert pinwarp_command.opened == 3 * [
        {"source": source, "destination": destination, "source_landmarks": marks}
    ]


def test_a_session_opens_in_the_window(pinwarp_command, study):
    pinwarp_command(study / "study.pinwarp.csv")
    assert pinwarp_command.opened == [{"session": study / "study.pinwarp.csv"}]


def test_passengers_open_with_a_session_and_with_meshes(pinwarp_command, study):
    marks, session = study / "source.csv", study / "study.pinwarp.csv"
    pinwarp_command(session, "--passengers", marks)
    assert pinwarp_command.opened == [{"session": session, "passengers": marks}]
    outcome = pinwarp_command("--demo", "--passengers", marks, exit_code=2)
    assert "give no files with it" in outcome.stderr


def test_a_first_word_that_is_no_command_is_a_file(pinwarp_command):
    outcome = pinwarp_command("wrap", exit_code=2)
    assert "wrap does not exist. It is no command either" in outcome.stderr
    assert "command" not in pinwarp_command("wrap.ply", exit_code=2).stderr
    assert not pinwarp_command.opened


def test_a_file_called_like_a_command_is_opened_by_its_path(
    pinwarp_command, study, monkeypatch, tmp_path
):
    (tmp_path / "warp").write_bytes((study / "source.ply").read_bytes())
    monkeypatch.chdir(tmp_path)
    pinwarp_command("./warp")
    assert [str(opened["source"]) for opened in pinwarp_command.opened] == ["warp"]


def test_the_sample_takes_no_files(pinwarp_command, study):
    assert "give no files" in pinwarp_command("--demo", study / "s0.stl", exit_code=2).stderr
    pinwarp_command("--demo")
    assert pinwarp_command.opened == [{"demo": True}]


@pytest.mark.parametrize("words", [["--version"], ["--demo", "--version"]])
def test_the_version_comes_before_everything(pinwarp_command, words):
    assert pinwarp_command(*words).stdout.startswith("pinwarp ")
    assert not pinwarp_command.opened


def test_the_help_names_every_command(pinwarp_command):
    words = pinwarp_command("--help").stdout
    for command in ("open", "warp", "check", "convert", "batch"):
        assert f" {command} " in words
        assert "Usage" in pinwarp_command(command, "--help").stdout
