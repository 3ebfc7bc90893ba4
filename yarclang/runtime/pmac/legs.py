"""Streaming of the legs of a program: its parts between barriers, at which the robot stands until it may
continue. No I/O.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from yarclang.decisions import (
    filled,
    in_words,
    registers_of,
    simple,
)
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.runtime.actions import Lost, Script, Stopped, Trouble, Wait
from yarclang.runtime.job import Barrier, Job, Leg, Part
from yarclang.runtime.notices import Reached
from yarclang.runtime.outcome import Concerned, Ended
from yarclang.runtime.pmac.asked import LOOK, known_of, read_inputs, value_of
from yarclang.runtime.pmac.assigning import assign
from yarclang.runtime.pmac.held import COUNTED, Held, Passes, title
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.outputs import Outputs
from yarclang.runtime.pmac.rest import leave, stands_at
from yarclang.runtime.pmac.searching import found_at
from yarclang.runtime.pmac.shifting import shifted_by
from yarclang.runtime.pmac.teaching import TEACHING, teach
from yarclang.runtime.pmac.waiting import (
    awaited,
    obey_or_hold,
    wait_for_input,
    wait_for_operator,
    wait_until,
)
from yarclang.runtime.signals import state_text
from yarclang.runtime.state import Event

LOST = "Y1606"
"""Code of the finding for a lost connection."""

_TAKEN = {True: "its lines are executed", False: "its lines are skipped"}
"""Words for the lines under a WHEN, by the value of its condition."""

_LEFT = {True: "the loop is left", False: "the loop continues"}
"""Words for the loop of an UNTIL, by the value of its condition."""

Perform = Callable[[Operation, Job], Script[Ended]]


@frozen(eq=False)
class _Standing:
    """The place at which a robot stands: its barrier, position and time in the program.

    Attributes:
        barrier: the barrier.
        joints: (n,) joint positions [rad or m].
        done: program time, counting both branches of each WHEN, one after the other [s].
        clock: program time, counting only the longer branch of each WHEN passed before [s].
    """

    barrier: Barrier
    joints: Array
    done: float
    clock: float


def perform_legs(operation: Operation, job: Job, perform: Perform) -> Script[Ended]:
    """Stream the legs of a job; at each barrier, wait or choose a branch.

    Args:
        operation: state of the run, and access to the controller.
        job: a job with legs.
        perform: script that streams a job without barriers, here that of a single leg.
    """
    place: int | None = 0
    held = Held.of(job)
    if held.in_words():
        operation.remark(held.in_words())
    stands, begun = job.start, False
    ways: tuple[bool, ...] = ()
    barriers = 0
    anew: list[Job] = []
    while place is not None and place < len(job.legs):
        leg, input_found = job.legs[place], False
        if leg.job is not None:
            streamed = leg.job
            if anew:
                streamed = replace(anew.pop(0), behind=leg.job.behind)
            offset, clock = job.offset + leg.job.offset, job.clock + leg.job.clock
            part = Part(begun, title(leg.barrier) if leg.barrier is not None else "")
            begun = True
            held.said.clear()
            for one in held.loops.values():
                one.moved = True
            ended = yield from perform(operation, replace(streamed, offset=offset, clock=clock, part=part))
            if not ended.well:
                _tell_registers(operation, job, held)
                return replace(ended, ways=ways, barriers=barriers, registers=held.told)
            stands, input_found = streamed.end, ended.found
            if input_found and ended.joints is not None:
                stands = ended.joints
        if leg.barrier is None:
            break
        standing = _Standing(leg.barrier, stands, job.offset + leg.ends, job.clock + leg.clock)
        if leg.barrier.kind == "stop":
            operation.remark(f"{title(leg.barrier)}: the program ends here")
            return Ended(
                True,
                joints=stands,
                done=standing.done,
                clock=standing.clock,
                ways=ways,
                barriers=barriers,
                registers=held.told,
                finished=True,
            )
        try:
            if input_found:
                anew = yield from found_at(operation, job, place, stands, held)
            if leg.barrier.offset is not None:
                anew = yield from shifted_by(operation, job, place, stands, held)
            before, place = place, (yield from _pass(operation, job, place, leg.barrier, held, stands))
        except Stopped as stopped:
            ended = yield from _ended(operation, job, standing, Event.STOP, Trouble(str(stopped), code=""))
        except Trouble as trouble:
            ended = yield from _ended(operation, job, standing, Event.FAULT, trouble)
        except Lost as lost:
            ended = _lost(operation, standing, str(lost))
        else:
            barriers += 1
            match leg.barrier.kind:
                case "when":
                    ways = (*ways, place == before + 1)
                case "loop":
                    held.loops[before] = Passes(len(ways), barriers)
                case "next":
                    # restore the counts from before the loop: nothing from the pass that has ended is needed
                    # any more
                    loop = held.loops[place - 1]
                    ways, barriers = ways[: loop.ways], loop.barriers
            continue
        _tell_registers(operation, job, held)
        return replace(ended, ways=ways, barriers=barriers, at_barrier=True, registers=held.told)
    clock = job.clock + job.lasting.most
    done = job.offset + job.duration
    return Ended(
        True, joints=stands, done=done, clock=clock, ways=ways, barriers=barriers, registers=held.told
    )


def _tell_registers(operation: Operation, job: Job, held: Held) -> None:
    """Report the values of the registers when a run ends early: a later run begins with the values of KEPT
    registers only.
    """
    if held.in_words():
        kept = [one.name for one in job.registers if one.kept]
        but = f", except {', '.join(kept)}" if kept else ""
        operation.remark(
            f"{held.in_words()}; a run that continues with --from begins with their initial values{but}"
        )


def _pass(
    operation: Operation, job: Job, place: int, barrier: Barrier, held: Held, stands: Array
) -> Script[int]:
    """Pass a barrier at which the robot stands: wait, decide, begin another pass of a loop, store the robot's
    position, or change a register.

    Args:
        operation: state of the run, and access to the controller.
        job: the job with its legs.
        place: number of the leg that ends at the barrier.
        barrier: the barrier.
        held: registers, inputs and loops of the run.
        stands: (n,) the robot's joint positions [rad or m].

    Returns:
        The number of the next leg.
    """
    if barrier.kind in ("wait", "hold") or barrier.timeout is not None:
        operation.notices.append(Reached(operation.now, barrier.label))
    match barrier.kind:
        case "wait":
            if barrier.decided is None:
                yield from wait_for_input(operation, job, barrier)
            else:
                met = yield from wait_until(operation, job, barrier, barrier.decided, held)
                if not met:
                    raise Trouble(
                        f"{title(barrier)} has waited {barrier.timeout:g} s for "
                        f"{awaited(barrier, barrier.decided)}: {known_of(barrier.decided, held)}",
                        "check the inputs, then continue with --from",
                        "Y1604",
                    )
        case "hold":
            yield from wait_for_operator(operation, job, barrier, held)
        case "when":
            holds = yield from _decided(operation, job, barrier, held)
            return place + 1 if holds else _behind(job.legs, place, "when", "else", "end")
        case "set":
            yield from assign(operation, job, barrier, held)
        case "say" if barrier.word in TEACHING:
            yield from teach(operation, barrier, stands)
        case "say":
            operation.remark(f"{title(barrier)}: {filled(barrier.name, held.registers)}")
        case "abort":
            what = f"{title(barrier)} ends the program: {barrier.name}"
            raise Trouble(what, "correct the cause, then start the program again", "Y1635")
        case "else":
            return _behind(job.legs, place, "when", "end")
        case "next":
            return (yield from _begin_anew(operation, job, place, held))
        case "exit":
            if barrier.word != "UNTIL":
                operation.remark(
                    f"{title(barrier)}: the {'SUB' if barrier.word == 'RETURN' else 'loop'} is left"
                )
            return _behind(job.legs, place, "loop", "endloop")
    return place + 1


def _begin_anew(operation: Operation, job: Job, place: int, held: Held) -> Script[int]:
    """Go back to the first leg of a loop for its next pass, after carrying out orders. If the last pass had
    no motion, wait for `LOOK`, so that an empty loop doesn't keep this process busy.
    """
    yield from obey_or_hold(operation, job, "between two passes of a loop")
    head = _in_front(job.legs, place)
    loop = held.loops[head]
    if loop.moved:
        label = job.legs[head].barrier
        assert label is not None  # a loop begins at a barrier
        operation.remark(f"{title(label)}: pass {loop.number} is done", begins_pass=True)
        loop.number, loop.moved = loop.number + 1, False
    else:
        yield Wait(operation.now + LOOK)
    return head + 1


def _in_front(legs: tuple[Leg, ...], place: int) -> int:
    """Return the number of the leg before the innermost loop around a barrier."""
    depth = 0
    for number in range(place - 1, -1, -1):
        barrier = legs[number].barrier
        kind = barrier.kind if barrier is not None else ""
        if kind == "loop" and not depth:
            return number
        depth += (kind == "endloop") - (kind == "loop")
    raise AssertionError("a loop without a beginning was refused when the text was read")


def _decided(operation: Operation, job: Job, barrier: Barrier, held: Held) -> Script[bool]:
    """Decide a WHEN: return True if its first branch is taken. Each input is read once; all branches of a
    CASE are decided by the values read for the first branch.
    """
    assert barrier.decided is not None  # a WHEN without a condition was refused when the text was read
    if barrier.timeout is not None:
        met = yield from wait_until(operation, job, barrier, barrier.decided, held)
        if not met:
            known = known_of(barrier.decided, held)
            operation.remark(f"{title(barrier)}: {known}: the lines after its ELSE are executed")
        return met
    if not barrier.again:
        held.inputs = yield from read_inputs(operation, barrier, barrier.decided)
    holds = bool(value_of(barrier, barrier.decided, held))
    compared = simple(barrier.decided)
    condition = in_words(barrier.decided) if compared is None or not barrier.name else barrier.name
    outcome = (_LEFT if barrier.word == "UNTIL" else _TAKEN)[holds]
    if held.flags.intersection(registers_of(barrier.decided)):
        return holds  # the search or OFFSET has reported this already
    if barrier.word in COUNTED:
        (counted,) = registers_of(barrier.decided)
        left = max(held.registers[counted], 0)
        _say(operation, barrier, held, f"{left} pass{'es' * (left != 1)} to go")
        return holds
    if compared is not None and barrier.name:
        state = state_text(held.inputs[compared[0].variable])
        _say(operation, barrier, held, f"{condition} is {state}: {outcome}")
        return holds
    told = "holds" if holds else "does not hold"
    _say(
        operation,
        barrier,
        held,
        f"{barrier.name or condition} {told}, {known_of(barrier.decided, held)}: {outcome}",
    )
    return holds


def _say(operation: Operation, barrier: Barrier, held: Held, text: str) -> None:
    """Report a decision at a barrier. In a loop, it is reported only if its text has changed or the robot has
    moved since the last report.
    """
    place = f"{barrier.label} {barrier.source_line}"
    if held.said.get(place) != text:
        operation.remark(f"{title(barrier)}: {text}")
    held.said[place] = text


def _behind(legs: tuple[Leg, ...], place: int, opens: str, *kinds: str) -> int:
    """Search the legs for the next barrier of the same block that is of one of the given kinds, and return
    the number of the leg after it.

    Args:
        legs: the legs of the job.
        place: number of the leg whose barrier begins the block.
        opens: kind of barrier that begins such a block.
        kinds: kinds of barriers to look for; the last one ends the block.
    """
    depth = 0
    for number in range(place + 1, len(legs)):
        barrier = legs[number].barrier
        kind = barrier.kind if barrier is not None else ""
        if kind == opens:
            depth += 1
        elif depth == 0 and kind in kinds:
            return number + 1
        elif kind == kinds[-1]:
            depth -= 1
    raise AssertionError("a block without an end was refused when the text was read")


def _ended(
    operation: Operation, job: Job, standing: _Standing, event: Event, cause: Trouble
) -> Script[Ended]:
    """End the run at rest after a fault or a stop: leave the controller in a known state, and set outputs to
    their safe values.
    """
    operation.orders.clear()
    barrier, joints, problem = standing.barrier, standing.joints, cause.what
    try:
        yield from leave(operation, job.robot)
        yield from Outputs(job).secure(operation)
        joints = yield from stands_at(operation, job.robot)
    except Trouble as trouble:
        problem = f"{problem}; then: {trouble.what}"
    except Lost as lost:
        return _lost(operation, standing, f"{problem}; then: {lost}")
    operation.go(event, problem, cause.code, cause.remedy)
    return Ended(
        False,
        problem,
        cause.remedy,
        joints,
        title(barrier),
        barrier.label,
        standing.done,
        code=cause.code,
        concerns=_concerned(barrier),
        clock=standing.clock,
    )


def _lost(operation: Operation, standing: _Standing, reason: str) -> Ended:
    """End the run after the connection was lost while the robot was at rest; the robot stays at rest."""
    problem = f"the connection was lost: {reason}"
    remedy = "the robot is at rest; find the cause, run `yarc doctor`, then continue with --from"
    operation.go(Event.LOST, problem, LOST, remedy)
    operation.go(Event.FAULT, problem, LOST, remedy)
    return Ended(
        False,
        problem,
        remedy,
        standing.joints,
        title(standing.barrier),
        standing.barrier.label,
        standing.done,
        code=LOST,
        concerns=_concerned(standing.barrier),
        clock=standing.clock,
    )


def _concerned(barrier: Barrier) -> Concerned:
    return Concerned(barrier.label, barrier.word or barrier.kind.upper(), barrier.source_line)
