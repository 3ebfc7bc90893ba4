"""Compute an upper bound on the distance of the tool from each joint axis: the lever by which joint errors
become path errors.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from yarclang.robot.kinematics.fk import links_of
from yarclang.robot.model import Array, Chain, Limits


def reach_radii(chain: Chain, limits: Limits, flange_from_tool: Array) -> Array:
    """Return, for each joint, an upper bound on the speed of the tool's origin per unit of joint speed.

    For a revolute joint this is a bound on the distance [m] from its axis to the tool's origin. The bound is
    a sum of three parts: the distance from the axis to a fixed point on the next axis; the lengths of all
    later links, point to point; and the travel of all later prismatic joints. By the triangle inequality the
    bound holds for all joint positions within the limits of the prismatic joints; the limits of revolute
    joints aren't used. For a prismatic joint the bound is 1 (times the length of its screw).

    Args:
        chain: the arm, n joints.
        limits: contains the travel of prismatic joints; unlimited travel gives an infinite bound.
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
            # a sliding joint moves everything after it by at most its travel
            travel = max(abs(limits.lower[joint]), abs(limits.upper[joint]))
            radii[joint] = links.slide[joint]
            beyond += links.slide[joint] * travel
            continue
        axis, origin = links.frames[joint, :3, 2], links.frames[joint, :3, 3]
        # `point` is fixed in the link that this joint turns; its nearest point on the axis stays at rest
        foot = origin + axis * (axis @ (point - origin))
        beyond += float(np.linalg.norm(point - foot))
        radii[joint] = links.turn[joint] * beyond
        point = foot
    return radii


def arm_length(chain: Chain, flange_from_tool: Array) -> float:
    """Return an upper bound on the distance of the tool from the first turning axis [m], with sliding joints
    at zero; 1 m if no joint turns.

    The bound is a sum of distances. The first is the distance from the tool to the nearest point of the last
    turning axis; the second is the distance from that point to the nearest point of the previous turning
    axis, and so on. The bound doesn't depend on where along their axes the URDF puts the joints.

    Args:
        chain: the arm.
        flange_from_tool: (4, 4).
    """
    return _arm_length(chain, np.asarray(flange_from_tool, dtype=float).tobytes())


@lru_cache(maxsize=256)
def _arm_length(chain: Chain, tool: bytes) -> float:
    """Compute `arm_length`, cached by the chain's identity and the numbers of the tool's transform (4, 4)."""
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
