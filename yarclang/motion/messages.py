"""What the planner says: the code, one sentence with its figures, the place, the remedy, the fix."""

from __future__ import annotations

import math
import re

import numpy as np

from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.hir import (
    ArcMove,
    Array,
    Else,
    EndWhen,
    Gap,
    LineMove,
    Motion,
    Origin,
    PoseSplineMove,
    Step,
    Stop,
    When,
)
from yarclang.motion.cartesian import FramePath
from yarclang.motion.cruise import CruiseBroken
from yarclang.motion.curve import FEWEST_SEGMENTS, Curve
from yarclang.motion.fit import MOST_SEGMENTS, NotHeld, TooFast, TooLong
from yarclang.motion.limits import Demand, Grid
from yarclang.motion.paths.arc import NoArc
from yarclang.motion.singular import Nearest
from yarclang.robot.kinematics.nearest import Unreachable
from yarclang.robot.kinematics.track import Broken
from yarclang.robot.model import Robot
from yarclang.source import Span
from yarclang.units import DEG, MM, MS, UNITS, Kind

Message = tuple[str, str, Span, str, Fix | None]
CartesianMove = LineMove | ArcMove | PoseSplineMove

MUCH_SWING = 1.0
"""A spline that leaves the range of its way-points by more [deg or mm] is worth a note."""

MUCH_OF_BOX = 0.1
"""... or, of a curve of the moving frame, by more than this share of the diagonal of the box round them."""

_ANGLE_NOISE = 1e-3
"""A smaller angle [rad] that is left beside a distance comes from the search for the distance."""

_DISTANCE_NOISE = 1e-6
"""A smaller distance [m] that is left beside an angle comes from the search for both."""

_BY_JOINTS = "MOVEJ to the same pose may take another configuration; or give a via pose beside it"


def unreachable(robot: Robot, solved: Unreachable, origin: Origin, which: str = "") -> Message:
    """A pose without a joint position."""
    if solved.kind == "reach":
        message = f"{which}out of reach by {_miss(solved.miss, solved.miss_angle)}"
        return (
            "Y0501",
            message,
            origin.span,
            "check the pose, its units and its frames; or move the robot nearer",
            None,
        )
    joint = solved.joint or 0
    message = (
        f"{which}the pose needs {_beyond(robot, joint, solved.excess)}, in the configuration that needs least"
    )
    return "Y0502", message, origin.span, _range(robot, joint), None


def increments_out_of_limits(robot: Robot, end: Array, origin: Origin) -> Message:
    """DMOVEJ to a joint position beyond the limits."""
    limits = robot.limits
    excess = np.maximum(end - limits.upper, limits.lower - end) / robot.axis_units
    joint = int(np.argmax(excess))
    over = end[joint] - limits.upper[joint]
    amount = float(over if over > 0 else end[joint] - limits.lower[joint])
    message = f"the increments take {_beyond(robot, joint, amount)}"
    return "Y0502", message, origin.span, _range(robot, joint), None


def half_turn(origin: Origin, where: str = "") -> Message:
    """A motion that turns by half a revolution; `where` says at which of its way-points."""
    message = f"{where}the orientation turns by half a revolution: there is no short way"
    return "Y0409", message, origin.span, "give a via pose that says which way round", None


def no_arc(arc: NoArc, origin: Origin) -> Message:
    """Three points that give no circle."""
    if arc.kind == "half turn":
        return half_turn(origin)
    if arc.kind == "coincident":
        message = f"{arc.points} are {_length(arc.apart)} apart: they give no circle"
        help_ = "a full circle is two arcs of MOVEC; a motion without a way is a MOVEL"
    else:
        message = (
            f"start, via and end lie on a line (they bend by {arc.bend / DEG:.2g} deg): they give no circle"
        )
        help_ = "MOVEL goes straight; for an arc, move via off the line"
    return "Y0420", message, origin.span, help_, None


def broken_path(robot: Robot, broken: Broken, frame: FramePath, step: CartesianMove) -> Message:
    """A motion of the moving frame that can't be followed to its end."""
    origin = step.origin
    what = {LineMove: "straight line", ArcMove: "arc", PoseSplineMove: "curve"}[type(step)]
    point = np.round(frame.poses(np.array([broken.s]))[0, :3, 3] / MM, 1) + 0.0  # no negative zeros
    where = f"at {broken.s * 100:.3g} % of the way (x {point[0]:.1f}, y {point[1]:.1f}, z {point[2]:.1f} mm)"
    joint = broken.joint
    if broken.kind == "reach":
        message = f"the {what} leaves the workspace {where}: it is out of reach by up to {_miss(broken.amount, broken.angle)}"
        return "Y0503", message, origin.span, "go round by a via pose, or by MOVEJ", None
    if broken.kind == "limits" and joint is not None:
        message = (
            f"the {what} takes {_beyond(robot, joint, broken.amount)}, from {where.removeprefix('at ')} on"
        )
        return "Y0504", message, origin.span, f"{_range(robot, joint)}; {_BY_JOINTS}", None
    if broken.kind == "configuration":
        why = (
            f": {_beyond(robot, joint, broken.amount)} otherwise"
            if joint is not None and broken.amount
            else ""
        )
        message = f"the {what} needs another configuration {where}{why}"
        return "Y0801", message, origin.span, _BY_JOINTS, None
    name = robot.joint_names[joint] if joint is not None else "a joint"
    message = f"the {what} meets a singularity {where}: {name} would have to jump by {_amount(robot, joint or 0, abs(broken.amount))}"
    return "Y0701", message, origin.span, _BY_JOINTS, None


def spline_out_of_limits(robot: Robot, joint: int, excess: float, s: float, origin: Origin) -> Message:
    """A spline that takes a joint beyond its limits."""
    name, unit = robot.joint_names[joint], robot.axis_unit_names[joint]
    message = f"the curve takes {name} out of its limits by {excess:.4g} {unit} at {s * 100:.3g} % of the way"
    return (
        "Y0504",
        message,
        origin.span,
        f"{_range(robot, joint)}; a way-point between holds the curve back",
        None,
    )


def spline_swings_out(robot: Robot, joint: int, swing: float, s: float, origin: Origin) -> Message:
    """A spline that leaves the range of its way-points by much."""
    name, unit = robot.joint_names[joint], robot.axis_unit_names[joint]
    message = (
        f"the curve swings {swing:.3g} {unit} beyond its way-points in {name}, at {s * 100:.3g} % of the way"
    )
    return "Y0505", message, origin.span, "a way-point between holds it back", None


def curve_swings_out(axis: str, swing: float, s: float, origin: Origin) -> Message:
    """A curve of the moving frame that leaves the box round its way-points by much."""
    message = f"the curve swings {_length(swing)} beyond its way-points in {axis} of {{B}}, at {s * 100:.3g} % of the way"
    return "Y0505", message, origin.span, "a way-point between holds it back", None


def ways_part(robot: Robot, one: Array, other: Array, origin: Origin) -> Message:
    """A WHEN whose ways end at different joint positions."""
    off = np.abs(one - other) / robot.axis_units
    joint = int(np.argmax(off))
    message = (
        f"the ways of this WHEN end apart: {robot.joint_names[joint]} by {off[joint]:.4g} "
        f"{robot.axis_unit_names[joint]}"
    )
    return (
        "Y1002",
        message,
        origin.span,
        "end both at the same joint positions, with MOVEJ to a JOINTS name",
        None,
    )


def no_motion(origin: Origin) -> Message:
    """A motion to where the robot stands."""
    message = "the robot stands at the target already: nothing moves"
    return "Y0603", message, origin.span, "take the command away, or check its target", None


def too_fast(robot: Robot, fitted: TooFast, grid: Grid, step: Motion, near: Nearest | None = None) -> Message:
    """A time in which a limit is broken."""
    origin = step.origin
    shortest = f"{fitted.shortest:.10g} s"
    fix = None
    if math.isinf(fitted.shortest):
        help_ = f"no time works: not even {MOST_SEGMENTS:,} segments; the path passes too near a singularity, go round it"
    elif origin.time_span is not None:
        factor = UNITS[origin.time_unit].factor
        text = f"{_not_below(fitted.shortest / factor):.10g}"
        shortest = f"[{text}] ({origin.time_unit})"
        fix = Fix(f"write [{text}]", (Edit(origin.time_span, f"[{text}]"),))
    if math.isfinite(fitted.shortest):
        help_ = f"the shortest time that works is {shortest}; [MIN] takes the shortest there is"
    span = origin.time_span or origin.span
    demand = fitted.demand
    code = "Y0912" if demand is not None and demand.watch is not None else "Y0601"
    if demand is None:
        message = (
            f"this duration can't be divided into segments: the controller takes {FEWEST_SEGMENTS} or more, "
            f"of {grid.smallest / MS:.4g} to {grid.largest / MS:.4g} ms"
        )
        return "Y0601", message, span, help_, fix
    message = (
        f"{_excess(robot, step, demand, fitted.share)}, {fitted.time:.3g} s after the start "
        f"({fitted.s * 100:.3g} % of the way)"
    )
    if near is not None:
        message += f"; {_beside(robot, near)}"
    return code, message, span, help_, fix


def _excess(robot: Robot, step: Motion, demand: Demand, used_share: float) -> str:
    """What would break a limit, and by how much."""
    limits, row = robot.limits, demand.row
    if demand.watch is not None and demand.watch.item is not None:
        zone = demand.watch.zone
        limit = (zone.speed or 0.0) / MM
        return (
            f"{demand.watch.item.name} would go at {limit * used_share:,.4g} mm/s in the zone {zone.name}, {_percent(used_share - 1)} above "
            f"the {limit:,.4g} mm/s that it allows"
        )
    if demand.kind == "motor speed":
        limit = robot.actuation.velocity[row] * MS
        what, unit, whose = "speed", "counts/ms", f"motor {robot.controller.motors[row]}"
        share = 1.0
    else:
        table = {"velocity": limits.velocity, "acceleration": limits.acceleration, "jerk": limits.jerk}
        limit = table[demand.kind][row] / robot.axis_units[row]
        what, whose = demand.kind, robot.joint_names[row]
        unit = (
            robot.axis_unit_names[row] + {"velocity": "/s", "acceleration": "/s²", "jerk": "/s³"}[demand.kind]
        )
        share = step.timing.ramp if demand.kind in ("acceleration", "jerk") else 1.0
    limit *= share
    reduced = f" (ACC {share * 100:.4g}%)" if share != 1.0 else ""
    return (
        f"the {what} of {whose} would be {limit * used_share:,.4g} {unit}, {_percent(used_share - 1)} above "
        f"its limit of {limit:,.4g} {unit}{reduced}"
    )


def too_fast_a_cruise(
    robot: Robot, fitted: CruiseBroken, step: Motion, near: Nearest | None = None
) -> Message:
    """A speed of the moving frame that can't be held."""
    origin, broken = step.origin, fitted.broken
    span = origin.time_span or origin.span
    message, code = "no segments are short enough for this speed", "Y0605"
    if broken is not None and broken.demand is not None:
        message = f"at this speed {_excess(robot, step, broken.demand, broken.share)} at {broken.s * 100:.3g} % of the way"
        code = "Y0912" if broken.demand.watch is not None else code
    if near is not None:
        message += f"; {_beside(robot, near)}"
    if not fitted.share:
        return (
            code,
            message,
            span,
            "no speed works: the path passes too near a singularity, go round it",
            None,
        )
    text, fix = _slower(fitted.share, origin)
    return code, message, span, f"the highest speed that works is about {text}", fix


def speed_not_reached(share: float, step: Motion) -> Message:
    """A way that is too short for its speed."""
    origin = step.origin
    text, fix = _slower(share, origin)
    message = f"the limits leave no room to get to this speed on this way: the moving frame goes at {share * 100:.3g} % of it"
    help_ = f"{text} is reached; a longer way, gentler corners and larger blends make room"
    return "Y0610", message, origin.time_span or origin.span, help_, fix


def _slower(share: float, origin: Origin) -> tuple[str, Fix | None]:
    """A share of a speed, as it would be written, and a fix that writes it where the speed stands in the line."""
    if (written := _written_speed(origin)) is None or origin.time_span is None:
        return f"{share * 100:.3g} % of this speed", None
    value = written * share
    digits = 2 - math.floor(math.log10(value))
    text = f"[V {math.floor(value * 10.0**digits) / 10.0**digits:.10g}]"
    return text, Fix(f"write {text}", (Edit(origin.time_span, text),))


def near_singularity(robot: Robot, near: Nearest, curve: Curve, step: Motion) -> Message:
    """A path that a singularity makes slow."""
    message = f"the path comes near a singularity: {_beside(robot, near)}"
    if step.timing.duration is None and step.timing.speed is None:
        message += f"; the shortest time is {curve.duration:.4g} s"
    help_ = "a way farther from it takes less time: another pose, a via, or MOVEJ"
    return "Y0702", message, step.origin.span, help_, None


def _beside(robot: Robot, near: Nearest) -> str:
    """Where a path is nearest to a singularity, how near, and what that costs."""
    joint, unit = robot.joint_names[near.joint], robot.axis_unit_names[near.joint]
    rate = near.rate / robot.axis_units[near.joint] * (DEG if near.turns else MM)
    return (
        f"at {near.s * 100:.3g} % of the way the smallest singular value is {near.smallest:.2g}, and "
        f"{joint} moves {rate:.3g} {unit} per {'deg' if near.turns else 'mm'}"
    )


def _written_speed(origin: Origin) -> float | None:
    """The number of a speed that stands in the line itself."""
    span = origin.time_span
    if span is None:
        return None
    text = origin.source.line(span.line)[span.column - 1 : span.end_column - 1]
    found = re.fullmatch(r"\[\s*V\s+([0-9.eE+-]+)\s*\]", text, re.IGNORECASE)
    return float(found[1]) if found else None


def speed_without_unit(turns: bool, origin: Origin) -> Message:
    """A speed whose unit isn't given."""
    kind = "an angle" if turns else "a length"
    message = f"the speed needs {kind} unit: the moving frame {'only turns' if turns else 'moves'} here"
    return "Y0304", message, origin.time_span or origin.span, "for example (mm,deg,s)", None


def no_cruise(step: Motion) -> Message:
    """A speed with a law that keeps none."""
    origin = step.origin
    message = f"[V ..] is the speed of a cruise, and _{step.profile} has none"
    return "Y0407", message, origin.time_span or origin.span, "take _LSPB, the default, or _SCURVE", None


def blend_without_unit(kind: str, what: str, origin: Origin) -> Message:
    """BLEND without the unit that it needs."""
    message = f"BLEND {what} needs {kind} unit"
    return "Y0304", message, origin.span, "for example (mm,deg,s)", None


def nothing_to_flow_into(following: Step | None, origin: Origin) -> Message:
    """BLEND before something that isn't a motion, or that doesn't move."""
    if following is None or isinstance(following, Stop):
        what = "the program ends here"
    elif isinstance(following, Motion):
        what = "there is no way on one side of the corner"
    elif isinstance(following, EndWhen | Else | When):
        what = "the ways of a WHEN part or meet here"
    else:
        name = "a command with errors" if isinstance(following, Gap) else following.origin.name
        what = f"{name} follows, which the robot stands for"
    return "Y1010", f"no BLEND is done: {what}", origin.span, "the motion ends in an exact stop", None


def blend_too_large(largest: float, kind: Kind, by_the_next: bool, step: Motion) -> Message:
    """BLEND beyond half of a motion."""
    origin = step.origin
    amount = _length(largest) if kind == "length" else f"{largest / DEG:.4g} deg"
    whose = "the next motion" if by_the_next else "this motion"
    message = f"the blend is more than half of {whose}"
    return "Y0606", message, origin.span, f"the largest one here is {amount}", None


def not_tangent(off: tuple[float, float] | None, origin: Origin) -> Message:
    """BLEND 0 at a corner."""
    if off is None:
        why = "one is a path of joints, the other one of a frame"
    elif off[0] > off[1]:
        why = f"they meet at {off[0] / DEG:.3g} deg"
    else:
        why = f"the frame turns differently before and behind, by {off[1] / DEG * MM:.3g} deg/mm"
    message = f"BLEND 0 needs two paths that are tangent: {why}"
    return "Y0607", message, origin.span, "give the distance by which the corner may be cut, as BLEND 5", None


def stops_at_corner(origin: Origin) -> Message:
    """A blend that the limits leave no room for."""
    message = "the robot stops at this corner: in these times the limits leave no room to flow through it"
    return "Y0608", message, origin.span, "more time, a larger blend or a gentler corner make room", None


def time_off_the_grid(duration: float, curve: Curve, origin: Origin) -> Message:
    """A time that isn't a whole number of segments in a chain."""
    message = (
        f"the motion takes {curve.duration:.6g} s instead of {duration:.6g} s: motions without a stop between have one "
        f"segment time, {curve.segment / MS:.6g} ms, and theirs have none in common"
    )
    return (
        "Y0609",
        message,
        origin.time_span or origin.span,
        "times with a common part, as 1.2 and 0.8, are met exactly",
        None,
    )


def another_configuration(
    robot: Robot,
    step: Motion,
    taken: Array,
    nearest: Array | None,
    later: Step,
    reasons: tuple[Diagnostic, ...],
) -> Message:
    """A target whose nearest solution would break a later motion."""
    origin = step.origin
    why = next((reason for reason in reasons if reason.is_error), None)
    blamed = ""
    if why is not None:
        named = "" if isinstance(later, Gap) else later.origin.label
        label = named or (f"line {why.span.line}" if why.span is not None else "")
        blamed = f": with that, in {label}, {why.message}" if label else f": with that, {why.message}"
    message = f"this target isn't taken in the nearest configuration{differs(robot, taken, nearest)}{blamed}"
    help_ = "NEAR with a joint position in this configuration says that it is meant"
    return "Y0802", message, origin.span, help_, near_fix(robot, origin, taken)


def differs(robot: Robot, taken: Array, nearest: Array | None) -> str:
    """In which joints a solution differs from the nearest, in brackets."""
    if nearest is None:
        return ""
    # no negative zeros
    shown = [np.round(one / robot.axis_units, 1) + 0.0 for one in (taken, nearest)]
    apart = np.abs(taken - nearest) / robot.axis_units
    joints = [joint for joint in np.argsort(-apart).tolist() if apart[joint] > 1.0][:3]
    told = (
        f"{robot.joint_names[joint]} {shown[0][joint]:.1f} instead of {shown[1][joint]:.1f} "
        f"{robot.axis_unit_names[joint]}"
        for joint in sorted(joints)
    )
    return f" ({', '.join(told)})"


def near_fix(robot: Robot, origin: Origin, q: Array) -> Fix | None:
    """A fix that names the joint position and takes it by NEAR; None where one command has many places."""
    if not origin.index or ">" in origin.place or "(" in origin.place or origin.end_span is None:
        return None
    name = f"{origin.index}_NEAR"
    units = sorted(
        {"mm" if unit == "mm" else "deg" for unit in robot.axis_unit_names}, key=("mm", "deg").index
    )
    values = " ".join(
        f"{value:.3f}".rstrip("0").rstrip(".") for value in np.round(q / robot.axis_units, 3) + 0.0
    )
    declaration = f"JOINTS {name} {values} ({','.join(units)})\n"
    line = Span.on_line(origin.span.line, 1, 1)
    return Fix(
        f"declare {name} and write NEAR {name}",
        (Edit(line, declaration), Edit(origin.end_span, f" NEAR {name}")),
    )


def too_long(robot: Robot, fitted: TooLong, origin: Origin, near: Nearest | None = None) -> Message:
    """A motion of more segments than are planned."""
    message = f"the motion takes {fitted.duration:,.0f} s or longer: more than {MOST_SEGMENTS:,} segments, the most that are planned"
    if near is not None:
        message += f"; {_beside(robot, near)}"
    help_ = (
        "if [MIN] takes so long, the path passes too near a singularity: go round it; or through a slow zone of the cell whose speed has another "
        "unit than was meant; else divide the motion"
    )
    return "Y0604", message, origin.time_span or origin.span, help_, None


def not_held(fitted: NotHeld, smallest: float, origin: Origin) -> Message:
    """A path that the controller's segments can't follow."""
    message = (
        f"with segments of {fitted.segment / MS:.4g} ms the path is missed by {_length(fitted.position)} and "
        f"{fitted.angle / DEG:.2g} deg, and the controller takes none shorter than {smallest / MS:.4g} ms"
    )
    return "Y0602", message, origin.span, "give the motion more time, or allow more (--tolerance)", None


def _not_below(value: float) -> float:
    """The value rounded up to six digits behind its first."""
    step = 10.0 ** (math.floor(math.log10(value)) - 6)
    return math.ceil(value / step - 1e-6) * step


def _percent(share: float) -> str:
    return f"{share * 100:.3g} %" if share < 10.0 else f"{share * 100:,.0f} %"


def _miss(distance: float, angle: float) -> str:
    """A distance [m], an angle [rad] or both: what isn't rounding."""
    if angle <= _ANGLE_NOISE:
        return _length(distance)
    turn = f"{angle / DEG:.3g} deg"
    return turn if distance < _DISTANCE_NOISE else f"{_length(distance)} and {turn}"


def _length(metres: float) -> str:
    return f"{metres / MM:.3g} mm" if abs(metres) < 1.0 else f"{metres / MM:,.0f} mm"


def _amount(robot: Robot, joint: int, value: float) -> str:
    return f"{value / robot.axis_units[joint]:.4g} {robot.axis_unit_names[joint]}"


def _beyond(robot: Robot, joint: int, excess: float) -> str:
    side = "above its upper" if excess > 0 else "below its lower"
    return f"{robot.joint_names[joint]} {_amount(robot, joint, abs(excess))} {side} limit"


def _range(robot: Robot, joint: int) -> str:
    lower, upper = (
        limit[joint] / robot.axis_units[joint] for limit in (robot.limits.lower, robot.limits.upper)
    )
    return f"{robot.joint_names[joint]} goes from {lower:.6g} to {upper:.6g} {robot.axis_unit_names[joint]}"
