"""Compute the pose, Jacobian and pose error of a single joint position, in a fifth of the time that `fk` and
`numeric` take for a batch of one.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from yarclang.robot.kinematics.fk import Links, links_of
from yarclang.robot.model import Array, Chain
from yarclang.transforms import sealed


def pose_with_jacobian(chain: Chain, q: Array) -> tuple[Array, Array]:
    """Return the pose base_from_flange (4, 4) at a joint position (n,) [rad or m], and the Jacobian (6, n) at
    the flange's origin: linear part above angular part, in the axes of {B}.
    """
    links, (first, after) = links_of(chain), _constants(chain)
    turns = q if links.uniform else q * links.turn
    sin, cos = np.sin(turns), np.cos(turns)
    moves = np.zeros((chain.size, 4, 4))
    moves[:, 0, 0] = moves[:, 1, 1] = cos
    moves[:, 1, 0], moves[:, 0, 1] = sin, -sin
    moves[:, 2, 2] = moves[:, 3, 3] = 1.0
    if not links.uniform:
        moves[:, 2, 3] = links.slide * q
    moves = moves @ after
    frames = np.empty((chain.size, 4, 4))
    frame = first
    for joint in range(chain.size):
        frames[joint] = frame
        frame = frame @ moves[joint]
    axes, arms = frames[:, :3, 2].T, frame[:3, 3:] - frames[:, :3, 3].T
    jacobian = np.empty((6, chain.size))
    for row in range(3):
        over, before = (row + 1) % 3, (row + 2) % 3
        jacobian[row] = axes[over] * arms[before] - axes[before] * arms[over]
    jacobian[3:] = axes
    if not links.uniform:
        jacobian *= links.turn
        jacobian[:3] += links.slide * axes
    return frame, jacobian


def twist_between(pose: Array, target: Array) -> Array:
    """Return the twist (6,) from one pose (4, 4) to another: translation [m] above rotation [rad], axes of
    {B}; see `numeric.pose_error`.
    """
    error = np.empty(6)
    error[:3] = target[:3, 3] - pose[:3, 3]
    turned = (target[:3, :3] @ pose[:3, :3].T).tolist()
    # the antisymmetric part of the relative rotation: its axis times sin(angle)
    x = 0.5 * (turned[2][1] - turned[1][2])
    y = 0.5 * (turned[0][2] - turned[2][0])
    z = 0.5 * (turned[1][0] - turned[0][1])
    cosine = 0.5 * (turned[0][0] + turned[1][1] + turned[2][2] - 1.0)
    sine = math.sqrt(x * x + y * y + z * z)
    stretch = math.atan2(sine, cosine) / sine if cosine < 0.999 and sine > 1e-9 else 1.0
    half = math.pi if cosine < 0.0 and sine <= 1e-9 else 0.0
    error[3], error[4], error[5] = x * stretch + half, y * stretch, z * stretch
    return error


@lru_cache(maxsize=256)
def _constants(chain: Chain) -> tuple[Array, Array]:
    """Return two constants of a chain, cached by its identity: the first joint's frame in {B} (4, 4), and the
    transforms from each joint to the next joint or to the flange (n, 4, 4).
    """
    links: Links = links_of(chain)
    after = np.empty((chain.size, 4, 4))
    after[:-1] = links.steps[1:].transpose(0, 2, 1)
    after[-1] = links.last
    return sealed(links.frames[0].copy()), sealed(after)
