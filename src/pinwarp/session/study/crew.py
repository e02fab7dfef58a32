"""The workers of a Dask cluster: who is there, who can do the work, and what is waited for."""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import pinwarp
from pinwarp.session.study.scheduler import ANSWERS_WITHIN, reason_of
from pinwarp.session.study.workers import LOOKS_UP_EVERY

_VERSION = "__import__('pinwarp').__version__"
_WAY_OUT = "Ctrl+C ends it, and what was done stays."


class Crew:
    """The workers of a cluster: who is there, and who cannot do the work."""

    def __init__(
        self,
        client: Any,
        address: str,
        stop: threading.Event,
        told: Callable[[str], None],
        patience: float,
    ) -> None:
        self.address = address
        self._client, self._stop = client, stop
        self._told, self._patience = told, patience
        self._versions: dict[str, str | Exception | None] = {}
        self._trouble, self._since, self._is_told = "", time.monotonic(), False
        self._looked = -patience
        self.threads: dict[str, int] = {}
        self.unable: dict[str, str] = {}

    @property
    def able(self) -> frozenset[str]:
        """The addresses of those who are not known to be unable."""
        return frozenset(self.threads.keys() - self.unable.keys())

    def look(self, *, ask_again: bool = False) -> None:
        """See who is there and ask who is new; tell when nobody could work for a while."""
        if not ask_again and time.monotonic() - self._looked < self._patience / 5:
            return
        threads = self._answer(self._client.nthreads)
        is_answered = isinstance(threads, dict)
        self.threads = threads if is_answered else {}
        if ask_again:
            self._versions = {k: v for k, v in self._versions.items() if v is not None}
        if new := [worker for worker in self.threads if worker not in self._versions]:
            # They need to know no name of ours to answer.
            run = partial(self._client.run, eval, _VERSION, workers=new, on_error="return")
            answers = self._answer(run)
            for worker in new:
                answer = answers.get(worker) if isinstance(answers, dict) else None
                # Who is gone again or too busy to answer may be able.
                self._versions[worker] = None if isinstance(answer, OSError) else answer
        self.unable = {
            worker: reason
            for worker in self.threads
            if (reason := why_unable(self._versions.get(worker)))
        }
        self._tell(is_answered=is_answered)
        self._looked = time.monotonic()

    def _answer(self, ask: Callable[[], Any]) -> Any:
        """Return what the scheduler answers, or an error; it may be gone, or stopped for ever."""
        try:
            return self._client.sync(self._answered, ask)
        except Exception as error:  # whatever the library makes of a connection that is going
            return error

    async def _answered(self, ask: Callable[[], Any]) -> Any:
        answer = asyncio.ensure_future(ask())
        until = time.monotonic() + ANSWERS_WITHIN
        while not answer.done():
            is_over = time.monotonic() > until or self._stop.is_set()
            if is_over or self._client.status != "running":
                answer.cancel()
                return TimeoutError()
            await asyncio.wait([answer], timeout=LOOKS_UP_EVERY)
        return answer.result()

    def _tell(self, *, is_answered: bool) -> None:
        trouble = ""
        why = " and ".join(sorted(set(self.unable.values())))
        if not is_answered:
            trouble = f"The scheduler at {self.address} does not answer. Waiting for it; {_WAY_OUT}"
        elif not self.threads:
            trouble = (
                f"No worker is connected to {self.address}. Waiting for one: "
                f"start it with 'dask worker {self.address}'; {_WAY_OUT}"
            )
        elif self.unable and not self.able:
            trouble = (
                f"The workers of {self.address} {why}. Waiting for one that can be used: "
                f"install pinwarp {pinwarp.__version__} where they run; {_WAY_OUT}"
            )
        elif self.unable:
            trouble = (
                f"{len(self.unable)} of {len(self.threads)} workers of {self.address} {why}. "
                "The others do the work."
            )
        if trouble != self._trouble:
            self._trouble, self._since, self._is_told = trouble, time.monotonic(), False
        if trouble and not self._is_told and time.monotonic() - self._since >= self._patience:
            self._told(trouble)
            self._is_told = True


def why_unable(version: str | Exception | None) -> str:
    """Return what makes a worker useless, to follow its name; nothing where it can be used.

    Parameters
    ----------
    version
        Its pinwarp's, what was raised instead, or None where it is not known.

    Examples
    --------
    >>> why_unable(pinwarp.__version__), why_unable(ImportError("No module named 'pinwarp'"))
    ('', "cannot import pinwarp: No module named 'pinwarp'")
    """
    if version is None or version == pinwarp.__version__:
        return ""
    if isinstance(version, Exception):
        return f"cannot import pinwarp: {reason_of(version)}"
    return f"have pinwarp {version}, not {pinwarp.__version__}"
