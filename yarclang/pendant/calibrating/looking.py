"""Motions with which the user inspects the result of a calibration before it is written to a file. They
are planned and proved like other motions.
"""

from __future__ import annotations

import numpy as np

from yarclang.calibration.touching import FrameTouching, TipTouching
from yarclang.calibration.writing import frame_line
from yarclang.pendant.calibrating.kept import Calibration
from yarclang.pendant.messages.calibration import LookCalibration, LookText
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble
from yarclang.transforms import turn_about
from yarclang.units import DEG, MM

_NAME = "CALIBRATION_LOOK"
"""Name of the frame with the result. It is declared inside the block with the motion, so it doesn't exist
in the session after the block.
"""
_SHARE = "10%"
"""Speed of these motions as a share of the robot's limits: as slow as the approach to a program's start."""
_SHORT = 5.0 * MM
"""Smallest distance between tip and flange from which the direction of the tool is derived [m]. With a
shorter tool, it isn't certain on which side of a touched point or plane the tool is.
"""


def look(calibration: Calibration, request: LookCalibration) -> LookText:
    """Return the program text of a motion that brings the tip near a touched point, where the user can check
    the result.

    Args:
        calibration: a calibration that has a result.
        request: number of the touched point, and the distance from it.

    Raises:
        Trouble: there is no result or no such touch, or the result can't be checked by a motion.
    """
    touching = calibration.touching
    if request.at is not None and request.at >= len(touching.joints):
        raise Trouble(f"there is no touch {request.at + 1}", "reload the touches", "gone")
    if isinstance(touching, TipTouching) and touching.value is not None:
        return _tip(touching, request)
    if isinstance(touching, FrameTouching) and touching.value is not None:
        return _frame(touching, calibration.tool, request)
    if touching.result_text():
        raise Trouble(
            "offsets can be checked only after they are written and loaded",
            "then move the joints to their marks",
            "look",
        )
    raise Trouble("there is no result yet", touching.next_step(), "result")


def _tip(touching: TipTouching, request: LookCalibration) -> LookText:
    assert touching.value is not None  # the caller has checked it
    flange = touching.poses()[-1 if request.at is None else request.at]
    back = flange[:3, 3] - touching.value.fixed
    length = float(np.linalg.norm(back))
    back = back / length if length > _SHORT else np.array([0.0, 0.0, 1.0])
    pose = np.eye(4)
    pose[:3, 3] = touching.value.fixed + back * request.distance * MM
    pose[:3, :3] = flange[:3, :3] @ turn_about("xyz".index(request.axis), request.tilt * DEG)
    tip = np.eye(4)
    tip[:3, 3] = touching.value.flange_from_tip
    problem = (
        f"The tip goes to {request.distance:g} mm from the point that was touched, back towards the flange"
    )
    if request.tilt:
        problem = (
            f"The tool turns by {request.tilt:+g} deg about {request.axis} of the flange: after that the "
            f"tip must stay in place, {request.distance:g} mm from the point"
        )
    return LookText(text=_block(frame_line(_NAME, tip, "FLANGE"), _NAME, pose, "B"), what=problem)


def _frame(touching: FrameTouching, tool: str, request: LookCalibration) -> LookText:
    assert touching.value is not None  # the caller has checked it
    at = request.at or 0
    base_from_frame = touching.value.base_from_frame
    flange = flange_poses(touching.robot.chain, touching.joints[at][None])[0]
    tip = flange @ touching.flange_from_tip
    z = base_from_frame[:3, 2]
    # Keep the tool on the side from which it touched the plane, even if z points to the other side.
    side = float((flange[:3, 3] - tip[:3, 3]) @ z)
    if abs(side) < _SHORT:
        side = float(z[2])
    side = 1.0 if side >= 0.0 else -1.0
    frame_from_tip = np.linalg.inv(base_from_frame) @ tip
    frame_from_tip[2, 3] = side * request.distance * MM
    point = ("the origin", "the point on x")[at] if at < 2 else f"touch {at + 1}"
    problem = (
        f"{tool} goes to {request.distance:g} mm above {point}: it must be exactly above the touched point"
    )
    if side < 0.0:
        problem += (
            ". z of the frame points into the surface, away from the tool: if this is wrong, touch the "
            "point of the plane on the other side of x"
        )
    text = _block(frame_line(_NAME, base_from_frame, "B"), tool.strip("{}"), frame_from_tip, _NAME)
    return LookText(text=text, what=problem)


def _block(declaration: str, moving: str, pose: Array, base: str) -> str:
    numbers = frame_line(moving, pose, base).removeprefix("FRAME ").partition(" (mm,deg) ")
    return f"REPEAT 1\n{declaration}\nMOVEL {numbers[0]} [{_SHARE}] (mm,deg) {numbers[2]}\nEND\n"
