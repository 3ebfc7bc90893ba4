"""TOPP: the time-optimal law along the path under the limits of velocity, acceleration and motor speed, by TOPP-RA.

Its acceleration jumps from limit to limit; there is no limit of jerk. On the grid, raw samples of the law are the control
values: divided differences of samples are averages of derivatives, so what the law keeps the samples keep, and the
two segments that this takes are all that it costs (Pham and Pham, A New Approach to Time-Optimal Path Parameterization
based on Reachability Analysis, IEEE T-RO 34, 2018).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array
from yarclang.motion.limits import Bounds
from yarclang.motion.path import Path
from yarclang.motion.profile import NO_FORM, Form, Law, Profile

_PLACES = 300
"""At how many places of the path, at least, the limits are looked at."""

_SHARE = 0.999
"""The share of the limits that the law uses: between the places it may use a little more."""


def _law(path: Path, bounds: Bounds) -> Law:
    times, s, speed = _fastest(path, bounds)
    duration = times[-1]

    def pure(u: Array) -> Array:
        t = np.clip(u, 0.0, 1.0) * duration
        piece = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2)
        along = t - times[piece]
        push = (speed[piece + 1] - speed[piece]) / (times[piece + 1] - times[piece])
        reached: Array = np.clip(s[piece] + along * (speed[piece] + 0.5 * push * along), 0.0, 1.0)
        return reached

    def control(segments: int, form: Form) -> Array:  # noqa: ARG001
        samples = pure(np.arange(segments - 1) / (segments - 2))
        samples[0], samples[-1] = 0.0, 1.0
        return np.concatenate((np.zeros(2), samples, np.ones(2)))

    top = float(speed.max()) * duration
    sharpest = float(np.abs(np.diff(speed) / np.diff(times)).max()) * duration**2

    def strain(segments: int, forms: NDArray[np.int64]) -> Array:
        h = 1.0 / (segments - 2)
        return np.tile([top * h, sharpest * h**2, 2.0 * sharpest * h**2], (len(forms), 1))

    return Law(pure, control, lambda segments: NO_FORM, strain)  # noqa: ARG005


def _fastest(path: Path, bounds: Bounds) -> tuple[Array, Array, Array]:
    """Times [s], places s and speeds [1/s] of the law, (N,) each; between them the acceleration of s is constant."""
    import toppra
    from toppra import constraint

    places = np.unique(np.concatenate((np.linspace(0.0, 1.0, _PLACES + 1), path.places)))
    joints = path.joints(places)
    if not np.ptp(joints, axis=0).any():
        return np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.5, 1.0]), np.array([0.0, 2.0, 0.0])
    # motors as further joints: their speed is limited, and their acceleration by that of the joints they turn with
    both = np.concatenate((joints, joints @ bounds.counts.T), axis=1)
    velocity = np.concatenate((bounds.velocity, bounds.motor_velocity)) * _SHARE
    acceleration = np.concatenate((bounds.acceleration, 2.0 * np.abs(bounds.counts) @ bounds.acceleration))
    scale = np.concatenate((np.ones(len(bounds.velocity)), bounds.motor_velocity))
    instance = toppra.algorithm.TOPPRA(
        [
            constraint.JointVelocityConstraint(_both_ways(velocity / scale)),
            constraint.JointAccelerationConstraint(
                _both_ways(acceleration / scale * _SHARE),
                discretization_scheme=constraint.DiscretizationType.Interpolation,
            ),
        ],
        toppra.SplineInterpolator(places, both / scale),
        gridpoints=places,
        parametrizer="ParametrizeConstAccel",
    )
    _, speed, _ = instance.compute_parameterization(0.0, 0.0)
    if speed is None or not np.isfinite(speed).all() or (speed[1:-1] <= 0.0).any():
        raise ArithmeticError("TOPP-RA found no law along a path that starts and ends at rest")
    steps = 2.0 * np.diff(places) / (speed[1:] + speed[:-1])
    return np.concatenate(([0.0], np.cumsum(steps))), places, speed


def _both_ways(limit: Array) -> Array:
    return np.stack((-limit, limit), axis=1)


PROFILE = Profile(
    name="TOPP",
    summary="time-optimal along the path under velocity, acceleration and motor limits; no jerk limit",
    law=_law,
    is_stretched=True,
    has_jerk_limit=False,
    longest_segment=0.01,
)
