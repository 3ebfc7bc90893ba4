"""I-variables of the motors except rates: software limits, the scale of positions, and the speed of RAPID."""

from __future__ import annotations

from fractions import Fraction

from yarclang.certify.pmac.settings.coupling import Coupling
from yarclang.certify.pmac.settings.positions import Say
from yarclang.certify.pmac.settings.text import SettingsText
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import motor_variable
from yarclang.robot.model import Robot

_BEYOND = 3
"""Largest number of counts by which a software limit may exceed the reach of its motor."""
_LARGEST_LIMIT = 2**35
"""Largest constant that the controller accepts for Ixx13 and Ixx14 [counts] (TSRM 96)."""
_REGISTER = 2**42
"""Range of a position register in counts, times Ixx08 (TSRM 96)."""
_LONGEST_TIME = 2**23 - 1
"""Largest value of Ixx20 and Ixx21 [ms] (TSRM 101)."""


def check_motors(content: SettingsText, robot: Robot, coupling: Coupling, say: Say) -> None:
    """Check those I-variables of all motors that are not rates."""
    scale = turbo_pmac(robot).ixx08
    wanted = {
        8: (scale, scale, "the position scale is {}, as in robot.toml"),
        # RAPID never accelerates by more than Ixx19, whatever Ixx20 and Ixx21 are, unless both are 0 (TSRM
        # 101).
        20: (0, _LONGEST_TIME, "the time of RAPID's ramps is an integer from {} to {} ms"),
        21: (1, _LONGEST_TIME, "the S-curve time of RAPID's ramps is an integer from {} to {} ms"),
        90: (0, 0, "it must be {}: RAPID takes the jog speed"),
    }
    for row, motor in enumerate(robot.controller.motors):
        for number, (least, most, what) in wanted.items():
            setting = content.settings[motor_variable(motor, number)]
            if setting.value.denominator != 1 or not least <= setting.value <= most:
                message = f"{setting.name}={setting.printed}: {what.format(least, most)}"
                say("Y1174", setting.line, message)
        for number, sign in ((13, 1), (14, -1)):
            setting = content.settings[motor_variable(motor, number)]
            if problem := _wrong_limit(sign * setting.value, sign, row, robot, coupling):
                say("Y1174", setting.line, f"{setting.name}={setting.printed}: motor {motor} {problem}")


def _wrong_limit(limit: Fraction, sign: int, row: int, robot: Robot, coupling: Coupling) -> str:
    """Return the fault of a motor's software limit in words; empty if the limit is right.

    Args:
        limit: the limit, times `sign` [counts].
        sign: 1 for the positive limit, -1 for the negative one.
        row: row of the motor in the coupling.
        robot: the robot.
        coupling: the robot's conversion of joint positions to motor counts, and the limits of the joints.
    """
    reach = _reach(sign, row, coupling)
    if reach is None:
        return "turns without an end, so it must be 0 (no limit)" if limit else ""
    fault = (
        f"goes {'up' if sign > 0 else 'down'} to {float(sign * reach):.3f} counts within the joints' limits"
    )
    if not limit:
        return f"{fault}, but 0 means no limit"
    if limit < reach:
        return f"{fault}, but would be stopped before"
    if limit > reach + _BEYOND:
        return f"{fault}, and may be stopped at most {_BEYOND} counts beyond"
    if abs(limit) > min(Fraction(_LARGEST_LIMIT), Fraction(_REGISTER, turbo_pmac(robot).ixx08)):
        return f"{fault}, farther than the controller counts"
    return ""


def _reach(sign: int, row: int, coupling: Coupling) -> Fraction | None:
    """Return the farthest position of a motor in one direction while all joints are within their limits
    [counts].

    The position is multiplied by `sign`, 1 or -1. None if a joint without a limit moves the motor.
    """
    total = sign * coupling.offset[row]
    for share, lower, upper in zip(coupling.matrix[row], coupling.lower, coupling.upper, strict=True):
        if not share:
            continue
        end = upper if sign * share > 0 else lower
        if end is None:
            return None
        total += sign * share * end
    return total
