"""Make the planner's findings about times and speeds.

The functions return a `Message`: the finding's code, a sentence with numbers, the place in the source, the
advice for the user, and an automatic fix if there is one.
"""

from __future__ import annotations

import math

from yarclang.diagnostics import Edit, Fix
from yarclang.hir import Motion, Origin, TimedMove
from yarclang.motion.cruise import CruiseBroken
from yarclang.motion.curve import FEWEST_SEGMENTS, Curve
from yarclang.motion.fit import MOST_SEGMENTS, NotHeld, TooFast, TooLong
from yarclang.motion.limits import Demand, Grid
from yarclang.motion.profile import NoLaw, profiles_with
from yarclang.motion.singular import Nearest
from yarclang.motion.timed import Broken, Refused, TooShort
from yarclang.motion.wording import Message, MessageAbout, length_text, percent_text
from yarclang.robot.model import Robot
from yarclang.subjects import MissingUnit
from yarclang.units import DEG, MM, MS, UNITS, Kind
from yarclang.written import slower, stretch_fix


def no_motion(origin: Origin) -> Message:
    """Return the finding that a motion leads to the robot's present position."""
    message = "the robot stands at the target already: nothing moves"
    return "Y0603", message, origin.span, "take the command away, or check its target", None


def too_fast(robot: Robot, fitted: TooFast, grid: Grid, step: Motion, near: Nearest | None = None) -> Message:
    """Return the finding that a motion breaks a limit in its given time."""
    origin = step.origin
    shortest = f"{fitted.shortest:.10g} s"
    fix = None
    if math.isinf(fitted.shortest):
        help_ = (
            f"no time works: not even {MOST_SEGMENTS:,} segments; the path passes too near a singularity, "
            "go round it"
        )
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


def timetable_refused(robot: Robot, refused: Refused, step: TimedMove, stretch: float | None) -> Message:
    """Return the finding that a timetable breaks a limit, or that the controller's segments can't follow it.

    Args:
        robot: the robot.
        refused: the reason.
        step: the motion.
        stretch: the smallest factor after STRETCH, by which all times grow, that works; or None.
    """
    origin = step.origin
    when = "" if isinstance(refused, TooShort) else f"{refused.time:.4g} s after the start"
    if isinstance(refused, TooShort):
        code, other = "Y0617", ""
        message = (
            f"the timetable lasts {refused.duration:.4g} s; the fewest segments, {FEWEST_SEGMENTS}, last "
            f"{refused.shortest:.4g} s"
        )
    elif isinstance(refused, Broken):
        code = "Y0912" if refused.demand.watch is not None else "Y0616"
        message = f"{_excess(robot, step, refused.demand, refused.share)}, {when}"
        other = ""
    else:
        name, unit = robot.joint_names[refused.joint], robot.axis_unit_names[refused.joint]
        factor = robot.axis_units[refused.joint]
        code = "Y0617"
        message = (
            f"{name} would be {refused.off / factor:.3g} {unit} from the path of the timetable, {when}, "
            f"with the shortest segments of {refused.segment / MS:.4g} ms; allowed are "
            f"{step.within[refused.joint] / factor:.3g} {unit}"
        )
        other = "; or allow more with TOL"
    if stretch is None:
        return (
            code,
            message,
            origin.span,
            f"no STRETCH is found that works: look at positions, velocities and accelerations there{other}",
            None,
        )
    help_ = f"the shortest STRETCH that works is {stretch:.10g}{other}"
    return code, message, origin.span, help_, stretch_fix(step, stretch)


def _excess(robot: Robot, step: Motion, demand: Demand, used_share: float) -> str:
    """Return a clause that names the joint, motor or zone whose limit is broken, and by how much."""
    limits, row = robot.limits, demand.row
    if demand.watch is not None and demand.watch.item is not None:
        zone = demand.watch.zone
        limit = (zone.speed or 0.0) / MM
        return (
            f"{demand.watch.item.name} would go at {limit * used_share:,.4g} mm/s in the zone {zone.name}, "
            f"{percent_text(used_share - 1)} above the {limit:,.4g} mm/s that it allows"
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
        f"the {what} of {whose} would be {limit * used_share:,.4g} {unit}, {percent_text(used_share - 1)} "
        f"above its limit of {limit:,.4g} {unit}{reduced}"
    )


def too_fast_a_cruise(
    robot: Robot, fitted: CruiseBroken, step: Motion, near: Nearest | None = None
) -> Message:
    """Return the finding that the moving frame can't have the requested speed."""
    origin, broken = step.origin, fitted.broken
    span = origin.time_span or origin.span
    message, code = "no segments are short enough for this speed", "Y0605"
    if broken is not None and broken.demand is not None:
        message = (
            f"at this speed {_excess(robot, step, broken.demand, broken.share)} at {broken.s * 100:.3g} % "
            "of the way"
        )
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
    text, fix = slower(fitted.share, origin)
    return code, message, span, f"the highest speed that works is about {text}", fix


def near_singularity(robot: Robot, near: Nearest, curve: Curve, step: Motion) -> Message:
    """Return the finding that a singularity makes a motion slow."""
    message = f"the path comes near a singularity: {_beside(robot, near)}"
    if step.timing.duration is None and step.timing.speed is None:
        message += f"; the shortest time is {curve.duration:.4g} s"
    help_ = "a way farther from it takes less time: another pose, a via, or MOVEJ"
    return "Y0702", message, step.origin.span, help_, None


def _beside(robot: Robot, near: Nearest) -> str:
    """Return a clause about the place where a path is nearest to a singularity: its distance along the path,
    and its effect on speed.
    """
    joint, unit = robot.joint_names[near.joint], robot.axis_unit_names[near.joint]
    rate = near.rate / robot.axis_units[near.joint] * (DEG if near.turns else MM)
    return (
        f"at {near.s * 100:.3g} % of the way the smallest singular value is {near.smallest:.2g}, and "
        f"{joint} moves {rate:.3g} {unit} per {'deg' if near.turns else 'mm'}"
    )


def speed_without_unit(turns: bool, origin: Origin) -> MessageAbout:
    """Return the finding that a speed has no unit that suits the path."""
    kind: Kind = "angle" if turns else "length"
    what = "an angle unit: the moving frame only turns" if turns else "a length unit: the moving frame moves"
    subject = MissingUnit(kind, "the speed")
    message = f"the speed needs {what} here"
    return "Y0304", message, origin.time_span or origin.span, "for example (mm,deg,s)", None, subject


def no_cruise(step: Motion) -> Message:
    """Return the finding that a speed is requested of a motion profile without a cruise."""
    origin = step.origin
    message = f"[V ..] is the speed of a cruise, and _{step.profile} has none"
    help_ = f"take {profiles_with(lambda profile: profile.has_cruise)}"
    return "Y0407", message, origin.time_span or origin.span, help_, None


def too_long(robot: Robot, fitted: TooLong, origin: Origin, near: Nearest | None = None) -> Message:
    """Return the finding that a motion would need more segments than are ever planned."""
    message = (
        f"the motion takes {fitted.duration:,.0f} s or longer: more than {MOST_SEGMENTS:,} segments, the "
        "most that are planned"
    )
    if near is not None:
        message += f"; {_beside(robot, near)}"
    help_ = (
        "if [MIN] takes so long, the path passes too near a singularity: go round it; or through a slow "
        "zone of the cell whose speed has another unit than was meant; else divide the motion"
    )
    return "Y0604", message, origin.time_span or origin.span, help_, None


def too_long_a_table(fitted: TooLong, origin: Origin) -> Message:
    """Return the finding that a timetable would need more segments than are ever planned."""
    message = (
        f"the timetable takes {fitted.duration:,.0f} s, for which the tolerance wants more than "
        f"{MOST_SEGMENTS:,} segments, the most that are planned"
    )
    help_ = "divide it where the robot rests; a larger TOL wants fewer segments"
    return "Y0604", message, origin.span, help_, None


def no_law(robot: Robot, fitted: NoLaw, step: Motion, near: Nearest | None = None) -> Message:
    """Return the finding that the search for a motion profile gives up at a place of the path."""
    message = (
        f"no law of _{step.profile} is found along this path: the search gives up at {fitted.s * 100:.3g} % "
        "of the way"
    )
    if near is not None:
        message += f"; {_beside(robot, near)}"
    help_ = (
        f"take {profiles_with(lambda profile: not profile.needs_search)}, which need no search; "
        "a way farther from singularities helps too: another pose, or a via"
    )
    return "Y0614", message, step.origin.span, help_, None


def not_held(fitted: NotHeld, smallest: float, origin: Origin) -> Message:
    """Return the finding that the controller's segments can't follow a path within the tolerance."""
    message = (
        f"with segments of {fitted.segment / MS:.4g} ms the path is missed by "
        f"{length_text(fitted.position)} and {fitted.angle / DEG:.2g} deg, and the controller takes none "
        f"shorter than {smallest / MS:.4g} ms"
    )
    return "Y0602", message, origin.span, "give the motion more time, or allow more (--tolerance)", None


def _not_below(value: float) -> float:
    """Return a value rounded up to seven significant digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 6)
    return math.ceil(value / step - 1e-6) * step
