"""The queue of events for one subscriber. Its length is limited, so that a subscriber that doesn't read its
events needs little memory. No I/O.
"""

from __future__ import annotations

from collections import deque

from yarclang.coordinator.messages.events import COALESCED, BaseEvent, Missed

CAPACITY = 256
"""Default of the largest number of events that are stored for a subscriber."""


class Mailbox:
    """Queue of events, in their order.

    Of some types of events (`COALESCED`, such as positions), only the newest event is stored. If the queue is
    full, the oldest event of the other types is dropped. The number of dropped events is reported before
    any other event.

    Args:
        capacity: largest number of stored events, at least 4.
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
        """Add an event."""
        if isinstance(event, COALESCED):
            kind = type(event)
            older = next((one for one in reversed(self._events) if type(one) is kind), None)
            if older is not None:
                self._events.remove(older)
        self._events.append(event)
        if len(self._events) > self._capacity:
            self._make_room()

    def take(self) -> BaseEvent | None:
        """Remove and return the oldest event; None if there is none."""
        if self._missed:
            count, self._missed = self._missed, 0
            return Missed(time_s=self._events[0].time_s, count=count)
        return self._events.popleft() if self._events else None

    def _make_room(self) -> None:
        """Drop the oldest event whose type isn't in `COALESCED`. Events of the types in `COALESCED` take
        little room, since only the newest of each type is stored.
        """
        oldest = next(one for one in self._events if not isinstance(one, COALESCED))
        self._events.remove(oldest)
        self._missed += 1
