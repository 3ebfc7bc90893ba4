"""Find the corners that a plan passes without a stop: their times, places, and allowed deviations from the
programmed path.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array, Motion
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.plan import MotionPlan
from yarclang.report.pictures.drawn_frame import DrawnFrame, moving_frame
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.units import MM

_SAME = 1e-9
"""Places of frames that differ by less count as equal [m]."""


@frozen(eq=False)
class Passed:
    """The c corners between motions that a plan passes without a stop, in order of time.

    Attributes:
        motions: (c,) numbers of the motions that end in the corners.
        begins: (c,) times at which both motions begin to overlap [s].
        middles: (c,) times at which one motion ends and the other begins in the plan [s].
        ends: (c,) ends of the overlaps [s].
        places: (c, 3) positions of the drawn frame in the corners themselves [mm in {B}].
        radii: (c,) allowed distances from these positions [mm]. 0 if the motion must not leave the path, NaN
            if the blend is given for joints or for another frame than the drawn one.
    """

    motions: NDArray[np.intp]
    begins: Array
    middles: Array
    ends: Array
    places: Array
    radii: Array

    def __len__(self) -> int:
        return len(self.motions)


def passed_corners(plan: MotionPlan, frame: DrawnFrame) -> Passed:
    """Return the corners of a plan, as places of a frame on the flange."""
    flowing = [number for number, motion in enumerate(plan.motions) if motion.flows]
    halves = np.array([plan.motions[n].half for n in flowing])
    middles = plan.ends[flowing] if flowing else np.zeros(0)
    corners = np.array([plan.motions[n].path.end for n in flowing]).reshape(-1, plan.robot.size)
    places = tool_poses(plan.robot.chain, corners, frame.flange_from_frame)[:, :3, 3] / MM
    return Passed(
        np.array(flowing, dtype=np.intp),
        middles - halves,
        middles,
        middles + halves,
        places,
        np.array([_radius(plan, number, frame) for number in flowing], dtype=np.float64),
    )


def _radius(plan: MotionPlan, number: int, frame: DrawnFrame) -> float:
    """Return the largest allowed distance of the drawn frame from a corner while it passes the corner [mm];
    NaN if the blend gives no distance for this frame.
    """
    step = plan.program.steps[plan.motions[number].step]
    assert isinstance(step, Motion)
    moving = moving_frame(step)
    if moving is None:  # a joint motion that flows into a motion of a frame
        moving = moving_frame(plan.program.steps[plan.motions[number + 1].step])
    blend = step.blend.length if step.blend is not None else None
    if blend is None or moving is None or _joints_only(plan, number):
        return float("nan")
    same = np.abs(moving[:3, 3] - frame.flange_from_frame[:3, 3]).max() < _SAME
    return blend / MM if same else float("nan")


def _joints_only(plan: MotionPlan, number: int) -> bool:
    """Return True if both motions at a corner are joint motions, whose blend applies to each joint."""
    return not any(isinstance(plan.motions[n].path, CartesianPath) for n in (number, number + 1))
