"""A stream of events for one subscriber."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable

from yarclang.coordinator.mailbox import Mailbox
from yarclang.coordinator.messages.events import BaseEvent, Position


class Subscription:
    """Events as an asynchronous iterator. It ends when the coordinator or the subscription is closed.

    Args:
        capacity: largest number of events that are stored. If there are more, events are dropped, and their
            number is reported as `Missed`.
        leave: called when the subscription is closed.
        positions: True if the subscriber wants positions.
        told: called when an event has arrived, for a subscriber that doesn't wait in `next`.
    """

    def __init__(
        self,
        capacity: int,
        leave: Callable[[Subscription], object],
        *,
        positions: bool = True,
        told: Callable[[], object] = lambda: None,
    ) -> None:
        self._positions = positions
        self._told = told
        self._mailbox = Mailbox(capacity)
        self._leave: Callable[[Subscription], object] | None = leave
        self._arrived = asyncio.Event()

    def put(self, event: BaseEvent) -> None:
        """Add an event. The coordinator calls this; it never waits."""
        if not self._positions and isinstance(event, Position):
            return
        self._mailbox.put(event)
        self._arrived.set()
        self._told()

    def take(self) -> BaseEvent | None:
        """Remove and return the oldest event; None if there is none."""
        return self._mailbox.take()

    def close(self) -> None:
        """End the stream. Waiting events can still be taken."""
        if self._leave is not None:
            leave, self._leave = self._leave, None
            leave(self)
            self._arrived.set()

    async def next(self) -> BaseEvent | None:
        """Wait for the oldest event and return it; None at the end of the stream."""
        while True:
            if (event := self._mailbox.take()) is not None:
                return event
            if self._leave is None:
                return None
            self._arrived.clear()
            await self._arrived.wait()

    def waiting(self) -> tuple[BaseEvent, ...]:
        """Return all events that have arrived, without waiting."""
        found: list[BaseEvent] = []
        while (event := self._mailbox.take()) is not None:
            found.append(event)
        return tuple(found)

    async def __aiter__(self) -> AsyncIterator[BaseEvent]:
        while (event := await self.next()) is not None:
            yield event

    def __enter__(self) -> Subscription:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
