"""Distribution of the robot's state to all pages of a pendant. One client of the coordinator listens for all
pages, and each message is formatted only once.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Awaitable, Callable
from itertools import count

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import events, orders
from yarclang.pendant.messages.display import Beat, Notice
from yarclang.pendant.seats import Attach, Seats
from yarclang.pendant.showing import Showing
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble

EACH = 0.05
"""Time between two messages with the state for the display [s]."""

_HEALTH_EACH = 0.5
_BEATS = 10
"""Number of periods `EACH` between two heartbeats. By the heartbeats, a page knows that this server is
running.
"""

LATE = 3.0
"""Greatest allowed age of the heartbeat in a page's order [s]. An order with an older one was delayed on its
way, and isn't carried out any more.
"""

_AGAIN = 1.0
"""Time between two attempts to reach the coordinator [s]."""

_MOST = 64
"""Largest number of texts that are queued for a page. If there are more, the oldest text is dropped."""


class Page:
    """Queue of a connected page: the newest display, and texts in their order."""

    def __init__(self, session: str) -> None:
        self.session = session
        self._display = ""
        self._texts: list[str] = []
        self._arrived = asyncio.Event()

    def show(self, display: str) -> None:
        """Queue a display. It replaces a display that wasn't sent yet."""
        self._display = display
        self._arrived.set()

    def tell(self, text: str) -> None:
        """Queue a text."""
        self._texts.append(text)
        del self._texts[:-_MOST]
        self._arrived.set()

    async def next(self) -> str:
        """Wait for the next text or display and return it."""
        while True:
            if self._texts:
                return self._texts.pop(0)
            if self._display:
                display, self._display = self._display, ""
                return display
            self._arrived.clear()
            await self._arrived.wait()


class Watched:
    """Client of the coordinator that passes the coordinator's messages to all pages.

    Args:
        robot: the robot.
        attach: attaches new clients to the coordinator.
        seats: the sessions' clients of the coordinator. They are given up when the coordinator is
            disconnected.
        audit: returns the reason why the audit trail can't be written; empty if it can be.

    Attributes:
        showing: the state that all pages display.
    """

    def __init__(self, robot: Robot, attach: Attach, seats: Seats, audit: Callable[[], str]) -> None:
        self.showing = Showing(robot)
        self._attach = attach
        self._seats = seats
        self._audit = audit
        self._attached: Attached | None = None
        self._pages: set[Page] = set()
        self._shown = ""
        self._beaten: deque[tuple[int, float]] = deque(maxlen=16)
        self._works: list[Callable[[Attached], Awaitable[None]]] = []
        self._hearers: list[Callable[[events.BaseEvent], None]] = []
        self._losers: list[Callable[[], None]] = []

    def attend(
        self,
        work: Callable[[Attached], Awaitable[None]],
        hear: Callable[[events.BaseEvent], None],
        lost: Callable[[], None] = lambda: None,
    ) -> None:
        """Register functions for the coordinator's events and for the state of its connection.

        Args:
            work: coroutine that runs while the coordinator is connected, and is cancelled when the connection
                ends.
            hear: called with each event of the coordinator.
            lost: called when the coordinator can't be reached.
        """
        self._works.append(work)
        self._hearers.append(hear)
        self._losers.append(lost)

    @property
    def is_watched(self) -> bool:
        """True if a page is connected."""
        return bool(self._pages)

    @property
    def pages(self) -> int:
        """Number of connected pages."""
        return len(self._pages)

    @property
    def attached(self) -> Attached:
        """The connection of this shared client to the coordinator, for stops and for requests that move
        nothing.

        Raises:
            Trouble: the coordinator can't be reached.
        """
        if self._attached is None:
            what = f"the coordinator of {self.showing.robot.name} can't be reached"
            raise Trouble(what, "inspect the robot; wait, or restart `yarc serve`", "Y1606")
        return self._attached

    def is_fresh(self, beat: int) -> bool:
        """Return True if the heartbeat with this number was sent a short time ago."""
        now = asyncio.get_running_loop().time()
        return any(number == beat and now - sent <= LATE for number, sent in self._beaten)

    def pages_of(self, session: str) -> int:
        """Return the number of a session's connected pages."""
        return sum(page.session == session for page in self._pages)

    def join(self, page: Page) -> None:
        """Start sending all messages to a page."""
        self._pages.add(page)
        page.show(self._shown or self._written())

    def leave(self, page: Page) -> None:
        """Stop sending messages to a page."""
        self._pages.discard(page)

    def notice(self, notice: Notice, session: str = "") -> None:
        """Send a notice to the pages of the session with this id, or to all pages if the id is empty."""
        text = notice.model_dump_json()
        for page in self._pages:
            if not session or page.session == session:
                page.tell(text)

    async def run(self) -> None:
        """Listen until cancelled. Reconnect if the connection to the coordinator is lost."""
        telling = asyncio.create_task(self._tell())
        try:
            while True:
                with contextlib.suppress(Trouble):
                    await self._listen()
                self._attached = None
                self.showing.lost()
                for lose in self._losers:
                    lose()
                await self._seats.leave_all()
                await asyncio.sleep(_AGAIN)
        finally:
            telling.cancel()

    async def start(self) -> None:
        """Attach to the coordinator for the first time.

        Raises:
            Trouble: the coordinator can't be reached.
        """
        self._attached = await self._attach("pendant")

    async def stop(self) -> None:
        """Detach from the coordinator."""
        await self._seats.leave_all()
        if self._attached is not None:
            await self._attached.leave()

    async def _listen(self) -> None:
        robot = self._attached or await self._attach("pendant")
        self._attached = robot
        with await robot.listen() as stream:
            self.showing.welcome(await robot.ask(orders.AskStatus()))
            works = (self._ask_health, *self._works)
            asking = [asyncio.ensure_future(work(robot)) for work in works]
            try:
                async for event in stream:
                    self.showing.take(event)
                    for hear in self._hearers:
                        hear(event)
                    if not isinstance(event, events.Position | events.ProgressMade):
                        text = event.model_dump_json()
                        for page in self._pages:
                            page.tell(text)
            finally:
                for one in asking:
                    one.cancel()

    async def _ask_health(self, robot: Attached) -> None:
        while True:
            with contextlib.suppress(Trouble):
                self.showing.health(await robot.ask(orders.AskHealth()))
            await asyncio.sleep(_HEALTH_EACH)

    async def _tell(self) -> None:
        for number in count(1):
            if number % _BEATS == 0:
                self._beaten.append((number, asyncio.get_running_loop().time()))
                beat = Beat(beat=number).model_dump_json()
                for page in self._pages:
                    page.tell(beat)
            if self._pages:
                text = self._written()
                if text != self._shown:
                    self._shown = text
                    for page in self._pages:
                        page.show(text)
            await asyncio.sleep(EACH)

    def _written(self) -> str:
        return self.showing.display(self._audit()).model_dump_json()
