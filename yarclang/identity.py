"""What steps do, as keys: equal where they do the same, wherever they stand in a text."""

from __future__ import annotations

import marshal
from collections.abc import Hashable
from typing import Any

from yarclang.hir import Array, FrameLink, JointDelta, JointGoal, Motion, PoseDelta, PoseGoal, Reading


def flat(*parts: Any) -> bytes:
    """Numbers, texts, bytes and tuples of them as one piece: hashed and compared at once, where a tuple asks each of its parts.

    Equal pieces say the same; the other way round not always (a numpy float isn't written as a float is), which costs a recollection and
    nothing else.
    """
    return marshal.dumps(parts, _WITHOUT_REFERENCES)


_WITHOUT_REFERENCES = 2
"""The version of the format that writes what parts say, not which objects they are."""


def key_of(step: Motion) -> bytes:
    """What a motion does and what it moves, by value: all of it but where it stands in a text."""
    goals = getattr(step, "waypoints", None) or (step.goal,)  # type: ignore[union-attr]
    timing, speed = step.timing, step.timing.speed
    via: Array | None = getattr(step, "via", None)
    return flat(
        type(step).__name__,
        tuple(map(_key_of_goal, goals)),
        None if via is None else via.tobytes(),
        step.profile,
        (timing.duration, timing.share, timing.ramp, None if speed is None else _key_of_reading(speed)),
        step.tolerance,
        None if step.blend is None else _key_of_reading(step.blend),
        _key_of_link(step.origin.tool),
    )


def _key_of_link(link: FrameLink | None) -> Hashable:
    """The frames from a moving one down to the flange."""
    if link is None:
        return None
    return link.name, link.parent_from_frame.tobytes(), _key_of_link(link.parent)


def _key_of_reading(reading: Reading) -> Hashable:
    return reading.length, reading.angle


def _key_of_goal(goal: JointGoal | JointDelta | PoseGoal | PoseDelta) -> Hashable:
    match goal:
        case JointGoal():
            return "joints", goal.q.tobytes()
        case JointDelta():
            return "delta", goal.dq.tobytes()
        case PoseGoal():
            near = None if goal.near is None else goal.near.tobytes()
            return "pose", goal.base_from_moving.tobytes(), goal.flange_from_moving.tobytes(), near
        case PoseDelta():
            parts = (goal.shift, goal.turn, goal.axes, goal.flange_from_moving)
            return "poses apart", goal.axes_on_flange, *(part.tobytes() for part in parts)
