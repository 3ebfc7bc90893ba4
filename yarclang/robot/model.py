"""A robot as the stages see it: plain data in SI units, already checked.

`yarclang.robot.description` makes it from a robot.toml and a URDF. Arrays are float64 and read-only,
one entry a joint, from the base to the flange.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from functools import lru_cache
from pathlib import Path
from typing import Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.robot.controller import Controller
from yarclang.shapes import Shape
from yarclang.units import DEG, MM

Array = NDArray[np.float64]

REDUCED_SPEED = 250.0 * MM
"""The largest speed of a tool where people are within reach [m/s] (ISO 10218-1)."""
START_SHARE = 0.05
"""Share of the limits of acceleration and jerk that a robot may use up in the first segment of a motion because it stands beside the start."""
JointKind = Literal["revolute", "prismatic", "continuous"]


@frozen(eq=False)
class Lines:
    """The axes of a chain with all joints at zero, in {B}: unit directions `axes` (n, 3), a point on each, `points` (n, 3) [m], and how much
    a joint turns about its axis and slides along it for each unit of its position, `turn` and `slide` (n,).
    """

    axes: Array
    points: Array
    turn: Array
    slide: Array


class Kinematics(Protocol):
    """Forward kinematics for `yarclang.collision` and `yarclang.handling`, given with a chain."""

    def placements(self, chain: Chain, q: Array) -> Array:
        """Return (n + 1, 3, 4, P) for joint positions (P, n): see `yarclang.robot.placements`."""

    def flange(self, chain: Chain, q: Array) -> Array:
        """Return base_from_flange (P, 4, 4) for joint positions (P, n)."""

    def lines(self, chain: Chain) -> Lines:
        """Return the axes of a chain."""

    def elbow(self, chain: Chain) -> tuple[int, Array] | None:
        """Return the joint in which the elbow is, counted from 0, and its point (3,) in {B} with all joints at zero; None if there is none."""


@frozen(eq=False)
class Chain:
    """The serial chain from {B} to {FLANGE}, as a product of exponentials.

    `screws` (n, 6) are the joint axes in {B} with all joints at zero: linear part, then
    angular part (a revolute axis w through point c has (-w x c, w); a prismatic one (v, 0)).
    `base_from_flange` (4, 4) is the flange with all joints at zero. `kinematics` moves the chain; None: that of the planner. The judge gives its own.
    """

    screws: Array
    base_from_flange: Array
    kinematics: Kinematics | None = None

    @property
    def size(self) -> int:
        """The number of joints."""
        return len(self.screws)

    @property
    def is_prismatic(self) -> NDArray[np.bool_]:
        """Which joints slide (n,); it can't be written to."""
        return _prismatic(self)


@frozen(eq=False)
class Limits:
    """Joint limits (n,) each: position from `lower` to `upper` [rad or m] (infinite where there is none),
    and the largest velocity, acceleration, jerk, and acceleration of an emergency stop.
    """

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    stop_acceleration: Array


@frozen(eq=False)
class Actuation:
    """Motor positions from joint positions, the paper's eq. 5: counts = K J q + a0.

    `gear` is K (n,) in counts per axis unit, `coupling` J (n, n), `offset` a0 (n,) in counts.
    q is in axis units here: deg for a revolute joint, mm for a prismatic one.
    `velocity` (n,) is the largest speed of each motor [counts/s].
    """

    gear: Array
    coupling: Array
    offset: Array
    velocity: Array


@frozen
class Tolerance:
    """How far the executed path may be from the programmed one."""

    position: float = 0.02 * MM
    """[m], of the moving frame, and of prismatic joints"""
    angle: float = 0.002 * DEG
    """[rad], of the moving frame, and of revolute joints"""

    def of_motion(self, told: float | None, *, leads_frame: bool) -> Tolerance:
        """Return the tolerance of a motion.

        Args:
            told: what the motion says of the distance [m]; None: nothing.
            leads_frame: whether it leads the moving frame along a path: then that may also be turned, by a degree for each millimetre that is told.
        """
        if told is None:
            return self
        return Tolerance(told, max(self.angle, told / MM * DEG) if leads_frame else self.angle)


@frozen(eq=False)
class LinkShape:
    """A collision shape of a link: `base_from_shape` (4, 4) [m] is where it is with all joints at zero.

    `joint` is how many of the arm's joints move it, those from the base on: none of a link that stands still.
    """

    link: str
    joint: int
    base_from_shape: Array
    shape: Shape


@frozen(eq=False)
class ToolShape:
    """A shape of a tool, and where it is on the flange: `flange_from_shape` (4, 4) [m]."""

    flange_from_shape: Array
    shape: Shape


@frozen(eq=False)
class Tool:
    """What hangs on the flange, or, if it isn't `mounted`, could.

    `mass` is in kg, `center` (3,) its centre [m] and `inertia` (3, 3) about that [kg m^2], in the axes of {FLANGE}.
    """

    name: str
    mounted: bool
    mass: float
    center: Array
    inertia: Array
    shapes: tuple[ToolShape, ...]


@frozen(eq=False)
class Dynamics:
    """What the joints have to move, with all of them at zero, in {B}: of what joint k moves and joint k + 1 doesn't, mounted tools among it, `mass` (n,) [kg], `center`
    (n, 3) [m], and `inertia` (n, 3, 3) about it [kg m^2].

    `gravity` (3,) is in m/s^2, `effort` (n,) the largest torque or force of each joint [N m or N], infinite where none is known. `wanted` says whether robot.toml
    wants efforts to be checked.
    """

    mass: Array
    center: Array
    inertia: Array
    gravity: Array
    effort: Array
    wanted: bool

    @property
    def is_checked(self) -> bool:
        """Whether motions are held against efforts: all masses are known, and some effort is."""
        return self.wanted and bool((self.mass > 0.0).all() and np.isfinite(self.effort).any())


@frozen
class Written:
    """The texts of the files that a robot was read from, for readers that trust no other: robot.toml and URDF."""

    toml: str
    urdf: str


@frozen(eq=False)
class Robot:
    """A robot: geometry, limits, frames, actuation, controller.

    `flange_from_frame` has each frame that sits on the flange, by its name in upper case
    without braces; FLANGE itself is the identity. `positions` are the named joint
    positions, HOME among them. `fingerprint` is the SHA-256 of all that programs depend on. `shapes` are the links' collision
    shapes; `allowed` the pairs of links and tools, each in alphabetical order, that may touch each other. `dynamics` is None for a robot that was made
    without files. `jog_speed` is the largest speed of the tool's origin in live motions [m/s]: ISO 10218-1's reduced speed, unless its file says otherwise.
    `written` are the texts of its files; None for a robot that was made without files, or changed after it was read.
    """

    name: str
    title: str
    folder: Path
    urdf: str
    joint_names: tuple[str, ...]
    joint_kinds: tuple[JointKind, ...]
    chain: Chain
    limits: Limits
    flange_from_frame: Mapping[str, Array]
    positions: Mapping[str, Array]
    actuation: Actuation
    controller: Controller
    tolerance: Tolerance
    fingerprint: str
    shapes: tuple[LinkShape, ...] = ()
    allowed: frozenset[tuple[str, str]] = frozenset()
    tools: tuple[Tool, ...] = ()
    dynamics: Dynamics | None = None
    jog_speed: float = REDUCED_SPEED
    written: Written | None = field(default=None, repr=False)

    @property
    def size(self) -> int:
        """The number of joints."""
        return len(self.joint_names)

    @property
    def home(self) -> Array:
        """The joint position HOME (n,) [rad or m]."""
        return self.positions["HOME"]

    @property
    def axis_units(self) -> Array:
        """The axis unit of each joint in SI (n,): pi/180 for deg, 0.001 for mm; it can't be written to."""
        return _axis_units(self.chain)

    @property
    def axis_unit_names(self) -> tuple[str, ...]:
        """`deg` or `mm`, for each joint."""
        return tuple("mm" if prismatic else "deg" for prismatic in self.chain.is_prismatic)


@lru_cache(maxsize=256)
def _prismatic(chain: Chain) -> NDArray[np.bool_]:
    """Return which joints of a chain slide (n,); a chain never changes."""
    prismatic: NDArray[np.bool_] = ~np.any(chain.screws[:, 3:], axis=1)
    prismatic.setflags(write=False)
    return prismatic


@lru_cache(maxsize=256)
def _axis_units(chain: Chain) -> Array:
    """Return the axis unit of each joint of a chain in SI (n,)."""
    units = np.where(_prismatic(chain), MM, DEG)
    units.setflags(write=False)
    return units
