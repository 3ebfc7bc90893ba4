"""What follows a search (a motion that an input ends): it is planned and proved from the position at which
the search has ended. No I/O.
"""

from __future__ import annotations

from yarclang.robot.model import Array
from yarclang.runtime.actions import PROGRAM_UNKNOWN, Replan, Replanned, Script, Trouble
from yarclang.runtime.job import Job, Leg
from yarclang.runtime.notices import Planned
from yarclang.runtime.pmac.assigning import keep
from yarclang.runtime.pmac.held import Held, title
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.waiting import obey_or_hold
from yarclang.units import MM

_STEP = 0.01
"""Unit of a register that gets the distance covered by a search [mm]."""


def found_at(operation: Operation, job: Job, place: int, joints: Array, held: Held) -> Script[list[Job]]:
    """Store the distance covered by a search in the search's register, and have the next steps planned from
    the robot's position.

    Args:
        operation: state of the run, and access to the controller.
        job: a job with legs.
        place: number of the leg that the input has ended.
        joints: (n,) the robot's joint positions [rad or m].
        held: registers of the run, which receive the results of the search.

    Returns:
        The jobs to stream instead of the next legs, up to the first leg whose end position doesn't depend on
        the search.

    Raises:
        Trouble: the next steps can't be proved from here, or the distance is out of its register's range.
    """
    leg = job.legs[place]
    assert leg.job is not None
    search, barrier = leg.job.search, leg.barrier
    assert search is not None
    assert barrier is not None
    (command,) = leg.job.commands
    since = operation.now
    answer = yield Replan(job.offset + leg.job.offset + command.begins, joints)
    if not isinstance(answer, Replanned):
        raise Trouble(
            f"{title(barrier)}: {search.name} was found, but what follows isn't possible from here: "
            f"{answer or PROGRAM_UNKNOWN}",
            "the robot is at the place where it was found; move it from there by hand, or with --approach",
            "Y1638",
        )
    if not _do_the_same(answer.jobs, job.legs[place + 1 :]):
        raise Trouble(
            f"{title(barrier)}: the motions planned from here differ from those of the text", code="Y1638"
        )
    held.registers[search.flag] = 1
    depth = round(answer.length / MM / _STEP)
    if search.depth:
        register = next(replanned for replanned in job.registers if replanned.name == search.depth)
        if not register.low <= depth <= register.high:
            raise Trouble(
                f"{title(barrier)} would make {register.name} {depth}, and it is an integer from "
                f"{register.low} to {register.high}",
                f"declare a larger range: REGISTER {register.name} 0..{depth}",
                "Y1630",
            )
        yield from keep(barrier, register, depth)
        held.registers[register.name] = depth
    for replanned in answer.jobs:
        operation.notices.append(Planned(operation.now, replanned.text, replanned.certificate))
    way = f", {answer.length / MM:.2f} mm from the start of the motion" if answer.length else ""
    follows = f"; what follows is planned and proved from there ({operation.now - since:.3f} s)"
    operation.remark(f"{title(barrier)}: {search.name} found{way}{follows if answer.jobs else ''}")
    yield from obey_or_hold(operation, job, f"where {search.name} was found")
    return list(answer.jobs)


def _do_the_same(jobs: tuple[Job, ...], legs: tuple[Leg, ...]) -> bool:
    """Return True if each replanned job has the same outputs, dwells and commands as one of the next legs."""
    behind = [leg.job for leg in legs if leg.job is not None]
    return all(deeds(one) in [deeds(other) for other in behind] for one in jobs)


def deeds(job: Job) -> object:
    """Return the outputs that a job sets, the durations of its dwells, and its commands."""
    sets = [(variable, value) for _, variable, value in job.sets]
    return sets, [seconds for _, seconds in job.dwells], [(one.index, one.name) for one in job.commands]
