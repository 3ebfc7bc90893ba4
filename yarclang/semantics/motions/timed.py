"""Read timetables: waypoints with times, velocities and accelerations."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from yarclang.commands.spec import Timed
from yarclang.diagnostics import Result, has_errors
from yarclang.hir import Array, JointGoal, Timetable
from yarclang.semantics.motions.goals import goals_of
from yarclang.semantics.motions.line import Line
from yarclang.semantics.motions.options import refuse_at_most
from yarclang.semantics.motions.trajectory_file import TrajectoryFile
from yarclang.semantics.values.amounts import AmountError
from yarclang.semantics.values.evaluate import LARGEST_NUMBER
from yarclang.semantics.values.units import amount, joint_kinds, number_fault
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Computed, Number, Option, Place, Rate, Statement, Text, Time, Value, WayPoint
from yarclang.transforms import constant
from yarclang.units import UNITS, Kind

Load = Callable[[str, SourceFile | None], Result[TrajectoryFile]]

_WITHIN = {"angle": 1e-4, "length": 1e-4}
"""Default tolerance: allowed distance of a joint from the path of a timetable [rad or m] if the line has no
TOL.
"""

_STANDS = 1e-9
"""Largest velocity at the last waypoint that counts as rest [axis units per s]."""

_FORM = "write each waypoint with its time: 10 0 0 0 20 0 [0.5]; 12 0 0 0 20 0 [0.9]"


def refuse_rates(line: Line) -> None:
    """Add a finding if a waypoint has a time or rates, but the motion is no timetable."""
    if line.name.spec.is_timed:
        return
    for waypoint in line.statement.waypoints:
        for part in (waypoint.time, waypoint.velocity, waypoint.acceleration):
            if part is not None:
                what = "a time of its own" if isinstance(part, Time) else f"{part.word.name} after its time"
                message = f"a waypoint of {line.name.spec.name} can't have {what}".replace("no a ", "no ")
                line.findings.add(
                    "Y0421",
                    message,
                    line.statement.span(part.place),
                    "MOVEJ_TIMED is the motion with a timetable",
                )
                return


def timed_of(line: Line, load: Load | None) -> Timed | None:
    """Return the timetable of a timed motion, with its options.

    Args:
        line: the command.
        load: function that reads a trajectory file; None if files can't be read.

    Returns:
        None with findings if the command has an error.
    """
    before = len(line.findings.found)
    within, stretch = _options(line)
    values = [value for waypoint in line.statement.waypoints for value in waypoint.values]
    file = ""
    if any(isinstance(value, Text) for value in values):
        table = _from_file(line, load)
        file = values[0].text.strip('"')
    else:
        table = _table(line)
    if table is None or has_errors(line.findings.found[before:]):
        return None
    return Timed(table, within, stretch, file)


# options


def _options(line: Line) -> tuple[Array, float]:
    """Return the tolerances (n,) [rad or m] of the option TOL and the factor of the option STRETCH."""
    kinds = joint_kinds(line.robot)
    within = np.array([_WITHIN[kind] for kind in kinds])
    stretch = 1.0
    seen: set[str] = set()
    for option in line.statement.options:
        word, span = option.word.name, line.statement.span(option.word.place)
        if word == "ALLOW":
            continue  # `allowed_by` reads ALLOW
        if word in seen:
            line.findings.add("Y0412", f"{word} is given twice", span, "remove one of them")
        seen.add(word)
        refuse_at_most(line, option)
        if word == "STRETCH":
            stretch = _stretch(line, option)
        elif word == "TOL":
            within = _within(line, option, kinds, within)
        else:
            message = f"{line.name.spec.name} doesn't take {word}: its timetable gives the times"
            line.findings.add("Y0412", message, span, "remove it; STRETCH makes all times longer")
    return constant(within), stretch


def stretch_span(statement: Statement) -> Span | None:
    """Return the place of the factor after STRETCH; None without STRETCH, or if the factor is an
    expression.
    """
    for option in statement.options:
        if option.word.name == "STRETCH" and isinstance(option.argument, Number):
            return statement.span(option.argument.place)
    return None


def _stretch(line: Line, option: Option) -> float:
    span = line.statement.span((option.argument or option.word).place)
    if not isinstance(option.argument, Number | Computed):
        line.findings.add("Y0412", "STRETCH needs a factor", span, "for example STRETCH 1.5")
        return 1.0
    value = _plain(line, option.argument, "a factor")
    if value is None:
        return 1.0
    if not 0.0 < value <= LARGEST_NUMBER:
        message = f"STRETCH {value:.10g}: the factor must be above 0"
        line.findings.add("Y0412", message, span, "for example STRETCH 1.5 for one and a half times as long")
        return 1.0
    return value


def _within(line: Line, option: Option, kinds: tuple[Kind, ...], default: Array) -> Array:
    span = line.statement.span((option.argument or option.word).place)
    if not isinstance(option.argument, Number | Computed):
        line.findings.add(
            "Y0412",
            "TOL needs the largest deviation of a joint from the timetable",
            span,
            "for example TOL 0.01",
        )
        return default
    found = amount(option.argument, line.scope, line.statement, line.findings)
    if found is None:
        return default
    if not found.value > 0.0:
        line.findings.add("Y0412", f"TOL {found}: the tolerance must be above 0", span)
        return default
    if found.unit is not None:
        if found.unit.kind not in kinds:
            message = (
                f"{found} is of the wrong kind: no joint of {line.robot.name} moves in {found.unit.name}"
            )
            line.findings.add("Y0307", message, span)
            return default
        said = found.value * found.unit.factor
        return np.where([kind == found.unit.kind for kind in kinds], said, default)
    units = line.units or {}
    for kind in dict.fromkeys(kinds):
        if kind not in units:
            line.missing(kind, span)
            return default
    return np.array([found.value * units[kind].factor for kind in kinds])


# waypoints in the program


def _table(line: Line) -> Timetable | None:
    """Return the timetable of the waypoints in a command; None with findings."""
    statement, findings = line.statement, line.findings
    waypoints = statement.waypoints
    before = len(findings.found)
    goals = goals_of(line, None)
    times = [waypoint.time for waypoint in waypoints[:-1]]
    times += [statement.time] if waypoints else []
    missing = [number for number, time in enumerate(times, 1) if time is None]
    if missing:
        where = statement.span(waypoints[missing[0] - 1].place)
        more = f", nor have {len(missing) - 1} others" if len(missing) > 1 else ""
        findings.add(
            "Y0421", f"waypoint {missing[0]} of {line.name.spec.name} has no time{more}", where, _FORM
        )
    if has_errors(findings.found[before:]) or not waypoints or line.units is None:
        return None
    unit = line.units.get("time")
    if unit is None:
        line.missing("time", statement.span(times[0].place if times[0] else waypoints[0].place))
        return None
    seconds = [_seconds(line, time) for time in times if time is not None]
    if any(one is None for one in seconds):
        return None
    at = np.array(seconds, dtype=np.float64)
    if not _grows(line, at, times):
        return None
    positions = np.array([goal.q for goal in goals if isinstance(goal, JointGoal)])
    factors = np.array(
        [line.units[kind].factor if kind in line.units else 1.0 for kind in joint_kinds(line.robot)]
    )
    rates = [
        _rates(line, name, factors / unit.factor**order)
        for order, name in enumerate(("velocity", "acceleration"), 1)
    ]
    if has_errors(findings.found[before:]):
        return None
    velocities, accelerations = rates
    if accelerations is not None and velocities is None:  # the grammar allows ACC only after VEL
        return None
    if not _rests(line, velocities, statement.span(_last(waypoints[-1]))):
        return None
    return Timetable(
        constant(at),
        constant(positions),
        None if velocities is None else constant(velocities),
        None if accelerations is None else constant(accelerations),
    )


def _last(waypoint: WayPoint) -> Place:
    return (waypoint.velocity or waypoint).place


def _seconds(line: Line, time: Time) -> float | None:
    """Return the time of a waypoint [s]; None with a finding if it is wrong."""
    span = line.statement.span(time.place)
    unit = (line.units or {})["time"]
    if len(time.items) != 1 or not isinstance(item := time.items[0], Number | Computed):
        text = " ".join(item.text for item in time.items)
        message = f"[{text}] is no time of a waypoint: write the time from the start of the motion"
        line.findings.add("Y0421", message, span, _FORM)
        return None
    if isinstance(item, Number):
        if (fault := number_fault(item)) is not None:
            line.findings.add(fault[0], fault[1], span)
            return None
        value = item.value * unit.factor
    else:
        found = amount(item, line.scope, line.statement, line.findings)
        if found is None:
            return None
        try:
            value = found.in_unit(unit) * unit.factor
        except AmountError as error:
            line.findings.add_error(error, span)
            return None
    if not value > 0.0:
        message = (
            f"the time of a waypoint must be above 0: the motion begins at 0 s, and not at {value:.6g} s"
        )
        line.findings.add("Y0421", message, span, _FORM)
        return None
    return value


def _grows(line: Line, at: Array, times: list[Time | None]) -> bool:
    back = np.flatnonzero(np.diff(at) <= 0.0)
    if not back.size:
        return True
    number = int(back[0]) + 1
    time = times[number]
    assert time is not None
    message = (
        f"waypoint {number + 1} is at {at[number]:.10g} s, and the one before at {at[number - 1]:.10g} s: "
        "times must increase"
    )
    line.findings.add(
        "Y0421", message, line.statement.span(time.place), "times are counted from the start of the motion"
    )
    return False


def _rates(line: Line, name: str, factors: Array) -> Array | None:
    """Return the velocities or accelerations that a timed motion gives for its waypoints.

    Args:
        line: the command.
        name: "velocity" or "acceleration".
        factors: (n,) from the line's units to SI.

    Returns:
        (k, n) in SI; None if the waypoints have none, or with a finding if they have an error.
    """
    waypoints, word = line.statement.waypoints, {"velocity": "VEL", "acceleration": "ACC"}[name]
    rates: list[Rate | None] = [getattr(waypoint, name) for waypoint in waypoints]
    if not any(rates):
        return None
    rows: list[list[float]] = []
    for number, (waypoint, rate) in enumerate(zip(waypoints, rates, strict=True), 1):
        if rate is None:
            message = f"waypoint {number} has no {word}, but others have: give it for all or for none"
            span = line.statement.span(waypoint.place)
            line.findings.add(
                "Y0421", message, span, f"write {word} and a value for each joint after its time"
            )
            return None
        row = [_plain(line, value, "a rate") for value in rate.values]
        if any(one is None for one in row):
            return None
        if len(row) != len(factors):
            names = line.robot.joint_names
            verb = "is" if len(row) == 1 else "are"
            message = (
                f"{word} of waypoint {number} takes {len(names)} values ({' '.join(names)}), {len(row)} "
                f"{verb} given"
            )
            line.findings.add("Y0401", message, line.statement.span(rate.place))
            return None
        rows.append([float(one) for one in row if one is not None])
    return np.array(rows) * factors


def _plain(line: Line, value: Value, what: str) -> float | None:
    """Return a number that must have no unit. If it has one, return None, and add a finding that calls the
    number `what`.
    """
    span = line.statement.span(value.place)
    fault = number_fault(value)
    if fault is not None:
        line.findings.add(fault[0], fault[1], span, fault[2])
        return None
    if isinstance(value, Number):
        return value.value
    found = amount(value, line.scope, line.statement, line.findings)
    if found is None:
        return None
    try:
        return found.plain(what)
    except AmountError as error:
        line.findings.add_error(error, span)
        return None


def _rests(line: Line, velocities: Array | None, span: Span) -> bool:
    """Return True if a timetable ends at rest, and set its last velocities to exactly 0; otherwise add a
    finding.
    """
    if velocities is None:
        return True
    last = velocities[-1] / line.robot.axis_units
    joint = int(np.argmax(np.abs(last)))
    if abs(last[joint]) <= _STANDS:
        velocities[-1] = 0.0
        return True
    unit = line.robot.axis_unit_names[joint]
    message = (
        f"{line.robot.joint_names[joint]} moves at {last[joint]:.6g} {unit}/s at the last waypoint: the "
        "motion must end at rest"
    )
    line.findings.add("Y0421", message, span, "set the velocities of the last waypoint to 0")
    return False


# waypoints in a file


def _from_file(line: Line, load: Load | None) -> Timetable | None:
    """Return the timetable of a file in SI; None with findings."""
    statement, findings, robot = line.statement, line.findings, line.robot
    (first, *others) = statement.waypoints
    text = first.values[0]
    if others or len(first.values) > 1 or not isinstance(text, Text):
        message = f"{line.name.spec.name} needs waypoints, or the path of one file in quotes"
        findings.add(
            "Y0401", message, statement.span(first.place), f'for example {line.name.spec.name} "path.csv"'
        )
        return None
    span = statement.span(text.place)
    for part in (statement.time, first.velocity, first.acceleration):
        if part is not None:
            message = "no time, VEL or ACC is allowed with a file: the file gives them"
            findings.add(
                "Y0421", message, statement.span(part.place), "remove it; STRETCH makes all times longer"
            )
            return None
    if load is None:
        findings.add(
            "Y0421", f"no file can be read here: {text.text}", span, "write the waypoints in the program"
        )
        return None
    source = findings.source
    loaded = load(text.text.strip('"'), source if source.module else None)
    findings.found += [
        one if one.source is not None else replace(one, source=source, span=span)
        for one in loaded.diagnostics
    ]
    if loaded.value is None or has_errors(loaded.diagnostics) or line.units is None:
        return None
    own = frozenset(
        UNITS[item.text.lower()].kind for item in (statement.units.items if statement.units else ())
    )
    read = loaded.value.table(robot, line.units, own)
    findings.found += read.diagnostics
    return read.value
