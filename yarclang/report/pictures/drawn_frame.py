"""Choose the frame on the flange whose path a picture of a plan shows."""

from __future__ import annotations

from collections import Counter

from yarclang.frozen import frozen
from yarclang.hir import Array, Motion, Step
from yarclang.motion.plan import MotionPlan
from yarclang.robot.model import Robot


@frozen(eq=False)
class DrawnFrame:
    """A frame on the flange whose path is drawn.

    Attributes:
        name: name without braces.
        flange_from_frame: (4, 4).
    """

    name: str
    flange_from_frame: Array


def drawn_frame(plan: MotionPlan) -> DrawnFrame:
    """Return the frame whose path is drawn: the one that most motions of a plan move, or the first of several
    such frames. If all are joint motions, return {TCP}.
    """
    led = [found for motion in plan.motions if (found := led_by(plan.program.steps[motion.step])) is not None]
    if not led:
        name = _tool_name(plan.robot)
        return DrawnFrame(name, plan.robot.flange_from_frame[name])
    places = [frame.flange_from_frame.tobytes() for frame in led]
    return led[places.index(Counter(places).most_common(1)[0][0])]


def moving_frame(step: Step) -> Array | None:
    """Return the pose on the flange of the frame that a motion moves, as flange_from_moving (4, 4); None for
    a joint motion.
    """
    return step.flange_from_moving if isinstance(step, Motion) else None


def led_by(step: Step) -> DrawnFrame | None:
    """Return the frame that a motion moves, with its name; None for a joint motion, or a frame without a
    name.
    """
    frame = moving_frame(step)
    if frame is None or not isinstance(step, Motion) or step.origin.moving is None:
        return None
    return DrawnFrame(step.origin.moving.name, frame)


def _tool_name(robot: Robot) -> str:
    """Return TCP if the robot has this frame, otherwise its first frame on the flange; FLANGE if there is no
    other.
    """
    names = list(robot.flange_from_frame)
    return "TCP" if "TCP" in names else next((name for name in names if name != "FLANGE"), "FLANGE")
