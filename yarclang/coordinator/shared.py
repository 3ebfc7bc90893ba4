"""A robot that several clients share: who may move it, what is known of it, what is carried out, who listens."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import asdict
from datetime import datetime
from itertools import chain, count
from pathlib import Path
from typing import Any

from yarclang.coordinator.around import Around
from yarclang.coordinator.carrying import Carrying, Planning
from yarclang.coordinator.describing import finished, joints_by_name
from yarclang.coordinator.engine import Engine
from yarclang.coordinator.history import History, stands_there
from yarclang.coordinator.lines import Lines
from yarclang.coordinator.mailbox import CAPACITY
from yarclang.coordinator.messages import events
from yarclang.coordinator.messages.message import Question
from yarclang.coordinator.names import Names
from yarclang.coordinator.offers import Planner
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.ownership import Ownership
from yarclang.coordinator.scene import Scenes
from yarclang.coordinator.signals import signal_event
from yarclang.coordinator.subscription import Subscription
from yarclang.coordinator.values import Values, wanted_message
from yarclang.lasting import Lasting
from yarclang.robot.model import Array, Robot
from yarclang.runtime.inspection import Inspection
from yarclang.runtime.notices import (
    Abort,
    Changed,
    Hold,
    Notice,
    Progress,
    Reached,
    Remark,
    Stop,
    ValuesWanted,
)
from yarclang.runtime.outcome import Ended
from yarclang.runtime.sample import Sample
from yarclang.runtime.signals import InputChanged, OutputSet, WaitBegan, WaitEnded
from yarclang.runtime.state import State
from yarclang.simulated_cell.playing import SimulatedCell

POSITIONS_EACH = 0.02
"""Time between two positions that are told [s]: 50 Hz, if the link allows."""

_SAME_PACE = 1e-6
"""Percent."""


class SharedRobot:
    """One robot as its clients see it; one of them may move the robot, all of them may watch, and stop it.

    Args:
        robot: whose.
        session: the connection to its controller.
        folder: where modules, cells and yarc.toml are looked for.
        tm: longest segment time of what is planned [ms]; None: the robot's.
        cell: the path of a cell.toml that all motions keep to; None: that of yarc.toml, if it names one.
        log: where motions are logged (`Engine`).
        name: what `yarc status` calls it while nothing is under way.
        simulated: whether the controller is a simulator of our own.
        serves: whether it is there to serve other processes.
        surroundings: the machines around a robot that is simulated in this process; None: it isn't.
        patient: whether it is there also while the controller can't be reached, or isn't what the robot needs: nothing moves then.
        first: the first number of a program or an offer.
        plan: where planning is done; None: in a thread, so that a long program doesn't keep anybody from stopping the robot.

    Attributes:
        engine: the task that talks to the controller.
        carrying: performs what moves the robot, and keeps where the parts of the cell are.
        planner: makes offers.
        lines: the declarations of the session.
        history: what it has done.
        names: what names mean behind them.
        around: the cell, and inputs and outputs by name.
        scenes: what robot and cell are for programs that draw them.
        stops: how often somebody wanted a stop or an abort: what was asked for before doesn't begin any more.
        rests: how often somebody wanted a stop, an abort or a hold: who steers doesn't begin anew by going on.
        why: the reason of the robot's last state.
        progress: what was told last of how far a program is.
        sample: where the motors were heard last.
        behind: the known time of the program after the part that is carried out, at full pace [s].
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
        name: str = "",
        simulated: bool = False,
        serves: bool = False,
        surroundings: SimulatedCell | None = None,
        plan: Planning | None = None,
        patient: bool = False,
        first: int = 1,
    ) -> None:
        self.robot = robot
        self.name = name
        self.simulated = simulated
        self.serves = serves
        self.surroundings = surroundings
        self.since = datetime.now().astimezone().isoformat(timespec="seconds")
        self.engine = Engine(robot, session, log, self._bug)
        self.carrying = Carrying(robot, self.engine, self.plan, self.beside)
        self.planner = Planner(robot, folder, tm, cell, self.carrying.kept.now_for_lines)
        self.lines = Lines()
        self.names = Names(self.lines, self.planner)
        self.around = Around(self.names, self.lines)
        self.scenes = Scenes(robot, self.engine, self.lines, self.around, self.carrying.kept)
        self.history = History(robot)
        self._planning = asyncio.Lock()
        self._plan = plan or self.engine.beside
        self.numbers = count(first)
        self.position: Array | None = None
        self.sample: Sample | None = None
        self.stops = 0
        self.rests = 0
        self.why = ""
        self.asks: Question | None = None
        self.values = Values(session, lambda: bool(self.engine.under_way))
        self.progress: events.ProgressMade | None = None
        self.behind = 0.0
        self._percent = 100.0
        self._session = session
        self._patient = patient
        self._ownership = Ownership()
        self._clients: list[str] = []
        self._subscriptions: list[Subscription] = []
        session.operation.positions_each = POSITIONS_EACH * session.pace
        session.listen(self._hear)

    @property
    def cell(self) -> str | None:
        """The path of the cell.toml that all motions keep to; None if only a CELL line can name one."""
        cell = self.planner.cell
        return None if cell is None else str(Path(cell.source.name).absolute())

    # who is there

    def enter(self, name: str) -> str:
        """Let somebody new be there.

        Args:
            name: what others shall know the client by; where it is taken, a number is added.

        Returns:
            The client's name.
        """
        wanted = name or "client"
        names = chain([wanted], (f"{wanted}-{number}" for number in count(2)))
        free = next(one for one in names if one not in self._clients)
        self._clients.append(free)
        return free

    def detach(self, name: str) -> None:
        """Somebody has gone; who owned the robot leaves it at rest, on its path, and to nobody."""
        if name in self._clients:
            self._clients.remove(name)
        if self.owner == name:
            self.stop()
            self._ownership.owner = ""
            self._tell(events.OwnerChanged(time_s=self.time, owner=None))

    @property
    def owner(self) -> str:
        """Who may move the robot; empty: nobody does."""
        return self._ownership.owner

    @property
    def clients(self) -> tuple[str, ...]:
        """Who is there."""
        return tuple(self._clients)

    def own(self, name: str, *, shared: bool = False) -> None:
        """Somebody owns the robot from now on; `shared`: others may resume and change the pace as well.

        Raises:
            NotOwner: somebody else does.
        """
        if self._ownership.take(name, shared=shared):
            if not self.under_way:
                self.engine.close_log()  # each owner's motions have a log of their own
            self._tell(events.OwnerChanged(time_s=self.time, owner=name))

    def give(self, name: str, to: str) -> None:
        """The owner gives the robot to somebody, or (empty) to nobody.

        Raises:
            NotOwner: it isn't theirs, or nobody is called so.
        """
        self._ownership.give(name, to, self.clients)
        self._tell(events.OwnerChanged(time_s=self.time, owner=to or None))

    def check_owner(self, name: str, what: str) -> None:
        """Whether somebody may do what is for the owner.

        Raises:
            NotOwner: no.
        """
        self._ownership.check(name, what)

    def check_pace(self, name: str, what: str) -> None:
        """Check whether somebody may resume, and change the pace.

        Raises:
            NotOwner: no.
        """
        self._ownership.check_pace(name, what)

    # what is known

    @property
    def now(self) -> float:
        """The session's clock [s]."""
        return self.engine.operation.now

    @property
    def time(self) -> float:
        """The same, as events tell it."""
        return round(self.now, 4)

    @property
    def paused(self) -> bool:
        """Whether the robot stands between two commands that are carried out one by one."""
        return self._session.paused

    @property
    def waiting(self) -> int:
        """Orders that weren't looked at yet."""
        return len(self.engine.operation.orders)

    @property
    def address(self) -> str:
        """Of the controller, HOST:PORT."""
        return f"{self._session.host}:{self._session.port}"

    @property
    def inspection(self) -> Inspection | None:
        """What was found when the controller was looked at last; None: it wasn't yet."""
        return self.engine.inspection

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
        return await self.engine.ask(lambda: self.engine.scripts.stands_at(operation, robot))

    # what is carried out

    async def plan(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call a function that takes long where planning is done, one at a time: many of them would keep the task that streams from its work."""
        async with self._planning:
            return await self._plan(function, *arguments)

    async def look_around(self, *, waits: bool = True) -> int:
        """Read the cell again if a file of it has changed, so that what is planned from now on keeps to it; offers made before don't hold then.

        Args:
            waits: whether this waits for what is planned just now; else nothing is looked at meanwhile.

        Returns:
            The planner's generation.
        """
        if not waits and self._planning.locked():
            return self.planner.generation
        if await self.plan(self.planner.renewed):
            self.lines.doubt()
        return self.planner.generation

    async def beside(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call a function where planning is done, without waiting for what is planned."""
        return await self._plan(function, *arguments)

    async def carry_out(
        self,
        client: str,
        name: str,
        lasting: Lasting,
        work: Callable[[], Awaitable[Ended]],
        stops: int,
        *,
        serves: bool = False,
    ) -> Ended:
        """Carry work out, unless somebody has wanted a stop since there were so many `stops`.

        Args:
            client: who wants it.
            name: what people call it.
            lasting: how long it takes.
            work: moves the robot.
            stops: as they were counted when it was asked for.
            serves: whether it may be done behind a fault (`Engine.move`).

        Raises:
            Trouble: something else is under way, or the state forbids it.
        """

        async def told() -> Ended:
            if self.stops != stops:
                return Ended(False, "stopped before it began; nothing moved")
            began = events.Began(
                time_s=self.time,
                name=name,
                duration_s=round(lasting.most, 4),
                waits=lasting.waits,
                client=client,
            )
            if self.surroundings is not None:
                self.surroundings.begin()
            self._tell(began)
            self.scenes.begin()
            self.behind = 0.0
            self.engine.client = client
            ended = await work()
            self.scenes.begin()
            self._tell(finished(self.time, name, ended, self.robot))
            self.tell_scene()
            return ended

        return await self.engine.move(name, told, serves=serves)

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
        self.rests += 1
        if self.under_way or self._session.paused:
            self._session.order(order)

    # who listens

    def subscribe(
        self,
        capacity: int = CAPACITY,
        *,
        positions: bool = True,
        arrived: Callable[[], object] = lambda: None,
    ) -> Subscription:
        """Return all events from now on. Whoever doesn't take them costs nothing but `capacity` events.

        Args:
            capacity: events that wait at most.
            positions: whether positions are wanted.
            arrived: called when an event has arrived, for whoever doesn't wait for it.
        """
        one = Subscription(capacity, self._subscriptions.remove, positions=positions, told=arrived)
        self._subscriptions.append(one)
        return one

    def tell(
        self, text: str, stopped_by: tuple[str, ...] = (), *, warning: bool = False, code: str | None = None
    ) -> None:
        """Tell everybody something.

        Args:
            text: what.
            stopped_by: the bodies and zones by which a live motion is stopped, if it says that.
            warning: True if somebody should look at it.
            code: of the finding that it is; None: it is none.
        """
        told = events.Told(time_s=self.time, text=text, warning=warning, stopped_by=stopped_by, code=code)
        self._tell(told)

    def tell_override(self) -> None:
        """Tell everybody the pace, if it is another one now."""
        if abs(self.override - self._percent) > _SAME_PACE:
            self._percent = self.override
            self._tell(events.OverrideChanged(time_s=self.time, percent=round(self.override, 6)))

    def tell_scene(self) -> None:
        """Tell everybody if what is around the robot may be something else now."""
        if self.scenes.is_another():
            self._tell(events.SceneChanged(time_s=self.time))

    def announce(self, event: events.BaseEvent) -> None:
        """Tell everybody an event."""
        self._tell(event)

    def _tell(self, event: events.BaseEvent) -> None:
        for one in tuple(self._subscriptions):
            one.put(event)

    def _hear(self, notice: Notice) -> None:
        time = round(notice.time, 4)
        match notice:
            case Changed(state=state, why=why, code=code, remedy=remedy, asks=asks):
                self.why, self.asks = why, None if asks is None else Question(**asdict(asks))
                changed = events.StateChanged(
                    time_s=time,
                    state=state,
                    why=why,
                    code=code or None,
                    help=remedy or None,
                    asks=self.asks,
                )
                self._tell(changed)
            case ValuesWanted(wanted=wanted):
                if self.surroundings is not None:
                    self.surroundings.wanted(wanted)
                self._tell(events.ValuesAsked(time_s=time, wanted=wanted_message(wanted)))
            case Progress():
                self.progress = events.ProgressMade(
                    time_s=time,
                    done_s=round(notice.done, 4),
                    left_s=round(notice.left, 4),
                    command=notice.command,
                    line=notice.source_line,
                )
                self._tell(self.progress)
                if self.surroundings is not None and notice.command:
                    self.surroundings.reached(notice.command.split(" ", 1)[0])
            case Reached(place=place):
                if self.surroundings is not None:
                    self.surroundings.reached(place)
            case OutputSet(variable=variable, value=value):
                self.scenes.output_set(variable, value, self.position)
                self._tell(signal_event(notice))
            case WaitBegan() | WaitEnded() | InputChanged():
                self._tell(signal_event(notice))
            case Remark(text=text, warning=warning):
                self._tell(events.Told(time_s=time, text=text, warning=warning))
            case Sample():
                self.sample = notice
                self.position = notice.joints(self.robot)
                joints = joints_by_name(self.robot, self.position)
                done = round(notice.reached, 4)
                self._tell(events.Position(time_s=time, joints=joints, done_s=done))
        self.tell_override()
        self.tell_scene()

    def _bug(self, error: BaseException, where: str) -> None:
        rests = f"; {where}" if where else ""
        text = f"a bug of yarclang has ended what was under way: {error!r}{rests}; report it"
        self.tell(text, warning=True, code="Y2001")
