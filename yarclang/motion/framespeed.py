"""How exactly the moving frame keeps a speed: between the knots the curve goes a little faster and slower than its law."""

from __future__ import annotations

import numpy as np

from yarclang.hir import Array
from yarclang.motion.cartesian import CartesianPath
from yarclang.motion.curve import Curve
from yarclang.motion.trials import Trial
from yarclang.progress import go_on
from yarclang.robot.kinematics.fk import poses_and_jacobians

KEPT = 4e-4
"""A cruise may be faster or slower than was asked for by this share."""

_CRUISE = 0.9995
_PARTS = 4


def frame_speeds(path: CartesianPath, q: Array, rates: Array) -> Array:
    """The speed (N,) of the moving frame [m/s, or rad/s of a pure turn] at joint positions and velocities (N, n)."""
    jacobians = poses_and_jacobians(path.chain, q, path.flange_from_moving)[1]
    rows = slice(3, 6) if path.extent[1] else slice(0, 3)
    speeds: Array = np.linalg.norm(np.einsum("nij,nj->ni", jacobians[:, rows], rates), axis=1)
    return speeds


def finer_for_speed(path: CartesianPath, trial: Trial, segment: float) -> float | None:
    """A segment time [s] at which the cruise keeps its speed; None where it does with `segment`."""
    go_on()
    times = np.arange(_PARTS * trial.segments + 1, dtype=float) * (segment / _PARTS)
    law = Curve(trial.control[:, None], segment, trial.control).sample(times)[1][:, 0]
    cruise = law > _CRUISE * law.max()
    q, rates, _ = Curve(trial.points, segment, trial.control).sample(times[cruise])
    off = float(np.abs(frame_speeds(path, q, rates) / (law[cruise] * path.extent[0]) - 1.0).max())
    # the speed between knots misses by the third power of the segment time
    return segment * float(max((0.8 * KEPT / off) ** (1 / 3), 0.25)) if off > KEPT else None
