"""Report if the torques of motions are compared with the joints' effort limits, and compute the torques that
hold the arm at rest against gravity.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from yarclang.robot.checklist.item import Item, listed
from yarclang.robot.dynamics import holding_torques
from yarclang.robot.joint_points import joint_points
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.kinematics.search import within
from yarclang.robot.model import Dynamics, Robot

POSITIONS = 500
"""Number of joint positions, spread over the limits, at which holding torques are computed."""

FAR_CENTER = 0.5
"""Distance of a centre of mass from its link, relative to the arm's length, above which the centre of mass is
probably wrong.
"""


def mass_items(robot: Robot) -> Iterator[Item]:
    """Yield the items about masses, efforts, and the largest torques that hold the arm at rest."""
    dynamics = robot.dynamics
    if dynamics is None:
        return
    reason = _reason(robot, dynamics)
    if reason:
        remedy = "give <inertial> and <limit effort=...> in the URDF, or effort in [joints.NAME]"
        yield Item("torques", "note", f"torques aren't checked: {reason}", remedy)
        return
    yield from _centers(robot, dynamics)
    total = f"{dynamics.mass.sum():.3g} kg move"
    is_known = np.isfinite(dynamics.effort)
    q = within(robot.chain, robot.limits, POSITIONS)
    torques = np.abs(holding_torques(robot.chain, dynamics, q)) / dynamics.effort
    joint = int(np.argmax(torques.max(axis=0)))
    most = (
        f"at rest {robot.joint_names[joint]} needs up to {torques.max():.0%} of its effort in {POSITIONS} "
        "positions"
    )
    free = [name for name, one in zip(robot.joint_names, is_known, strict=True) if not one]
    without = f"; {listed(free)} have no effort" if free else ""
    if torques.max() > 1.0:
        often = float((torques > 1.0).any(axis=1).mean())
        most = f"{most}, and in {often:.0%} of them a joint needs more than all of its effort"
        remedy = (
            "motions there are refused: check masses (kg), effort (N m), gravity and the tools' masses; "
            "[joints.NAME] effort overrides the URDF's, and checked = false in [dynamics] disables the "
            "check"
        )
        yield Item("torques", "note", f"{total}; {most}{without}", remedy)
    else:
        yield Item("torques", "ok", f"{total}; {most}{without}")


def _centers(robot: Robot, dynamics: Dynamics) -> Iterator[Item]:
    """Yield the item about centres of mass that lie far from their own link.

    Such a centre often comes from an exporter that writes it in the coordinates of the whole drawing. For
    this item, a link is the line from its joint to the next joint. Arms with sliding joints are left out:
    their links can be as long as the joint's travel.
    """
    chain = robot.chain
    if chain.is_prismatic.any():
        return
    points = joint_points(robot)
    if points is None:
        return
    foot = points[:-1]
    along = points[1:] - foot
    square = np.maximum((along * along).sum(axis=1), 1e-12)
    share = np.clip(((dynamics.center - foot) * along).sum(axis=1) / square, 0.0, 1.0)
    away = np.linalg.norm(dynamics.center - foot - share[:, None] * along, axis=1)
    away = np.where(dynamics.mass > 0.0, away, 0.0)
    size = arm_length(chain, np.eye(4))
    far = np.flatnonzero(away > FAR_CENTER * size)
    if not len(far):
        return
    moved = listed([f"{robot.joint_names[k]} ({away[k]:.3g} m)" for k in far])
    found = (
        f"centres of mass are far from the links that these joints move: {moved}; the arm is "
        f"{size:.3g} m long"
    )
    remedy = (
        "check <inertial> in the URDF: its <origin> is given in the link's own frame, not in the base; "
        "checked = false in [dynamics] disables the check"
    )
    yield Item("centres of mass", "note", found, remedy)


def _reason(robot: Robot, dynamics: Dynamics) -> str:
    """Return the reason why torques aren't compared with efforts; empty if they are compared."""
    if not dynamics.wanted:
        return "robot.toml says so"
    light = dynamics.mass <= 0.0
    if light.any():
        joints = [name for name, one in zip(robot.joint_names, light, strict=True) if one]
        return f"the links moved by {listed(joints, 3)} have no mass"
    return "" if np.isfinite(dynamics.effort).any() else "no joint has an effort"
