"""What an import would do, told before it is done."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from pinwarp.core.landmarks import Landmark, Role, Side
from pinwarp.core.mesh import Mesh
from pinwarp.core.surface_distance import SurfaceIndex
from pinwarp.io.landmark_files import LandmarkReading, SkippedLine
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.importing.asking import doubts_of, is_plain
from pinwarp.session.importing.fit import Fit, fits_of
from pinwarp.session.importing.landmarks import (
    Arriving,
    Fate,
    ImportChoice,
    Pairing,
    arrivals,
    awaiting,
    can_pair,
    default_pairing,
    imported,
)
from pinwarp.session.importing.words import left_waiting, summary
from pinwarp.session.naming import free_names
from pinwarp.session.session import Session

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION
BY_NAME, BY_ORDER, AS_NEW, AS_PASSENGERS, ONLY_KNOWN = Pairing


def placed(names, side=SOURCE, shift=0.0):
    return tuple(
        Landmark(name).placed(side, (shift + i, 0, 0)) for i, name in enumerate(names, start=1)
    )


def file(landmarks, side=DESTINATION, **more):
    reading = LandmarkReading(tuple(landmarks), side is None, **{"skipped": (), **more})
    return Arriving(Path("a.csv"), reading, side)


def words(session, arriving, pairing):
    return [x.words for x in arrivals(session, arriving, ImportChoice(pairing))]


def test_each_way_says_what_it_does_and_does_what_it_says():
    session = Session(landmarks=(*placed(["head", "fovea"]), Landmark("tip", (3, 0, 0), (9, 9, 9))))
    arriving = file(placed(["fovea", "tip", "neck"], DESTINATION, shift=10))
    assert words(session, arriving, BY_NAME) == [
        "pairs with fovea",
        "replaces the position of tip",
        "new",
    ]
    assert words(session, arriving, BY_ORDER) == ["pairs with head", "pairs with fovea", "new"]
    assert words(session, arriving, AS_NEW) == ["new, called fovea_2", "new, called tip_2", "new"]

    def destinations(pairing):
        after = imported(session, arriving, ImportChoice(pairing))
        return {x.name: x.destination and x.destination[0] for x in after.landmarks}

    assert destinations(BY_NAME) == {"head": None, "fovea": 11, "tip": 12, "neck": 13}
    assert destinations(BY_ORDER) == {"head": 11, "fovea": 12, "tip": 9, "neck": 13}
    assert destinations(AS_NEW) == {
        "head": None,
        "fovea": None,
        "tip": 9,
        "fovea_2": 11,
        "tip_2": 12,
        "neck": 13,
    }


def test_only_pairs_wait_for_a_position():
    passenger = Landmark("p", (1, 2, 3), role=Role.PASSENGER)
    off = Landmark("off", (1, 2, 3), enabled=False)
    session = Session(landmarks=(passenger, off, Landmark("both", (1, 2, 3), (1, 2, 3))))
    assert awaiting(session, DESTINATION) == ("off",)
    assert awaiting(session, SOURCE) == ()


@pytest.mark.parametrize(
    ("there", "arriving", "expected"),
    [
        (["a", "b"], ["b", "x"], BY_NAME),
        (["a", "b"], ["x", "y"], BY_ORDER),
        (["a", "b"], ["x", "y", "z"], BY_NAME),
        # Numbers that a reader gave out are no names.
        (["a", "b"], ["landmark_0", "landmark_1", "landmark_2"], BY_ORDER),
        ([], ["x"], BY_NAME),
    ],
)
def test_names_come_first_then_the_order(there, arriving, expected):
    session = Session(landmarks=placed(there))
    assert default_pairing(session, file(placed(arriving, DESTINATION))) is expected


def test_a_file_whose_landmarks_are_all_there_goes_by_name_though_others_wait_for_nothing():
    session = Session(landmarks=(Landmark("a", (1, 0, 0), (2, 0, 0)),))
    arriving = file(placed(["a"], DESTINATION, shift=5))
    assert default_pairing(session, arriving) is BY_NAME
    assert not can_pair(session, arriving, BY_ORDER)


def test_pairs_have_no_order_to_go_by():
    session = Session(landmarks=placed("ab"))
    arriving = file([Landmark("x", (1, 1, 1), (2, 2, 2)), Landmark("y")], None)
    assert default_pairing(session, arriving) is BY_NAME
    assert not can_pair(session, arriving, BY_ORDER)
    assert can_pair(session, arriving, AS_NEW)


def test_pairs_say_which_positions_they_replace():
    session = Session(
        landmarks=(
            Landmark("both", (1, 0, 0), (2, 0, 0)),
            Landmark("one", (1, 0, 0), (2, 0, 0), locked=True),
            Landmark("half", (1, 0, 0)),
            Landmark("same", (1, 0, 0), (2, 0, 0)),
        )
    )
    arriving = file(
        [
            Landmark("both", (5, 0, 0), (6, 0, 0)),
            Landmark("one", (1, 0, 0), (6, 0, 0)),
            Landmark("half", (1, 0, 0), (6, 0, 0)),
            Landmark("same", (1, 0, 0), None),
        ],
        None,
    )
    assert words(session, arriving, BY_NAME) == [
        "replaces both positions of both",
        "replaces the destination position of one, which is locked",
        "pairs with half",
        "changes nothing of same",
    ]


def test_positions_are_read_as_chosen_and_only_on_their_side():
    arriving = file([Landmark("x", (1, 2, 3), (4, 5, 6))], None)
    choice = ImportChoice(BY_NAME, {DESTINATION: Fit(True, 1000.0)})
    (landmark,) = imported(Session(), arriving, choice).landmarks
    assert landmark.source == (1, 2, 3)
    assert landmark.destination == (-4000, -5000, 6000)
    (arrival,) = arrivals(Session(), arriving, choice)
    assert arrival.landmark == landmark


def test_who_goes_on_waiting_is_known():
    session = Session(landmarks=placed("abc"))
    arriving = file(placed("ax", DESTINATION))
    found = arrivals(session, arriving, ImportChoice(BY_NAME))
    assert left_waiting(session, arriving, found) == ("b", "c")
    # Where nothing pairs up, that others wait is no news.
    found = arrivals(session, arriving, ImportChoice(AS_NEW))
    assert left_waiting(session, arriving, found) == ()


# What needs no question


def test_all_matching_or_all_new_on_an_empty_side_is_plain():
    assert is_plain(Session(), file(placed("ab", SOURCE), SOURCE))
    assert is_plain(Session(landmarks=placed("ab")), file(placed("ba", DESTINATION)))
    # Fewer than wait: the others are placed later.
    assert is_plain(Session(landmarks=placed("abc")), file(placed("ba", DESTINATION)))


@pytest.mark.parametrize(
    "arriving",
    [
        file(placed("ax", DESTINATION)),
        file(placed("xy", DESTINATION)),
        file(placed("ab", SOURCE, shift=7), SOURCE),
        file(placed("ab", DESTINATION), skipped=(SkippedLine(1, "b", "bad"),)),
        file(placed("ab", DESTINATION), notes=("2 lists: the first was read.",)),
        replace(
            file(placed("ab", DESTINATION)),
            fits={DESTINATION: (Fit(distance=9.0), Fit(True, distance=0.1))},
        ),
    ],
    ids=["one new", "other names", "replaced", "skipped", "noted", "doubtful"],
)
def test_anything_else_is_asked(arriving):
    assert not is_plain(Session(landmarks=placed("ab")), arriving)


# Whatever comes


few_names = st.sampled_from(["a", "b", "a_2", "landmark_0", "landmark_1", "landmark_7"])
places = st.none() | st.tuples(*[st.integers(-3, 3).map(float)] * 3)
sets = st.lists(
    st.builds(Landmark, few_names, places, places), max_size=5, unique_by=lambda x: x.name
).map(tuple)


@given(
    sets, sets.filter(bool), st.sampled_from([SOURCE, DESTINATION, None]), st.sampled_from(Pairing)
)
def test_the_preview_and_the_import_agree(there, coming, side, pairing):
    session = Session(landmarks=there)
    if side is not None:
        coming = tuple(x.placed(side.other, None) for x in coming)
    arriving = file(coming, side)
    choice = ImportChoice(pairing)
    after = imported(session, arriving, choice)
    found = arrivals(session, arriving, choice)
    names = [x.name for x in after.landmarks]
    assert len(set(names)) == len(names)
    # What was there stays in its place; what is new follows in the order of the file.
    assert names == [x.name for x in there] + [x.target for x in found if x.fate is Fate.NEW]
    for arrival in found:
        before, then = session.landmark(arrival.target), after.landmark(arrival.target)
        changed = [s for s in Side if before is not None and before.position(s) != then.position(s)]
        match arrival.fate:
            case Fate.LEFT_OUT:
                assert pairing is ONLY_KNOWN
                assert before is then is None
                continue
            case Fate.NEW:
                assert before is None
            case Fate.SAME:
                assert then == before
            case Fate.REPLACES:
                assert any(before.position(s) is not None for s in changed)
            case Fate.PAIRS:
                assert then.is_complete
                assert all(before.position(s) is None for s in changed)
            case Fate.PLACES:
                assert all(before.position(s) is None for s in changed)
                assert changed
        for s in arriving.sides:
            if arrival.landmark.position(s) is not None:
                assert then.position(s) == arrival.landmark.position(s)
    if pairing is AS_NEW:
        assert after.landmarks[: len(there)] == there
    untouched = {x.name for x in there} - {x.target for x in found}
    assert all(after.landmark(name) == session.landmark(name) for name in untouched)


@given(st.lists(few_names), st.lists(few_names))
def test_free_names_are_free_and_different(names, taken):
    found = free_names(names, taken)
    assert len({*found, *taken}) == len(found) + len(set(taken))
    assert len(found) == len(names)
    assert all(
        a == b
        for a, b in zip(found, names, strict=True)
        if b not in taken and names.count(b) == 1 and b not in found[: names.index(b)]
    )


def test_many_taken_names_are_counted_past_quickly():
    names = [f"landmark_{i}" for i in range(20_000)]
    assert free_names(names, names) == [f"landmark_{i}" for i in range(20_000, 40_000)]


def test_a_name_that_only_looks_like_one_of_the_session_is_told_and_asked_about():
    session = Session(landmarks=(Landmark("fovea", (1, 2, 3), (4, 5, 6)),))
    arriving = file([Landmark("fovea\u200b", None, (7, 8, 9))])
    assert words(session, arriving, Pairing.BY_NAME) == ["new, though it looks like fovea"]
    assert not is_plain(session, arriving)
    fresh = Session(landmarks=session.landmarks[:0])
    assert is_plain(fresh, file([Landmark("head", None, (7, 8, 9))]))


def test_what_a_file_says_of_a_landmark_comes_in_with_a_new_one_only():
    here = Landmark("a", (1, 2, 3), note="mine")
    bare = Landmark("b", (4, 5, 6))
    said = {"note": "worn", "locked": True, "enabled": False, "role": Role.PASSENGER}
    arriving = file([Landmark(name, (7, 8, 9), **said) for name in "abc"], SOURCE)
    after = imported(Session(landmarks=(here, bare)), arriving, ImportChoice(BY_NAME))
    assert after.landmarks == (
        Landmark("a", (7, 8, 9), note="mine"),
        Landmark("b", (7, 8, 9), note="worn"),
        Landmark("c", (7, 8, 9), **said),
    )


def test_many_landmarks_of_which_few_lie_near_the_mesh_are_doubted():
    places = np.random.default_rng(1).uniform(500, 900, (120, 3))
    marks = [Landmark(f"p{n}", tuple(place)) for n, place in enumerate(places)]
    mesh = Mesh([[0, 0, 0], [10, 0, 0], [0, 10, 0], [0, 0, 10]], [[0, 1, 2], [0, 1, 3]])
    session = Session(source=MeshFile(Path("a.ply"), mesh, "ab", ()))
    fits = {SOURCE: fits_of(marks, SOURCE, SurfaceIndex(mesh))}
    arriving = Arriving(Path("a.csv"), LandmarkReading(tuple(marks), False, ()), SOURCE, fits)
    (doubt,) = doubts_of(session, arriving)
    assert "120 landmarks, and most of them lie farther from the source mesh" in doubt
    assert not is_plain(session, arriving)
    few = replace(arriving, reading=LandmarkReading(tuple(marks[:9]), False, ()))
    assert doubts_of(session, few) == ()


# Passengers, and what is known of nobody


def paired(count=4):
    places = [(float(i), float(i * i), 1.0) for i in range(count)]
    return Session(landmarks=tuple(Landmark(f"p{i}", x, x) for i, x in enumerate(places)))


def stations(*names, side=Side.SOURCE):
    marks = tuple(Landmark(name).placed(side, (float(i), 2.0, 3.0)) for i, name in enumerate(names))
    return Arriving(Path("stations.csv"), LandmarkReading(marks, False, ()), side)


def test_unknown_names_on_a_paired_source_are_proposed_as_passengers_and_asked_about():
    session, file = paired(), stations("glut_med", "iliopsoas")
    assert default_pairing(session, file) is Pairing.AS_PASSENGERS
    assert not is_plain(session, file)
    found = arrivals(session, file, ImportChoice(Pairing.AS_PASSENGERS))
    assert [x.words for x in found] == ["a new passenger", "a new passenger"]
    after = imported(session, file, ImportChoice(Pairing.AS_PASSENGERS))
    assert [x.name for x in after.passengers] == ["glut_med", "iliopsoas"]
    assert after.pairs == session.pairs


def test_unknown_names_on_a_paired_destination_are_asked_about_and_never_passengers():
    session, file = paired(), stations("a", "b", side=Side.DESTINATION)
    assert default_pairing(session, file) is Pairing.BY_NAME
    assert not is_plain(session, file)
    assert not can_pair(session, file, Pairing.AS_PASSENGERS)


def test_the_first_landmarks_of_a_session_come_in_without_a_question():
    assert is_plain(Session(), stations("a", "b"))
    assert default_pairing(Session(), stations("a", "b")) is Pairing.BY_NAME


def test_a_passenger_that_is_there_gets_its_place_and_a_pair_of_that_name_stays_a_pair():
    session = edits.add_passenger(paired(), (9.0, 9.0, 9.0))[0]
    name = session.passengers[0].name
    file = stations(name, "p1", "glut_med")
    after = imported(session, file, ImportChoice(Pairing.AS_PASSENGERS))
    assert after.landmark(name).source == (0.0, 2.0, 3.0)
    assert after.landmark("p1") == session.landmark("p1")
    assert len(after.passengers) == 3
    assert len({x.name for x in after.landmarks}) == len(after.landmarks)


@pytest.mark.parametrize("half", [Side.SOURCE, Side.DESTINATION])
def test_where_something_waits_nothing_is_taken_for_passengers(half):
    session = edits.remove_side(paired(), "p2", half)
    assert default_pairing(session, stations("x", "y", "z")) is not Pairing.AS_PASSENGERS
    # Nor do they join the pairs without a question.
    assert not is_plain(session, stations("x", "y", "z"))


def test_of_a_file_only_what_is_known_comes_in():
    session = Session(landmarks=(Landmark("a", (0, 0, 0), (1, 1, 1)),))
    arriving = file((Landmark("a", None, (2, 2, 2)), Landmark("b", None, (3, 3, 3))), DESTINATION)
    choice = ImportChoice(ONLY_KNOWN)
    assert can_pair(session, arriving, ONLY_KNOWN)
    found = arrivals(session, arriving, choice)
    assert [x.words for x in found] == [
        "replaces the position of a",
        "left out: none here is called so",
    ]
    assert summary(found) == "1 replaces a position (a), 1 is left out (b)."
    after = imported(session, arriving, choice)
    assert [(x.name, x.destination) for x in after.landmarks] == [("a", (2, 2, 2))]
    assert not can_pair(Session(), arriving, ONLY_KNOWN)
