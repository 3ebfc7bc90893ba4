"""Connects the action to a robot that `yarc serve` owns: orders, events, and a new connection when it is served anew. The threads are here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from typing import Protocol

from yarclang.ros.node.action import Feedback, Result
from yarclang.ros.node.trajectory import Goal, Values


@dataclass(frozen=True)
class JointState:
    """Where the joints are, in the order of the robot's joints.

    Attributes:
        names: of the joints.
        positions: [rad or m].
        velocities: [rad/s or m/s].
    """

    names: tuple[str, ...]
    positions: Values
    velocities: Values


@dataclass(frozen=True)
class Status:
    """The fields of industrial_msgs/RobotStatus, with its values: -1 unknown, 0 no, 1 yes.

    Attributes:
        mode: 1 manual (somebody else owns the robot), 2 automatic, -1 unknown.
        e_stopped: always -1: no controller of ours says it.
        drives_powered: 1 if all loops are closed.
        motion_possible: 1 if a goal may move the robot now.
        in_motion: 1 while a program is carried out or joints move.
        in_error: 1 at a fault, without a controller, or after a goal that failed.
        error_code: number of the finding (1612 of Y1612); 0: none.
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
    """What the ROS side does. Called from one thread of the driver, in order; it must not block."""

    def accepted(self, goal_id: str) -> None:
        """Take note that planning begins."""

    def feedback(self, goal_id: str, feedback: Feedback) -> None:
        """Publish how a goal goes on."""

    def ended(self, goal_id: str, outcome: str, result: Result) -> None:
        """End a goal: `outcome` is "succeeded", "aborted" or "canceled". Exactly once a goal that was accepted."""

    def joint_state(self, state: JointState) -> None:
        """Publish where the joints are, 50 times a second."""

    def status(self, status: Status) -> None:
        """Publish how the robot is: at each change, and once a second."""

    def changed(self) -> None:
        """Take note that the robot, its cell or its plan have changed: ask `model`, `scene` and `ghost` again, from another thread."""

    def say(self, level: str, text: str) -> None:
        """Tell people: `level` is "info", "warn" or "error"."""


class Driver:
    """A FollowJointTrajectory action on a robot that `yarc serve` owns.

    Args:
        which: as for `yarclang.client.Robot`: path of the socket, name of the process or of the robot; None: the only one that there is.
        shell: the ROS side.
        name: under which others know the driver.
        hold_on_cancel: True if a cancelled goal is held on its path at once; else it goes on to its end, and a cancellation only keeps goals from beginning.

    Attributes:
        joint_names: of the robot, in its order; empty before `start`.
    """

    joint_names: tuple[str, ...]

    def __init__(
        self, which: str | None, shell: Shell, *, name: str = "ros", hold_on_cancel: bool = True
    ) -> None:
        raise NotImplementedError

    def start(self) -> None:
        """Connect, and serve goals from now on.

        Raises:
            yarclang.client.Gone: nobody serves the robot.
            yarclang.client.Refused: it was denied.
            TimeoutError: it doesn't answer.
        """
        raise NotImplementedError

    def goal(self, goal_id: str, goal: Goal) -> Result | None:
        """Take a goal, at once, from any thread. Return None if it is accepted (planning follows), else why it is rejected."""
        raise NotImplementedError

    def cancel(self, goal_id: str | None = None) -> None:
        """Cancel a goal, or whatever goes on (None). It ends "canceled" when the robot rests."""
        raise NotImplementedError

    def hold(self) -> tuple[bool, str]:
        """Hold the robot on its path, ready to go on. Return True if that was taken, and what was answered."""
        raise NotImplementedError

    def resume(self) -> tuple[bool, str]:
        """Go on after a hold; returns as `hold`."""
        raise NotImplementedError

    def stop(self) -> tuple[bool, str]:
        """Come to rest on the path and end what is under way; returns as `hold`."""
        raise NotImplementedError

    def override(self, percent: float) -> tuple[bool, str]:
        """Change the pace, 1 to 100 %; returns as `hold`."""
        raise NotImplementedError

    def model(self) -> dict[str, Any]:
        """Return the answer of the order `model`.

        Raises:
            yarclang.client.Gone: nobody serves the robot.
            yarclang.client.Refused: it was denied.
            TimeoutError: it doesn't answer.
        """
        raise NotImplementedError

    def scene(self) -> dict[str, Any]:
        """Return the answer of the order `scene`; raises as `model`."""
        raise NotImplementedError

    def ghost(self) -> list[tuple[float, Values]]:
        """Return (time [s], positions [rad or m] in the order of `joint_names`) of the plan under way, thinned; empty if there is none."""
        raise NotImplementedError

    def close(self) -> None:
        """Go away. If a goal of ours moves, the robot comes to rest on its path first."""
        raise NotImplementedError
