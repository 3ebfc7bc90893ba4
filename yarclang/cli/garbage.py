"""What becomes of garbage in a process that checks programs and ends."""

from __future__ import annotations

import atexit
import contextlib
import gc
import os
import sys

_ALIVE = 200_000
"""So many more objects may come before they are looked through: a long program has a million."""


def seldom_look_for_garbage() -> None:
    """Look through objects for cycles seldom, and not at the end.

    Trees and steps are no garbage, have no cycles, and were looked through again and again while they grew. At its end Python looks
    through all of them once more, for nothing: a twentieth of the time of 10,000 lines.
    """
    gc.set_threshold(_ALIVE, 20, 20)
    atexit.unregister(gc.freeze)  # once, however many files there are
    atexit.register(gc.freeze)


def end_quietly() -> None:
    """Hide what OMPL's bindings write about their own memory after the interpreter has ended: thirty lines about nothing that anybody could do."""
    atexit.unregister(_close_errors)
    atexit.register(_close_errors)


def _close_errors() -> None:
    if "ompl" not in sys.modules:
        return
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):  # closed, or nobody reads it any more
            stream.flush()
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
