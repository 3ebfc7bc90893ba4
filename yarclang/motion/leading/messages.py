"""Make findings about the goals of motions and their arm configurations; see `yarclang.motion.messages`."""

from __future__ import annotations

import numpy as np

from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.hir import (
    ArcMove,
    Array,
    Gap,
    LineMove,
    Loop,
    Motion,
    NextPass,
    Origin,
    PoseSplineMove,
    Step,
    TimedMove,
)
from yarclang.motion.cartesian import FramePath
from yarclang.motion.paths.arc import NoArc
from yarclang.motion.wording import Message, amount_text, beyond_text, length_text, miss_text, range_text
from yarclang.robot.kinematics.nearest import Unreachable
from yarclang.robot.kinematics.track import Broken
from yarclang.robot.model import Robot
from yarclang.source import Span
from yarclang.units import DEG, MM
from yarclang.ways import Turn

CartesianMove = LineMove | ArcMove | PoseSplineMove

MUCH_SWING = 1.0
"""Distance [deg or mm]. If a joint spline exceeds the range of its waypoints by at least this distance, it is
reported in a note.
"""

MUCH_OF_BOX = 0.1
"""Share of the diagonal of the box around the waypoints. If a curve of the moving frame leaves the box by
more than this, it is reported in a note.
"""

_BY_JOINTS = "use MOVEJ, which may take another configuration, or add a via pose beside this place"


def unreachable(robot: Robot, solved: Unreachable, origin: Origin, which: str = "") -> Message:
    """Return the finding that no joint position brings the moving frame to a pose."""
    if solved.kind == "reach":
        by = f" by {miss_text(solved.miss, solved.miss_angle)}" if solved.is_measured else ""
        message = f"{which}the pose is out of reach{by}"
        return (
            "Y0501",
            message,
            origin.span,
            "check the pose, its units and its frames, or move the robot nearer",
            None,
        )
    joint = solved.joint or 0
    message = (
        f"{which}the pose needs {beyond_text(robot, joint, solved.excess)}, even in the best configuration"
    )
    return "Y0502", message, origin.span, range_text(robot, joint), None


def increments_out_of_limits(robot: Robot, end: Array, origin: Origin) -> Message:
    """Return the finding that a DMOVEJ ends at a joint position beyond the limits."""
    limits = robot.limits
    excess = np.maximum(end - limits.upper, limits.lower - end) / robot.axis_units
    joint = int(np.argmax(excess))
    over = end[joint] - limits.upper[joint]
    amount = float(over if over > 0 else end[joint] - limits.lower[joint])
    message = f"the increments move {beyond_text(robot, joint, amount)}"
    return "Y0502", message, origin.span, range_text(robot, joint), None


def half_turn(origin: Origin, where: str = "") -> Message:
    """Return the finding that a frame would turn by 180 deg, so that the direction of rotation is ambiguous.
    `where` names the waypoint.
    """
    message = f"{where}the orientation turns by 180 deg, so the direction of rotation is ambiguous"
    return "Y0409", message, origin.span, "add a via pose that determines the direction", None


def no_arc(arc: NoArc, origin: Origin) -> Message:
    """Return the finding that the three points of an arc determine no circle."""
    if arc.kind == "half turn":
        return half_turn(origin)
    if arc.kind == "coincident":
        message = f"{arc.points} are only {length_text(arc.apart)} apart and determine no circle"
        help_ = "write a full circle as two MOVEC arcs, and a rotation in place as MOVEL"
    else:
        message = (
            f"start, via and end lie on a line (they bend by {arc.bend / DEG:.2g} deg) and determine no "
            "circle"
        )
        help_ = "use MOVEL for a straight line, or move the via point off the line"
    return "Y0420", message, origin.span, help_, None


def broken_path(robot: Robot, broken: Broken, frame: FramePath, step: CartesianMove) -> Message:
    """Return the finding that the arm can't follow a path of the moving frame to its end."""
    origin = step.origin
    what = {LineMove: "straight line", ArcMove: "arc", PoseSplineMove: "curve"}[type(step)]
    point = np.round(frame.poses(np.array([broken.s]))[0, :3, 3] / MM, 1) + 0.0  # no negative zeros
    where = f"at {broken.s * 100:.3g} % of the path (x {point[0]:.1f}, y {point[1]:.1f}, z {point[2]:.1f} mm)"
    joint = broken.joint
    if broken.kind == "reach":
        by = f", by up to {miss_text(broken.amount, broken.angle)}"
        message = f"the {what} leaves the workspace {where}{by if broken.is_measured else ''}"
        return "Y0503", message, origin.span, "go through a via pose within reach, or use MOVEJ", None
    if broken.kind == "limits" and joint is not None:
        message = (
            f"the {what} moves {beyond_text(robot, joint, broken.amount)}, from "
            f"{where.removeprefix('at ')} on"
        )
        return "Y0504", message, origin.span, f"{range_text(robot, joint)}; {_BY_JOINTS}", None
    if broken.kind == "configuration":
        why = (
            f": with the present one, {beyond_text(robot, joint, broken.amount)}"
            if joint is not None and broken.amount
            else ""
        )
        message = f"the {what} needs another configuration {where}{why}"
        return "Y0801", message, origin.span, _BY_JOINTS, None
    name = robot.joint_names[joint] if joint is not None else "a joint"
    message = (
        f"the {what} passes through a singularity {where}: {name} would have to jump by "
        f"{amount_text(robot, joint or 0, abs(broken.amount))}"
    )
    return "Y0701", message, origin.span, _BY_JOINTS, None


def spline_out_of_limits(robot: Robot, joint: int, excess: float, s: float, origin: Origin) -> Message:
    """Return the finding that a joint would exceed its limits on a spline."""
    name, unit = robot.joint_names[joint], robot.axis_unit_names[joint]
    message = (
        f"the curve moves {name} out of its limits by {excess:.4g} {unit} at {s * 100:.3g} % of the path"
    )
    return (
        "Y0504",
        message,
        origin.span,
        f"{range_text(robot, joint)}; add a waypoint there to hold the curve back",
        None,
    )


def table_begins_elsewhere(robot: Robot, begins: Array, stands: Array, step: TimedMove) -> Message:
    """Return the finding that the first row of a timetable isn't the robot's position."""
    off = np.abs(begins - stands)
    joint = int(np.argmax(off / step.within))
    name, unit, factor = robot.joint_names[joint], robot.axis_unit_names[joint], robot.axis_units[joint]
    message = (
        f"the timetable begins with {name} at {begins[joint] / factor:.6g} {unit}, but the robot is at "
        f"{stands[joint] / factor:.6g} {unit}: they differ by {off[joint] / factor:.4g} {unit}, and "
        f"{step.within[joint] / factor:.4g} {unit} are allowed"
    )
    help_ = (
        "move to its first row with MOVEJ before, or remove the row at time 0: the motion then begins at "
        "the robot's position"
    )
    return "Y0615", message, step.origin.span, help_, None


def spline_swings_out(robot: Robot, joint: int, swing: float, s: float, origin: Origin) -> Message:
    """Return the finding that a joint spline swings far beyond the range of its waypoints."""
    name, unit = robot.joint_names[joint], robot.axis_unit_names[joint]
    message = (
        f"the curve swings {swing:.3g} {unit} beyond its waypoints in {name}, at {s * 100:.3g} % of the path"
    )
    return "Y0505", message, origin.span, "add a waypoint there to hold the curve back", None


def curve_swings_out(axis: str, swing: float, s: float, origin: Origin) -> Message:
    """Return the finding that a spline of the moving frame swings far out of the box around its
    waypoints.
    """
    message = (
        f"the curve swings {length_text(swing)} beyond its waypoints in {axis} of {{B}}, at {s * 100:.3g} "
        "% of the path"
    )
    return "Y0505", message, origin.span, "add a waypoint there to hold the curve back", None


def ways_part(robot: Robot, one: Array, other: Array, where: Turn) -> Message:
    """Return the finding that branches of the program end at different joint positions, although the program
    continues from one.

    For a loop, the differing positions are those at its EXITs, or at the end and at the beginning of a pass.
    """
    off = np.abs(one - other) / robot.axis_units
    joint = int(np.argmax(off))
    apart = f"{robot.joint_names[joint]} by {off[joint]:.4g} {robot.axis_unit_names[joint]}"
    help_ = "end all of them at the same joint positions, with MOVEJ to a JOINTS name"
    match where:
        case NextPass():
            message = f"a pass of this loop doesn't end where it began: the joint positions differ in {apart}"
            help_ = "move back to the loop's first position, with MOVEJ to a JOINTS name"
        case Loop():
            message = (
                f"the exits of this {'loop' if where.origin.name != 'CALL' else 'CALL'} end at different "
                f"joint positions, which differ in {apart}"
            )
        case _:
            word = "CASE" if where.origin.name == "OF" else where.origin.name
            message = f"the branches of this {word} end at different joint positions, which differ in {apart}"
    return "Y1002", message, where.origin.span, help_, None


def grips_on_the_way(origin: Origin, closes: bool) -> Message:
    """Return the finding that a gripper would close or open while the robot moves."""
    does = "closes" if closes else "opens"
    return (
        "Y0944",
        f"the gripper {does} while the robot moves, between two motions that flow into each other",
        origin.span,
        "remove BLEND from the motion before: parts are taken and put down at rest",
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
    """Return the finding that the arm takes another configuration than the nearest one, because a later
    motion can't be executed from the nearest one.
    """
    origin = step.origin
    why = next((reason for reason in reasons if reason.is_error), None)
    blamed = ""
    if why is not None:
        named = "" if isinstance(later, Gap) else later.origin.label
        label = named or (f"line {why.span.line}" if why.span is not None else "")
        blamed = (
            f": from the nearest one, in {label}, {why.message}"
            if label
            else f": from the nearest one, {why.message}"
        )
    message = f"the target isn't reached in the nearest configuration{differs(robot, taken, nearest)}{blamed}"
    help_ = "NEAR with a joint position in this configuration states that it is intended"
    return "Y0802", message, origin.span, help_, near_fix(robot, origin, taken)


def differs(robot: Robot, taken: Array, nearest: Array | None) -> str:
    """Return, in brackets, the names and positions of joints in which a solution differs from the nearest
    one.
    """
    if nearest is None:
        return ""
    # Avoid negative zeros.
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
    """Return a fix that declares the joint position and adds NEAR with its name to the command; None if the
    command's line is executed in several places of the program.
    """
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
