"""What a file of another kind says, before it is a program: targets in order, and what was asked of the conversion."""

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
    """What the user said besides the file.

    `units` are those of columns that don't say theirs; `joints` the file's names for the robot's joints, in the
    robot's order (empty: the same names); `form` whether the robot stops at each target, passes all in one go, or at their times (None: by the file); `time`
    what stands in [ ] instead of the file's own times; `every` and `tolerance` [deg and mm] thin the targets out. `beside` begins the names of files that may be
    written beside the program (None: all stands in the program). `topic` of a bag is the only one that is read (None: all with trajectories).
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
    """Targets in the order in which they are passed.

    `values` (w, k) are joint values, or poses of {TCP} in {B} (x y z roll pitch yaw, or x y z qx qy qz qw), in deg and
    mm. `times` (w,) [s] are rising, or None; a first target at time 0 is where the robot stands at first. `velocities` and `accelerations` (w, k) are those of joint values [deg/s, mm/s and per s^2], or None. `names` and `comments` are empty, or have a text (perhaps an empty one)
    for each target. `remarks` are sentences for the reader of the program.
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
        """The number of targets."""
        return len(self.values)

    def only(self, kept: NDArray[np.intp]) -> Course:
        """The targets with these numbers (m,), rising."""
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
        """True if the first target is where the robot stands at time 0."""
        return self.times is not None and bool(self.times[0] == 0.0)


@dataclass(frozen=True, slots=True, eq=False)
class Content:
    """All that a file says: what kind of file it is, in words; courses; named joint positions (n,) [deg, mm]."""

    kind: str
    courses: tuple[Course, ...] = ()
    positions: tuple[tuple[str, Array], ...] = ()


@dataclass(frozen=True, slots=True)
class Converted:
    """A program's text, and the names and texts of the files that stand beside it."""

    text: str
    files: tuple[tuple[str, str], ...] = ()


def in_axis_units(robot: Robot, q: Array) -> Array:
    """Joint values (w, n) [rad or m] in deg and mm."""
    values: Array = np.asarray(q, dtype=np.float64) / robot.axis_units
    return values
