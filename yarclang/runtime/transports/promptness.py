"""Measures that keep other work of this process or of the computer from delaying a stop."""

from __future__ import annotations

import contextlib
import ctypes
import gc
import os
import platform
import struct
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field

_SWITCH = 0.0005
"""Longest time for which a planning thread may keep the interpreter while the streaming thread waits for it
and something moves [s]. Python's default is ten times as long.
"""

_GARBAGE = (2_000, 20, 1_000)
"""Thresholds of Python's garbage collection while something moves. The first is the number of new objects
after which Python searches the first generation. The other two are the numbers of searches after which it
searches the second and the third generation.

The third generation contains all objects of a long program. Searching it takes 0.1 s, during which no thread
runs.
"""

_SLICE = 100_000
"""Length of a thread's time slice [ns], the minimum of Linux. The kernel runs a thread with short slices
sooner after it wakes up.
"""

_ATTRIBUTES = struct.Struct("IIQiIQQQII")
"""`struct sched_attr` of Linux: size, policy, flags, nice, priority, runtime, deadline, period and two bounds
of utilisation.
"""

_SET_ATTRIBUTES = {"x86_64": 314, "aarch64": 274}
"""Number of the system call `sched_setattr`, by the machine."""

_NOT_FOR_OTHERS = 1
"""SCHED_FLAG_RESET_ON_FORK: threads and processes that are started later have normal priority."""

_STREAMS, _WORKS = 2, 1
"""Priorities of the streaming thread, and of the threads that plan or log.

A thread that plans or logs holds the interpreter for a while. It has priority over ordinary processes, so
that none of them keeps it from releasing the interpreter.
"""


@dataclass(slots=True)
class _Process:
    """State of this process with regard to the promptness of its threads.

    Attributes:
        moving: number of robots that move.
        beside: numbers of the threads that plan or log.
        first: True if the streaming thread has priority over ordinary threads.
        frozen: True if code outside of this module had excluded objects from garbage collection (gc.freeze)
            before something moved.
    """

    moving: int = 0
    beside: set[int] = field(default_factory=set)
    first: bool = False
    frozen: bool = False


_PROCESS = _Process()


@contextlib.contextmanager
def prompt_thread() -> Iterator[None]:
    """Have the operating system wake the calling thread soon, however busy the computer is, as long as the
    context lasts.

    If the user has the right (RLIMIT_RTPRIO, CAP_SYS_NICE), the thread gets priority over all ordinary
    threads. Otherwise it asks for short time slices, which every user may do, and which Linux honours from
    version 6.12 on. If neither is possible, nothing happens. Threads and processes that are started later
    have normal priority.
    """
    if _PROCESS.first:
        yield
        return
    _PROCESS.first = _goes_first(0, _STREAMS)
    if not _PROCESS.first:
        _ask_for_slices(_SLICE)
    try:
        yield
    finally:
        if _PROCESS.first:
            _goes_first(0, 0)
        else:
            _ask_for_slices(0)
        _PROCESS.first = False


@contextlib.contextmanager
def shares_the_interpreter() -> Iterator[None]:
    """Mark the calling thread as one that plans or logs in the process of the streaming thread, and shares
    Python's interpreter with it.

    While something moves, the calling thread gets priority over ordinary processes, so that it releases the
    interpreter soon.
    """
    number = threading.get_native_id()
    _PROCESS.beside.add(number)
    if _PROCESS.first and _PROCESS.moving:
        _goes_first(number, _WORKS)
    try:
        yield
    finally:
        _PROCESS.beside.discard(number)
        if _PROCESS.first:
            _goes_first(number, 0)


def _goes_first(thread: int, priority: int) -> bool:
    """Give a thread (0: the calling thread) priority over ordinary threads, or make it an ordinary thread
    (priority 0). Return False if that isn't allowed.
    """
    policy = os.SCHED_RR if priority else os.SCHED_OTHER
    try:
        os.sched_setscheduler(thread, policy | os.SCHED_RESET_ON_FORK, os.sched_param(priority))
    except (OSError, AttributeError):
        return False
    return True


def _ask_for_slices(length: int) -> None:
    """Ask for time slices of `length` [ns] for this thread; 0 for the system's default."""
    number = _SET_ATTRIBUTES.get(platform.machine())
    if sys.platform == "linux" and number is not None:
        size = _ATTRIBUTES.size
        wanted = _ATTRIBUTES.pack(size, os.SCHED_OTHER, _NOT_FOR_OTHERS, 0, 0, length, 0, 0, 0, 0)
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).syscall(number, 0, ctypes.create_string_buffer(wanted, size), 0)


@contextlib.contextmanager
def prompt_while_moving() -> Iterator[None]:
    """Make planning threads release the interpreter sooner, and postpone garbage collection, as long as the
    context lasts. Afterwards, restore the former settings.
    """
    _PROCESS.moving += 1
    if _PROCESS.moving > 1:  # another robot of this process moves already
        try:
            yield
        finally:
            _PROCESS.moving -= 1
        return
    for number in tuple(_PROCESS.beside) if _PROCESS.first else ():
        _goes_first(number, _WORKS)
    switch, garbage = sys.getswitchinterval(), gc.get_threshold()
    # `get_freeze_count` takes long: call it only once
    frozen = _PROCESS.frozen = _PROCESS.frozen or gc.get_freeze_count() > 0
    sys.setswitchinterval(min(switch, _SWITCH))
    if not frozen:  # objects frozen by someone else must stay exactly as they are
        gc.freeze()
    gc.set_threshold(*map(max, garbage, _GARBAGE))
    try:
        yield
    finally:
        _PROCESS.moving -= 1
        gc.set_threshold(*garbage)
        if not frozen:
            gc.unfreeze()
        sys.setswitchinterval(switch)
        for number in tuple(_PROCESS.beside) if _PROCESS.first else ():
            _goes_first(number, 0)
