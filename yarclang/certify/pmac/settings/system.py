"""I-variables of the coordinate system and the controller: servo clock, spline, hold, guard."""

from __future__ import annotations

from fractions import Fraction

from yarclang.certify.pmac.settings.positions import Say
from yarclang.certify.pmac.settings.text import SettingsText
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import GUARD_PLC, system_variable
from yarclang.robot.model import Robot

_CLOCK = 2**23
"""Units of I10 in 1 ms (TSRM 43)."""
_MS = Fraction(1, 1000)
_GUARD_DELAY = Fraction(1, 10)
"""Longest delay until the guard PLC notices that the rotary buffer runs low [s]."""
_WITHIN = Fraction(1, 100)
"""Allowed error of the duration of a hold, as a fraction of the robot's hold time."""
_MOST_LINES = 2**23 - 1
"""Largest value of I16 and I17 (TSRM 46)."""


def check_system(content: SettingsText, robot: Robot, say: Say) -> None:
    """Check the I-variables that do not belong to motors."""
    controller = turbo_pmac(robot)
    system = controller.coordinate_system
    wanted = {
        "I10": (controller.i10, "the servo interrupt time in robot.toml", "Y1174"),
        "I8": (controller.i8, "the servo cycles between real-time interrupts in robot.toml", "Y1174"),
        "I42": (0, "SPLINE takes its time from TM", "Y1174"),
        system_variable(system, 13): (0, "moves aren't cut into segments", "Y1174"),
        system_variable(system, 50): (0, "the controller computes no kinematics", "Y1174"),
        "I5": (3, f"PLC 0 and PLC {GUARD_PLC} run", "Y1175"),
    }
    for name, (value, what, code) in wanted.items():
        setting = content.settings[name]
        if setting.value != value:
            say(code, setting.line, f"{name}={setting.printed}: it must be {value}, {what}")
    for number, what in ((94, "a change of the override"), (95, "a hold")):
        _check_slew(content, system_variable(system, number), what, robot, say)
    _check_marks(content, robot, say)


def _check_slew(content: SettingsText, name: str, what: str, robot: Robot, say: Say) -> None:
    """Check that slowing the program from 100 % to 0 takes the robot's hold time (slew rate).

    The time base is I10, and changes by Isx94 or Isx95 in each servo cycle (TSRM 191).
    """
    setting, i10 = content.settings[name], turbo_pmac(robot).i10
    hold = Fraction(robot.controller.hold_time)
    cycle = Fraction(i10, _CLOCK) * _MS
    slew = setting.value
    # The time base falls from I10 to 0 by `slew` in each servo cycle, so it takes I10 / slew cycles.
    time = i10 / slew * cycle if slew > 0 else None
    # The slew must be the integer nearest to the exact value.
    half_step = time is not None and abs(slew - i10 * cycle / hold) < Fraction(501, 1000)
    if time is None or not half_step or slew.denominator != 1 or abs(time - hold) > _WITHIN * hold:
        told = "never ends" if time is None else f"takes {float(time / _MS):.6g} ms"
        message = (
            f"{name}={setting.printed}: {what} {told}; the robot's hold_time is {float(hold / _MS):.6g} ms"
        )
        say("Y1174", setting.line, message)


def _check_marks(content: SettingsText, robot: Robot, say: Say) -> None:
    """Check that the guard reacts while enough lines are left for a hold.

    During a hold that takes a time T, the program advances as far as it would at full speed in T / 2.
    """
    low, full = content.settings["I16"], content.settings["I17"]
    controller = turbo_pmac(robot)
    # While the program brakes evenly for a time T, it advances as far as it would at full speed in T / 2.
    ahead = Fraction(controller.hold_time) / 2 + _GUARD_DELAY
    # The guard acts when fewer than I16 lines are ahead. A text with shorter segments sets an I16 of its own
    # (checked in `guard.py`).
    there = low.value * Fraction(controller.largest_segment)
    if low.value.denominator != 1 or there < ahead * (1 - Fraction(1, 10**9)):
        message = (
            f"{low.name}={low.printed}: the guard leaves {float(there / _MS):.6g} ms of the program, and a "
            f"hold needs {float(ahead / _MS):.6g} ms"
        )
        say("Y1175", low.line, message)
    elif full.value.denominator != 1 or not low.value < full.value <= _MOST_LINES:
        message = (
            f"{full.name}={full.printed}: the rotary counts as full from more lines on than {low.name}, "
            f"{low.printed}, and at most {_MOST_LINES}"
        )
        say("Y1175", full.line, message)
