"""The controller's settings for a robot: axis definitions, feedback, limits, and the guard of the rotary buffer."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.backend_pmac.guard import watermarks
from yarclang.hir import Array
from yarclang.pmac.variables import (
    ARMED,
    GUARD_PLC,
    ROTARY_FULL,
    actual_position,
    commanded_position,
    motor_variable,
    rotary_full,
    system_variable,
)
from yarclang.robot.actuation import counts_per_joint, joints_per_count, to_counts
from yarclang.robot.model import Robot
from yarclang.units import MS

_NEVER = 0


def settings_text(robot: Robot) -> str:
    """What a controller has to be told once about a robot, as text to download."""
    sections = (
        ("axis definitions: counts = K J q + a0", axis_definitions(robot)),
        ("positions of the motors, in 1/(Ixx08*32) count, and the rotary's state", _definitions(robot)),
        ("motors", _motor_settings(robot)),
        ("coordinate system and controller", _system_settings(robot)),
        ("feedback: joint positions in axis units, the inverse of the same matrix", _feedback(robot)),
        ("guard: holds the motion when the rotary buffer runs low while a program is armed", _guard(robot)),
    )
    lines = [
        f"; settings of a Turbo PMAC for {robot.name}: {robot.title}",
        f"; robot {robot.fingerprint}",
        "; download once, look at the result, then SAVE",
        "CLOSE ALL",
    ]
    for title, section in sections:
        lines += ["", f"; {title}", *section]
    return "\n".join(lines) + "\n"


def axis_definitions(robot: Robot) -> tuple[str, ...]:
    """The paper's Listing 1: each motor as a sum of axes, with the coordinate system addressed first."""
    actuation, controller = robot.actuation, robot.controller
    lines = [f"&{controller.coordinate_system}"]
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
        lines.append(f"#{motor}->" + "+".join(terms).replace("+-", "-"))
    return tuple(lines)


def _number(value: float) -> str:
    """Four decimals as in the paper where they are exact, else as many as are needed."""
    short = f"{value:.4f}"
    return short if float(short) == value else f"{value:.10f}".rstrip("0")


def _definitions(robot: Robot) -> Iterator[str]:
    for motor in robot.controller.motors:
        for variable, address in (commanded_position(motor), actual_position(motor)):
            yield f"{variable}->{address}"
    variable, address = rotary_full(robot.controller.coordinate_system)
    yield f"{variable}->{address}"


def _motor_settings(robot: Robot) -> Iterator[str]:
    """I-variables of the motors. The controller's own default of Ixx15 would take 6 s to abort a motion."""
    controller, limits = robot.controller, robot.limits
    reach = np.abs(counts_per_joint(robot))
    stop = _motor_rate(robot, limits.stop_acceleration) * MS**2
    ramp = _motor_rate(robot, limits.acceleration) * MS**2
    rapid = _motor_rate(robot, limits.velocity) * controller.rapid_share * MS
    least, most = _count_limits(robot)
    for row, motor in enumerate(controller.motors):
        ramp_time = max(rapid[row] / ramp[row], 50.0)
        values = {
            8: (f"{controller.ixx08}", "position scale"),
            13: (f"{_software_limit(most[row])}", "positive software limit, counts"),
            14: (f"{_software_limit(least[row])}", "negative software limit, counts"),
            15: (f"{stop[row]:.4f}", "abort deceleration, counts/ms^2, of the joints' stop acceleration"),
            16: (f"{rapid[row]:.4f}", "speed of RAPID where Ixx90 is 1, counts/ms"),
            17: (f"{ramp[row]:.4f}", "acceleration of LINEAR, counts/ms^2"),
            19: (f"{ramp[row]:.4f}", "jog and RAPID acceleration, counts/ms^2"),
            20: (f"{ramp_time:.0f}", "jog and RAPID acceleration time, ms"),
            21: (f"{ramp_time / 2:.0f}", "of which S-curve, ms"),
            22: (f"{rapid[row]:.4f}", "jog and RAPID speed, counts/ms"),
            90: ("0", "RAPID takes the jog speed"),
        }
        if not np.any(reach[row]):
            continue
        yield from (
            f"{motor_variable(motor, number)}={value} ; {what}" for number, (value, what) in values.items()
        )


def _motor_rate(robot: Robot, joint_rate: Array) -> Array:
    """The largest rate of each motor [counts/s or s^2], all motors of a coupling at once, at which
    no joint exceeds its own (n,) whatever the others do.
    """
    coupling = robot.actuation.coupling
    rate = joint_rate / robot.axis_units
    # |J^-1| t <= rate, with one t for all motors that share joints
    share = rate / np.abs(np.linalg.inv(coupling)).sum(axis=1)
    moved = (coupling != 0).astype(float)
    together = np.linalg.matrix_power(moved @ moved.T, len(rate)) @ moved > 0
    slowest = np.where(together, share[None, :], np.inf).min(axis=1)
    motors: Array = np.abs(robot.actuation.gear) * slowest
    return motors


def _count_limits(robot: Robot) -> tuple[Array, Array]:
    """The least and the largest position of each motor [counts] over all joint positions within limits."""
    lower, upper = robot.limits.lower, robot.limits.upper
    matrix = counts_per_joint(robot)
    with np.errstate(invalid="ignore"):
        ends = np.stack((matrix * lower, matrix * upper))
    ends[:, matrix == 0.0] = 0.0
    offset = to_counts(robot, np.zeros(robot.size))
    return ends.min(axis=0).sum(axis=1) + offset, ends.max(axis=0).sum(axis=1) + offset


def _software_limit(counts: float) -> int:
    """0 switches a limit off: none where the joint has none, and 1 count instead of zero."""
    if not np.isfinite(counts):
        return _NEVER
    return round(counts) or 1


def _system_settings(robot: Robot) -> Iterator[str]:
    controller = robot.controller
    system = controller.coordinate_system
    marks = watermarks(robot, controller.largest_segment)
    # TSRM 43, 177: the time base changes by Isx95 each servo interrupt, in units of I10
    slew = max(1, round(controller.i10**2 / (2**23 * controller.hold_time / MS)))
    yield f"I10={controller.i10} ; servo interrupt time, 1/8388608 ms"
    yield f"I8={controller.i8} ; real-time interrupt each I8+1 servo cycles"
    yield "I42=0 ; SPLINE takes its time from TM"
    yield f"I16={marks.low} ; the rotary counts as low below so many lines (a program sets its own)"
    yield f"I17={marks.full} ; and as full from so many on"
    yield f"{system_variable(system, 13)}=0 ; no segmentation"
    yield f"{system_variable(system, 50)}=0 ; no kinematics in the controller: the axis definitions do it"
    yield f"{system_variable(system, 94)}={slew} ; slew rate of the override, for {controller.hold_time / MS:.0f} ms"
    yield f"{system_variable(system, 95)}={slew} ; slew rate of the hold, for {controller.hold_time / MS:.0f} ms"


def _feedback(robot: Robot) -> Iterator[str]:
    """PLC 0: joint positions from actual motor positions."""
    actuation, controller = robot.actuation, robot.controller
    inverse = joints_per_count(robot) / robot.axis_units[:, None] * actuation.gear[None, :]
    yield "OPEN PLC 0 CLEAR"
    for variable, row in zip(controller.feedback, inverse, strict=True):
        terms = ""
        for motor, share, gear, offset in zip(
            controller.motors, row, actuation.gear, actuation.offset, strict=True
        ):
            if abs(share) < 1e-12:
                continue
            counts = f"{actual_position(motor)[0]}/({motor_variable(motor, 8)}*32)"
            if offset:
                counts = f"({counts}{-offset:+.10g})"
            factor = "" if abs(abs(share) - 1.0) < 1e-12 else f"{abs(share):.12g}*"
            sign = "-" if share / gear < 0 else "+"
            terms += f"{sign}{factor}{counts}/{_number(abs(gear))}"
        yield f"{variable}={terms.removeprefix('+')}"
    yield "CLOSE"


def _guard(robot: Robot) -> Iterator[str]:
    yield f"; to go on after it has held ({ARMED} is 2 then): refill the buffer, {ARMED}=1, then R"
    yield f"{ARMED}=0"
    yield f"OPEN PLC {GUARD_PLC} CLEAR"
    yield f"IF({ARMED}=1)"
    yield f"IF({ROTARY_FULL}=0)"
    yield f"{ARMED}=2"
    yield f'CMD"&{robot.controller.coordinate_system}H"'
    yield "ENDIF"
    yield "ENDIF"
    yield "CLOSE"
    yield "I5=3 ; foreground and background PLCs run"
    yield "ENABLE PLC 0"
    yield f"ENABLE PLC {GUARD_PLC}"
