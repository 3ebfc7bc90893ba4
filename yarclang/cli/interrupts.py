"""Ctrl-C at a moment in which Python discards exceptions.

An exception in a destructor or in a callback of a weak reference is printed and then ignored. Imports have
many such callbacks. If a KeyboardInterrupt were lost in one, the robot would move after a Ctrl-C.
"""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

_LATER = 0.01
"""Time after which an interrupt is repeated [s]; by then, the destructor or callback has usually ended. If it
hasn't, the interrupt is discarded and repeated again.
"""


def repeat_lost_interrupts() -> None:
    """Interrupt the main thread again, a moment later, whenever Python discards a KeyboardInterrupt.

    Windows has no signals to threads; there, no command moves a robot.
    """
    if hasattr(signal, "pthread_kill") and sys.unraisablehook is sys.__unraisablehook__:
        sys.unraisablehook = _hook


def _hook(discarded: UnraisableHookArgs) -> None:
    if issubclass(discarded.exc_type, KeyboardInterrupt):
        _thread.start_new_thread(_repeat, ())
    else:
        sys.__unraisablehook__(discarded)


def _repeat() -> None:
    time.sleep(_LATER)
    main = threading.main_thread().ident
    assert main is not None  # it has started
    signal.pthread_kill(main, signal.SIGINT)
