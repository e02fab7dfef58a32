"""Random mouse, wheel and key events at the window: nothing breaks, nothing is lost or kept.

PINWARP_MONKEY=20000 pytest -s tests/gui/test_monkey.py    many more events
PINWARP_MONKEY_SEED=7 pytest tests/gui/test_monkey.py      the events of a failed run again
"""

from __future__ import annotations

import os
import shutil
from dataclasses import replace

import pytest
from tests.gui.conftest import open_window
from tests.gui.monkey.memory import Held, grown
from tests.gui.monkey.monkey import Broken, Monkey

from pinwarp.core.landmarks import Side

LONG = int(os.environ.get("PINWARP_MONKEY", "0"))
SEED = os.environ.get("PINWARP_MONKEY_SEED")
EACH = LONG // 2 or 300
SEEDS = [int(SEED)] if SEED else [1] if LONG else [1, 2, 3, 4]


@pytest.fixture
def monkey(nothing_leaks, qtbot, tmp_path, state_folder):
    """Put a monkey at a window on which something is opened."""
    monkeys = []

    def monkey(begin, seed: int) -> Monkey:
        def open_one():
            # The real dialogs: the monkey answers them.
            window = open_window(None, tmp_path, state_folder)
            # Small: every pixel is drawn by the processor here.
            window.resize(620, 460)
            return window

        monkeys.append(Monkey(open_one, begin, state_folder, tmp_path / "monkey", seed))
        return monkeys[0]

    yield monkey
    for each in monkeys:
        each.window.editor.replace_all(each.window.editor.committed, None)
        each.window.close()
        each.window.deleteLater()
    monkeys.clear()


def open_sample(window):
    window.parts.documents.open_sample()


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_breaks_on_the_sample_whatever_a_monkey_does(monkey, seed):
    monkey(open_sample, seed).play(EACH)


@pytest.mark.parametrize("seed", [int(SEED)] if SEED else [5])
def test_nothing_breaks_on_the_real_femur_whatever_a_monkey_does(
    monkey, shared_data, tmp_path, seed
):
    # What is typed into a save dialog lands beside the meshes: they are not everybody's.
    folder = shutil.copytree(shared_data / "opensim-creator-femur", tmp_path / "femur")

    def begin(window):
        for side, name in ((Side.SOURCE, "femur_r"), (Side.DESTINATION, "subject_femur_r")):
            window.parts.documents.open_mesh(side, folder / f"{name}.obj")
        for side, name in ((Side.SOURCE, "femur_r"), (Side.DESTINATION, "subject_femur_r")):
            window.parts.imports.bring_in(folder / f"{name}.landmarks.csv", side, asking=False)

    monkey(begin, seed).play(EACH)


def test_a_mesh_that_is_kept_of_every_session_is_told_by_the_monkey(monkey):
    one, kept = monkey(open_sample, 1), []

    def keep(session):
        kept.append(session.mesh(Side.SOURCE))

    one.window.editor.session_changed.connect(keep)
    with pytest.raises(Broken, match="grew: meshes from 2 to 3, surfaces from 2 to 3"):
        one.play(1)


def test_memory_that_grows_by_a_tenth_after_the_first_thousand_events_is_told():
    held = [
        Held(events, 0, megabytes, meshes=4, surfaces=2, finders=0)
        for events, megabytes in ((0, 500), (1100, 800), (2150, 870), (3200, 879))
    ]
    assert grown(held) == ""
    assert grown([*held, replace(held[0], events=4000, megabytes=881)]) == (
        "memory from 800 to 881 MB"
    )
    # Another window is compared with itself, and with all others in what it holds.
    anew = replace(held[0], events=4000, opened_at=2500, megabytes=950)
    assert grown([*held, anew]) == ""
    assert grown([*held, anew, replace(anew, events=5000, megabytes=1050, meshes=5)]) == (
        "meshes from 4 to 5, memory from 950 to 1050 MB"
    )
