"""The places of the cells' parts (workpieces and tools) between the actions of a coordinator. No I/O.

Each program, line and jog begins with the parts in the places in which the previous action has left them.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce
from pathlib import Path

from yarclang.cell.model import Cell, Parts, Present
from yarclang.coordinator.carried_out import CarriedOut, carried_out
from yarclang.handling.parts import either, first_parts, remove
from yarclang.handling.present import are_same, beside, is_same, on_cell, present_after, presently
from yarclang.handling.walk import Handling, flange_pose, followed, handling_of
from yarclang.hir import Motion, SetOutput, Step
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.cells import file_of
from yarclang.pipeline.parts import ends_of
from yarclang.robot.actuation import to_counts
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.job import Job
from yarclang.runtime.outcome import Ended
from yarclang.ways import Turn

ELSEWHERE = "Y1620"
"""Code of the finding for an action that is refused because the parts aren't in the places that the proof
assumes, or their places are unknown.
"""

_COUNTS = 1.0
"""Largest difference of two positions that count as equal [counts]."""


@dataclass(frozen=True, slots=True, eq=False)
class Known:
    """What is known about the places of a cell's parts.

    `cell` is the cell as read from its file; `present` has the places of the parts of this cell. `stands`
    (n,) is the position at which the robot rested when the places were stored [rad or m]; None: not known.
    `doubt` is the reason why the places are no longer known; empty: they are known.
    """

    cell: Cell
    present: Present
    stands: Array | None = None
    doubt: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Performed:
    """The steps of a plan that a job carries out.

    `begin` is the number of the first step, `end` the number after the last step. `program` is the job of the
    whole program. `assumed` has the places of parts before the first step, as assumed in the proof; they are
    used if no places are stored for the cell.
    """

    plan: MotionPlan
    begin: int
    end: int
    program: Job
    assumed: Parts | None


class KeptParts:
    """Places of the parts in each cell, as known from the coordinator's actions or declared by users.

    Args:
        robot: the robot that carries the parts.
    """

    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._known: dict[Path, Known] = {}

    # reading

    @property
    def all(self) -> tuple[Known, ...]:
        """Return the stored places of all cells. If two calls return equal tuples, nothing has changed
        between the calls.
        """
        return tuple(self._known.values())

    def known(self, cell: Cell) -> Known | None:
        """Return the places of a cell's parts; None if nothing is known beyond the cell's file."""
        found = self._known.get(file_of_cell(cell)) if cell.parts else None
        if found is None or found.cell.parts == cell.parts:
            return found
        return replace(found, cell=cell, present=on_cell(found.present, found.cell, cell))

    def of_file(self, file: Path) -> Known | None:
        """Return the places of the parts of the cell with this file; None if the parts are where the file
        places them.
        """
        return self._known.get(file_of(file))

    def now(self, cell: Cell, start: Array) -> Cell | None:
        """Return a cell with its parts at their present places. Return None if no places are stored: then the
        parts are in the places that the cell's file gives.

        Args:
            cell: the cell.
            start: (n,) start of the program [rad or m].
        """
        known = self.known(cell)
        if known is None:
            return None
        present = self._at(known, start)
        return cell if present == Present(first_parts(cell)) else presently(cell, present)

    def now_for_lines(self, cell: Cell, start: Array) -> Cell:
        """Return a cell with its parts at their present places, for planning lines of a session. The returned
        cell allows for later lines that open or close grippers.

        Args:
            cell: the cell.
            start: (n,) joint positions at which the lines begin [rad or m].

        Raises:
            Trouble: the places of parts are unknown.
        """
        known = self.known(cell) or Known(cell, Present(first_parts(cell)))
        check_sure(known)
        return presently(cell, replace(self._at(known, start), goes_on=True))

    def _at(self, places: Known, start: Array) -> Present:
        """Return the places of the parts for a program that begins at the joint positions `start`.

        A gripper is allowed to touch a part that it has just taken or put down. If the robot has moved since,
        this is no longer allowed.
        """
        stands = places.stands
        if places.present.leaving and (stands is None or not self._is_there(start, stands)):
            return replace(places.present, leaving=())
        return places.present

    def _is_there(self, item: Array, other: Array) -> bool:
        return bool((abs(to_counts(self._robot, item) - to_counts(self._robot, other)) <= _COUNTS).all())

    def check(self, cell: Cell | None, assumed: Parts | None) -> None:
        """Check that the parts of a cell are in the places that a proof has assumed.

        Raises:
            Trouble: the parts are elsewhere, or their places are unknown.
        """
        places = None if cell is None or assumed is None else self.known(cell)
        if places is None or assumed is None:
            return
        check_sure(places)
        if not are_same(places.present.parts, assumed):
            moved = _moved(places.present.parts, assumed)
            raise Trouble(
                f"{moved} isn't at the place for which this was proved",
                "load it again, or correct the places of the parts (.parts)",
                ELSEWHERE,
            )

    # changing

    def say(self, places: Known) -> None:
        """Store the places of parts that a user has declared."""
        present = beside(self._robot, places.cell, places.present, places.stands)
        if present == Present(first_parts(places.cell)):
            self._known.pop(file_of_cell(places.cell), None)  # the parts are where the file places them
        else:
            self._known[file_of_cell(places.cell)] = replace(places, present=present, doubt="")

    def doubt(self, cell: Cell | None, reason: str) -> None:
        """Record that the places of a cell's parts are unknown from now on, and the reason."""
        if cell is not None and cell.parts:
            known = self.known(cell) or Known(cell, Present(first_parts(cell)))
            self._known[file_of_cell(cell)] = replace(known, doubt=reason)

    def doubt_all(self, reason: str) -> None:
        """Record for all cells with stored places that the places of their parts are unknown from now on."""
        for file, known in tuple(self._known.items()):
            self._known[file] = replace(known, doubt=reason)

    def stands(self, q: Array | None) -> None:
        """Record the robot's position (n,) [rad or m] after a motion that moves no parts; None: unknown."""
        for file, known in tuple(self._known.items()):
            if known.present.leaving:
                present = beside(self._robot, known.cell, known.present, q)
                self._known[file] = replace(known, present=present, stands=q)

    def set(self, cell: Cell | None, variable: str, value: float, q: Array) -> None:
        """Record that an output was set, and how this has changed the places of a cell's parts.

        Args:
            cell: the cell; None: there is none.
            variable: controller variable of the output.
            value: value of the output.
            q: position of the robot at that time (n,) [rad or m].
        """
        if cell is None or not cell.parts:
            return
        known = self.known(cell) or Known(cell, Present(first_parts(cell)))
        self._known[file_of_cell(cell)] = self._after_outputs(known, {variable: value}, q)

    def performed(self, performed: Performed, ended: Ended, outputs: Mapping[str, float]) -> None:
        """Record the places of the parts after a job that was carried out completely or in part.

        Args:
            performed: steps of the job.
            ended: outcome of the job.
            outputs: present values of the outputs of grippers and machines, without those that couldn't be
                read.
        """
        plan, given = performed.plan, performed.plan.program.cell
        assert given is not None, "parts aren't tracked in a program without a cell"
        cell = replace(given, present=None)
        places = self.known(cell)
        if places is None:
            places = Known(cell, Present(performed.assumed or first_parts(cell)))
        start = _start(plan, performed.begin)
        cell = presently(cell, replace(self._at(places, start), goes_on=False))
        handling = handling_of(self._robot, cell, plan.program.steps[performed.begin : performed.end])
        done = carried_out(plan, performed.begin, performed.end, performed.program, ended)
        safe = dict(performed.program.outputs)
        q = performed.program.end if ended.well and performed.end == len(plan.program.steps) else ended.joints
        present = self._followed(
            handling, performed, done, start, q, {k: v for k, v in outputs.items() if k not in safe}
        )
        learned = Known(places.cell, present, q, places.doubt)
        if safe and q is None and any(one in (*cell.grips, *cell.removals) for one in safe):
            learned = replace(
                learned,
                doubt=f"{performed.program.name} was ended, and its outputs were set to safe values at "
                "an unknown position",
            )
        elif safe and q is not None:
            learned = self._after_outputs(learned, safe, q)
        self._known[file_of_cell(cell)] = learned

    def _followed(
        self,
        handling: Handling,
        performed: Performed,
        carried_out: CarriedOut,
        start: Array,
        q: Array | None,
        outputs: Mapping[str, float],
    ) -> Present:
        """Return the places of the parts after the steps that were carried out.

        The steps `carried_out.perhaps` were carried out up to an unknown step. The places are computed for
        each possibility that agrees with the outputs, and the result contains all of these places.

        Args:
            handling: grippers and parts of the cell, and the steps that use them.
            performed: the steps of the plan that the job carries out.
            carried_out: steps that were certainly carried out, and steps that may have been.
            start: (n,) position of the robot before the first step [rad or m].
            q: (n,) present position of the robot [rad or m]; None: unknown.
            outputs: present values of outputs, by their variables.
        """
        cell, steps = handling.cell, handling.steps
        ends = {step - performed.begin: at for step, at in ends_of(performed.plan).items()}
        moving = () if cell is None else (*cell.grips, *cell.removals)
        surely = {at - performed.begin for at in carried_out.surely}
        perhaps = [
            at - performed.begin
            for at in carried_out.perhaps
            if _output(steps[at - performed.begin]) in moving
        ]
        possible: list[Present] = []
        for count in range(len(perhaps) + 1):
            # If the first `count` SETs in `perhaps` were carried out, so were all motions before the last of
            # these SETs.
            more = range(max(surely, default=-1) + 1, perhaps[count - 1] + 1 if count else 0)
            chosen = surely | {at for at in more if isinstance(steps[at], Motion) or at in perhaps}
            if perhaps and not _agrees(steps, chosen, outputs):
                continue
            left_out = {at for at, one in enumerate(steps) if at not in chosen or isinstance(one, Turn)}
            walked = followed(handling, start, ends, left_out)
            possible.append(present_after(handling, walked, q))
        if not possible:  # no possibility agrees: something else has set an output, so ignore the outputs
            return self._followed(handling, performed, carried_out, start, q, {})
        leaving = tuple(dict.fromkeys(one for each in possible for one in each.leaving))
        return Present(reduce(either, (one.parts for one in possible)), leaving)

    def _after_outputs(self, places: Known, outputs: Mapping[str, float], q: Array) -> Known:
        """Return the places of the parts after outputs were set while the robot stands at `q` (n,) [rad or
        m].
        """
        handling = handling_of(self._robot, presently(places.cell, places.present), ())
        present = places.present
        for variable, value in outputs.items():
            grip, removal = places.cell.grips.get(variable), places.cell.removals.get(variable)
            if grip is not None:
                grasp = handling.at_pose(present.parts, 0, variable, value, flange_pose(self._robot, q))
                if grasp is not None:
                    more = (handling.leaving(grasp),) if grasp.moved else ()
                    present = Present(grasp.after, (*present.leaving, *more))
            if removal is not None and value == removal.value:
                present = replace(present, parts=remove(present.parts, removal))
        return replace(places, present=beside(self._robot, places.cell, present, q), stands=q)


def _moved(parts: Parts, other: Parts) -> str:
    """Return the names of the parts whose places differ between two states; "a gripper" if only the state of
    a gripper differs.
    """
    pairs = ((parts, other), (other, parts))
    names = [
        item.name
        for here, there in pairs
        for item in here.items
        if not any(is_same(item, each) for each in there.items)
    ]
    return ", ".join(list(dict.fromkeys(names))[:4]) or "a gripper"


def file_of_cell(cell: Cell) -> Path:
    """Return the file of a cell."""
    return file_of(Path(cell.source.name))


def _start(plan: MotionPlan, begin: int) -> Array:
    """Return the position of the robot (n,) [rad or m] before the step `begin` of a plan."""
    if begin == 0 or not plan.motions:
        return plan.program.start
    # The robot moves only in motions. So before the step, it stands at the start of the next motion.
    following = next((motion for motion in plan.motions if motion.step >= begin), None)
    position: Array = plan.motions[-1].waypoints[-1] if following is None else following.curve.points[0]
    return position


def _output(step: Step) -> str | None:
    return step.output.variable if isinstance(step, SetOutput) else None


def _agrees(steps: Sequence[Step], chosen: Collection[int], outputs: Mapping[str, float]) -> bool:
    """Return True if all known outputs have the values to which the chosen steps have set them."""
    values = {
        step.output.variable: step.value
        for at, step in enumerate(steps)
        if at in chosen and isinstance(step, SetOutput)
    }
    return all(outputs.get(variable, value) == value for variable, value in values.items())


def check_sure(places: Known) -> None:
    """Check that the places of parts are known.

    Raises:
        Trouble: the places aren't known.
    """
    if places.doubt:
        raise Trouble(
            f"the places of the cell's parts are unknown: {places.doubt}",
            "enter their places with .parts",
            ELSEWHERE,
        )
