"""Define a robot as planning and all later stages use it: plain data in SI units, already checked.

`yarclang.robot.description` creates it from a robot.toml and a URDF. Arrays are float64 and read-only, with
one entry for each joint, from the base to the flange.
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
"""The largest speed of a tool if people are within reach [m/s] (ISO 10218-1)."""
START_SHARE = 0.05
"""Fraction of the acceleration and jerk limits that the first segment of a motion may use to remove a small
initial distance of the robot from the motion's start.
"""
JointKind = Literal["revolute", "prismatic", "continuous"]


@frozen(eq=False)
class Lines:
    """The axes of a chain in {B}, with all joints at zero.

    Attributes:
        axes: (n, 3) unit directions of the axes.
        points: (n, 3) a point on each axis [m].
        turn: (n,) rotation about the axis per unit of joint position.
        slide: (n,) translation along the axis per unit of joint position.
    """

    axes: Array
    points: Array
    turn: Array
    slide: Array


class Kinematics(Protocol):
    """Interface of the forward kinematics that `yarclang.collision` and `yarclang.handling` use. A chain may
    have its own implementation (`Chain.kinematics`).
    """

    def placements(self, chain: Chain, q: Array) -> Array:
        """Return the placements (n + 1, 3, 4, P) of everything that the joints move, for joint positions (P,
        n): see `yarclang.robot.placements`.
        """

    def flange(self, chain: Chain, q: Array) -> Array:
        """Return base_from_flange (P, 4, 4) for joint positions (P, n)."""

    def lines(self, chain: Chain) -> Lines:
        """Return the joint axes of the chain in {B}."""

    def elbow(self, chain: Chain) -> tuple[int, Array] | None:
        """Return the joint at the elbow, counted from 0, and its point (3,) in {B} with all joints at zero;
        None if there is no elbow.
        """


@frozen(eq=False)
class Chain:
    """The serial chain from {B} to {FLANGE}, as a product of exponentials.

    Attributes:
        screws: (n, 6) joint axes in {B} with all joints at zero: linear part, then angular part. A revolute
            axis w through point c is (-w x c, w); a prismatic one is (v, 0).
        base_from_flange: (4, 4) flange pose with all joints at zero.
        kinematics: object that computes the chain's motion; None for the planner's kinematics. The judge,
            which checks the output independently, sets its own implementation.
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
        """True for each joint that slides (n,); read-only."""
        return _prismatic(self)


@frozen(eq=False)
class Limits:
    """Joint limits, (n,) each.

    Positions range from `lower` to `upper` [rad or m], which are infinite without a limit. The other fields
    are the largest velocity, acceleration and jerk, and the acceleration of an emergency stop.
    """

    lower: Array
    upper: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    stop_acceleration: Array


@frozen(eq=False)
class Actuation:
    """The conversion of joint positions to motor positions, the paper's eq. 5: counts = K J q + a0.

    q is in axis units here: deg for a revolute joint, mm for a prismatic one.

    Attributes:
        gear: (n,) K, the gear ratio of each motor [counts per axis unit].
        coupling: (n, n) J, the motions of the motors (rows) that belong to a motion of each joint (columns).
        offset: (n,) a0, the position of each motor with all joints at 0 [counts].
        velocity: (n,) largest speed of each motor [counts/s].
    """

    gear: Array
    coupling: Array
    offset: Array
    velocity: Array


@frozen
class Tolerance:
    """The largest distance of the executed path from the programmed one."""

    position: float = 0.02 * MM
    """Largest distance of the moving frame, and of prismatic joints [m]."""
    angle: float = 0.002 * DEG
    """Largest angle of the moving frame, and of revolute joints [rad]."""

    def of_motion(self, distance: float | None, *, leads_frame: bool) -> Tolerance:
        """Return the path tolerance of a motion.

        Args:
            distance: the distance from the path that the motion allows [m], or None if it sets none.
            leads_frame: True if the motion moves the moving frame along a path. The frame may then also turn,
                by one degree for each millimetre of `distance`.
        """
        if distance is None:
            return self
        return Tolerance(distance, max(self.angle, distance / MM * DEG) if leads_frame else self.angle)


@frozen(eq=False)
class LinkShape:
    """A collision shape of a link: `base_from_shape` (4, 4) [m] is its pose with all joints at zero.

    `joint` is the number of the arm's joints between the base and the link: 0 for a link at rest.
    """

    link: str
    joint: int
    base_from_shape: Array
    shape: Shape


@frozen(eq=False)
class ToolShape:
    """A shape of a tool, with its pose on the flange: `flange_from_shape` (4, 4) [m]."""

    flange_from_shape: Array
    shape: Shape


@frozen(eq=False)
class Tool:
    """A tool.

    Attributes:
        name: name of the tool.
        mounted: True if the tool is on the flange; False if it can be put on the flange.
        mass: mass [kg].
        center: (3,) centre of mass in the axes of {FLANGE} [m].
        inertia: (3, 3) inertia about the centre of mass, in the axes of {FLANGE} [kg m^2].
        shapes: shapes of the tool.
        frame: name of the frame relative to which robot.toml describes the tool.
    """

    name: str
    mounted: bool
    mass: float
    center: Array
    inertia: Array
    shapes: tuple[ToolShape, ...]
    frame: str = "FLANGE"


@frozen(eq=False)
class Dynamics:
    """The masses that the joints move, in {B} with all joints at zero.

    Entry k of an array describes the body that joint k moves and joint k + 1 doesn't, including mounted
    tools.

    Attributes:
        mass: (n,) mass of each body [kg].
        center: (n, 3) centre of mass [m].
        inertia: (n, 3, 3) inertia about the centre of mass [kg m^2].
        gravity: (3,) gravity [m/s^2].
        effort: (n,) largest torque or force of each joint [N m or N]; infinite if it isn't known.
        wanted: True if robot.toml asks for torques to be compared with efforts.
    """

    mass: Array
    center: Array
    inertia: Array
    gravity: Array
    effort: Array
    wanted: bool

    @property
    def is_checked(self) -> bool:
        """True if the torques of motions are compared with efforts. For this, robot.toml must ask for it, and
        all masses and at least one effort must be known.
        """
        return self.wanted and bool((self.mass > 0.0).all() and np.isfinite(self.effort).any())


@frozen
class Written:
    """The texts of a robot's robot.toml and URDF, as they were when the robot was read. A checker that
    doesn't trust the `Robot` made from these texts uses them instead.
    """

    toml: str
    urdf: str


@frozen(eq=False)
class Robot:
    """A robot: geometry, limits, frames, actuation, controller.

    Attributes:
        name: name of the robot.
        title: one line about the robot.
        folder: folder of the robot's files.
        urdf: name of the URDF file, as in robot.toml.
        joint_names: names of the joints.
        joint_kinds: kinds of the joints.
        chain: the joints' axes.
        limits: the joints' limits.
        flange_from_frame: pose of each frame on the flange, by the frame's name in upper case without braces;
            FLANGE itself is the identity.
        positions: named joint positions, including HOME.
        actuation: conversion of joint positions to motor positions.
        controller: connection to the controller.
        tolerance: largest distance of the executed path from the programmed one.
        fingerprint: SHA-256 of everything that programs depend on.
        shapes: collision shapes of the links.
        allowed: pairs of links and tools that may touch each other, each pair in alphabetical order.
        tools: the tools.
        dynamics: masses and efforts; None for a robot that wasn't read from files.
        jog_speed: largest speed of the tool's origin in live motions [m/s]: ISO 10218-1's reduced speed,
            unless robot.toml sets another.
        written: texts of the robot's files; None for a robot that wasn't read from files, or was changed
            after it was read.
        file_name: name of the file that describes the robot, usually robot.toml.
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
    file_name: str = "robot.toml"

    @property
    def file(self) -> Path:
        """The path of the file that describes the robot, usually robot.toml."""
        return self.folder / self.file_name

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
        """The axis unit of each joint in SI (n,): pi/180 for deg, 0.001 for mm; read-only."""
        return _axis_units(self.chain)

    @property
    def axis_unit_names(self) -> tuple[str, ...]:
        """The name of each joint's axis unit, `deg` or `mm`."""
        return tuple("mm" if prismatic else "deg" for prismatic in self.chain.is_prismatic)


@lru_cache(maxsize=256)
def _prismatic(chain: Chain) -> NDArray[np.bool_]:
    """Return a mask (n,) of the joints of a chain that slide; cached, since a chain never changes."""
    prismatic: NDArray[np.bool_] = ~np.any(chain.screws[:, 3:], axis=1)
    prismatic.setflags(write=False)
    return prismatic


@lru_cache(maxsize=256)
def _axis_units(chain: Chain) -> Array:
    """Return the axis unit of each joint of a chain in SI (n,)."""
    units = np.where(_prismatic(chain), MM, DEG)
    units.setflags(write=False)
    return units
