"""A run over a real connection: drives the scripts with a socket and a clock, and tells those who watch.

The only module of the runtime, with `transports/`, that knows time and the network.
"""

from __future__ import annotations

import asyncio
import math
import os
from collections.abc import Awaitable, Callable
from typing import TypeVar

from yarclang.runtime.actions import Connect, Connected, Outcome, Script, Unreachable, Wait
from yarclang.runtime.messages import Event, Late, Request, Violation
from yarclang.runtime.notices import Abort, Fail, Notice, Order, Stop
from yarclang.runtime.operation import ABORT_ALL, HOLD_ALL, LONGEST_SLEEP, Operation
from yarclang.runtime.protocol import Connection
from yarclang.runtime.state import State
from yarclang.runtime.transports.tcp import Wire, connect

T = TypeVar("T")
Listener = Callable[[Notice], None]
Connector = Callable[[str, int, float], Awaitable[Wire]]
"""Makes a connection: to a host and a port, within a time [s]."""

REPLY_TIME = 1.0
"""A reply that takes longer is lost [s]."""

_TURN = 0.005

CONNECT_TIME = 5.0
"""A connection that takes longer can't be made [s]."""


class Session:
    """One controller, and one script at a time.

    Args:
        host: of the controller.
        port: likewise.
        reply_time: after so long a reply is lost [s].
        pace: how fast the controller's time passes: 1, but for a simulator.
        connector: makes connections; TCP, but where a controller lives in this very process.
        leash: how far the controller's time goes at most while nothing is asked [s], of a simulator that waits for this process
            (`yarclang.simulator.leash`); None: it waits for nobody.
    """

    def __init__(
        self,
        host: str,
        port: int,
        *,
        reply_time: float = REPLY_TIME,
        pace: float = 1.0,
        connector: Connector = connect,
        leash: float | None = None,
    ) -> None:
        self.host = host
        self.port = port
        self.pace = pace
        self.operation = Operation()
        self.operation.longest_sleep = max(LONGEST_SLEEP, reply_time + 1.0) * pace
        self._leash = math.inf if leash is None else leash
        self.operation.behind = 0.0 if leash is None else 2.0 * leash  # each end leaves time out by itself
        self._most = math.inf
        self._left_out = 0.0
        self._reply_time = reply_time
        self.connector = connector
        self._listeners: list[Listener] = []
        self._woken = asyncio.Event()
        self._wire: Wire | None = None
        self._connection = Connection()

    def listen(self, listener: Listener) -> None:
        """Call a function with each notice from now on. It must not wait."""
        self._listeners.append(listener)

    def unlisten(self, listener: Listener) -> None:
        """Call a function no more; nothing where it isn't called."""
        if listener in self._listeners:
            self._listeners.remove(listener)

    def order(self, order: Order) -> None:
        """Something that a person wants, at once."""
        self.operation.orders.append(order)
        self.wake()

    def wake(self) -> None:
        """End the wait of the script that is carried out, if it waits: there is something to look at."""
        self._woken.set()

    async def perform(self, script: Script[T]) -> T:
        """Carry a script out.

        Returns:
            What it gives.

        Raises:
            Trouble: as the script does.
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
                    case _:
                        outcome = await self._exchange(action)
        finally:
            self._most = math.inf

    async def order_given(self, kind: type[Order]) -> None:
        """Wait, with nothing moving, until an order of a kind is given; a stop or an abort ends the wait, too, and stays."""
        orders = self.operation.orders
        while not any(isinstance(order, kind | Stop | Abort) for order in orders):
            self._woken.clear()
            await self._woken.wait()
        if not any(isinstance(order, Stop | Abort) for order in orders):
            orders.clear()

    def close(self) -> None:
        """End the connection; if something still moves, hold it."""
        if self._wire is not None:
            self._last_words()
            self._wire.close()
            self._wire = None

    def now(self) -> float:
        """Return the host's clock, at the controller's pace [s]. On a leash, the time is left out in which this process was kept from its work."""
        return min(self._passed() - self._left_out, self._most)

    def _passed(self) -> float:
        """Return the host's clock with nothing left out [s]."""
        return asyncio.get_running_loop().time() * self.pace

    def _step(self) -> float:
        """Return the time of a script's next step [s]; until the one after it no more than the leash passes."""
        now = self.now()
        self._left_out = self._passed() - now
        self._most = now + self._leash
        return now

    def _later(self, delay: float, event: asyncio.Event) -> asyncio.TimerHandle:
        """Set an event after a time of that clock [s]."""
        return asyncio.get_running_loop().call_later(max(0.0, delay) / self.pace, event.set)

    def _tell(self) -> None:
        notices = self.operation.notices
        while notices:
            notice = notices.popleft()
            for listener in tuple(self._listeners):
                try:
                    listener(notice)
                except Exception as error:
                    # whoever only watches must not leave a moving robot to itself
                    self._listeners.remove(listener)
                    self.order(
                        Fail(f"what watches this run has failed: {error!r}", "this is a bug: report it")
                    )

    async def _wait(self, until: float) -> None:
        """Until a time, or until somebody orders something."""
        self._woken.clear()
        now = self.now()
        if until <= now:
            await asyncio.sleep(0)
            return
        self._most = until + self._leash  # who waits isn't kept from anything
        timer = self._later(until - now, self._woken)
        await self._woken.wait()
        timer.cancel()

    async def _connect(self) -> Outcome:
        self.close()
        self._connection = Connection()
        try:
            self._wire = await self.connector(self.host, self.port, CONNECT_TIME)
        except OSError as error:
            reason = os.strerror(error.errno) if error.errno and error.errno > 0 else str(error)
            return Unreachable(f"{self.host}:{self.port} can't be reached: {reason.lower()}")
        return Connected()

    async def _exchange(self, request: Request) -> Event:
        """A request, and the event that ends it."""
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
                # a process that has slept past the deadline finds its reply only in the next turn of the loop
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
        """What is said on a connection whose replies can't be trusted any more: hold, or abort if that was asked for."""
        if self._wire is None or self.operation.state not in (State.MOVE, State.HOLD):
            return
        self._wire.send(Connection().last_words(ABORT_ALL if Abort() in self.operation.orders else HOLD_ALL))
