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
    """Return the finding that a joint motion makes a detour around obstacles, with its way-points."""
    count = len(way.waypoints) - 1
    in_way = inside(way.between) if way.between is not None else "something is in the straight way"
    message = (
        f"the straight way isn't free: {in_way}; a way round was found, through {count} "
        f"way-point{'s' * (count != 1)}"
    )
    help_ = "MOVEJ_SPLINE with these way-points goes the same way, whatever the cell becomes"
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
        f"the straight line isn't free: {why}; a way round was found, with {count} "
        f"corner{'s' * (count != 1)} at {places}{more} (mm) {{B}}"
    )
    return (
        "Y0920",
        message,
        step.origin.span,
        "MOVEL to these places goes the same way, whatever the cell becomes",
        None,
    )


def no_way(robot: Robot, why: NoWay, origin: Origin) -> Message:
    """Return the finding that no path around obstacles exists, or that none was found.

    It names the obstruction at the start, at the goal, or in between.
    """
    if why.start is not None:
        message = f"there is no way from where the robot stands: {inside(why.start)}"
        if why.goal is not None:
            message += f"; nor to the target: {inside(why.goal)}"
        help_ = "end the motion before this one where the robot is free; or correct the cell.toml"
        return "Y0921", message, origin.span, help_, None
    if why.goal is not None:
        message = f"there is no way to the target: {inside(why.goal)}"
        return "Y0922", message, origin.span, "move the target away from it; or correct the cell.toml", None
    if why.parting is not None:
        message = f"there is no way to the joint positions of the target: {parted(robot, why.parting)}"
        return (
            "Y0923",
            message,
            origin.span,
            "take a target on this side, or change the zone in the cell.toml",
            None,
        )
    message = f"no way round was found {tried(robot, why)}"
    help_ = "go there in two motions, by a via pose in the open; or by another configuration (NEAR)"
    if why.is_cut:
        help_ += (
            "; among so many bodies the search has ended early, and --avoid-effort 4 goes on four times as "
            "long"
        )
    return "Y0923", message, origin.span, help_, None


def tried(robot: Robot, why: NoWay) -> str:
    """Return a clause with the number of samples tried, a reminder that they prove nothing, and the place at
    which the search came nearest to the goal.
    """
    said = f"in {why.tries:,} tries, which doesn't prove that there is none: "
    if why.has_corners:
        said += "there is a way with corners, but no smooth one along it was proved to be free"
        return said + (f"; on the straight way {inside(why.between)}" if why.between is not None else "")
    if why.furthest is None:
        between = f"; on the straight way {inside(why.between)}" if why.between is not None else ""
        return f"{said}start and target are free{between}"
    far = why.furthest
    units = ",".join(dict.fromkeys(robot.axis_unit_names))
    place = f"{_written(robot, far.q, 1)} ({units}), {far.left / MM:.0f} mm from the target"
    return f"{said}it came as far as {place}; from there on {in_way(far.blocked)}"


def parted(robot: Robot, parting: Parting | Barrier) -> str:
    """Return a clause that names the zone that separates start and target, and the joint or the item that
    can't get past this zone.
    """
    if isinstance(parting, Barrier):
        return (
            f"zone {parting.name}, which the arm can't reach past, lies between where {parting.item} is and "
            "where it shall be"
        )
    joint, unit = parting.joint, robot.axis_units[parting.joint]
    return (
        f"zone {parting.name} forbids {robot.joint_names[joint]} from {parting.lower / unit:.6g} to "
        f"{parting.upper / unit:.6g} {robot.axis_unit_names[joint]}, and start and target are on either "
        "side of it"
    )


def configuration_blocked(
    robot: Robot, step: Motion, taken: Array, nearest: tuple[Array, Obstruction], which: str
) -> Message:
    """Return the finding that another inverse-kinematics solution was taken, because the nearest one
    collides.
    """
    origin = step.origin
    message = (
        f"{which}this target isn't taken in the nearest configuration{differs(robot, taken, nearest[0])}: "
        f"with that, {inside(nearest[1])}"
    )
    help_ = "NEAR with a joint position in this configuration says that it is meant"
    return "Y0924", message, origin.span, help_, None if which else near_fix(robot, origin, taken)


def configuration_without_way(
    robot: Robot, step: Motion, taken: Array, nearest: Array, why: NoWay
) -> Message:
    """Return the finding that another inverse-kinematics solution was taken, because no path to the nearest
    one was found.
    """
    origin = step.origin
    message = (
        f"this target isn't taken in the nearest configuration{differs(robot, taken, nearest)}: no way to "
        f"that was found{f', {inside(why.between)} on the straight one' if why.between is not None else ''}"
    )
    help_ = "NEAR with a joint position in this configuration says that it is meant"
    return "Y0924", message, origin.span, help_, near_fix(robot, origin, taken)


def every_configuration_blocked(
    robot: Robot, step: Motion, blocked: Sequence[tuple[Array, Obstruction]], which: str
) -> Message:
    """Return the finding that all inverse-kinematics solutions of a target pose collide."""
    first = {one.names: one for _, one in reversed(blocked)}
    reasons = [inside(first[names]) for names in dict.fromkeys(one.names for _, one in blocked)]
    count = len(blocked)
    more = f", and {len(reasons) - _SHOWN} more reasons" if len(reasons) > _SHOWN else ""
    all_ = "the only configuration" if count == 1 else f"each of the {count} configurations"
    message = (
        f"{which}{all_} that {robot.name} has for this target is blocked: {'; '.join(reasons[:_SHOWN])}{more}"
    )
    help_ = "move the target away from it, turn the tool, or correct the cell.toml"
    return "Y0925", message, step.origin.span, help_, None


_BLOCKED = "Y0925"


def with_changes(
    told: Message, goal: PoseGoal, changes: tuple[Change, ...], origin: Origin, *, is_alone: bool
) -> Message:
    """Add helpful changes of the target to a message about a pose that can't be taken; the first change is
    given with its numbers.

    Args:
        told: the message.
        goal: the target pose.
        changes: the changes that help; empty if none of those tried helps.
        origin: the command that gives the pose.
        is_alone: True if the command has no other way-point: then the first change may be offered as a fix.
    """
    code, message, span, help_, _ = told
    if changes:
        how = "free" if code == _BLOCKED else "in reach"
        fix = change_fix(goal, changes[0], origin) if is_alone else None
        return code, message, span, f"{changes_text(changes, origin, how)}; {help_}", fix
    if code != _BLOCKED:
        return told
    tried = f"neither z reversed, nor a turn about z, nor a move of up to {FARTHEST:g} mm frees it"
    return code, message, span, f"{tried}: move the target farther away, or correct the cell.toml", None


def inside(one: Obstruction) -> str:
    """Return words for an obstruction, as the end of a sentence."""
    moving, other = one.names
    if one.is_tilt:
        return f"{moving} tilts {max(one.distance / DEG, 0.001):.3g} deg more than {other} allows"
    if one.aim is not None:
        angle, distance = one.aim
        return f"{moving} breaks {other}, {angle / DEG:.4g} deg off the axis and {distance / MM:,.4g} mm away"
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
    """Return words for an obstruction, or for the item nearest to being one, as the end of a sentence."""
    moving, other = one.names
    if one.is_zone and one.distance <= 0.0:
        return f"zone {other} leaves {moving} too little room"
    if one.is_zone or one.distance <= 0.0:
        return inside(one)
    return f"{moving} is {one.distance / MM:.3g} mm from {other}"


def _as_spline(robot: Robot, way: Way, step: AvoidMove) -> Fix | None:
    """Return a fix that declares the way-points of a detour and writes MOVEJ_SPLINE through them; None if the
    command's line is executed in several places of the program.
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
    return Fix("write the way found as MOVEJ_SPLINE", edits, by_choice=True)


def _written(robot: Robot, q: Array, fine: int = 4) -> str:
    """Return a joint position as text, with at most `fine` decimals per number; way-points are given with
    two.
    """
    return " ".join(
        f"{value:.{fine}f}".rstrip("0").rstrip(".") for value in np.round(q / robot.axis_units, fine) + 0.0
    )
