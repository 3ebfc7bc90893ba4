"""Check that the limits of the joints are plausible for an arm."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.robot.checklist.item import Item, listed
from yarclang.robot.model import REDUCED_SPEED, Array, Robot
from yarclang.units import MM

USUAL_SPEED = {"deg": (1.0, 1500.0), "mm": (1.0, 5000.0)}
"""Smallest and largest usual velocity limit of an arm's joints [deg/s, mm/s]."""

USUAL_RISE = (0.02, 3.0)
"""Shortest and longest usual time in which a joint reaches its velocity limit [s]."""

USUAL_EASE = (0.004, 2.0)
"""Shortest and longest usual time in which a joint reaches its acceleration limit [s]."""

USUAL_TRAVEL = {"deg": (5.0, 1440.0), "mm": (5.0, 20_000.0)}
"""Smallest and largest usual range of a joint [deg, mm]."""


def limit_items(robot: Robot) -> Iterator[Item]:
    """Yield the items about the joints' limits of position, velocity, acceleration and jerk, about emergency
    stops and jogging, and about joints without end stops.
    """
    limits, units = robot.limits, robot.axis_units
    travel = (limits.upper - limits.lower) / units
    usual = [USUAL_TRAVEL[unit] for unit in robot.axis_unit_names]
    yield _within(robot, "position limits", travel, usual, "a range of", "")
    speed = limits.velocity / units
    yield _within(
        robot, "velocity limits", speed, [USUAL_SPEED[unit] for unit in robot.axis_unit_names], "", "/s"
    )
    rise, ease = limits.velocity / limits.acceleration, limits.acceleration / limits.jerk
    yield _times(robot, "acceleration limits", rise, USUAL_RISE, "its velocity limit")
    yield _times(robot, "jerk limits", ease, USUAL_EASE, "its acceleration limit")
    slow = limits.stop_acceleration < limits.acceleration
    if slow.any():
        remark = f"{listed(_names(robot, slow))} have a stop_acceleration that isn't above their acceleration"
        yield Item("stops", "note", remark, "give the stop_acceleration that brakes and gears tolerate")
    if robot.jog_speed > REDUCED_SPEED * (1.0 + 1e-9):
        remark = (
            f"the tool moves at up to {robot.jog_speed / MM:g} mm/s in jogs, faster than the reduced speed "
            f"of ISO 10218-1, {REDUCED_SPEED / MM:g} mm/s"
        )
        yield Item("jogs", "note", remark, "give [jog] a speed of 250 if people may be within reach")
    endless = [
        name for name, kind in zip(robot.joint_names, robot.joint_kinds, strict=True) if kind == "continuous"
    ]
    free = [name for name in endless if not np.isfinite(travel[robot.joint_names.index(name)])]
    if free:
        remark = f"{listed(free)} turn without end: a program may add up turns"
        yield Item(
            "continuous joints", "note", remark, "give position limits if cables or hoses go through them"
        )
    elif endless:
        yield Item("continuous joints", "ok", f"{listed(endless)} have position limits in robot.toml")


def _within(
    robot: Robot, subject: str, values: Array, usual: list[tuple[float, float]], kind: str, per: str
) -> Item:
    low, high = (np.array([pair[side] for pair in usual]) for side in (0, 1))
    odd = np.isfinite(values) & ((values < low) | (values > high))
    if not odd.any():
        return Item(subject, "ok", f"plausible for all {robot.size} joints")
    joint = int(np.argmax(odd))
    unit = robot.axis_unit_names[joint]
    sentence = (
        f"{robot.joint_names[joint]} has {kind}{' ' * bool(kind)}{values[joint]:.4g} {unit}{per}; arms have "
        f"{low[joint]:g} to {high[joint]:g}"
    )
    more = int(odd.sum()) - 1
    sentence += f"; so have {more} more" if more else ""
    return Item(subject, "to do", sentence, f"check the unit ({unit}{per} in robot.toml) and the value")


def _times(robot: Robot, subject: str, times: Array, usual: tuple[float, float], goal: str) -> Item:
    odd = (times < usual[0]) | (times > usual[1])
    if not odd.any():
        return Item(subject, "ok", f"each joint reaches {goal} in {times.min():.3g} to {times.max():.3g} s")
    joint = int(np.argmax(odd))
    found = (
        f"{robot.joint_names[joint]} reaches {goal} in {times[joint]:.3g} s; arms take {usual[0]:g} to "
        f"{usual[1]:g} s"
    )
    return Item(subject, "to do", found, "check the unit and the value")


def _names(robot: Robot, chosen: np.ndarray[tuple[int, ...], np.dtype[np.bool_]]) -> list[str]:
    return [name for name, one in zip(robot.joint_names, chosen, strict=True) if one]
