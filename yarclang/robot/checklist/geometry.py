"""Check the arm's geometry, and report its consequences for programs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from yarclang.robot.checklist.item import Item
from yarclang.robot.kinematics.fk import flange_poses, lines_of, tool_poses
from yarclang.robot.kinematics.geometry import nominal_form, parallel_arm, wristed_arm
from yarclang.robot.kinematics.inverse import has_all
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.kinematics.search import reaching, within
from yarclang.robot.kinematics.singularity import nearness, smallest_singular_values
from yarclang.robot.kinematics.track import Broken, PathPoses, followed, track
from yarclang.robot.model import Array, Robot
from yarclang.source import SourceFile
from yarclang.units import MM

POSES = 500
"""Number of joint positions, spread over the limits, at which kinematics are checked."""

EXACT = 1e-9
"""Largest deviation of forward kinematics from Pinocchio [m, rad]."""

SOLVED = 0.99
"""Least fraction of the poses that the inverse kinematics must solve."""

DIRECTIONS = np.vstack([np.eye(3), -np.eye(3)])
"""Directions of the straight test lines: along and against each axis of {B}. The flange keeps its orientation
on these lines.
"""

PLACES = 2
"""Number of start positions from which the arm should be able to follow all test lines."""

TRIED = 8
"""The largest number of start positions that are tried, the best ones first."""

MIDDLE = 0.25
"""Fraction of the sampled joint positions at which test lines may begin: those at which the distance of the
flange from {B} is nearest to the median of all samples.
"""

LINE = 0.1
"""Length of a test line, relative to the arm's length."""

ROOM = 0.7
"""Distance of a joint from its limits [rad or m] that is enough for the start of a test line. More distance
doesn't make a start better.
"""

STRAIGHT = 0.01
"""A joint position whose smallest singular value is below this counts as near a singularity."""

USUAL_SIZE = (0.05, 10.0)
"""Smallest and largest usual length of an arm [m]."""

LONG_TOOL = 2.0
"""Distance of a frame from the flange [m] above which a wrong unit is suspected."""

SHORT_TOOL = 5e-3
"""A distance shorter than this [m] doesn't determine the tool's direction."""

ALONG = 0.9
"""Smallest cosine of the angle between z of TCP and the tool's direction at which z of TCP counts as pointing
along the tool.
"""


def geometry_items(robot: Robot) -> Iterator[Item]:
    """Yield the items about units, forward and inverse kinematics, HOME, reach and frames."""
    size = arm_length(robot.chain, np.eye(4))
    if USUAL_SIZE[0] <= size <= USUAL_SIZE[1]:
        yield Item("units", "ok", f"the flange gets up to {size:.3g} m from the first axis")
    else:
        found = (
            f"the flange gets up to {size:.3g} m from the first axis; arms reach {USUAL_SIZE[0]:g} to "
            f"{USUAL_SIZE[1]:g} m"
        )
        yield Item("units", "to do", found, "a URDF is in m and rad: check its <origin>s")
    q = within(robot.chain, robot.limits, POSES)
    yield _method(robot)
    yield _forward(robot, q)
    yield _back(robot, q)
    if robot.size >= 6:
        yield _lines(robot, q)
    yield _home(robot)
    yield _reach(robot, q)
    yield from _frames(robot)


def _method(robot: Robot) -> Item:
    if wristed_arm(robot.chain) is not None:
        return Item("inverse kinematics", "ok", "closed form: spherical wrist, parallel shoulder and elbow")
    if parallel_arm(robot.chain) is not None:
        return Item("inverse kinematics", "ok", "closed form: three parallel axes")
    if nominal_form(robot.chain) is not None:
        solver = "all solutions, from the closed form of the arm before it was calibrated"
        return Item("inverse kinematics", "ok", solver)
    if has_all(robot.chain):
        return Item("inverse kinematics", "ok", "all solutions, by elimination")
    if robot.size < 6:
        solver = (
            f"numeric. With {robot.size} joints the arm reaches only some poses: MOVEL and MOVEJ_RPY "
            "accept a pose that it can reach, and refuse any other"
        )
        return Item(
            "inverse kinematics",
            "note",
            solver,
            "move by joint values (MOVEJ, MOVEJ_SPLINE) if a pose is refused",
        )
    if robot.size > 6:
        more = f"{robot.size - 6} joint{'s' * (robot.size > 7)}"
        solver = f"numeric. The arm has {more} more than a pose needs, and the nearest solution is taken"
        return Item("inverse kinematics", "note", solver, "choose the elbow's position with NEAR")
    return Item("inverse kinematics", "ok", "numeric: the arm has no closed form here")


def _forward(robot: Robot, q: Array) -> Item:
    """Compare this package's flange poses with Pinocchio's poses for the whole URDF."""
    ours, theirs = flange_poses(robot.chain, q), pinocchio_poses(robot, q)
    miss = float(np.abs(ours - theirs).max())
    if miss <= EXACT:
        found = f"{len(q)} poses agree with Pinocchio, better than {EXACT:g} m and rad"
        return Item("forward kinematics", "ok", found)
    found = f"a pose is {miss:.3g} m or rad off Pinocchio's"
    return Item("forward kinematics", "to do", found, "this is a fault of yarclang: report it with the URDF")


def pinocchio_poses(robot: Robot, q: Array) -> Array:
    """Return the flange poses base_from_flange (N, 4, 4) that Pinocchio computes one by one, with all joints
    outside of the arm at 0.
    """
    import pinocchio as pin

    from yarclang.robot.library import DESCRIPTION
    from yarclang.toml.reading import parse_toml, read_text

    data = parse_toml(_text(read_text(robot.folder / DESCRIPTION, "")))
    ends = (data["base"], data["flange"]) if isinstance(data, dict) else ("", "")
    model = pin.buildModelFromXML(_text(read_text(robot.folder / robot.urdf, "")).text)
    state = model.createData()
    base, flange = (model.getFrameId(end, pin.FrameType.BODY) for end in ends)
    poses = np.empty((len(q), 4, 4))
    joints = [model.joints[model.getJointId(name)] for name in robot.joint_names]
    for row, values in enumerate(q):
        full = pin.neutral(model)
        for joint, value in zip(joints, values, strict=True):
            # Pinocchio stores a continuous joint as a cosine and a sine
            full[joint.idx_q : joint.idx_q + joint.nq] = (
                value if joint.nq == 1 else (np.cos(value), np.sin(value))
            )
        pin.framesForwardKinematics(model, state, full)
        poses[row] = (state.oMf[base].inverse() * state.oMf[flange]).homogeneous
    return poses


def _text(source: object) -> SourceFile:
    assert isinstance(source, SourceFile)  # the URDF can be read: the robot has just been read from it
    return source


def _back(robot: Robot, q: Array) -> Item:
    solved = reaching(robot.chain, robot.limits, flange_poses(robot.chain, q))[1]
    share = float(solved.mean())
    result = f"{share * 100:.4g} % of {len(q)} reachable poses have a solution within the limits"
    if share >= SOLVED:
        return Item("inverse of forward", "ok", result)
    return Item(
        "inverse of forward",
        "to do",
        result,
        "look for joints that cancel each other, or for limits that leave no range",
    )


def _lines(robot: Robot, q: Array) -> Item:
    """Return the item that states if the arm can follow straight lines of fixed orientation. The lines begin
    at positions that a person would choose, and are followed as the planner follows them.
    """
    length = LINE * arm_length(robot.chain, np.eye(4))
    starts = _roomy(robot, q)[:TRIED]
    whole = 0
    best, most = starts[0], np.zeros(len(DIRECTIONS), dtype=bool)
    # most arms can follow all lines from the first `PLACES` starts; for other arms, all remaining starts are
    # tried together
    for group in (starts[:PLACES], starts[PLACES:]):
        if whole == PLACES or not len(group):
            break
        for start, lines in zip(group, _followed(robot, group, length), strict=True):
            whole += bool(lines.all()) and whole < PLACES
            if lines.sum() > most.sum():
                best, most = start, lines
    lines = f"lines of {length / MM:.0f} mm through the middle of the workspace"
    if whole:
        return Item("lines", "ok", f"all {whole * len(DIRECTIONS)} {lines} are followed")
    ends = [
        (way, track(robot.chain, robot.limits, _line(robot, best, way * length), best, reason="any"))
        for way in DIRECTIONS[~most]
    ]
    ended = [
        f"{'-' if way.min() < 0.0 else '+'}{'xyz'[int(np.argmax(np.abs(way)))]} {_end(robot, end, length)}"
        for way, end in ends
        if isinstance(end, Broken)
    ]
    if len(ended) == len(DIRECTIONS):
        result = f"no {lines} are followed, from the best of {TRIED} places; {'; '.join(ended)}"
        remedy = (
            "check with yarc reach if the robot is really so: a joint may be missing, or a limit too narrow"
        )
        return Item("lines", "to do", result, remedy)
    result = (
        f"{most.sum()} of {len(most)} {lines} are followed, from the best of {TRIED} places; "
        f"{'; '.join(ended)}"
    )
    return Item("lines", "note", result, "yarc reach shows where the arm can hold its orientation")


def _roomy(robot: Robot, q: Array) -> Array:
    """Return the sampled joint positions that may be starts of test lines, the best ones first.

    These are the positions whose flange has about the median distance from {B}. The best ones are farthest
    from singularities and joint limits.
    """
    points = flange_poses(robot.chain, q)[:, :3, 3]
    far = np.linalg.norm(points, axis=1)
    middle = np.argsort(np.abs(far - np.median(far)), kind="stable")[: max(1, round(MIDDLE * len(q)))]
    q = q[middle]
    values = smallest_singular_values(robot.chain, q, np.eye(4))
    bounded = np.isfinite(robot.limits.upper - robot.limits.lower)
    room = np.where(bounded, np.minimum(q - robot.limits.lower, robot.limits.upper - q), ROOM).min(axis=1)
    worth = np.minimum(values / max(float(values.max()), 1e-12), np.minimum(room, ROOM) / ROOM)
    chosen: Array = q[np.argsort(-worth, kind="stable")]
    return chosen


def _followed(robot: Robot, starts: Array, length: float) -> NDArray[np.bool_]:
    """Return which straight lines the arm can follow: a mask (K, 6) with one row for each start, and one
    column for each direction of `DIRECTIONS`.

    Args:
        robot: the robot, n joints.
        starts: (K, n) joint positions [rad or m], where the lines begin.
        length: length of the lines [m].
    """
    paths = [_line(robot, start, way * length) for start in starts for way in DIRECTIONS]
    each = np.repeat(starts, len(DIRECTIONS), axis=0)
    return followed(robot.chain, robot.limits, paths, each).reshape(-1, len(DIRECTIONS))


def _line(robot: Robot, q: Array, way: Array) -> PathPoses:
    """Return the path of a straight line on which the flange keeps its orientation. The path begins at the
    flange pose for the joint position `q` (n,), and ends at the displacement `way` (3,) [m] from it.
    """
    start = flange_poses(robot.chain, q[None])[0]

    def pose_at(s: Array) -> Array:
        poses = np.repeat(start[None], len(s), axis=0)
        poses[:, :3, 3] += s[:, None] * way
        return poses

    return pose_at


def _end(robot: Robot, end: Broken, length: float) -> str:
    """Return the end of the sentence that reports why a line can't be followed: the distance after which the
    arm can't follow it, and the reason.
    """
    place = f"ends after {end.s * length / MM:.0f} mm"
    if end.joint is None:
        return f"{place} (out of reach, or at a singularity)"
    kind = "would have to jump" if end.kind == "singular" else "is at its limit"
    return f"{place} ({robot.joint_names[end.joint]} {kind})"


def _home(robot: Robot) -> Item:
    frame = robot.flange_from_frame.get("TCP", np.eye(4))
    near = nearness(robot.chain, robot.home[None], frame)
    value = float(near.smallest[0])
    if value >= STRAIGHT:
        return Item("HOME", "ok", f"not near a singularity: smallest singular value {value:.2g}")
    motion = np.abs(near.joints[0])
    names = [name for name, part in zip(robot.joint_names, motion, strict=True) if part > 0.3]
    result = (
        f"singular (smallest singular value {value:.2g}): {' and '.join(names)} cancel each other's motion "
        "of the tool"
    )
    return Item(
        "HOME", "note", result, "leave HOME by MOVEJ instead of a straight line, or choose another HOME"
    )


def _reach(robot: Robot, q: Array) -> Item:
    frame = robot.flange_from_frame.get("TCP", np.eye(4))
    points = tool_poses(robot.chain, q, frame)[:, :3, 3]
    far, near = (float(choose(np.linalg.norm(points, axis=1))) / MM for choose in (np.max, np.min))
    low, high = points.min(axis=0)[2] / MM, points.max(axis=0)[2] / MM
    found = (
        f"in {len(q)} positions TCP is {near:.0f} to {far:.0f} mm from {{B}}, {low:.0f} to {high:.0f} mm high"
    )
    return Item("reach", "ok", found)


def _frames(robot: Robot) -> Iterator[Item]:
    names = [f"{{{name}}}" for name in robot.flange_from_frame]
    if "TCP" not in robot.flange_from_frame:
        remedy = "add [frames.TCP] with xyz and rpy on the flange"
        yield Item("TCP", "to do", "there is no frame TCP, so programs move {FLANGE}", remedy)
    for name, pose in robot.flange_from_frame.items():
        length = float(np.linalg.norm(pose[:3, 3]))
        if length > LONG_TOOL:
            position = f"{{{name}}} is {length / MM:.0f} mm from the flange"
            yield Item("frames", "to do", position, "check xyz, which is in mm")
    if "TCP" in robot.flange_from_frame:
        pose = robot.flange_from_frame["TCP"]
        same = np.allclose(pose, np.eye(4), atol=1e-9)
        place = " ".join(f"{value / MM:.4g}" for value in pose[:3, 3])
        position = "TCP is the flange itself" if same else f"TCP is at {place} mm on the flange"
        yield Item(
            "TCP", "note" if same else "ok", position, "give the tool's tip in [frames.TCP]" if same else ""
        )
    yield from tool_axis(robot)
    yield Item("frames", "ok", f"on the flange: {', '.join(names)}")


def tool_axis(robot: Robot) -> Iterator[Item]:
    """Yield the item that compares the z axis of TCP with the direction in which the tool points. The poses
    of the commands PICKPLACE and PALLET depend on this axis.
    """
    out = outwards(robot)
    if out is None:
        return
    z = (robot.chain.base_from_flange @ robot.flange_from_frame["TCP"])[:3, 2]
    share = float(z @ out)
    if share <= -ALONG:
        found = "z of TCP points back along the tool, away from the work, as PICKPLACE and PALLET need it"
        yield Item("tool axis", "ok", found)
        return
    if share >= ALONG:
        way, turn = "out along the tool, into the work", "by 180 deg about x"
    else:
        way, turn = "neither out nor back along the tool", "so that z points back"
    remedy = (
        f"for these modules turn TCP {turn} with rpy in [frames.TCP], or call them with a frame turned in "
        "this way"
    )
    yield Item(
        "tool axis", "note", f"z of TCP points {way}; PICKPLACE and PALLET need it to point back", remedy
    )


def outwards(robot: Robot) -> Array | None:
    """Return the direction in which the end of the arm points with all joints at 0, as a unit vector (3,) in
    {B}. Return None if the geometry doesn't determine this direction.

    With a tool, this is the direction from FLANGE to TCP. Without a tool, it is the direction from the axis
    of the joint before the last one to the flange. If the last joint turns, only the direction's component
    along the axis of this joint counts.
    """
    frame = robot.flange_from_frame.get("TCP")
    if frame is None:
        return None
    flange = robot.chain.base_from_flange
    way = flange[:3, :3] @ frame[:3, 3]
    if np.linalg.norm(way) < SHORT_TOOL:
        lines = lines_of(robot.chain)
        if robot.size < 2 or lines.turn[-2] == 0.0:
            return None
        from_axis = flange[:3, 3] - lines.points[-2]
        way = from_axis - lines.axes[-2] * (from_axis @ lines.axes[-2])
        if lines.turn[-1] != 0.0:  # the offset across the last axis belongs to the wrist, not to the tool
            way = lines.axes[-1] * (way @ lines.axes[-1])
    length = float(np.linalg.norm(way))
    return way / length if length >= SHORT_TOOL else None
