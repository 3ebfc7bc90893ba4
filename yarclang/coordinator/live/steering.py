"""What people want of a moving robot to joint velocities: a joint's, a twist's, or those that follow a master."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from yarclang.coordinator.live.grid import Rates, State
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.kinematics.reach import arm_length
from yarclang.robot.kinematics.singularity import weighted_jacobians
from yarclang.robot.model import Array, Robot

SLOW, STILL = 0.06, 0.02
"""Smallest singular values (weighted, `robot.kinematics.singularity`): a motion towards a singularity gets slower below the first, and ends at the second."""

_AHEAD = 0.02
"""How far a singularity is looked for ahead, in units of the joints' motion [rad, or arm's lengths for a sliding joint]."""

_SAME = 1e-7
_KEPT = 0.9
"""What of a tool's speed is used: what it can grow by within a segment must have room."""

_NEAR = 0.2
"""Seconds in which a master that stands is reached."""


@dataclass(frozen=True, slots=True, eq=False)
class JointVelocity:
    """Joints shall move with `velocity` (n,) [rad/s or m/s]."""

    velocity: Array


@dataclass(frozen=True, slots=True, eq=False)
class Twist:
    """The tool shall move with `linear` (3,) [m/s] and turn with `angular` (3,) [rad/s], along the axes of {B} or its own."""

    linear: Array
    angular: Array
    axes: Literal["base", "tool"] = "base"


@dataclass(frozen=True, slots=True, eq=False)
class Master:
    """The robot shall be where a master is: joints `q` (n,) [rad or m], which move with `rate` (n,) per s."""

    q: Array
    rate: Array


Target = JointVelocity | Twist | Master


@dataclass(frozen=True, slots=True, eq=False)
class Steered:
    """Joint velocities (n,) [rad/s or m/s], and what keeps them from what was wanted, in words."""

    velocity: Array
    held_back: str = ""


class Steering:
    """Knows one robot and its tool.

    Args:
        robot: that moves.
        tool: (4, 4) flange_from_tool.
        rates: the joints' limits.
        speed: the largest speed of the tool's origin [m/s].
    """

    def __init__(self, robot: Robot, tool: Array, rates: Rates, speed: float) -> None:
        self._robot = robot
        self._tool = tool
        self._rates = rates
        self._speed = speed
        self._length = arm_length(robot.chain, tool)
        self._slide = np.where(robot.chain.is_prismatic, self._length, 1.0)

    def velocity(self, target: Target | None, state: State, ahead: float = 0.0) -> Steered:
        """The joint velocities that a target wants of a robot in a state, and `ahead` [s] of it; none without one."""
        match target:
            case None:
                return Steered(np.zeros_like(state.c))
            case JointVelocity(velocity=wanted):
                return self._within(wanted, state.c, "")
            case Master():
                return self._within(self._towards(target, state), state.c, "")
            case Twist():
                return self._of_twist(target, state.c + ahead * state.v)

    def _within(self, wanted: Array, q: Array, why: str) -> Steered:
        """All joints slower together, until each, and the tool, keeps its limit."""
        share = float((np.abs(wanted) / self._rates.velocity).max(initial=0.0))
        tool = float(np.linalg.norm((self._jacobian(q) @ (wanted / self._slide))[:3])) * self._length
        share = max(share, tool / (_KEPT * self._speed))
        return Steered(wanted / share, why) if share > 1.0 else Steered(wanted, why)

    def _jacobian(self, q: Array) -> Array:
        """(6, n) at the tool, lengths in arm's lengths."""
        found: Array = weighted_jacobians(self._robot.chain, q[None], self._tool)[0]
        return found

    def _of_twist(self, twist: Twist, q: Array) -> Steered:
        turn = np.eye(3)
        if twist.axes == "tool":
            turn = tool_poses(self._robot.chain, q[None], self._tool)[0, :3, :3]
        wanted = np.concatenate([turn @ twist.linear / self._length, turn @ twist.angular])
        if not wanted.any():
            return Steered(np.zeros_like(q))
        left, values, right = np.linalg.svd(self._jacobian(q), full_matrices=False)
        # what a singularity costs endless speed is left out bit by bit; elsewhere this is the exact solution
        damping = np.where(values < SLOW, (SLOW - values) * STILL, 0.0)
        joints = right.T @ (values / (values**2 + damping) * (left.T @ wanted)) if values.any() else 0.0 * q
        least = float(values[-1])
        factor, why = 1.0, ""
        if least < SLOW and joints.any():
            ahead = q + _AHEAD * joints * self._slide / np.abs(joints).max()
            approaches = np.linalg.svd(self._jacobian(ahead), compute_uv=False)[-1] < least - _SAME
            if approaches:
                # leaving is always allowed
                factor = float(np.clip((least - STILL) / (SLOW - STILL), 0.0, 1.0))
                why = f"near a singularity (smallest singular value {least:.3f})"
        return self._within(factor * joints * self._slide, q, why)

    def _towards(self, master: Master, state: State) -> Array:
        """The master's own velocity, and what closes the distance: as fast as what is left can be braked in."""
        left = master.q - state.c
        brake = 0.5 * self._rates.acceleration
        fast = np.sqrt(2.0 * brake * np.abs(left))
        velocity: Array = master.rate + np.sign(left) * np.minimum(fast, np.abs(left) / _NEAR)
        return velocity
