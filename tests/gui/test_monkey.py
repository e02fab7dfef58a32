"""Random mouse, wheel and key events at the window: nothing breaks, nothing is lost or kept.

PINWARP_MONKEY=20000 pytest -s tests/gui/test_monkey.py    many more events
PINWARP_MONKEY_SEED=7 pytest tests/gui/test_monkey.py      the events of a failed run again
"""

from __future__ import annotations

import os

import pytest
from tests.gui.conftest import open_window
from tests.gui.monkey.monkey import Monkey

from pinwarp.core.landmarks import Side

LONG = int(os.environ.get("PINWARP_MONKEY", "0"))
SEED = os.environ.get("PINWARP_MONKEY_SEED")
EACH = LONG // 2 or 300
SEEDS = [int(SEED)] if SEED else [1] if LONG else [1, 2, 3, 4]


@pytest.fixture
def play(nothing_leaks, qtbot, tmp_path, state_folder):
    """Let the monkey at a window on which something is opened."""
    monkeys = []

    def play(begin, seed: int) -> Monkey:
        def open_one():
            # The real dialogs: the monkey answers them.
            window = open_window(None, tmp_path, state_folder)
            # Small: every pixel is drawn by the processor here.
            window.resize(620, 460)
            begin(window)
            qtbot.waitUntil(lambda: window.is_settled, timeout=180_000)
            # What was opened step by step is where the monkey begins.
            window.editor.replace_all(window.editor.committed, None)
            return window

        monkeys.append(Monkey(open_one, state_folder, tmp_path / "monkey", seed))
        monkeys[0].play(EACH)
        return monkeys[0]

    yield play
    for monkey in monkeys:
        monkey.window.editor.replace_all(monkey.window.editor.committed, None)
        monkey.window.close()
        monkey.window.deleteLater()
    monkeys.clear()


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_breaks_on_the_sample_whatever_a_monkey_does(play, seed):
    play(lambda window: window.open_sample(), seed)


@pytest.mark.parametrize("seed", [int(SEED)] if SEED else [5])
def test_nothing_breaks_on_the_real_femur_whatever_a_monkey_does(play, shared_data, seed):
    folder = shared_data / "opensim-creator-femur"

    def begin(window):
        for side, name in ((Side.SOURCE, "femur_r"), (Side.DESTINATION, "subject_femur_r")):
            window.parts.documents.open_mesh(side, folder / f"{name}.obj")
        for side, name in ((Side.SOURCE, "femur_r"), (Side.DESTINATION, "subject_femur_r")):
            window.parts.imports.bring_in(folder / f"{name}.landmarks.csv", side, asking=False)

    play(begin, seed)
