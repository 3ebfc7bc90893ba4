"""What was worked out before: results by all that determines them, so that a program that was edited is worked out anew only where it changed.

A memory is handed to a stage as an argument. What a stage does with one is what it does without: a key holds everything that the result depends on, by
value (`bytes` of arrays) or by identity (a robot, a path that was itself recalled; the memory holds it, so no other can take its place).
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from typing import Any, Protocol, TypeVar

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
        while len(self._kept) > self._most:
            try:
                self._kept.popitem(last=False)
            except KeyError:
                return

    def clear(self) -> None:
        """Forget everything."""
        self._kept.clear()


def recall(memory: Memory, key: Hashable, make: Callable[[], T]) -> T:
    """What was kept under a key, else what `make` gives, which is kept."""
    found: T | None = memory.get(key)
    if found is None:
        found = make()
        memory.keep(key, found)
    return found
