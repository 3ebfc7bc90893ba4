"""The coordinator: owns one robot, takes commands and programs, plans from where the robot really stands, moves, and tells.

Everything runs in one event loop; `plan` may hand planning to a thread. docs/coordinator.md shows it in use.
"""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from itertools import chain, count
from pathlib import Path
from typing import Any

from yarclang.coordinator import events
from yarclang.coordinator.client import Client
from yarclang.coordinator.engine import Engine
from yarclang.coordinator.history import History, stands_there
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.mailbox import CAPACITY
from yarclang.coordinator.offers import Planner
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.ownership import Ownership
from yarclang.coordinator.subscription import Subscription
from yarclang.robot.model import Array, Robot
from yarclang.runtime.feedback import Sample
from yarclang.runtime.inspection import Inspection
from yarclang.runtime.notices import Abort, Changed, Hold, Notice, Progress, Remark, Stop
from yarclang.runtime.rest import stands_at
from yarclang.runtime.state import State

POSITIONS_EACH = 0.02
"""Time between two positions that are told [s]: 50 Hz, if the link allows."""

Planning = Callable[..., Awaitable[Any]]
"""Calls a function with arguments somewhere and gives what it gives."""


class Coordinator:
    """Owns one robot. Clients attach to it; one of them may move the robot, all of them may watch, and stop it.

    Args:
        robot: whose.
        session: the connection to its controller.
        folder: where modules, cells and yarc.toml are looked for.
        tm: longest segment time of what is planned [ms]; None: the robot's.
        cell: the path of a cell.toml that all motions keep to; None: that of yarc.toml, if it names one.
        log: where motions are logged (`Engine`).
        plan: where planning is done; None: in a thread, so that a long program doesn't keep anybody from stopping the robot.

    Attributes:
        engine: the task that talks to the controller.
        planner: makes offers.
        lines: the declarations of the session.
        history: what it has done.
        stops: how often somebody wanted a stop or an abort: what was asked for before doesn't begin any more.
    """

    def __init__(
        self,
        robot: Robot,
        session: OrderedSession,
        *,
        folder: Path,
        tm: float | None = None,
        cell: str | None = None,
        log: Path | None = None,
        plan: Planning | None = None,
    ) -> None:
        self.robot = robot
        self.engine = Engine(robot, session, log, self._bug)
        self.planner = Planner(robot, folder, tm, cell)
        self.lines = Lines()
        self.history = History(robot)
        self.plan = plan or self.engine.beside
        self.numbers = count(1)
        self.position: Array | None = None
        self.stops = 0
        self._session = session
        self._ownership = Ownership()
        self._clients: dict[str, Client] = {}
        self._subscriptions: list[Subscription] = []
        session.operation.positions_each = POSITIONS_EACH * session.pace
        session.listen(self._hear)

    # from beginning to end

    async def start(self) -> Inspection:
        """Connect to the controller, look at everything, and be at work from now on.

        Raises:
            Trouble: it can't be reached, or isn't what the robot needs (`NotReady`).
        """
        return await self.engine.start()

    async def close(self) -> None:
        """Bring the robot to rest on its path, end the connection, and all event streams."""
        await self.engine.close()
        for one in tuple(self._subscriptions):
            one.close()

    async def __aenter__(self) -> Coordinator:
        await self.start()
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    # who is there

    def attach(self, name: str) -> Client:
        """Somebody new, who watches at first.

        Args:
            name: what others know the client by; where it is taken, a number is added.
        """
        wanted = name or "client"
        names = chain([wanted], (f"{wanted}-{number}" for number in count(2)))
        free = next(one for one in names if one not in self._clients)
        client = Client(self, free)
        self._clients[free] = client
        return client

    def detach(self, name: str) -> None:
        """Somebody has gone; who owned the robot leaves it at rest, on its path, and to nobody."""
        self._clients.pop(name, None)
        if self.owner == name:
            self.stop()
            self._ownership.owner = ""
            self._tell(events.OwnerChanged(self.now, ""))

    @property
    def owner(self) -> str:
        """Who may move the robot; empty: nobody does."""
        return self._ownership.owner

    @property
    def clients(self) -> tuple[str, ...]:
        """Who is there."""
        return tuple(self._clients)

    def own(self, name: str) -> None:
        """Somebody owns the robot from now on.

        Raises:
            NotOwner: somebody else does.
        """
        if self._ownership.take(name):
            self._tell(events.OwnerChanged(self.now, name))

    def give(self, name: str, to: str) -> None:
        """The owner gives the robot to somebody, or (empty) to nobody.

        Raises:
            NotOwner: it isn't theirs, or nobody is called so.
        """
        self._ownership.give(name, to, self.clients)
        self._tell(events.OwnerChanged(self.now, to))

    def check_owner(self, name: str, what: str) -> None:
        """Whether somebody may do what is for the owner.

        Raises:
            NotOwner: no.
        """
        self._ownership.check(name, what)

    # what is known

    @property
    def now(self) -> float:
        """The session's clock [s]."""
        return self.engine.operation.now

    @property
    def state(self) -> State:
        """What the robot does."""
        return self.engine.operation.state

    @property
    def under_way(self) -> str:
        """What is carried out; empty: nothing is."""
        return self.engine.under_way

    @property
    def override(self) -> float:
        """Percent of the programmed speed."""
        return self.engine.operation.override * 100.0

    async def stands(self) -> Array:
        """(n,) where the robot is commanded to stand [rad or m], asked now: the planned end of its last motion, where it has ended there to a count.

        Raises:
            Trouble: it is under way, or can't be asked.
        """
        here = await self.commanded()
        known = self.history.end
        return known if known is not None and stands_there(self.robot, here, known) else here

    async def commanded(self) -> Array:
        """(n,) where the controller commands the motors to stand [rad or m], asked now, as exactly as its registers tell it.

        Raises:
            Trouble: as `stands`.
        """
        operation, robot = self.engine.operation, self.robot
        return await self.engine.ask(lambda: stands_at(operation, robot))

    # orders, for everybody

    def stop(self) -> None:
        """Come to rest on the path, and end what is under way. Overtakes everything."""
        self.stops += 1
        self._order(Stop())

    def abort(self) -> None:
        """Each motor comes to rest at once, off the path; what is under way is ended."""
        self.stops += 1
        self._order(Abort())

    def hold(self) -> None:
        """Come to rest on the path, ready to go on."""
        self._order(Hold())

    def _order(self, order: Stop | Abort | Hold) -> None:
        if self.under_way or self._session.paused:
            self._session.order(order)

    # who listens

    def subscribe(self, capacity: int = CAPACITY) -> Subscription:
        """All events from now on. Whoever doesn't take them costs nothing but `capacity` events."""
        one = Subscription(capacity, self._subscriptions.remove)
        self._subscriptions.append(one)
        return one

    def tell(self, text: str, *, warning: bool = False) -> None:
        """Tell everybody something."""
        self._tell(events.Message(self.now, text, warning))

    def announce(self, event: events.Event) -> None:
        """Tell everybody an event."""
        self._tell(event)

    def _tell(self, event: events.Event) -> None:
        for one in tuple(self._subscriptions):
            one.put(event)

    def _hear(self, notice: Notice) -> None:
        match notice:
            case Changed(time=time, state=state, why=why):
                self._tell(events.StateChanged(time, state, why))
            case Progress(time=time, done=done, left=left, command=command, source_line=line):
                self._tell(events.ProgressMade(time, done, left, command, line))
            case Remark(time=time, text=text, warning=warning):
                self._tell(events.Message(time, text, warning))
            case Sample():
                self.position = notice.joints(self.robot)
                self._tell(events.Position(notice.time, self.position, notice.program_time))

    def _bug(self, error: BaseException) -> None:
        self.tell(f"a bug of yarclang has ended what was under way: {error!r}; report it", warning=True)
