"""Signals that end a command which serves other clients."""

from __future__ import annotations

import asyncio
import signal
from collections.abc import Iterator
from contextlib import contextmanager

_ENDING = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP)


@contextmanager
def terminations() -> Iterator[asyncio.Event]:
    """Yield an event that a termination sets."""
    ends = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in _ENDING:
        loop.add_signal_handler(number, ends.set)
    try:
        yield ends
    finally:
        for number in _ENDING:
            loop.remove_signal_handler(number)
