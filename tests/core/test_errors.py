"""What the user reads about an error."""

from __future__ import annotations

import pickle

import pytest

from pinwarp.core.errors import LONGEST, FileFormatError, LandmarkError, PinwarpError, words_of


@pytest.mark.parametrize(
    "error",
    [
        PinwarpError("start " + "a" * 1_000_000 + " end"),
        LandmarkError("start " + "a" * 1_000_000 + " end"),
        FileFormatError("a.csv", "start " + "a" * 1_000_000 + " end", 3),
        OSError(36, "File name too long", "start " + "a" * 1_000_000),
        ValueError("start " + "a" * 1_000_000 + " end"),
    ],
    ids=lambda error: type(error).__name__,
)
def test_a_message_is_cut_at_a_readable_length(error):
    words = words_of(error)
    assert len(words) <= LONGEST
    assert "start" in words
    assert words.endswith((" end", "File name too long."))
    if isinstance(error, PinwarpError):
        assert str(error) == words


def test_a_short_message_is_whole_and_survives_a_worker():
    error = FileFormatError("a.csv", "It is empty.", 3)
    assert str(error) == "a.csv, line 3: It is empty."
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.path, again.reason, again.line) == (
        *(str(error), error.path, "It is empty.", 3),
    )
