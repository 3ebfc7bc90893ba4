"""How often Python looks for garbage, in a process that checks programs and ends."""

from __future__ import annotations

import atexit
import gc

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
