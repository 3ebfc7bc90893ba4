"""A robot that several clients share: ownership, state, execution, subscriptions."""

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
"""Time between two reported positions [s]: 50 Hz, if the connection is fast enough."""

_SAME_PACE = 1e-6
"""Largest difference of overrides that count as equal [percent]."""


class SharedRobot:
    """The robot that clients share. One client may move the robot; all clients may watch and stop it.

    Args:
        robot: the robot.
        session: connection to its controller.
        folder: folder that contains modules, cells and yarc.toml.
        tm: longest segment time of planned motions [ms]; None: that of the robot.
        cell: path of a cell.toml for all motions; None: the one that yarc.toml names, if any.
        log: file or folder in which motions are logged (`Engine`).
        name: name that `yarc status` shows while nothing is in progress.
        simulated: True if the controller is yarclang's simulator.
        serves: True if the coordinator serves other processes.
        surroundings: machines around a robot that is simulated in this process; None: the robot isn't
            simulated here.
        patient: True to run also while the controller can't be reached, or isn't in the state that the robot
            needs. Nothing can move in the meantime.
        first: number of the first program and of the first offer; the numbers count up from it.
        plan: runs planning functions; None: in a thread, so that planning a long program doesn't delay a
            stop.

    Attributes:
        engine: the task that communicates with the controller.
        carrying: executes all motions, and keeps track of the cell's parts.
        planner: creates offers.
        lines: declarations of the session.
        history: actions of the session.
        names: looks up frames and signals by name, as the session's lines declare them.
        around: the cell, and inputs and outputs by name.
        scenes: descriptions of robot and cell, for programs that draw them.
        stops: number of stops and aborts so far. A request that was made before the last stop or abort isn't
            carried out any more.
        rests: number of stops, aborts and holds so far. After one of them, a steering client can't restart
            the robot by just sending further targets.
        why: reason for the robot's present state.
        progress: last reported progress of a program.
        sample: last reported position of the motors.
        behind: duration of the rest of the program after the current job, without waits, at an override of
            100 % [s].
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
        """Return the path of the cell.toml that applies to all motions; None if a cell can be named only by a
        CELL line.
        """
        cell = self.planner.cell
        return None if cell is None else str(Path(cell.source.name).absolute())

    # clients

    def enter(self, name: str) -> str:
        """Add a client.

        Args:
            name: name of the client that others see; a number is added if the name is taken.

        Returns:
            The client's name.
        """
        wanted = name or "client"
        names = chain([wanted], (f"{wanted}-{number}" for number in count(2)))
        free = next(one for one in names if one not in self._clients)
        self._clients.append(free)
        return free

    def detach(self, name: str) -> None:
        """Remove a client. If this client owned the robot, the robot comes to rest on its path, and then
        has no owner.
        """
        if name in self._clients:
            self._clients.remove(name)
        if self.owner == name:
            self.stop()
            self._ownership.owner = ""
            self._tell(events.OwnerChanged(time_s=self.time, owner=None))

    @property
    def owner(self) -> str:
        """Return the name of the owner; empty if there is none."""
        return self._ownership.owner

    @property
    def clients(self) -> tuple[str, ...]:
        """Return the names of all clients."""
        return tuple(self._clients)

    def own(self, name: str, *, shared: bool = False) -> None:
        """Give the robot to a client. With `shared`, other clients may also resume and change the override.

        Raises:
            NotOwner: another client owns the robot.
        """
        if self._ownership.take(name, shared=shared):
            if not self.under_way:
                self.engine.close_log()  # each owner has a log of its own
            self._tell(events.OwnerChanged(time_s=self.time, owner=name))

    def give(self, name: str, to: str) -> None:
        """Hand the robot from its owner `name` to another client `to`, or to nobody if `to` is empty.

        Raises:
            NotOwner: `name` doesn't own the robot, or there is no client `to`.
        """
        self._ownership.give(name, to, self.clients)
        self._tell(events.OwnerChanged(time_s=self.time, owner=to or None))

    def check_owner(self, name: str, action: str) -> None:
        """Check that a client may give an order that only the owner may give.

        Raises:
            NotOwner: the client doesn't own the robot.
        """
        self._ownership.check(name, action)

    def check_pace(self, name: str, action: str) -> None:
        """Check that a client may resume, and change the override.

        Raises:
            NotOwner: the client isn't allowed to.
        """
        self._ownership.check_pace(name, action)

    # state

    @property
    def now(self) -> float:
        """Return the session's clock [s]."""
        return self.engine.operation.now

    @property
    def time(self) -> float:
        """Return the session's clock, rounded like the times of events [s]."""
        return round(self.now, 4)

    @property
    def paused(self) -> bool:
        """Return True if the robot stands between two commands that are carried out one by one."""
        return self._session.paused

    @property
    def waiting(self) -> int:
        """Return the number of orders that weren't processed yet."""
        return len(self.engine.operation.orders)

    @property
    def address(self) -> str:
        """Return the address of the controller, HOST:PORT."""
        return f"{self._session.host}:{self._session.port}"

    @property
    def inspection(self) -> Inspection | None:
        """Return the last inspection of the controller; None: none yet."""
        return self.engine.inspection

    @property
    def state(self) -> State:
        """Return the state of the robot."""
        return self.engine.operation.state

    @property
    def under_way(self) -> str:
        """Return the name of the action in progress; empty: none."""
        return self.engine.under_way

    @property
    def override(self) -> float:
        """Return the override in percent of the programmed speed."""
        return self.engine.operation.override * 100.0

    async def stands(self) -> Array:
        """Request and return the robot's commanded position (n,) [rad or m].

        If this position is within one count of the last motion's planned end, the planned end is returned.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        here = await self.commanded()
        known = self.history.end
        return known if known is not None and stands_there(self.robot, here, known) else here

    async def commanded(self) -> Array:
        """Request and return the motors' commanded position (n,) [rad or m], with the precision of the
        controller's registers.

        Raises:
            Trouble: the robot is moving, or there is no connection.
        """
        operation, robot = self.engine.operation, self.robot
        return await self.engine.ask(lambda: self.engine.scripts.stands_at(operation, robot))

    # execution

    async def plan(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Run a slow planning function. Only one runs at a time: several of them would delay the task that
        streams.
        """
        async with self._planning:
            return await self._plan(function, *arguments)

    async def look_around(self, *, waits: bool = True) -> int:
        """Read the cell again if one of its files has changed, so that later plans respect the change.
        Earlier offers become invalid.

        Args:
            waits: if True, wait for planning in progress; otherwise do nothing while planning is in progress.

        Returns:
            The planner's `generation`, which grows each time the cell is read.
        """
        if not waits and self._planning.locked():
            return self.planner.generation
        if await self.plan(self.planner.renewed):
            self.lines.doubt()
        return self.planner.generation

    async def beside(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Run a function in the same way as `plan`, but don't wait for planning in progress."""
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
        """Carry work out, unless there was a stop after it was requested.

        Args:
            client: client that orders the work.
            name: name of the work, for messages.
            lasting: duration of the work.
            work: function that moves the robot.
            stops: value of `stops` when the work was requested.
            serves: True if the work may be done after a fault (`Engine.move`).

        Raises:
            Trouble: something else is in progress, or the robot's state forbids it.
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

    # orders from any client

    def stop(self) -> None:
        """Bring the robot to rest on its path, and end the current action. A stop is executed before all
        waiting orders.
        """
        self.stops += 1
        self._order(Stop())

    def abort(self) -> None:
        """Bring each motor to rest at once, off the path, and end the current action."""
        self.stops += 1
        self._order(Abort())

    def hold(self) -> None:
        """Bring the robot to rest on its path, ready to continue."""
        self._order(Hold())

    def _order(self, order: Stop | Abort | Hold) -> None:
        self.rests += 1
        if self.under_way or self._session.paused:
            self._session.order(order)

    # subscriptions

    def subscribe(
        self,
        capacity: int = CAPACITY,
        *,
        positions: bool = True,
        arrived: Callable[[], object] = lambda: None,
    ) -> Subscription:
        """Return an iterator over all events from now on.

        Args:
            capacity: largest number of events that are stored until the subscriber reads them.
            positions: True if the subscriber wants positions.
            arrived: called when an event has arrived, for a subscriber that doesn't wait for events.
        """
        one = Subscription(capacity, self._subscriptions.remove, positions=positions, told=arrived)
        self._subscriptions.append(one)
        return one

    def tell(
        self, text: str, stopped_by: tuple[str, ...] = (), *, warning: bool = False, code: str | None = None
    ) -> None:
        """Send a remark to all clients.

        Args:
            text: the remark.
            stopped_by: bodies and zones that stop or slow a live motion, if the remark is about this motion.
            warning: True if a user should react.
            code: code of the finding; None if there is none.
        """
        told = events.Told(time_s=self.time, text=text, warning=warning, stopped_by=stopped_by, code=code)
        self._tell(told)

    def tell_override(self) -> None:
        """Inform all clients of the override, if it has changed."""
        if abs(self.override - self._percent) > _SAME_PACE:
            self._percent = self.override
            self._tell(events.OverrideChanged(time_s=self.time, percent=round(self.override, 6)))

    def tell_scene(self) -> None:
        """Inform all clients if the cell around the robot or its parts may have changed."""
        if self.scenes.is_another():
            self._tell(events.SceneChanged(time_s=self.time))

    def announce(self, event: events.BaseEvent) -> None:
        """Send an event to all clients."""
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

    def _bug(self, error: BaseException, place: str) -> None:
        rests = f"; {place}" if place else ""
        text = f"a bug of yarclang has ended the current motion: {error!r}{rests}; report it"
        self.tell(text, warning=True, code="Y2001")
