"""Values to goals: the only place where mm and deg become m and rad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from yarclang.commands.spec import Arguments, Values
from yarclang.diagnostics import Collector, suggest
from yarclang.hir import Array, JointDelta, JointGoal, Origin, PoseDelta, PoseGoal, Step, Timing
from yarclang.robot.model import Robot
from yarclang.semantics.context import Context, Defaults
from yarclang.semantics.frames import Axes, base_axes, check_frame, moving_frame
from yarclang.semantics.names import ResolvedName
from yarclang.semantics.parts import ALL_PARTS, refuse_parts
from yarclang.semantics.times import resolve_time
from yarclang.semantics.units import missing_unit, number_fault, resolve_units
from yarclang.source import Span
from yarclang.syntax.ast import Number, Statement, WayPoint, Word
from yarclang.units import Kind, Unit

QUATERNION_TOLERANCE = 1e-3


def to_step(
    statement: Statement, name: ResolvedName, context: Context, defaults: Defaults, findings: Collector
) -> Step | None:
    """One command in SI.

    Returns:
        None where the command has errors; each is a finding.
    """
    before = len(findings.found)
    own_units = resolve_units(statement, statement.units, findings) if name.values else {}
    units = {**defaults.units, **own_units} if own_units is not None else None
    origin = Origin(
        index=f"P{int(statement.index.text[1:]):04d}" if statement.index else "",
        name=name.full,
        source=findings.source,
        span=statement.head_span,
        time_span=statement.span(statement.time.place) if statement.time else None,
        time_unit=units["time"].name if units and "time" in units else "s",
    )
    if name.values is None:
        refuse_parts(statement, ALL_PARTS, findings)
        goals: tuple[object, ...] = ()
        timing = Timing(0.0)
    else:
        goals = _goals(statement, name, name.values, context.robot, defaults, units, findings)
        timing = (
            resolve_time(statement, units or {}, defaults, findings) if units is not None else Timing(None)
        )
    if any(found.is_error for found in findings.found[before:]):
        return None
    return name.spec.build(Arguments(origin, goals, name.profile, timing))


def _goals(
    statement: Statement,
    name: ResolvedName,
    values: Values,
    robot: Robot,
    defaults: Defaults,
    units: Mapping[Kind, Unit] | None,
    findings: Collector,
) -> tuple[object, ...]:
    """The goals of all way-points, or what could be made of them beside the findings."""
    for option in statement.options:
        message = f"the option {option.word.name} is not carried out by this version"
        findings.add("Y0207", message, statement.span(option.word.place), "take it away")
    frames = _frames(statement, name, values, robot, defaults, findings)
    least, most = name.spec.waypoints
    given = len(statement.waypoints)
    if given < least or (most is not None and given > most):
        if given == 0:
            labels = values.labels(robot.joint_names)
            message = f"{name.spec.name} wants {len(labels)} values ({' '.join(labels)}), 0 are given"
            findings.add("Y0401", message, statement.head_span, _example(name))
            return ()
        wanted = "one way-point" if most == 1 else f"{least} or more way-points"
        place = statement.waypoints[min(given, most or given) - 1 if given < least else least].place
        message = f"{name.spec.name} takes {wanted}, {given} {'is' if given == 1 else 'are'} given"
        findings.add("Y0405", message, statement.span(place), _example(name))
    goals: list[object] = []
    told: set[str] = set()
    for number, waypoint in enumerate(statement.waypoints, 1):
        goal = _named_goal(statement, name, waypoint, robot, findings)
        if goal is None:
            numbers = _numbers(statement, name, values, waypoint, number, robot, findings)
            if numbers is None or units is None:
                continue
            factors = _factors(statement, values, robot, units, told, findings)
            if factors is None:
                continue
            goal = _goal(statement, waypoint, values, numbers * factors, frames, robot, findings)
        if goal is not None:
            goals.append(goal)
    return tuple(goals)


def _example(name: ResolvedName) -> str:
    return f"for example: {name.spec.examples[0].splitlines()[0]}"


def _frames(
    statement: Statement,
    name: ResolvedName,
    values: Values,
    robot: Robot,
    defaults: Defaults,
    findings: Collector,
) -> tuple[Array, Axes] | None:
    """The moving frame on the flange and the base axes; None for joint values or with errors."""
    if values.of_joints or (_takes_names(name) and _all_named(statement)):
        # joint values need no frames; those given change nothing, but have to exist
        for frame in (statement.moving, statement.base):
            if frame is not None:
                check_frame(statement, frame, robot, findings)
        return None
    moving = base = None
    if statement.moving or defaults.moving:
        line = statement if statement.moving else defaults.statement
        frame = statement.moving or defaults.moving
        assert line is not None
        assert frame is not None
        moving = moving_frame(line, frame, robot, findings)
    else:
        help_ = "write it behind the name, as {TCP}, or in DEFAULT"
        findings.add("Y0302", f"{name.full} doesn't say which frame it moves", statement.head_span, help_)
    if statement.base or defaults.base:
        line = statement if statement.base else defaults.statement
        frame = statement.base or defaults.base
        assert line is not None
        assert frame is not None
        base = base_axes(line, frame, robot, name.spec.frames_may_move, findings)
    else:
        help_ = "write the base frame behind the units, as {B}, or in DEFAULT"
        message = f"{name.full} doesn't say in which frame its values are given"
        findings.add("Y0302", message, statement.head_span, help_)
    return (moving, base) if moving is not None and base is not None else None


def _takes_names(name: ResolvedName) -> bool:
    """Whether names of joint positions may stand for way-points: where the command takes joint values at all."""
    return name.spec.targets.get("") is Values.JOINTS


def _all_named(statement: Statement) -> bool:
    """Whether every way-point is one word: the name of a joint position."""
    return bool(statement.waypoints) and all(
        len(waypoint.values) == 1 and isinstance(waypoint.values[0], Word) for waypoint in statement.waypoints
    )


def _named_goal(
    statement: Statement,
    name: ResolvedName,
    waypoint: WayPoint,
    robot: Robot,
    findings: Collector,
) -> object | None:
    """A way-point that is one name of a joint position: for commands that take joint values, whatever the target."""
    if len(waypoint.values) != 1 or not isinstance(word := waypoint.values[0], Word):
        return None
    if not _takes_names(name):
        return None
    if word.name in robot.positions:
        return JointGoal(robot.positions[word.name])
    if word.name in {"NAN", "INF", "INFINITY"}:
        return None
    meant = suggest(word.text, robot.positions)
    help_ = (meant + " " if meant else "") + f"{robot.name} has {', '.join(robot.positions)}"
    findings.add("Y0205", f"no joint position is named {word.text}", statement.span(word.place), help_)
    return JointGoal(robot.home)  # the finding is an error: the goal is never used


def _numbers(
    statement: Statement,
    name: ResolvedName,
    values: Values,
    waypoint: WayPoint,
    number: int,
    robot: Robot,
    findings: Collector,
) -> Array | None:
    """The values of a way-point as numbers, in the units of the line."""
    faults = 0
    for value in waypoint.values:
        fault = number_fault(value)
        if fault is not None:
            code, message, help_ = fault
            if isinstance(value, Word) and value.name in robot.positions:
                help_ = f"{value.name} is a joint position: MOVEJ goes there"
            findings.add(code, message, statement.span(value.place), help_)
            faults += 1
    if faults:
        return None
    labels = values.labels(robot.joint_names)
    if len(waypoint.values) != len(labels):
        which = f"way-point {number} of {name.spec.name}" if len(statement.waypoints) > 1 else name.full
        given = len(waypoint.values)
        difference = len(labels) - given
        help_ = (
            f"{difference} missing: {' '.join(labels[given:])}"
            if difference > 0
            else f"{-difference} surplus"
        )
        message = f"{which} wants {len(labels)} values ({' '.join(labels)}), {given} {'is' if given == 1 else 'are'} given"
        findings.add("Y0401", message, statement.span(waypoint.place), help_)
        return None
    return np.array([value.value for value in waypoint.values if isinstance(value, Number)])


def _factors(
    statement: Statement,
    values: Values,
    robot: Robot,
    units: Mapping[Kind, Unit],
    told: set[str],
    findings: Collector,
) -> Array | None:
    """The factors to SI of a way-point's values; a missing unit is told once a line."""
    kinds: tuple[Kind, ...] = tuple("length" if unit == "mm" else "angle" for unit in robot.axis_unit_names)
    missing: Sequence[Kind] = [
        kind for kind in dict.fromkeys(values.kinds(kinds)) if kind is not None and kind not in units
    ]
    for kind in missing:
        if kind not in told:
            what = {"length": "the lengths", "angle": "the angles", "time": "the time"}[kind]
            message, help_ = missing_unit(kind, what)
            findings.add("Y0304", message, statement.span(statement.waypoints[0].place), help_)
            told.add(kind)
    if missing:
        return None
    return np.array([1.0 if kind is None else units[kind].factor for kind in values.kinds(kinds)])


def _goal(
    statement: Statement,
    waypoint: WayPoint,
    values: Values,
    numbers: Array,
    frames: tuple[Array, Axes] | None,
    robot: Robot,
    findings: Collector,
) -> object | None:
    """One goal from values in SI."""
    span = statement.span(waypoint.place)
    if values is Values.JOINTS:
        check_limits(robot, numbers, findings, span)
        return JointGoal(_constant(numbers))
    if values is Values.JOINT_DELTAS:
        return JointDelta(_constant(numbers))
    rotation = _rotation(values, numbers[3:], findings, span)
    if rotation is None or frames is None:
        return None
    flange_from_moving, axes = frames
    if values.is_delta:
        turned = np.abs(numbers[3:]).max() if not values.is_quaternion else 0.0
        cosine = (np.trace(rotation) - 1.0) / 2.0
        if turned >= np.pi - 1e-9 or cosine <= -1.0 + 1e-12:
            message = "an increment of half a turn or more has no short way"
            findings.add("Y0409", message, span, "make two commands of it")
            return None
        return PoseDelta(
            _constant(numbers[:3]),
            _constant(rotation),
            _constant(axes.transform[:3, :3]),
            axes.on_flange,
            flange_from_moving,
        )
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[:3, 3] = numbers[:3]
    return PoseGoal(_constant(axes.transform @ pose), flange_from_moving)


def check_limits(robot: Robot, q: Array, findings: Collector, span: Span) -> None:
    """One finding for the joint that is farthest out of its limits."""
    excess = np.maximum(robot.limits.lower - q, q - robot.limits.upper) / robot.axis_units
    joint = int(np.argmax(excess))
    if excess[joint] <= 1e-9:
        return
    unit = robot.axis_unit_names[joint]
    lower, upper = (
        limit[joint] / robot.axis_units[joint] for limit in (robot.limits.lower, robot.limits.upper)
    )
    others = int(np.count_nonzero(excess > 1e-9)) - 1
    more = f" ({others} other joint{'s are' if others > 1 else ' is'} out too)" if others else ""
    message = (
        f"{robot.joint_names[joint]} at {q[joint] / robot.axis_units[joint]:.6g} {unit} is out of its limits "
        f"by {excess[joint]:.4g} {unit}{more}"
    )
    help_ = f"{robot.joint_names[joint]} goes from {lower:.6g} to {upper:.6g} {unit}"
    findings.add("Y0502", message, span, help_)


def _rotation(values: Values, numbers: Array, findings: Collector, span: Span) -> Array | None:
    """The rotation (3, 3) of roll pitch yaw [rad], or of a quaternion x y z w."""
    if not values.is_quaternion:
        return rpy_rotation(numbers)
    norm = float(np.linalg.norm(numbers))
    if abs(norm - 1.0) > QUATERNION_TOLERANCE:
        message = f"the quaternion qx qy qz qw has the norm {norm:.6g}, not 1"
        findings.add("Y0404", message, span, "the order is qx qy qz qw, with the real part last")
        return None
    x, y, z, w = numbers / norm
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def rpy_rotation(rpy: Array) -> Array:
    """Rz(yaw) Ry(pitch) Rx(roll) of `rpy` (3,) = roll pitch yaw [rad], as (3, 3)."""
    (sr, sp, sy), (cr, cp, cy) = np.sin(rpy), np.cos(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _constant(values: Array) -> Array:
    values = np.ascontiguousarray(values, dtype=np.float64)
    values.setflags(write=False)
    return values
