"""Which joint positions may be HOME: those in which the robot doesn't touch itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.checklist import MOSTLY, POSITIONS, apart
from yarclang.collision.scene import scene_of
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Array, Robot

GAPS = (0.05, 0.02, 0.01, 0.001, 0.0)
"""How far apart bodies should be in HOME [m], the widest that any position has: what almost touches there does so after a small motion."""


def first_free(robot: Robot, proposed: Array) -> tuple[int | None, tuple[tuple[str, str], ...]]:
    """Return the first of some joint positions in which nothing touches or almost does; None and what touches in the very first, if there is none.

    Bodies that do so in most positions are drawn so, and don't count. A robot with meshes that can't be read touches nothing here.

    Args:
        robot: its bodies.
        proposed: (K, n) [rad or m].
    """
    # with all pairs, also those that HOME lets touch
    scene = scene_of(robot, None, lenient=False).value
    if scene is None or not len(scene.pairs.first):
        return 0, ()
    names = [scene.names(pair) for pair in range(len(scene.pairs.first))]
    usual, here = apart(scene, within(robot.chain, robot.limits, POSITIONS)), apart(scene, proposed)
    touching = _near(names, usual, here, 0.0)
    for gap in GAPS:
        free = np.flatnonzero(~(touching | _near(names, usual, here, gap)).any(axis=1))
        if len(free):
            return int(free[0]), ()
    hit = np.flatnonzero(touching[0]).tolist()
    return None, tuple(sorted({names[pair] for pair in hit}))


def _near(names: Sequence[tuple[str, str]], usual: Array, here: Array, gap: float) -> NDArray[np.bool_]:
    """Return which pairs are nearer than a gap [m] in each proposed position (P, K), but for bodies that are in most of the usual ones."""
    near = usual <= gap
    shares: dict[tuple[str, str], NDArray[np.bool_]] = {}
    for pair, name in enumerate(names):
        shares[name] = shares.get(name, np.zeros(len(near), dtype=bool)) | near[:, pair]
    found: NDArray[np.bool_] = (here <= gap) & np.array([shares[name].mean() <= MOSTLY for name in names])
    return found
