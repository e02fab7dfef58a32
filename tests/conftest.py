"""What every test may ask for."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest
from hypothesis import settings

# These machines are noisy: a slow example is not a failing one.
settings.register_profile("pinwarp", deadline=None, max_examples=60)
settings.load_profile("pinwarp")

REPOSITORY = Path(__file__).resolve().parents[1]


def pytest_collection_finish() -> None:
    """Collect no garbage among modules and tests: they stay to the end."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of real bones beside the checkout."""
    folder = REPOSITORY.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"real bones are not here: {folder}")
    return folder
