"""Garbage collection in a process that checks programs and ends."""

from __future__ import annotations

import atexit
import contextlib
import gc
import os
import sys

_ALIVE = 200_000
"""Number of new objects after which Python collects garbage. A long program creates a million objects."""


def seldom_look_for_garbage() -> None:
    """Let Python collect cyclic garbage seldom, and not at exit.

    Trees and steps have no cycles, but collections would scan them repeatedly while they grow. At exit Python
    would scan all objects once more, which takes a twentieth of the time for 10,000 lines.
    """
    gc.set_threshold(_ALIVE, 20, 20)
    atexit.unregister(gc.freeze)  # register it once, even if this function is called for each file
    atexit.register(gc.freeze)


def end_quietly() -> None:
    """Hide messages that OMPL's bindings print about their own memory after the interpreter has ended. They
    are thirty lines, and users can't do anything about them.
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
