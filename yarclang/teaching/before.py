"""The pose of the flange before a line of a program, if it can be found without planning a motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from yarclang.diagnostics import has_errors
from yarclang.hir import (
    Array,
    Gap,
    JointDelta,
    JointGoal,
    MotionHead,
    PoseDelta,
    PoseGoal,
    Step,
)
from yarclang.pipeline.stages import check_program
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.runtime.actions import Trouble
from yarclang.source import SourceFile
from yarclang.syntax.ast import Block, Node
from yarclang.syntax.parse import parse
from yarclang.teaching.edits import Program
from yarclang.teaching.holding import Around
from yarclang.ways import line_to

_ENOUGH = 20_000
"""Number of evaluated lines in loops and SUBs after which no loop begins a further pass."""


def flange_before(around: Around, after: int) -> Array:
    """Return the pose of the flange, base_from_flange (4, 4) [m], after the first execution of a line.

    Args:
        around: the program.
        after: number of the line; 0 is the beginning of the program.

    Raises:
        Trouble: the pose isn't known without planning; the message is the reason.
    """
    text = text_before(around.program, after)
    source = SourceFile(around.program.source.name, text)
    module = parse(source).value
    assert module is not None  # parsing always returns a tree
    checked = check_program(module, replace(around.request, enough=_ENOUGH))
    found = [one for one in checked.diagnostics if one.code != "Y0104"]  # Y0104: a text without a command
    program = checked.value
    if has_errors(found) or program is None or program.is_cut:
        errors = [one for one in found if one.is_error]
        why = errors[0].message if errors else "its loops are too long"
        raise Trouble(
            f"the pose before this line isn't known: {why}",
            "correct that first, or teach a MOVEL, which works from any pose",
            "before",
        )
    found_pose: Array = _Walk(around, program.start).walked(program.steps)
    return found_pose


def text_before(program: Program, after: int) -> str:
    """Return the lines of a program up to a given line. A block that is open after this line is closed with
    END. The block is also changed so that it executes the branch with the line exactly once.

    Args:
        program: the program.
        after: number of the last line.

    Raises:
        Trouble: the line is in a SUB.
    """
    lines = [program.content(line) for line in range(1, after + 1)]
    open_blocks = 0
    for block in blocks_around(program.sketch.nodes, after):
        head, otherwise = block.head, block.otherwise_head
        word = head.name.name
        if word == "SUB":
            what = (
                f"line {after} is in the SUB of line {head.line}: where the robot is before depends on the "
                "CALL"
            )
            raise Trouble(what, "teach a MOVEL in a frame of the SUB, or teach outside of it", "before")
        open_blocks += 1
        values = [value.text for point in head.waypoints for value in point.values]
        name = values[0] if word == "REPEAT" and len(values) > 1 else ""
        lines[head.line - 1] = "LOOP" if word in ("LOOP", "WHILE") else f"REPEAT {name} 1"
        if otherwise is not None and otherwise.line <= after:
            for line in range(head.line + 1, otherwise.line + 1):
                lines[line - 1] = ""
    return "\n".join((*lines, *["END"] * open_blocks, ""))


def blocks_around(nodes: Iterable[Node], after: int) -> Iterable[Block]:
    """Yield the blocks that are open after a line, outermost first."""
    for node in nodes:
        if not isinstance(node, Block) or node.head.line > after:
            continue
        last = node.end.line - 1 if node.end else after
        if after <= last:
            yield node
            yield from blocks_around((*node.body, *(node.otherwise or ())), after)


class _Walk:
    """Tracks the flange's pose through the goals of a program's motions, without planning the motions. Joint
    positions are tracked as well, up to the first goal that is a pose.
    """

    def __init__(self, around: Around, start: Array) -> None:
        self._chain = around.robot.chain
        self._joints: Array | None = start
        self._flange = flange_poses(self._chain, start[None])[0]

    def walked(self, steps: Iterable[Step]) -> Array:
        """Return the pose of the flange, base_from_flange (4, 4) [m], after the given steps of a program."""
        for step in line_to(steps):
            self._step(step)
        return np.asarray(self._flange)

    def _step(self, step: Step) -> None:
        match step:
            case Gap():
                raise Trouble(
                    "the pose before this line isn't known: a line above can't be carried out",
                    "correct that line first",
                    "before",
                )
            case MotionHead():
                self._to(step.end)
            case _:
                pass

    def _to(self, goal: JointGoal | JointDelta | PoseGoal | PoseDelta) -> None:
        match goal:
            case JointGoal(q=q):
                self._stand(np.asarray(q))
            case JointDelta(dq=dq):
                if self._joints is None:
                    raise Trouble(
                        "the pose before this line isn't known: a DMOVEJ follows a motion to a pose",
                        "teach a MOVEL, which works from any pose",
                        "before",
                    )
                self._stand(self._joints + dq)
            case PoseGoal(base_from_moving=pose, flange_from_moving=tool):
                self._joints, self._flange = None, np.asarray(pose @ np.linalg.inv(tool))
            case PoseDelta():
                self._shift(goal)

    def _stand(self, joints: Array) -> None:
        self._joints, self._flange = joints, flange_poses(self._chain, joints[None])[0]

    def _shift(self, delta: PoseDelta) -> None:
        stands = self._flange @ delta.flange_from_moving
        axes = self._flange[:3, :3] @ delta.axes if delta.axes_on_flange else delta.axes
        moved = np.eye(4)
        moved[:3, 3] = stands[:3, 3] + axes @ delta.shift
        moved[:3, :3] = axes @ delta.turn @ axes.T @ stands[:3, :3]
        self._joints, self._flange = None, np.asarray(moved @ np.linalg.inv(delta.flange_from_moving))
