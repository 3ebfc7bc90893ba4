"""The segment times that a plan may use, from the robot's description and the user's request."""

from __future__ import annotations

import numpy as np

from yarclang.diagnostics import Diagnostic, Result
from yarclang.motion.limits import Grid
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.segments import LARGEST, QUANTUM
from yarclang.robot.model import Robot
from yarclang.units import MS


def segment_grid(robot: Robot, tm: float | None) -> Result[Grid]:
    """Return the grid of segment times that a plan for a robot may use.

    Args:
        robot: the robot.
        tm: longest segment time that the user allows [ms]; None if the user sets no limit.

    Returns:
        The grid; None, with a finding, if the controller would round or clip `tm`, or can't calculate such
        short segments fast enough.
    """
    smallest, largest = robot.controller.smallest_segment, robot.controller.largest_segment
    if tm is None:
        return Result(Grid(smallest, largest, QUANTUM))
    asked = tm * MS
    if asked > LARGEST + 1e-12:
        return _refused(
            "Y1102",
            f"TM {tm:g} ms is too long: the controller clips at {LARGEST / MS:g} ms",
            f"give {largest / MS:g} or less",
        )
    if asked > largest + 1e-12:
        message = f"TM {tm:g} ms is too long for {robot.name}: at most {largest / MS:g} ms are allowed"
        return _refused(
            "Y1102",
            message,
            f"give {largest / MS:g} or less, or raise controller.largest_tm in robot.toml",
        )
    if asked < smallest:
        message = (
            f"TM {tm:g} ms is too short: the controller can't calculate segments shorter than "
            f"{np.ceil(smallest / MS * 1e4) / 1e4:.6g} ms in time (three real-time interrupts at I8 = "
            f"{turbo_pmac(robot).i8})"
        )
        least = _neat_above(smallest / MS)
        return _refused(
            "Y1103", message, f"give {least:g} or more, or lower I8 (controller.i8 in robot.toml)"
        )
    steps = asked / QUANTUM
    if abs(steps - round(steps)) > 1e-6:
        kept = round(steps) * QUANTUM / MS
        message = (
            f"TM {tm:.12g} ms lies between two steps of 1/4096 ms: the controller would use {kept:.12g} ms"
        )
        return _refused("Y1101", message, f"give {kept:.12g}")
    return Result(Grid(smallest, round(steps) * QUANTUM, QUANTUM))


def _neat_above(milliseconds: float) -> float:
    """Return the next multiple of half a millisecond: every controller stores it exactly."""
    return float(-(-milliseconds // 0.5)) * 0.5


def _refused(code: str, message: str, help_: str) -> Result[Grid]:
    return Result(None, (Diagnostic(code, message, help=help_),))
