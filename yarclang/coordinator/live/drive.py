"""A live motion in progress. Its client sends targets again and again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np

from yarclang.coordinator.engine import Running
from yarclang.coordinator.live.generator import WATCHDOG, Generator
from yarclang.coordinator.live.steering import JointVelocity, Master, Target, Twist
from yarclang.robot.joint_names import joint_number, listed_joints
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.outcome import Ended


class Drive:
    """A live motion, which continues as long as targets arrive. After 200 ms without a target the robot comes
    to rest, and the motion ends.

    Args:
        robot: the robot.
        generator: computes the lines of the motion.
        running: the engine's work that streams the lines.
        now: the session's clock [s].
        stop: ends the motion at once, by a hold.
        tell: reports to all clients why the target isn't followed, and which bodies and zones are in the way.
        lag: duration of the lines in the controller's buffer [s].
        check: raises an error if the client no longer owns the robot.

    Attributes:
        lag: time until a new target takes effect [s]. A stop takes effect at once.
    """

    def __init__(
        self,
        robot: Robot,
        generator: Generator,
        running: Running[Ended],
        now: Callable[[], float],
        stop: Callable[[], None],
        tell: Callable[[str, tuple[str, ...]], None],
        lag: float,
        check: Callable[[], None],
    ) -> None:
        self.lag = lag
        self._check = check
        self._robot = robot
        self._generator = generator
        self._running = running
        self._now = now
        self._stop = stop
        self._tell = tell
        self._told = ""

    @property
    def alive(self) -> bool:
        """Return True if the drive still accepts targets."""
        return not self._running.has_ended

    @property
    def end(self) -> Array:
        """Return the position at the end of the lines streamed so far (n,) [rad or m]."""
        return self._generator.end

    @property
    def why(self) -> str:
        """Return the reason why the target isn't followed; empty if it is."""
        return self._generator.why

    def want(self, target: Target) -> None:
        """Set the target for the next 200 ms.

        Raises:
            NotOwner: the robot was given to another client; it comes to rest.
            Trouble: the drive has ended, or a number isn't finite.
        """
        self._check()
        if not self.alive:
            raise Trouble(
                f"the live motion has ended: no target came for {WATCHDOG:g} s, or the motion was stopped",
                "begin another",
                "Y1612",
            )
        check_finite(target)
        self._generator.want(target, self._now())
        if self._generator.why != self._told:
            self._told = self._generator.why
            if self._told:
                self._tell(self._told, self._generator.stopped_by)

    def joint(self, name: str, speed: float) -> None:
        """Move one joint with `speed` [rad/s or m/s]; the sign is the direction.

        Raises:
            NotOwner: the robot was given to another client; it comes to rest.
            Trouble: there is no such joint, the drive has ended, or a number isn't finite.
        """
        self.want(joint_target(self._robot, name, speed))

    def twist(
        self,
        linear: Sequence[float] = (0.0, 0.0, 0.0),
        angular: Sequence[float] = (0.0, 0.0, 0.0),
        axes: Literal["base", "tool"] = "base",
    ) -> None:
        """Move the tool with a velocity. Raises the same errors as `want`.

        Args:
            linear: velocity of the tool's origin [m/s].
            angular: angular velocity [rad/s].
            axes: axes in which both velocities are given: those of {B}, or those of the tool.
        """
        self.want(Twist(np.asarray(linear, dtype=float), np.asarray(angular, dtype=float), axes))

    def follow(self, q: Array, rate: Array | None = None) -> None:
        """Follow a master arm. Raises the same errors as `want`.

        Args:
            q: (n,) joint positions of the master [rad or m].
            rate: (n,) joint velocities of the master [rad/s or m/s]; None: zero.
        """
        self.want(Master(q, np.zeros_like(q) if rate is None else rate))

    def finish(self) -> None:
        """Bring the robot to rest within the limits, after the lines in the buffer, and end the motion."""
        self._generator.finish()

    def stop(self) -> None:
        """Bring the robot to rest at once, by a hold on the path, and end the motion."""
        if self.alive:
            self._stop()

    async def ended(self) -> Ended:
        """Wait for the end, and return the outcome."""
        return await self._running.ended()


def joint_target(robot: Robot, name: str, speed: float) -> JointVelocity:
    """Return a target that moves one joint.

    Args:
        robot: the robot.
        name: name of the joint.
        speed: velocity of the joint [rad/s or m/s].

    Raises:
        Trouble: there is no such joint.
    """
    number = joint_number(robot.joint_names, name)
    if number is None:
        raise Trouble(f"there is no joint {name}", f"there are {listed_joints(robot.joint_names)}", "Y1616")
    velocity = np.zeros(robot.size)
    velocity[number] = speed
    return JointVelocity(velocity)


def check_finite(target: Target) -> None:
    """Check that a target has the right number of values, and that all of them are finite.

    Raises:
        Trouble: a value isn't finite, or there are too few or too many values.
    """
    match target:
        case JointVelocity(velocity=velocity):
            values = velocity
        case Twist(linear=linear, angular=angular):
            values = np.concatenate([linear, angular])
        case Master(q=q, rate=rate):
            values = np.concatenate([q, rate])
    if not np.isfinite(values).all():
        raise Trouble("a value of the target isn't finite", "nothing has changed", "Y1616")
