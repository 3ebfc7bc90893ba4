"""Move nodes of viser's scene to poses (4, 4)."""

from __future__ import annotations

from typing import Any

import numpy as np

from yarclang.robot.model import Array


def move_nodes(nodes: list[Any], poses: Array) -> None:
    """Set the poses (K, 4, 4) of viser nodes (K). The first node isn't moved, because no joint moves it."""
    for node, pose, turn in zip(nodes[1:], poses[1:], _quaternions(poses[1:]), strict=True):
        node.position, node.wxyz = pose[:3, 3], turn


def position_and_turn(transform: Array) -> tuple[Array, Array]:
    """Return position, and rotation as a quaternion w x y z."""
    return transform[:3, 3], _quaternions(transform[None])[0]


def _quaternions(poses: Array) -> Array:
    """Return the rotations of poses (K, 4, 4) as quaternions w x y z (K, 4)."""
    from scipy.spatial.transform import Rotation

    quaternions: Array = np.roll(Rotation.from_matrix(np.array(poses[:, :3, :3])).as_quat(), 1, axis=1)
    return quaternions
