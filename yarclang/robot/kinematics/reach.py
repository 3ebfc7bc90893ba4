"""How far the tool can be from each joint axis, at most: the lever that turns joint motion into path
error.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.robot.kinematics.fk import links_of
from yarclang.robot.model import Array, Chain, Limits


def reach_radii(chain: Chain, limits: Limits, flange_from_tool: Array) -> Array:
    """For each joint, a bound over all configurations on what a unit of it moves the tool's origin.

    For a revolute joint that is the distance [m] from its axis to the tool's origin: the distance from the
    axis to a fixed point on the next one, and from there on the sum of the links, point to point, with
    all travel of the prismatic joints among them. It holds by the triangle inequality, whatever the
    joints do within the limits of the prismatic ones; limits of revolute joints aren't used. For a
    prismatic joint, which has no lever, it is 1 (times the length of its screw).

    Args:
        chain: the arm, n joints.
        limits: the travel of prismatic joints is taken from here; endless travel gives an infinite bound.
        flange_from_tool: (4, 4).

    Returns:
        The bounds (n,) [m per rad, or 1].
    """
    links = links_of(chain)
    radii = np.empty(chain.size)
    point = (chain.base_from_flange @ flange_from_tool)[:3, 3]
    beyond = 0.0
    for joint in range(chain.size - 1, -1, -1):
        if not links.turn[joint]:
            travel = max(abs(limits.lower[joint]), abs(limits.upper[joint]))
            radii[joint] = links.slide[joint]
            beyond += links.slide[joint] * travel
            continue
        axis, origin = links.frames[joint, :3, 2], links.frames[joint, :3, 3]
        # `point` is fixed in the link that this joint turns; its nearest point on the axis stays where it is
        foot = origin + axis * (axis @ (point - origin))
        beyond += float(np.linalg.norm(point - foot))
        radii[joint] = links.turn[joint] * beyond
        point = foot
    return radii


def arm_length(chain: Chain, flange_from_tool: Array) -> float:
    """How far the tool can be from the first axis that turns [m], slides at zero; 1 m where nothing turns.

    It is the sum of the links, each from the foot of the one behind it on its axis: a size of the arm that
    doesn't depend on where along their axes the URDF puts the joints.
    """
    return _arm_length(chain, np.asarray(flange_from_tool, dtype=float).tobytes())


@lru_cache(maxsize=256)
def _arm_length(chain: Chain, tool: bytes) -> float:
    """As `arm_length`, remembered by the chain's identity and the tool's numbers (4, 4)."""
    links = links_of(chain)
    point = (chain.base_from_flange @ np.frombuffer(tool).reshape(4, 4))[:3, 3]
    total = 0.0
    for joint in range(chain.size - 1, -1, -1):
        if links.turn[joint]:
            axis, origin = links.frames[joint, :3, 2], links.frames[joint, :3, 3]
            foot = origin + axis * (axis @ (point - origin))
            total += float(np.linalg.norm(point - foot))
            point = foot
    return total if total > 1e-3 else 1.0
