"""The motion link (the connection on which a ROS client sends goals) as a state machine. Its inputs are
messages and times, its outputs are replies and orders. No I/O, no clock.

Each waypoint is answered at once, because ROS-Industrial's client node holds its lock while it waits for a
reply, and a stop waits for that lock. The client ignores the content of the reply. It never marks the end of
a streamed trajectory, so a goal counts as complete after a pause without another waypoint.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from yarclang.ros.refusal import Refusal
from yarclang.ros.simple_message import (
    SLOTS,
    Comm,
    FullPoint,
    Message,
    Ping,
    Sequence,
    TrajectoryPoint,
    reply_to,
)

PAUSE = 0.05
"""Time without another waypoint after which a streamed goal is complete [s]. ROS-Industrial's client node
sends a waypoint every 6 to 8 ms.
"""

PATIENCE = 10.0
"""Time after which an incomplete goal is given up [s]: if its client has disconnected and doesn't reconnect,
or if the next waypoint of a download doesn't arrive.
"""

MOST_POINTS = 20_000
"""Largest number of waypoints of one goal."""

_POINT = "Y1622"
_SEQUENCE = "Y1623"
_AGAIN = "send the goal again"


@dataclass(frozen=True, slots=True)
class Goal:
    """A trajectory that was received.

    Attributes:
        number: number of the goal on its connection, from 1.
        points: waypoints in order. The duration of the first waypoint has no meaning.
        downloaded: True if the client marked the end of the goal; False if the goal was streamed.
    """

    number: int
    points: tuple[TrajectoryPoint, ...]
    downloaded: bool = False


@dataclass(frozen=True, slots=True)
class Answer:
    """Send a message to the client."""

    message: Message


@dataclass(frozen=True, slots=True)
class Plan:
    """Request to plan and prove a goal from the robot's position at rest, and then to call
    `MotionLink.planned`.
    """

    goal: Goal


@dataclass(frozen=True, slots=True)
class Move:
    """Run the planned goal of this number, then call `MotionLink.ended`."""

    number: int


@dataclass(frozen=True, slots=True)
class Stop:
    """Come to rest on the path at once, and end the running motion."""


@dataclass(frozen=True, slots=True)
class Hold:
    """Come to rest on the path, ready to continue."""


@dataclass(frozen=True, slots=True)
class Refused:
    """Report a refusal on the terminal. It is also in `MotionLink.refusal`."""

    refusal: Refusal


@dataclass(frozen=True, slots=True)
class Told:
    """Print a line on the terminal."""

    text: str


Action = Answer | Plan | Move | Stop | Hold | Refused | Told


@dataclass(slots=True)
class _Incoming:
    """A goal whose waypoints are being received.

    Attributes:
        number: number of the goal.
        downloaded: True for a download, False for a stream.
        points: waypoints received so far.
        due: time at which the goal is complete, or is given up [s]; None if no more waypoints are expected.
        complete: True if all waypoints were received.
        cut: True if the client disconnected before the goal was complete.
    """

    number: int
    downloaded: bool
    points: list[TrajectoryPoint] = field(default_factory=list)
    due: float | None = None
    complete: bool = False
    cut: bool = False

    def goal(self) -> Goal:
        return Goal(self.number, tuple(self.points), self.downloaded)


class MotionLink:
    """State machine of the motion link of one robot. At most one client is connected at a time.

    Args:
        joints: number of the robot's joints; further joint slots of a message are 0.
        pause: time without another waypoint after which a streamed goal is complete [s].
        patience: time for which an incomplete goal waits [s].
        hold_on_disconnect: True to hold the robot if its client disconnects during a motion; False to finish
            the goal.

    Attributes:
        refusal: reason why the last goal or its execution has failed; None if it hasn't. It is kept until the
            next goal begins.
    """

    def __init__(
        self,
        joints: int,
        *,
        pause: float = PAUSE,
        patience: float = PATIENCE,
        hold_on_disconnect: bool = False,
    ) -> None:
        self.refusal: Refusal | None = None
        self._joints = joints
        self._pause = pause
        self._patience = patience
        self._hold_on_disconnect = hold_on_disconnect
        self._goals = 0
        self._incoming: _Incoming | None = None
        self._planning: Goal | None = None
        self._moving: Goal | None = None
        self._stopping = False
        self._last: TrajectoryPoint | None = None
        self._is_new = True
        """True until the first waypoint of this connection arrives."""
        self._rejects = False
        """True while waypoints are dropped, until the next goal begins."""

    @property
    def due(self) -> float | None:
        """Time at which `passed` must be called next [s]; None if nothing is pending."""
        return None if self._incoming is None else self._incoming.due

    @property
    def phase(self) -> str:
        """Phase of the link: idle, receiving, planning, moving or stopping."""
        if self._moving is not None:
            return "stopping" if self._stopping else "moving"
        if self._incoming is not None:
            return "receiving"
        return "idle" if self._planning is None else "planning"

    @property
    def is_idle(self) -> bool:
        """True if no goal is pending."""
        return self.phase == "idle"

    # the connection

    def connected(self) -> list[Action]:
        """Handle the connection of a client."""
        self._is_new = True
        return []

    def disconnected(self, now: float) -> list[Action]:
        """Handle the disconnection of the client.

        An incomplete goal waits until the client reconnects. The client then repeats the last waypoint, if
        it got no reply to it. With `hold_on_disconnect` a running motion is held on its path, and a goal that
        waits or is being planned is dropped. Without it, motion and goals continue.
        """
        incoming = self._incoming
        if incoming is not None and not incoming.complete:
            incoming.cut, incoming.due = True, now + self._patience
        waiting = self._planning or (incoming.goal() if incoming is not None and incoming.complete else None)
        if waiting is not None and self._hold_on_disconnect:
            self._incoming = self._planning = None
            return [Told(f"the motion client has disconnected: goal {waiting.number} is forgotten")]
        if self._moving is None or self._stopping:
            return []
        if self._hold_on_disconnect:
            return [
                Hold(),
                Told(f"the motion client has disconnected: goal {self._moving.number} is held on its path"),
            ]
        return [Told(f"the motion client has disconnected: goal {self._moving.number} continues")]

    # messages

    def heard(self, message: Message, now: float) -> list[Action]:
        """Handle a message of the client. Return the resulting actions, with a reply if the message is a
        request.

        Args:
            message: message as decoded.
            now: the time of any monotonic clock [s].
        """
        if message.comm is Comm.REPLY:
            return []
        match message.body:
            case TrajectoryPoint(sequence=Sequence.STOP):
                taken, actions = True, self._stopped()
            case TrajectoryPoint() as point:
                taken, actions = self._point(point, now)
            case Ping():
                taken, actions = True, []
            case FullPoint():
                what = "a point with the derivatives of all joints (message 14) isn't supported"
                taken, actions = (
                    False,
                    self._refuse(_POINT, what, "use the stock nodes, which send message 11"),
                )
            case other:
                taken, actions = (
                    False,
                    [Told(f"the motion client sends messages of kind {other.kind}: they are ignored")],
                )
        if message.comm is Comm.REQUEST:
            # The orders are before the reply, so that a stop is sent before anything else.
            actions = [*actions, Answer(reply_to(message, success=taken))]
        return actions

    def passed(self, now: float) -> list[Action]:
        """Handle a timeout: a goal that is being received is complete, or is given up."""
        incoming = self._incoming
        if incoming is None or incoming.due is None or now < incoming.due:
            return []
        count = len(incoming.points)
        if incoming.cut:
            what = (
                f"the connection ended within goal {incoming.number}, after {_counted(count)}, "
                f"and the client didn't reconnect within {self._patience:g} s"
            )
            return self._refuse(_SEQUENCE, f"{what}: the goal is forgotten", _AGAIN)
        if incoming.downloaded:
            what = (
                f"goal {incoming.number}, a download, has no end: nothing came for {self._patience:g} s "
                f"after {_counted(count)}"
            )
            return self._refuse(_SEQUENCE, what, _AGAIN)
        return self._completed()

    # results of orders

    def planned(self, goal: Goal, refusal: Refusal | None) -> list[Action]:
        """Handle the end of planning.

        Args:
            goal: the planned goal. It is outdated if further waypoints of its trajectory have arrived during
                planning.
            refusal: reason why the goal can't be run; None if it can.

        Returns:
            A `Move`, unless the goal was refused, or was stopped or replaced during planning.
        """
        if goal is not self._planning:
            return []
        self._planning = None
        if refusal is not None:
            return self._refused(refusal)
        self._moving, self._stopping = goal, False
        return [Move(goal.number)]

    def ended(self, number: int, refusal: Refusal | None) -> list[Action]:
        """Handle the end of a motion that `Move` has begun, with the robot at rest.

        Args:
            number: number of the goal.
            refusal: reason why the robot isn't at the goal's end; None if it is.

        Returns:
            A `Plan`, if another goal was received during the motion.
        """
        goal = self._moving
        if goal is None or goal.number != number:
            return []
        wanted = self._stopping
        self._moving, self._stopping = None, False
        actions: list[Action] = []
        if refusal is not None and not wanted:
            actions = self._refused(refusal)
        incoming = self._incoming
        if incoming is not None and incoming.complete:
            actions += self._plan(incoming)
        return actions

    # points

    def _point(self, point: TrajectoryPoint, now: float) -> tuple[bool, list[Action]]:
        """Handle a waypoint. Return two values: True if the waypoint belongs to a goal, and the
        resulting actions.
        """
        if self._is_repeated(point):
            incoming = self._incoming
            if incoming is not None and not incoming.complete:
                incoming.cut, incoming.due = False, now + self._wait(incoming)
            self._is_new = False
            return not self._rejects, []
        self._is_new, self._last = False, point
        sequence = point.sequence
        if sequence in (0, Sequence.START_STREAMING, Sequence.START_DOWNLOAD):
            return self._begins(point, now, downloaded=sequence == Sequence.START_DOWNLOAD)
        if sequence == Sequence.END and self._incoming is None:  # a download of one point
            return self._begins(point, now, downloaded=True)
        if self._rejects:
            return False, []
        if sequence < 0 and sequence != Sequence.END:
            what = f"a point has the sequence {sequence}, which has no meaning"
            return False, self._refuse(
                _SEQUENCE, what, "points count from 0; only -1, -2, -3 and -4 have a special meaning"
            )
        return self._goes_on(point, now)

    def _is_repeated(self, point: TrajectoryPoint) -> bool:
        """Return True if a waypoint is a repetition of the last one. The client sends a waypoint again if
        the reply to it was lost with the connection.
        """
        if not self._is_new or self._last != point:
            return False
        # A single point that repeats a finished goal is a new goal, because the robot may have moved since.
        return not (self.is_idle and point.sequence <= 0)

    def _begins(self, point: TrajectoryPoint, now: float, *, downloaded: bool) -> tuple[bool, list[Action]]:
        actions: list[Action] = []
        if self._moving is not None:
            actions.append(Stop())
            self._stopping = True
        self._goals += 1
        self._planning, self._rejects, self.refusal = None, False, None
        incoming = self._incoming = _Incoming(self._goals, downloaded)
        taken, more = self._added(incoming, point, now)
        return taken, actions + more

    def _goes_on(self, point: TrajectoryPoint, now: float) -> tuple[bool, list[Action]]:
        incoming = self._incoming
        if incoming is None and self._planning is not None and not self._planning.downloaded:
            # The client was slow: the goal counted as complete, but has a further point.
            incoming = _Incoming(self._planning.number, downloaded=False, points=list(self._planning.points))
            if point.sequence == len(incoming.points):
                self._planning, self._incoming = None, incoming
                return self._added(incoming, point, now)
        if incoming is not None and self._incoming is None:
            what = f"point {point.sequence} follows {_counted(len(incoming.points))}"
            return False, self._refuse(_SEQUENCE, what, _AGAIN)
        if incoming is None:
            return False, self._stray(point)
        expected = len(incoming.points)
        ends = incoming.downloaded and point.sequence == Sequence.END
        if not ends and point.sequence != expected:
            what = f"goal {incoming.number}: point {point.sequence} follows point {expected - 1}"
            return False, self._refuse(_SEQUENCE, what, _AGAIN)
        return self._added(incoming, point, now)

    def _stray(self, point: TrajectoryPoint) -> list[Action]:
        """Refuse a point that belongs to no goal."""
        moving = self._moving
        if moving is None or self._stopping:
            what = f"point {point.sequence} came without the points before it"
            return self._refuse(_SEQUENCE, what, "a goal begins with the sequence 0")
        what = (
            f"point {point.sequence} came more than {self._pause * 1000.0:g} ms after the one before "
            f"it: goal {moving.number} was taken as "
            f"complete with {_counted(len(moving.points))}, and is stopped"
        )
        return [
            Stop(),
            *self._stop_moving(),
            *self._refuse(_SEQUENCE, what, "find out why the client was slow, then send the goal again"),
        ]

    def _added(self, incoming: _Incoming, point: TrajectoryPoint, now: float) -> tuple[bool, list[Action]]:
        number, place = incoming.number, len(incoming.points)
        if (fault := self._fault(point, first=place == 0)) is not None:
            return False, self._refuse(_POINT, f"goal {number}, point {place}: {fault[0]}", fault[1])
        if place >= MOST_POINTS:
            what = f"goal {number} has more than {MOST_POINTS} points"
            return False, self._refuse(_SEQUENCE, what, "divide it, or plan it with fewer waypoints")
        incoming.points.append(point)
        incoming.complete = incoming.cut = False
        incoming.due = now + self._wait(incoming)
        if incoming.downloaded and point.sequence == Sequence.END:
            return True, self._completed()
        return True, []

    def _fault(self, point: TrajectoryPoint, *, first: bool) -> tuple[str, str] | None:
        """Return the fault of a point and its remedy; None if the point has no fault."""
        names = "check controller_joint_names: it must name the joints of robot.toml in their order"
        for slot, value in enumerate(point.joints):
            if not math.isfinite(value):
                return (
                    f"joint {slot + 1} is {value}",
                    "check the planner: a joint position is a finite number [rad or m]",
                )
            if slot >= self._joints and value != 0.0:
                return f"slot {slot + 1} of {SLOTS} is {value:g}, the robot has {self._joints} joints", names
        if not first and not (math.isfinite(point.duration) and point.duration > 0.0):
            return f"its duration is {point.duration:g} s", "time_from_start must grow from point to point"
        return None

    def _wait(self, incoming: _Incoming) -> float:
        return self._patience if incoming.downloaded else self._pause

    # goals

    def _completed(self) -> list[Action]:
        """Plan a goal whose points are complete. If the robot still moves, the goal is planned later, when
        the robot rests.
        """
        incoming = self._incoming
        assert incoming is not None
        incoming.complete, incoming.due = True, None
        return [] if self._moving is not None else self._plan(incoming)

    def _plan(self, incoming: _Incoming) -> list[Action]:
        self._incoming, self._planning = None, incoming.goal()
        return [Plan(self._planning)]

    def _stopped(self) -> list[Action]:
        """Drop all pending goals, and bring the robot to rest. A motion of another client of the coordinator
        is stopped as well, because everybody may stop the robot.
        """
        forgotten = self._planning is not None or self._incoming is not None
        self._planning = self._incoming = None
        self._rejects = True
        told: list[Action] = [Told("stopped: the goal is forgotten")] if forgotten else []
        return [Stop(), *self._stop_moving(), *told]

    def _stop_moving(self) -> list[Action]:
        if self._moving is None or self._stopping:
            return []
        self._stopping = True
        return [Told(f"stopped: goal {self._moving.number} comes to rest on its path")]

    def _refuse(self, code: str, what: str, help_: str) -> list[Action]:
        return self._refused(Refusal(code, what, help_))

    def _refused(self, refusal: Refusal) -> list[Action]:
        """Drop the goal that is being received or planned, and ignore all waypoints until the next goal
        begins.
        """
        self._incoming = self._planning = None
        self._rejects = True
        self.refusal = refusal
        return [Refused(refusal)]


def _counted(points: int) -> str:
    return "1 point" if points == 1 else f"{points} points"
