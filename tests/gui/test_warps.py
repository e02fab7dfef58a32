"""The warp on the screen, with a worker whose answers come when the test says so."""

from __future__ import annotations

import numpy as np
import pytest
from qtpy.QtCore import QObject, Signal

from pinwarp.core.landmarks import Landmark, Side
from pinwarp.core.mesh import Mesh
from pinwarp.gui.drawn.surfaces import Surfaces
from pinwarp.gui.scene.drawables import Motion, Overlay
from pinwarp.gui.warp.warps import Warps
from pinwarp.io.meshes import MeshFile
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.session import Session
from pinwarp.session.warp.result import WarpInputs


class ByHand(QObject):
    """A worker that computes a request when it is told to, in any order."""

    computed = Signal(object)
    failed = Signal(object)

    def __init__(self, function):
        super().__init__()
        self._function = function
        self.requests = []

    def request(self, request):
        self.requests.append(request)

    request_if_idle = request

    def answer(self, request=None):
        """Answer a request, without one the oldest."""
        self.computed.emit(self._function(request or self.requests.pop(0)))

    def shut_down(self):
        self.requests.clear()


class Counted:
    """Scenes that nobody looks at."""

    def renew(self, *_changed):
        pass


@pytest.fixture
def editor(tmp_path):
    """A tetrahedron, and eight pairs that bend it."""
    corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    mesh = Mesh(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    places = np.random.default_rng(0).normal(size=(8, 3))
    pairs = tuple(
        Landmark(f"p{i}", tuple(a), tuple(a + 0.1 * np.sin(3 * a)))
        for i, a in enumerate(places.tolist())
        for a in [np.array(a)]
    )
    return Editor(Session(MeshFile(tmp_path / "a.ply", mesh, "", ()), landmarks=pairs))


@pytest.fixture
def make(qapp, monkeypatch):
    """Makes the warps of an editor and their worker, which has been asked for the first."""
    made = []
    monkeypatch.setattr(
        "pinwarp.gui.warp.warps.LatestWins", lambda f: made.append(ByHand(f)) or made[-1]
    )

    def make(editor):
        warps = Warps(editor, Counted(), Surfaces(), lambda: False)
        return warps, made[-1]

    return make


def shown(warps, kind):
    """What of a kind is to be seen on the destination, if anything."""
    return next((x for x in warps.drawables(Side.DESTINATION) if isinstance(x, kind)), None)


def moved(session, by):
    (x, y, z), name = session.pairs[0].destination, session.pairs[0].name
    return edits.move(session, name, Side.DESTINATION, (x + by, y, z))


def test_a_refinement_of_a_warp_that_is_no_longer_shown_is_not_taken(make, editor, monkeypatch):
    monkeypatch.setattr("pinwarp.session.warp.solver.EAGER_MODES", 3)
    warps, worker = make(editor)
    worker.answer()
    refinement = worker.requests.pop()
    editor.commit(moved(editor.session, 0.2), "Move")
    worker.answer()
    told = []
    warps.result_changed.connect(lambda result, *_: told.append(result))
    worker.answer(refinement)
    assert told == []
    assert warps.result.inputs == WarpInputs.of(editor.session)
    # That of the warp that is shown is.
    worker.answer()
    assert told == [warps.result]
    assert warps.result.factor.has_modes


def test_the_stand_in_stays_until_the_full_mesh_of_the_last_drag_has_caught_up(make, editor):
    warps, worker = make(editor)
    worker.answer()
    assert shown(warps, Motion) is None
    editor.preview(moved(editor.committed, 0.1))
    assert shown(warps, Motion) is not None
    worker.answer()
    assert shown(warps, Motion) is not None
    editor.commit(editor.session, "Move")
    assert shown(warps, Motion) is not None, "the full mesh is still the old one"
    # The next drag begins before the last one's mesh has come.
    editor.preview(moved(editor.committed, 0.1))
    worker.answer()
    assert shown(warps, Motion) is not None
    worker.answer()
    editor.commit(editor.session, "Move")
    worker.answer()
    assert shown(warps, Motion) is None


def test_a_warp_that_mirrors_is_shaded_from_its_other_side(make, editor):
    def mirrored(landmark):
        x, y, z = landmark.destination
        return landmark.placed(Side.DESTINATION, (-x, y, z))

    warps, worker = make(editor)
    worker.answer()
    assert not shown(warps, Overlay).full.inside_out
    session = editor.session
    for pair in session.pairs:
        session = edits.move(session, pair.name, Side.DESTINATION, mirrored(pair).destination)
    editor.commit(session, "Mirror")
    worker.answer()
    assert shown(warps, Overlay).full.inside_out


def test_warps_that_are_shut_down_ask_for_nothing_more(make, editor):
    warps, worker = make(editor)
    warps.shut_down()
    editor.commit(moved(editor.session, 0.2), "Move")
    assert worker.requests == []
