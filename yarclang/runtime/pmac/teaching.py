"""Storing of the robot's position for later runs, under a name that the program gives. No I/O."""

from __future__ import annotations

from typing import Literal

from yarclang.robot.model import Array
from yarclang.runtime.actions import Script, Teach, Told, Trouble
from yarclang.runtime.job import Barrier
from yarclang.runtime.pmac.held import title
from yarclang.runtime.pmac.operation import Operation

TEACHING: dict[str, Literal["joints", "pose"]] = {"JPOS": "joints", "LPOS": "pose"}
"""For each teaching command, the form in which it stores the robot's position."""


def teach(operation: Operation, barrier: Barrier, stands: Array) -> Script[None]:
    """Store the robot's present position for later runs. The robot stands still until the position is on the
    disk.

    Args:
        operation: state of the run, and access to the controller.
        barrier: the JPOS or LPOS that is carried out.
        stands: (n,) the robot's joint positions [rad or m].

    Raises:
        Trouble: the position can't be stored.
    """
    told = yield Teach(TEACHING[barrier.word], barrier.name, stands)
    if not isinstance(told, Told):
        what = f"{title(barrier)} can't store {barrier.name}: {told}"
        raise Trouble(what, "check the disk and its permissions, then start the program again", "Y1636")
    operation.remark(f"{title(barrier)}: {told.line}")
