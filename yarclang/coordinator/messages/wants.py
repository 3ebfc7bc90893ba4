"""Targets of a live motion, which are sent again and again. The kind of a target is determined by the key of
its JSON object. The first target begins the motion.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from yarclang.coordinator.messages import replies
from yarclang.coordinator.messages.message import Number
from yarclang.coordinator.messages.orders import Order


class BeThere(Order[replies.Wanted]):
    """Follow these joint positions [deg or mm]; `rate` [per s] is estimated if it is missing."""

    key: ClassVar[str] = "joints"
    joints: Annotated[
        tuple[Number, ...], Field(max_length=64, description="a list of finite numbers, one per joint")
    ]
    rate: Annotated[
        tuple[Number, ...] | None, Field(max_length=64, description="a list of finite numbers, one per joint")
    ] = None


class HoldPose(Order[replies.Wanted]):
    """Follow this pose of the tool in {B}: x y z [mm], roll pitch yaw [deg]. If several joint positions reach
    the pose, the one nearest to the previous pose's is used.
    """

    key: ClassVar[str] = "pose"
    pose: Annotated[
        tuple[Number, ...],
        Field(
            min_length=6, max_length=6, description="six finite numbers: x y z in mm, roll pitch yaw in deg"
        ),
    ]


class MoveJoints(Order[replies.Wanted]):
    """Move joints with these velocities [deg/s or mm/s]."""

    key: ClassVar[str] = "velocity"
    velocity: Annotated[
        dict[str, Number],
        Field(min_length=1, max_length=64, description='an object of finite numbers, as {"J3": 5}'),
    ]


class MoveTool(Order[replies.Wanted]):
    """Move the tool with these velocities [mm/s along and deg/s about the axes], in the axes of {B} or of
    the tool.
    """

    key: ClassVar[str] = "twist"
    twist: Annotated[
        tuple[Number, ...],
        Field(
            min_length=6,
            max_length=6,
            description="six finite numbers: mm/s along x y z, deg/s about x y z",
        ),
    ]
    axes: Annotated[Literal["base", "tool"], Field(description='"base" or "tool"')] = "base"


class Finish(Order[replies.Wanted]):
    """Come to rest within the limits."""

    key: ClassVar[str] = "finish"
    finish: Annotated[Literal[True], Field(description="true, or absent")] = True


Want = BeThere | HoldPose | MoveJoints | MoveTool | Finish

KINDS: tuple[type[Order[Any]], ...] = (BeThere, HoldPose, MoveJoints, MoveTool, Finish)
"""All kinds of targets."""
