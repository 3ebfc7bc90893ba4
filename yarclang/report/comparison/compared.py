"""Compare two programs by the behaviour of the robot: paths, times, inverse kinematics solutions, outputs and
waits.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from yarclang.frozen import frozen
from yarclang.pipeline.executed import Act, Executed
from yarclang.progress import tell
from yarclang.report.comparison.paired import pairs_of
from yarclang.report.comparison.path_difference import PathDifference, path_difference
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot, Tolerance

SAME_TIME = 5e-4
"""Durations that differ by less count as equal [s]. Smaller differences come only from rounding: segment
times are multiples of a small step.
"""

_OTHER_JOINTS = 1.0
"""Smallest difference of a joint that counts as another inverse kinematics solution, if the tool is at the
same pose [deg or mm].
"""

Status = Literal["same", "changed", "added", "removed"]


@frozen(eq=False)
class Compared:
    """A command of the first program beside the command of the second program that corresponds to it.

    Attributes:
        first: command of the first program; None if only the second program has it.
        second: command of the second program; None if only the first program has it.
        path: difference of the paths of two motions.
        differs: True if this difference is beyond the tolerance.
        other_branch: True if the tool ends at the same pose, but at different joint positions.
        longer: extra duration of the second command [s]; 0 if the durations differ by at most `SAME_TIME`.
        what: True if two commands without motion do different things.
        carries: True if the robot carries different parts during the two motions.
        touches: True if different pairs of bodies may touch during the two motions.
        keeps: True if different KEEP rules apply to the two motions.
    """

    first: Act | None
    second: Act | None
    path: PathDifference | None = None
    differs: bool = False
    other_branch: bool = False
    longer: float = 0.0
    what: bool = False
    carries: bool = False
    touches: bool = False
    keeps: bool = False

    @property
    def status(self) -> Status:
        """Kind of the difference between the two commands."""
        if self.first is None:
            return "added"
        if self.second is None:
            return "removed"
        different = self.differs or self.other_branch or self.longer != 0.0 or self.what
        different = different or self.carries or self.touches or self.keeps
        return "changed" if different else "same"


@frozen(eq=False)
class Comparison:
    """Two programs side by side.

    Attributes:
        first: actions of the first program.
        second: actions of the second program.
        frame: frame whose path is compared.
        tolerance: tolerance of the comparison.
        start: (n,) difference of the second program's start from the first's [rad or m].
        commands: commands of both programs.
    """

    first: Executed
    second: Executed
    frame: str
    tolerance: Tolerance
    start: Array
    commands: tuple[Compared, ...]

    @property
    def starts_elsewhere(self) -> bool:
        """True if the starts of the programs differ in a joint by more than the tolerance for angles or
        distances.
        """
        return bool((np.abs(self.start) > _allowed(self.first.robot, self.tolerance)).any())

    @property
    def holds_otherwise(self) -> bool:
        """True if the programs watch different inputs to hold the motion, watch them in a different order, or
        react to them differently.
        """
        return self.first.watches != self.second.watches

    @property
    def equal(self) -> bool:
        """True if there is no difference beyond the tolerance."""
        return not (self.starts_elsewhere or self.holds_otherwise) and all(
            one.status == "same" for one in self.commands
        )

    def count(self, status: Status) -> int:
        """Return the number of commands with a given status."""
        return sum(one.status == status for one in self.commands)

    @property
    def worst(self) -> Compared | None:
        """The command with the largest difference of the tool's positions."""
        with_path = [one for one in self.commands if one.path is not None]
        return max(with_path, key=lambda one: one.path.position if one.path else 0.0, default=None)


def compare(first: Executed, second: Executed, tolerance: Tolerance) -> Comparison:
    """Compare two programs for robots of the same kind.

    Args:
        first: actions of the first program.
        second: actions of the second program, for a robot with the same number of joints.
        tolerance: allowed difference of the tool's path.
    """
    robot = second.robot
    frame = "TCP" if "TCP" in robot.flange_from_frame else "FLANGE"
    tell("matching the commands of both programs", 0)
    pairs = pairs_of(first.acts, second.acts)
    commands = []
    for number, (one, other) in enumerate(pairs):
        tell("comparing", number, len(pairs))
        commands.append(_compared(robot, frame, tolerance, one, other))
    return Comparison(first, second, frame, tolerance, second.start - first.start, tuple(commands))


def _compared(robot: Robot, frame: str, tolerance: Tolerance, act: Act | None, other: Act | None) -> Compared:
    if act is None or other is None:
        return Compared(act, other)
    longer = other.duration - act.duration
    longer = longer if abs(longer) > SAME_TIME else 0.0
    if act.curve is None or other.curve is None:
        # two dwells of different duration differ in `what`, which contains the duration
        return Compared(act, other, what=act.what != other.what, longer=longer)
    path = path_difference(robot, frame, act.curve, other.curve)
    differs = path.position > tolerance.position or path.angle > tolerance.angle
    ends = np.stack((act.curve.points[-1], other.curve.points[-1]))
    carries = act.carries is not None and other.carries is not None and act.carries != other.carries
    other_branch = _other_branch(robot, frame, tolerance, ends, path)
    touches, keeps = act.may_touch != other.may_touch, act.keeps != other.keeps
    return Compared(
        act, other, path, differs, other_branch, longer, carries=carries, touches=touches, keeps=keeps
    )


def _other_branch(robot: Robot, frame: str, tolerance: Tolerance, ends: Array, path: PathDifference) -> bool:
    """Return True if the tool has the same pose at two different joint positions, `ends` (2, n)."""
    if path.joint_off <= _OTHER_JOINTS:
        return False
    off = np.abs(ends[1] - ends[0]) / robot.axis_units
    poses = tool_poses(robot.chain, ends, robot.flange_from_frame[frame])
    position = float(np.linalg.norm(poses[1, :3, 3] - poses[0, :3, 3]))
    spread = float(np.linalg.norm(poses[1, :3, :3] - poses[0, :3, :3]))
    alike = position <= tolerance.position and spread / np.sqrt(2.0) <= tolerance.angle
    return bool(alike and off.max() > _OTHER_JOINTS)


def _allowed(robot: Robot, tolerance: Tolerance) -> Array:
    return np.where(robot.chain.is_prismatic, tolerance.position, tolerance.angle)
