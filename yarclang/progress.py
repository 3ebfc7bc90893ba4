"""Report progress of work to a listener, who may cancel the work.

A command sets a listener during some work (`told_to`). Long loops inside report how much is done (`tell`), or
that they continue (`go_on`). An exception that the listener raises ends the work. Results don't depend on a
listener.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

T = TypeVar("T")

Listener = Callable[[str, int, int], None]
"""Function that is called with the current work, the amount done, and the total amount (0: unknown)."""


class GivenUp(BaseException):
    """The work was cancelled. This isn't an `Exception`, so that handlers of failures don't catch it."""


def unless(is_over: Callable[[], bool]) -> Listener:
    """Return a listener that cancels the work when `is_over` returns True."""

    def listen(what: str, done: int, total: int) -> None:  # noqa: ARG001 - a listener
        if is_over():
            raise GivenUp

    return listen


class _Told:
    """A listener, and the last report that it received."""

    __slots__ = ("done", "listener", "total", "what")

    def __init__(self, listener: Listener) -> None:
        self.listener = listener
        self.what, self.done, self.total = "", 0, 0


_TOLD: ContextVar[_Told | None] = ContextVar("told", default=None)


@contextmanager
def told_to(listener: Listener | None) -> Iterator[None]:
    """Set the listener to whom this thread's work inside the `with` block is reported; None keeps the current
    listener.
    """
    if listener is None:
        yield
        return
    token = _TOLD.set(_Told(listener))
    try:
        yield
    finally:
        _TOLD.reset(token)


@contextmanager
def silent() -> Iterator[None]:
    """Report the progress of the work inside this `with` block to nobody."""
    token = _TOLD.set(None)
    try:
        yield
    finally:
        _TOLD.reset(token)


@contextmanager
def within() -> Iterator[None]:
    """Keep the last report before this `with` block: each report of the work inside the block repeats it."""
    around = _TOLD.get()
    if around is None:
        yield
        return
    with told_to(lambda *_: around.listener(around.what, around.done, around.total)):
        yield


@contextmanager
def part(title: str) -> Iterator[None]:
    """Put a title before the reports of the work inside this `with` block: `title: what is done`."""
    around = _TOLD.get()
    if around is None:
        yield
        return
    listener = around.listener
    with told_to(lambda what, done, total: listener(f"{title}: {what}", done, total)):
        yield


def tell(what: str, done: int, total: int = 0) -> None:
    """Report to the listener what work is going on, and how much of it is done.

    Args:
        what: the work.
        done: amount done.
        total: total amount; 0 if it isn't known.
    """
    told = _TOLD.get()
    if told is not None:
        told.what, told.done, told.total = what, done, total
        told.listener(what, done, total)


def go_on(done: int | None = None, total: int = 0) -> None:
    """Repeat the last report, optionally with a new amount. Called often during long work."""
    told = _TOLD.get()
    if told is not None:
        if done is not None:
            told.done, told.total = done, total
        told.listener(told.what, told.done, told.total)


_EVERY = 32
"""Number of items of a long list between two reports."""


def each(items: Iterable[T]) -> Iterator[T]:
    """Yield the items, and report progress once every few items."""
    for number, item in enumerate(items):
        if number % _EVERY == 0:
            go_on()
        yield item
