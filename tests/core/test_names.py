"""Names that differ only in what cannot be seen."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.names import look_alike_notes, look_alikes, visible

UNSEEN = {
    "no width": "fo\u200bvea",
    "a joiner": "fo\u200dvea",
    "a mark of order": "\ufefffovea",
    "a soft hyphen": "fo\u00advea",
    "a direction": "\u202dfovea\u202c",
    "a blank behind": "fovea ",
    "a hard blank behind": "fovea\u00a0",
    "a blank of braille": "fovea\u2800",
    "a filler": "fovea\u3164",
    "a choice of shape": "fovea\ufe0f",
    "a joiner of letters": "fo\u034fvea",
    "a tag": "fovea\U000e0041",
    "a control character": "fovea\x00",
}


@pytest.mark.parametrize("name", UNSEEN.values(), ids=UNSEEN)
def test_a_name_with_something_unseen_looks_like_the_one_without(name):
    assert visible(name) == "fovea"
    assert look_alikes(["fovea", name]) == (("fovea", name),)
    (note,) = look_alike_notes(["fovea", name])
    assert note.isprintable()
    assert ascii(name) in note


def test_letters_composed_in_two_ways_look_alike():
    assert look_alikes(["t\u00eate", "te\u0302te", "\u1112\u1161\u11ab", "\ud55c"]) == (
        ("t\u00eate", "te\u0302te"),
        ("\u1112\u1161\u11ab", "\ud55c"),
    )
    assert visible("e\u200d\u0301") == "\u00e9"


def test_blanks_of_every_kind_are_one():
    assert {visible(f"a{blank}b") for blank in " \t\u00a0\u2009\u3000\u202f"} == {"a b"}


def test_names_that_can_be_told_apart_give_no_note():
    assert look_alike_notes(["a", "A", "a b", "ab", "\u00e9", "e", "a1", "a-1", "a"]) == ()


def test_many_notes_are_counted_and_long_names_cut():
    names = [letter * 100 for letter in "abcde"]
    notes = look_alike_notes([*names, *(f"\u200b{name}" for name in names)])
    assert len(notes) == 4
    assert notes[-1] == "2 more names look like another one."
    assert max(map(len, notes)) < 250


@given(st.text(max_size=8), st.text(max_size=8))
def test_what_is_seen_is_seen_again(one, other):
    assert visible(visible(one)) == visible(one)
    assert (len(look_alikes([one, other])) == 1) == (
        one != other and visible(one) == visible(other)
    )
