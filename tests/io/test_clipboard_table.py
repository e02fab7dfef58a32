"""Rows to and from a spreadsheet by the clipboard."""

from __future__ import annotations

import pytest
from hypothesis import given

from pinwarp.core.errors import LandmarkError
from pinwarp.core.landmarks import Landmark, Role
from pinwarp.io.clipboard_table import clipboard_text, read_clipboard

from . import strategies


@given(landmarks=strategies.landmark_lists(strategies.trimmed_names))
def test_what_was_copied_is_pasted_as_it_was(landmarks: list[Landmark]) -> None:
    table = read_clipboard(clipboard_text(landmarks))
    assert table.skipped == ()
    for row, landmark in zip(table.rows, landmarks, strict=True):
        pasted = row.onto(Landmark(row.name))
        assert pasted.note.strip() == landmark.note.strip()
        assert (pasted.name, pasted.source, pasted.destination, pasted.role, pasted.enabled) == (
            landmark.name,
            landmark.source,
            landmark.destination,
            landmark.role,
            landmark.enabled,
        )


@pytest.mark.parametrize(
    "text",
    [
        "fovea\t1\t2\t3\t4\t5\t6.5\r\n",
        "fovea,1,2,3,4,5,6.5",
        "Name;Source X;Source Y;Source Z;Dest. X;Dest. Y;Dest. Z\nfovea;1,0;2;3;4;5;6,5",
        "name,source.x,source.y,source.z,dest.x,dest.y,dest.z\nfovea,1,2,3,4,5,6.5\n",
        "landmark\tsourceX\tsourceY\tsourceZ\tdestination-x\tdestination-y\tdestination-z\n"
        "fovea\t1\t2\t3\t4\t5\t6,5",
        "\ufefffovea\tpair\t1\t1\t2\t3\t4\t5\t6.5\t\n",
    ],
)
def test_tables_are_understood_as_people_write_them(text: str) -> None:
    (row,) = read_clipboard(text).rows
    pasted = row.onto(Landmark(row.name))
    assert pasted == Landmark("fovea", (1, 2, 3), (4, 5, 6.5))


def test_an_empty_cell_changes_nothing() -> None:
    before = Landmark("a", (1, 2, 3), (4, 5, 6), Role.PASSENGER, enabled=False, note="worn")
    text = "name\trole\tenabled\tsource_x\tsource_y\tsource_z\tnote\na\t\t\t\t\t\t\n"
    assert read_clipboard(text).rows[0].onto(before) == before


def test_bad_rows_are_named_with_line_and_reason_and_the_others_read() -> None:
    table = read_clipboard(
        "name\tenabled\tsource_x\tsource_y\tsource_z\n"
        "a\t1\t1\t2\t3\n"
        "b\tmaybe\t1\t2\t3\n"
        "\n"
        "c\t1\t1\tx\t3\n"
        "\t1\t1\t2\t3\n"
        "a\t1\t1\t2\t3\n"
        "d\t1\t1\t2\n"
    )
    assert [row.name for row in table.rows] == ["a"]
    assert [(x.line, x.reason) for x in table.skipped] == [
        (3, "'enabled' is 'maybe' and not 1 or 0"),
        (5, "'x' is not a number"),
        (6, "it has no name"),
        (7, "the name 'a' was used before"),
        (8, "a number is missing"),
    ]


def test_a_thousands_separator_is_not_taken_for_a_decimal_comma() -> None:
    table = read_clipboard("a\t1,234\t2.5\t3\t4\t5\t6\n")
    assert table.skipped[0].reason == "'1,234' is not a number"


@pytest.mark.parametrize("text", ["", "\n\n", "some words that were copied", "a,b,c\n1,2,3"])
def test_text_that_is_no_table_of_landmarks_is_refused(text: str) -> None:
    with pytest.raises(LandmarkError, match="no landmarks to paste"):
        read_clipboard(text)


def test_a_column_given_twice_is_refused() -> None:
    with pytest.raises(LandmarkError, match="two columns called note"):
        read_clipboard("name,note,note\na,b,c")
