"""The parts of a cell through a program, for people: where they are from each step on, and what each SET does to them."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from yarclang.cell.model import Cell, Parts, Touch
from yarclang.frozen import frozen
from yarclang.handling.grasp import Grasp
from yarclang.handling.walk import Followed, Handling, followed, handling_of
from yarclang.hir import Program
from yarclang.motion.curve import Curve
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.executed import Executed
from yarclang.robot.model import Array, Robot


@frozen(eq=False)
class State:
    """Where the parts are from the beginning of step `step` on (-1: before the program), and which bodies may touch then. `is_motion` is True if the step moves the robot."""

    step: int
    parts: Parts
    is_motion: bool = False
    touches: tuple[Touch, ...] = ()


@frozen(eq=False)
class Carried:
    """The parts through a program.

    Attributes:
        handling: the program's steps, with the grippers and parts of its cell.
        states: in the order of the steps; the first one is before the program.
        grasps: what grippers do, by the step of the SET.
        removed: the names of the parts that machines remove, by the step of the SET.
        names: the names of the parts that grippers hold during each motion, by its step.
    """

    handling: Handling
    states: tuple[State, ...]
    grasps: Mapping[int, Grasp]
    removed: Mapping[int, tuple[str, ...]]
    names: Mapping[int, tuple[str, ...]]

    def cell_of(self, state: State) -> Cell | None:
        """Return the cell with the parts where they are in a state."""
        return self.handling.around(state.parts, state.touches)

    def deeds(self, step: int) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """Return what a SET does to parts: verb and names, such as ("takes", ("BOX 3",))."""
        if step in self.removed:
            return (("removes", self.removed[step]),)
        grasp = self.grasps.get(step)
        if grasp is None or not grasp.moved:
            return ()
        return (("takes" if grasp.closes else "puts down", grasp.moved),)


def carried_parts(
    robot: Robot, program: Program, start: Array, ends: Mapping[int, Array], left_out: Collection[int] = ()
) -> Carried | None:
    """Follow the parts through a program.

    Args:
        robot: whose flange carries them.
        program: its steps, and its cell.
        start: where the robot stands at first (n,) [rad or m].
        ends: where each motion ends (n,) [rad or m], by its step; motions that can't be planned are missing.
        left_out: steps that aren't carried out. With a WHEN among them its ELSE and END must be too: what is left is then carried out one after the other.

    Returns:
        None if the cell has no parts.
    """
    handling = handling_of(robot, program.cell, program.steps)
    if not handling.is_needed:
        return None
    found = followed(handling, start, ends, left_out)
    motions = found.before
    states = [State(-1, handling.first().parts)]
    states += [State(step, parts, step in motions) for step, parts in found.changes]
    names = {step: tuple(item.name for item in parts.held()) for step, parts in motions.items()}
    return Carried(handling, _touching(states, found), found.grasps, found.removed, names)


def _touching(states: list[State], followed: Followed) -> tuple[State, ...]:
    """Return the states with what may touch: on motions as the certificate has it, and at rest as on the motion beside it, up to the SET that moves a gripper."""
    cells = {step: cell for step, cell in followed.cells.items() if cell is not None}
    motions, grasps = {step: cell.touches for step, cell in cells.items()}, followed.grasps
    found: list[State] = []
    for at, one in enumerate(states):
        touches = motions.get(one.step, ()) if one.is_motion else _beside(states, at, motions, grasps)
        found.append(State(one.step, one.parts, one.is_motion, touches))
    return tuple(found)


def _beside(
    states: list[State], at: int, motions: Mapping[int, tuple[Touch, ...]], grasps: Mapping[int, Grasp]
) -> tuple[Touch, ...]:
    """Return what may touch while the robot stands in a state: what may on the motion before it or, after a gripper has moved, on the next one."""
    for here in range(at, -1, -1):
        if states[here].is_motion:
            return motions[states[here].step]
        if states[here].step in grasps:
            break
    for here in range(at + 1, len(states)):
        if states[here].is_motion:
            return motions[states[here].step]
        if states[here].step in grasps:
            break
    return ()


def carried_in_plan(plan: MotionPlan) -> Carried | None:
    """Follow the parts through a program as it is planned; None if its cell has none."""
    if not _has_parts(plan.program):
        return None
    ends = {motion.step: end_of(motion.curve) for motion in plan.motions}
    return carried_parts(plan.robot, plan.program, plan.program.start, ends)


def _has_parts(program: Program) -> bool:
    return program.cell is not None and bool(program.cell.parts)


def end_of(curve: Curve) -> Array:
    """Return where a curve ends (n,) [rad or m]."""
    end: Array = curve.sample(np.array([curve.duration]))[0][0]
    return end


def carried_in_text(
    does: Executed, program: Program | None, left_out: Collection[int] = ()
) -> Carried | None:
    """Follow the parts through a controller text.

    Args:
        does: what the text does.
        program: the program that it was made from; None if that isn't known.
        left_out: steps of the program that aren't carried out, as of `carried_parts`.

    Returns:
        None if the program isn't known, or its cell has no parts.
    """
    if program is None or not _has_parts(program):
        return None
    ends = {act.step: end_of(act.curve) for act in does.acts if act.curve is not None}
    return carried_parts(does.robot, program, does.start, ends, left_out)


def begins_in_text(does: Executed, steps: int, *, counts_dwells: bool = True) -> tuple[float, ...]:
    """Return when each step of a program begins in its text [s], with the ways of a WHEN one after the other. A step of which the text has nothing begins with the next one.

    Args:
        does: what the text does.
        steps: how many steps the program has.
        counts_dwells: True if dwells take time.
    """
    begins: list[float] = []
    now = 0.0
    for act in does.acts:
        while len(begins) <= min(act.step, steps - 1):
            begins.append(now)
        if counts_dwells or act.curve is not None:
            now += act.duration
    return (*begins, *([now] * (steps - len(begins))))
