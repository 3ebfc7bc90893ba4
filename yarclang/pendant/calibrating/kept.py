"""Running calibrations: at most one for each session, with the robot's recorded positions (touches)."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from itertools import count

import numpy as np

from yarclang.calibration.touching import FrameTouching, HomeTouching, TipTouching, Touching
from yarclang.coordinator.messages import orders
from yarclang.pendant.accounts.sessions import Session
from yarclang.pendant.messages import calibration as said
from yarclang.pendant.standing import stands
from yarclang.pendant.watched import Watched
from yarclang.robot.actuation import counts_per_joint
from yarclang.robot.joint_names import joint_number, listed_joints
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.semantics.names.scope import BASE

MOST_TOUCHES = 40
"""Largest number of touches of one calibration."""

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,59}")


@dataclass(slots=True, eq=False)
class Calibration:
    """A running calibration of one session.

    Attributes:
        user: name of the user.
        touching: recorded positions of the robot, and the result that follows from them.
        tool: name of the tool frame that touches, in braces; empty for a calibration without one.
        version: number that changes whenever the calibration changes.
    """

    user: str
    touching: Touching
    tool: str
    version: int

    @property
    def kind(self) -> str:
        """Kind of the calibration: `tip`, `frame` or `home`."""
        return KINDS[type(self.touching)]


KINDS: dict[type[Touching], str] = {TipTouching: "tip", FrameTouching: "frame", HomeTouching: "home"}


class Calibrations:
    """The running calibrations of all sessions.

    Args:
        robot: the robot that is calibrated.
        watched: shared client of the coordinator, which knows the robot's state.
    """

    def __init__(self, robot: Robot, watched: Watched) -> None:
        self._robot = robot
        self._watched = watched
        self._kept: dict[str, Calibration] = {}
        self._versions = count(1)

    def of(self, session: Session) -> Calibration | None:
        """Return the calibration of a session; None if there is none."""
        return self._kept.get(session.id)

    def other(self) -> Calibration | None:
        """Return the newest calibration of all sessions; None if there is none."""
        return max(self._kept.values(), key=lambda one: one.version, default=None)

    def forget(self, session: str) -> None:
        """Forget the calibration of the session with this id."""
        self._kept.pop(session, None)

    def going_on(self, session: Session, version: int) -> Calibration:
        """Return the calibration of a session. Check that the page shows its newest version.

        Args:
            session: session of the page.
            version: version that the page shows.

        Raises:
            Trouble: the session has no calibration, or it has changed since the page showed it.
        """
        calibration = self._kept.get(session.id)
        if calibration is None:
            raise Trouble("no calibration is in progress", "begin one", "gone")
        if calibration.version != version:
            what = "the calibration was changed on another page"
            raise Trouble(what, "check its touches, and try again", "changed")
        return calibration

    async def begin(self, session: Session, request: said.BeginCalibration) -> Calibration:
        """Begin a calibration.

        Args:
            session: session of the user.
            request: kind of the calibration, with its parameters.

        Raises:
            Trouble: the session already has a calibration with touches and `request.anew` is False, or the
                request names an unknown joint or frame.
        """
        requested, tool = request.calibration, ""
        match requested:
            case said.TipCalibration():
                touching: Touching = TipTouching(self._robot, tip_name(requested.name))
            case said.FrameCalibration():
                tool, pose = await self._tool(requested.tool)
                touching = FrameTouching(self._robot, await self._frame_name(requested.name), pose)
            case said.OffsetCalibration():
                touching = HomeTouching(self._robot, self._marks(requested))
        going = self._kept.get(session.id)
        if going is not None and going.touching.joints and not request.anew:
            what = (
                f"a calibration of {going.touching.name} is in progress, with "
                f"{len(going.touching.joints)} touches"
            )
            raise Trouble(what, "continue or discard it", "going")
        made = Calibration(session.user, touching, tool, next(self._versions))
        self._kept[session.id] = made
        return made

    async def touch(self, session: Session, request: said.TakeTouch) -> Calibration:
        """Record the robot's present position as a touch.

        Raises:
            Trouble: the robot moves or isn't referenced, its position equals that of another touch, there are
                too many touches, or the calibration has changed since the page showed it.
        """
        calibration = self.going_on(session, request.version)
        count_before = len(calibration.touching.joints)
        if request.at is None and count_before >= MOST_TOUCHES:
            raise Trouble(
                f"{count_before} touches are recorded, and no more can be added",
                "remove the worst touch",
                "most",
            )
        _check_there(request.at, count_before)
        joints = await stands(self._watched, self._motors(calibration.touching))
        # Check again: during the wait, another page may have changed the calibration.
        calibration = self.going_on(session, request.version)
        self._check_new(calibration.touching, joints, request.at)
        calibration.touching.touch(joints, request.at)
        calibration.version = next(self._versions)
        return calibration

    def remove(self, session: Session, request: said.RemoveTouch) -> Calibration:
        """Remove a touch.

        Raises:
            Trouble: there is no such touch, the next touch would take its role (such as the origin of a
                frame), or the calibration has changed since the page showed it.
        """
        calibration = self.going_on(session, request.version)
        _check_there(request.at, len(calibration.touching.joints))
        if not calibration.touching.can_go(request.at):
            what = f"touch {request.at + 1} can't be removed: the next touch would take its place"
            raise Trouble(what, "record it again, or remove the touches after it first", "order")
        calibration.touching.untouch(request.at)
        calibration.version = next(self._versions)
        return calibration

    def _motors(self, touching: Touching) -> Collection[int] | None:
        """Return the motors that must be referenced for a touch; None for all motors.

        For a calibration of motor offsets, these are the motors that move the calibrated joints, directly or
        through coupled joints. A motor's offset follows from its encoder count and the positions of all
        joints that it moves, so other motors need not be referenced.
        """
        if not isinstance(touching, HomeTouching):
            return None
        linked = counts_per_joint(self._robot) != 0.0
        joints = np.array([name in touching.marks for name in self._robot.joint_names])
        while True:
            motors = linked[:, joints].any(axis=1)
            more = linked[motors].any(axis=0)
            if (more == joints).all():
                numbers = self._robot.controller.motors
                return {number for number, needed in zip(numbers, motors, strict=True) if needed}
            joints = more

    def _check_new(self, touching: Touching, joints: Array, at: int | None) -> None:
        """Check that the robot's position differs from those of the other touches.

        For a calibration of motor offsets nothing is checked: there, the joints are moved to the same marks
        several times.
        """
        if isinstance(touching, HomeTouching):
            return
        for number, other in enumerate(touching.joints):
            if number != at and np.abs(other - joints).max() < _SAME:
                what = f"the robot is at the same position as at touch {number + 1}: this adds no information"
                raise Trouble(what, "move it, then touch again", "same")

    def _marks(self, request: said.OffsetCalibration) -> dict[str, float]:
        robot, marks = self._robot, {}
        for name, value in request.marks.items():
            at = joint_number(robot.joint_names, name)
            if at is None:
                problem = f"{robot.name} has no joint {name[:40]!r}"
                raise Trouble(problem, f"its joints are {listed_joints(robot.joint_names)}", "joints")
            if robot.joint_names[at] in marks:
                raise Trouble(f"joint {name[:40]} is named twice", "remove one of the two", "joints")
            unit, factor = robot.axis_unit_names[at], float(robot.axis_units[at])
            lower, upper = float(robot.limits.lower[at]) / factor, float(robot.limits.upper[at]) / factor
            if not lower <= value <= upper:
                problem = (
                    f"the mark of {robot.joint_names[at]} at {value:g} {unit} is beyond its limits, "
                    f"{lower:g} to {upper:g} {unit}"
                )
                raise Trouble(problem, "give the joint position at the mark", "joints")
            marks[robot.joint_names[at]] = value * factor
        return {name: marks[name] for name in robot.joint_names if name in marks}

    async def _tool(self, name_asked: str) -> tuple[str, Array]:
        name = f"{{{name_asked.strip('{} ').upper()}}}"
        for one in (await self._watched.attached.ask(orders.AskFrames())).frames:
            if one.name.upper() == name and one.on_flange:
                return name, np.array(one.pose)
        raise Trouble(
            f"{name_asked[:40]!r} isn't a frame on the flange, so it can't touch anything",
            "choose one from the list",
            "frame",
        )

    async def _frame_name(self, name_asked: str) -> str:
        name = plain_name(name_asked)
        known = (await self._watched.attached.ask(orders.AskFrames())).frames
        moves = any(one.on_flange and one.name.upper() == f"{{{name}}}" for one in known)
        if moves or name in ("TCP", "FLANGE", BASE):
            raise Trouble(f"{{{name}}} is a frame of the robot", "choose another name", "name")
        return name


_SAME = 1e-6
"""Largest distance between joint positions that count as equal [rad or m]."""


def plain_name(any_name: str) -> str:
    """Return the name of a frame, as typed by a user, in upper case and without braces.

    Raises:
        Trouble: the name isn't allowed for a frame.
    """
    name = any_name.strip("{} ")
    if _NAME.fullmatch(name) is None:
        what = f"{name[:60]!r} isn't a valid name"
        raise Trouble(what, "a name has up to 60 letters, digits and _, and begins with a letter", "name")
    return name.upper()


def tip_name(wanted: str) -> str:
    """Return the name of a tool frame, as typed by a user, in upper case and without braces.

    Raises:
        Trouble: the name isn't allowed for a tool.
    """
    name = plain_name(wanted)
    if name in ("FLANGE", BASE):
        raise Trouble(f"{{{name}}} is a frame of the robot, which has no tip", "name the tool", "name")
    return name


def _check_there(at: int | None, touches_known: int) -> None:
    if at is not None and at >= touches_known:
        raise Trouble(
            f"there is no touch {at + 1}: {touches_known} are recorded", "reload the touches", "gone"
        )
