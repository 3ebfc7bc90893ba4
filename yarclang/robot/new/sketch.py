"""Collect the values of a new robot.toml: from the URDF, from the user, or by a rule. A value from a rule is
marked as a guess.

All numbers here are in the units of robot.toml: deg and mm, per s, s^2, s^3; counts; ms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import Literal

from yarclang.frozen import frozen
from yarclang.robot.new.chains import ArmChain
from yarclang.robot.urdf import Joint, Urdf
from yarclang.units import DEG, MM

RISE = 0.25
"""Time in which a joint reaches its velocity limit, if its acceleration isn't known [s]."""

EASE = 0.12
"""Time in which a joint reaches its acceleration limit, if its jerk isn't known [s]."""

COUNTS = 10_000.0
"""Guessed encoder counts per deg or mm."""

SLOW = {"deg": 60.0, "mm": 100.0}
"""Guessed velocity limits [deg/s, mm/s]."""

FASTEST = {"deg": 50.0 / DEG, "mm": 10.0 / MM}
"""Largest velocity that counts as a limit [deg/s, mm/s]. Files have larger values if the limit isn't
known.
"""

WIDEST = {"deg": 100 * 360.0, "mm": 100_000.0}
"""Largest position that counts as a limit [deg, mm]."""

TRAVEL = {"deg": (-180.0, 180.0), "mm": (0.0, 100.0)}
"""Guessed position limits [deg, mm]."""

AXES = "XYZABCUVW"

Origin = Literal["urdf", "given", "guess"]


@frozen
class Said:
    """A value for robot.toml.

    Attributes:
        value: the value.
        origin: where it comes from: the URDF, the user, or a guess.
        note: its unit, or the reason for a guess.
    """

    value: tuple[float, ...]
    origin: Origin
    note: str = ""


@frozen
class Given:
    """The values for robot.toml that the user gives.

    A tuple has one entry for each joint, or one entry for all of them. A value that the user doesn't give is
    None.

    Attributes:
        position: position limits [deg, mm], by the joints' names.
        velocity: velocity limits [deg/s, mm/s].
        acceleration: acceleration limits [deg/s^2, mm/s^2].
        jerk: jerk limits [deg/s^3, mm/s^3].
        counts: encoder counts per deg or mm.
        home: HOME [deg, mm].
        tcp: x y z [mm] roll pitch yaw [deg] in the flange.
        motors: numbers of the motors.
    """

    position: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    velocity: tuple[float, ...] | None = None
    acceleration: tuple[float, ...] | None = None
    jerk: tuple[float, ...] | None = None
    counts: tuple[float, ...] | None = None
    home: tuple[float, ...] | None = None
    tcp: tuple[float, ...] | None = None
    motors: tuple[int, ...] | None = None


@frozen
class JointSketch:
    """The values for the table [joints.NAME] of one joint.

    Attributes:
        name: name of the joint.
        kind: type of the joint in the URDF.
        unit: deg or mm.
        position: position limits; None for a continuous joint.
        velocity: velocity limit.
        acceleration: acceleration limit; None if [ramps] gives it.
        jerk: jerk limit; None if [ramps] gives it.
        effort: effort limit of the URDF [N m or N]; 0 if it isn't known.
    """

    name: str
    kind: str
    unit: str
    position: Said | None
    velocity: Said
    acceleration: Said | None
    jerk: Said | None
    effort: float


@frozen
class Sketch:
    """All values for a new robot.toml except HOME, which depends on the geometry.

    Attributes:
        name: name of the robot.
        title: one line about it.
        urdf: name of the URDF's copy.
        made_from: name of the original URDF.
        chain: the arm.
        base_said: True if the user chose the base, or if there is no other choice.
        tip_said: True if the user chose the flange, or if there is no other choice.
        joints: tables of the joints.
        tcp: the frame TCP on the flange.
        gear: encoder counts per deg or mm.
        motors: numbers of the motors.
        motor_velocity: velocity limits of the motors [counts/ms].
    """

    name: str
    title: str
    urdf: str
    made_from: str
    chain: ArmChain
    base_said: bool
    tip_said: bool
    joints: tuple[JointSketch, ...]
    tcp: Said
    gear: Said
    motors: Said
    motor_velocity: Said


def sketch(
    urdf: Urdf, chain: ArmChain, given: Given, names: tuple[str, str, str, str], chosen: tuple[bool, bool]
) -> Sketch:
    """Choose all values of a new robot.toml except HOME.

    Args:
        urdf: a URDF whose links form one tree.
        chain: the arm in it.
        given: the values that the user gives; its tuples have one entry, or one for each joint.
        names: the robot's name, its title, the name of the URDF's copy, and the file from which it is
            created.
        chosen: two flags. The first is True if the user chose the base, the second if the user chose the tip.
    """
    size = len(chain.joints)
    joints = tuple(_joint(joint, at, size, given) for at, joint in enumerate(chain.joints))
    units = {joint.unit for joint in joints}
    gear = _from_user(given.counts, size) or Said(
        (COUNTS,) * size, "guess", f"{COUNTS:,.0f} counts per {' and '.join(sorted(units))}"
    )
    speeds = [
        _rounded_up(abs(counts) * joint.velocity.value[0] * 1e-3)
        for counts, joint in zip(gear.value, joints, strict=True)
    ]
    numbers = given.motors or tuple(range(1, size + 1))
    origin: Origin = "given" if given.motors else "guess"
    return Sketch(
        name=names[0],
        title=names[1],
        urdf=names[2],
        made_from=names[3],
        chain=chain,
        base_said=chosen[0] or not chain.base_choices,
        tip_said=chosen[1] or not (chain.flange_choices or chain.other_tips),
        joints=joints,
        tcp=_tcp(urdf, chain, given),
        gear=gear,
        motors=Said(tuple(float(number) for number in numbers), origin, "motor k moves joint k"),
        motor_velocity=Said(tuple(speeds), "guess", "each motor is as fast as its joint may be"),
    )


def unit_of(joint: Joint) -> str:
    """Return `mm` for a prismatic joint, `deg` for a revolute one."""
    return "mm" if joint.kind == "prismatic" else "deg"


def _joint(joint: Joint, at: int, size: int, given: Given) -> JointSketch:
    unit = unit_of(joint)
    velocity = _one_from_user(given.velocity, at, size) or _velocity(joint, unit)
    acceleration, jerk = _one_from_user(given.acceleration, at, size), _one_from_user(given.jerk, at, size)
    limit = joint.element.first("limit")
    effort = float(limit.attributes.get("effort", "0")) if limit is not None else 0.0
    position = None if joint.kind == "continuous" else _position(joint, unit, given)
    return JointSketch(joint.name, joint.kind, unit, position, velocity, acceleration, jerk, effort)


def _velocity(joint: Joint, unit: str) -> Said:
    size = DEG if unit == "deg" else MM
    found = (joint.velocity or 0.0) / size
    if 1e-3 < found <= FASTEST[unit]:
        return Said((_rounded_down(found),), "urdf", f"{unit}/s")
    why = f"is {found:.4g}, which is no limit" if found else "has none"
    return Said((SLOW[unit],), "guess", f"{unit}/s, the URDF {why}")


def _position(joint: Joint, unit: str, given: Given) -> Said:
    if joint.name in given.position:
        return Said(given.position[joint.name], "given", unit)
    size = DEG if unit == "deg" else MM
    if joint.lower is not None and joint.upper is not None and joint.lower < joint.upper:
        low, high = joint.lower / size, joint.upper / size
        if max(abs(low), abs(high)) <= WIDEST[unit]:
            return Said((-_rounded_down(-low), _rounded_down(high)), "urdf", unit)
    return Said(TRAVEL[unit], "guess", f"{unit}, the URDF has none")


def _tcp(urdf: Urdf, chain: ArmChain, given: Given) -> Said:
    if given.tcp is not None:
        return Said(given.tcp, "given")
    if not chain.tcp:
        return Said((0.0,) * 6, "guess", "no tool: TCP is FLANGE")
    return Said(_place(urdf, chain.flange, chain.tcp), "guess", f"the link {chain.tcp}")


def _place(urdf: Urdf, flange: str, link: str) -> tuple[float, ...]:
    """Return the pose of a link that is fixed to the flange, relative to the flange: x y z [mm] roll pitch
    yaw [deg].
    """
    import numpy as np

    from yarclang.robot.chain import joints_between
    from yarclang.transforms import rpy_rotation

    pose = np.eye(4)
    for joint in joints_between(urdf, flange, link) or ():
        step = np.eye(4)
        step[:3, :3], step[:3, 3] = rpy_rotation(np.array(joint.rpy)), joint.xyz
        pose = pose @ step
    turn = pose[:3, :3]
    pitch = math.atan2(-turn[2, 0], math.hypot(turn[0, 0], turn[1, 0]))
    upright = math.cos(pitch) > 1e-9
    roll = math.atan2(turn[2, 1], turn[2, 2]) if upright else 0.0
    yaw = math.atan2(turn[1, 0], turn[0, 0]) if upright else math.atan2(-turn[0, 1], turn[1, 1])
    values = [*(pose[:3, 3] / MM), *(angle / DEG for angle in (roll, pitch, yaw))]
    return tuple(round(float(value), 6) + 0.0 for value in values)


def _from_user(values: Sequence[float] | None, size: int) -> Said | None:
    if values is None:
        return None
    return Said(tuple(values) if len(values) == size else tuple(values) * size, "given")


def _one_from_user(values: Sequence[float] | None, at: int, size: int) -> Said | None:
    said = _from_user(values, size)
    return None if said is None else Said((said.value[at],), "given")


def _rounded_down(value: float) -> float:
    """Round a limit down to a multiple of 1e-6, so that it never allows more. A value within 1e-9 of a number
    with four decimals is rounded to this number instead: so small a difference comes from the conversion of
    units.
    """
    near = round(value, 4)
    return near if abs(value - near) < 1e-9 * max(1.0, abs(value)) else math.floor(value * 1e6) / 1e6


def _rounded_up(value: float) -> float:
    """Round a value up to four significant digits."""
    unit = 10.0 ** (math.floor(math.log10(value)) - 3)
    return float(f"{math.ceil(value / unit - 1e-9) * unit:.4g}")
