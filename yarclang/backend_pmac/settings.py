"""The settings that a controller needs for a robot: axis definitions, feedback, limits, and the guard of the
rotary buffer.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from yarclang.backend_pmac.guard import watermarks
from yarclang.hir import Array
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.settings import AxisDefinition, ControllerSettings, IVariable, MDefinition, Plc
from yarclang.pmac.variables import (
    ARMED,
    ECHO,
    FEEDBACK_PLC,
    GUARD_PLC,
    HEARTBEAT,
    ROTARY_FULL,
    WATCHED,
    actual_position,
    commanded_position,
    motor_variable,
    rotary_full,
    system_variable,
    watchdog,
)
from yarclang.robot.actuation import counts_per_joint, joints_per_count, to_counts
from yarclang.robot.model import Robot
from yarclang.units import MS

_NEVER = 0
_MOST_DECIMALS = 20
"""Largest number of decimals of a coefficient. Further decimals are too small to move a motor."""
_CLEARANCE = 0.01
"""Minimum distance from the end of a motor's range to its software limit [counts].

The controller aborts a move whose target is beyond the limit, and it rounds the targets that it computes.
"""


def settings_text(robot: Robot) -> str:
    """Print the settings that a controller needs for a robot, as text to download."""
    return settings_of(robot).text


def settings_of(robot: Robot) -> ControllerSettings:
    """Collect the settings that a controller needs for a robot."""
    return ControllerSettings(
        robot=robot.name,
        title=_printable(robot.title),
        fingerprint=robot.fingerprint,
        system=turbo_pmac(robot).coordinate_system,
        axes=tuple(_axis_definitions(robot)),
        registers=tuple(_registers(robot)),
        motors=tuple(_motor_settings(robot)),
        globals=tuple(_system_settings(robot)),
        feedback=Plc(FEEDBACK_PLC, tuple(_feedback(robot))),
        guard=Plc(GUARD_PLC, tuple(_guard(robot))),
        plcs=IVariable("I5", "3", "foreground and background PLCs run"),
    )


def _printable(title: str) -> str:
    """Return a title in ASCII on one line, so that it can be a comment: text after a line end would be
    executed as a command.
    """
    return "".join(one if one.isascii() and one.isprintable() else "?" for one in title)


def _axis_definitions(robot: Robot) -> Iterator[AxisDefinition]:
    """Yield each motor's position as a sum of axes (Listing 1 of the paper)."""
    actuation, controller = robot.actuation, turbo_pmac(robot)
    for motor, gear, row, offset in zip(
        controller.motors, actuation.gear, actuation.coupling, actuation.offset, strict=True
    ):
        terms = [
            f"{_number(gear * share)}{axis}"
            for share, axis in zip(row, controller.axes, strict=True)
            if share
        ]
        if offset:
            terms.append(_number(offset))
        yield AxisDefinition(motor, "+".join(terms).replace("+-", "-"))


def _number(value: float) -> str:
    """Print a number with four decimals, as in the paper, if they are exact; otherwise with as many as are
    needed.
    """
    short = f"{value:.4f}"
    if float(short) == value:
        return short
    text = f"{value:.{min(max(10, _decimals(value, 12)), _MOST_DECIMALS)}f}".rstrip("0")
    return text + "0" * text.endswith(".")


def _decimals(value: float, digits: int) -> int:
    """Return the number of decimals at which a value other than 0 is printed with `digits` significant
    digits.
    """
    return digits - 1 - math.floor(math.log10(abs(value)))


def _digits(value: float, digits: int) -> str:
    """Print a value with at most `digits` significant digits and without an exponent, which the controller
    does not accept.
    """
    text = f"{value:.{digits}g}"
    return text if "e" not in text else f"{value:.{max(0, _decimals(value, digits))}f}"


def _registers(robot: Robot) -> Iterator[MDefinition]:
    for motor in robot.controller.motors:
        yield MDefinition(*commanded_position(motor))
        yield MDefinition(*actual_position(motor))
    yield MDefinition(*rotary_full(turbo_pmac(robot).coordinate_system))


def _motor_settings(robot: Robot) -> Iterator[IVariable]:
    """Yield the I-variables of the motors. They include Ixx15, since with the controller's own default,
    aborting a motion would take 6 s.
    """
    controller, limits = turbo_pmac(robot), robot.limits
    stop = _motor_rate(robot, limits.stop_acceleration) * MS**2
    ramp = _motor_rate(robot, limits.acceleration) * MS**2
    fastest = np.minimum(
        _motor_rate(robot, limits.velocity) * controller.rapid_share, robot.actuation.velocity
    )
    rapid = fastest * MS
    least, most = _count_limits(robot)
    for row, motor in enumerate(controller.motors):
        ramp_time = max(rapid[row] / ramp[row], 50.0)
        values = {
            8: (f"{controller.ixx08}", "position scale"),
            13: (f"{_software_limit(most[row])}", "positive software limit, counts"),
            14: (f"{-_software_limit(-least[row])}", "negative software limit, counts"),
            15: (_rate(stop[row]), "abort deceleration, counts/ms^2, of the joints' stop acceleration"),
            16: (_rate(rapid[row]), "speed of RAPID where Ixx90 is 1, counts/ms"),
            17: (_rate(ramp[row]), "acceleration of LINEAR, counts/ms^2"),
            19: (_rate(ramp[row]), "jog and RAPID acceleration, counts/ms^2"),
            20: (f"{ramp_time:.0f}", "jog and RAPID acceleration time, ms"),
            21: (f"{ramp_time / 2:.0f}", "of which S-curve, ms"),
            22: (_rate(rapid[row]), "jog and RAPID speed, counts/ms"),
            90: ("0", "RAPID takes the jog speed"),
        }
        for number, (value, what) in values.items():
            yield IVariable(motor_variable(motor, number), value, what)


def _rate(value: float) -> str:
    """Print a rate with four decimals, or with more if four would change a small rate by more than 0.1 %."""
    return f"{value:.{4 if value >= 0.05 else _decimals(value, 5)}f}"


def _motor_rate(robot: Robot, joint_rate: Array) -> Array:
    """Compute the largest speed or acceleration of each motor. Motors that share joints get the same limit,
    so low that none of these joints exceeds its own limit, whatever the signs of the motors' motions.

    Args:
        robot: the robot.
        joint_rate: limit of each joint (n,) [rad/s or m/s, or per s^2].

    Returns:
        The limit of each motor (n,) [counts/s or counts/s^2].
    """
    coupling = robot.actuation.coupling
    rate = joint_rate / robot.axis_units
    # Let J be the coupling matrix. If all motors that share joints have the rate t, joint i moves at most
    # with t * sum_k |(J^-1)_ik|, which must not exceed its limit.
    share = rate / np.abs(np.linalg.inv(coupling)).sum(axis=1)
    moved = (coupling != 0).astype(float)
    together = np.linalg.matrix_power(moved @ moved.T, len(rate)) @ moved > 0
    slowest = np.where(together, share[None, :], np.inf).min(axis=1)
    motors: Array = np.abs(robot.actuation.gear) * slowest
    return motors


def _count_limits(robot: Robot) -> tuple[Array, Array]:
    """Compute the smallest and the largest position of each motor [counts] over all joint positions within
    the joint limits.
    """
    lower, upper = robot.limits.lower, robot.limits.upper
    matrix = counts_per_joint(robot)
    with np.errstate(invalid="ignore"):
        ends = np.stack((matrix * lower, matrix * upper))
    ends[:, matrix == 0.0] = 0.0
    offset = to_counts(robot, np.zeros(robot.size))
    return ends.min(axis=0).sum(axis=1) + offset, ends.max(axis=0).sum(axis=1) + offset


def _software_limit(reach: float) -> int:
    """Return the software limit of a motor: the first count beyond its largest position.

    The value 0 switches the limit off. A limit at 0 is therefore written as 1 (TSRM 96).
    """
    if not np.isfinite(reach):
        return _NEVER
    return math.ceil(reach + _CLEARANCE) or 1


def _system_settings(robot: Robot) -> Iterator[IVariable]:
    controller = turbo_pmac(robot)
    system = controller.coordinate_system
    marks = watermarks(robot, controller.largest_segment)
    # The time base changes by Isx95 each servo interrupt, in units of I10 (TSRM 43, 177).
    slew = max(1, round(controller.i10**2 / (2**23 * controller.hold_time / MS)))
    hold = f"{controller.hold_time / MS:.0f} ms"
    yield IVariable("I10", f"{controller.i10}", "servo interrupt time, 1/8388608 ms")
    yield IVariable("I8", f"{controller.i8}", "real-time interrupt each I8+1 servo cycles")
    yield IVariable("I42", "0", "SPLINE takes its time from TM")
    yield IVariable(
        "I16", f"{marks.low}", "the rotary counts as low below so many lines (a program sets its own)"
    )
    yield IVariable("I17", f"{marks.full}", "and as full from so many on")
    yield IVariable(system_variable(system, 13), "0", "no segmentation")
    yield IVariable(
        system_variable(system, 50), "0", "no kinematics in the controller: the axis definitions do it"
    )
    yield IVariable(system_variable(system, 94), f"{slew}", f"slew rate of the override, for {hold}")
    yield IVariable(system_variable(system, 95), f"{slew}", f"slew rate of the hold, for {hold}")


def _feedback(robot: Robot) -> Iterator[str]:
    """Yield the lines of PLC 0: joint positions from actual motor positions, and a copy of the guard's
    heartbeat, which shows that PLC 0 runs.
    """
    actuation, controller = robot.actuation, turbo_pmac(robot)
    inverse = joints_per_count(robot) / robot.axis_units[:, None] * actuation.gear[None, :]
    # joint = sum of share * (counts - offset) / gear over the motors; shares that differ from 0 only by
    # rounding are left out
    for variable, row in zip(controller.feedback, inverse, strict=True):
        terms = ""
        least = 1e-12 * np.abs(row).max()
        for motor, share, gear, offset in zip(
            controller.motors, row, actuation.gear, actuation.offset, strict=True
        ):
            if abs(share) < least:
                continue
            counts = f"{actual_position(motor)[0]}/({motor_variable(motor, 8)}*32)"
            if offset:
                counts = f"({counts}{_offset(-offset)})"
            factor = "" if abs(abs(share) - 1.0) < 1e-12 else f"{_digits(abs(share), 12)}*"
            sign = "-" if share / gear < 0 else "+"
            terms += f"{sign}{factor}{counts}/{_number(abs(gear))}"
        yield f"{variable}={terms.removeprefix('+')}"
    yield f"{ECHO}={HEARTBEAT}"


def _offset(counts: float) -> str:
    """Print an offset of an axis definition with its sign: with ten digits if they are accurate to half a
    thousandth of a count, else with all digits.
    """
    text = f"{counts:+.10g}"
    near = "e" not in text and abs(float(text) - counts) < 5e-4
    return text if near else f"{'-' if counts < 0 else '+'}{_number(abs(counts))}"


def _guard(robot: Robot) -> Iterator[str]:
    """Yield the lines of PLC 29, the guard.

    The PLC holds the motion for two reasons: the rotary buffer has run low (fewer than I16 lines are ahead),
    or the watchdog of the streaming computer has expired. After each arming, each reason causes at most one
    hold.
    """
    system = turbo_pmac(robot).coordinate_system
    yield f"{HEARTBEAT}={HEARTBEAT}+1"
    # With the hold, the flag changes from 1 to 2, so that each arming commands only one hold.
    for flag, condition in ((ARMED, f"{ROTARY_FULL}=0"), (WATCHED, f"{watchdog(system)}<0")):
        yield from (f"IF({flag}=1)", f"IF({condition})", f"{flag}=2", f'CMD"&{system}H"', "ENDIF", "ENDIF")
