"""Compute, for display, where the parts of a cell are at each step of a program, and what each SET of a
gripper does to them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from yarclang.cell.model import Cell, Parts, Touch
from yarclang.frozen import frozen
from yarclang.handling.allowing import allowances_of
from yarclang.handling.grasp import Grasp
from yarclang.handling.surroundings import NO_PAIRS, surroundings
from yarclang.handling.walk import Followed, Handling, followed, handling_of
from yarclang.hir import Program
from yarclang.motion.curve import Curve
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.executed import Executed
from yarclang.robot.model import Array, Robot


@frozen(eq=False)
class State:
    """The places of a cell's parts at the beginning of a step. These places hold until the step of the next
    state.

    Attributes:
        step: number of the step; -1 before the program.
        parts: parts of the cell, with their positions.
        is_motion: True if the step moves the robot.
        touches: pairs of bodies that may touch where a part is taken or put down.
        allowed: names of the pairs of bodies that may touch because the program or the cell allows it.
    """

    step: int
    parts: Parts
    is_motion: bool = False
    touches: tuple[Touch, ...] = ()
    allowed: frozenset[tuple[str, str]] = NO_PAIRS


@frozen(eq=False)
class Carried:
    """The places of a cell's parts throughout a program, and the actions that change them.

    Attributes:
        handling: the program's steps, with the grippers and parts of its cell.
        states: positions of the parts in the order of the steps; the first state is before the program.
        grasps: actions of grippers, by the step of the SET.
        removed: names of the parts that machines remove, by the step of the SET.
        names: names of the parts that grippers hold during each motion, by its step.
    """

    handling: Handling
    states: tuple[State, ...]
    grasps: Mapping[int, Grasp]
    removed: Mapping[int, tuple[str, ...]]
    names: Mapping[int, tuple[str, ...]]

    def cell_of(self, state: State) -> Cell | None:
        """Return the cell with its parts where they are in a given state."""
        return surroundings(self.handling.cell, state.parts, state.touches, state.allowed)

    def deeds(self, step: int) -> tuple[tuple[str, tuple[str, ...]], ...]:
        """Return what a SET does to parts: verbs, each with the names of the parts, such as ("takes",
        ("BOX 3",)).
        """
        if step in self.removed:
            return (("removes", self.removed[step]),)
        grasp = self.grasps.get(step)
        if grasp is None or not grasp.moved:
            return ()
        return (("takes" if grasp.closes else "puts down", grasp.moved),)


def carried_parts(
    robot: Robot, program: Program, start: Array, ends: Mapping[int, Array], left_out: Collection[int] = ()
) -> Carried | None:
    """Follow the parts of a cell through a program.

    Args:
        robot: robot whose flange carries the parts.
        program: the program, with its cell.
        start: (n,) joint positions at the start [rad or m].
        ends: (n,) end of each motion [rad or m], by its step; motions that can't be planned are missing.
        left_out: steps that aren't executed. A WHEN can only be left out together with its ELSE and END. The
            remaining steps are executed one after the other.

    Returns:
        None if the cell has no parts, and no bodies may touch during any motion.
    """
    handling = handling_of(robot, program.cell, program.steps)
    if not handling.is_needed:
        return None
    handled = followed(handling, start, ends, left_out)
    motions = handled.before
    states = [State(-1, handling.first().parts)]
    states += [State(step, parts, step in motions) for step, parts in handled.changes]
    names = {step: tuple(item.name for item in parts.held()) for step, parts in motions.items()}
    return Carried(handling, _touching(states, handled), handled.grasps, handled.removed, names)


def _touching(states: list[State], followed: Followed) -> tuple[State, ...]:
    """Add to each state the pairs of bodies that may touch. For a motion, these are the pairs in its
    certificate. For a state at rest, these are the pairs of the previous motion or, if a gripper acts between
    that motion and the state, of the next motion.
    """
    motions = {step: _may_touch(cell) for step, cell in followed.cells.items()}
    states_found: list[State] = []
    for at, state in enumerate(states):
        may_touch = (
            motions.get(state.step, _NOTHING)
            if state.is_motion
            else _beside(states, at, motions, followed.grasps)
        )
        states_found.append(State(state.step, state.parts, state.is_motion, *may_touch))
    return tuple(states_found)


_MayTouch = tuple[tuple[Touch, ...], frozenset[tuple[str, str]]]
_NOTHING: _MayTouch = ((), NO_PAIRS)


def _may_touch(cell: Cell | None) -> _MayTouch:
    return _NOTHING if cell is None else (cell.touches, cell.allowed)


def _beside(
    states: list[State], at: int, motions: Mapping[int, _MayTouch], grasps: Mapping[int, Grasp]
) -> _MayTouch:
    """Return the pairs of bodies that may touch while the robot rests: the pairs of the previous motion, or
    of the next motion if a gripper has taken or put down a part since the previous one.
    """
    for later in range(at, -1, -1):
        if states[later].is_motion:
            return motions[states[later].step]
        if states[later].step in grasps:
            break
    for later in range(at + 1, len(states)):
        if states[later].is_motion:
            return motions[states[later].step]
        if states[later].step in grasps:
            break
    return _NOTHING


def carried_in_plan(plan: MotionPlan) -> Carried | None:
    """Follow the parts of a cell through a planned program. Return None if the cell has no parts and the
    program allows no bodies to touch.
    """
    if not _is_needed(plan.program):
        return None
    ends = {motion.step: end_of(motion.curve) for motion in plan.motions}
    return carried_parts(plan.robot, plan.program, plan.program.start, ends)


def _is_needed(program: Program) -> bool:
    return (program.cell is not None and bool(program.cell.parts)) or bool(allowances_of(program))


def end_of(curve: Curve) -> Array:
    """Return the joint position at the end of a curve (n,) [rad or m]."""
    end: Array = curve.sample(np.array([curve.duration]))[0][0]
    return end


def carried_in_text(
    does: Executed, program: Program | None, left_out: Collection[int] = ()
) -> Carried | None:
    """Follow the parts of a cell through a controller text.

    Args:
        does: the actions of the text.
        program: program from which the text was compiled; None if unknown.
        left_out: steps of the program that aren't executed, as for `carried_parts`.

    Returns:
        None if the program is unknown, or its cell has no parts and no bodies may touch.
    """
    if program is None or not _is_needed(program):
        return None
    ends = {act.step: end_of(act.curve) for act in does.acts if act.curve is not None}
    return carried_parts(does.robot, program, does.start, ends, left_out)


def begins_in_text(does: Executed, steps: int, *, counts_dwells: bool = True) -> tuple[float, ...]:
    """Return the time in a controller text at which each step of its program begins [s]. The branches of a
    WHEN follow one after the other. A step without lines in the text begins with the next step that has
    lines.

    Args:
        does: the actions of the text.
        steps: number of the program's steps.
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
