"""Make findings about detours around obstacles and blocked arm configurations; see
`yarclang.motion.messages`.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from yarclang.diagnostics import Edit, Fix
from yarclang.hir import Array, AvoidMove, Motion, Origin, PoseGoal
from yarclang.motion.avoid.changes import FARTHEST, Change, change_fix, changes_text
from yarclang.motion.avoid.lines import Course
from yarclang.motion.avoid.parting import Barrier, Parting
from yarclang.motion.avoid.room import JOINTS, Obstruction
from yarclang.motion.avoid.way import NoWay, Way
from yarclang.motion.leading.messages import differs, near_fix
from yarclang.motion.wording import Message
from yarclang.robot.model import Robot
from yarclang.source import Span
from yarclang.units import DEG, MM

_SHOWN = 4
"""The largest number of blocked configurations that are listed."""


def way_round(robot: Robot, way: Way, step: AvoidMove) -> Message:
    """Return the finding that a joint motion makes a detour around obstacles, with its waypoints."""
    count = len(way.waypoints) - 1
    in_way = inside(way.between) if way.between is not None else "the straight path is blocked"
    message = (
        f"the straight path isn't free: {in_way}; a detour was found, through {count} "
        f"waypoint{'s' * (count != 1)}"
    )
    help_ = "MOVEJ_SPLINE through these waypoints keeps this path, also if the cell changes"
    return "Y0920", message, step.origin.span, help_, _as_spline(robot, way, step)


def way_of_lines(course: Course, step: Motion) -> Message:
    """Return the finding that a straight line is replaced by a polyline around obstacles, with the positions
    of its corners.
    """
    why = inside(course.between) if course.between is not None else "the arm can't follow it"
    corners = course.poses[:-1, :3, 3] / MM
    count = len(corners)
    places = ", ".join(" ".join(f"{value + 0.0:.1f}" for value in one) for one in corners[:_SHOWN])
    more = f", and {count - _SHOWN} more" if count > _SHOWN else ""
    message = (
        f"the straight line isn't free: {why}; a detour was found, with {count} corner{'s' * (count != 1)} "
        f"at {places}{more} (mm) {{B}}"
    )
    return (
        "Y0920",
        message,
        step.origin.span,
        "MOVEL to these corners keeps this path, also if the cell changes",
        None,
    )


def no_way(robot: Robot, why: NoWay, origin: Origin) -> Message:
    """Return the finding that no path around obstacles exists, or that none was found.

    It names the obstruction at the start, at the goal, or on the way between the two.
    """
    if why.start is not None:
        message = f"no path can begin at the robot's position: {inside(why.start)}"
        if why.goal is not None:
            message += f"; none can end at the target: {inside(why.goal)}"
        help_ = "end the motion before this one at a free position, or correct the cell.toml"
        return "Y0921", message, origin.span, help_, None
    if why.goal is not None:
        message = f"no path can end at the target: {inside(why.goal)}"
        return "Y0922", message, origin.span, "move the target away from it, or correct the cell.toml", None
    if why.parting is not None:
        message = f"no path exists to the joint positions of the target: {parted(robot, why.parting)}"
        return (
            "Y0923",
            message,
            origin.span,
            "choose a target on the start's side of the zone, or change the zone in the cell.toml",
            None,
        )
    message = f"no free path was found {tried(robot, why)}"
    help_ = (
        "move in two steps, through a via pose away from the obstacles, or to another configuration (NEAR)"
    )
    if why.is_cut:
        help_ += (
            "; with so many bodies the search was cut short: --avoid-effort 4 searches four times as long"
        )
    return "Y0923", message, origin.span, help_, None


def tried(robot: Robot, why: NoWay) -> str:
    """Return a clause about a failed search: the number of its tries, the place at which it came nearest to
    the goal, and a reminder that a path may still exist.
    """
    said = f"in {why.tries:,} tries (one may still exist): "
    if why.has_corners:
        said += "a path with corners is free, but no smooth path along it was proved to be free"
        return said + (f"; on the straight path {inside(why.between)}" if why.between is not None else "")
    if why.furthest is None:
        between = f"; on the straight path {inside(why.between)}" if why.between is not None else ""
        return f"{said}start and target are free{between}"
    far = why.furthest
    units = ",".join(dict.fromkeys(robot.axis_unit_names))
    place = f"{_written(robot, far.q, 1)} ({units}), {far.left / MM:.0f} mm from the target"
    return f"{said}the search came as far as {place}; beyond, {in_way(far.blocked)}"


def parted(robot: Robot, parting: Parting | Barrier) -> str:
    """Return a clause that names the zone that separates start and target, and the joint or the watched item
    that can't get past this zone.
    """
    if isinstance(parting, Barrier):
        return (
            f"zone {parting.name} separates the positions of {parting.item} at start and target, and the "
            "arm can't reach past the zone"
        )
    joint, unit = parting.joint, robot.axis_units[parting.joint]
    return (
        f"zone {parting.name} forbids {robot.joint_names[joint]} from {parting.lower / unit:.6g} to "
        f"{parting.upper / unit:.6g} {robot.axis_unit_names[joint]}, and start and target are on opposite "
        "sides of this range"
    )


def configuration_blocked(
    robot: Robot, step: Motion, taken: Array, nearest: tuple[Array, Obstruction], which: str
) -> Message:
    """Return the finding that the arm takes another configuration than the nearest one, because it would
    collide in the nearest one.
    """
    origin = step.origin
    message = (
        f"{which}the target isn't reached in the nearest configuration{differs(robot, taken, nearest[0])}: "
        f"in the nearest one, {inside(nearest[1])}"
    )
    help_ = "NEAR with a joint position in this configuration states that it is intended"
    return "Y0924", message, origin.span, help_, None if which else near_fix(robot, origin, taken)


def configuration_without_way(
    robot: Robot, step: Motion, taken: Array, nearest: Array, why: NoWay
) -> Message:
    """Return the finding that the arm takes another configuration than the nearest one, because no path to
    the nearest one was found.
    """
    origin = step.origin
    message = (
        f"the target isn't reached in the nearest configuration{differs(robot, taken, nearest)}: no free "
        "path to the nearest one was "
        f"found{f', {inside(why.between)} on the straight path' if why.between is not None else ''}"
    )
    help_ = "NEAR with a joint position in this configuration states that it is intended"
    return "Y0924", message, origin.span, help_, near_fix(robot, origin, taken)


def every_configuration_blocked(
    robot: Robot, step: Motion, blocked: Sequence[tuple[Array, Obstruction]], which: str
) -> Message:
    """Return the finding that the arm would collide in every configuration by which it reaches a target
    pose.
    """
    first = {one.names: one for _, one in reversed(blocked)}
    reasons = [inside(first[names]) for names in dict.fromkeys(one.names for _, one in blocked)]
    count = len(blocked)
    more = f", and {len(reasons) - _SHOWN} more reasons" if len(reasons) > _SHOWN else ""
    all_ = "the only configuration" if count == 1 else f"each of the {count} configurations"
    message = (
        f"{which}{all_} that {robot.name} has for this target is blocked: {'; '.join(reasons[:_SHOWN])}{more}"
    )
    return "Y0925", message, step.origin.span, _remedy([one for _, one in blocked]), None


def _remedy(blocked: Sequence[Obstruction]) -> str:
    """Return a remedy for a target that is blocked by bodies, zones or rules of KEEP."""
    if any(_is_rule(one) for one in blocked):
        return "change the target, or allow more in the KEEP"
    if any(one.is_zone for one in blocked):
        return "move the target to the allowed side of the zone, or correct the zone in the cell.toml"
    return "move the target away from it, turn the tool, or correct the cell.toml"


def _is_rule(one: Obstruction) -> bool:
    return one.is_tilt or one.aim is not None or (one.is_zone and one.names[1].startswith("KEEP "))


_BLOCKED = "Y0925"


def with_changes(
    told: Message, goal: PoseGoal, changes: tuple[Change, ...], origin: Origin, *, is_alone: bool
) -> Message:
    """Extend the finding that a target pose can't be reached, or only with a collision: add changes of the
    pose that would help. The first change is given with its numbers.

    Args:
        told: the finding.
        goal: the target pose.
        changes: the changes that help; empty if none of those tried helps.
        origin: the command that gives the pose.
        is_alone: True if the pose is the command's only waypoint. Only then, the first change is
            offered as a fix.
    """
    code, message, span, help_, _ = told
    if changes:
        how = "free" if code == _BLOCKED else "in reach"
        fix = change_fix(goal, changes[0], origin) if is_alone else None
        return code, message, span, f"{changes_text(changes, origin, how)}; {help_}", fix
    if code != _BLOCKED:
        return told
    tried = f"the pose stays blocked with z reversed, turned about z, and moved by up to {FARTHEST:g} mm"
    return code, message, span, f"{tried}: {help_}", None


def inside(one: Obstruction) -> str:
    """Return a description of an obstruction, for the end of a sentence."""
    moving, other = one.names
    if one.is_tilt:
        return f"{moving} tilts {max(one.distance / DEG, 0.001):.3g} deg more than {other} allows"
    if one.aim is not None:
        angle, distance = one.aim
        return f"{moving} breaks {other}, {angle / DEG:.4g} deg off the axis and {distance / MM:,.4g} mm away"
    if _is_rule(one):
        return f"{moving} is {max(one.distance / MM, 0.01):.3g} mm lower than {other} allows"
    if one.is_zone:
        return (
            f"{JOINTS} break the zone {other}"
            if moving == JOINTS
            else f"{moving} breaks the zone {other} by {max(one.distance / MM, 0.01):.3g} mm"
        )
    if one.distance <= 0.0:
        return f"{moving} is {max(-one.distance / MM, 0.01):.3g} mm deep in {other}"
    return f"{moving} is {one.distance / MM:.3g} mm from {other}, nearer than its margin"


def in_way(one: Obstruction) -> str:
    """Return a description of an obstruction, for the end of a sentence. If nothing is violated, `one` is the
    pair of bodies or the zone that is nearest to a violation.
    """
    moving, other = one.names
    if one.is_zone and one.distance <= 0.0:
        return f"zone {other} leaves {moving} too little room"
    if one.is_zone or one.distance <= 0.0:
        return inside(one)
    return f"{moving} is {one.distance / MM:.3g} mm from {other}"


def _as_spline(robot: Robot, way: Way, step: AvoidMove) -> Fix | None:
    """Return a fix that writes a detour into the program: it declares the waypoints and replaces the command
    by a MOVEJ_SPLINE through them. None if the command's line is executed in several places of the program.
    """
    origin = step.origin
    if not origin.index or ">" in origin.place or "(" in origin.place:
        return None
    if origin.name_span is None or origin.values_span is None:
        return None
    names = [f"{origin.index}_VIA{number}" for number in range(1, len(way.waypoints))]
    if re.search(rf"\b{names[0]}\b", origin.source.text, re.IGNORECASE):
        return None
    units = sorted(
        {"mm" if unit == "mm" else "deg" for unit in robot.axis_unit_names}, key=("mm", "deg").index
    )
    lines = [
        f"JOINTS {name} {_written(robot, q)} ({','.join(units)})\n"
        for name, q in zip(names, way.waypoints[:-1], strict=True)
    ]
    line = Span.on_line(origin.span.line, 1, 1)
    edits = (
        Edit(line, "".join(lines)),
        Edit(origin.name_span, origin.name.replace("_AVOID", "").replace("MOVEJ", "MOVEJ_SPLINE", 1)),
        Edit(origin.values_span, "".join(f"{name}; " for name in names)),
    )
    return Fix("write the path found as MOVEJ_SPLINE", edits, by_choice=True)


def _written(robot: Robot, q: Array, fine: int = 4) -> str:
    """Return a joint position as text, with at most `fine` decimals per number."""
    return " ".join(
        f"{value:.{fine}f}".rstrip("0").rstrip(".") for value in np.round(q / robot.axis_units, fine) + 0.0
    )
