"""What was worked out before: results by all that determines them, so that a program that was edited is worked out anew only where it changed.

A memory is handed to a stage as an argument. What a stage does with one is what it does without: a key holds everything that the result depends on, by
value (`bytes` of arrays) or by identity (a robot, a path that was itself recalled; the memory holds it, so no other can take its place).
"""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable, Hashable
from contextlib import suppress
from typing import Any, Generic, Protocol, TypeVar

T = TypeVar("T")


class Memory(Protocol):
    """Keeps results by their keys, as long as it likes."""

    def get(self, key: Hashable) -> Any:
        """What was kept, or None."""

    def keep(self, key: Hashable, value: object) -> None:
        """Keep a result (not None)."""


class Forgetful:
    """Keeps nothing: every stage's choice where nothing comes again."""

    def get(self, key: Hashable) -> Any:
        """Nothing."""

    def keep(self, key: Hashable, value: object) -> None:
        """Don't."""


NO_MEMORY = Forgetful()


class Recent:
    """Keeps the results that were used last, at most `most` of them.

    Two threads may use it at once: the worst that happens is that a result is worked out twice.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._kept: OrderedDict[Hashable, Any] = OrderedDict()
        self._used: set[Hashable] = set()
        self._before: list[set[Hashable]] = []
        """What looks have used that ended since the order was last put right."""
        self._uses = deque([0], maxlen=_LOOKS)
        self.hits = 0
        self.misses = 0

    def __len__(self) -> int:
        return len(self._kept)

    def get(self, key: Hashable) -> Any:
        """What was kept, or None."""
        value = self._kept.get(key)
        if value is None:
            self.misses += 1
            return None
        self.hits += 1
        self._used.add(key)
        # before, nothing is dropped for long, and to keep the order costs more than the look
        if 2 * len(self._kept) > self._most:
            try:
                self._kept.move_to_end(key)
            except KeyError:  # another thread has just dropped it
                self._kept[key] = value
        return value

    def keep(self, key: Hashable, value: object) -> None:
        """Keep a result, and drop what wasn't used for longest."""
        self._kept[key] = value
        self._used.add(key)
        if len(self._kept) > self._most:
            self._put_in_order()
            self._drop(self._most)

    def settle(self, least: int) -> None:
        """Drop what wasn't used for long, after one look at something: up to `least` results stay, or as many as the largest of the last looks
        has used, and as many again.
        """
        used, self._used = self._used, set()
        self._uses.append(len(used))
        self._before.append(used)
        # to put the order right costs as much as a look at some lines: that is done for several looks at once
        most = max(least, 2 * max(self._uses))
        if len(self._before) >= _LOOKS_AT_ONCE or len(self._kept) > most + least // 8:
            self._put_in_order()
            self._drop(most)

    def clear(self) -> None:
        """Forget everything."""
        self._kept.clear()
        self._used.clear()
        self._before.clear()

    def _put_in_order(self) -> None:
        before, self._before = self._before, []
        last: dict[Hashable, None] = {}
        for used in reversed(before):
            last.update(dict.fromkeys(used - last.keys()))
        for key in reversed(last):
            with suppress(KeyError):  # it was dropped already
                self._kept.move_to_end(key)

    def _drop(self, most: int) -> None:
        while len(self._kept) > most:
            try:
                self._kept.popitem(last=False)
            except KeyError:
                return


_LOOKS_AT_ONCE = 8
"""Looks after which the order of what was used is put right at the latest."""

_LOOKS = 32
"""Looks at something that count for how much is kept after one of them."""


class Lately(Generic[T]):
    """A function of texts and numbers that keeps what it has given lately.

    There are two tables. Once the younger one has more than enough, it becomes the older one, and what was in that and wasn't asked for since is forgotten. Two
    threads may use it at once, as `Recent`.

    Args:
        make: gives a result.
        least: how many results are enough at least.
    """

    def __init__(self, make: Callable[..., T], least: int) -> None:
        self._make = make
        self._least = self._enough = least
        self._young: dict[Hashable, T] = {}
        self._old: dict[Hashable, T] = {}
        self.__doc__ = make.__doc__

    def __call__(self, *key: Hashable) -> T:
        """Return what was given lately, else what `make` gives."""
        found: Any = self._young.get(key, self)
        if found is self:
            found = self._old.get(key, self)
            if found is self:
                found = self._make(*key)
            if len(self._young) >= self._enough:
                self._old, self._young = self._young, {}
            self._young[key] = found
        result: T = found
        return result

    def __len__(self) -> int:
        return len(self._young) + len(self._old)

    def expect(self, number: int) -> None:
        """Take it that so many results are asked for next: they are kept until they are asked for again."""
        self._enough = max(self._least, 2 * number)

    def cache_clear(self) -> None:
        """Forget everything."""
        self._young, self._old = {}, {}


def recall(memory: Memory, key: Hashable, make: Callable[[], T]) -> T:
    """What was kept under a key, else what `make` gives, which is kept."""
    found: T | None = memory.get(key)
    if found is None:
        found = make()
        memory.keep(key, found)
    return found
