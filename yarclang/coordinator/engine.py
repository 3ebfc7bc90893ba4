"""The only task that communicates with the controller. It monitors the controller while nothing is in
progress, carries out work, and restores a lost connection.

Other code passes its work to this task. Only orders to stop, hold or resume are given to the session
directly.
"""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Awaitable, Callable, Coroutine
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, TypeVar

from yarclang import __version__
from yarclang.coordinator.ordered import OrderedSession
from yarclang.pipeline.settings import items_of
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Lost, Script, Trouble
from yarclang.runtime.inspection import Inspection, Item
from yarclang.runtime.job import Job
from yarclang.runtime.live import Live
from yarclang.runtime.log import FOLDER, RunLog
from yarclang.runtime.notices import Fail, Stop
from yarclang.runtime.operation import Operation
from yarclang.runtime.outcome import Ended
from yarclang.runtime.scripts import Scripts
from yarclang.runtime.session import Session
from yarclang.runtime.standing import described
from yarclang.runtime.state import Event, State
from yarclang.runtime.transports.promptness import prompt_while_moving, shares_the_interpreter

T = TypeVar("T")

_AGAIN_EACH = 0.5
"""Time between two attempts to restore a lost connection [s]."""

_TRIED, _TRIES = 1.0, 20
"""Longest time for which `retry` waits for a connection [s] (`_TRIED`), and the number of times that it
checks the connection in this time (`_TRIES`).
"""

_RESCUE = 30.0
"""Time limit for bringing the robot to rest after a bug in yarclang [s]."""

_LOST, _BUG = "Y1606", "Y2001"
"""Codes of the findings for a lost connection, and for a bug in yarclang."""

_RETRIED = "it is restored as soon as the controller can be reached: check its cable and power"
"""Remedy for a lost connection."""

UNDER_WAY = "Y1612"
"""Code of the finding for an action that is refused because another one is in progress."""

NO_LOG = Path()
"""Value of the engine's argument `log` that means: write no log."""


class NotReady(Trouble):
    """Raised if the controller isn't in the state that the robot needs; `inspection` has the details."""

    def __init__(self, inspection: Inspection) -> None:
        count = len(inspection.errors)
        first = inspection.errors[0]
        super().__init__(
            f"{count} of {len(inspection.checked)} checks failed, the first: "
            f"{first.subject} is {first.found!r}, not {first.wanted!r}",
            first.remedy or "`yarc doctor` shows all of them",
        )
        self.inspection = inspection


@dataclass(slots=True, eq=False)
class _Work:
    """A piece of work for the controller.

    `work` is the function that does the work, `done` the future for which the caller waits. `moves` is True
    if the work moves the robot.
    """

    do: Callable[[], Awaitable[Any]]
    done: asyncio.Future[Any]
    moves: bool


class Running(Generic[T]):
    """Work of the engine that continues even if its caller stops waiting for the end.

    Args:
        task: task that carries the work out.
    """

    def __init__(self, task: asyncio.Task[T]) -> None:
        self._task = task

    @property
    def has_ended(self) -> bool:
        """Return True if the work has ended, in any way."""
        return self._task.done()

    async def ended(self) -> T:
        """Wait for the end of the work, and return its result or raise its exception. If the wait is
        cancelled, the work continues.
        """
        return await asyncio.shield(self._task)


class Engine:
    """Carries out work on one controller, one function after the other.

    Args:
        robot: the robot.
        session: connection to the controller.
        log: file or folder in which motions are logged; None: a new file in yarc-runs/; `NO_LOG`: no log.
        on_bug: called after a bug in yarclang, when the robot is at rest. Its arguments are the exception,
            and the end of a sentence that says where the robot rests (empty if nothing had moved).

    Attributes:
        under_way: name of the work in progress; empty: none.
        client: name of the client that ordered the work, for the log; empty: unknown.
        run_log: log of the motions; None before the first motion.
        ended: outcome of the last motion, as written at the end of the log.
        lost: reason why there is no connection; empty: there is one.
        inspection: result of the last inspection of the controller; None: none yet.
    """

    def __init__(
        self,
        robot: Robot,
        session: OrderedSession,
        log: Path | None,
        on_bug: Callable[[BaseException, str], None],
    ) -> None:
        self.robot = robot
        self.session = session
        self.under_way = ""
        self.client = ""
        self.run_log: RunLog | None = None
        self.ended: Ended | None = None
        self.lost = ""
        self.inspection: Inspection | None = None
        self._again = asyncio.Event()
        self._log_place = log
        self._on_bug = on_bug
        self._work: deque[_Work] = deque()
        self._items: tuple[Item, ...] = ()
        self._closing = False
        self._task: asyncio.Task[None] | None = None

    @property
    def operation(self) -> Operation:
        """Return the state, orders and notices of the session."""
        return self.session.operation

    @property
    def scripts(self) -> Scripts:
        """Return the scripts for this kind of controller."""
        return self.session.scripts

    async def start(self, *, patient: bool = False) -> Inspection | None:
        """Connect, inspect the controller, and begin to serve.

        Args:
            patient: if True, wait for a controller that can't be reached. If the controller isn't in the
                state that the robot needs, enter a fault, so that nothing can move.

        Returns:
            The inspection; None if the controller can't be reached yet.

        Raises:
            NotReady: the controller isn't in the state that the robot needs.
            Trouble: the robot's settings aren't proved, or the controller can't be reached or inspected.
        """
        self._items = items_of(self.robot)
        try:
            found = await self._reach()
            if found.errors and not patient:
                raise NotReady(found)
            self._judge(found)
        except Trouble as trouble:
            if not patient:
                self.session.close()
                raise
            self.lost = trouble.what
        except BaseException:
            self.session.close()
            raise
        self._task = asyncio.create_task(self._serve(), name="coordinator")
        return self.inspection

    async def _reach(self) -> Inspection:
        """Connect, and inspect the controller.

        Raises:
            Trouble: the controller can't be reached or inspected.
        """
        operation = self.operation
        await self.session.perform(self.scripts.connect(operation))
        if operation.searches and self.scripts.services is not None:  # nobody watches the search any more
            await self.session.perform(self.scripts.services.end_search(operation))
        return await self.look()

    def _judge(self, inspection: Inspection) -> None:
        """Enter a fault if the inspection has found an error."""
        if inspection.errors:
            trouble = NotReady(inspection)
            self.operation.go(Event.FAULT, trouble.what, trouble.code, trouble.remedy)

    async def retry(self) -> None:
        """Try at once to restore a lost connection.

        Raises:
            Trouble: there is still no connection.
        """
        if not self.lost:
            return
        self._again.set()
        for _ in range(_TRIES):
            await asyncio.sleep(_TRIED / _TRIES / self.session.pace)
            if not self.lost:
                return
        if self.lost:
            raise Trouble(f"there is no connection yet: {self.lost}", "the connection is retried", "Y1606")

    async def close(self) -> None:
        """End the current action by coming to rest on its path, and close the connection."""
        self._closing = True
        if self.under_way:
            self.session.order(Stop())
        self.session.wake()
        self._again.set()
        if self._task is not None:
            with contextlib.suppress(asyncio.CancelledError):
                await self._task
        self.close_log()
        self.session.close()

    def give_up(self) -> None:
        """End at once even if the robot can't be reached. Later messages of the controller are ignored."""
        self._closing = True
        if self._task is not None:
            self._task.cancel()

    def close_log(self) -> RunLog | None:
        """Close the log of all motions so far, and return it; None if there is no log. The next motion
        begins a new log.
        """
        log, self.run_log = self.run_log, None
        if log is not None:
            self.session.unlisten(log.take)
            self.session.log = None
            log.close(self.ended)
        return log

    async def ask(self, script: Callable[[], Script[T]]) -> T:
        """Run a script (a short exchange with the controller) while nothing is in progress. No motion begins
        until the script has ended.

        Raises:
            Trouble: the script itself fails, the robot is moving, or there is no connection.
        """
        self._refuse_while_under_way()
        return await self._wait_for(lambda: self.session.perform(script()), moves=False)

    async def move(self, name: str, work: Callable[[], Awaitable[T]], *, serves: bool = False) -> T:
        """Carry out work that moves the robot.

        Args:
            name: name of the work, for messages.
            work: function that calls `perform` and similar functions. It begins when all earlier requests are
                done.
            serves: True for work that makes a controller ready for motions. Such work is allowed even after a
                fault.

        Raises:
            Trouble: something else is in progress, or the robot's state forbids it.
        """
        self._refuse_while_under_way()
        if self.lost:
            raise Trouble(f"there is no connection to the controller: {self.lost}", "wait", "Y1606")
        if self.operation.state is State.FAULT and not serves:
            raise Trouble(
                "after a fault the controller must be checked before a motion", "clear it", code="Y1612"
            )
        self.operation.orders.clear()  # they were meant for an earlier action
        if not self._closing:
            self.under_way = name
        return await self._wait_for(work, moves=True)

    async def begin(self, work: Coroutine[Any, Any, T], name: str) -> Running[T]:
        """Begin work in a task of its own, and return as soon as the work has begun.

        Args:
            work: a coroutine that calls `move`.
            name: name of the work, for messages.

        Raises:
            Trouble: the work was refused at once.
        """
        task = asyncio.create_task(work, name=name)
        await asyncio.sleep(0)
        if task.done():
            task.result()
        return Running(task)

    async def beside(self, function: Callable[..., T], *arguments: Any) -> T:
        """Call a slow function in a thread, so that the event loop can react to stops meanwhile."""

        def called() -> T:
            with shares_the_interpreter():
                return function(*arguments)

        return await asyncio.to_thread(called)

    async def perform(self, job: Job, program: Job | None = None) -> Ended:
        """Carry a job out. Call this only from a function that was passed to `move`. `program` is the whole
        program to which the job belongs; the log is named after it.
        """
        return await self._logged(job, self.scripts.perform(self.operation, job), program)

    async def perform_live(self, live: Live) -> Ended:
        """Carry a live motion out. Call this only from a function that was passed to `move`. The log contains
        the states and positions during the motion and the users' orders, but not the lines that are streamed.
        """
        script = self.scripts.perform_live
        if script is None:
            raise Trouble(
                "this controller doesn't support live motions", "move the robot by commands", "Y1616"
            )
        return await self._logged(live.job, script(self.operation, live))

    async def _logged(self, job: Job, script: Script[Ended], program: Job | None = None) -> Ended:
        try:
            self._log(job, program or job)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            place = error.filename or self._log_place or FOLDER
            what = f"the log can't be created, {place}: {reason}; nothing moved"
            return Ended(False, what, "make room on the disk, or use --log PATH or --no-log", code="Y1601")
        self.ended = await self.session.perform(script)
        return self.ended

    async def clear(self) -> None:
        """Inspect the controller after a fault. If everything is in order, clear the fault. A program that
        was interrupted is ended first.

        Raises:
            NotReady: something isn't in order.
            Trouble: something is in progress, or there is no connection.
        """
        self._refuse_while_under_way()

        async def cleared() -> Inspection:
            if self.operation.state is State.FAULT:
                await self.session.perform(self.scripts.end_leftovers(self.operation, self.robot))
            return await self.look()

        found = await self._wait_for(cleared, moves=False)
        if found.errors:
            raise NotReady(found)

    async def look_again(self) -> Inspection:
        """Inspect the controller between two motions.

        Raises:
            Trouble: something is in progress, or there is no connection.
        """
        self._refuse_while_under_way()
        return await self._wait_for(self.look, moves=False)

    async def look(self) -> Inspection:
        """Inspect the controller. If everything is in order, clear an existing fault."""
        self.inspection = await self.session.perform(
            self.scripts.look(self.operation, self.robot, self._items)
        )
        return self.inspection

    def _refuse_while_under_way(self) -> None:
        if self.under_way:
            raise Trouble(f"{self.under_way} is under way", "wait for its end, or stop it", UNDER_WAY)

    # the task

    async def _wait_for(self, do: Callable[[], Awaitable[T]], *, moves: bool) -> T:
        if self._closing or self._task is None:
            raise Trouble("the coordinator isn't running", "start it")
        done: asyncio.Future[T] = asyncio.get_running_loop().create_future()
        self._work.append(_Work(do, done, moves))
        self.session.wake()
        # If the client that began the work leaves, the work continues until somebody orders its end.
        return await asyncio.shield(done)

    async def _serve(self) -> None:
        if self.lost:
            await self._reconnect(f"there is no connection: {self.lost}", self.lost)
        while not (self._closing and not self._work):
            try:
                if self._work:
                    work = self._work.popleft()
                    with prompt_while_moving() if work.moves else contextlib.nullcontext():
                        await self._carry_out(work)
                else:
                    await self.session.perform(self.scripts.idle(self.operation, self.robot, self._has_work))
            except Lost as lost:
                await self._reconnect(f"the connection was lost: {lost}", str(lost))
            except Exception as error:
                self._on_bug(error, await self._rescue())

    def _has_work(self) -> bool:
        return bool(self._work) or self._closing

    async def _carry_out(self, work: _Work) -> None:
        try:
            result = await work.do()
        except Lost as lost:
            self._end(work, Trouble(f"the connection was lost: {lost}", "wait until it is restored", "Y1606"))
            raise
        except Trouble as trouble:
            self._end(work, trouble)
        except Exception as error:
            where = await self._rescue()  # callers are informed only after the robot rests
            self._end(work, error)
            self._on_bug(error, where)
        else:
            self._end(work, None)
            if not work.done.done():
                work.done.set_result(result)

    def _end(self, work: _Work, error: Exception | None) -> None:
        """Finish work, and give its result or its error to the caller, if the caller still waits."""
        if work.moves:
            self.under_way = ""
            self.operation.orders.clear()
        if error is not None and not work.done.done():
            work.done.set_exception(error)

    async def _reconnect(self, reason: str, lost: str) -> None:
        """Try to connect again and again, until there is a connection or the engine is closed.

        Args:
            reason: reason for the robot's state, for reports.
            lost: reason why the connection was lost.
        """
        operation = self.operation
        self.lost = lost
        operation.go(Event.LOST, reason, _LOST, _RETRIED)
        while not self._closing:
            while self._work:
                self._end(
                    self._work.popleft(), Trouble("there is no connection to the controller", "wait", "Y1606")
                )
            self._again.clear()
            try:
                inspection = await self._reach()
            except Trouble as trouble:
                self.lost = trouble.what
                if operation.state is State.STOP:  # there was a connection for a moment
                    operation.go(Event.LOST, trouble.what, _LOST, _RETRIED)
                with contextlib.suppress(TimeoutError):
                    async with asyncio.timeout(_AGAIN_EACH / self.session.pace):
                        await self._again.wait()
                continue
            self.lost = ""
            self._judge(inspection)
            return

    async def _rescue(self) -> str:
        """Bring the robot to rest after a bug in yarclang, and end the running program. A new session does
        this, because the bug may have corrupted the state of the old one.

        Returns:
            The end of a sentence that says where the robot rests; empty if nothing had moved.
        """
        session, operation = self.session, self.operation
        operation.orders.clear()
        if operation.state in (State.STOP, State.FAULT) and not operation.searches:
            return ""
        rescuer = Session(
            session.host,
            session.port,
            pace=session.pace,
            connector=session.connector,
            scripts=session.scripts,
        )
        session.close()
        stand = "couldn't be brought to rest: inspect it"
        with contextlib.suppress(Exception):
            async with asyncio.timeout(_RESCUE):
                await rescuer.perform(self.scripts.connect(rescuer.operation))
                aborts = operation.searches  # a hold doesn't stop a search
                joints = await rescuer.perform(
                    self.scripts.end_what_runs(rescuer.operation, self.robot, abort=aborts)
                )
                operation.searches = False
                stands = described(self.robot, joints) if joints is not None else ""
                stand = f"is at {stands}" if stands else "isn't homed any more"
        rescuer.close()
        operation.go(Event.FAULT, "a bug of yarclang has ended the motion", _BUG, "report it")
        return f"{self.robot.name} {stand}"

    def _log(self, job: Job, program: Job) -> None:
        """Open the log before the first motion.

        Raises:
            OSError: the log can't be created.
        """
        if self._log_place is NO_LOG:
            return
        if self.run_log is None:
            loop = asyncio.get_running_loop()

            def failed(reason: str) -> None:
                what = Fail(f"the log can't be written: {reason}", "make room on the disk, or give --no-log")
                loop.call_soon_threadsafe(self.session.order, what)

            self.run_log = RunLog.open(
                self._log_place,
                program,
                f"{self.session.host}:{self.session.port}",
                version=__version__,
                on_failure=failed,
                pace=self.session.pace,
                clock=self.session.now(),
                client=self.client,
            )
            self.session.listen(self.run_log.take)
            self.session.log = self.run_log
        self.run_log.begin(job)
