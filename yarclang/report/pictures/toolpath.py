"""Compute the path of a frame on the flange through space, in a bounded number of points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.plan import MotionPlan
from yarclang.report.pictures.drawn_frame import DrawnFrame
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Robot
from yarclang.units import MM

MOST_POINTS = 20_000
"""Largest number of points of all motions together. The starts of the motions aren't counted."""

_MOST_EACH = 1_000
"""Largest number of points of one motion."""

MOST_DOTS = 400
"""Largest number of waypoints, and of corners, that are drawn. More couldn't be distinguished in a picture.
"""


@frozen(eq=False)
class ToolPath:
    """Path of the origin of a frame on the flange, in mm in {B}.

    Attributes:
        frame: frame on the flange.
        points: (N, 3) points of all motions. Motion k is `points[bounds[k] : bounds[k + 1]]`, from its start
            to its end.
        bounds: where the points of each motion begin in `points`.
        waypoints: (w, 3) positions that the commands name, including the ends of motions. If there are too
            many, only every `every`-th of them.
        every: thinning of the waypoints: 1 if all of them are kept.
    """

    frame: str
    points: Array
    bounds: NDArray[np.intp]
    waypoints: Array
    every: int


def tool_path_of(plan: MotionPlan, frame: DrawnFrame) -> ToolPath:
    """Compute the path of a frame on the flange during a plan.

    The points are distributed by the lengths of the motions in joint space. A short program thus gets many
    points for its length, while the number of points of a long program is bounded.
    """
    start = plan.program.start[None]
    if not plan.motions:
        standing = _places(plan.robot, start, frame)
        return ToolPath(frame.name, standing, np.array([0, 1]), standing[:0], 1)
    curves = [motion.curve for motion in plan.motions]
    ways = np.array([np.abs(np.diff(curve.points, axis=0)).sum() for curve in curves])
    shares = ways / max(float(ways.sum()), 1e-12)
    # a motion of k parts has k + 1 points: its start is repeated from the end of the previous motion
    parts = np.clip((shares * (MOST_POINTS - len(curves))).astype(np.intp), 1, _MOST_EACH)
    # if there are more motions than points, only some motions have points
    parts[np.arange(1 - len(parts), 1) % -(-len(parts) // MOST_POINTS) > 0] = 0
    bounds = np.concatenate(([0], np.cumsum(np.where(parts > 0, parts + 1, 0))))
    number = np.repeat(np.arange(len(parts)), np.diff(bounds))
    along = (np.arange(bounds[-1]) - bounds[number]) / parts[number]
    durations = np.array([curve.duration for curve in curves])
    q = plan.sampler.sample(number, along * durations[number])[0]
    named = np.concatenate([motion.waypoints for motion in plan.motions])
    every = -(-len(named) // MOST_DOTS)
    return ToolPath(
        frame.name,
        _places(plan.robot, q, frame),
        bounds,
        _places(plan.robot, named[every - 1 :: every], frame),
        every,
    )


def _places(robot: Robot, q: Array, frame: DrawnFrame) -> Array:
    """Return the origin of a frame on the flange at joint positions `q` (N, n), as (N, 3) [mm] in {B}."""
    places: Array = tool_poses(robot.chain, q, frame.flange_from_frame)[:, :3, 3] / MM
    return places
