"""User stories: a session that was refined to the surface, opened in the window."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pinwarp.core.landmarks import Side
from pinwarp.session import edits
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.outputs.exports import warped_mesh
from pinwarp.session.warp.refining import RefinementOptions, refined_session

SOURCE, DESTINATION = Side.SOURCE, Side.DESTINATION


def overlay_misses(user, session) -> float:
    """How far what is drawn over the destination lies from the warp that a session exports."""
    drawn = user.window.viewports[DESTINATION].overlay_points
    return float(np.abs(drawn - warped_mesh(session).vertices).max())


def test_a_refined_session_is_shown_edited_undone_and_saved_without_loss(user, sample_copy):
    refined, _ = refined_session(read_session(sample_copy), RefinementOptions(40.0))
    plain = replace(refined, refinement=None)
    write_session(sample_copy, refined)
    user.dialogs.opens.append(sample_copy)
    user.trigger("open_session")
    assert user.session.refinement == refined.refinement

    # The landmarks are the sixteen that somebody placed; the rest is told in a sentence.
    for side in Side:
        assert len(user.window.viewports[side].layer.markers) == len(refined.landmarks)
    fitted = len(refined.refinement.source) - len(refined.pairs)
    note = user.window.parts.refining.note.label
    assert note.isVisible()
    assert note.text() == f"Refined to the surface by {fitted} fitted pairs"
    assert overlay_misses(user, refined) < 0.01 < overlay_misses(user, plain)

    user.drag_a_landmark()
    assert user.session.pairs != refined.pairs
    assert "out of date" in note.text()
    assert "Refine again" in user.window.parts.refining.note.toolTip()
    assert user.session.refinement == refined.refinement
    assert overlay_misses(user, replace(user.session, refinement=None)) < 0.01

    user.trigger("undo")
    assert note.text().startswith("Refined to the surface")
    assert overlay_misses(user, refined) < 0.01

    # What the refinement does not depend on leaves it in use, also in the file.
    name = refined.pairs[0].name
    user.editor.commit(edits.rename(user.session, name, "first"), "Rename")
    user.settle()
    user.trigger("save")
    kept = read_session(sample_copy)
    assert kept.landmark("first") is not None
    assert kept.refinement == refined.refinement
    np.testing.assert_array_equal(warped_mesh(kept).vertices, warped_mesh(refined).vertices)
