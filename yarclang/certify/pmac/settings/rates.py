"""Largest speeds and accelerations of motors that the settings define.

No joint may exceed its limits in an abort or a RAPID, whichever way the motors turn, and no motor may be
slower than necessary.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from fractions import Fraction

from yarclang.certify.pmac.settings.coupling import Coupling, Row, exact
from yarclang.certify.pmac.settings.positions import Say
from yarclang.certify.pmac.settings.text import Setting, SettingsText
from yarclang.frozen import frozen
from yarclang.pmac.variables import motor_variable
from yarclang.robot.model import Robot

_ROUNDING = Fraction(1, 1000)
"""Allowed error of a printed rate, as a fraction of the largest allowed rate."""
_SPEED, _ACCELERATION = 1000, 1_000_000
"""Counts/s in one count/ms, and counts/s^2 in one count/ms^2."""

_Rates = Mapping[int, Fraction]
"""Rates of motors by their rows [counts/s or counts/s^2]."""


@frozen
class _Quantity:
    """A rate (speed or acceleration) that one Ixx sets for all motors.

    Attributes:
        number: number of the I-variable.
        unit: counts/s or counts/s^2 in one unit of the I-variable.
        limits: limits of the joints [axis units/s or axis units/s^2].
        most: the motors' own limits [counts/s]; None without such limits.
        does: the action that uses this rate, in messages.
        limit: the name of a joint's limit, in messages.
    """

    number: int
    unit: int
    limits: Row
    most: Row | None
    does: str
    limit: str

    @property
    def per(self) -> str:
        """Unit of time in messages."""
        return "/s" if self.unit == _SPEED else "/s2"


def check_rates(content: SettingsText, robot: Robot, coupling: Coupling, say: Say) -> None:
    """Check speeds and accelerations of all motors, group by group of coupled motors."""
    gears = dict(enumerate(exact(abs(robot.actuation.gear))))
    quantities = tuple(_quantities(robot))
    for motors, joints in coupling.groups:
        group = _Group(coupling, motors, joints)
        for quantity in quantities:
            settings = {
                row: content.settings[motor_variable(robot.controller.motors[row], quantity.number)]
                for row in motors
            }
            even = _even(quantity, {row: gears[row] for row in motors}, group)
            if wrong := _wrong(quantity, settings, even, group, robot):
                setting, message = wrong
                say("Y1174", setting.line, f"{setting.name}={setting.printed}: {message}")


def _quantities(robot: Robot) -> Iterator[_Quantity]:
    limits, units = robot.limits, robot.axis_units
    stop, acceleration = exact(limits.stop_acceleration / units), exact(limits.acceleration / units)
    rapid = exact(robot.controller.rapid_share * limits.velocity / units)
    fastest = exact(robot.actuation.velocity)
    share = f"the velocity limit times {robot.controller.rapid_share:g}"
    yield _Quantity(15, _ACCELERATION, stop, None, "an abort brakes", "the stop acceleration")
    yield _Quantity(16, _SPEED, rapid, fastest, "RAPID with Ixx90=1 moves", share)
    yield _Quantity(17, _ACCELERATION, acceleration, None, "LINEAR accelerates", "the acceleration limit")
    yield _Quantity(19, _ACCELERATION, acceleration, None, "RAPID accelerates", "the acceleration limit")
    yield _Quantity(22, _SPEED, rapid, fastest, "RAPID moves", share)


@frozen
class _Group:
    """Coupled motors and joints, by their rows."""

    coupling: Coupling
    motors: list[int]
    joints: list[int]

    def worst(self, joint: int, rates: _Rates) -> Fraction:
        """Return the largest rate of one joint [axis units/s or /s^2], whichever way the motors turn."""
        # The worst case is that all motors push the joint in one direction.
        shares = self.coupling.inverse[joint]
        return sum((abs(shares[row] * rate) for row, rate in rates.items() if shares[row]), Fraction(0))


def _even(quantity: _Quantity, gears: _Rates, group: _Group) -> _Rates:
    """Return the largest motor rates that are proportional to the gear ratios and exceed no joint's limit. A
    rate beyond the motor's own limit is reduced to that limit.
    """
    # Scale the gear ratios up until the first joint reaches its limit.
    largest = min(quantity.limits[joint] / group.worst(joint, gears) for joint in group.joints)
    even = {row: gear * largest for row, gear in gears.items()}
    return (
        even if quantity.most is None else {row: min(rate, quantity.most[row]) for row, rate in even.items()}
    )


def _wrong(
    quantity: _Quantity, settings: Mapping[int, Setting], even: _Rates, group: _Group, robot: Robot
) -> tuple[Setting, str] | None:
    """Return the first wrong setting of a group of motors and its fault in words; None if all are right."""
    rates = {row: setting.value * quantity.unit for row, setting in settings.items()}
    shares = {row: rate / even[row] for row, rate in rates.items()}
    # Compute the largest rate of each joint for the motor rates in the settings, as a fraction of its limit.
    loads = {joint: group.worst(joint, rates) / quantity.limits[joint] for joint in group.joints}
    joint = max(loads, key=lambda one: loads[one])
    if loads[joint] > 1 + _ROUNDING:
        moving = [row for row in settings if group.coupling.inverse[joint][row]]
        row = max(moving, key=lambda one: shares[one])
        limit, unit = quantity.limits[joint], robot.axis_unit_names[joint] + quantity.per
        fault = (
            f"{quantity.does} {robot.joint_names[joint]} with up to {float(loads[joint] * limit):.5g} {unit}"
        )
        return settings[row], f"{fault}; {float(limit):.5g} {unit} are allowed, {quantity.limit}"
    for row, rate in rates.items():
        motor = robot.controller.motors[row]
        if quantity.most is not None and rate > quantity.most[row] * (1 + _ROUNDING):
            most = float(quantity.most[row])
            fault = f"{quantity.does} motor {motor} with {float(rate):.5g} counts{quantity.per}"
            return settings[row], f"{fault}; {most:.5g} are allowed"
        # `even` has the largest allowed rates: in proportion to the gear ratios, and within the motors' own
        # limits. A motor whose rate is smaller makes moves longer than necessary.
        if shares[row] < 1 - _ROUNDING:
            least = float(even[row] / quantity.unit)
            fault = f"{quantity.does} motor {motor} less than {quantity.limit} allows"
            return settings[row], f"{fault}; it must be {least:.5g}"
    return None
