"""Follow a program step by step: compute where the workpieces are before each step, and what the grippers
do.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import field, replace

import numpy as np

from yarclang.cell.model import Cell, Leaving, Parts, Touch
from yarclang.frozen import frozen
from yarclang.handling.allowing import Allowances, allowances
from yarclang.handling.grasp import Grasp, Parted, Whereabouts
from yarclang.handling.keeping import has_keeps, keeps_of
from yarclang.handling.parts import (
    arrive,
    close,
    either,
    first_parts,
    open_,
    remove,
    unlike,
)
from yarclang.handling.runs import BEFORE, NO_RUNS, Runs, runs_of
from yarclang.handling.surroundings import (
    INTO,
    NO_PAIRS,
    PRESSED,
    hand_is_clear,
    on_all_ways,
    supports,
    surroundings,
)
from yarclang.hir import Finish, Motion, NextPass, SetOutput, Step, Stop
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.robot.model import Array, Robot
from yarclang.ways import Turn, Ways


@frozen(eq=False)
class Handling:
    """The grippers and workpieces of a cell, and the steps of a program that uses them.

    Attributes:
        robot: the robot.
        cell: the cell around the robot, or None.
        steps: the program's steps.
        runs: the motions by which the robot approaches and leaves workpieces.
        allowances: the bodies that may touch during the motions because the program or the cell allows it.
    """

    robot: Robot
    cell: Cell | None
    steps: Sequence[Step]
    runs: Runs
    allowances: Allowances = field(default_factory=dict)

    @property
    def has_parts(self) -> bool:
        """True if the cell has any workpieces."""
        return self.cell is not None and bool(self.cell.parts)

    @property
    def is_needed(self) -> bool:
        """True if the cell differs from motion to motion: because of workpieces, bodies that may touch, or
        path constraints (KEEP).
        """
        return self.has_parts or bool(self.allowances) or has_keeps(self.steps)

    def first(self) -> Whereabouts:
        """Return where the workpieces are when the program starts."""
        return Whereabouts(Ways(first_parts(self.cell)))

    def before_motion(self, stand: Whereabouts, step: int) -> Whereabouts:
        """Return where the workpieces are during a motion. The next workpiece of a kind replaces one that was
        taken away.
        """
        if not stand.parts.expected:
            return stand
        return stand.moved(arrive(stand.parts, self.runs.leaves.get(step, frozenset())))

    def passed(self, stand: Whereabouts, step: int, q: Array | None) -> tuple[Whereabouts, Grasp | None]:
        """Carry out a step that doesn't move the robot.

        Args:
            stand: the places of the workpieces before the step.
            step: number of the step.
            q: the robot's joint positions (n,) [rad or m]; None if they aren't known, in which case grippers
                change nothing.

        Returns:
            The places of the workpieces after the step, and the grasp, if the step moves a gripper.
        """
        one = self.steps[step]
        if isinstance(one, Turn):
            wrong, parted = "", None

            def meet(first: Parts, other: Parts, where: Turn) -> Parts:
                nonlocal wrong, parted
                if isinstance(where, NextPass):
                    wrong = unlike(first, other)
                elif first.tools != other.tools:
                    on, off = (" or ".join(parts.tools) for parts in (first, other))
                    parted = Parted(where, (on, off))
                return either(first, other)

            ways = stand.ways.turned(one, meet)
            return Whereabouts(ways, wrong, parted), None
        if isinstance(one, SetOutput):
            removal = self.cell.removals.get(one.output.variable) if self.cell is not None else None
            if removal is not None and one.value == removal.value:
                return stand.moved(remove(stand.parts, removal)), None
            grasp = self._grasp(stand.parts, step, one, q)
            return (stand, None) if grasp is None else (stand.moved(grasp.after), grasp)
        return stand, None

    def _grasp(self, parts: Parts, step: int, one: SetOutput, q: Array | None) -> Grasp | None:
        if q is None or self.cell is None or one.output.variable not in self.cell.grips or not self.has_parts:
            return None
        return self.at_pose(parts, step, one.output.variable, one.value, flange_pose(self.robot, q))

    def at_pose(
        self, parts: Parts, step: int, variable: str, value: float, base_from_flange: Array
    ) -> Grasp | None:
        """Return the grasp of a gripper whose output becomes `value`, or None if the gripper doesn't move.

        Args:
            parts: where the workpieces are before.
            step: the step of the SET.
            variable: variable of the gripper's output.
            value: the new value.
            base_from_flange: (4, 4) pose of the flange.
        """
        if self.cell is None:
            return None
        flange, grip = base_from_flange, self.cell.grips[variable]
        closes = value == grip.value
        if closes:
            if variable in parts.closed:
                return None
            after, near = close(parts, variable, grip, flange, step)
            return Grasp(step, variable, grip, closes, flange, parts, after, near)
        if variable not in parts.closed and not parts.held(variable):
            return None
        return Grasp(step, variable, grip, closes, flange, parts, open_(parts, variable, flange))

    def touches(
        self,
        step: int,
        grasps: Callable[[int], Grasp | None],
        clear: Collection[tuple[int, int]] = (),
        coming: Sequence[Grasp] = (),
    ) -> tuple[Touch, ...]:
        """Return the bodies that may touch during a motion because it approaches or leaves a workpiece. If
        several branches of a WHEN lead to the motion, these are the bodies that may touch on every branch.

        Args:
            step: the motion's step.
            grasps: function that returns the grasp of a SET by its step; None if it isn't known.
            clear: pairs of SET and motion, by their steps. The gripper is away from the workpiece during
                these motions, and must not touch it.
            coming: grasps that the next lines of the session may make.
        """

        def of_set(number: int, *, leads_in: bool) -> tuple[Touch, ...]:
            is_clear = (number, step) in clear
            if number == BEFORE:
                left = (one for one in self._left if one.closes or not is_clear)
                return tuple(touch for one in left for touch in one.touches)
            if number == len(self.steps):
                return tuple(self._allowed([one for one in coming if not (one.closes and is_clear)]))
            grasp = grasps(number)
            if grasp is None or (is_clear and grasp.closes == leads_in):
                return ()
            return self._touches(grasp, leads_in=leads_in)

        return (
            *on_all_ways(of_set(one.to, leads_in=False) for one in self.runs.away.get(step, ())),
            *on_all_ways(of_set(one.to, leads_in=True) for one in self.runs.towards.get(step, ())),
        )

    @property
    def _left(self) -> tuple[Leaving, ...]:
        present = None if self.cell is None else self.cell.present
        return () if present is None else present.leaving

    def leaving(self, grasp: Grasp) -> Leaving:
        """Return the workpieces that a grasp has taken or put down, with the bodies that may touch until the
        gripper has moved away.
        """
        return Leaving(grasp.moved, grasp.closes, self._touches(grasp, leads_in=False))

    def coming(self, parts: Parts, base_from_flange: Array) -> tuple[Grasp, ...]:
        """Return the grasps that the next lines of a session may make at a flange pose (4, 4): close an open
        gripper, open a closed one.
        """
        present = None if self.cell is None else self.cell.present
        if self.cell is None or present is None or not present.goes_on:
            return ()
        at = len(self.steps)
        found = [
            self.at_pose(parts, at, variable, value, base_from_flange)
            for variable, grip in self.cell.grips.items()
            for value in (grip.value, grip.value + 1.0)
        ]
        return tuple(one for one in found if one is not None and one.moved)

    def _allowed(self, coming: Sequence[Grasp]) -> list[Touch]:
        """Return the bodies that may touch where the next line of a session may take or put down a workpiece.
        A workpiece must not be put down inside a body.
        """
        touches = [touch for one in coming for touch in self._touches(one, leads_in=True)]
        return [one for one in touches if one.other is None or one.least >= -INTO - PRESSED]

    def clear_of(
        self,
        grasp: Grasp,
        begins: Callable[[int], Array | None],
        ends: Callable[[int], Array | None],
        before: Mapping[int, Parts],
    ) -> set[tuple[int, int]]:
        """Find the straight motions to or from a SET during which the gripper is away from its workpiece.

        Search from the SET outwards for the nearest motion end at which the gripper is clear of the
        workpiece. The motions beyond that end are returned.

        Args:
            grasp: what the SET does.
            begins: function that returns where a motion begins (n,) [rad or m], by its step.
            ends: function that returns where a motion ends (n,) [rad or m], by its step.
            before: where the workpieces are during each motion, by its step.

        Returns:
            Pairs of the SET's step and a motion's step.
        """
        leave = begins if grasp.closes else ends
        return self._beyond(grasp.step, grasp.closes, grasp.moved, leave, before)

    def clear_of_left(
        self, ends: Callable[[int], Array | None], before: Mapping[int, Parts]
    ) -> set[tuple[int, int]]:
        """Find motions as `clear_of` does, but those by which the robot leaves workpieces that a gripper has
        put down just before the program starts.
        """
        found = (self._beyond(BEFORE, False, one.moved, ends, before) for one in self._left if not one.closes)
        return set().union(*found)

    def _beyond(
        self,
        number: int,
        closes: bool,
        moved: tuple[str, ...],
        leave: Callable[[int], Array | None],
        before: Mapping[int, Parts],
    ) -> set[tuple[int, int]]:
        runs = self.runs.towards if closes else self.runs.away
        found: set[tuple[int, int]] = set()

        def is_clear(step: int) -> bool:
            """Return True if the gripper is clear of the workpiece at the start of a motion to the SET, or at
            the end of a motion from the SET.
            """
            q = leave(step)
            if (number, step) in found:
                return True
            if self.cell is None or q is None or step not in before:
                return False
            return hand_is_clear(self.robot, self.cell, before[step], moved, q)

        for step in sorted(runs, reverse=closes):
            lead = next((one for one in runs[step] if one.to == number), None)
            if lead is not None and lead.between and all(map(is_clear, lead.between)):
                found.add((number, step))
        return found

    def _touches(self, grasp: Grasp, *, leads_in: bool) -> tuple[Touch, ...]:
        if grasp.closes == leads_in:
            # the bodies on the flange may touch the part, since the gripper encloses it at the SET
            return tuple(Touch(name, None, -np.inf) for name in grasp.moved)
        # if a part overlaps a body deeply when it is taken, the body doesn't carry the part: the two collide
        carry = (one for one in self.supports(grasp) if not grasp.closes or one.least >= -INTO)
        return tuple(Touch(one.part, one.other, one.least - PRESSED) for one in carry)

    def supports(self, grasp: Grasp) -> tuple[Touch, ...]:
        """Return the bodies near the workpieces of a grasp, with their distances [m]."""
        if self.cell is None:
            return ()
        carried = grasp.after if grasp.closes else grasp.before
        return supports(self.robot, self.cell, carried, grasp.variable, grasp.base_from_flange.tobytes())

    def foreseen(self, parts: Parts, step: int, base_from_flange: Array) -> tuple[Touch, ...]:
        """Return the bodies that may touch at the end of a motion, if a gripper closes or opens there.

        Args:
            parts: where the workpieces are.
            step: the motion's step.
            base_from_flange: (4, 4) pose of the flange at the end of the motion.
        """

        def of_set(at: int) -> tuple[Touch, ...]:
            if at == len(self.steps):
                return tuple(self._allowed(self.coming(parts, base_from_flange)))
            one = self.steps[at]
            if self.cell is None or not isinstance(one, SetOutput):
                return ()
            grasp = self.at_pose(parts, at, one.output.variable, one.value, base_from_flange)
            return () if grasp is None else self._touches(grasp, leads_in=True)

        return on_all_ways(of_set(one.to) for one in self.runs.towards.get(step, ()))

    def around(self, parts: Parts, touches: tuple[Touch, ...] = (), step: int | None = None) -> Cell | None:
        """Return the cell at one instant of the program, with its workpieces as bodies.

        Args:
            parts: where the workpieces are.
            touches: the bodies that may touch where a workpiece is taken or put down.
            step: the motion's step, for its allowed contacts and path constraints (KEEP); None outside of
                motions.
        """
        own = () if step is None else self.allowances.get(step, ())
        pairs = frozenset(one.pair for one in own) if own else NO_PAIRS
        keeps = () if step is None or step >= len(self.steps) else keeps_of(self.steps[step])
        return surroundings(self.cell, parts, touches, pairs, keeps)


@frozen(eq=False)
class Followed:
    """The result of following the workpieces through a program to its end.

    Attributes:
        before: where the workpieces are during each motion, by its step.
        changes: where the workpieces are from the beginning of each motion, and of each other step that moves
            them, in the order of the steps.
        grasps: what grippers do, by the step of the SET.
        removed: the names of the workpieces that machines remove, by the step of the SET.
        end: where the workpieces are at the end.
        cells: the cell during each motion, by its step.
        unlike: a workpiece whose place after a loop's first pass differs from its place before the pass, by
            the step at which the loop would begin again.
        parted: ends of branches that leave different tools on the flange, by the step.
        tools: the tools that are on the flange after each TOOL, by the step of the TOOL, if the robot's
            position is known at this step.
    """

    before: Mapping[int, Parts]
    changes: tuple[tuple[int, Parts], ...]
    grasps: Mapping[int, Grasp]
    removed: Mapping[int, tuple[str, ...]]
    end: Parts
    cells: Mapping[int, Cell | None]
    unlike: Mapping[int, str] = field(default_factory=dict)
    parted: Mapping[int, Parted] = field(default_factory=dict)
    tools: Mapping[int, tuple[str, ...]] = field(default_factory=dict)


def followed(
    handling: Handling, start: Array, ends: Mapping[int, Array], left_out: Collection[int] = ()
) -> Followed:
    """Follow the workpieces through a whole program.

    Args:
        handling: steps of the program, and the cell.
        start: the robot's first joint positions (n,) [rad or m].
        ends: where each motion ends (n,), by its step. In a partial plan some ends are missing. After a
            missing end, grippers do nothing until the next motion with an end.
        left_out: steps that aren't carried out. A WHEN can only be left out together with its ELSE and END;
            the remaining steps are then carried out one after the other.
    """
    stand = handling.first()
    before: dict[int, Parts] = {}
    changes: list[tuple[int, Parts]] = []
    removed: dict[int, tuple[str, ...]] = {}
    begins: dict[int, Array] = {}
    grasps: dict[int, Grasp] = {}
    changed: dict[int, str] = {}
    parted: dict[int, Parted] = {}
    tools: dict[int, tuple[str, ...]] = {}
    at = Ways[Array | None](start)
    for number, step in enumerate(handling.steps):
        if number in left_out:
            continue
        if isinstance(step, Stop) or (isinstance(step, Finish) and not at.open):
            break
        if isinstance(step, Motion):
            if number in ends:
                stand = handling.before_motion(stand, number)
                before[number] = stand.parts
                changes.append((number, stand.parts))
                if at.state is not None:
                    begins[number] = at.state
            at = replace(at, state=ends.get(number))
            continue
        if isinstance(step, Turn):
            at = at.turned(step, lambda _, last, __: last)
        had = stand.parts
        stand, grasp = handling.passed(stand, number, at.state)
        if stand.unlike:
            changed[number] = stand.unlike
        if stand.parted is not None:
            parted[number] = stand.parted
        if isinstance(step, SetOutput) and step.tool is not None and at.state is not None:
            tools[number] = stand.parts.tools
        if grasp is not None:
            grasps[number] = grasp
        elif isinstance(step, SetOutput) and had != stand.parts:
            left = set(stand.parts.items)
            removed[number] = tuple(dict.fromkeys(one.name for one in had.items if one not in left))
        if grasp is not None or had != stand.parts:
            changes.append((number, stand.parts))
    clear = handling.clear_of_left(ends.get, before)
    coming = () if at.state is None else handling.coming(stand.parts, flange_pose(handling.robot, at.state))
    for grasp in (*grasps.values(), *coming):
        clear |= handling.clear_of(grasp, begins.get, ends.get, before)
    cells = {
        step: handling.around(parts, handling.touches(step, grasps.get, clear, coming), step)
        for step, parts in before.items()
    }
    return Followed(before, tuple(changes), grasps, removed, stand.parts, cells, changed, parted, tools)


def handling_of(
    robot: Robot, cell: Cell | None, steps: Sequence[Step], allowed: Allowances | None = None
) -> Handling:
    """Return the data with which the workpieces of a program are followed.

    Args:
        robot: robot in the cell.
        cell: cell around the robot, or None.
        steps: steps of the program.
        allowed: the bodies that may touch, if the steps are a section of a program; None to derive them from
            the steps.
    """
    if allowed is None:
        allowed = allowances(cell, steps)
    has_parts = cell is not None and bool(cell.parts)
    if cell is None or not has_parts:
        return Handling(robot, cell, steps, NO_RUNS, allowed)
    present = cell.present
    leaves, goes_on = present is not None and bool(present.leaving), present is not None and present.goes_on
    runs = runs_of(steps, cell.grips, leaves=leaves, goes_on=goes_on)
    return Handling(robot, cell, steps, runs, allowed)


def flange_pose(robot: Robot, q: Array) -> Array:
    """Return the flange's pose at a joint position (n,): base_from_flange (4, 4)."""
    chain, at = robot.chain, np.array(q, dtype=np.float64)[None]
    own = chain.kinematics
    pose: Array = (tool_poses(chain, at, np.eye(4)) if own is None else own.flange(chain, at))[0]
    return pose
