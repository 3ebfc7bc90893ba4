"""Compute distances of the bodies of a scene over time."""

from __future__ import annotations

import numpy as np

from yarclang.report.clearance import SEEN, near
from yarclang.robot.model import Array
from yarclang.view.stage import Stage


def apart_over(stage: Stage, times: Array) -> Array:
    """Return the smallest distance (N,) [m] between the bodies of a scene at times (N,) [s]. Distances above
    `SEEN` count as `SEEN`.
    """
    found = np.full(len(times), SEEN)
    q = stage.track.at(times)[0]
    for scene, rows in stage.scenes_over(times):
        found[rows] = near(scene, q[rows]).apart
    return found
