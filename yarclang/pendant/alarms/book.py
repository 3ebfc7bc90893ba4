"""List of all alarms, in order and of limited number. No I/O."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from heapq import merge

from yarclang.pendant.alarms.alarm import Alarm, Raised, Source, Stood

MOST = 10_000
"""Largest number of alarms that are stored. The oldest are removed, except those whose fault is still
present.
"""

AGAIN = 60.0
"""If an alarm occurs again within this time, it is counted instead of listed a second time [s]."""

_INCIDENT = 2.0
"""Time after a fault within which the end of a program counts as a consequence of the fault and raises no
alarm of its own [s].
"""

_NOWHERE = Stood()

_MOST_OF_SOURCE = 100
"""Largest number of present faults of one source for which there are alarms. Further faults of this source
are ignored.
"""


class Book:
    """All alarms of a pendant.

    Args:
        stored: earlier alarms from the database, in any order.
        most: largest number of alarms that are stored.

    Attributes:
        version: number that changes whenever an alarm changes.
        changed: numbers of alarms that were changed or removed since they were last written to the database.
    """

    def __init__(self, stored: Iterable[Alarm] = (), most: int = MOST) -> None:
        self._alarms = {one.number: one for one in sorted(stored, key=lambda one: one.number)}
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

    # causes

    def happened(self, raised: Raised, stood: Stood, now: float) -> None:
        """Record a fault that an event reports, such as the end of a program with an error.

        Args:
            raised: cause of the alarm.
            stood: the state of the robot.
            now: time of day [s].
        """
        raised = raised.cleaned()
        if not self._tells_of_known(raised, stood, now):
            self._raise(raised, stood, now, ended=now)

    def holding(
        self, source: Source, causes: Iterable[Raised], stood: Callable[[], Stood], now: float
    ) -> None:
        """Replace the list of a source's present faults. A new fault raises an alarm. The alarm of a fault
        that is no longer present ends.

        Args:
            source: origin of the alarms.
            causes: causes of all faults that are present now.
            stood: function that returns the state of the robot.
            now: time of day [s].
        """
        holding = {
            self._alarms[one].raised.key: one
            for one in self._holding
            if self._alarms[one].raised.source == source
        }
        cleaned = {one.key: one for one in (each.cleaned() for each in causes)}
        for raised in list(cleaned.values())[:_MOST_OF_SOURCE]:
            number = holding.pop(raised.key, None)
            if number is None and source == "state":  # the same fault, with a longer description
                same = (key for key in holding if key[1] in raised.what or raised.what in key[1])
                number = holding.pop(next(same, ("", "")), None)
            if number is None:
                self._raise(raised, stood(), now, ended=None)
            else:
                self._add(number, raised)
        for number in holding.values():
            self._put(replace(self._alarms[number], ended=now))

    def _tells_of_known(self, raised: Raised, stood: Stood, now: float) -> bool:
        """Return True if a cause only repeats the fault that the robot's state has just reported. If so, add
        the details of the cause to the alarm of that fault.
        """
        alarm_before = self._alarms.get(self._state)
        if alarm_before is None or not (alarm_before.holds or alarm_before.last >= now - _INCIDENT):
            return False
        before, remedy = alarm_before.raised.what, alarm_before.raised.remedy
        if before in raised.what or raised.what in before or raised.what == remedy:
            self._add(alarm_before.number, raised, stood)
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
        alarm = Alarm(self._next, raised, stood, now, now, ended=ended)
        self._next += 1
        self._recent[raised.key] = alarm.number
        if raised.source == "state":
            self._state = alarm.number
        self._put(alarm)
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

    # acknowledgements

    def unacknowledged(self, numbers: Iterable[int]) -> tuple[int, ...]:
        """Return those of the given numbers whose alarms aren't acknowledged yet."""
        found = (self._alarms.get(one) for one in dict.fromkeys(numbers))
        return tuple(one.number for one in found if one is not None and one.acknowledged is None)

    def acknowledge(self, numbers: Iterable[int], by: str, now: float) -> int:
        """Acknowledge alarms and return how many of them are newly acknowledged.

        Args:
            numbers: numbers of the alarms.
            by: name of the user.
            now: time of day [s].
        """
        found = self.unacknowledged(numbers)
        for number in found:
            self._put(replace(self._alarms[number], acknowledged=now, by=by))
        return len(found)

    # queries

    def __len__(self) -> int:
        return len(self._alarms)

    def get(self, number: int) -> Alarm | None:
        """Return an alarm by its number; None if there is none."""
        return self._alarms.get(number)

    def open(self) -> Iterator[Alarm]:
        """Yield the alarms whose fault is present or that aren't acknowledged, newest first."""
        read = sorted((one for one in self._holding if one not in self._unread), reverse=True)
        for number in merge(reversed(self._unread), read, reverse=True):
            yield self._alarms[number]

    @property
    def open_count(self) -> int:
        """Number of open alarms."""
        return len(self._unread) + sum(one not in self._unread for one in self._holding)

    def past(self, before: int | None = None) -> Iterator[Alarm]:
        """Yield the alarms that are no longer open, newest first. With `before`, yield only alarms with
        smaller numbers.
        """
        for number in reversed(self._alarms):
            if not self._alarms[number].is_open and (before is None or number < before):
                yield self._alarms[number]

    def all(self) -> tuple[Alarm, ...]:
        """Return all alarms, newest first."""
        return tuple(reversed(self._alarms.values()))

    def foremost(self) -> Alarm | None:
        """Return the most important alarm: the newest one that isn't acknowledged, otherwise the newest
        one whose fault is still present; None if there is neither.
        """
        newest = next(reversed(self._unread), None) or max(self._holding, default=None)
        return None if newest is None else self._alarms[newest]
