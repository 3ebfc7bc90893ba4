"""Define the content of a file that is converted (targets and joint positions), and the options of the
conversion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array
from yarclang.robot.model import Robot
from yarclang.units import Kind, Unit

Target = Literal["JOINTS", "RPY", "QUAT"]
Form = Literal["moves", "spline", "timed"]


@dataclass(frozen=True, slots=True)
class Wishes:
    """Options of a conversion.

    Attributes:
        units: units of columns whose names contain no unit.
        joints: the names that the robot's joints have in the file, in the robot's order; empty if the file
            uses the robot's names.
        form: `moves` if the robot stops at each target, `spline` if it passes all targets without a stop,
            `timed` if it passes them at their times; None to choose by the file's content.
        time: motion time that the program gives in square brackets; None to use the times in the file.
        every: n to keep each n-th target.
        tolerance: omit targets whose distance from the program's path is at most this [deg and mm]; None to
            omit none for this reason.
        beside: prefix for the names of files that may be written into the program's folder; None to write
            everything into the program.
        topic: the only topic of a bag to read; None for all topics with trajectories.
    """

    units: Mapping[Kind, Unit] = field(default_factory=dict)
    joints: tuple[str, ...] = ()
    form: Form | None = None
    time: str | None = None
    every: int = 1
    tolerance: float | None = None
    beside: str | None = None
    topic: str | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A motion: its targets in the order in which they are passed.

    Attributes:
        target: kind of the targets: JOINTS, RPY or QUAT.
        values: (w, k) joint values, or poses of {TCP} in {B} (x y z roll pitch yaw, or x y z qx qy qz qw)
            [deg, mm].
        times: (w,) increasing times [s]; None without times. A first target at time 0 is the start position
            of the robot.
        names: one name for each target, empty for a target without a name; () if no target has one.
        comments: one comment for each target, empty for a target without a comment; () if no target has one.
        remarks: sentences for the reader of the program.
        velocities: (w, k) velocities of joint values [deg/s, mm/s]; None without velocities.
        accelerations: (w, k) accelerations of joint values [deg/s^2, mm/s^2]; None without accelerations.
    """

    target: Target
    values: Array
    times: Array | None = None
    names: tuple[str, ...] = ()
    comments: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    velocities: Array | None = None
    accelerations: Array | None = None

    @property
    def size(self) -> int:
        """Number of targets."""
        return len(self.values)

    def only(self, kept: NDArray[np.intp]) -> Course:
        """Return the course reduced to the targets with the given indices (m,), which are in increasing
        order.
        """
        return Course(
            self.target,
            self.values[kept],
            None if self.times is None else self.times[kept],
            tuple(self.names[one] for one in kept) if self.names else (),
            tuple(self.comments[one] for one in kept) if self.comments else (),
            self.remarks,
            None if self.velocities is None else self.velocities[kept],
            None if self.accelerations is None else self.accelerations[kept],
        )

    @property
    def begins(self) -> bool:
        """True if the first target is the position of the robot at time 0."""
        return self.times is not None and bool(self.times[0] == 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Content:
    """The motions and joint positions that a converted file contains.

    Attributes:
        kind: kind of the file, in words.
        courses: its motions.
        positions: names and values (n,) of joint positions [deg, mm].
    """

    kind: str
    courses: tuple[Course, ...] = ()
    positions: tuple[tuple[str, Array], ...] = ()


@dataclass(frozen=True, slots=True)
class Converted:
    """The program that a conversion makes.

    Attributes:
        text: the program.
        files: names and texts of the files that the program refers to.
    """

    text: str
    files: tuple[tuple[str, str], ...] = ()


def in_axis_units(robot: Robot, q: Array) -> Array:
    """Convert joint values (w, n) from rad or m to deg or mm."""
    values: Array = np.asarray(q, dtype=np.float64) / robot.axis_units
    return values
