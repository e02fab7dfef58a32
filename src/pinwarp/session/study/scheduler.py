"""The scheduler of a Dask cluster: its address, and a connection to it."""

from __future__ import annotations

import contextlib
import logging
import re
import socket
import threading
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from functools import partial
from typing import Any

from pinwarp.core.errors import PinwarpError

SCHEMES = ("tcp", "tls", "ws", "wss")
# How long a connection, an answer and the farewell may take, in seconds.
CONNECTS_WITHIN = 5.0
ANSWERS_WITHIN = 10.0
LEAVES_WITHIN = 2.0

_LABEL = r"[A-Za-z0-9_]([A-Za-z0-9_-]{0,61}[A-Za-z0-9_])?"
_HOST = re.compile(rf"{_LABEL}(\.{_LABEL})*\.?|\[[0-9A-Fa-f:.]*:[0-9A-Fa-f:.]*(%\w+)?\]")
_ADDRESS = re.compile(
    r"((?P<scheme>[^/]*)://)?(?P<host>\[[^]]*\]|[^][:/?#@]*)(:(?P<port>[0-9]{1,9})?)?/?"
)


def address_of(text: str) -> str:
    """Return the address of a scheduler, whole.

    Raises
    ------
    PinwarpError
        When it is none; nobody is asked for it.

    Examples
    --------
    >>> address_of("node7:8786"), address_of("tls://[::1]:8786")
    ('tcp://node7:8786', 'tls://[::1]:8786')
    >>> try:
    ...     address_of("http://node7")
    ... except PinwarpError as error:
    ...     print(error)
    'http://node7' is no address of a scheduler: it begins with 'http'. Write it like tcp://HOST:8786.
    """
    found = _ADDRESS.fullmatch(text)
    if found is None:
        problem = "there is more or less in it than host and port"
    elif (found["scheme"] or "tcp") not in SCHEMES:
        problem = f"it begins with {found['scheme']!r}"
    elif not _HOST.fullmatch(found["host"]):
        problem = "no host can be called so" if found["host"] else "the host is missing"
    elif not 0 < int(found["port"] or 0) < 1 << 16:
        problem = "the port is missing or no number from 1 to 65535"
    else:
        return f"{found['scheme'] or 'tcp'}://{found['host']}:{found['port']}"
    raise PinwarpError(
        f"{text!r} is no address of a scheduler: {problem}. Write it like tcp://HOST:8786."
    )


@contextlib.contextmanager
def connected(address: str) -> Iterator[Any]:
    """Give a client of the scheduler, or say in a sentence why there is none."""
    try:
        from distributed import Client
    except ImportError:
        raise PinwarpError(
            "Clusters need the package 'distributed': pip install 'pinwarp[cluster]'."
        ) from None
    host, _, port = address.partition("://")[2].rpartition(":")
    try:
        # The client would try a refused connection again and again.
        socket.create_connection((host.strip("[]"), int(port)), CONNECTS_WITHIN).close()
    except (OSError, UnicodeError) as error:
        raise PinwarpError(
            f"No Dask scheduler answers at {address}: {reason_of(error)}. "
            "Is the address right, and was 'dask scheduler' started there?"
        ) from error
    with _quiet_log(), contextlib.ExitStack() as leaving:
        try:
            with warnings.catch_warnings():
                # Whether the workers have the same pinwarp is asked; the rest seldom matters.
                warnings.simplefilter("ignore")
                make = partial(Client, address, timeout=ANSWERS_WITHIN, set_as_default=False)
                client = _within(ANSWERS_WITHIN, make)
        except Exception as error:  # whatever it was, a program that is no scheduler made it
            raise PinwarpError(
                f"What answers at {address} is no Dask scheduler that can be used: "
                f"{reason_of(error)}. Is the port that of the scheduler, not of its web page?"
            ) from error
        # The scheduler forgets what nobody waits for any more.
        leaving.callback(_leave, client)
        yield client


def _leave(client: Any) -> None:
    with contextlib.suppress(Exception):  # nothing is left to lose
        client.close(timeout=LEAVES_WITHIN)


def _within(seconds: float, make: Callable[[], Any]) -> Any:
    """Return what is made, or raise: a client waits for ever for one who takes calls in silence."""
    future: Future[Any] = Future()

    def run() -> None:
        try:
            future.set_result(make())
        except Exception as error:  # it is raised where the result is wanted
            future.set_exception(error)

    threading.Thread(target=run, daemon=True).start()
    try:
        return future.result(seconds)
    except TimeoutError:
        raise TimeoutError(f"nothing was said within {seconds:g} s") from None


@contextlib.contextmanager
def _quiet_log() -> Iterator[None]:
    """Keep off the screen what the cluster's own library logs: what matters is told."""
    names = [x for x in logging.root.manager.loggerDict if x.startswith(("distributed", "tornado"))]
    logs = [log for log in map(logging.getLogger, names) if log.handlers]
    before = [(log.handlers, log.propagate) for log in logs]
    for log in logs:
        log.handlers, log.propagate = [logging.NullHandler()], False
    try:
        yield
    finally:
        for log, (handlers, propagate) in zip(logs, before, strict=True):
            log.handlers, log.propagate = handlers, propagate


def reason_of(error: Exception) -> str:
    """Return the first line of what an error says, without a full stop.

    Examples
    --------
    >>> reason_of(ConnectionRefusedError(111, "Connection refused")), reason_of(KeyError())
    ('Connection refused', 'KeyError')
    """
    words = (error.strerror if isinstance(error, OSError) else None) or str(error)
    return words.strip().split("\n")[0].rstrip(".") or type(error).__name__
