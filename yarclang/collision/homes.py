"""Which joint positions may be HOME: those in which the robot doesn't touch itself."""

from __future__ import annotations

import numpy as np

from yarclang.collision.checklist import OFTEN, POSITIONS, by_names, touching
from yarclang.collision.scene import scene_of
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Array, Robot


def first_free(robot: Robot, proposed: Array) -> tuple[int | None, tuple[tuple[str, str], ...]]:
    """Return the first of some joint positions in which nothing touches, and what touches in the very first.

    Bodies that touch in nearly all positions are drawn so, and don't count. None: there is no free one. A robot with meshes that can't be read touches nothing here.

    Args:
        robot: its bodies.
        proposed: (K, n) [rad or m].
    """
    # with all pairs, also those that HOME lets touch
    scene = scene_of(robot, None, lenient=False).value
    if scene is None or not len(scene.pairs.first):
        return 0, ()
    usual = by_names(scene, touching(scene, within(robot.chain, robot.limits, POSITIONS)))
    names = [scene.names(pair) for pair in range(len(scene.pairs.first))]
    counts = np.array([usual[name] <= OFTEN for name in names])
    hit = touching(scene, proposed) & counts
    free = np.flatnonzero(~hit.any(axis=1))
    first = sorted({names[pair] for pair in np.flatnonzero(hit[0]).tolist()})
    return (int(free[0]) if len(free) else None), tuple(first)
