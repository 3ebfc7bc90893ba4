"""Check whether torques of motions are compared with the joints' effort limits, and compute the torques that
the arm needs to hold itself.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.robot.checklist.item import Item, listed
from yarclang.robot.dynamics import holding_torques
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Dynamics, Robot

POSITIONS = 500
"""Number of joint positions, spread over the limits, in which the arm is held."""


def mass_items(robot: Robot) -> Iterator[Item]:
    """Yield the item about masses, efforts, and the largest torques of an arm at rest."""
    dynamics = robot.dynamics
    if dynamics is None:
        return
    reason = _reason(robot, dynamics)
    if reason:
        remedy = "give <inertial> and <limit effort=...> in the URDF, or effort in [joints.NAME]"
        yield Item("torques", "note", f"torques aren't checked: {reason}", remedy)
        return
    total = f"{dynamics.mass.sum():.3g} kg move"
    is_known = np.isfinite(dynamics.effort)
    q = within(robot.chain, robot.limits, POSITIONS)
    torques = np.abs(holding_torques(robot.chain, dynamics, q)) / dynamics.effort
    joint = int(np.argmax(torques.max(axis=0)))
    most = (
        f"to stand, {robot.joint_names[joint]} needs up to {torques.max():.0%} of its effort in "
        f"{POSITIONS} positions"
    )
    free = [name for name, one in zip(robot.joint_names, is_known, strict=True) if not one]
    without = f"; {listed(free)} have no effort" if free else ""
    if torques.max() > 1.0:
        remedy = "check masses (kg), effort (N m), gravity, and what the tools weigh"
        yield Item("torques", "note", f"{total}; {most}{without}", remedy)
    else:
        yield Item("torques", "ok", f"{total}; {most}{without}")


def _reason(robot: Robot, dynamics: Dynamics) -> str:
    """Return the reason why torques aren't checked; empty if they are."""
    if not dynamics.wanted:
        return "robot.toml says so"
    light = dynamics.mass <= 0.0
    if light.any():
        joints = [name for name, one in zip(robot.joint_names, light, strict=True) if one]
        return f"what {listed(joints, 3)} move has no mass"
    return "" if np.isfinite(dynamics.effort).any() else "no joint has an effort"
