"""The tool on the flange along the branches and loops of a program, computed by the judge itself."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from yarclang import hir
from yarclang.cell.model import RackTool
from yarclang.certify.read.ways import Standing
from yarclang.handling.walk import Handling, flange_pose
from yarclang.robot.model import Array
from yarclang.units import DEG

_BARRIERS: dict[type, str] = {
    hir.When: "when",
    hir.Else: "else",
    hir.EndWhen: "end",
    hir.Finish: "stop",
    hir.Loop: "loop",
    hir.NextPass: "next",
    hir.Exit: "exit",
    hir.EndLoop: "endloop",
}
_WIDEST = 0.5 * DEG
"""Largest angle between the flange and a tool's place in the rack at which the changer locks [rad]."""


def tools_again(handling: Handling, start: Array, ends: Mapping[int, Array]) -> dict[int, str]:
    """Return the tool on the flange during each motion, by the motion's step; an empty string for no tool.

    The tool follows from the values of the lock's output, the racks of the tools and the ends of the motions.
    The model of bodies that planner and judge share is not used.

    Args:
        handling: the cell and the steps, whose outputs are proved to be those of the text.
        start: (n,) the robot's first position [rad or m].
        ends: the end (n,) of each motion, by its step. Steps after a missing end are left out.
    """
    cell = handling.cell
    lock = None if cell is None else cell.lock
    if cell is None or lock is None or lock.grip is None:
        return {}
    racks = {part.body.name: part.rack for part in cell.parts if part.rack is not None}
    names = ["", *racks]
    on = handling.first().parts.tools
    tool_at: dict[int, str] = {}
    standing = Standing(np.array([names.index(on[0]) if on else 0, *start], dtype=np.float64))
    for number, step in enumerate(handling.steps):
        kind = _BARRIERS.get(type(step))
        if isinstance(step, hir.Stop):
            break
        if kind is not None:
            try:
                standing.pass_(kind)
            except ValueError:  # a section of a program may lack a WHEN
                break
        elif isinstance(step, hir.Motion):
            if number not in ends:
                break
            tool_at[number] = names[int(standing.at[0])]
            standing.at = np.append(standing.at[:1], ends[number])
        elif isinstance(step, hir.SetOutput) and step.output.variable == lock.variable:
            at = standing.at
            tool = names[int(at[0])]
            if step.value != lock.grip.value:
                tool = ""
            elif not tool:
                pose = flange_pose(handling.robot, at[1:])
                tool = next((name for name in names[1:] if _is_at(racks[name], pose)), "")
            standing.at = np.array([names.index(tool), *at[1:]])
    return tool_at


def _is_at(rack: RackTool, flange: Array) -> bool:
    """Return True if the flange (4, 4) is at a tool's place in the rack."""
    place = rack.place.transform
    # The difference of both orientations has the Frobenius norm 2 sqrt 2 sin(angle / 2).
    turned = float(np.linalg.norm(flange[:3, :3] - place[:3, :3])) / np.sqrt(2.0)
    near = float(np.linalg.norm(flange[:3, 3] - place[:3, 3])) <= rack.reach
    return near and turned <= 2.0 * np.sin(_WIDEST / 2.0)
