"""Measure how exactly the moving frame keeps a speed: between knots, the frame on the curve is slightly
faster or slower than its motion profile.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.curve import Curve
from yarclang.motion.trials import Trial
from yarclang.progress import go_on
from yarclang.robot.kinematics.fk import poses_and_jacobians

KEPT = 4e-4
"""Largest share by which a cruise may deviate from its speed."""

_CRUISE = 0.9995
_OF_RAMPS = 0.45
"""Weight of an excess over the cruise's speed on a ramp: the certificate allows twice as much there as in the
cruise.
"""
_BETWEEN = 0.2
_REACHED = 2e-3
"""Missing share of a speed below which the speed counts as reached, in the certificate too."""
_DIPS = 20
"""Largest number of dips of a speed that are examined, each lower than the one before."""
_PARTS = 4
_AT_ONCE = 4_096
"""Instants at which speeds are computed together."""


def frame_speeds(path: CartesianPath, q: Array, rates: Array) -> Array:
    """Return the speed of the moving frame (N,) [m/s, or rad/s for a pure turn] at N joint positions and
    velocities (N, n).
    """
    jacobians = poses_and_jacobians(path.chain, q, path.flange_from_moving)[1]
    rows = slice(3, 6) if path.extent[1] else slice(0, 3)
    speeds: Array = np.linalg.norm(np.einsum("nij,nj->ni", jacobians[:, rows], rates), axis=1)
    return speeds


def _instants(segments: int, segment: float) -> Iterator[Array]:
    """Yield the times [s] at which the frame's speed is sampled, several in each segment."""
    count = _PARTS * segments + 1
    for begin in range(0, count, _AT_ONCE):
        go_on()
        yield np.arange(begin, min(begin + _AT_ONCE, count), dtype=float) * (segment / _PARTS)


def top_speeds(path: CartesianPath, curve: Curve) -> tuple[float, float]:
    """Return the largest and the sustained speed of the moving frame on a curve from rest to rest.

    The unit is m/s, or rad/s for a pure turn. Between the first and the last instant at which the frame
    nearly has the sustained speed, it doesn't fall below it.
    """
    speeds = np.concatenate(
        [frame_speeds(path, *curve.sample(times)[:2]) for times in _instants(curve.segments, curve.segment)]
    )
    top = least = float(speeds.max())
    for _ in range(_DIPS):
        # A dip between two instants that reach the speed lowers the sustained speed, which may be reached
        # earlier and later then: repeat.
        (reached,) = np.nonzero(speeds >= least * (1.0 - _REACHED))
        lowest = float(speeds[reached[0] : reached[-1] + 1].min())
        if lowest >= least * (1.0 - KEPT):
            break
        least = lowest
    # Between the instants the speed may be slightly lower.
    return top, least - _BETWEEN * (top - least)


def finer_for_speed(path: CartesianPath, trial: Trial, segment: float) -> float | None:
    """Return a shorter segment time [s] with which the moving frame keeps its cruise speed; None if `segment`
    is already short enough.
    """
    law = Curve(trial.control[:, None], segment, trial.control)
    curve = Curve(trial.points, segment, trial.control)
    instants = list(_instants(trial.segments, segment))
    rates = [law.sample(times)[1][:, 0] for times in instants]
    top, off = max(float(one.max()) for one in rates), 0.0
    for times, wanted in zip(instants, rates, strict=True):
        go_on()
        q, velocities, _ = curve.sample(times)
        speeds, is_cruise = frame_speeds(path, q, velocities) / path.extent[0], wanted > _CRUISE * top
        off = max(off, float(np.abs(speeds[is_cruise] / wanted[is_cruise] - 1.0).max(initial=0.0)))
        off = max(off, _OF_RAMPS * float((speeds[~is_cruise] / top - 1.0).max(initial=0.0)))
    # The error of the speed between knots grows with the third power of the segment time.
    return segment * float(max((0.8 * KEPT / off) ** (1 / 3), 0.25)) if off > KEPT else None
