"""Have the steps of an OFFSET planned and proved where registers have shifted its frame. No I/O."""

from __future__ import annotations

from yarclang.decisions import SHIFTS, Shifted
from yarclang.robot.model import Array
from yarclang.runtime.actions import Replan, Replanned, Script
from yarclang.runtime.job import Job, Leg
from yarclang.runtime.notices import Planned
from yarclang.runtime.pmac.held import Held, title
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.searching import deeds, held_meanwhile


def shifted_by(operation: Operation, job: Job, place: int, joints: Array, held: Held) -> Script[list[Job]]:
    """Have the first branch of an OFFSET planned, and set its flag: 1 if it can be carried out.

    Args:
        operation: the run.
        job: with legs.
        place: of the leg with the OFFSET at its end.
        joints: (n,) where the robot stands [rad or m].
        held: the registers; receives the flag.

    Returns:
        The jobs to stream instead of the legs of the branch; empty if it can't be carried out.

    Raises:
        Stopped: the run was stopped meanwhile.
    """
    barrier = job.legs[place].barrier
    assert barrier is not None
    assert barrier.offset is not None
    offset = barrier.offset
    held.registers[offset.flag] = 0
    values = tuple(held.registers[one] if one else 0 for one in offset.registers)
    said = _in_words(offset, values)
    legs = job.legs[place + 1 : _end_of_branch(job.legs, place)]
    answer = _out_of_range(job, offset, values)
    since = operation.now
    first = next((leg.job for leg in legs if leg.job is not None and leg.job.commands), None)
    if not answer and first is None:
        answer = "nothing moves in it"
    made: list[Job] = []
    if not answer and first is not None:
        begins = job.offset + first.offset + first.commands[0].begins
        found = yield Replan(begins, joints, values)
        if not isinstance(found, Replanned):
            answer = str(found)
        elif [deeds(one) for one in found.jobs] != [deeds(leg.job) for leg in legs if leg.job is not None]:
            answer = "other commands would move, set or wait there than without a shift"
        else:
            made = list(found.jobs)
    yield from held_meanwhile(operation, f"at {title(barrier)}")
    if answer:
        refused = f"{title(barrier)}: with {{{offset.frame}}} shifted by {said} it can't be done: {answer}"
        operation.remark(refused, warning=True)
        return []
    held.registers[offset.flag] = 1
    for one in made[:1]:  # all of them are pieces of one text
        operation.notices.append(Planned(operation.now, one.text, one.certificate, "offset"))
    operation.remark(
        f"{title(barrier)}: {{{offset.frame}}} is shifted by {said}; its lines are planned and proved "
        f"there ({operation.now - since:.3f} s)"
    )
    return made


def _out_of_range(job: Job, offset: Shifted, values: tuple[int, ...]) -> str:
    """Return the register that isn't in its range; empty if all are."""
    ranges = {one.name: (one.low, one.high) for one in job.registers}
    for name, value in zip(offset.registers, values, strict=True):
        if name and not ranges[name][0] <= value <= ranges[name][1]:
            return f"{name} is {value}, and its range is {ranges[name][0]}..{ranges[name][1]}"
    return ""


def _in_words(offset: Shifted, values: tuple[int, ...]) -> str:
    """Return a shift in words: `X 12.50 mm, RZ -3.00 deg`."""
    return ", ".join(
        f"{axis} {value / 100:.2f} {'deg' if axis == 'RZ' else 'mm'}"
        for axis, value, name in zip(SHIFTS, values, offset.registers, strict=True)
        if name
    )


def _end_of_branch(legs: tuple[Leg, ...], place: int) -> int:
    """Return the number after the last leg of the branch, whose barrier is its ELSE; no branch is in it."""
    for number in range(place + 1, len(legs)):
        barrier = legs[number].barrier
        if barrier is not None and barrier.kind in ("else", "end"):
            return number + 1
    raise AssertionError("an OFFSET without an end was refused when the text was read")
