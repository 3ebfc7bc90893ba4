"""A live motion that one client steers by messages, which are converted to targets of the motion."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from yarclang.coordinator.engine import UNDER_WAY
from yarclang.coordinator.live.drive import Drive
from yarclang.coordinator.live.opening import Settings
from yarclang.coordinator.live.steering import JointVelocity, Master, Target, Twist
from yarclang.coordinator.messages import orders, replies, wants
from yarclang.diagnostics import Diagnostic
from yarclang.robot.joint_names import listed_joints, numbers_by_name
from yarclang.robot.kinematics.inverse import follow, reached_within
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.transforms import rpy_rotation
from yarclang.units import DEG, MM

if TYPE_CHECKING:
    from yarclang.coordinator.client import Client

_SMOOTH = 0.3
"""Weight of the newest estimate of the master's velocity in the moving average of all estimates."""

_LONGEST_GAP = 0.2
"""Longest time between two positions of a master from which its velocity is estimated [s]."""

_JUMP = 0.5
"""Largest change of a joint between the master's current and previous poses [rad or m]. A larger change is
refused, because the robot would have to jump.
"""


class Reader:
    """Converts a client's messages to targets of a live motion. The velocity of a master arm is sent with its
    position, or estimated from its earlier positions.

    Args:
        robot: the robot that is steered.
        tool: (4, 4) flange_from_tool, used for poses.
        start: (n,) position of the robot [rad or m].
    """

    def __init__(self, robot: Robot, tool: Array, start: Array) -> None:
        self._robot = robot
        self._tool = tool
        self._last = start
        self._heard: float | None = None
        self._rate = np.zeros(robot.size)

    def read(self, want: wants.Want, now: float) -> Target | None:
        """Return the target that a message asks for; None: come to rest.

        Args:
            want: the message.
            now: time at which the message arrived [s].

        Raises:
            Trouble: the robot can't follow the target.
        """
        match want:
            case wants.BeThere(joints=joints, rate=rate):
                units = self._robot.axis_units
                wanted = self._numbers(joints) * units
                return self._master(wanted, None if rate is None else self._numbers(rate) * units, now)
            case wants.HoldPose(pose=pose):
                return self._pose(np.array(pose), now)
            case wants.MoveJoints(velocity=velocity):
                return self._velocity(velocity)
            case wants.MoveTool(twist=twist, axes=axes):
                values = np.array(twist)
                return Twist(values[:3] * MM, values[3:] * DEG, axes)
            case _:
                return None

    def _numbers(self, values: tuple[float, ...]) -> Array:
        if len(values) != self._robot.size:
            names = " ".join(self._robot.joint_names)
            raise Trouble(
                f"{self._robot.size} finite numbers are needed, one per joint ({names})", code="Y1616"
            )
        return np.array(values)

    def _pose(self, values: Array, now: float) -> Master:
        pose = np.eye(4)
        pose[:3, :3] = rpy_rotation(values[3:] * DEG)
        pose[:3, 3] = values[:3] * MM
        chain = self._robot.chain
        q, off, turned = follow(chain, (pose @ np.linalg.inv(self._tool))[None], self._last[None])
        miss = max(float(off[0]), float(turned[0]))
        if miss > reached_within(chain):
            what = f"the pose is out of reach by {off[0] / MM:.1f} mm, {turned[0] / DEG:.2f} deg"
            raise Trouble(what, code="Y1616")
        if np.abs(q[0] - self._last).max() > _JUMP:
            what = "the pose is too far from the one before: another configuration, or a jump"
            raise Trouble(what, code="Y1616")
        return self._master(q[0], None, now)

    def _master(self, q: Array, rate: Array | None, now: float) -> Master:
        limits = self._robot.limits
        past = np.maximum(q - limits.upper, limits.lower - q)
        if (past > 0.0).any():
            joint = int(np.argmax(past))
            raise Trouble(f"{self._robot.joint_names[joint]} would exceed its limits", code="Y1616")
        if rate is None:
            gap = None if self._heard is None else now - self._heard
            if gap is None or not 0.0 < gap < _LONGEST_GAP:
                self._rate = np.zeros(len(q))
            else:
                self._rate = (1.0 - _SMOOTH) * self._rate + _SMOOTH * (q - self._last) / gap
            rate = self._rate
        self._heard, self._last = now, q
        return Master(q, rate)

    def _velocity(self, values: dict[str, float]) -> JointVelocity:
        names = numbers_by_name(self._robot.joint_names)
        known = [names[name.upper()] for name in values if name.upper() in names]
        if len(set(known)) < len(known) or len({name.upper() for name in values}) < len(values):
            raise Trouble("a joint is named twice", code="Y1616")
        velocity = np.zeros(self._robot.size)
        for name, value in values.items():
            if name.upper() not in names:
                what = f"{name[:40]!r} isn't a joint; there are {listed_joints(self._robot.joint_names)}"
                raise Trouble(what, code="Y1616")
            velocity[names[name.upper()]] = value
        return JointVelocity(velocity * self._robot.axis_units)


class Steered:
    """The live motion of one client, if any.

    Args:
        client: the client that moves the robot.
        now: the session's clock [s].
        rests: returns the number of stops, aborts and holds so far.
    """

    def __init__(self, client: Client, now: Callable[[], float], rests: Callable[[], int]) -> None:
        self._client = client
        self._now = now
        self._rests = rests
        self._begun_at: int | None = None
        self._moving = "{TCP}"
        self._settings = Settings()
        self._title = "master"
        self._again = True
        self._over = False
        self._drive: Drive | None = None
        self._reader: Reader | None = None

    def set(self, order: orders.Steer) -> None:
        """Set the settings of the next motions."""
        name = order.moving.strip("{} ")
        self._moving = f"{{{name}}}"
        self._settings = Settings(speed=None if order.speed is None else order.speed * MM, share=order.share)
        self._title, self._again, self._over = order.title, order.again, False
        self._reader = self._begun_at = None

    async def take(self, want: wants.Want) -> replies.Wanted:
        """Carry out a message: set the target of the live motion, or begin the motion if there is none.

        Raises:
            NotOwner: the client only watches.
            Trouble: the message can't be executed.
        """
        reader = await self._read_by(want)
        target = reader.read(want, self._now())
        if target is None:
            if self._drive is not None and self._drive.alive:
                self._drive.finish()
            self._begun_at = None
            return replies.Wanted(lag_s=0.0, behind=None, why="")
        drive = await self._driven(target)
        behind = None
        if isinstance(target, Master):
            robot = self._client.robot
            values = np.round((target.q - drive.end) / robot.axis_units, 4).tolist()
            behind = dict(zip(robot.joint_names, values, strict=True))
        return replies.Wanted(lag_s=round(drive.lag, 3), behind=behind, why=drive.why)

    async def _read_by(self, want: wants.Want) -> Reader:
        """Return the reader that converts a message to a target. If no motion is in progress, a new reader is
        created, since the robot may be elsewhere by now.
        """
        robot = self._client.robot
        if not isinstance(want, wants.BeThere | wants.HoldPose):
            return Reader(robot, np.eye(4), np.zeros(robot.size))
        if self._reader is None or not (self._drive is not None and self._drive.alive):
            frame = self._client.session.frame(self._moving)
            if frame.value is None:
                raise Trouble(frame.diagnostics[0].message, frame.diagnostics[0].help, "Y1616")
            tool = np.asarray(frame.value.transform)
            self._reader = Reader(robot, tool, await self._client.motion.stands())
        return self._reader

    async def _driven(self, target: Target) -> Drive:
        if self._drive is not None and self._drive.alive:
            self._drive.want(target)
            return self._drive
        if self._begun_at not in (None, self._rests()):
            # The master doesn't know of the stop, and keeps sending targets. Without this check, its next
            # target would start the robot again.
            remedy = 'send {"finish": true} first, or connect again'
            raise Trouble("another client has stopped or held the robot", remedy, UNDER_WAY)
        if self._over:
            what = "the live motion has ended: no target came for too long, or the motion was stopped"
            raise Trouble(what, "begin another", UNDER_WAY)
        live, rests = self._client.live, self._rests()
        made = await live.drive(target, moving=self._moving, settings=self._settings, name=self._title)
        if made.value is None:
            raise _refusal(made.diagnostics[0])
        self._drive, self._begun_at = made.value, rests
        self._over = not self._again
        return self._drive

    def stop(self) -> None:
        """Bring the motion to rest at once, because its client has gone."""
        if self._drive is not None:
            self._drive.stop()


def _refusal(finding: Diagnostic) -> Trouble:
    """Convert a finding to a `Trouble` for a client. If the finding is about a line of the cell's or the
    robot's file, the message names the file and the line.
    """
    what = finding.clause
    if finding.source is not None and finding.span is not None and finding.source.name.endswith(".toml"):
        what = f"{finding.source.name}, line {finding.span.line}: {what}"
    return Trouble(what, finding.help, finding.code)
