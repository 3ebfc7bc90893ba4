"""Find where a program comes nearest to a limit, a tolerance, a margin or the border of a zone."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from heapq import nlargest
from operator import attrgetter
from typing import Any, NamedTuple

from yarclang.cell.model import Cell
from yarclang.certify.certificate import (
    IDLE,
    Certificate,
    Clearance,
    CommandCertificate,
    Load,
    Quantity,
    ZoneSpeed,
    bound_text,
)
from yarclang.certify.outward import down_to, most, up_to
from yarclang.frozen import frozen
from yarclang.report.distances import whole_tenths
from yarclang.robot.model import Robot, Tolerance
from yarclang.units import DEG, MM

MOST = 10
"""Largest number of places that are shown."""

_MORE, _LESS = 1.0 + 1e-15, 1.0 - 1e-15
"""Factors that make a printed number slightly worse, so that the rounding errors of its computation (three
roundings) can't make it look better than the proved value.
"""


@frozen
class Nearest:
    """A command that comes near to a limit, a tolerance, a margin or a border.

    Attributes:
        command: command of the program.
        what: the measured quantity.
        figure: the value in words.
        share: share of the allowed value; None for a distance without a margin.
        rank: sort key: the share or, without a margin, 1 mm divided by the distance.
    """

    command: CommandCertificate
    what: str
    figure: str
    share: float | None
    rank: float

    @property
    def is_judged(self) -> bool:
        """True if the quantity has a limit that the program must not exceed."""
        return self.share is not None


def source_command(command: CommandCertificate) -> tuple[str, int, str]:
    """Return a key that is equal for all commands from one line of the source: module, line and name."""
    return command.module, command.source_line, command.name


def nearest_places(certificate: Certificate, robot: Robot, cell: Cell | None) -> tuple[Nearest, ...]:
    """Return the commands that come nearest to their limits, sorted: the nearest one for each measured
    quantity and, if there is room, further commands.

    A line of the source that is executed several times is listed once for a quantity, with its worst value.

    Args:
        certificate: the proved commands.
        robot: robot with the limits of joints and motors.
        cell: cell with the margins of obstacles and zones.
    """
    worst: dict[tuple[str, int, str, str], _Found] = {}
    measure = _Measure(certificate.tolerance, robot, cell)
    for command in certificate.commands:
        source = source_command(command)
        for place in measure.of(command):
            key = (*source, place.what)
            previous = worst.get(key)
            if previous is None or place.rank > previous.rank:
                worst[key] = place
        if len(worst) > _MANY:
            worst = _foremost(worst)
    first: dict[str, _Found] = {}
    for place in worst.values():
        previous = first.get(place.what)
        if previous is None or place.rank > previous.rank:
            first[place.what] = place
    chosen = nlargest(MOST, first.values(), key=_rank)
    rest = (place for place in worst.values() if place.share is not None and first[place.what] is not place)
    chosen += nlargest(MOST - len(chosen), rest, key=_rank)
    return tuple(place.told() for place in sorted(chosen, key=_rank, reverse=True))


_MANY = 4_096
"""If there are more candidates than this, those that can't be among the nearest are dropped."""


def _foremost(worst: dict[tuple[str, int, str, str], _Found]) -> dict[tuple[str, int, str, str], _Found]:
    """Drop candidates that can't be in the list: keep only the nearest ones of each measured quantity, in the
    order in which they were found.
    """
    by_quantity: dict[str, list[tuple[str, int, str, str]]] = {}
    for key in worst:
        by_quantity.setdefault(key[-1], []).append(key)
    nearest = {
        key
        for keys in by_quantity.values()
        for key in nlargest(MOST + 1, keys, key=lambda one: worst[one].rank)
    }
    return {key: one for key, one in worst.items() if key in nearest}


class _Found(NamedTuple):
    """A candidate for the list of commands nearest to a limit, with the attributes of `Nearest`. Its figure
    is formatted only when it is needed, by `words` from `values`.
    """

    command: CommandCertificate
    what: str
    share: float | None
    rank: float
    words: Callable[..., str]
    values: tuple[Any, ...]

    def told(self) -> Nearest:
        """Return the candidate as a `Nearest`, with its value in words."""
        return Nearest(self.command, self.what, self.words(*self.values), self.share, self.rank)


_rank = attrgetter("rank")


class _Measure:
    """Converter of a proved command to measured quantities, for a robot in a cell."""

    def __init__(self, tolerance: Tolerance, robot: Robot, cell: Cell | None) -> None:
        self._tolerance = tolerance
        self._margins = {body.name: body.margin for body in cell.obstacles} if cell else {}
        self._zone_margins = {zone.name: zone.margin for zone in cell.zones} if cell else {}
        limits, names, units = robot.limits, robot.joint_names, robot.axis_units
        axis = robot.axis_unit_names
        effort = [] if robot.dynamics is None else robot.dynamics.effort.tolist()
        force = ["N" if unit == "mm" else "N m" for unit in axis]
        motors = [f"motor {motor}" for motor in robot.controller.motors]
        self._scales: tuple[tuple[Quantity, str, dict[str, tuple[float, str]]], ...] = (
            ("velocity", "speed", _scale(names, limits.velocity / units, axis, "/s")),
            ("acceleration", "acceleration", _scale(names, limits.acceleration / units, axis, "/s^2")),
            ("jerk", "jerk", _scale(names, limits.jerk / units, axis, "/s^3")),
            ("motor_velocity", "motor speed",
                _scale(motors, robot.actuation.velocity, ["counts"] * len(motors), "/s")),
            ("torque", "torque", _scale(names, effort, force, "")),
        )  # fmt: skip
        half = (limits.upper - limits.lower) / 2.0 / units
        self._halves = _scale(names, half, axis, "")

    def of(self, command: CommandCertificate) -> Iterator[_Found]:
        """Yield the measured quantities of a command."""
        if name := command.position.name:
            share = command.position.share
            yield _Found(command, "position", share, share, _before_limit, (name, share, *self._halves[name]))
        for key, quantity, scale in self._scales:
            load: Load = getattr(command, key) or IDLE
            if not load.name or (key == "jerk" and not command.jerk_judged):
                continue
            form = ",.0f" if key == "motor_velocity" else ".4g"
            yield _Found(
                command, quantity, load.share, load.share, _of_limit, (load, *scale[load.name], form)
            )
        tolerance = command.tolerance or self._tolerance
        for quantity, value, limit, unit, called in (
            ("path mm", command.deviation.position, tolerance.position, MM, "mm"),
            ("path deg", command.deviation.angle, tolerance.angle, DEG, "deg"),
        ):
            share = value / limit
            yield _Found(command, quantity, share, share, _of_tolerance, (value, limit, unit, called))
        yield from self._distances(command)
        if (speed := command.zone_speed) is not None:
            quantity = "speed ceiling" if speed.of_motion else "speed in zone"
            yield _Found(command, quantity, speed.share, speed.share, _in_zone, (speed,))

    def _distances(self, command: CommandCertificate) -> Iterator[_Found]:
        for quantity, near, margins in (
            ("clearance", command.clearance, self._margins),
            ("own clearance", command.own_clearance, {}),
            ("zone border", command.zone_clearance, self._zone_margins),
        ):
            if near is None or not near.first:
                continue
            margin = max(margins.get(near.first, 0.0), margins.get(near.second, 0.0))
            share = margin / near.distance if margin > 0.0 and near.distance > 0.0 else None
            rank = MM / max(near.distance, MM) if share is None else share
            yield _Found(command, quantity, share, rank, _distance, (near, margin))


def _before_limit(name: str, share: float, half: float, unit: str) -> str:
    """Return a position in words: `J2 12.3 deg before its limit`."""
    return f"{name} {down_to(max(0.0, (1.0 - share) * half) * _LESS, 4)} {unit} before its limit"


def _of_limit(load: Load, limit: float, unit: str, form: str) -> str:
    """Return a velocity or another limited quantity in words: `J2 90 of 100 deg/s`."""
    used = load.share * limit * _MORE
    told = f"{math.ceil(used):,}" if form == ",.0f" else up_to(used, 4)
    return f"{load.name} {told} of {limit:{form}} {unit}"


def _of_tolerance(value: float, limit: float, unit: float, called: str) -> str:
    """Return a deviation in words: `0.0012 of 0.02 mm`."""
    return f"{bound_text(value, unit)} of {limit / unit:.4g} {called}"


def _in_zone(speed: ZoneSpeed) -> str:
    """Return a speed in a zone in words: `FINGERS 90 of 100 mm/s in WORKER`. If the motion's own speed limit
    applies, no zone is named.
    """
    where = "" if speed.of_motion else f" in {speed.zone}"
    return f"{speed.part} {up_to(most(speed.largest, MM), 4)} of {speed.limit / MM:.4g} mm/s{where}"


def _distance(near: Clearance, margin: float) -> str:
    """Return a distance in words: `12.3 mm (FINGERS, BENCH), margin 5 mm`."""
    wanted = f", margin {margin / MM:.4g} mm" if margin > 0.0 else ""
    return f"{whole_tenths(near.distance)} mm ({near.first}, {near.second}){wanted}"


def _scale(
    names: Sequence[str], limits: Iterable[float], units: Sequence[str], per: str
) -> dict[str, tuple[float, str]]:
    """Return the limit of each joint or motor and its unit, by the name of the joint or motor."""
    return {
        name: (float(limit), f"{unit}{per}") for name, limit, unit in zip(names, limits, units, strict=False)
    }
