"""Caches of earlier results, so that after an edit only what depends on the edit is computed.

A memory is passed to a stage of the compiler as an argument. Results don't depend on it. A key contains
everything on which a result depends, by value (`bytes` of arrays) or by identity (a robot, or a path that
came from the memory itself). For keys by identity the memory holds a reference, so that no other object can
get the same id.
"""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable, Hashable
from contextlib import suppress
from typing import Any, Generic, Protocol, TypeVar

T = TypeVar("T")


class Memory(Protocol):
    """Stores results by key, and may drop them at any time."""

    def get(self, key: Hashable) -> Any:
        """Return the stored result, or None."""

    def keep(self, key: Hashable, value: object) -> None:
        """Store a result, which isn't None."""


class Forgetful:
    """A memory that stores nothing, for stages whose work isn't repeated."""

    def get(self, key: Hashable) -> Any:
        """Return None."""

    def keep(self, key: Hashable, value: object) -> None:
        """Do nothing."""


NO_MEMORY = Forgetful()


class Recent:
    """A cache of the `most` results that were used most recently.

    Two threads may use it at the same time. The worst effect is that a result is computed twice.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._kept: OrderedDict[Hashable, Any] = OrderedDict()
        self._used: set[Hashable] = set()
        self._before: list[set[Hashable]] = []
        """For each run of the compiler since the order of use was last updated: the keys that the run has
        used.
        """
        self._uses = deque([0], maxlen=_LOOKS)
        self.hits = 0
        self.misses = 0

    def __len__(self) -> int:
        return len(self._kept)

    def get(self, key: Hashable) -> Any:
        """Return the stored result, or None."""
        value = self._kept.get(key)
        if value is None:
            self.misses += 1
            return None
        self.hits += 1
        self._used.add(key)
        # Below half of the largest size, nothing will be dropped soon, and updating the order would cost more
        # than the access.
        if 2 * len(self._kept) > self._most:
            try:
                self._kept.move_to_end(key)
            except KeyError:  # another thread has just dropped it
                self._kept[key] = value
        return value

    def keep(self, key: Hashable, value: object) -> None:
        """Store a result, and drop the least recently used ones."""
        self._kept[key] = value
        self._used.add(key)
        if len(self._kept) > self._most:
            self._put_in_order()
            self._drop(self._most)

    def settle(self, least: int) -> None:
        """Drop old results after a run of the compiler.

        Args:
            least: number of results that are always kept. If one of the last runs used more, up to twice the
                number of results that it used are kept.
        """
        used, self._used = self._used, set()
        self._uses.append(len(used))
        self._before.append(used)
        # Updating the order of use takes as long as checking some lines, so it is done once for several runs.
        most = max(least, 2 * max(self._uses))
        if len(self._before) >= _LOOKS_AT_ONCE or len(self._kept) > most + least // 8:
            self._put_in_order()
            self._drop(most)

    def clear(self) -> None:
        """Drop everything."""
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
"""Number of runs after which the order of use is updated, unless it was updated earlier."""

_LOOKS = 32
"""Number of the latest runs that determine how many results are kept."""


class Lately(Generic[T]):
    """A function of texts and numbers that caches its latest results.

    There are two tables, a younger and an older one. A result that is used is put into the younger table.
    When this table is full, it replaces the older one, whose unused results are dropped. Two threads may use
    the function at the same time, as with `Recent`.

    Args:
        make: computes a result.
        least: number of results in a full table, unless `expect` makes the tables larger.
    """

    def __init__(self, make: Callable[..., T], least: int) -> None:
        self._make = make
        self._least = self._enough = least
        self._young: dict[Hashable, T] = {}
        self._old: dict[Hashable, T] = {}
        self.__doc__ = make.__doc__

    def __call__(self, *key: Hashable) -> T:
        """Return a cached result, or compute it by `make`."""
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
        """Enlarge the tables, so that `number` different results are all kept until they are used again."""
        self._enough = max(self._least, 2 * number)

    def cache_clear(self) -> None:
        """Drop everything."""
        self._young, self._old = {}, {}


def recall(memory: Memory, key: Hashable, make: Callable[[], T]) -> T:
    """Return the stored result for a key, or compute it by `make` and store it."""
    found: T | None = memory.get(key)
    if found is None:
        found = make()
        memory.keep(key, found)
    return found
