"""Show a running robot in a browser.

The picture follows the messages of the robot's coordinator (the server process that runs its programs), 20
times a second. Users can set inputs. While no coordinator serves the robot, the page waits for one.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable

from yarclang.coordinator.attached import There
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.events import Missed
from yarclang.coordinator.messages.replies import Surroundings
from yarclang.runtime.actions import Trouble
from yarclang.runtime.transports.runs import Run
from yarclang.view.door import Door, opened
from yarclang.view.live_page import LivePage
from yarclang.view.live_parts import LiveParts
from yarclang.view.of_live import Live
from yarclang.view.panel import Order
from yarclang.view.reaching import Place, Whose, read_place

_RATE = 20.0
"""Number of pictures per second while the robot moves."""
_LOOKS_EACH, _LOOKS_EACH_REAL = 0.2, 1.0
"""Time between two requests for inputs and outputs [s], for a simulated and for a real controller."""
_SILENT = 2.0
"""Time without a message after which the robot's position is shown as unknown [s]."""
_AGAIN_EACH = 1.0
"""Time between two attempts to find a robot that no coordinator serves [s]."""


def show_live(whose: Whose, door: Door, ready: Callable[[Door, str], None]) -> None:
    """Serve the picture of a running robot until it is interrupted (KeyboardInterrupt).

    Args:
        whose: which robot to show.
        door: address at which the picture is served; port 0 means any free port.
        ready: called with the actual address and the name of the run when both exist.

    Raises:
        Trouble: no coordinator serves the robot, or the robot's files can't be read.
        PortTakenError: the port is in use, or the address doesn't belong to this machine.
    """
    asyncio.run(_show(whose, door, ready))


class _Link:
    """A connection to a coordinator as a client that only watches, and the first messages that it
    received.
    """

    def __init__(self, run: Run, there: There, around: Surroundings, place: Place) -> None:
        self.run, self.there, self.around, self.place = run, there, around, place

    @classmethod
    async def attach(cls, run: Run) -> _Link:
        """Connect to the coordinator of a run as a client that only watches.

        Raises:
            Trouble: the coordinator can't be reached or has another version, or the robot's files can't be
                read.
        """
        there = await There.attach(run.path, "view")
        try:
            around = await cls._asked(there, run)
            place = await asyncio.to_thread(read_place, there.welcome, around)
        except BaseException:
            await there.leave()
            raise
        return cls(run, there, around, place)

    @staticmethod
    async def _asked(there: There, run: Run) -> Surroundings:
        try:
            return await there.ask(orders.AskSurroundings())
        except Trouble as trouble:
            if there.is_gone:
                raise
            what = f"{run.name} can't be shown: it doesn't give the surroundings of its robot"
            raise Trouble(
                what,
                "it is served by an older yarclang: end that process, and serve the robot with this version",
            ) from trouble

    @property
    def subtitle(self) -> str:
        """Return the source of the robot's messages, for people."""
        welcome = self.there.welcome
        what = "simulated" if welcome.simulated else f"at {welcome.status.controller}"
        return f"{what}, reported by {self.run.name}"


async def _show(whose: Whose, door: Door, ready: Callable[[Door, str], None]) -> None:
    link = await _Link.attach(await asyncio.to_thread(whose.first))
    loop = asyncio.get_running_loop()
    given: asyncio.Queue[Order] = asyncio.Queue()

    def give(order: Order) -> None:  # runs in a thread of the server
        with contextlib.suppress(RuntimeError):  # the event loop has ended
            loop.call_soon_threadsafe(given.put_nowait, order)

    try:
        with opened(door) as server:
            page = LivePage(server, give)
            ready(Door(door.host, server.get_port()), link.run.name)
            while True:
                try:
                    await _Watch(link, page, given).watch()
                except Trouble as trouble:
                    page.lose(trouble.what)
                await link.there.leave()
                link = await _again(whose, link.run, page, given)
    finally:
        await link.there.leave()


async def _again(whose: Whose, before: Run, page: LivePage, given: asyncio.Queue[Order]) -> _Link:
    """Wait until a coordinator serves the robot again, and connect to it."""
    while True:
        try:
            return await _Link.attach(await asyncio.to_thread(whose.again, before))
        except Trouble as trouble:
            page.lose(trouble.what)
        await asyncio.sleep(_AGAIN_EACH)
        while not given.empty():
            page.take(given.get_nowait())


class _Watch:
    """Watches a robot through one connection."""

    def __init__(self, link: _Link, page: LivePage, given: asyncio.Queue[Order]) -> None:
        self._link, self._page, self._given = link, page, given
        self._there = link.there
        self._missed = False
        self._parts: LiveParts | None = None
        self._live = Live(link.place.robot, self._there.welcome.status)

    async def watch(self) -> None:
        """Draw all events of the running robot until the connection ends.

        Raises:
            Trouble: the connection has ended. The message has the reason.
        """
        self._page.attach(self._live, self._link.place, self._link.subtitle)
        self._page.show_around(self._link.around)
        with await self._there.listen() as stream:
            looking = asyncio.create_task(self._look())
            loop = asyncio.get_running_loop()
            due = loop.time()
            try:
                while not looking.done():
                    for event in stream.waiting():
                        self._missed |= isinstance(event, Missed)
                        self._live.hear(event)
                    while not self._given.empty():
                        self._take(self._given.get_nowait())
                    silent = self._there.silence
                    self._page.draw(f"no message was received for {silent:.0f} s" if silent > _SILENT else "")
                    due = max(due + 1.0 / _RATE, loop.time())
                    await asyncio.sleep(due - loop.time())
                looking.result()
            finally:
                looking.cancel()

    async def _look(self) -> None:
        """Request inputs, outputs and the cell repeatedly."""
        each = _LOOKS_EACH if self._there.welcome.simulated else _LOOKS_EACH_REAL
        while True:
            if self._missed:
                self._missed = False
                self._live.look(await self._there.ask(orders.AskStatus()))
            around = await self._there.ask(orders.AskSurroundings())
            if around.cell != self._link.around.cell:
                place = await asyncio.to_thread(read_place, self._there.welcome, around)
                self._page.attach(self._live, place, self._link.subtitle)
            self._link.around = around
            self._page.show_around(around)
            await self._look_for_parts(around)
            await asyncio.sleep(each)

    async def _look_for_parts(self, around: Surroundings) -> None:
        """Request the places of the workpieces from the coordinator.

        While a program runs, they are requested only once: until the program ends, the coordinator doesn't
        know where the program has moved the workpieces.
        """
        parts, is_busy = self._live.parts, self._live.is_under_way
        if parts is None or (is_busy and parts is self._parts) or around.cell is None:
            return
        told = await self._there.ask(orders.AskParts(cell=around.cell))
        if is_busy == self._live.is_under_way and parts is self._live.parts:
            parts.told(told, is_late=is_busy)
            self._parts = parts

    def _take(self, order: Order) -> None:
        if order.kind != "input":
            self._page.take(order)
            return
        wanted = orders.SetInput(name=order.value, value="ON" if order.more else "OFF")
        self._there.send(wanted, lambda trouble: self._page.refuse(order.value, trouble))
