from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from pinwarp.core import kernel


@pytest.fixture
def spline():
    rng = np.random.default_rng(3)
    source = rng.normal(size=(300, 3)) * 100 + 5000
    weights = rng.normal(size=(300, 3)) * 0.01
    affine = np.vstack([[10, 20, 30], np.eye(3) + 0.1 * rng.normal(size=(3, 3))])
    points = rng.normal(size=(3001, 3)) * 120 + 5000
    return source, weights, affine, points


def by_definition(source, weights, affine, points):
    distances = np.linalg.norm(points[:, None] - source[None], axis=2)
    return affine[0] + points @ affine[1:] + distances @ weights


def test_the_compiled_path_is_taken_where_it_pays(spline):
    assert kernel.compiled() is not None
    assert len(spline[0]) * len(spline[3]) >= kernel.WORTH_COMPILING


def test_the_compiled_and_the_numpy_path_agree(spline, monkeypatch):
    compiled = kernel.evaluate(*spline)
    monkeypatch.setattr(kernel, "compiled", lambda: None)
    plain = kernel.evaluate(*spline)
    assert np.abs(compiled - by_definition(*spline)).max() < 1e-8
    assert np.abs(plain - by_definition(*spline)).max() < 1e-8


def test_the_preview_is_good_to_a_few_millionths_of_the_bounding_box(spline):
    source, weights, affine, points = spline
    centre = source.mean(axis=0)
    local = affine.copy()
    local[0] += centre @ affine[1:]
    preview = kernel.evaluate_preview(
        source - centre, weights, local, (points - centre).astype(np.float32)
    )
    exact = by_definition(*spline)
    box = np.linalg.norm(np.ptp(exact, axis=0))
    assert preview.dtype == np.float32
    assert np.abs(preview - exact).max() < 1e-5 * box


def test_the_numpy_preview_agrees_with_the_compiled_one(spline, monkeypatch):
    source, weights, affine, points = spline
    compact = (source - 5000, weights, affine, (points - 5000).astype(np.float32))
    compiled = kernel.evaluate_preview(*compact)
    monkeypatch.setattr(kernel, "compiled", lambda: None)
    assert np.abs(kernel.evaluate_preview(*compact) - compiled).max() < 1e-2


def test_no_points_and_no_landmarks_are_fine():
    affine = np.vstack([[1, 2, 3], np.eye(3)])
    none = np.zeros((0, 3))
    assert kernel.evaluate(none, none, affine, [[0, 0, 0]]).tolist() == [[1, 2, 3]]
    assert kernel.evaluate(none, none, affine, none).shape == (0, 3)


def test_without_a_compiler_it_says_so_and_goes_on(monkeypatch, caplog, spline):
    kernel.compiled.cache_clear()
    monkeypatch.setitem(sys.modules, "pinwarp.core.compiled", None)
    monkeypatch.delattr("pinwarp.core.compiled", raising=False)
    try:
        assert np.abs(kernel.evaluate(*spline) - by_definition(*spline)).max() < 1e-8
        assert "without compiled code" in caplog.text
    finally:
        kernel.compiled.cache_clear()


def test_a_package_folder_for_reading_only_sends_the_cache_elsewhere():
    code = (
        "import os\n"
        "from pinwarp.core import kernel\n"
        "kernel._is_writable = lambda folder: False\n"
        "assert kernel.compiled() is not None\n"
        "folder = os.environ['NUMBA_CACHE_DIR']\n"
        "assert os.stat(folder).st_mode & 0o777 == 0o700 and os.listdir(folder)\n"
    )
    environment = {k: v for k, v in os.environ.items() if k != "NUMBA_CACHE_DIR"}
    subprocess.run([sys.executable, "-c", code], check=True, env=environment, timeout=120)
