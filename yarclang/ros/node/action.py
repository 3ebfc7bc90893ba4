"""The rules of FollowJointTrajectory as a state machine. Its inputs are goals, positions and times, its
outputs are actions. No I/O, no threads, no clock.

One goal is active, and at most one more waits until the robot rests: a new goal preempts the active goal.
Each accepted goal ends exactly once.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Sequence, Union

from yarclang.ros.node.trajectory import (
    GOAL_TOLERANCE_VIOLATED,
    INVALID_GOAL,
    INVALID_JOINTS,
    OLD_HEADER_TIMESTAMP,
    PATH_TOLERANCE_VIOLATED,
    SUCCESSFUL,
    Goal,
    Joint,
    Moment,
    Result,
    Track,
    Values,
    fault_of,
)

__all__ = [
    "ABORTED",
    "CANCELED",
    "GOAL_TOLERANCE_VIOLATED",
    "INVALID_GOAL",
    "INVALID_JOINTS",
    "OLD_HEADER_TIMESTAMP",
    "PATH_TOLERANCE_VIOLATED",
    "SUCCEEDED",
    "SUCCESSFUL",
    "Accepted",
    "Action",
    "End",
    "Feedback",
    "Give",
    "Moment",
    "Move",
    "Plan",
    "Ready",
    "Result",
    "Stop",
    "TrajectoryAction",
]

SUCCEEDED, ABORTED, CANCELED = "succeeded", "aborted", "canceled"

GOAL_TOLERANCE = {"deg": 0.01, "mm": 0.001}
"""Default goal tolerance: largest distance of a joint from its position in the goal's last point, by the
joint's unit: 0.01 rad for "deg", 0.001 m for "mm".
"""

SETTLING = 2.0
"""Default goal time tolerance: time after the end of the program in which the joints must arrive at the
goal's last point [s].
"""

STEP = 0.05
"""Step by which the program time in the coordinator's reports grows [s], as assumed until two reports have
arrived. The real step is the duration of one or several segments.
"""

BEHIND, AHEAD = 1.5, 2.5
"""Largest delay and largest lead of the joints relative to the reported program time, in steps of the program
time (see `STEP`). The two differ because the controller reports joints and time one after the other.
"""


@dataclass(frozen=True)
class Feedback:
    """Progress of a goal, 50 times a second while it moves.

    Attributes:
        joint_names: names of the joints in the order of the goal.
        desired: planned state at the program's time. An override below 100 % or a hold delays this time.
        actual: state that the controller reports.
        error: desired - actual.
    """

    joint_names: tuple[str, ...]
    desired: Moment
    actual: Moment
    error: Moment


@dataclass(frozen=True)
class Ready:
    """A goal that was planned and proved.

    Attributes:
        track: planned path over time, with joints in the robot's order; None if the robot is already at its
            end.
        lead: duration of the motion from the robot's position to the goal's first point [s].
        course: samples of the motion to the goal's first point, as pairs (program time [s], joint positions
            [rad or m]).
    """

    track: Track | None
    lead: float = 0.0
    course: tuple[tuple[float, Values], ...] = ()


# actions


@dataclass(frozen=True)
class Accepted:
    """Report to the client that its goal is being planned, or will be planned when the robot rests."""

    goal_id: str


@dataclass(frozen=True)
class Plan:
    """Request to plan and prove a goal from the robot's position at rest, and then to call
    `TrajectoryAction.planned` with the goal's number.
    """

    number: int
    goal_id: str
    goal: Goal


@dataclass(frozen=True)
class Move:
    """Run the planned goal of this number, then call `TrajectoryAction.ended`."""

    number: int


@dataclass(frozen=True)
class Stop:
    """Hold the robot on its path at once, and end the running program."""


@dataclass(frozen=True)
class Give:
    """Publish feedback of a goal."""

    goal_id: str
    feedback: Feedback


@dataclass(frozen=True)
class End:
    """End a goal: `outcome` is "succeeded", "aborted" or "canceled"."""

    goal_id: str
    outcome: str
    result: Result


Action = Union[Accepted, Plan, Move, Stop, Give, End]


@dataclass
class _UnderWay:
    """A goal from its acceptance to its end.

    Attributes:
        number: number of the goal.
        goal_id: id of the goal at its client.
        goal: goal as received.
        begins: planned start by the caller's clock [s].
        phase: planning, ready, moving or settling (the program has ended, but the joints may not have
            arrived).
        ready: the planned goal; None before planning has finished.
        due: time of the next timeout [s]; None if there is none.
        ending: outcome and result that the goal gets when the robot rests; None if they depend on how the
            motion ends.
        done: program time reached so far [s].
        step: smallest step between reported program times so far [s].
        late: delay of the start relative to the stamp of the goal [s].
    """

    number: int
    goal_id: str
    goal: Goal
    begins: float
    phase: str = "planning"
    ready: Ready | None = None
    due: float | None = None
    ending: tuple[str, Result] | None = None
    done: float = 0.0
    step: float = STEP
    late: float = 0.0


@dataclass(frozen=True)
class _Tolerances:
    """Tolerances in the robot's order; infinity means no tolerance."""

    path: Values
    goal: Values


@dataclass
class TrajectoryAction:
    """State machine of the FollowJointTrajectory action of one robot.

    Args:
        joints: joints of the robot.
        hold_on_cancel: True to hold a cancelled goal on its path; False to finish a goal that moves.

    Attributes:
        joints: joints of the robot; may be replaced while the action is idle.
    """

    joints: Sequence[Joint]
    hold_on_cancel: bool = True
    _current: _UnderWay | None = field(default=None, init=False)
    _next: _UnderWay | None = field(default=None, init=False)
    _numbers: int = field(default=0, init=False)

    @property
    def is_idle(self) -> bool:
        """True if no goal is active."""
        return self._current is None

    @property
    def moves(self) -> bool:
        """True if the robot moves for a goal, or may begin to do so."""
        return self._current is not None and self._current.phase == "moving"

    @property
    def due(self) -> float | None:
        """Time at which `passed` must be called next [s]; None if nothing is pending."""
        return None if self._current is None else self._current.due

    def plans(self, number: int) -> bool:
        """Return True if the planning of the goal with this number is in progress and still wanted."""
        current = self._current
        return current is not None and current.number == number and current.phase == "planning"

    # clients

    def goal(self, goal_id: str, goal: Goal, now: float) -> tuple[Result | None, list[Action]]:
        """Handle a new goal.

        Args:
            goal_id: id of the goal at the client.
            goal: goal as received.
            now: the time of any monotonic clock [s].

        Returns:
            Two values: the reason why the goal is rejected (None if it is accepted), and the resulting
                actions.
        """
        fault = fault_of(goal, self.joints)
        if fault is None and goal_id in (one.goal_id for one in (self._current, self._next) if one):
            fault = Result(INVALID_GOAL, f"a goal with the id {goal_id[:64]} is under way")
        if fault is not None:
            return fault, []
        self._numbers += 1
        taken = _UnderWay(self._numbers, goal_id, goal, now + goal.starts_in)
        preempted = CANCELED, Result(SUCCESSFUL, "preempted: another goal has come")
        actions: list[Action] = [Accepted(goal_id), *self._end_next(preempted)]
        current = self._current
        if current is None:
            return None, actions + self._plan(taken)
        if current.phase != "moving":
            return None, actions + self._end(preempted) + self._plan(taken)
        self._next = taken
        return None, actions + self._stop(preempted)

    def cancel(self, goal_id: str | None = None) -> list[Action]:
        """Cancel the goal with a given id, or all goals (None). A goal that moves the robot ends when the
        robot rests.
        """
        canceled = CANCELED, Result(SUCCESSFUL, "canceled")
        actions: list[Action] = []
        if self._next is not None and goal_id in (None, self._next.goal_id):
            actions = self._end_next(canceled)
        current = self._current
        if current is None or goal_id not in (None, current.goal_id):
            return actions
        if current.phase != "moving":
            return actions + self._end(canceled)
        return actions + (self._stop(canceled) if self.hold_on_cancel else [])

    # results of orders

    def planned(self, number: int, made: Ready | Result, now: float) -> list[Action]:
        """Handle the end of planning, with the planned goal, or with a `Result` if planning has failed. A
        goal that has ended during planning isn't run.
        """
        current = self._current
        if current is None or not self.plans(number):
            return []
        if isinstance(made, Result):
            return self._end((ABORTED, made))
        current.ready, current.phase = made, "ready"
        if current.begins > now:
            current.due = current.begins
            return []
        return self._begin(current, now)

    def ended(self, number: int, failed: Result | None, now: float) -> list[Action]:
        """Handle the end of a motion that `Move` has begun, with the robot at rest.

        Args:
            number: number of the goal.
            failed: reason why the robot isn't at the goal's end; None if it is.
            now: the time [s].
        """
        current = self._current
        if current is None or current.number != number or current.phase != "moving":
            return []
        if current.ending is not None or failed is not None:
            outcome = current.ending or (ABORTED, failed or Result(INVALID_GOAL))
            return self._end(outcome) + self._plan_next()
        return self._settle(current, now)

    def lost(self, reason: str) -> list[Action]:
        """Abort all goals, because the coordinator is lost or the node ends."""
        aborted = ABORTED, Result(INVALID_GOAL, reason)
        return self._end_next(aborted) + (self._end(aborted) if self._current is not None else [])

    def stopped(self, reason: str) -> list[Action]:
        """Handle a stop that somebody has ordered. A goal that doesn't move yet won't begin."""
        aborted = ABORTED, Result(INVALID_GOAL, reason)
        actions = self._end_next(aborted)
        current = self._current
        if current is not None and current.phase in ("planning", "ready"):
            actions += self._end(aborted)
        return actions

    def leave(self, reason: str) -> list[Action]:
        """End all goals. If a goal moves the robot, the robot is first held on its path."""
        aborted = ABORTED, Result(INVALID_GOAL, reason)
        return self.stopped(reason) + (self._stop(aborted) if self.moves else self._end_settling(aborted))

    # reports and time

    def position(self, actual: Moment, done: float | None, now: float) -> list[Action]:
        """Handle a report of the joint positions.

        Args:
            actual: state of the joints in the robot's order.
            done: program time of the goal that moves [s]; None if its motion isn't reported yet, or has
                ended.
            now: the time [s].
        """
        current = self._current
        if current is None or current.ready is None:
            return []
        if current.phase == "settling":
            return self._near(current, actual, now)
        if current.phase != "moving" or done is None:
            return []
        if done > current.done:
            current.step = min(current.step, done - current.done)
            current.done = done
        return self._watched(current, current.ready, actual)

    def passed(self, now: float) -> list[Action]:
        """Handle a timeout: begin a goal whose start is due, or end a goal whose joints haven't arrived in
        time.
        """
        current = self._current
        if current is None or current.due is None or now < current.due:
            return []
        current.due = None
        if current.phase == "ready":
            return self._begin(current, now)
        text = (
            f"the joints weren't at the last point within {self._patience(current):g} s after the "
            f"program's end"
        )
        return self._end((ABORTED, Result(GOAL_TOLERANCE_VIOLATED, text)))

    # goals

    def _plan(self, taken: _UnderWay) -> list[Action]:
        self._current = taken
        return [Plan(taken.number, taken.goal_id, taken.goal)]

    def _plan_next(self) -> list[Action]:
        waiting, self._next = self._next, None
        return [] if waiting is None else self._plan(waiting)

    def _begin(self, current: _UnderWay, now: float) -> list[Action]:
        ready = current.ready
        assert ready is not None
        if current.goal.starts_in != 0.0:
            current.late = max(0.0, now - current.begins)
        current.due = None
        if ready.track is None:
            return self._settle(current, now)
        current.phase = "moving"
        return [Move(current.number)]

    def _settle(self, current: _UnderWay, now: float) -> list[Action]:
        current.phase = "settling"
        patience = self._patience(current)
        current.due = None if math.isinf(patience) else now + patience
        return []

    def _patience(self, current: _UnderWay) -> float:
        given = current.goal.goal_time_tolerance
        return SETTLING if given == 0.0 else math.inf if given < 0.0 else given

    def _stop(self, ending: tuple[str, Result]) -> list[Action]:
        """Bring the robot to rest during a goal. Then the goal ends with the given outcome, unless another
        outcome was set before.
        """
        current = self._current
        assert current is not None
        if current.ending is not None:
            return []
        current.ending = ending
        return [Stop()]

    def _end(self, ending: tuple[str, Result]) -> list[Action]:
        current, self._current = self._current, None
        assert current is not None
        return [End(current.goal_id, *ending)]

    def _end_settling(self, ending: tuple[str, Result]) -> list[Action]:
        return [] if self._current is None else self._end(ending)

    def _end_next(self, ending: tuple[str, Result]) -> list[Action]:
        waiting, self._next = self._next, None
        return [] if waiting is None else [End(waiting.goal_id, *ending)]

    # tolerances

    def _watched(self, current: _UnderWay, ready: Ready, actual: Moment) -> list[Action]:
        """Return the feedback of the goal that moves. Add a stop if the joints are farther from the planned
        path than the goal's path tolerance.
        """
        assert ready.track is not None
        time = current.done - ready.lead
        if time < 0.0:
            desired = Moment(
                _between(ready.course, current.done), actual.velocities, actual.accelerations, time
            )
        else:
            step = current.step
            desired = ready.track.nearest(actual.positions, time - BEHIND * step, time + AHEAD * step)
        actions: list[Action] = [Give(current.goal_id, self._feedback(current.goal, desired, actual))]
        if time < 0.0 or current.ending is not None:
            return actions
        for joint, limit, wanted, found in zip(
            self.joints, self._tolerances(current.goal).path, desired.positions, actual.positions
        ):
            if abs(wanted - found) > limit:
                text = (
                    f"{joint.name} is {abs(wanted - found):.6g} off its path at {time:.3f} s, "
                    f"path_tolerance allows {limit:g}; the robot is held: "
                    "look whether the joint is blocked, or allow more"
                )
                return actions + self._stop((ABORTED, Result(PATH_TOLERANCE_VIOLATED, text)))
        return actions

    def _near(self, current: _UnderWay, actual: Moment, now: float) -> list[Action]:
        """End a goal if the joints are at its last point, or haven't arrived in time."""
        ready = current.ready
        assert ready is not None
        last = self._last(current)
        limits = self._tolerances(current.goal).goal
        if all(abs(a - b) <= limit for a, b, limit in zip(last, actual.positions, limits)):
            note = "the robot was there already" if ready.track is None else ""
            if current.late > 0.1:
                note = f"it began {current.late:.2f} s later than its stamp says, since planning took so long"
            return self._end((SUCCEEDED, Result(SUCCESSFUL, note)))
        if current.due is not None and now >= current.due:
            off = [abs(a - b) - limit for a, b, limit in zip(last, actual.positions, limits)]
            worst = off.index(max(off))
            text = (
                f"{self.joints[worst].name} is {abs(last[worst] - actual.positions[worst]):.6g} off the "
                f"last point {self._patience(current):g} s after "
                f"the program's end, goal_tolerance allows {limits[worst]:g}"
            )
            return self._end((ABORTED, Result(GOAL_TOLERANCE_VIOLATED, text)))
        return []

    def _last(self, current: _UnderWay) -> Values:
        point, names = current.goal.points[-1], current.goal.joint_names
        return tuple(point.positions[names.index(one.name)] for one in self.joints)

    def _tolerances(self, goal: Goal) -> _Tolerances:
        path = {one.name: one.position for one in goal.path_tolerance}
        end = {one.name: one.position for one in goal.goal_tolerance}
        return _Tolerances(
            tuple(_limit(path.get(one.name, 0.0), math.inf) for one in self.joints),
            tuple(_limit(end.get(one.name, 0.0), GOAL_TOLERANCE[one.unit]) for one in self.joints),
        )

    def _feedback(self, goal: Goal, desired: Moment, actual: Moment) -> Feedback:
        """Return feedback in the order of the goal's joints."""
        names = [one.name for one in self.joints]
        order = [names.index(name) for name in goal.joint_names]
        desired, actual = _reordered(desired, order), _reordered(actual, order)
        actual = Moment(actual.positions, actual.velocities, actual.accelerations, desired.time)
        error = Moment(
            _minus(desired.positions, actual.positions),
            _minus(desired.velocities, actual.velocities),
            (),
            desired.time,
        )
        return Feedback(goal.joint_names, desired, actual, error)


def _limit(given: float, default: float) -> float:
    return default if given == 0.0 else math.inf if given < 0.0 else given


def _reordered(moment: Moment, order: Sequence[int]) -> Moment:
    def ordered(values: Values) -> Values:
        return tuple(values[place] for place in order) if values else ()

    return Moment(
        ordered(moment.positions), ordered(moment.velocities), ordered(moment.accelerations), moment.time
    )


def _minus(first: Values, second: Values) -> Values:
    return tuple(a - b for a, b in zip(first, second))


def _between(course: Sequence[tuple[float, Values]], time: float) -> Values:
    """Return joint positions at a time, interpolated linearly between the samples of a planned motion."""
    before = course[0]
    for after in course:
        if after[0] >= time:
            share = 0.0 if after[0] <= before[0] else (time - before[0]) / (after[0] - before[0])
            return tuple(a + share * (b - a) for a, b in zip(before[1], after[1]))
        before = after
    return before[1]
