"""The command, run within the test."""

from __future__ import annotations

import pytest
from tests.session.study import make_study
from typer.testing import CliRunner

from pinwarp.cli.app import make_app


class Command:
    """Runs ``pinwarp`` and remembers what the window was asked to open."""

    def __init__(self):
        self.opened = []
        self._app = make_app(self._open_window)
        self._runner = CliRunner()

    def _open_window(self, **asked):
        self.opened.append({key: value for key, value in asked.items() if value})
        return 0

    def __call__(self, *arguments, exit_code=0):
        outcome = self._runner.invoke(self._app, [str(x) for x in arguments])
        if outcome.exception is not None and not isinstance(outcome.exception, SystemExit):
            raise outcome.exception
        assert outcome.exit_code == exit_code, outcome.output
        return outcome


@pytest.fixture
def pinwarp_command():
    return Command()


@pytest.fixture
def study(tmp_path):
    """A folder with a source, a session, three subjects and their manifest."""
    make_study(tmp_path / "study", 3)
    return tmp_path / "study"
