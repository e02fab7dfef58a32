"""Landmarks of every kind, for round trips."""

from __future__ import annotations

from hypothesis import strategies as st

from pinwarp.core.landmarks import Landmark, Role

coordinates = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False),
    st.sampled_from([-0.0, 5e-324, 2.2250738585072014e-308, 1e308, -1.7976931348623157e308, 0.1]),
)
positions = st.none() | st.tuples(coordinates, coordinates, coordinates)

_AWKWARD = st.sampled_from(
    ["=1+1", "'=1+1", "''@x", "-5", "+a", "@b", "'", "#1", '"', 'a"b', "a,b", "a;b", "1", "1,2,3"]
)
_LETTERS = st.characters(exclude_categories=["Cs", "Cc", "Zl", "Zp"])
_ANY = st.characters(exclude_categories=["Cs"])

trimmed_names = (st.text(_LETTERS, min_size=1).map(str.strip) | _AWKWARD).filter(bool)
names = (st.text(_ANY, min_size=1) | _AWKWARD).filter(str.strip)
texts = st.text(_ANY) | _AWKWARD | st.sampled_from(["two\nlines", "a\r\nb", "\tx", ' "q" '])


def landmarks(name: st.SearchStrategy[str]) -> st.SearchStrategy[Landmark]:
    """Landmarks whose names come from a strategy."""
    return st.builds(
        Landmark,
        name=name,
        source=positions,
        destination=positions,
        role=st.sampled_from(Role),
        enabled=st.booleans(),
        note=texts,
        locked=st.booleans(),
    )


def landmark_lists(name: st.SearchStrategy[str]) -> st.SearchStrategy[list[Landmark]]:
    """Lists of landmarks with different names."""
    return st.lists(landmarks(name), max_size=6, unique_by=lambda landmark: landmark.name)
