"""Where a motion goes over from one path to the next in a corner that it may not leave (BLEND 0): when it passes the corner.

Any instant would be lawful: up to it the one path is proved, from it on the other. A good one proves more.
"""

from __future__ import annotations

import numpy as np

from yarclang.certify.bounds import Cubics
from yarclang.certify.programmed import Rows
from yarclang.frozen import frozen
from yarclang.robot.kinematics.fk import poses_and_jacobians
from yarclang.robot.model import Array, Chain

_LOOKS = 8
"""So often a segment is looked at."""
_ROUNDS = 40
_LEAST = 1e-7


@frozen(eq=False)
class Corner:
    """The corner, as joints `q` (n,) that count by `weights` (n,), or, with a frame at `flange_from_moving` (4, 4), as its `pose` (4, 4),
    in which 1 / `weights` are a distance [m] and an angle [rad].
    """

    q: Array
    weights: Array
    flange_from_moving: Array | None = None
    pose: Array | None = None

    def closing(self, chain: Chain, x: Array, v: Array) -> tuple[Array, Array]:
        """The square of how far joints `x` (N, n) are from the corner, and how fast it grows with velocities `v`, (N,) each."""
        if self.flange_from_moving is None or self.pose is None:
            off = (x - self.q) * self.weights
            return (off**2).sum(axis=1), 2.0 * (off * v * self.weights).sum(axis=1)
        poses, jacobians = poses_and_jacobians(chain, x, self.flange_from_moving)
        twist = (jacobians @ v[:, :, None])[:, :, 0]
        off = (poses[:, :3, 3] - self.pose[:3, 3]) * self.weights[0]
        turn = (poses[:, :3, :3] - self.pose[:3, :3]) * self.weights[1] / np.sqrt(2.0)
        spin = np.cross(twist[:, 3:, None], poses[:, :3, :3], axis=1) * self.weights[1] / np.sqrt(2.0)
        far = (off**2).sum(axis=1) + (turn**2).sum(axis=(1, 2))
        rate = (off * twist[:, :3]).sum(axis=1) * self.weights[0] + (turn * spin).sum(axis=(1, 2))
        return far, 2.0 * rate


def passing(cubics: Cubics, corner: Corner, chain: Chain) -> tuple[int, float]:
    """The segment in which a corner is passed, and how long after its start [s]."""
    segment = np.repeat(np.arange(len(cubics.h)), _LOOKS)
    share = np.tile(np.arange(_LOOKS) / _LOOKS, len(cubics.h))
    far, _ = corner.closing(chain, *_at(cubics, segment, share))
    nearest = int(np.argmin(far))
    # the square of the distance falls before the corner and grows behind it
    low, high = max(nearest - 1, 0), min(nearest + 1, len(far) - 1)
    place = [segment[low] + share[low], segment[high] + share[high]]
    for _ in range(_ROUNDS):
        middle = (place[0] + place[1]) / 2.0
        row = np.array([min(int(middle), len(cubics.h) - 1)])
        _, rate = corner.closing(chain, *_at(cubics, row, middle - row))
        place[int(rate[0] > 0.0)] = middle
    found = min(int(place[0]), len(cubics.h) - 1)
    # a part of a segment has a duration
    part = min(max(place[0] - found, _LEAST), 1.0 - _LEAST)
    return found, float(part * cubics.h[found])


def _at(cubics: Cubics, rows: Rows, share: Array) -> tuple[Array, Array]:
    return cubics.take(rows).at(share * cubics.h[rows])
