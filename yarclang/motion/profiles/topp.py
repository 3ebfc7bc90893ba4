"""TOPP: the time-optimal law along the path under the limits of velocity, acceleration and motor speed, by TOPP-RA.

Its acceleration jumps from limit to limit; there is no limit of jerk. On the grid, raw samples of the law are the control
values: divided differences of samples are averages of derivatives, so what the law keeps the samples keep, and the
two segments that this takes are all that it costs (Pham and Pham, A New Approach to Time-Optimal Path Parameterization
based on Reachability Analysis, IEEE T-RO 34, 2018).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.hir import Array
from yarclang.motion.limits import Bounds
from yarclang.motion.path import Path
from yarclang.motion.profile import NO_FORM, Form, Law, Profile

_PLACES = 350
"""At how many places of the path the limits are looked at, at least: the denser the sharper it bends."""

_MOST_PLACES = 1000
_AROUND = 12
"""... but so many for each place that shows the path's bends: near a singularity, and on splines, there are more."""

_FINE = 400
"""At how many the bends are looked for."""

_NO_BOUND = 1e8
"""A bound of the speed of s, squared, that is none."""

_SHARE = 0.9998
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

    places, joints = _places(path, bounds)
    if not np.ptp(joints, axis=0).any():
        return np.array([0.0, 0.5, 1.0]), np.array([0.0, 0.5, 1.0]), np.array([0.0, 2.0, 0.0])

    class SpeedLimit(constraint.LinearConstraint):  # type: ignore[misc]
        """Joints and motors: an upper bound of the square of the speed of s at each place."""

        def get_dof(self) -> int:
            return len(bounds.velocity)

        def compute_constraint_params(self, curve: Any, gridpoints: Array) -> tuple[Array | None, ...]:
            slope = np.abs(curve(gridpoints, 1))
            motors = np.abs(curve(gridpoints, 1) @ bounds.counts.T)
            shares = np.maximum(
                (slope / bounds.velocity).max(axis=1), (motors / bounds.motor_velocity).max(axis=1)
            )
            most = np.minimum((_SHARE / np.maximum(shares, 1e-12)) ** 2, _NO_BOUND)
            return None, None, None, None, None, None, np.stack((np.zeros_like(most), most), axis=1)

    acceleration = bounds.acceleration * _SHARE
    instance = toppra.algorithm.TOPPRA(
        [
            SpeedLimit(),
            constraint.JointAccelerationConstraint(
                np.stack((-acceleration, acceleration), axis=1),
                discretization_scheme=constraint.DiscretizationType.Interpolation,
            ),
        ],
        toppra.SplineInterpolator(places, joints),
        gridpoints=places,
        parametrizer="ParametrizeConstAccel",
    )
    _, speed, _ = instance.compute_parameterization(0.0, 0.0)
    if speed is None or not np.isfinite(speed).all() or (speed[1:-1] <= 0.0).any():
        raise ArithmeticError("TOPP-RA found no law along a path that starts and ends at rest")
    steps = 2.0 * np.diff(places) / (speed[1:] + speed[:-1])
    return np.concatenate(([0.0], np.cumsum(steps))), places, speed


def _places(path: Path, bounds: Bounds) -> tuple[Array, Array]:
    """Places (N,), the denser the sharper the path bends, and the joint positions there (N, n)."""
    fine = np.unique(np.concatenate((np.linspace(0.0, 1.0, _FINE + 1), path.places)))
    joints = path.joints(fine)
    if path.is_straight_in_joints:
        return fine[:: _FINE // _PLACES], joints[:: _FINE // _PLACES]
    slope = np.diff(joints, axis=0) / np.diff(fine)[:, None]
    bend = np.abs(np.diff(slope, axis=0)) / ((fine[2:] - fine[:-2]) / 2.0)[:, None] / bounds.acceleration
    sharpness = np.sqrt(bend.max(axis=1))
    density = np.concatenate((sharpness[:1], sharpness, sharpness[-1:]))
    density += density.mean() + 1e-9
    count = np.concatenate(([0.0], np.cumsum((density[1:] + density[:-1]) * np.diff(fine))))
    wanted = max(_PLACES, min(_MOST_PLACES, _AROUND * len(path.places))) + 1
    places = np.interp(np.linspace(0.0, count[-1], wanted), count, fine)
    places[0], places[-1] = 0.0, 1.0
    return places, path.joints(places)


PROFILE = Profile(
    name="TOPP",
    summary="time-optimal along the path under velocity, acceleration and motor limits; no jerk limit",
    law=_law,
    is_stretched=True,
    has_jerk_limit=False,
    longest_segment=0.005,
)
