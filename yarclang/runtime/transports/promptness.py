"""What this process can do itself so that a stop never waits for other work of this process or of the computer."""

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
"""How long a thread that plans may keep the interpreter from the thread that streams, while something moves [s]; Python's default is ten times that."""

_GARBAGE = (2_000, 20, 1_000)
"""How many more objects, and how many rounds, Python waits before it looks through them for garbage while something moves. The third round looks through
all objects of a long program, and takes 0.1 s in which no thread goes on."""

_SLICE = 100_000
"""Time that a thread wants at once [ns], the least that Linux takes: who wants little gets it soon."""

_ATTRIBUTES = struct.Struct("IIQiIQQQII")
"""`struct sched_attr` of Linux: size, policy, flags, nice, priority, runtime, deadline, period and two bounds of utilisation."""

_SET_ATTRIBUTES = {"x86_64": 314, "aarch64": 274}
"""Number of the system call `sched_setattr`, by the machine."""

_NOT_FOR_OTHERS = 1
"""SCHED_FLAG_RESET_ON_FORK: threads and processes that are begun later are ordinary ones."""

_STREAMS, _WORKS = 2, 1
"""Priorities of the thread that streams, and of those that plan or log: these hold the interpreter, and must not be kept from giving it back by ordinary processes."""


@dataclass(slots=True)
class _Process:
    """What is known of this process.

    Attributes:
        moving: robots that move.
        beside: threads that plan or log.
        first: whether the thread that streams goes before ordinary ones.
        frozen: whether objects were frozen before something moved.
    """

    moving: int = 0
    beside: set[int] = field(default_factory=set)
    first: bool = False
    frozen: bool = False


_PROCESS = _Process()


@contextlib.contextmanager
def prompt_thread() -> Iterator[None]:
    """Have the calling thread woken soon, however busy the computer is, as long as the context lasts.

    Where the user may (RLIMIT_RTPRIO, CAP_SYS_NICE), the thread goes before all ordinary ones. Else it asks for short slices of time, which everybody may, and
    which Linux heeds from 6.12 on. Nothing happens where neither is possible. Threads and processes that are begun later stay ordinary.
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
    """Say that the calling thread works beside the one that streams: while something moves, it mustn't be kept from giving the interpreter back."""
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
    """Let a thread (0: this one) go before ordinary ones, or (priority 0) be one of them; false where that isn't allowed."""
    policy = os.SCHED_RR if priority else os.SCHED_OTHER
    try:
        os.sched_setscheduler(thread, policy | os.SCHED_RESET_ON_FORK, os.sched_param(priority))
    except (OSError, AttributeError):
        return False
    return True


def _ask_for_slices(length: int) -> None:
    """Ask for slices of so many nanoseconds for this thread; 0: the system's own."""
    number = _SET_ATTRIBUTES.get(platform.machine())
    if sys.platform == "linux" and number is not None:
        size = _ATTRIBUTES.size
        wanted = _ATTRIBUTES.pack(size, os.SCHED_OTHER, _NOT_FOR_OTHERS, 0, 0, length, 0, 0, 0, 0)
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).syscall(number, 0, ctypes.create_string_buffer(wanted, size), 0)


@contextlib.contextmanager
def prompt_while_moving() -> Iterator[None]:
    """Let threads that plan give way sooner, and put the search for garbage off, as long as the context lasts; then all is as before."""
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
    frozen = _PROCESS.frozen = _PROCESS.frozen or gc.get_freeze_count() > 0  # to count them takes long
    sys.setswitchinterval(min(switch, _SWITCH))
    if not frozen:  # who froze objects before wants just these to stay so
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
