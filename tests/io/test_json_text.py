"""JSON with a key twice."""

from __future__ import annotations

from pinwarp.core.landmarks import Side
from pinwarp.io.landmark_files import read_landmarks

POINT = '{"label": "a", "position": [1, 2, 3]}'


def notes(tmp_path, text: str) -> tuple[str, ...]:
    path = tmp_path / "a.mrk.json"
    path.write_text(text)
    return read_landmarks(path, Side.SOURCE).notes


def test_a_key_that_is_there_twice_is_noted_wherever_it_is(tmp_path):
    twice = '{"label": "b", "position": [1, 2, 3], "position": [4, 5, 6]}'
    assert notes(tmp_path, f'{{"markups": [{{"controlPoints": [{POINT}, {twice}]}}]}}') == (
        "A key is there twice, and the last counts: 'position'.",
    )
    lists = f'{{"markups": [], "markups": [{{"controlPoints": [{POINT}]}}]}}'
    assert notes(tmp_path, lists) == ("A key is there twice, and the last counts: 'markups'.",)


def test_the_same_key_in_two_objects_is_usual(tmp_path):
    other = POINT.replace("a", "b")
    assert notes(tmp_path, f'{{"markups": [{{"controlPoints": [{POINT}, {other}]}}]}}') == ()


def test_many_such_keys_are_counted_and_long_ones_cut(tmp_path):
    keys = ", ".join(f'"{letter * 1000}": 1, "{letter * 1000}": 2' for letter in "abcde")
    (note,) = notes(tmp_path, f'{{"markups": [{{"controlPoints": [{POINT}], {keys}}}]}}')
    assert note.endswith("and 2 more.")
    assert len(note) < 300
