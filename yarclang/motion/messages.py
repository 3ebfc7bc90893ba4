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
    """Return the finding that a motion ends at the position at which it begins."""
    message = "the robot is already at the target, so nothing moves"
    return "Y0603", message, origin.span, "remove the command, or check its target", None


def too_fast(robot: Robot, fitted: TooFast, grid: Grid, step: Motion, near: Nearest | None = None) -> Message:
    """Return the finding that a motion breaks a limit in its given duration."""
    origin = step.origin
    shortest = f"{fitted.shortest:.10g} s"
    fix = None
    if math.isinf(fitted.shortest):
        help_ = (
            f"no duration works, not even {MOST_SEGMENTS:,} segments: the path passes too near a "
            "singularity, so choose another path"
        )
    elif origin.time_span is not None:
        factor = UNITS[origin.time_unit].factor
        text = f"{_not_below(fitted.shortest / factor):.10g}"
        shortest = f"[{text}] ({origin.time_unit})"
        fix = Fix(f"write [{text}]", (Edit(origin.time_span, f"[{text}]"),))
    if math.isfinite(fitted.shortest):
        help_ = f"the shortest time that works is {shortest}; [MIN] always takes the shortest"
    span = origin.time_span or origin.span
    demand = fitted.demand
    code = "Y0912" if demand is not None and demand.watch is not None else "Y0601"
    if demand is None:
        message = (
            "the given time is too short or too long for the controller, which needs at least "
            f"{FEWEST_SEGMENTS} segments of {grid.smallest / MS:.4g} to {grid.largest / MS:.4g} ms"
        )
        return "Y0601", message, span, help_, fix
    message = (
        f"{_excess(robot, step, demand, fitted.share)}, {fitted.time:.3g} s after the start "
        f"({fitted.s * 100:.3g} % of the path)"
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
        stretch: the smallest factor of STRETCH that works (all times are multiplied by it); None if none
            was found.
    """
    origin = step.origin
    when = "" if isinstance(refused, TooShort) else f"{refused.time:.4g} s after the start"
    if isinstance(refused, TooShort):
        code, more = "Y0617", ""
        message = (
            f"the timetable lasts {refused.duration:.4g} s, but the controller needs at least "
            f"{FEWEST_SEGMENTS} segments, which last {refused.shortest:.4g} s"
        )
    elif isinstance(refused, Broken):
        code = "Y0912" if refused.demand.watch is not None else "Y0616"
        message = f"{_excess(robot, step, refused.demand, refused.share)}, {when}"
        more = ""
    else:
        name, unit = robot.joint_names[refused.joint], robot.axis_unit_names[refused.joint]
        factor = robot.axis_units[refused.joint]
        code = "Y0617"
        message = (
            f"{name} would be {refused.off / factor:.3g} {unit} from the path of the timetable, {when}, "
            f"even with the shortest segments ({refused.segment / MS:.4g} ms); "
            f"{step.within[refused.joint] / factor:.3g} {unit} are allowed"
        )
        more = "; or allow more with TOL"
    if stretch is None:
        return (
            code,
            message,
            origin.span,
            f"no STRETCH that works was found: check positions, velocities and accelerations there{more}",
            None,
        )
    help_ = f"the shortest STRETCH that works is {stretch:.10g}{more}"
    return code, message, origin.span, help_, stretch_fix(step, stretch)


def _excess(robot: Robot, step: Motion, demand: Demand, used_share: float) -> str:
    """Return a clause that names the joint, motor or zone whose limit is broken, and the amount."""
    limits, row = robot.limits, demand.row
    if demand.watch is not None and demand.watch.item is not None:
        zone = demand.watch.zone
        limit = (zone.speed or 0.0) / MM
        return (
            f"{demand.watch.item.name} would move at {limit * used_share:,.4g} mm/s in the zone "
            f"{zone.name}, {percent_text(used_share - 1)} above the {limit:,.4g} mm/s that it allows"
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
    message, code = "the controller's shortest segments are too long for this speed", "Y0605"
    if broken is not None and broken.demand is not None:
        message = (
            f"at this speed {_excess(robot, step, broken.demand, broken.share)} at {broken.s * 100:.3g} % "
            "of the path"
        )
        code = "Y0912" if broken.demand.watch is not None else code
    if near is not None and code != "Y0912":  # a singularity doesn't affect the speed limit of a zone
        message += f"; {_beside(robot, near)}"
    if not fitted.share:
        return (
            code,
            message,
            span,
            "no speed works: the path passes too near a singularity, so choose another path",
            None,
        )
    text, fix = slower(fitted.share, origin)
    return code, message, span, f"the highest speed that works is about {text}", fix


def near_singularity(robot: Robot, near: Nearest, curve: Curve, step: Motion) -> Message:
    """Return the finding that a singularity makes a motion slow."""
    message = f"the path comes near a singularity: {_beside(robot, near)}"
    if step.timing.duration is None and step.timing.speed is None:
        message += f"; the shortest time is {curve.duration:.4g} s"
    help_ = "a path farther from it takes less time: choose another pose, add a via pose, or use MOVEJ"
    return "Y0702", message, step.origin.span, help_, None


def _beside(robot: Robot, near: Nearest) -> str:
    """Return a clause about the place where a path is nearest to a singularity: where it is on the path, and
    how fast a joint moves there.
    """
    joint, unit = robot.joint_names[near.joint], robot.axis_unit_names[near.joint]
    rate = near.rate / robot.axis_units[near.joint] * (DEG if near.turns else MM)
    return (
        f"at {near.s * 100:.3g} % of the path the smallest singular value is {near.smallest:.2g}, and "
        f"{joint} moves {rate:.3g} {unit} per {'deg' if near.turns else 'mm'}"
    )


def speed_without_unit(turns: bool, origin: Origin) -> MessageAbout:
    """Return the finding that a speed lacks the unit that the path requires."""
    kind: Kind = "angle" if turns else "length"
    what = "an angle unit: the moving frame only turns" if turns else "a length unit: the moving frame moves"
    subject = MissingUnit(kind, "the speed")
    message = f"the speed needs {what} here"
    return "Y0304", message, origin.time_span or origin.span, "for example (mm,deg,s)", None, subject


def no_cruise(step: Motion) -> Message:
    """Return the finding that a speed is requested of a motion profile without a cruise."""
    origin = step.origin
    message = f"[V ..] gives a cruise speed, but _{step.profile} has no cruise"
    help_ = f"use {profiles_with(lambda profile: profile.has_cruise)}"
    return "Y0407", message, origin.time_span or origin.span, help_, None


def too_long(robot: Robot, fitted: TooLong, origin: Origin, near: Nearest | None = None) -> Message:
    """Return the finding that a motion would need more than `MOST_SEGMENTS` segments."""
    message = (
        f"the motion takes {fitted.duration:,.0f} s or longer, which needs more than the {MOST_SEGMENTS:,} "
        "segments that can be planned"
    )
    if near is not None:
        message += f"; {_beside(robot, near)}"
    help_ = (
        "divide the motion; if [MIN] takes so long, the path passes too near a singularity, or the speed "
        "of a slow zone has a wrong unit"
    )
    return "Y0604", message, origin.time_span or origin.span, help_, None


def too_long_a_table(fitted: TooLong, origin: Origin) -> Message:
    """Return the finding that a timetable would need more than `MOST_SEGMENTS` segments."""
    message = (
        f"the timetable takes {fitted.duration:,.0f} s, for which its tolerance needs more than the "
        f"{MOST_SEGMENTS:,} segments that can be planned"
    )
    help_ = (
        "divide it at a row at which the robot is at rest, or allow a larger TOL, which needs fewer segments"
    )
    return "Y0604", message, origin.span, help_, None


def no_law(robot: Robot, fitted: NoLaw, step: Motion, near: Nearest | None = None) -> Message:
    """Return the finding that no motion profile was found, with the place of the path at which the search
    failed.
    """
    message = (
        f"no _{step.profile} profile was found for this path: the search failed at {fitted.s * 100:.3g} % "
        "of the path"
    )
    if near is not None:
        message += f"; {_beside(robot, near)}"
    help_ = (
        f"use {profiles_with(lambda profile: not profile.needs_search)}, which need no search, or a path "
        "farther from singularities: another pose, or a via pose"
    )
    return "Y0614", message, step.origin.span, help_, None


def not_held(fitted: NotHeld, smallest: float, origin: Origin) -> Message:
    """Return the finding that the controller's segments can't follow a path within the tolerance."""
    message = (
        f"with segments of {fitted.segment / MS:.4g} ms the motion deviates from the path by "
        f"{length_text(fitted.position)} and {fitted.angle / DEG:.2g} deg; the controller's shortest "
        f"segment is {smallest / MS:.4g} ms"
    )
    return (
        "Y0602",
        message,
        origin.span,
        "give the motion more time, or a larger tolerance (--tolerance)",
        None,
    )


def _not_below(value: float) -> float:
    """Return a value rounded up to seven significant digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 6)
    return math.ceil(value / step - 1e-6) * step
