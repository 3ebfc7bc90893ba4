"""Conversion of pressed jog buttons to targets of a live motion, that is, a motion whose target can change
while it runs. Buttons ask for velocities of joints or of a frame, or for steps.
"""

from __future__ import annotations

import numpy as np

from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders, wants
from yarclang.pendant.messages.jog import Press, Step
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM

AXES = "xyzabc"


class Pressed:
    """Converter of presses for one robot.

    Args:
        robot: robot that is jogged.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    async def of(self, press: Press, seat: Attached) -> wants.Want:
        """Return the target of the live motion for a button that asks for a velocity of joints or of a frame.

        Raises:
            Trouble: the press contains no velocity, or names an unknown joint or frame.
        """
        if press.velocity is not None:
            return wants.MoveJoints(velocity=press.velocity)
        if press.twist is None:
            raise Trouble("nothing is wanted", "give velocity, twist, step or go", "")
        if _same_text(press.axes, press.moving):
            return wants.MoveTool(twist=press.twist, axes="tool")
        turn = await self._axes(press.axes, seat)
        along, about = np.array(press.twist[:3]), np.array(press.twist[3:])
        return wants.MoveTool(twist=tuple(np.concatenate([turn @ along, turn @ about]).tolist()), axes="base")

    async def _axes(self, name: str, seat: Attached) -> Array:
        """Return the axes (3, 3) of a stationary frame in {B}."""
        if _same_text(name, "{B}"):
            return np.eye(3)
        for frame in (await seat.ask(orders.AskFrames())).frames:
            if _same_text(frame.name, name):
                if frame.on_flange:
                    what = (
                        f"{frame.name} moves with the robot: only the moving frame can also be the reference"
                    )
                    raise Trouble(what, "choose it as the moving frame too", "")
                return np.array(frame.pose)[:3, :3]
        raise Trouble(f"there is no frame {name[:40]!r}", "choose one from the list", "")

    async def step(self, press: Press, step: Step, seat: Attached) -> wants.Want:
        """Return the target of the live motion for a step from the robot's present position."""
        stands = await seat.ask(orders.AskPlace(base="{B}", moving=press.moving))
        names = {name.upper(): number for number, name in enumerate(self._robot.joint_names)}
        if (number := names.get(step.axis.upper())) is not None:
            joints = list(stands.joints.values())
            joints[number] += step.by
            return wants.BeThere(joints=tuple(joints), rate=(0.0,) * len(joints))
        if step.axis not in AXES or len(step.axis) != 1:
            raise Trouble(f"there is no axis {step.axis[:40]!r}", "name a joint, or one of x y z a b c", "")
        if stands.pose is None:
            raise Trouble(stands.findings[0].message, stands.findings[0].help or "", "")
        pose = np.array(stands.pose)
        axis = AXES.index(step.axis)
        turn = pose[:3, :3] if _same_text(press.axes, press.moving) else await self._axes(press.axes, seat)
        way = turn[:, axis % 3]
        if axis < 3:
            pose[:3, 3] += way * step.by * MM
        else:
            pose[:3, :3] = _about(way, step.by * DEG) @ pose[:3, :3]
        values = [*(pose[:3, 3] / MM).tolist(), *(roll_pitch_yaw(pose[:3, :3]) / DEG).tolist()]
        return wants.HoldPose(pose=tuple(values))


def _same_text(text: str, other: str) -> bool:
    return text.strip("{} ").upper() == other.strip("{} ").upper()


def _about(axis: Array, angle: float) -> Array:
    """Return the rotation (3, 3) about a unit vector (3,) by an angle [rad]."""
    x, y, z = axis
    # Rodrigues' formula.
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Array = np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)
    return turn
