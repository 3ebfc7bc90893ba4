"""Judgement of each blend, in which one motion flows into the next."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from yarclang import hir
from yarclang.certify.blends.ball import (
    Away,
    Balls,
    away_in_joints,
    away_on_path,
    cubics_of,
    farthest,
    joint_distances,
    joint_turn,
    radii,
)
from yarclang.certify.blends.flows import Corner, frame_of
from yarclang.certify.certificate import Blended
from yarclang.certify.judged import Judged
from yarclang.certify.motion.bounds import Cubics
from yarclang.certify.motion.joint import by_kind
from yarclang.certify.motion.proved import Proofs
from yarclang.certify.read.layout import CHUNK, Layout
from yarclang.frozen import frozen
from yarclang.progress import go_on
from yarclang.robot.model import Array
from yarclang.units import DEG, MM

NOTHING = Away(0.0, 0.0)


def judge_blends(judged: Judged, layout: Layout, proofs: Proofs) -> dict[int, Blended]:
    """Prove each blend, report the blends that leave their balls, and return the proved bounds.

    The bounds are keyed by the step of the motion before the blend.
    """
    blended: dict[int, Blended] = {}
    rounded: list[Corner] = []
    for corner in proofs.flows.corners:
        step = layout.places[corner.first].step
        if not corner.rounded:
            passed = int(proofs.flows.follow[corner.first, 1]) - 1 - layout.places[corner.first].last
            blended[step] = Blended(corner.segments, 0.0, 0.0, 0.0, 0.0, passed)
        elif corner.joints:
            blended[step] = _in_joints(judged, layout, proofs, corner)
        else:
            rounded.append(corner)
    for corners in _chunks(rounded):
        go_on()
        blended.update(_of_frames(judged, layout, proofs, corners))
    return blended


def _chunks(corners: list[Corner]) -> Iterator[list[Corner]]:
    """Yield groups of corners. The blends of a group have at most `CHUNK` / 4 segments in total, except for a
    group of one corner.
    """
    chunk: list[Corner] = []
    size = 0
    for corner in corners:
        if chunk and size + corner.segments > CHUNK // 4:
            yield chunk
            chunk, size = [], 0
        chunk.append(corner)
        size += corner.segments
    if chunk:
        yield chunk


def _overlap(layout: Layout, corner: Corner) -> slice:
    """Return the range of the segments of a blend."""
    middle = layout.places[corner.first].last
    return slice(middle - corner.segments // 2, middle + corner.segments // 2)


def _blend_of(layout: Layout, corner: Corner) -> hir.Reading:
    blend = layout.places[corner.first].motion.blend
    assert blend is not None  # the map lists a blend only where the program has one
    return blend


def _in_joints(judged: Judged, layout: Layout, proofs: Proofs, corner: Corner) -> Blended:
    """Judge a blend between two motions in joint space.

    Each joint must stay near its position in the corner, within the blend's angle (revolute) or radius
    (prismatic).
    """
    robot = judged.robot
    rows = _overlap(layout, corner)
    middle = proofs.starts.q[corner.second]
    away = joint_distances(layout.cubics(rows.start, rows.stop), middle)
    left = _apart(proofs, corner.first, 1, middle)
    joined = _apart(proofs, corner.second, 0, middle)
    worst = np.maximum(away, np.maximum(left, joined))
    allowed = radii(_blend_of(layout, corner), robot)
    slack = np.where(robot.chain.is_prismatic, judged.tolerance.position, judged.tolerance.angle)
    # Compare in the user's units (deg or mm), so that revolute and prismatic joints are ranked alike.
    excess = (worst - allowed - slack) / robot.axis_units
    if not (excess <= 0.0).all():
        joint = int(np.argmax(excess))
        unit = robot.axis_units[joint]
        judged.find(
            "Y1166",
            f"in the blend after it {robot.joint_names[joint]} is up to {worst[joint] / unit:.6g} "
            f"{robot.axis_unit_names[joint]} from the corner, "
            f"{_how(away[joint], left[joint], joined[joint])}: {(worst - allowed)[joint] / unit:.3g} more "
            f"than the {allowed[joint] / unit:.6g} that are allowed",
            layout.places[corner.first].step,
        )
    most, bound = by_kind(allowed, robot), by_kind(worst, robot)
    return Blended(corner.segments, *most, *bound)


def _how(away: float, left: float, joined: float) -> str:
    """Return in words which part of the blend is farthest from the corner."""
    # Both ends of the blend also belong to the paths, which `left` and `joined` bound. If the largest
    # distance is there, `away` differs from them only in the last digits.
    if away > 1.001 * max(left, joined):
        return "between the two paths"
    return "where the path is left" if left >= joined else "where the next path is joined"


def _apart(proofs: Proofs, row: int, end: int, corner: Array) -> Array:
    """Bound each joint's distance (n,) [rad or m] from the corner on the part of a path that the blend cuts
    off.

    Args:
        proofs: the proofs so far.
        row: the motion's row in the layout.
        end: 0 for the part at the path's start, 1 for the part at its end.
        corner: (n,) joint positions of the corner [rad or m].
    """
    spline = proofs.curves.get(row)
    if spline is None or len(spline.y) == 1:
        return np.zeros_like(corner)
    share = float(proofs.covered[row, end])
    return joint_distances(cubics_of(spline, *((0.0, share) if end == 0 else (share, 1.0))), corner)


@frozen(eq=False)
class _Ball:
    """The ball in which a moving frame must stay, with the parts of both paths that the blend cuts off.

    Attributes:
        corner: the corner.
        flange_from_moving: (4, 4) moving frame, relative to the flange.
        pose: (4, 4) pose of the moving frame in the corner.
        left: largest distance and angle from the corner on the first path after the blend has left it.
        joined: largest distance and angle from the corner on the second path before the blend joins it.
    """

    corner: Corner
    flange_from_moving: Array
    pose: Array
    left: Away
    joined: Away


def _of_frames(
    judged: Judged, layout: Layout, proofs: Proofs, corners: list[Corner]
) -> Iterator[tuple[int, Blended]]:
    """Judge blends in which a moving frame must stay near the corner.

    The frame is that of the first motion, or that of the second one if the first is in joint space.
    """
    balls = [_ball(judged, layout, proofs, corner) for corner in corners]
    rows = [np.arange(*_overlap(layout, ball.corner).indices(len(layout.time))[:2]) for ball in balls]
    owner = np.repeat(np.arange(len(balls)), [len(row) for row in rows])
    segments = np.concatenate(rows)
    cubics = Cubics.of_spline(layout.control, layout.at[segments], layout.time[segments])
    radius = np.array([_blend_of(layout, ball.corner).length or 0.0 for ball in balls])
    slack = [judged.tolerance_of(layout.places[ball.corner.first].motion) for ball in balls]
    turn = np.array([ball.left.angle + ball.joined.angle for ball in balls])
    # Allow the tolerance in addition to the ball: the executed path may differ from the programmed one by
    # this amount.
    together = Balls(
        np.array([ball.flange_from_moving for ball in balls]),
        np.array([ball.pose for ball in balls]),
        radius + np.array([one.position for one in slack]),
        turn + np.array([one.angle for one in slack]),
    )
    position, angle = farthest(cubics, owner, together, judged.robot)
    for i, ball in enumerate(balls):
        step = layout.places[ball.corner.first].step
        parts = float(position[i]), ball.left.position, ball.joined.position
        # The executed blend, the cut-off end of the first path and the cut-off start of the second path must
        # all stay in the ball.
        most = max(parts)
        if not most <= together.radius[i]:
            judged.find(
                "Y1166",
                f"in the blend after it the moving frame is up to {most / MM:.6g} mm from the corner, "
                f"{_how(*parts)}: {(most - radius[i]) / MM:.3g} more than the {radius[i] / MM:.6g} that are "
                "allowed",
                step,
            )
        elif not angle[i] <= together.angle[i]:
            judged.find(
                "Y1166",
                f"in the blend after it the moving frame is turned by up to {angle[i] / DEG:.6g} deg from "
                f"its orientation in the corner; both motions turn by {turn[i] / DEG:.6g} deg there",
                step,
            )
        yield step, Blended(ball.corner.segments, float(radius[i]), float(turn[i]), most, float(angle[i]))


def _ball(judged: Judged, layout: Layout, proofs: Proofs, corner: Corner) -> _Ball:
    frame = frame_of(layout.places[corner.first].motion, layout.places[corner.second].motion)
    assert frame is not None  # without a moving frame, it would be a blend of joints
    pose = proofs.starts.flange[corner.second] @ frame
    radius = _blend_of(layout, corner).length or 0.0
    left, joined = (
        _not_followed(judged, proofs, row, end, frame, pose, radius)
        for row, end in ((corner.first, 1), (corner.second, 0))
    )
    other = frame_of(layout.places[corner.second].motion)
    if other is not None and not np.array_equal(frame, other):
        # The second motion moves another frame: bound the rotations by those of the joints, as for motions in
        # joint space.
        rows = _overlap(layout, corner)
        knots = layout.cubics(rows.start, rows.stop).x
        turned = joint_turn(knots[[0, -1]], knots[corner.segments // 2], judged.robot)
        left, joined = (
            replace(away, angle=max(away.angle, float(x)))
            for away, x in zip((left, joined), turned, strict=True)
        )
    return _Ball(corner, frame, pose, left, joined)


def _not_followed(
    judged: Judged, proofs: Proofs, row: int, end: int, frame: Array, pose: Array, radius: float
) -> Away:
    """Bound the distance from the corner on the part of a path that the blend cuts off.

    Args:
        judged: the context of the judgement.
        proofs: the proofs so far.
        row: the motion's row in the layout.
        end: 0 for the part at the path's start, 1 for the part at its end.
        frame: (4, 4) the blend's moving frame, relative to the flange.
        pose: (4, 4) pose of this frame in the corner.
        radius: allowed distance [m].
    """
    share = float(proofs.covered[row, end])
    if row in proofs.frames:
        low, high = (0.0, share) if end == 0 else (share, 1.0)
        paths, own = proofs.frames[row]
        moving = paths.flange_from_moving[own]
        # Compute moving_from_frame, the pose of the blend's frame relative to the path's moving frame.
        between = np.eye(4) if np.array_equal(moving, frame) else np.linalg.inv(moving) @ frame
        return away_on_path(paths, own, (low, high), pose, between)
    spline = proofs.curves.get(row)
    if spline is None or len(spline.y) == 1:
        return NOTHING
    sharp = radius + judged.tolerance.position
    ball = Balls(frame[None], pose[None], np.array([sharp]), np.array([np.pi]))
    return away_in_joints(spline, end, share, ball, judged.robot)
