"""All alarms, in their order and bounded. No I/O."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from heapq import merge

from yarclang.pendant.alarms.alarm import Alarm, Raised, Source, Stood

MOST = 10_000
"""Alarms that are kept; the oldest go, but for those that hold."""

AGAIN = 60.0
"""The same alarm is counted, not listed once more, if it comes again within this time [s]."""

_INCIDENT = 2.0
"""The end of a program tells of the fault before it, within this time [s]."""

_NOWHERE = Stood()

_MOST_OF_SOURCE = 100
"""Alarms of one source that hold at a time; more aren't told."""


class Book:
    """The alarms.

    Args:
        kept: those of before, in any order.
        most: that are kept.

    Attributes:
        version: another number after each change.
        changed: numbers of alarms that aren't written yet, or have gone.
    """

    def __init__(self, kept: Iterable[Alarm] = (), most: int = MOST) -> None:
        self._alarms = {one.number: one for one in sorted(kept, key=lambda one: one.number)}
        self._next = max(self._alarms, default=0) + 1
        self._most = most
        self._holding = {number for number, one in self._alarms.items() if one.holds}
        self._unread = {number: None for number, one in self._alarms.items() if one.acknowledged is None}
        self._state = max(
            (one for one in self._holding if self._alarms[one].raised.source == "state"), default=0
        )
        self._recent: dict[tuple[str, str], int] = {}
        self.version = 0
        self.changed: set[int] = set()

    # what went wrong

    def happened(self, raised: Raised, stood: Stood, now: float) -> None:
        """Note something that went wrong once.

        Args:
            raised: what.
            stood: where the robot was.
            now: the time of day [s].
        """
        raised = raised.cleaned()
        if not self._tells_of_known(raised, stood, now):
            self._raise(raised, stood, now, ended=now)

    def holding(
        self, source: Source, found: Iterable[Raised], stood: Callable[[], Stood], now: float
    ) -> None:
        """Note all that is wrong now, as one source tells it: what was wrong before and isn't among it has ended.

        Args:
            source: who tells it.
            found: what is wrong now.
            stood: returns where the robot is.
            now: the time of day [s].
        """
        held = {
            self._alarms[one].raised.key: one
            for one in self._holding
            if self._alarms[one].raised.source == source
        }
        cleaned = {one.key: one for one in (each.cleaned() for each in found)}
        for raised in list(cleaned.values())[:_MOST_OF_SOURCE]:
            number = held.pop(raised.key, None)
            if number is None and source == "state":  # a lost connection becomes a fault that tells of it
                same = (key for key in held if key[1] in raised.what or raised.what in key[1])
                number = held.pop(next(same, ("", "")), None)
            if number is None:
                self._raise(raised, stood(), now, ended=None)
            else:
                self._add(number, raised)
        for number in held.values():
            self._put(replace(self._alarms[number], ended=now))

    def _tells_of_known(self, raised: Raised, stood: Stood, now: float) -> bool:
        """Return True if it is the fault that the state has just told; what is new of it is added."""
        known = self._alarms.get(self._state)
        if known is None or not (known.holds or known.last >= now - _INCIDENT):
            return False
        before, remedy = known.raised.what, known.raised.remedy
        if before in raised.what or raised.what in before or raised.what == remedy:
            self._add(known.number, raised, stood)
            return True
        return False

    def _add(self, number: int, raised: Raised, stood: Stood = _NOWHERE) -> None:
        known = self._alarms[number]
        if raised.what == known.raised.remedy:
            return
        more = replace(known, raised=known.raised.with_more(raised), stood=known.stood.with_more(stood))
        if more != known:
            self._put(more)

    def _raise(self, raised: Raised, stood: Stood, now: float, ended: float | None) -> None:
        known = self._alarms.get(self._recent.get(raised.key, 0))
        if known is not None and known.acknowledged is None and 0.0 <= now - known.last <= AGAIN:
            self._put(replace(known, count=known.count + 1, last=now, ended=ended))
            return
        made = Alarm(self._next, raised, stood, now, now, ended=ended)
        self._next += 1
        self._recent[raised.key] = made.number
        if raised.source == "state":
            self._state = made.number
        self._put(made)
        if len(self._alarms) > self._most:
            self._forget()

    def _forget(self) -> None:
        oldest = next((one for one in self._alarms if one not in self._holding), None)
        if oldest is not None:
            gone = self._alarms.pop(oldest)
            self._unread.pop(oldest, None)
            self.changed.add(oldest)
            if self._recent.get(gone.raised.key) == oldest:
                del self._recent[gone.raised.key]

    def _put(self, alarm: Alarm) -> None:
        number = alarm.number
        self._alarms[number] = alarm
        if alarm.holds:
            self._holding.add(number)
        else:
            self._holding.discard(number)
        if alarm.acknowledged is None:
            self._unread.setdefault(number)
        else:
            self._unread.pop(number, None)
        self.changed.add(number)
        self.version += 1

    # what people do

    def unacknowledged(self, numbers: Iterable[int]) -> tuple[int, ...]:
        """Return those of the numbers that nobody has acknowledged."""
        found = (self._alarms.get(one) for one in dict.fromkeys(numbers))
        return tuple(one.number for one in found if one is not None and one.acknowledged is None)

    def acknowledge(self, numbers: Iterable[int], by: str, now: float) -> int:
        """Acknowledge alarms; return how many nobody had acknowledged before.

        Args:
            numbers: of the alarms.
            by: who does.
            now: the time of day [s].
        """
        found = self.unacknowledged(numbers)
        for number in found:
            self._put(replace(self._alarms[number], acknowledged=now, by=by))
        return len(found)

    # what there is

    def __len__(self) -> int:
        return len(self._alarms)

    def get(self, number: int) -> Alarm | None:
        """Return an alarm; None if it has gone, or never was one."""
        return self._alarms.get(number)

    def open(self) -> Iterator[Alarm]:
        """Yield the alarms that hold or nobody has acknowledged, the newest first."""
        read = sorted((one for one in self._holding if one not in self._unread), reverse=True)
        for number in merge(reversed(self._unread), read, reverse=True):
            yield self._alarms[number]

    @property
    def open_count(self) -> int:
        """How many alarms are open."""
        return len(self._unread) + sum(one not in self._unread for one in self._holding)

    def past(self, before: int | None = None) -> Iterator[Alarm]:
        """Yield the other alarms, the newest first; with `before`, those with smaller numbers only."""
        for number in reversed(self._alarms):
            if not self._alarms[number].is_open and (before is None or number < before):
                yield self._alarms[number]

    def all(self) -> tuple[Alarm, ...]:
        """Return all alarms, the newest first."""
        return tuple(reversed(self._alarms.values()))

    def foremost(self) -> Alarm | None:
        """Return the alarm that is shown first: the newest that nobody has acknowledged, else the newest that holds."""
        newest = next(reversed(self._unread), None) or max(self._holding, default=None)
        return None if newest is None else self._alarms[newest]
