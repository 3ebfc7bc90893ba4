"""Execution of the actions that the motion link (the connection on which goals arrive) requests: the
coordinator plans, proves and runs the goals. Stops overtake everything else.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from pathlib import Path

import numpy as np

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders, replies
from yarclang.coordinator.messages.findings import Finding
from yarclang.robot.model import Robot
from yarclang.ros.goal import goal_text, timetable
from yarclang.ros.motion import Action, Answer, Goal, Hold, MotionLink, Move, Plan, Refused, Stop, Told
from yarclang.ros.refusal import Refusal, refusal_of
from yarclang.ros.simple_message import Message
from yarclang.runtime.actions import Trouble

Say = Callable[[str], object]
Send = Callable[[Message], object]

_ENDED = "Y1624"

_AT_ONCE = 500
"""Largest number of waypoints of a goal that the event loop converts to program text, which takes up to 1
ms. Longer goals are converted in a thread.
"""


class Carrying:
    """Connection between the motion link's state machine and the coordinator.

    While there are goals, the door owns the robot: it takes the robot before it plans a goal, and releases
    the robot after the last one. Between goals, other clients may move the robot.

    Args:
        robot: the robot.
        link: state machine of the motion link.
        say: prints a line on the terminal.

    Attributes:
        seat: the door's client of the coordinator; None if the coordinator can't be reached.
    """

    def __init__(self, robot: Robot, link: MotionLink, say: Say) -> None:
        self.seat: Attached | None = None
        self._robot = robot
        self._link = link
        self._say = say
        self._timer: asyncio.TimerHandle | None = None
        self._goals: set[asyncio.Task[None]] = set()

    def do(self, actions: list[Action], send: Send | None = None) -> None:
        """Carry out actions that the motion link requests, in order.

        Args:
            actions: the actions.
            send: sends replies to the client on the motion link.
        """
        for action in actions:
            match action:
                case Stop():
                    self._order(orders.Stop())
                case Hold():
                    self._order(orders.Hold())
                case Answer():
                    if send is not None:
                        send(action.message)
                case Plan():
                    task = asyncio.ensure_future(self._carry_out(action.goal))
                    self._goals.add(task)
                    task.add_done_callback(self._goals.discard)
                case Refused():
                    self._say(str(action.refusal))
                case Told():
                    self._say(action.text)
                case Move():  # the task that has planned the goal runs it, too
                    pass
        self._set_timer()

    async def close(self) -> None:
        """End the running motion on its path."""
        if self._timer is not None:
            self._timer.cancel()
        if not self._link.is_idle:
            self._order(orders.Stop())
        for task in tuple(self._goals):
            task.cancel()
        await asyncio.gather(*self._goals, return_exceptions=True)

    def _order(self, order: orders.Stop | orders.Hold) -> None:
        if self.seat is not None:
            self.seat.send(order, lambda trouble: self._say(str(refusal_of(trouble))))

    def _set_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if (due := self._link.due) is not None:
            self._timer = asyncio.get_running_loop().call_at(due, self._passed)

    def _passed(self) -> None:
        self.do(self._link.passed(max(asyncio.get_running_loop().time(), self._link.due or 0.0)))

    # a goal

    async def _carry_out(self, goal: Goal) -> None:
        began = asyncio.get_running_loop().time()
        seat = self.seat
        planned = await self._planned(goal, seat)
        refusal = planned if isinstance(planned, Refusal) else None
        actions = self._link.planned(goal, refusal)
        self.do(actions)
        moves = any(isinstance(one, Move) for one in actions)
        if moves and not isinstance(planned, Refusal) and seat is not None:
            took = asyncio.get_running_loop().time() - began
            if planned is None:
                self._say(f"goal {goal.number}: the robot is already at its last point")
                failed = None
            else:
                self._say(
                    f"goal {goal.number}: {len(goal.points)} points, {planned.duration_s:.3f} s, proved "
                    f"after {took:.3f} s; it begins"
                )
                # There must be no await between the last check for stops and this order: a stop during an
                # await would come too late to prevent the motion.
                failed = await self._run(planned, seat, goal)
            self.do(self._link.ended(goal.number, failed))
        await self._released(seat)

    async def _planned(self, goal: Goal, seat: Attached | None) -> replies.ProgramDescribed | Refusal | None:
        """Plan and prove a goal from the robot's position. Return its program, or the reason why it is
        refused; None if the robot is already at the goal's end.
        """
        if seat is None:
            return Refusal(
                "Y1606", f"the coordinator of {self._robot.name} can't be reached", "start it again"
            )
        try:
            await seat.ask(orders.Own(shared=True))
            place = await seat.ask(orders.AskPlace())
            positions, times = timetable(self._robot, goal, np.array(place.exact))
            if not len(times):
                return None
            if len(times) <= _AT_ONCE:
                text = goal_text(self._robot, positions, times)
            else:
                text = await asyncio.to_thread(goal_text, self._robot, positions, times)
            file = Path(seat.welcome.folder) / f"ros-goal-{goal.number}"
            made = await seat.ask(orders.Load(file=str(file), text=text, here=True))
        except Trouble as trouble:
            return refusal_of(trouble)
        return made.program or _refused(goal, made.findings)

    async def _run(self, program: replies.ProgramDescribed, seat: Attached, goal: Goal) -> Refusal | None:
        try:
            ended = await seat.ask(orders.Run(program=program.number, unless_stopped=True))
        except Trouble as trouble:
            return refusal_of(trouble)
        if ended.well:
            self._say(f"goal {goal.number} has ended at its last point")
            return None
        what = f"goal {goal.number} was ended before its last point: {ended.what or 'no reason given'}"
        return Refusal(
            ended.code or _ENDED, what, ended.help or "send the goal again, from where the robot stands"
        )

    async def _released(self, seat: Attached | None) -> None:
        """Release the robot if no goal waits."""
        if seat is None or not self._link.is_idle:
            return
        try:
            log = (await seat.ask(orders.Release())).log
        except Trouble:
            return  # the coordinator has ended
        if log is not None:
            self._say(f"log: {log.path}" if not log.problem else f"log: {log.path}: {log.problem}")


def _refused(goal: Goal, findings: tuple[Finding, ...]) -> Refusal:
    """Convert the first error of a goal's program to a refusal of the goal."""
    for one in findings:
        if one.severity == "error":
            return Refusal(one.code, f"goal {goal.number}: {one.message}", one.help or "")
    return Refusal(_ENDED, f"goal {goal.number} can't be planned, and nothing says why", "report it")
