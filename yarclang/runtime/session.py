"""A session: it runs scripts over a real connection, with a socket and a clock, and informs listeners.

Together with `transports/`, this is the only module of the runtime that uses the clock and the network.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import time
from collections.abc import Awaitable, Callable
from typing import Any, Protocol, TypeVar

from yarclang.runtime.actions import (
    Connect,
    Connected,
    Keep,
    Late,
    Outcome,
    Replan,
    Script,
    Teach,
    Told,
    Unreachable,
    Violation,
    Wait,
)
from yarclang.runtime.notices import Abort, Fail, Notice, Order, Stop
from yarclang.runtime.operation import LONGEST_SLEEP
from yarclang.runtime.scripts import Scripts, scripts_of
from yarclang.runtime.state import State
from yarclang.runtime.transports.tcp import Wire, connect

T = TypeVar("T")
Listener = Callable[[Notice], None]
Connector = Callable[[str, int, float], Awaitable[Wire]]
"""Function that opens a connection to a host and a port, within a time [s]."""


class Leash(Protocol):
    """The clock of a simulator in this process, whose time waits for the session that uses the simulator
    (`yarclang.simulator.network.leash`).

    Attributes:
        until: time up to which the clock may run [s]; None if no session controls the clock.
    """

    until: float | None

    def now(self) -> float:
        """Return the simulator's time [s]."""


_EXCHANGE = 0.02
"""Longest time by which a leashed simulator may advance between two steps of a script, in addition to the
time for which the script waits [s].

In the longest sequence of questions between two restarts of the watchdog, these times add up to less than
half of the watchdog's time.
"""

REPLY_TIME = 1.0
"""Longest time for a reply [s]; if it takes longer, the connection is lost."""

_TURN = 0.005

_LOOK = 0.2
"""Time between two looks at the clock while nothing moves and an order is awaited [s]."""

_SHORTEST = 0.0002
"""Shortest wait [s of the wall clock]."""

PLANNING_TIME = 10.0
"""Longest time for planning and proving while a program runs [s]."""

CONNECT_TIME = 5.0
"""Longest time for connecting [s]."""


def switched_off() -> float:
    """Return for how long this computer was suspended since it was started [s], for example with its lid
    closed; 0 if the operating system doesn't tell.
    """
    if not hasattr(time, "CLOCK_BOOTTIME"):
        return 0.0
    return time.clock_gettime(time.CLOCK_BOOTTIME) - time.clock_gettime(time.CLOCK_MONOTONIC)


class Session:
    """The use of one controller: runs one script at a time.

    Args:
        host: name or address of the controller.
        port: port of the controller.
        reply_time: longest time for a reply [s].
        pace: seconds of the controller per second: 1, except for a simulator.
        connector: function that makes connections: by TCP, except for a controller in this process.
        leash: clock of a simulator whose time waits for this session; the session then uses this clock, too.
            None if the controller doesn't wait for the session.
        scripts: scripts of the controller's kind; None: those of the default kind of a robot.toml.

    Attributes:
        keeper: function that stores the value of a register for later runs; raises OSError if it can't. None:
            nothing is stored.
        teacher: function that stores a robot position, and returns the program line that declares it; raises
            OSError if it can't. None: positions can't be stored here.
        replanner: function that plans what follows a search, or the lines of an OFFSET; None: the program
            isn't known here.
    """

    def __init__(
        self,
        host: str,
        port: int,
        *,
        reply_time: float = REPLY_TIME,
        pace: float = 1.0,
        connector: Connector = connect,
        leash: Leash | None = None,
        scripts: Scripts | None = None,
    ) -> None:
        self.host = host
        self.port = port
        self.pace = pace
        self.scripts = scripts or scripts_of()
        self.operation = self.scripts.operation()
        self.operation.longest_sleep = max(LONGEST_SLEEP, reply_time + 1.0) * pace
        self._leash = leash
        self._reply_time = reply_time
        self.connector = connector
        self.keeper: Callable[[str, int], None] | None = None
        self.teacher: Callable[[Teach], str] | None = None
        self.replanner: Callable[[Replan], Outcome] | None = None
        self._listeners: list[Listener] = []
        self._woken = asyncio.Event()
        self._wire: Wire | None = None
        self._connection = self.scripts.exchange()
        self._off = switched_off()

    def listen(self, listener: Listener) -> None:
        """Add a listener, which is called with each notice from now on. The listener must not wait."""
        self._listeners.append(listener)

    def unlisten(self, listener: Listener) -> None:
        """Remove a listener. Does nothing if the listener isn't registered."""
        if listener in self._listeners:
            self._listeners.remove(listener)

    def order(self, order: Order) -> None:
        """Give a person's order to the running script, at once."""
        self.operation.orders.append(order)
        self.wake()

    def wake(self) -> None:
        """End the wait of the running script, because something outside of it has changed. Does nothing if
        the script isn't waiting.
        """
        self._woken.set()

    async def perform(self, script: Script[T]) -> T:
        """Run a script to its end: execute the actions that it yields, and send their outcomes back to it.

        Returns:
            The script's result.

        Raises:
            Trouble: as raised by the script.
        """
        operation = self.operation
        outcome: Outcome = None
        try:
            while True:
                operation.now = self._step()
                try:
                    action = script.send(outcome)
                except StopIteration as end:
                    result: T = end.value
                    return result
                finally:
                    self._tell()
                match action:
                    case Wait(until=until):
                        await self._wait(until)
                        outcome = None
                    case Connect():
                        outcome = await self._connect()
                    case Keep(register=register, value=value):
                        outcome = await self._keep(register, value)
                    case Teach():
                        outcome = await self._teach(action)
                    case Replan():
                        outcome = await self._replan(action)
                    case _:
                        outcome = await self._exchange(action)
        finally:
            self._allow(None)

    async def order_given(self, kind: type[Order]) -> None:
        """Wait, with nothing moving, until an order of a given kind comes. A stop or an abort also ends the
        wait, and stays in the queue. Orders that were given while this process was suspended don't count.
        """
        operation, orders = self.operation, self.operation.orders
        operation.now = self.now()
        self._notice_sleep()
        operation.stay_awake()
        while not any(isinstance(order, Stop | Abort) for order in orders):
            operation.now = self.now()
            self._notice_sleep()
            given = [order for order in orders if isinstance(order, kind)]
            if given and not operation.ignores_resume():
                orders.clear()
                return
            for order in given:
                orders.remove(order)
            self._tell()
            self._woken.clear()
            await self._woken_within(_LOOK)

    def close(self) -> None:
        """Close the connection. If something moves, hold the motion first."""
        if self._wire is not None:
            self._last_words()
            self._wire.close()
            self._wire = None

    def now(self) -> float:
        """Return the session's time: the host's clock at the controller's pace [s], or with a leashed
        simulator, the simulator's time.

        A leashed simulator's time doesn't include the time during which this process was prevented from
        working.
        """
        return self._passed() if self._leash is None else self._leash.now()

    def _passed(self) -> float:
        """Return the host's clock at the controller's pace [s], including the time during which this process
        was prevented from working.
        """
        return asyncio.get_running_loop().time() * self.pace

    def _step(self) -> float:
        """Return the time of a script's next step [s], and let a leashed simulator run until `_EXCHANGE`
        after it.
        """
        now = self.now()
        self._allow(now + _EXCHANGE)
        self._notice_sleep()
        return now

    def _notice_sleep(self) -> None:
        """Tell the script if the whole computer was suspended since the last call. The clock of the event
        loop stands still meanwhile. A leashed simulator is suspended with the computer.
        """
        before, self._off = self._off, switched_off()
        if self._leash is None and (self._off - before) * self.pace > self.operation.longest_sleep:
            self.operation.sleep((self._off - before) * self.pace)

    def _allow(self, until: float | None) -> None:
        """Let a leashed simulator run until a time [s], or without limit (None)."""
        if self._leash is not None:
            self._leash.until = until

    def _later(self, delay: float, event: asyncio.Event) -> asyncio.TimerHandle:
        """Set an event after a delay on the session's clock [s]."""
        return asyncio.get_running_loop().call_later(max(0.0, delay) / self.pace, event.set)

    def _tell(self) -> None:
        notices = self.operation.notices
        while notices:
            notice = notices.popleft()
            for listener in tuple(self._listeners):
                try:
                    listener(notice)
                except Exception as error:
                    # Whoever only watches must not leave a moving robot to itself.
                    self._listeners.remove(listener)
                    self.order(
                        Fail(
                            f"an internal observer of this run has failed: {error!r}",
                            "this is a bug: report it",
                        )
                    )

    async def _wait(self, until: float) -> None:
        """Wait until a time, or until an order is given."""
        self._woken.clear()
        if until <= self.now():
            await asyncio.sleep(0)
            return
        self._allow(until + _EXCHANGE)
        while not self._woken.is_set() and (left := until - self.now()) > 0.0:
            # A leashed simulator's clock may be slower than the wall clock: repeat the wait until its time is
            # over.
            await self._woken_within(max(left / self.pace, _SHORTEST))

    async def _woken_within(self, seconds: float) -> None:
        """Wait until this session is woken, but no longer than `seconds` of the wall clock."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(seconds):
                await self._woken.wait()

    async def _keep(self, register: str, value: int) -> Outcome:
        """Store a register's value for later runs. A slow disk delays only the script, nothing else in this
        process.
        """
        if self.keeper is None:
            return None
        try:
            await asyncio.get_running_loop().run_in_executor(None, self.keeper, register, value)
        except OSError as error:
            return str(error)
        return None

    async def _teach(self, request: Teach) -> Outcome:
        """Store a robot position for later runs. A slow disk delays only the script, nothing else in this
        process.
        """
        if self.teacher is None:
            return "positions can be taught only by programs in files"
        try:
            return Told(await asyncio.get_running_loop().run_in_executor(None, self.teacher, request))
        except OSError as error:
            return str(error)

    async def _replan(self, request: Replan) -> Outcome:
        """Have a part of the program planned: the lines of an OFFSET, or what follows a search. The robot
        stands during the planning, and everything else in this process continues.
        """
        if self.replanner is None:
            return None
        planning = asyncio.get_running_loop().run_in_executor(None, self.replanner, request)
        try:
            return await asyncio.wait_for(planning, PLANNING_TIME)
        except TimeoutError:
            return f"planning and proving it takes longer than {PLANNING_TIME:g} s"

    async def _connect(self) -> Outcome:
        self.close()
        self._connection = self.scripts.exchange()
        try:
            self._wire = await self.connector(self.host, self.port, CONNECT_TIME)
        except OSError as error:
            reason = os.strerror(error.errno) if error.errno and error.errno > 0 else str(error)
            return Unreachable(f"{self.host}:{self.port} can't be reached: {reason.lower()}")
        return Connected()

    async def _exchange(self, request: Any) -> Outcome:
        """Send a request, and return the event that ends it."""
        wire, connection = self._wire, self._connection
        if wire is None or connection.lost:
            self._last_words()
            return Violation(request, "there is no connection")
        wire.send(connection.send(request, self._passed(), self._reply_time * self.pace))
        while True:
            timer = self._later((connection.deadline or 0.0) - self._passed(), wire.arrived)
            await wire.arrived.wait()
            timer.cancel()
            data = wire.take()
            events = connection.receive(data, self._passed()) if data else ()
            if not events and wire.closed:
                events = connection.close()
            if not events and not data:
                # After a suspension of this process beyond the deadline, a reply that has come becomes
                # available only in the next turn of the event loop.
                await asyncio.sleep(_TURN)
                data = wire.take()
                now = self._passed()
                events = connection.receive(data, now) if data else connection.check(now)
            if more := connection.outgoing():
                wire.send(more)
            if events:
                break
        event = events[0]
        if isinstance(event, Late | Violation):
            self._last_words()
        return event

    def _last_words(self) -> None:
        """Send a hold, or an abort if one was ordered, on a connection whose replies can't be trusted and
        which is no longer used afterwards. Does nothing if no motion is in progress.
        """
        operation = self.operation
        if self._wire is None or not (operation.searches or operation.state in (State.MOVE, State.HOLD)):
            return
        aborts = operation.searches or Abort() in operation.orders
        self._wire.send(self.scripts.last_words(aborts))
