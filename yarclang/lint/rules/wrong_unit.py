"""Find numbers whose size suggests a wrong unit."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.findings import Finding
from yarclang.hir import Array, Motion, PoseGoal, Program, Reading
from yarclang.lint.rule import Remark, Rule, Surroundings, remark_at
from yarclang.robot.kinematics.reach import arm_length
from yarclang.units import DEG, MM

_NEAR, _FAR = 0.005, 20.0
"""Smallest and largest plausible distance of a pose from {B}, as multiples of the arm's length."""

_SLOWEST, _FASTEST = 1.0 * MM, 10.0
"""Smallest and largest plausible speed of a tool [m/s]."""

_BLEND = 0.1
"""Smallest plausible distance of a BLEND [mm and deg]."""


def _look(program: Program, around: Surroundings) -> Iterator[Remark]:
    arm = arm_length(around.robot.chain, np.eye(4))
    odd = _oddly_placed(program, arm)
    for number, step in enumerate(program.steps):
        if not isinstance(step, Motion):
            continue
        if number in odd:
            yield remark_at(step.origin, *_placed(odd[number], arm))
        if step.timing.speed is not None and (said := _speed(step.timing.speed)):
            yield remark_at(step.origin, *said)
        if step.blend is not None and (said := _blend(step.blend)):
            yield remark_at(step.origin, *said)


def _oddly_placed(program: Program, arm: float) -> dict[int, float]:
    """Find motions to a pose that is implausibly near to {B} or far from it, as with a wrong unit of length.

    Args:
        program: the program.
        arm: length of the arm [m].

    Returns:
        Distance of the first such pose of each motion from {B} [m], by the number of the step.
    """
    owners: list[int] = []
    points: list[Array] = []
    for number, step in enumerate(program.steps):
        if isinstance(step, Motion) and (step.origin.base is None or step.origin.base.name == "B"):
            of_step = _points(step)
            points += of_step
            owners += [number] * len(of_step)
    if not points:
        return {}
    away = np.linalg.norm(np.array(points), axis=1)
    odd = np.flatnonzero(((away > 0.0) & (away < _NEAR * arm)) | (away > _FAR * arm))
    return {owners[place]: float(away[place]) for place in odd[::-1].tolist()}


def _placed(away: float, arm: float) -> tuple[str, str]:
    if away > arm:
        return (
            f"this pose is {away:,.0f} m from {{B}}; the arm is {arm:.2g} m long",
            "if the values are in mm, write mm in the units",
        )
    meant = "; 1000 times as far would be within reach" if away * 1e3 < 1.5 * arm else ""
    return (
        f"this pose is {away / MM:.3g} mm from {{B}}, inside the robot's base{meant}",
        "if the values are in m, write m in the units",
    )


def _points(step: Motion) -> list[Array]:
    """Return the positions (3,) of a motion's poses in {B} [m]."""
    return [one.base_from_moving[:3, 3] for one in step.goals if isinstance(one, PoseGoal)]


def _speed(speed: Reading) -> tuple[str, str] | None:
    if speed.length is None:
        return None
    if speed.length < _SLOWEST:
        return (
            f"the tool goes at {speed.length / MM:.3g} mm/s",
            "if the speed is in m/s, write m in the units",
        )
    if speed.length > _FASTEST:
        return f"the tool goes at {speed.length:,.0f} m/s", "if the speed is in mm/s, write mm in the units"
    return None


def _blend(blend: Reading) -> tuple[str, str] | None:
    if not blend.length or blend.length >= _BLEND * MM:
        return None
    if blend.angle is not None and blend.angle >= _BLEND * DEG:
        return None
    return (
        f"a corner of {blend.length / MM:.3g} mm has nearly no effect",
        "if the value is in m, write m in the units; BLEND 0 follows both paths exactly",
    )


_HEAD = "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1376 0 0 0\n"
RULE = Rule(
    Finding(
        "Y0417",
        "wrong-unit",
        "warning",
        "a value suggests a wrong unit",
        "A pose 1.2 mm or 1174 m from the robot's base, or a speed of 0.25 mm/s, is often a value in m "
        "that is read in mm, or the reverse. Even if the robot can carry out the line, the motion isn't "
        "the intended one.",
        "P0010 MOVEJ_RPY {TCP} 0 1.1744 1.176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_RPY {TCP} 0 1.1744 1.176 0 0 0 [5] (m,deg,s) {B}",
        needs="unit",
    ),
    Program,
    _look,
    valid=(
        _HEAD + "P0020 MOVEL 0 1174.4 1276 0 0 0 [V 20] BLEND 5\nP0030 MOVEL 100 1174.4 1276 0 0 0",
        _HEAD + "P0020 DMOVE 0 0 0.5 0 0 0",
        (
            "FRAME {TABLE} 0 1174.4 1176 0 0 0 (mm,deg) {B}\n"
            "P0010 MOVEJ_RPY {TCP} 0 0 0.5 0 0 0 [5] (mm,deg,s) {TABLE}"
        ),
    ),
    invalid=(
        "P0010 MOVEJ_RPY {TCP} 0 1.1744 1.176 0 0 0 [5] (mm,deg,s) {B}",
        "P0010 MOVEJ_RPY {TCP} 0 1174.4 1176 0 0 0 [5] (m,deg,s) {B}",
        _HEAD + "P0020 MOVEL 0 1174.4 1366 0 0 0 [V 0.25]",
        _HEAD + "P0020 MOVEL 0 1174.4 1276 0 0 0 BLEND 0.02\nP0030 MOVEL 100 1174.4 1276 0 0 0",
    ),
    explains_errors=True,
)
