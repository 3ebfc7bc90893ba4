"""Sample the motion of a plan as shares of the robot's limits, in a bounded number of samples."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen
from yarclang.hir import Array
from yarclang.motion.plan import MotionPlan
from yarclang.progress import each
from yarclang.robot.actuation import counts_per_joint
from yarclang.robot.dynamics import torques
from yarclang.robot.model import Robot

MOST_SAMPLES = 20_000
"""Largest number of samples that are kept. If there are more, they are thinned, since a picture has far fewer
columns of pixels.
"""

_PARTS = (2, 16)
"""The smallest and the largest number of equal parts into which a segment of a curve is divided for sampling.
In a segment, jerk is constant and acceleration is linear, so that both are exact at its ends. With two parts,
the largest velocity exceeds the sampled velocities by at most jerk h^2 / 32, where h is the segment time.
This is 0.3 % of a velocity limit of 60 deg/s for 2000 deg/s^3 and 50 ms.
"""

_COLUMNS = 4_000
"""Number of short intervals in a thinned trace: several for each pixel. Of each interval, the smallest and
the largest values are kept.
"""

_AT_ONCE = 4_096
"""Number of segments that are sampled at once."""

_STANDS = 1e-9
"""Times that differ by less count as equal [s]."""

STANDING = 1.0
"""Duration that is drawn for a program without motion [s]."""


@frozen(eq=False)
class Trace:
    """Motion of joints and motors over time, as shares of their limits: 1.0 is the limit itself.

    At the boundary of two segments a time is repeated, with the jerk before and after it. Each quantity is
    (N, n), with one column for each joint or motor. A thinned trace has two rows for each short interval, at
    its first and last time: the smallest and the largest values in it.

    Attributes:
        times: (N,) never decreasing [s].
        position: -1 at the lower limit and +1 at the upper; for a joint without limits, the angle divided by
            180 deg.
        velocity: signed velocity, divided by the limit.
        acceleration: signed acceleration, divided by the limit.
        jerk: signed jerk, divided by the limit.
        motors: signed speed of the motors, divided by the limit.
        torque: signed torque of the joints, divided by their efforts; None if masses or efforts are unknown.
        is_thinned: True for a thinned trace.
    """

    times: Array
    position: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    motors: Array
    torque: Array | None
    is_thinned: bool

    @property
    def motors_bind(self) -> bool:
        """True if a motor uses a larger share of its speed limit than any joint uses of its velocity
        limit.
        """
        return bool(np.abs(self.motors).max() > np.abs(self.velocity).max())


@frozen
class Peak:
    """The largest share of a limit that a motion uses.

    Attributes:
        share: share of the limit.
        column: joint or motor, counted from 0.
        time: time of the largest share [s].
    """

    share: float
    column: int
    time: float


def peak_of(trace: Trace, values: Array) -> Peak:
    """Return the largest magnitude in `values` (N, n), a quantity of `trace`, with its column and time."""
    row, column = divmod(int(np.argmax(np.abs(values))), values.shape[1])
    return Peak(abs(float(values[row, column])), column, float(trace.times[row]))


def trace_of(plan: MotionPlan) -> Trace:
    """Sample all motions of a plan.

    Up to `MOST_SAMPLES` samples are kept unchanged. If there are more, the smallest and largest values of
    short intervals are kept, so that no peak is lost.
    """
    limits = _limits(plan.robot)
    if not plan.motions:
        still = np.array([0.0, plan.duration or STANDING])
        return _trace(still, _standing(limits, plan, still), plan.robot.size, is_thinned=False)
    segments = sum(motion.curve.segments for motion in plan.motions)
    parts = int(np.clip(MOST_SAMPLES // segments - 1, *_PARTS))
    sampled = each(_all_sampled(limits, plan, parts))
    if segments * (parts + 1) > MOST_SAMPLES:
        intervals = [extremes(times, times, rows, rows, plan.duration) for times, rows in sampled]
        # an interval may contain samples of several motions, so its extremes are computed again
        first, last, least, most = (np.concatenate(part) for part in zip(*intervals, strict=True))
        first, last, least, most = extremes(first, last, least, most, plan.duration)
        times = np.column_stack((first, last)).ravel()
        rows = np.stack((least, most), axis=1).reshape(len(times), -1)
        return _trace(times, rows, plan.robot.size, is_thinned=True)
    times, rows = (np.concatenate(part) for part in zip(*sampled, strict=True))
    return _trace(times, rows, plan.robot.size, is_thinned=False)


def _all_sampled(limits: _Limits, plan: MotionPlan, parts: int) -> Iterator[tuple[Array, Array]]:
    """Yield times (N,) [s] and the shares of all limits, side by side: one pair for each rest, and one for
    each group of motions without a rest inside.
    """
    ends = np.concatenate(([0.0], plan.ends))
    begins = np.concatenate((plan.begins, [plan.duration]))
    stands = begins - ends > _STANDS
    segments = np.array([motion.curve.segments for motion in plan.motions])
    passed = np.concatenate(([0], np.cumsum(segments)))
    first = 0
    while first <= len(segments):
        if stands[first]:
            times = np.array([ends[first], begins[first]])
            yield times, _standing(limits, plan, times)
        if first == len(segments):
            return
        # `behind` ends the group: consecutive motions without a rest between them, up to `_AT_ONCE` segments
        behind = int(np.searchsorted(passed, passed[first] + _AT_ONCE, side="right")) - 1
        behind = min(max(behind, first + 1), len(segments))
        rests = np.flatnonzero(stands[first + 1 : behind])
        behind = first + 1 + int(rests[0]) if len(rests) else behind
        yield _sampled(limits, plan, np.arange(first, behind), segments[first:behind], parts)
        first = behind


def _standing(limits: _Limits, plan: MotionPlan, times: Array) -> Array:
    """Return the shares of all limits, side by side, at times (N,) [s] at which the robot rests."""
    still = np.zeros((len(times), plan.robot.size))
    return limits.shares(plan.sample(times)[0], still, still, still)


def _sampled(
    limits: _Limits, plan: MotionPlan, motions: NDArray[np.intp], segments: NDArray[np.intp], parts: int
) -> tuple[Array, Array]:
    """Sample motions, with each segment divided into a given number of equal parts.

    Returns:
        Times (N,) [s], and all shares of limits, side by side (N, 5 n) or (N, 6 n).
    """
    curves = [plan.motions[number].curve for number in motions.tolist()]
    number = np.repeat(motions, segments)
    in_motion = np.arange(len(number)) - np.repeat(np.cumsum(segments) - segments, segments)
    length = np.repeat([curve.segment for curve in curves], segments)
    along = in_motion[:, None] + np.linspace(0.0, 1.0, parts + 1)
    local = (along * length[:, None]).ravel()
    jerk = np.concatenate([np.diff(curve.points, n=3, axis=0) / curve.segment**3 for curve in curves])
    each_of = np.repeat(number, parts + 1)
    q, v, a = plan.sampler.sample(each_of, local)
    return plan.begins[each_of] + local, limits.shares(q, v, a, np.repeat(jerk, parts + 1, axis=0))


@frozen(eq=False)
class _Limits:
    """The robot's limits, by which values are divided to get shares.

    Attributes:
        middle: (n,) middle of each joint's range [rad or m].
        half: (n,) half the width of each joint's range [rad or m].
        velocity: (n,) largest velocity [rad/s or m/s].
        acceleration: (n,) largest acceleration [rad/s² or m/s²].
        jerk: (n,) largest jerk [rad/s³ or m/s³].
        motors: (n, n) matrix that converts joint velocities to motor speeds, as shares of the motors' limits.
        robot: the robot, for the torques; None if its masses are unknown.
    """

    middle: Array
    half: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    motors: Array
    robot: Robot | None

    def shares(self, q: Array, v: Array, a: Array, j: Array) -> Array:
        """Divide positions, velocities, accelerations and jerks (N, n each, in SI) by their limits.

        Returns:
            The shares side by side: of the four quantities, of the motors' speeds and, if the robot's masses
            are known, of the torques. The shape is (N, 5 n), or (N, 6 n) with torques.
        """
        dynamics = self.robot.dynamics if self.robot else None
        rows = np.empty((len(q), 5 if dynamics is None else 6, q.shape[1]))
        np.divide(q - self.middle, self.half, out=rows[:, 0])
        np.divide(v, self.velocity, out=rows[:, 1])
        np.divide(a, self.acceleration, out=rows[:, 2])
        np.divide(j, self.jerk, out=rows[:, 3])
        np.matmul(v, self.motors.T, out=rows[:, 4])
        if self.robot is not None and dynamics is not None:
            np.divide(torques(self.robot.chain, dynamics, q, v, a), dynamics.effort, out=rows[:, 5])
        return rows.reshape(len(q), -1)


def _limits(robot: Robot) -> _Limits:
    """Return the limits of a robot. A joint without position limits gets 0 and 180 deg as middle and half."""
    limits, limited = robot.limits, has_limits(robot)
    lower, upper = np.where(limited, limits.lower, -np.pi), np.where(limited, limits.upper, np.pi)
    return _Limits(
        middle=(lower + upper) / 2.0,
        half=(upper - lower) / 2.0,
        velocity=limits.velocity,
        acceleration=limits.acceleration,
        jerk=limits.jerk,
        motors=counts_per_joint(robot) / robot.actuation.velocity[:, None],
        robot=robot if robot.dynamics is not None and robot.dynamics.is_checked else None,
    )


def has_limits(robot: Robot) -> NDArray[np.bool_]:
    """Return a mask (n,) of the joints with position limits; continuous joints have none."""
    limited: NDArray[np.bool_] = np.isfinite(robot.limits.lower) & np.isfinite(robot.limits.upper)
    return limited


def extremes(
    first: Array, last: Array, least: Array, most: Array, duration: float
) -> tuple[Array, Array, Array, Array]:
    """Thin samples: divide `duration` into `_COLUMNS` equal parts, and join all intervals that begin in the
    same part.

    Args:
        first: (N,) beginning of each interval [s], never decreasing.
        last: (N,) end of each interval [s].
        least: (N, m) smallest values in each interval.
        most: (N, m) largest values in each interval.
        duration: duration of the whole plan [s].

    Returns:
        The four arrays of the joined intervals.
    """
    column = np.minimum((first * (_COLUMNS / duration)).astype(np.intp), _COLUMNS - 1)
    begin = np.flatnonzero(np.diff(column, prepend=-1))
    end = np.append(begin[1:], len(first)) - 1
    return first[begin], last[end], np.minimum.reduceat(least, begin), np.maximum.reduceat(most, begin)


def _trace(times: Array, rows: Array, size: int, *, is_thinned: bool) -> Trace:
    position, velocity, acceleration, jerk, motors, *more = np.split(rows, rows.shape[1] // size, axis=1)
    for array in (times, rows):
        array.setflags(write=False)
    torque = more[0] if more else None
    return Trace(times, position, velocity, acceleration, jerk, motors, torque, is_thinned)
