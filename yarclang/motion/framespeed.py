"""Measure how exactly the moving frame keeps a speed. Between knots, the frame on the executed curve is
slightly faster or slower than its motion profile.
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
"""Largest relative deviation of the frame's speed from the cruise speed."""

_CRUISE = 0.9995
_OF_RAMPS = 0.45
"""Weight of speeds above the cruise speed on a ramp. It is about a half, since the certificate allows twice
as much there as in the cruise.
"""
_BETWEEN = 0.2
_REACHED = 2e-3
"""Share by which a speed may be missed and still counts as reached. The certificate uses the same value."""
_DIPS = 20
"""Largest number of dips of a speed that are examined, each one lower than the dip before."""
_PARTS = 4
_PEAKS, _FINE = 16, 16
"""Number of the largest samples around which the speed is sampled again, and number of closer samples on
either side of each of them.
"""
_AT_ONCE = 4_096
"""Number of instants at which speeds are computed together."""


def frame_speeds(path: CartesianPath, q: Array, rates: Array) -> Array:
    """Return the speed of the moving frame, (N,) [m/s, or rad/s for a pure rotation], at joint positions `q`
    (N, n) with joint velocities `rates` (N, n).
    """
    jacobians = poses_and_jacobians(path.chain, q, path.flange_from_moving)[1]
    # The geometric Jacobian has the rows of the origin's velocity first, then those of the angular velocity.
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

    The unit is m/s, or rad/s for a pure rotation. The sustained speed is kept: between the first and the last
    instant at which the frame reaches it, its speed is never lower.
    """
    speeds = np.concatenate(
        [frame_speeds(path, *curve.sample(times)[:2]) for times in _instants(curve.segments, curve.segment)]
    )
    top = least = float(speeds.max())
    for _ in range(_DIPS):
        # A dip between two instants that reach the speed lowers the sustained speed. The lower speed is
        # reached earlier and left later, and there may be further dips in this longer time: repeat.
        (reached,) = np.nonzero(speeds >= least * (1.0 - _REACHED))
        lowest = float(speeds[reached[0] : reached[-1] + 1].min())
        if lowest >= least * (1.0 - KEPT):
            break
        least = lowest
    # Between the samples the speed may be slightly lower.
    return _top(path, curve, speeds), least - _BETWEEN * (top - least)


def _top(path: CartesianPath, curve: Curve, speeds: Array) -> float:
    """Return the largest speed of the moving frame on a curve. `speeds` are the speeds at all `_instants`.

    Around the largest samples the speed is sampled more closely: at a sharp bend of the path it may have a
    peak between two samples.
    """
    step = curve.segment / _PARTS
    peaks = np.argpartition(speeds, -min(_PEAKS, len(speeds)))[-min(_PEAKS, len(speeds)) :]
    times = (peaks[:, None] + np.linspace(-1.0, 1.0, 2 * _FINE + 1)).ravel() * step
    times = np.clip(times, 0.0, curve.segments * curve.segment)
    return float(frame_speeds(path, *curve.sample(times)[:2]).max())


def largest_speed(path: CartesianPath, trial: Trial, segment: float, own: slice) -> float:
    """Return the largest speed of the moving frame in the segments `own` of a trial [m/s, or rad/s for a pure
    rotation].
    """
    curve = Curve(trial.points[own.start : own.stop + 3], segment, trial.control[own.start : own.stop + 3])
    instants = _instants(curve.segments, segment)
    speeds = np.concatenate([frame_speeds(path, *curve.sample(times)[:2]) for times in instants])
    return _top(path, curve, speeds)


def finer_for_speed(path: CartesianPath, trial: Trial, segment: float) -> float | None:
    """Return a shorter segment time [s] with which the moving frame keeps its cruise speed; None if `segment`
    is already short enough.
    """
    # Treat the motion profile as a curve of one coordinate: its derivative is the wanted speed, as a share of
    # the path per second.
    law = Curve(trial.control[:, None], segment, trial.control)
    curve = Curve(trial.points, segment, trial.control)
    instants = list(_instants(trial.segments, segment))
    rates = [law.sample(times)[1][:, 0] for times in instants]
    top, off = max(float(one.max()) for one in rates), 0.0
    for times, wanted in zip(instants, rates, strict=True):
        go_on()
        q, velocities, _ = curve.sample(times)
        speeds, is_cruise = frame_speeds(path, q, velocities) / path.extent[0], wanted > _CRUISE * top
        # In the cruise, the error is any difference from the profile's speed; on ramps, only an excess over
        # the top speed.
        off = max(off, float(np.abs(speeds[is_cruise] / wanted[is_cruise] - 1.0).max(initial=0.0)))
        off = max(off, _OF_RAMPS * float((speeds[~is_cruise] / top - 1.0).max(initial=0.0)))
    # The error of the speed between knots grows with the third power of the segment time.
    return segment * float(max((0.8 * KEPT / off) ** (1 / 3), 0.25)) if off > KEPT else None
