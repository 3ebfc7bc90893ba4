"""The lines of an OFFSET. They are planned and proved at run time, in a frame that is shifted by the values
of registers. No I/O.
"""

from __future__ import annotations

from yarclang.decisions import Shifted, shift_in_words
from yarclang.robot.model import Array
from yarclang.runtime.actions import PROGRAM_UNKNOWN, Replan, Replanned, Script
from yarclang.runtime.job import Job, Leg
from yarclang.runtime.notices import Planned
from yarclang.runtime.pmac.held import Held, title
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.searching import deeds
from yarclang.runtime.pmac.waiting import hold_with, obey_or_hold


def shifted_by(operation: Operation, job: Job, place: int, joints: Array, held: Held) -> Script[list[Job]]:
    """Have the first branch of an OFFSET planned with the present values of its registers. Set the OFFSET's
    flag to 1 if the branch can be carried out.

    If an OFFSET without an ELSE can't be carried out, the program holds and reports the reason. When a person
    resumes, the OFFSET is planned again with the values that the registers have then.

    Args:
        operation: state of the run, and access to the controller.
        job: a job with legs.
        place: number of the leg with the OFFSET at its end.
        joints: (n,) the robot's joint positions [rad or m].
        held: registers of the run; the flag is one of them.

    Returns:
        The jobs to stream instead of the legs of the branch; empty if the branch can't be carried out.

    Raises:
        Stopped: the run was stopped while the branch was planned, or during the hold.
    """
    barrier = job.legs[place].barrier
    assert barrier is not None
    assert barrier.offset is not None
    offset = barrier.offset
    held.registers[offset.flag] = 0
    while True:
        values = _values(offset, held)
        shift_text = shift_in_words(values, offset.registers)
        since = operation.now
        answer = yield from _planned(job, place, joints, values)
        yield from obey_or_hold(operation, job, f"at {title(barrier)}")
        if isinstance(answer, tuple):
            break
        refused = (
            f"{title(barrier)}: with {{{offset.frame}}} shifted by {shift_text} the motions aren't possible: "
            f"{answer or PROGRAM_UNKNOWN}"
        )
        if answer is None or not _has_no_else(job.legs, place):
            operation.remark(refused, warning=True)
            return []
        yield from hold_with(
            operation,
            job,
            barrier,
            held,
            f"{refused}; nothing has moved; try again with Enter or `yarc resume`, with the values that "
            "the registers have then",
        )
    held.registers[offset.flag] = 1
    for one in answer[:1]:  # all jobs are parts of one controller text: report it once
        operation.notices.append(Planned(operation.now, one.text, one.certificate, "offset"))
    operation.remark(
        f"{title(barrier)}: {{{offset.frame}}} is shifted by {shift_text}; its lines are planned and proved "
        f"there ({operation.now - since:.3f} s)"
    )
    return list(answer)


def _planned(
    job: Job, place: int, joints: Array, values: tuple[int, ...]
) -> Script[tuple[Job, ...] | str | None]:
    """Plan the first branch of an OFFSET and return its jobs. Return the reason (str) if it can't be carried
    out, or None if the program's source, which planning needs, isn't known.
    """
    barrier = job.legs[place].barrier
    assert barrier is not None
    assert barrier.offset is not None
    if answer := _out_of_range(job, barrier.offset, values):
        return answer
    legs = job.legs[place + 1 : _end_of_branch(job.legs, place)]
    first = next((leg.job for leg in legs if leg.job is not None and leg.job.commands), None)
    if first is None:
        return "it contains no motion"
    begins = job.offset + first.offset + first.commands[0].begins
    planned: Replanned | str | None = yield Replan(begins, joints, values)
    if not isinstance(planned, Replanned):
        return planned
    if [deeds(one) for one in planned.jobs] != [deeds(leg.job) for leg in legs if leg.job is not None]:
        return "the shift would change which commands are executed"
    return planned.jobs


def _has_no_else(legs: tuple[Leg, ...], place: int) -> bool:
    """Return True if the OFFSET has no ELSE in the program, so that the compiler has added a second branch
    that ends the program.
    """
    first, barrier = legs[place].barrier, legs[_end_of_branch(legs, place)].barrier
    assert first is not None
    return barrier is not None and (barrier.kind, barrier.word) == ("abort", first.word)


def _values(offset: Shifted, held: Held) -> tuple[int, ...]:
    """Return the values of the registers of an OFFSET; 0 for a direction without a register."""
    return tuple(held.registers[one] if one else 0 for one in offset.registers)


def _out_of_range(job: Job, offset: Shifted, values: tuple[int, ...]) -> str:
    """Return a sentence about the first register of an OFFSET whose value is out of its range; empty if all
    values are within their ranges.
    """
    ranges = {one.name: (one.low, one.high) for one in job.registers}
    for name, value in zip(offset.registers, values, strict=True):
        if name and not ranges[name][0] <= value <= ranges[name][1]:
            return f"{name} is {value}, but its range is {ranges[name][0]}..{ranges[name][1]}"
    return ""


def _end_of_branch(legs: tuple[Leg, ...], place: int) -> int:
    """Return the number of the leg after the first branch of an OFFSET. The barrier of the branch's last leg
    is the ELSE. The branch contains no other branch.
    """
    for number in range(place + 1, len(legs)):
        barrier = legs[number].barrier
        if barrier is not None and barrier.kind in ("else", "end"):
            return number + 1
    raise AssertionError("an OFFSET without an end was refused when the text was read")
