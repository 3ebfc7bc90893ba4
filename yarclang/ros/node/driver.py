"""Connection between the FollowJointTrajectory action and a robot that `yarc serve` owns: orders, events, and
reconnection when the robot is served again. The driver's threads are all in this module.

There are three connections to the process. The first gives the orders for goals, and owns the robot while
there are any goals. The second receives events. The third asks for the motors' state each second, so that a
hanging process is noticed. Stops use the connection of the goals, so that a stop can't overtake the start of
the goal that it is meant to end.
"""

from __future__ import annotations

import collections
import contextlib
import logging
import math
import os
import re
import threading
import time
from dataclasses import dataclass
from functools import partial
from typing import Any, Callable, Iterator, Protocol, Sequence

from yarclang.client import Gone, Refused, Robot, find
from yarclang.ros.node.action import (
    ABORTED,
    INVALID_GOAL,
    Accepted,
    Action,
    End,
    Feedback,
    Give,
    Move,
    Plan,
    Ready,
    Result,
    Stop,
    TrajectoryAction,
)
from yarclang.ros.node.trajectory import Goal, Joint, Moment, Values, fault_of, program_of, too_long

__all__ = ["Driver", "Feedback", "Goal", "JointState", "Result", "Shell", "Status"]

_AGAIN = 0.5
"""Time between two attempts to reconnect [s]."""

_EACH = 1.0
"""Time between two requests for the motors' state, and longest time between two status messages [s]."""

_HANGS = 10.0
"""Time without a reply after which a process, or its computer, counts as hanging [s]."""

_PREPARES = 60.0
"""Longest duration of an order that needs the controller but no motion [s]."""

_RESTS = 5.0
"""Longest wait of `close` for the robot to rest [s]."""

_MOST_WAITING = 256
"""Largest number of calls that wait until the shell has processed earlier ones. While so many calls wait, new
positions and new feedback are dropped.
"""

_STANDS = {"deg": 0.002, "mm": 0.0005}
"""Speed below which a joint counts as resting [rad/s, m/s], by the joint's unit. A position that alternates
between two counts isn't a motion.
"""

_COURSE, _LEAD_COURSE = 200, 2000
"""Numbers of samples of a planned motion for feedback. The first is used if the robot is at the goal's first
point, the second if the motion leads to this point first.
"""

_UNKNOWN, _NO, _YES = -1, 0, 1
_MANUAL, _AUTOMATIC = 1, 2

_GOAL_NAME = "ros-goal-"

_LOG = logging.getLogger(__name__)


@dataclass(frozen=True)
class JointState:
    """State of the joints, in the robot's order.

    Attributes:
        names: names of the joints.
        positions: positions [rad or m].
        velocities: velocities [rad/s or m/s].
    """

    names: tuple[str, ...]
    positions: Values
    velocities: Values


@dataclass(frozen=True)
class Status:
    """Fields of industrial_msgs/RobotStatus, with its values: -1 unknown, 0 no, 1 yes.

    Attributes:
        mode: 1 manual (another client owns the robot), 2 automatic, -1 unknown.
        e_stopped: always -1, because it is unknown.
        drives_powered: 1 if all loops are closed.
        motion_possible: 1 if a goal may move the robot now.
        in_motion: 1 while a program is run or joints move.
        in_error: 1 in a fault, without a controller, or after a goal that failed.
        error_code: number of the finding (1612 for Y1612); 0 for none.
        why: the reason, in words.
    """

    mode: int
    e_stopped: int
    drives_powered: int
    motion_possible: int
    in_motion: int
    in_error: int
    error_code: int
    why: str


class Shell(Protocol):
    """Interface through which the driver calls the ROS node. One thread of the driver makes all calls, in
    order. They must not block.
    """

    def accepted(self, goal_id: str) -> None:
        """Handle the acceptance of a goal: it is being planned, or will be planned when the robot rests."""

    def feedback(self, goal_id: str, feedback: Feedback) -> None:
        """Publish the progress of a goal."""

    def ended(self, goal_id: str, outcome: str, result: Result) -> None:
        """Report the end of a goal: `outcome` is "succeeded", "aborted" or "canceled". Called exactly once
        for each accepted goal.
        """

    def joint_state(self, state: JointState) -> None:
        """Publish the joints' state, 50 times a second."""

    def status(self, status: Status) -> None:
        """Publish the robot's status: at each change, and once a second."""

    def changed(self) -> None:
        """Handle a change of the robot, its cell or its planned motion: call the driver's `model`, `scene`
        and `ghost` again, from another thread.
        """

    def say(self, level: str, text: str) -> None:
        """Print a line for the user: `level` is "info", "warn" or "error"."""


class _Link:
    """The three connections to the process that owns the robot.

    Args:
        which: path of the socket, or name of the process or of the robot, as for `Driver`.
        name: name of the driver that other clients see.

    Raises:
        Gone: the robot isn't served.
        Refused: the connection was denied.
        TimeoutError: the process doesn't reply.
    """

    def __init__(self, which: str | int | None, name: str) -> None:
        robots: list[Robot] = []
        try:
            robots.append(Robot(which, name=name))
            self.path = robots[0].path
            robots.extend(Robot(self.path, name=f"{name} {what}") for what in ("events", "health"))
        except BaseException:
            for one in robots:
                one.close()
            raise
        self.orders, self.events, self.health = robots
        self.name = str(self.orders.welcome["name"])
        self.joints = tuple(
            Joint(one["name"], one["unit"]) for one in self.orders.welcome["status"]["joints"]
        )

    @property
    def robot(self) -> str:
        """Name of the robot, for finding its process."""
        return _robot_of(self.path)

    def close(self) -> None:
        """Disconnect. Pending calls raise `Gone`."""
        for one in (self.orders, self.events, self.health):
            one.close()


@dataclass
class _Seen:
    """Last known state of the robot.

    Attributes:
        heard: time by the coordinator's clock at which the joints were in the state `moment` [s].
    """

    state: str = "disconnected"
    why: str = ""
    code: str = ""
    owner: str = ""
    cell: str = ""
    powered: int = _UNKNOWN
    moves: int = _UNKNOWN
    moment: Moment | None = None
    heard: float = 0.0


class Driver:
    """A FollowJointTrajectory action for a robot that `yarc serve` owns.

    Args:
        which: path of the socket, or name of the process or of the robot, as for `yarclang.client.Robot`;
            None for the only one.
        shell: the ROS node.
        name: name of the driver that other clients see.
        hold_on_cancel: True to hold a cancelled goal on its path at once; False to finish a goal that moves.

    Attributes:
        joint_names: joint names of the robot, in its order; empty before `start`.
    """

    def __init__(
        self, which: str | int | None, shell: Shell, *, name: str = "ros", hold_on_cancel: bool = True
    ) -> None:
        self.joint_names: tuple[str, ...] = ()
        self._which = which
        self._shell = shell
        self._name = name
        self._lock = threading.RLock()
        self._news = threading.Condition(self._lock)
        self._action = TrajectoryAction((), hold_on_cancel)
        self._link: _Link | None = None
        self._lost = "it wasn't started"
        self._last = ""
        self._seen = _Seen()
        self._plans: collections.deque[tuple[Plan, int]] = collections.deque()
        self._program: tuple[int, int] | None = None
        self._running: tuple[int, int] | None = None
        self._stops: list[int] = []
        self._pace: float | None = None
        self._owns = False
        self._telling: int | None = None
        self._ghost: list[tuple[float, Values]] = []
        self._failed: Result | None = None
        self._told: Status | None = None
        self._outbox: collections.deque[Callable[[], None]] = collections.deque()
        self._closing = False
        self._is_told_out = False
        self._threads: list[threading.Thread] = []

    # called by shells

    def start(self) -> None:
        """Connect, and begin to serve goals.

        Raises:
            yarclang.client.Gone: the robot isn't served.
            yarclang.client.Refused: the connection was denied.
            TimeoutError: the process doesn't reply.
        """
        try:
            link = _Link(self._which, self._name)
        except Gone as gone:
            raise Gone(f"{gone}; `yarc serve --robot NAME` serves one") from None
        self._use(link)
        for work in (self._tell, self._keep_time, self._supervise):
            self._begin(work)

    def check(self, goal: Goal) -> Result | None:
        """Return the reason why `goal` would reject a goal now, without other effects; None if it would be
        accepted.
        """
        with self._lock:
            if self._link is None or self._closing:
                return Result(INVALID_GOAL, f"no robot is there: {self._lost}")
            joints = self._action.joints
        return fault_of(goal, joints)

    def goal(self, goal_id: str, goal: Goal) -> Result | None:
        """Accept or reject a goal, without waiting, from any thread. Return None if it is accepted (planning
        follows), otherwise the reason why it is rejected.
        """
        with self._lock:
            if self._link is None or self._closing:
                return Result(INVALID_GOAL, f"no robot is there: {self._lost}")
            rejected, actions = self._action.goal(goal_id, goal, time.monotonic())
            self._do(actions)
            return rejected

    def cancel(self, goal_id: str | None = None) -> None:
        """Cancel the goal with a given id, or all goals (None). A goal that moves the robot ends as
        "canceled" when the robot rests.
        """
        with self._lock:
            self._do(self._action.cancel(goal_id))

    def hold(self) -> tuple[bool, str]:
        """Hold the robot on its path, ready to continue. Return two values: True if the order was accepted,
        and the text of the reply.
        """
        return self._ordered("hold")

    def resume(self) -> tuple[bool, str]:
        """Continue after a hold. Return two values: True if the order was accepted, and the text of the
        reply.
        """
        return self._ordered("resume")

    def stop(self) -> tuple[bool, str]:
        """Bring the robot to rest on its path, and end the running program. Return two values: True if the
        order was accepted, and the text of the reply.
        """
        with self._lock:
            self._do(self._action.stopped("a stop was ordered"))
            if self._action.moves:
                self._send_stop()
        return self._ordered("stop")

    def override(self, percent: float) -> tuple[bool, str]:
        """Set the override, 1 to 100 %. Return two values: True if the order was accepted, and the text of
        the reply. While the robot has no owner, the override applies to the next goal.
        """
        if not 1.0 <= percent <= 100.0:
            return False, f"{percent:g} % is no valid override: it is 1 to 100 %"
        with self._lock:
            if self._link is not None and not self._seen.owner:
                self._pace = percent
                return True, f"the next goal begins with {percent:g} %"
        return self._ordered("override", percent=percent)

    def model(self) -> dict[str, Any]:
        """Return the description of the robot: the reply to the order `model`.

        Raises:
            yarclang.client.Gone: the robot isn't served.
            yarclang.client.Refused: the order was denied.
            TimeoutError: the process doesn't reply.
        """
        return self._asked("model")

    def scene(self) -> dict[str, Any]:
        """Return the cell around the robot: the reply to the order `scene`. Raises the same errors as
        `model`.
        """
        return self._asked("scene")

    def ghost(self) -> list[tuple[float, Values]]:
        """Return the planned motion that is being executed, as samples (time [s], joint positions [rad or m]
        in the order of `joint_names`); empty if there is none.
        """
        with self._lock:
            return list(self._ghost)

    def close(self) -> None:
        """Disconnect. If a goal of this driver moves the robot, the robot first comes to rest on its path."""
        with self._lock:
            if self._closing:
                return
            self._do(self._action.leave("the node was ended"))
            self._closing = True
            self._news.wait_for(lambda: self._action.is_idle, _RESTS)
            self._lose(self._link, "the node was ended")
            self._is_told_out = True
            self._news.notify_all()
        for thread in self._threads:
            if thread is not threading.current_thread():
                thread.join(_RESTS)

    def _ordered(self, order: str, **fields: Any) -> tuple[bool, str]:
        """Give an order that every client may give. The order has its own connection, so that it doesn't wait
        for other orders.
        """
        try:
            with Robot(self._path(), name=None) as robot:
                state = robot.ask(order, **fields)["state"]
        except Refused as refused:
            return False, _said(refused)
        except (Gone, TimeoutError) as error:
            return False, str(error)
        return True, f"{order} was taken, in the state {state}"

    def _asked(self, order: str) -> dict[str, Any]:
        with Robot(self._path(), name=f"{self._name} asks") as robot:
            return robot.ask(order, patience=_PREPARES)

    def _path(self) -> str:
        with self._lock:
            if self._link is None:
                raise Gone(f"no robot is there: {self._lost}")
            return self._link.path

    # actions; all under the lock

    def _do(self, actions: Sequence[Action]) -> None:
        for action in actions:
            if isinstance(action, Plan):
                self._send_own(action)
            elif isinstance(action, Move):
                self._send_run(action.number)
            elif isinstance(action, Stop):
                self._send_stop()
            elif isinstance(action, Accepted):
                self._failed = None
                self._call(partial(self._shell.accepted, action.goal_id))
            elif isinstance(action, Give):
                self._call(partial(self._shell.feedback, action.goal_id, action.feedback), often=True)
            elif isinstance(action, End):
                self._end(action)
        if actions:
            self._news.notify_all()

    def _end(self, action: End) -> None:
        if action.outcome == ABORTED:
            self._failed = action.result
            self._say("error", f"goal {action.goal_id}: {action.result.error_string}")
        self._call(partial(self._shell.ended, action.goal_id, action.outcome, action.result))
        if not self._action.moves:
            self._show([])
        self._tell_status()

    def _send_own(self, plan: Plan) -> None:
        """Send the order `own` before a goal is planned. The later order to run the goal is refused if a stop
        has come after `own`. So a stop during planning also prevents the motion.
        """
        if self._link is None:
            return
        try:
            self._plans.append((plan, self._link.orders.order("own", shared=True)))
        except Gone as gone:
            self._lose(self._link, str(gone))

    def _send_run(self, number: int) -> None:
        if self._link is None:
            return
        assert self._program is not None
        assert self._program[0] == number
        try:
            self._running = (
                number,
                self._link.orders.order("run", program=self._program[1], unless_stopped=True),
            )
        except Gone as gone:
            self._lose(self._link, str(gone))

    def _send_stop(self) -> None:
        if self._link is None:
            return
        try:
            self._stops.append(self._link.orders.order("stop"))
        except Gone as gone:
            self._lose(self._link, str(gone))

    def _show(self, ghost: list[tuple[float, Values]]) -> None:
        if ghost != self._ghost:
            self._ghost = ghost
            self._call(self._shell.changed)

    # the shell

    def _call(self, call: Callable[[], None], *, often: bool = False) -> None:
        with self._lock:
            if not (often and len(self._outbox) >= _MOST_WAITING):
                self._outbox.append(call)
                self._news.notify_all()

    def _say(self, level: str, text: str) -> None:
        self._call(partial(self._shell.say, level, text))

    def _tell(self) -> None:
        """Call the shell until the driver is closed and all calls are made."""
        while True:
            with self._lock:
                self._news.wait_for(lambda: self._outbox or self._is_told_out)
                if not self._outbox:
                    return
                call = self._outbox.popleft()
            try:
                call()
            except Exception:
                _LOG.exception("the ROS node has failed")

    # connections

    def _begin(self, work: Callable[..., None], *arguments: Any) -> None:
        thread = threading.Thread(
            target=work, args=arguments, name=f"yarc {work.__name__.strip('_')}", daemon=True
        )
        with self._lock:
            self._threads = [*(one for one in self._threads if one.is_alive()), thread]
        thread.start()

    def _use(self, link: _Link) -> None:
        status = link.orders.welcome["status"]
        with self._lock:
            self._link, self._lost, self._last = link, "", link.path
            self._seen = _Seen(
                status["state"], status["why"], "", status["owner"] or "", status["cell"] or ""
            )
            self._action.joints = link.joints
            self.joint_names = tuple(one.name for one in link.joints)
            self._call(self._shell.changed)
            self._tell_status()
        self._begin(self._carry_out, link)
        self._begin(self._hear, link)

    def _lose(self, link: _Link | None, reason: str) -> None:
        """Close the connection to a process, and abort the goals that used it."""
        with self._lock:
            if link is None or self._link is not link:
                return
            self._link, self._lost = None, reason
            self._seen = _Seen(why=reason)
            self._running = self._program = self._telling = None
            self._owns = False
            self._stops.clear()
            self._plans.clear()
            if not self._closing:
                self._say("error", f"{reason}: look at the robot; goals are refused until it is served again")
            self._do(self._action.lost(f"{reason}: look at the robot"))
            self._show([])
            self._tell_status()
            self._news.notify_all()
        link.close()

    def _supervise(self) -> None:
        """Ask for the state each second, and reconnect if there is no reply."""
        while True:
            with self._lock:
                link = self._link
                self._news.wait_for(lambda: self._closing, _AGAIN if link is None else _EACH)
                if self._closing:
                    return
                link = self._link
            if link is None:
                self._try_again()
                continue
            with self._losing(link):
                health = link.health.ask("health", patience=_HANGS)
                status = link.health.ask("status", patience=_HANGS)
                self._look(link, health, status)

    @contextlib.contextmanager
    def _losing(self, link: _Link) -> Iterator[None]:
        """Close the connection if, during the context, its process ends, hangs, refuses an order or sends an
        unknown reply.
        """
        try:
            yield
        except (Gone, TimeoutError) as error:
            self._lose(link, str(error))
        except Refused as refused:
            self._lose(link, _said(refused))
        except Exception as error:
            _LOG.exception("a received message can't be used")
            self._lose(link, f"a received message can't be used: {error!r}")

    def _try_again(self) -> None:
        for which in dict.fromkeys((self._which, self._anew())):
            try:
                link = _Link(which, self._name)
            except (Gone, Refused, TimeoutError):
                continue
            with self._lock:
                if self._closing:
                    link.close()
                    return
                self._say("info", f"{link.robot} is served again")
                self._use(link)
            return

    def _anew(self) -> str | int | None:
        """Return the socket of the process that now serves the same robot in the same folder. If there isn't
        exactly one such process, return `which` as it was given to the driver.
        """
        folder, robot = os.path.dirname(self._last), _robot_of(self._last)  # noqa: PTH120
        there = [one.path for one in find(folder) if one.robot == robot]
        return there[0] if len(there) == 1 else self._which

    def _look(self, link: _Link, health: dict[str, Any], status: dict[str, Any]) -> None:
        motors, is_cut = health["motors"], bool(health["link"])
        powered = _YES if all(one["closed_loop"] for one in motors) else _NO
        if not motors or is_cut:
            powered = _UNKNOWN
        with self._lock:
            if self._link is not link:
                return
            cell = status["cell"] or ""
            if cell != self._seen.cell:
                self._call(self._shell.changed)
            self._seen.powered, self._seen.cell = powered, cell
            if is_cut:
                self._seen.moves = _UNKNOWN
            self._tell_status(again=True)

    # time

    def _keep_time(self) -> None:
        """Call `passed` of the action whenever a timeout of the action is due."""
        with self._lock:
            while not self._closing:
                due = self._action.due
                self._news.wait(None if due is None else max(0.0, due - time.monotonic()))
                self._do(self._action.passed(time.monotonic()))

    # goals

    def _carry_out(self, link: _Link) -> None:
        """Plan goals, wait for their ends, and release the robot after the last one."""
        with self._losing(link):
            while True:
                with self._lock:
                    self._news.wait_for(lambda: self._link is not link or self._has_work)
                    if self._link is not link:
                        return
                    running = self._running
                    planning = self._plans.popleft() if running is None and self._plans else None
                    releasing = self._send_release(link) if running is None and planning is None else None
                if running is not None:
                    self._await_end(link, *running)
                elif planning is not None:
                    self._plan(link, *planning)
                elif releasing is not None:
                    self._tell_log(link, releasing)

    @property
    def _has_work(self) -> bool:
        return bool(self._plans or self._running is not None or (self._owns and self._action.is_idle))

    def _plan(self, link: _Link, plan: Plan, owning: int) -> None:
        outcome: Ready | Result
        program: int | None = None
        ghost: list[tuple[float, Values]] = []
        try:
            link.orders.answer(owning, _PREPARES)
            outcome, program, ghost = self._prepared(link, plan)
        except Refused as refused:
            outcome = Result(INVALID_GOAL, _said(refused))
        except (Gone, TimeoutError):
            raise
        except Exception as error:
            _LOG.exception("a goal can't be planned")
            outcome = Result(INVALID_GOAL, f"a bug of yarclang: {error!r}; report it")
        with self._lock:
            if self._link is not link:
                return
            self._program = None if program is None else (plan.number, program)
            if self._action.plans(plan.number) and isinstance(outcome, Ready):
                self._show(ghost)
            self._do(self._action.planned(plan.number, outcome, time.monotonic()))

    def _prepared(
        self, link: _Link, plan: Plan
    ) -> tuple[Ready | Result, int | None, list[tuple[float, Values]]]:
        """Plan a goal. Return three values: the planned goal or the reason of the failure; the number of the
        goal's program, or None without a program; and samples of the planned motion.

        Raises:
            Refused: another client owns the robot, or is moving it.
            Gone: the process has ended.
            TimeoutError: the process doesn't reply.
        """
        robot = link.orders
        with self._lock:
            self._owns = True
            if not self._action.plans(plan.number):
                return Ready(None), None, []
            pace, self._pace = self._pace, None
        if pace is not None:
            robot.ask("override", percent=pace)
        stands = robot.ask("where", patience=_PREPARES)["exact"]
        planned = program_of(plan.goal, link.joints, tuple(stands))
        if not planned.text:
            return Ready(None), None, []
        if (text := too_long(planned)) is not None:
            return Result(INVALID_GOAL, text), None, []
        folder = robot.welcome["folder"]
        loaded = robot.load(os.path.join(folder, f"{_GOAL_NAME}{plan.number}"), text=planned.text, here=True)  # noqa: PTH118
        program = loaded["program"]
        if program is None:
            return _refused(loaded["findings"]), None, []
        number: int = program["number"]
        course = robot.ask(
            "course",
            program=number,
            samples=_LEAD_COURSE if planned.has_lead else _COURSE,
            patience=_PREPARES,
        )
        places = _places(link.joints, course["course"])
        lead = 0.0
        if planned.has_lead:
            lead = program["commands"][0]["ends_s"]
        ready = Ready(planned.track, lead, tuple(places) if planned.has_lead else ())
        self._say(
            "info",
            f"goal {plan.goal_id}: {len(plan.goal.points)} points, {program['duration_s']:.3f} s, was "
            f"planned and proved",
        )
        return ready, number, places[:: max(1, len(places) // _COURSE)]

    def _await_end(self, link: _Link, number: int, answer: int) -> None:
        failed = None
        try:
            ended = link.orders.answer(answer, math.inf)
        except Refused as refused:
            failed = Result(INVALID_GOAL, _said(refused))
        else:
            if not ended["well"]:
                failed = Result(INVALID_GOAL, _why(ended))
        with self._lock:
            if self._link is not link:
                return
            self._running = None
            stops, self._stops = self._stops, []
            self._do(self._action.ended(number, failed, time.monotonic()))
        for stop in stops:
            with contextlib.suppress(Refused):
                link.orders.answer(stop, _PREPARES)

    def _send_release(self, link: _Link) -> int:
        """Send the order to release the robot, and return the order's number. The caller holds the lock, so
        that the next goal's order `own` is sent after this one.
        """
        self._owns = False
        return link.orders.order("release")

    def _tell_log(self, link: _Link, releasing: int) -> None:
        with contextlib.suppress(Refused):
            log = link.orders.answer(releasing, _PREPARES)["log"]
            if log is not None:
                self._say("info", f"log: {log['path']}" + (f": {log['problem']}" if log["problem"] else ""))

    # events

    def _hear(self, link: _Link) -> None:
        """Handle events until the process ends."""
        with self._losing(link):
            for event in link.events.events(positions=True):
                with self._lock:
                    if self._link is not link:
                        return
                    self._take(link, event)
            raise Gone(f"{os.path.basename(link.path)[:-5]} has ended")  # noqa: PTH119

    def _take(self, link: _Link, event: dict[str, Any]) -> None:
        kind = event["event"]
        seen = self._seen
        if kind == "position":
            self._place(link, event)
            return
        if kind == "state":
            seen.state, seen.why, seen.code = event["state"], event["why"], event["code"] or ""
            if seen.state == "disconnected":
                seen.moves = seen.powered = _UNKNOWN
        elif kind == "owner":
            seen.owner = event["owner"] or ""
        elif kind == "began" and event["client"] == link.name:
            number = event["name"].rpartition("-")[2]
            self._telling = int(number) if number.isdigit() else None
        elif kind == "finished":
            self._telling = None
        elif kind == "scene_changed":
            self._call(self._shell.changed)
        elif kind == "message" and event["warning"]:
            self._say("warn", event["text"])
        else:
            return
        self._tell_status()

    def _place(self, link: _Link, event: dict[str, Any]) -> None:
        seen = self._seen
        positions = tuple(event["joints"][one.name] / one.scale for one in link.joints)
        before, passed = seen.moment, event["time_s"] - seen.heard
        velocities = (0.0,) * len(positions)
        if before is not None and passed > 0.0:
            velocities = tuple((b - a) / passed for a, b in zip(before.positions, positions))
            moves = any(abs(v) > _STANDS[one.unit] for v, one in zip(velocities, link.joints))
            seen.moves = _YES if moves else _NO
        elif before is not None:
            velocities = before.velocities
        seen.moment, seen.heard = Moment(positions, velocities), event["time_s"]
        state = JointState(self.joint_names, positions, velocities)
        self._call(partial(self._shell.joint_state, state), often=True)
        is_ours = self._running is not None and self._running[0] == self._telling
        done = event["done_s"] if is_ours else None
        self._do(self._action.position(seen.moment, done, time.monotonic()))
        self._tell_status()

    # status

    def _tell_status(self, *, again: bool = False) -> None:
        status = self._status()
        if again or status != self._told:
            self._call(partial(self._shell.status, status), often=status == self._told)
            self._told = status

    def _status(self) -> Status:
        link, seen = self._link, self._seen
        if link is None:
            return Status(_UNKNOWN, _UNKNOWN, _UNKNOWN, _NO, _UNKNOWN, _YES, _number(self._lost), self._lost)
        out_of_order = seen.state in ("fault", "disconnected")
        others = seen.owner not in ("", link.name)
        failed = self._failed
        moves = seen.moves
        if seen.state == "move":
            moves = _YES
        code = why = ""
        if out_of_order:
            code, why = seen.code or ("Y1612" if seen.state == "fault" else "Y1606"), seen.why
        elif failed is not None:
            code = why = failed.error_string
        elif others:
            why = f"{seen.owner} owns the robot"
        else:
            why = seen.why
        return Status(
            mode=_MANUAL if others else _AUTOMATIC,
            e_stopped=_UNKNOWN,
            drives_powered=seen.powered,
            motion_possible=_NO if out_of_order or others or seen.powered == _NO else _YES,
            in_motion=moves,
            in_error=_YES if out_of_order or failed is not None else _NO,
            error_code=_number(code),
            why=why,
        )


def _robot_of(path: str) -> str:
    """Return the name of the robot from the path of a socket."""
    return re.sub(r"-\d+\.sock$", "", os.path.basename(path))  # noqa: PTH119


def _number(text: str) -> int:
    """Return the number of the first finding's code in a text; 0 if there is none."""
    found = re.search(r"\bY(\d{4})\b", text)
    return 0 if found is None else int(found[1])


def _said(refused: Refused) -> str:
    return _worded(refused.code, refused.error, refused.help)


def _why(ended: dict[str, Any]) -> str:
    what = f"the goal was ended before its last point: {ended['what'] or 'no reason given'}"
    return _worded(ended["code"] or "", what, ended["help"] or "")


def _refused(findings: Sequence[dict[str, Any]]) -> Result:
    """Convert the first error of a goal's program to the result of the goal, which is aborted."""
    for one in findings:
        if one["severity"] == "error":
            return Result(INVALID_GOAL, _worded(one["code"], one["message"], one["help"] or ""))
    return Result(INVALID_GOAL, "the goal can't be planned, and nothing says why: report it")


def _worded(code: str, what: str, help_: str) -> str:
    return "".join((f"{code}: " if code else "", what, f"; {help_}" if help_ else ""))


def _places(joints: Sequence[Joint], course: dict[str, Any]) -> list[tuple[float, Values]]:
    """Convert the samples of a planned motion from the coordinator's units to rad and m."""
    return [
        (at, tuple(value / one.scale for value, one in zip(row, joints)))
        for at, row in zip(course["times"], course["joints"])
    ]
