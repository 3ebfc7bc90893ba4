"""Computation of joint velocities from the target of a live motion: a velocity of one joint, a twist of the
tool, or a master arm that is followed.
"""

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
"""Thresholds for the smallest singular value of the weighted Jacobian (`robot.kinematics.singularity`). A
motion towards a singularity slows down when this value falls below `SLOW`, and stops when it reaches `STILL`.
"""

_AHEAD = 0.02
"""Distance ahead at which a motion is tested for approaching a singularity. It is the distance that the
fastest joint moves [rad, or arm's lengths for a sliding joint].
"""

_SAME = 1e-7
_KEPT = 0.9
"""Share of the tool's largest speed that is used at the control points. Between control points, the tool may
be faster.
"""

_NEAR = 0.2
"""Time constant with which the robot approaches its master [s]: the additional velocity is the distance
divided by this time.
"""


@dataclass(frozen=True, slots=True, eq=False)
class JointVelocity:
    """Target: the joints move with `velocity` (n,) [rad/s or m/s]."""

    velocity: Array


@dataclass(frozen=True, slots=True, eq=False)
class Twist:
    """Target: the tool moves with `linear` (3,) [m/s] and turns with `angular` (3,) [rad/s], in the axes of
    {B} or of the tool.
    """

    linear: Array
    angular: Array
    axes: Literal["base", "tool"] = "base"


@dataclass(frozen=True, slots=True, eq=False)
class Master:
    """Target: the robot follows a master arm that is at the joint positions `q` (n,) [rad or m] and moves
    with the joint velocities `rate` (n,) [per s].
    """

    q: Array
    rate: Array


Target = JointVelocity | Twist | Master


@dataclass(frozen=True, slots=True, eq=False)
class Steered:
    """Joint velocities (n,) [rad/s or m/s]. If they differ from those of the target, `held_back` is the
    reason.
    """

    velocity: Array
    held_back: str = ""


class Steering:
    """Computes joint velocities for one robot and its tool.

    Args:
        robot: the robot.
        tool: (4, 4) flange_from_tool.
        rates: limits of the joints.
        speed: largest speed of the tool's origin [m/s].
    """

    def __init__(self, robot: Robot, tool: Array, rates: Rates, speed: float) -> None:
        self._robot = robot
        self._tool = tool
        self._rates = rates
        self._speed = speed
        self._length = arm_length(robot.chain, tool)
        self._slide = np.where(robot.chain.is_prismatic, self._length, 1.0)

    def velocity(self, target: Target | None, state: State, ahead: float = 0.0) -> Steered:
        """Compute the joint velocities for a target; zero without a target.

        Args:
            target: the target; None: rest.
            state: joint positions, velocities and accelerations at the end of the streamed lines.
            ahead: delay until the velocities take effect [s]. A twist is evaluated at the robot's position at
                that time.
        """
        match target:
            case None:
                return Steered(np.zeros_like(state.c))
            case JointVelocity(velocity=wanted):
                return self._within(wanted, state.c, "")
            case Master():
                return self._within(self._towards(target, state), state.c, "")
            case Twist():
                return self._of_twist(target, state.c + ahead * state.v)

    def _within(self, requested: Array, q: Array, reason: str) -> Steered:
        """Slow all joints down by the same factor until each joint and the tool are within their speed
        limits.

        Args:
            requested: (n,) joint velocities [rad/s or m/s].
            q: (n,) joint positions [rad or m].
            reason: reason why the velocities already differ from those of the target; empty: they don't.
        """
        # Factor by which the joints or the tool would exceed their limits. All joints are slowed down by this
        # factor.
        share = float((np.abs(requested) / self._rates.velocity).max(initial=0.0))
        tool = float(np.linalg.norm((self._jacobian(q) @ (requested / self._slide))[:3])) * self._length
        share = max(share, tool / (_KEPT * self._speed))
        return Steered(requested / share, reason) if share > 1.0 else Steered(requested, reason)

    def _jacobian(self, q: Array) -> Array:
        """Compute the Jacobian (6, n) at the tool. Lengths are measured in arm's lengths."""
        found: Array = weighted_jacobians(self._robot.chain, q[None], self._tool)[0]
        return found

    def _of_twist(self, twist: Twist, q: Array) -> Steered:
        turn = np.eye(3)
        if twist.axes == "tool":
            turn = tool_poses(self._robot.chain, q[None], self._tool)[0, :3, :3]
        requested = np.concatenate([turn @ twist.linear / self._length, turn @ twist.angular])
        if not requested.any():
            return Steered(np.zeros_like(q))
        left, values, right = np.linalg.svd(self._jacobian(q), full_matrices=False)
        # Damped least squares. Near a singularity, directions in which the joints would become too fast are
        # faded out. Elsewhere the solution is exact.
        damping = np.where(values < SLOW, (SLOW - values) * STILL, 0.0)
        joints = (
            right.T @ (values / (values**2 + damping) * (left.T @ requested)) if values.any() else 0.0 * q
        )
        least = float(values[-1])
        factor, reason = 1.0, ""
        if least < SLOW and joints.any():
            ahead = q + _AHEAD * joints * self._slide / np.abs(joints).max()
            approaches = np.linalg.svd(self._jacobian(ahead), compute_uv=False)[-1] < least - _SAME
            if approaches:
                # Only motion towards the singularity is slowed down.
                factor = float(np.clip((least - STILL) / (SLOW - STILL), 0.0, 1.0))
                reason = f"near a singularity (smallest singular value {least:.3f})"
        return self._within(factor * joints * self._slide, q, reason)

    def _towards(self, master: Master, state: State) -> Array:
        """Return the velocities with which the joints approach a master: the master's velocities plus a
        correction that reduces the distance. The correction is small enough to brake within the remaining
        distance.
        """
        left = master.q - state.c
        brake = 0.5 * self._rates.acceleration
        # A joint with the speed sqrt(2 a s) comes to rest within the distance s at the deceleration a.
        fast = np.sqrt(2.0 * brake * np.abs(left))
        velocity: Array = master.rate + np.sign(left) * np.minimum(fast, np.abs(left) / _NEAR)
        return velocity
