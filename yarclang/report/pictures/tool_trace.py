"""Sample the tool's speed during a plan, and the arm's distance from singularities, with a bounded number of
samples.
"""

from __future__ import annotations

import numpy as np

from yarclang.frozen import frozen
from yarclang.hir import Array, Motion
from yarclang.motion.plan import MotionPlan
from yarclang.motion.zones import moving_of
from yarclang.report.pictures.drawn_frame import DrawnFrame, moving_frame
from yarclang.report.pictures.trace import MOST_SAMPLES, STANDING, extremes
from yarclang.robot.kinematics.fk import poses_and_jacobians
from yarclang.robot.kinematics.singularity import smallest_singular_values
from yarclang.units import MM

_FEWEST = 12
"""Smallest number of samples of a motion. The speed of a motion has one peak, which the samples miss by at
most a few percent.
"""

_AT_ONCE = 20_000
"""Number of samples that are computed at once, to bound the memory."""


@frozen(eq=False)
class ToolTrace:
    """Motion of a frame on the flange over time.

    A thinned trace has two rows for each short interval: the smallest and the largest values in it.

    Attributes:
        frame: frame on the flange.
        times: (N,) never decreasing [s].
        speed: (N,) speed of the frame's origin in {B} [mm/s].
        singular: (N,) smallest singular value of the weighted Jacobian: 0 at a singularity, 0.1 to 0.5 far
            from any singularity.
        wanted: (k, 3) speeds that commands request: start [s], end [s], and speed [mm/s].
    """

    frame: str
    times: Array
    speed: Array
    singular: Array
    wanted: Array


def tool_trace_of(plan: MotionPlan, frame: DrawnFrame) -> ToolTrace:
    """Follow a frame through a plan."""
    if not plan.motions:
        times = np.array([0.0, plan.duration or STANDING])
        rows = _followed(plan, frame, times)
        return ToolTrace(frame.name, times, rows[:, 0], rows[:, 1], np.zeros((0, 3)))
    durations = plan.ends - plan.begins
    shares = durations / max(float(durations.sum()), 1e-9)
    counts = np.maximum((shares * (MOST_SAMPLES / 2)).astype(np.intp), _FEWEST)
    ends = np.cumsum(counts + 1)
    begins = ends - counts - 1
    number = np.repeat(np.arange(len(counts)), counts + 1)
    along = (np.arange(ends[-1]) - begins[number]) / counts[number]
    times = plan.begins[number] + along * durations[number]
    # the tool is at rest before the first motion and after the last
    stands = np.array([0.0, plan.duration])
    times = np.concatenate((stands[:1][times[:1] > 0.0], times, stands[1:][plan.duration > times[-1:]]))
    parts = []
    for first in range(0, len(times), _AT_ONCE):
        piece = slice(first, first + _AT_ONCE)
        rows = _followed(plan, frame, times[piece])
        if len(times) > MOST_SAMPLES:
            parts.append(extremes(times[piece], times[piece], rows, rows, plan.duration))
        else:
            parts.append((times[piece], times[piece], rows, rows))
    first_, last, least, most = (np.concatenate(part) for part in zip(*parts, strict=True))
    if len(times) > MOST_SAMPLES:
        first_, last, least, most = extremes(first_, last, least, most, plan.duration)
        times = np.column_stack((first_, last)).ravel()
        rows = np.stack((least, most), axis=1).reshape(len(times), -1)
    else:
        rows = least
    return ToolTrace(
        frame.name, times, rows[:, 0], rows[:, 1], _requested(plan, frame, float(rows[:, 0].max(initial=0.0)))
    )


def _followed(plan: MotionPlan, frame: DrawnFrame, times: Array) -> Array:
    """Return speed [mm/s] and smallest singular value (N, 2) at times (N,) [s]."""
    q, v, _ = plan.sample(times)
    chain, tool = plan.robot.chain, frame.flange_from_frame
    jacobians = poses_and_jacobians(chain, q, tool)[1]
    speed = np.linalg.norm(np.einsum("nij,nj->ni", jacobians[:, :3], v), axis=1) / MM
    return np.column_stack((speed, smallest_singular_values(chain, q, tool)))


def _requested(plan: MotionPlan, frame: DrawnFrame, fastest: float) -> Array:
    """Return the speeds (k, 3) that commands request for a frame: start [s], end [s], and speed [mm/s].

    Upper limits on the speed (V<=) are included if they are below twice `fastest`, the frame's largest speed
    [mm/s].
    """
    rows = []
    for number, motion in enumerate(plan.motions):
        step = plan.program.steps[motion.step]
        assert isinstance(step, Motion)
        speed, moving = step.timing.speed, moving_frame(step)
        if (ceiling := step.timing.ceiling) is not None:
            tool = moving_of(plan.robot, step).flange_from_moving
            if ceiling / MM < 2.0 * fastest and np.array_equal(tool[:3, 3], frame.flange_from_frame[:3, 3]):
                rows.append((plan.begins[number], plan.ends[number], ceiling / MM))
            continue
        if speed is None or speed.length is None or moving is None:
            continue
        if np.array_equal(moving[:3, 3], frame.flange_from_frame[:3, 3]):
            rows.append((plan.begins[number], plan.ends[number], speed.length / MM))
    return np.array(rows, dtype=np.float64).reshape(-1, 3)
