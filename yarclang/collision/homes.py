"""Choose a joint position that could be HOME: one in which the robot doesn't touch itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from yarclang.collision.checklist import MOSTLY, POSITIONS, apart
from yarclang.collision.scene import scene_of
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Array, Robot

GAPS = (0.05, 0.02, 0.01, 0.001, 0.0)
"""Distances that bodies should keep in HOME [m]; the largest one that any position offers is used.

Bodies that almost touch would touch after a small motion.
"""


def first_free(robot: Robot, proposed: Array) -> tuple[int | None, tuple[tuple[str, str], ...]]:
    """Return the index of the first joint position in which no bodies of the robot touch or almost touch.

    Bodies that touch in most positions have shapes that are drawn too large, and don't count. If the meshes
    of a robot can't be read, the first position is returned.

    Args:
        robot: the robot with its bodies.
        proposed: (K, n) joint positions to choose from [rad or m].

    Returns:
        The index of the position, and no pairs; or None and the names of the pairs that touch in the first
        of the proposed positions.
    """
    # Use all pairs, including those that touch in HOME.
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
    """Return a mask (P, K): for each proposed position, the pairs of bodies that are nearer than a gap.

    Pairs that are nearer than the gap in most of the `usual` positions are left out.

    Args:
        names: names of the two bodies of each pair.
        usual: distances of the pairs in positions spread over the joint limits, (`POSITIONS`, K) [m].
        here: distances of the pairs in the proposed positions (P, K) [m].
        gap: the gap [m].
    """
    near = usual <= gap
    shares: dict[tuple[str, str], NDArray[np.bool_]] = {}
    for pair, name in enumerate(names):
        shares[name] = shares.get(name, np.zeros(len(near), dtype=bool)) | near[:, pair]
    found: NDArray[np.bool_] = (here <= gap) & np.array([shares[name].mean() <= MOSTLY for name in names])
    return found
