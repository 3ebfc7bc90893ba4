"""Garbage collection in a process that checks programs and ends."""

from __future__ import annotations

import atexit
import contextlib
import gc
import os
import sys

_ALIVE = 200_000
"""New objects before a collection. A long program has a million."""


def seldom_look_for_garbage() -> None:
    """Collect cycles seldom, and not at exit.

    Trees and steps are no garbage and have no cycles, but were scanned repeatedly while they grew. At exit
    Python scans all objects once more, which takes a twentieth of the time for 10,000 lines.
    """
    gc.set_threshold(_ALIVE, 20, 20)
    atexit.unregister(gc.freeze)  # only once for all files
    atexit.register(gc.freeze)


def end_quietly() -> None:
    """Hide the messages of OMPL's bindings about their own memory after the interpreter has ended: thirty
    lines that no user can act on.
    """
    atexit.unregister(_close_errors)
    atexit.register(_close_errors)


def _close_errors() -> None:
    if "ompl" not in sys.modules:
        return
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):  # closed, or not read any more
            stream.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
