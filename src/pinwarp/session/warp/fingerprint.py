"""Hashes of what a refinement or a rest follows from, by which a file tells whether it is stale."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import replace

from pinwarp.core.groups import Group, Patch, renamed_anchors
from pinwarp.core.landmarks import Side
from pinwarp.session.session import Session


def fingerprint(parts: tuple[object, ...]) -> str:
    """Return a hash of values that are written out the same each time.

    Examples
    --------
    >>> fingerprint((1.0, "a"))
    'sha256:2036feb4040c20a3ce0c3e116bfc20d8'
    """
    return f"sha256:{hashlib.sha256(repr(parts).encode()).hexdigest()[:32]}"


def mesh_parts(session: Session) -> tuple[object, ...]:
    """Return what tells the meshes of a session from others."""
    meshes = (session.mesh_file(side) for side in Side)
    return tuple(None if x is None else (x.sha256, x.mirrored, float(x.scaled)) for x in meshes)


def group_parts(session: Session, groups: Iterable[Group]) -> Iterator[tuple[object, ...]]:
    """Return what the points of groups follow from: no name, of theirs or of a landmark, does."""
    rows = {pair.name: str(row) for row, pair in enumerate(session.pairs)}
    # One that takes no part is still where a curve is divided.
    anchors = {landmark.name: rows.get(landmark.name, "-") for landmark in session.landmarks}
    for group in groups:
        bare = replace(renamed_anchors(group, anchors), name="-", excluded=frozenset())
        if isinstance(bare, Patch):
            # Its points are there: what they were spread inside says no more.
            bare = replace(bare, around="", inside=None)
        # Sets have no order of their own.
        yield bare, sorted(group.excluded)
