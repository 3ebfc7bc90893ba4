"""The alarms of a pendant, raised by the coordinator's events and stored in the pendant's database file.
Nothing here waits for a disk.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from contextlib import suppress

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import events
from yarclang.pendant.accounts.database import Database
from yarclang.pendant.alarms import kept, told
from yarclang.pendant.alarms.alarm import MOST_NAME, Stood, printable
from yarclang.pendant.alarms.book import MOST, Book
from yarclang.pendant.messages.display import AlarmBar
from yarclang.pendant.showing import Showing
from yarclang.runtime.actions import Trouble

_LOOKED_EACH = 0.5
"""Time between two checks of motors, guard and audit trail [s]."""

_TOGETHER, _AGAIN = 0.1, 20.0
"""Time for which changed alarms are collected before they are written in one transaction, and time after
which a failed write is repeated [s].
"""

_MOST_AT_ONCE = 1000
"""Largest number of alarms in one transaction. During a transaction, nothing else can be written to the
database.
"""


class Alarms:
    """The alarms of a pendant.

    Args:
        database: database in which the alarms are stored.
        showing: last known state of the robot.
        audit: returns the reason why the audit trail can't be written; empty if it can be.
        wall: returns the time of day [s].

    Attributes:
        book: all alarms.
        trouble: reason why the database can't be written, so that the alarms exist only in memory; empty if
            it can be written.
        low: function that returns a warning if little space is left on the disk; empty if there is enough.
            Called twice a second, so it must not wait for a disk.

    Raises:
        Trouble: the database can't be used.
    """

    def __init__(
        self,
        database: Database,
        showing: Showing,
        audit: Callable[[], str],
        wall: Callable[[], float] = time.time,
    ) -> None:
        self._database = database
        self._showing = showing
        self._audit = audit
        self._wall = wall
        self._writing: asyncio.Task[None] | None = None
        self._shown: AlarmBar | None = None
        self.low: Callable[[], str] = str
        self.trouble = ""
        self.book = Book(database.now(kept.kept_alarms, MOST))
        showing.alarm = lambda: self.bar

    @property
    def bar(self) -> AlarmBar:
        """The most important alarm, for the status bar of all pages."""
        if self._shown is None or self._shown.version != self.book.version:
            self._shown = bar_of(self.book)
        return self._shown

    # events and checks

    def hear(self, event: events.BaseEvent) -> None:
        """Handle an event of the coordinator. Call this after `showing`, the robot's last known state, has
        been updated by the same event.
        """
        if isinstance(event, events.StateChanged):
            found = told.of_state(event.state, event.why, event.code, event.help)
            self.book.holding("state", found, self._stood, self._wall())
        elif (raised := told.of_event(event)) is not None:
            stood = self._stood(event if isinstance(event, events.Finished) else None)
            self.book.happened(raised, stood, self._wall())
        else:
            return
        self._changed()

    async def watch(self, _: Attached) -> None:
        """Check regularly for alarms while the coordinator is connected."""
        self.book.holding("coordinator", (), self._stood, self._wall())
        state = told.of_state(self._showing.state, self._showing.why)
        self.book.holding("state", state, self._stood, self._wall())
        while True:
            self.look()
            await asyncio.sleep(_LOOKED_EACH)

    def look(self) -> None:
        """Check motors, guard, audit trail and disk once."""
        showing, now = self._showing, self._wall()
        health = showing.heard_health
        if health is not None:
            if not showing.under_way:  # the event at the end of a motion reports a failed motor itself
                motors = told.of_motors(health.motors, showing.why)
                self.book.holding("motors", motors, self._stood, now)
            self.book.holding("guard", told.of_guard(health, showing.state), self._stood, now)
        self.book.holding("audit", told.of_trail(self._audit()), self._stood, now)
        self.book.holding("disk", told.of_disk(self.low()), self._stood, now)
        self.book.holding("alarms", told.of_keeping(self.trouble), self._stood, now)
        self._changed()

    def lost(self) -> None:
        """Record that the coordinator is disconnected."""
        found = told.of_coordinator(self._showing.robot.name)
        self.book.holding("coordinator", found, self._stood, self._wall())
        self._changed()

    def _stood(self, finished: events.Finished | None = None) -> Stood:
        showing = self._showing
        display = showing.display()
        robot = showing.robot
        names = zip(robot.joint_names, display.joints, robot.axis_unit_names, strict=True)
        program = display.under_way if finished is None else finished.name
        return Stood(
            printable(program, MOST_NAME),
            showing.file_of(program),
            display.line if finished is None else finished.line or 0,
            printable(display.command if finished is None else finished.command or "", MOST_NAME),
            tuple((name, value, unit) for name, value, unit in names if value is not None),
            display.flange,
            printable(display.owner or "", MOST_NAME),
        )

    # acknowledgements

    async def acknowledge(self, numbers: tuple[int, ...], by: str) -> int:
        """Acknowledge alarms and return how many of them are newly acknowledged.

        Args:
            numbers: numbers of the alarms.
            by: name of the user.
        """
        count = 0
        for first in range(0, len(numbers), _MOST_AT_ONCE):
            some = numbers[first : first + _MOST_AT_ONCE]
            count += self.book.acknowledge(some, by, self._wall())
            self._changed()
            await asyncio.sleep(0)  # let the streaming loop run between two parts
        return count

    # the file

    def _changed(self) -> None:
        """Schedule a write of the changed alarms."""
        if self.book.changed and (self._writing is None or self._writing.done()):
            with suppress(RuntimeError):  # the event loop doesn't run yet
                self._writing = asyncio.get_running_loop().create_task(self._write())

    async def _write(self) -> None:
        await asyncio.sleep(_TOGETHER)
        while self.book.changed:
            if not await self._written():
                await asyncio.sleep(_AGAIN)

    async def _written(self) -> bool:
        """Write some of the changed alarms. Return False if the file can't be written now."""
        numbers = set(sorted(self.book.changed)[:_MOST_AT_ONCE])
        self.book.changed -= numbers
        found = [one for number in numbers if (one := self.book.get(number)) is not None]
        gone = numbers - {one.number for one in found}
        try:
            await self._database.call(kept.write_alarms, found, gone)
        except asyncio.CancelledError:
            self.book.changed |= numbers
            raise
        except Trouble as trouble:
            self.book.changed |= numbers
            self.trouble = trouble.what
            return False
        self.trouble = ""
        return True

    async def close(self) -> None:
        """Write pending alarms, if the file can be written."""
        if self._writing is not None:
            self._writing.cancel()
            with suppress(asyncio.CancelledError):
                await self._writing
        while self.book.changed and await self._written():
            pass


def bar_of(book: Book) -> AlarmBar:
    """Return the most important alarm, for the status bar of all pages."""
    alarm, count = book.foremost(), book.open_count
    if alarm is None:
        return AlarmBar(number=0, code="", text="", holds=False, open=count, version=book.version)
    raised = alarm.raised
    return AlarmBar(
        number=alarm.number,
        code=raised.code,
        text=raised.what,
        holds=alarm.holds,
        open=count,
        version=book.version,
    )
