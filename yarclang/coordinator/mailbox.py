"""What waits for one subscriber: bounded, so that whoever doesn't read costs nothing. No I/O."""

from __future__ import annotations

from collections import deque

from yarclang.coordinator.messages.events import COALESCED, BaseEvent, Missed

CAPACITY = 256
"""Events that wait for a subscriber, if nobody says otherwise."""


class Mailbox:
    """Events in their order. Of positions, and of progress, only the newest waits; of all others the oldest goes where
    there is no room, and how many went is told before anything else.

    Args:
        capacity: events that wait at most, 4 or more.
    """

    def __init__(self, capacity: int = CAPACITY) -> None:
        if capacity < 4:
            raise ValueError(f"a mailbox of {capacity}: 4 or more are wanted")
        self._capacity = capacity
        self._events: deque[BaseEvent] = deque()
        self._missed = 0

    def __len__(self) -> int:
        return len(self._events) + bool(self._missed)

    def put(self, event: BaseEvent) -> None:
        """One more."""
        if isinstance(event, COALESCED):
            kind = type(event)
            older = next((one for one in reversed(self._events) if type(one) is kind), None)
            if older is not None:
                self._events.remove(older)
        self._events.append(event)
        if len(self._events) > self._capacity:
            self._make_room()

    def take(self) -> BaseEvent | None:
        """The oldest; None where there is none."""
        if self._missed:
            count, self._missed = self._missed, 0
            return Missed(time_s=self._events[0].time_s, count=count)
        return self._events.popleft() if self._events else None

    def _make_room(self) -> None:
        """Give up the oldest whose loss matters: positions are never told as missed."""
        oldest = next(one for one in self._events if not isinstance(one, COALESCED))
        self._events.remove(oldest)
        self._missed += 1
