"""How far work has come: told to whoever listens, who may end it.

Doors listen around a piece of work (`told_to`); long loops below them tell how much is done (`tell`), or that they go on (`go_on`). An exception that
the listener raises ends the work. Nothing depends on whether somebody listens.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

T = TypeVar("T")

Listener = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and how much there is (0: unknown)."""


class GivenUp(BaseException):
    """The work was given up. It is no failure, so nothing that catches these must catch it."""


def unless(is_over: Callable[[], bool]) -> Listener:
    """Return a listener that gives the work up once it is over."""

    def listen(what: str, done: int, total: int) -> None:  # noqa: ARG001 - a listener
        if is_over():
            raise GivenUp

    return listen


class _Told:
    """A listener, and what it was told last."""

    __slots__ = ("done", "listener", "total", "what")

    def __init__(self, listener: Listener) -> None:
        self.listener = listener
        self.what, self.done, self.total = "", 0, 0


_TOLD: ContextVar[_Told | None] = ContextVar("told", default=None)


@contextmanager
def told_to(listener: Listener | None) -> Iterator[None]:
    """Let somebody listen to what is done in this block, by this thread; None: as before."""
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
    """Let nobody listen in this block."""
    token = _TOLD.set(None)
    try:
        yield
    finally:
        _TOLD.reset(token)


@contextmanager
def within() -> Iterator[None]:
    """Let what is told in this block only say that what was told before goes on."""
    around = _TOLD.get()
    if around is None:
        yield
        return
    with told_to(lambda *_: around.listener(around.what, around.done, around.total)):
        yield


@contextmanager
def part(title: str) -> Iterator[None]:
    """Report what is done in this block as a part of something: `title: what is done`."""
    around = _TOLD.get()
    if around is None:
        yield
        return
    listener = around.listener
    with told_to(lambda what, done, total: listener(f"{title}: {what}", done, total)):
        yield


def tell(what: str, done: int, total: int = 0) -> None:
    """Tell what is being done, and how much of it is done."""
    told = _TOLD.get()
    if told is not None:
        told.what, told.done, told.total = what, done, total
        told.listener(what, done, total)


def go_on(done: int | None = None, total: int = 0) -> None:
    """Tell again what was told last, or how much of that is done by now: called often where something takes long."""
    told = _TOLD.get()
    if told is not None:
        if done is not None:
            told.done, told.total = done, total
        told.listener(told.what, told.done, told.total)


_EVERY = 32
"""Items of a long list between two reports."""


def each(items: Iterable[T]) -> Iterator[T]:
    """Yield the items, and report every few of them that the work goes on."""
    for number, item in enumerate(items):
        if number % _EVERY == 0:
            go_on()
        yield item
