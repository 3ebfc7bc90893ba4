"""Conversion of joint to motor positions and back, as the settings define it.

The axis definitions convert joint positions to motor counts. Their coefficients must be K J and their
constants a0, where K has the gear ratios [counts per axis unit], J is the coupling of the joints to the
motors, and a0 has the motors' offsets [counts]. PLC 0 must compute the inverse conversion.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

from yarclang.certify.pmac.settings.coupling import Coupling, Row
from yarclang.certify.pmac.settings.expression import Affine, NotAffineError, constant, evaluate, variable
from yarclang.certify.pmac.settings.text import Definition, SettingsText
from yarclang.certify.read.lines import shown
from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import actual_position, motor_variable
from yarclang.robot.model import Robot

Say = Callable[[str, int, str], None]
"""Function that adds a finding with a code, a line and a message."""

_FLOAT = Fraction(1, 2**50)
"""Largest relative error of a product of two floating-point numbers."""
_UNITS_PER_COUNT = 32
"""The part of the register unit that is the same for all motors: a position register counts in units of
1/(32 Ixx08) count (TSRM 281).
"""


def check_definitions(content: SettingsText, robot: Robot, coupling: Coupling, say: Say) -> Row | None:
    """Check the coefficients and constants of the axis definitions (K J and a0, see the module), to the
    printed digits.

    Returns:
        The largest error of each joint within its limits [axis units]; None after a finding.
    """
    problems = False
    for row, definition in enumerate(content.definitions):
        if problem := _wrong_definition(definition, row, robot, coupling):
            problems = True
            say("Y1172", definition.line, f"motor {definition.motor} {problem}")
    if problems:
        return None
    printed, offset = _printed(content, robot)
    # Let M and o be the robot's matrix and offsets, and M' and o' the printed ones. The joints are then off
    # by M^-1 ((M' - M) q + o' - o). Sum the largest values over all joint positions q within `reach`.
    off = [_difference(one, true) for one, true in zip(printed, coupling.matrix, strict=True)]
    off_offset = _difference(offset, coupling.offset)
    errors = []
    for inverse in coupling.inverse:
        error = abs(_product(inverse, off_offset))
        for joint, reach in enumerate(coupling.reach):
            error += abs(_product(inverse, [motor[joint] for motor in off])) * reach
        errors.append(error)
    return errors


def _wrong_definition(definition: Definition, row: int, robot: Robot, coupling: Coupling) -> str:
    """Return the fault of a motor's definition in words; empty if it is right."""
    error = Fraction(0)
    for axis, unit, true, reach in zip(
        robot.controller.axes, robot.axis_unit_names, coupling.matrix[row], coupling.reach, strict=True
    ):
        printed = definition.counts.get(axis)
        if printed is None:
            if true:
                return f"doesn't follow {axis}; K J says {_told(true)} counts a {unit}"
            continue
        if not true:
            return f"follows {axis}, but K J says that it doesn't"
        # A printed number is off by at most half a unit of its last decimal.
        off = abs(printed.value - true)
        if off > printed.step / 2 + _FLOAT * abs(true):
            return f"follows {axis} with {_told(printed.value)} counts a {unit}; K J says {_told(true)}"
        error += off * reach
    off = abs(definition.offset.value - coupling.offset[row])
    if off > definition.offset.step / 2 + _FLOAT * abs(coupling.offset[row]):
        return (
            f"has the offset {_told(definition.offset.value)} counts; a0 says {_told(coupling.offset[row])}"
        )
    if (error := error + off) > coupling.slack[row]:
        return (
            f"is defined with too few digits: {float(error):.3g} counts are lost within the joints' limits, "
            f"{float(coupling.slack[row]):.3g} are allowed"
        )
    return ""


def check_feedback(
    content: SettingsText, robot: Robot, coupling: Coupling, say: Say, *, as_printed: bool
) -> Row | None:
    """Check that PLC 0 computes the joint positions that belong to the axis definitions, each in the joint's
    feedback variable.

    Args:
        content: the settings that were read.
        robot: defines the feedback variables.
        coupling: the robot's conversion of joint positions to motor counts.
        say: function that adds a finding.
        as_printed: True to compute the motors' positions from the printed definitions, False to compute them
            from `coupling`.

    Returns:
        The largest error of each variable within the limits of the joint [axis units]; None after a finding.
    """
    matrix, offset = _printed(content, robot) if as_printed else (coupling.matrix, coupling.offset)
    controller = turbo_pmac(robot)
    meaning = {motor_variable(motor, 8): constant(Fraction(controller.ixx08)) for motor in controller.motors}
    meaning |= {actual_position(motor)[0]: variable(actual_position(motor)[0]) for motor in controller.motors}
    errors: Row = []
    feedback = content.feedback
    joints = list(zip(feedback.statements, feedback.places, strict=True))[: robot.size]
    for joint, (statement, line) in enumerate(joints):
        name, _, expression = statement.partition("=")
        wanted, owner = controller.feedback[joint], robot.joint_names[joint]
        unit = robot.axis_unit_names[joint]
        if name != wanted:
            say("Y1173", line, f"{name} is given instead of {wanted}, the position of {owner}")
            continue
        try:
            value = evaluate(expression, meaning.get)
        except NotAffineError as problem:
            say("Y1173", line, f"{shown(statement)} doesn't compute {owner}: {problem}")
            continue
        error = _feedback_error(value, joint, matrix, offset, robot, coupling)
        allowed = coupling.joint_slack[joint]
        if error > allowed:
            message = (
                f"{name} differs from {owner} by up to {float(error):.3g} {unit} within the joints' limits; "
                f"{float(allowed):.2g} {unit} are allowed"
            )
            say("Y1173", line, message)
        errors.append(error)
    return errors if len(errors) == len(joints) else None


def _feedback_error(
    value: Affine, joint: int, matrix: list[Row], offset: Row, robot: Robot, coupling: Coupling
) -> Fraction:
    """Return the largest difference between a joint's position and its expression in PLC 0."""
    # `scale` is the number of units of a position register in one count.
    scale = turbo_pmac(robot).ixx08 * _UNITS_PER_COUNT
    shares = [
        value.factors.get(actual_position(motor)[0], Fraction(0)) * scale for motor in robot.controller.motors
    ]
    error = abs(value.constant + _product(shares, offset))
    for other, reach in enumerate(coupling.reach):
        # Put the motors' positions M q + o, with the matrix M and the offsets o, into the expression: it must
        # then have a factor 1 for this joint, 0 for all others, and no constant.
        follows = _product(shares, [row[other] for row in matrix])
        error += abs(follows - (other == joint)) * reach
    return error


def _printed(content: SettingsText, robot: Robot) -> tuple[list[Row], Row]:
    """Return the matrix and the offsets of the printed definitions."""
    matrix = [
        [one.counts[axis].value if axis in one.counts else Fraction(0) for axis in robot.controller.axes]
        for one in content.definitions
    ]
    return matrix, [one.offset.value for one in content.definitions]


def _difference(one: Row, other: Row) -> Row:
    return [a - b for a, b in zip(one, other, strict=True)]


def _product(one: Row, other: Row) -> Fraction:
    return sum((a * b for a, b in zip(one, other, strict=True) if a and b), Fraction(0))


def _told(value: Fraction) -> str:
    return f"{float(value):.12g}"
