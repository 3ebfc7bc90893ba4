"""A live motion that is under way: whoever has it says again and again what is wanted."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np

from yarclang.coordinator.engine import Running
from yarclang.coordinator.live.generator import WATCHDOG, Generator
from yarclang.coordinator.live.steering import JointVelocity, Master, Target, Twist
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.outcome import Ended


class Drive:
    """The robot moves as long as somebody says so: without a message for 200 ms it comes to rest, and the drive has ended.

    Args:
        robot: that moves.
        generator: makes its motion.
        running: the motion.
        now: the session's clock [s].
        stop: ends it by a hold, at once.
        tell: tells everybody why it doesn't do what is wanted, and which bodies and zones that is about.
        lag: what lies in the controller's buffer [s].
        check: raises if whoever has it doesn't own the robot any more.

    Attributes:
        lag: whatever is wanted is done so much later [s]; a stop isn't.
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
        """Whether it still takes what is wanted."""
        return not self._running.has_ended

    @property
    def end(self) -> Array:
        """(n,) where what is streamed ends so far [rad or m]."""
        return self._generator.end

    @property
    def why(self) -> str:
        """Why it doesn't do what is wanted; empty: it does."""
        return self._generator.why

    def want(self, target: Target) -> None:
        """This is wanted from now on, for 200 ms.

        Raises:
            NotOwner: the robot was given to somebody else; it comes to rest.
            Trouble: it has ended, or a number isn't finite.
        """
        self._check()
        if not self.alive:
            raise Trouble(
                f"the live motion has ended: nobody said for {WATCHDOG:g} s what is wanted, or somebody stopped it",
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
        """One joint moves with `speed` [rad/s or m/s], to either side.

        Raises:
            Trouble: there is no such joint; else as `want`.
        """
        self.want(joint_target(self._robot, name, speed))

    def twist(
        self,
        linear: Sequence[float] = (0.0, 0.0, 0.0),
        angular: Sequence[float] = (0.0, 0.0, 0.0),
        axes: Literal["base", "tool"] = "base",
    ) -> None:
        """The tool moves along and turns about axes of {B} or its own [m/s, rad/s]; else as `want`."""
        self.want(Twist(np.asarray(linear, dtype=float), np.asarray(angular, dtype=float), axes))

    def follow(self, q: Array, rate: Array | None = None) -> None:
        """Be where a master is: joints (n,) [rad or m], which move with `rate` (n,); else as `want`."""
        self.want(Master(q, np.zeros_like(q) if rate is None else rate))

    def finish(self) -> None:
        """Come to rest within the limits, behind what lies in the buffer, and end."""
        self._generator.finish()

    def stop(self) -> None:
        """Come to rest at once, by a hold on the path, and end."""
        if self.alive:
            self._stop()

    async def ended(self) -> Ended:
        """How it has ended, when it has."""
        return await self._running.ended()


def joint_target(robot: Robot, name: str, speed: float) -> JointVelocity:
    """One joint's velocity.

    Raises:
        Trouble: there is no such joint.
    """
    names = [one.upper() for one in robot.joint_names]
    if name.upper() not in names:
        raise Trouble(f"there is no joint {name}", f"there are {', '.join(robot.joint_names)}", "Y1616")
    velocity = np.zeros(robot.size)
    velocity[names.index(name.upper())] = speed
    return JointVelocity(velocity)


def check_finite(target: Target) -> None:
    """Refuse what isn't a number.

    Raises:
        Trouble: a value isn't finite, or there are too few or too many.
    """
    match target:
        case JointVelocity(velocity=velocity):
            values = velocity
        case Twist(linear=linear, angular=angular):
            values = np.concatenate([linear, angular])
        case Master(q=q, rate=rate):
            values = np.concatenate([q, rate])
    if not np.isfinite(values).all():
        raise Trouble("a value of what is wanted isn't finite", "nothing has changed", "Y1616")
