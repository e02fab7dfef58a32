"""No setting of a warp is forgotten by what depends on it: every one is looked at, new ones too."""

from __future__ import annotations

import dataclasses
import json
from dataclasses import replace
from datetime import datetime

import numpy as np
import pytest

from pinwarp.core.basis import Basis
from pinwarp.core.components import Components
from pinwarp.core.errors import PinwarpError
from pinwarp.core.landmarks import Landmark, Side, as_position
from pinwarp.core.mesh import Mesh
from pinwarp.core.settings import USUAL_SETTINGS, WarpSettings
from pinwarp.core.spline import PenaltyConvention
from pinwarp.io.coefficients import read_coefficients, write_coefficients
from pinwarp.io.manifest import Subject
from pinwarp.io.meshes import read_mesh, write_mesh
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.judging.report import report_of
from pinwarp.session.keeping.files import read_session, write_session
from pinwarp.session.outputs.exports import session_coefficients, warped_mesh
from pinwarp.session.outputs.script import script_of
from pinwarp.session.session import Session
from pinwarp.session.study.subject import Task, made_from
from pinwarp.session.warp.result import WarpInputs
from pinwarp.session.warp.setting_words import settings_in_words
from pinwarp.session.warp.solved import solved
from pinwarp.session.warp.solver import WarpSolver

FIELDS = [field.name for field in dataclasses.fields(WarpSettings)]
OTHERS = {
    "penalty": 0.3,
    "convention": PenaltyConvention.OPYNSIM,
    "components": Components.AFFINE,
    "blend": 0.25,
    "planar": True,
    "basis": Basis.R2_LOG_R,
}
# Penalty so that the convention matters, and landmarks near one plane so that planar does.
BASE = WarpSettings(penalty=0.05)
each = pytest.mark.parametrize("name", FIELDS)


def other(name: str, base: WarpSettings = BASE) -> WarpSettings:
    """Settings that differ from the base in one field."""
    return replace(base, **{name: OTHERS[name]})


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> Session:
    folder = tmp_path_factory.mktemp("bones")
    rng = np.random.default_rng(4)
    source = rng.normal(size=(9, 3)) * [10, 10, 1e-3]
    destination = source + rng.normal(size=(9, 3)) * 0.3
    landmarks = tuple(
        Landmark(f"p{i}", as_position(a), as_position(b))
        for i, (a, b) in enumerate(zip(source, destination, strict=True))
    )
    mesh = Mesh(rng.normal(size=(90, 3)) * [10, 10, 0.1], np.arange(90).reshape(-1, 3))
    path = folder / "bone.ply"
    write_mesh(path, mesh)
    return Session(read_mesh(path), None, landmarks, BASE)


def given(session: Session, settings: WarpSettings) -> Session:
    return replace(session, settings=settings)


def test_every_setting_is_looked_at_here():
    """A new setting needs another value in OTHERS: then all that follows looks at it, too."""
    assert set(OTHERS) == set(FIELDS)
    for name in FIELDS:
        assert OTHERS[name] not in (getattr(BASE, name), getattr(USUAL_SETTINGS, name))


@each
def test_another_setting_is_another_warp(session, name):
    changed = given(session, other(name))
    assert WarpInputs.of(changed) != WarpInputs.of(session)
    assert not np.allclose(
        warped_mesh(changed).vertices, warped_mesh(session).vertices, rtol=0, atol=1e-6
    )


@each
def test_a_solver_keeps_nothing_that_another_setting_spoils(session, name):
    changed = WarpInputs.of(given(session, other(name)))
    kept = WarpSolver()
    kept.solve(WarpInputs.of(session))
    for result in (kept.preview(changed), kept.solve(changed)):
        expected = WarpSolver().solve(changed)
        assert np.allclose(result.vertices, expected.vertices, rtol=0, atol=1e-3)
        assert np.allclose(result.landmarks, expected.landmarks, rtol=0, atol=1e-9)


@each
def test_a_drag_after_another_setting_previews_that_one(session, name):
    """The way that follows one landmark begins at the last state of rest, set as it was then."""
    place = as_position(np.add(session.landmarks[0].destination, 1.0))
    changed = edits.move(given(session, other(name)), "p0", Side.DESTINATION, place)
    solver = WarpSolver()
    solver.solve(WarpInputs.of(session))
    inputs = WarpInputs.of(changed)
    expected = WarpSolver().solve(inputs).vertices
    assert np.allclose(solver.preview(inputs).vertices, expected, rtol=0, atol=1e-3)


@each
def test_a_setting_comes_back_from_the_session_file(tmp_path, session, name):
    changed = given(session, other(name))
    write_session(tmp_path / "a.pinwarp.csv", changed)
    assert read_session(tmp_path / "a.pinwarp.csv").settings == changed.settings


@each
@pytest.mark.parametrize("suffix", [".json", ".npz"])
def test_a_setting_comes_back_from_the_coefficients(tmp_path, session, name, suffix):
    changed = given(session, other(name))
    path = tmp_path / f"warp{suffix}"
    write_coefficients(path, session_coefficients(changed))
    read = read_coefficients(path)
    assert read.settings == changed.settings
    spline = read.spline
    assert (spline.penalty, spline.convention, spline.basis) == (
        changed.settings.penalty,
        changed.settings.convention,
        changed.settings.basis,
    )


@each
def test_a_script_warps_with_the_setting(tmp_path, session, name):
    changed = given(session, other(name))
    code = script_of(changed, tmp_path).replace(
        "HERE = Path(__file__).resolve().parent", f"HERE = Path({str(tmp_path)!r})"
    )
    exec(compile(code, "script", "exec"), {})
    (written,) = tmp_path.glob("*_warped.ply")
    expected = warped_mesh(changed).vertices
    assert np.allclose(read_mesh(written).mesh.vertices, expected, rtol=0, atol=1e-6)


@each
def test_a_batch_does_a_subject_again_when_the_setting_changes(tmp_path, session, name):
    landmarks = tmp_path / "anna.csv"
    landmarks.write_text("name,x,y,z\np0,1,2,3\n")

    def hashed(settings: WarpSettings) -> str:
        anna = Subject("anna", 2, landmarks)
        mesh = tmp_path / "anna_warped.ply"
        return made_from(Task(anna, tmp_path / "m.csv", given(session, settings), mesh, None))

    assert hashed(BASE) == hashed(replace(BASE))
    assert hashed(other(name)) != hashed(BASE)


@each
def test_a_report_tells_the_setting(session, name):
    def facts(settings: WarpSettings) -> tuple[tuple[str, str], ...]:
        warp = solved(given(session, settings))
        return report_of("femur", warp, datetime(2026, 11, 22)).facts

    told = settings_in_words(other(name), "mm")
    assert told != settings_in_words(BASE, "mm")
    assert set(told) <= set(facts(other(name)))


@each
def test_undo_takes_the_setting_back(session, name):
    editor = Editor(session)
    change = getattr(edits, f"set_{name}")
    editor.commit(change(editor.session, OTHERS[name]), "Change")
    expected = other(name)
    if name == "basis":
        # The penalty is another figure there.
        expected = replace(expected, penalty=editor.session.settings.penalty)
    assert editor.session.settings == expected
    assert editor.is_dirty
    editor.undo()
    assert editor.session.settings == BASE


@pytest.mark.parametrize(
    "wrong", [{"penalty": -1}, {"penalty": float("nan")}, {"blend": -0.1}, {"blend": 1.1}]
)
def test_no_settings_can_be_made_that_mean_nothing(wrong):
    with pytest.raises(PinwarpError, match="must be"):
        WarpSettings(**wrong)


def test_damaged_settings_in_coefficients_are_told_with_the_file(tmp_path, session):
    path = tmp_path / "warp.json"
    write_coefficients(path, session_coefficients(session))
    fields = json.loads(path.read_text())
    for key, value in (("blend", 7), ("warping_penalty", -1), ("components", "elastic")):
        path.write_text(json.dumps(fields | {key: value}))
        with pytest.raises(PinwarpError, match=r"warp\.json"):
            read_coefficients(path)


def test_equal_settings_hash_alike_however_their_numbers_were_given():
    assert repr(WarpSettings(np.float64(2), blend=1)) == repr(WarpSettings(2.0))
