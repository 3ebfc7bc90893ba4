"""Programs with barriers: leg after leg is streamed, and between two of them the robot stands until it may go on. No I/O."""

from __future__ import annotations

from collections.abc import Callable

from yarclang.robot.model import Array
from yarclang.runtime.actions import Lost, Script, Stopped, Trouble, Wait
from yarclang.runtime.job import Barrier, Job, Leg
from yarclang.runtime.notices import Abort, Fail, Hold, Override, Resume, Stop
from yarclang.runtime.operation import Operation
from yarclang.runtime.outcome import Concerned, Ended
from yarclang.runtime.outputs import Outputs
from yarclang.runtime.rest import leave, stands_at
from yarclang.runtime.state import Event

_LOOK = 0.02
"""Time between two looks at an input [s]."""

Perform = Callable[[Operation, Job], Script[Ended]]


def perform_legs(operation: Operation, job: Job, perform: Perform) -> Script[Ended]:
    """Stream the legs of a job; at a barrier, wait, or choose the way that is taken.

    Args:
        operation: the run.
        job: with legs.
        perform: runs a job without any.
    """
    place: int | None = 0
    stands = job.start
    while place is not None and place < len(job.legs):
        leg = job.legs[place]
        if leg.job is not None:
            ended = yield from perform(operation, leg.job)
            if not ended.well:
                return ended
            stands = leg.job.end
        if leg.barrier is None:
            break
        try:
            place = yield from _pass(operation, job, place, leg.barrier)
        except Stopped as stopped:
            over = Trouble(str(stopped), code="")
            return (yield from _ended(operation, job, leg.barrier, Event.STOP, over, stands))
        except Trouble as trouble:
            return (yield from _ended(operation, job, leg.barrier, Event.FAULT, trouble, stands))
        except Lost as lost:
            return _lost(operation, leg.barrier, str(lost), stands)
    return Ended(True, joints=stands, done=job.offset + job.duration)


def _pass(operation: Operation, job: Job, place: int, barrier: Barrier) -> Script[int]:
    """Wait at a barrier; the number of the leg that comes next."""
    match barrier.kind:
        case "wait":
            yield from _wait_for_input(operation, barrier)
        case "hold":
            yield from _wait_for_operator(operation, job, barrier)
        case "when":
            (value,) = yield from operation.numbers(barrier.variable, 1)
            holds = value == barrier.value
            operation.remark(f"{_title(barrier)}: {barrier.name} is {_state(value)}")
            return place + 1 if holds else _behind(job.legs, place, "else", "end")
        case "else":
            return _behind(job.legs, place, "end")
    return place + 1


def _behind(legs: tuple[Leg, ...], place: int, *kinds: str) -> int:
    """The leg behind the next barrier of some kinds that belongs to the same WHEN."""
    depth = 0
    for number in range(place + 1, len(legs)):
        barrier = legs[number].barrier
        kind = barrier.kind if barrier is not None else ""
        if kind == "when":
            depth += 1
        elif depth == 0 and kind in kinds:
            return number + 1
        elif kind == "end":
            depth -= 1
    raise AssertionError("a WHEN without an end was refused when the text was read")


def _wait_for_input(operation: Operation, barrier: Barrier) -> Script[None]:
    """Until the input is as it shall be, or its time is over."""
    since = operation.now
    (value,) = yield from operation.numbers(barrier.variable, 1)
    if value == barrier.value:
        return
    operation.go(Event.HOLD, f"{_title(barrier)} waits for {barrier.name} to be {_state(barrier.value)}")
    while value != barrier.value:
        if barrier.timeout is not None and operation.now - since > barrier.timeout:
            raise Trouble(
                f"{_title(barrier)} has waited {barrier.timeout:g} s for {barrier.name} ({barrier.variable}) to be "
                f"{_state(barrier.value)}: it is {_state(value)}",
                "look at the input, then go on with --from",
                "Y1604",
            )
        yield Wait(operation.now + _LOOK)
        yield from _obey(operation)
        (value,) = yield from operation.numbers(barrier.variable, 1)
    operation.go(Event.END, f"{barrier.name} is {_state(value)}")


def _wait_for_operator(operation: Operation, job: Job, barrier: Barrier) -> Script[None]:
    """Until somebody says that it goes on; outputs are safe meanwhile."""
    outputs = Outputs(job)
    yield from outputs.remember(operation)
    yield from outputs.secure(operation)
    text = f": {barrier.name}" if barrier.name else ""
    operation.go(Event.HOLD, f"{_title(barrier)} holds{text}; Enter or `yarc resume` goes on")
    while not (yield from _obey(operation)):
        yield Wait(operation.now + _LOOK)
    yield from outputs.restore(operation, 0)
    operation.go(Event.END, "the operator goes on")


def _obey(operation: Operation) -> Script[bool]:
    """What people order while the robot stands at a barrier; whether it may go on."""
    resumed = False
    while operation.orders:
        match operation.orders.popleft():
            case Stop():
                raise Stopped(abort=False)
            case Abort():
                raise Stopped(abort=True)
            case Fail(what=what, remedy=remedy):
                raise Trouble(what, remedy, code="")  # no command's fault
            case Resume():
                resumed = True
            case Override(percent=percent):
                operation.override = percent / 100.0
                operation.remark(f"override {percent:g} %")
            case Hold():
                pass
    return resumed
    yield  # a script, though it asks nothing


def _ended(
    operation: Operation, job: Job, barrier: Barrier, event: Event, why: Trouble, stands: Array
) -> Script[Ended]:
    """The robot stands: leave the controller in a state that is known, outputs safe."""
    operation.orders.clear()
    joints, what = stands, why.what
    try:
        yield from leave(operation, job.robot)
        yield from Outputs(job).secure(operation)
        joints = yield from stands_at(operation, job.robot)
    except Trouble as trouble:
        what = f"{what}; then: {trouble.what}"
    except Lost as lost:
        return _lost(operation, barrier, f"{what}; then: {lost}", stands)
    operation.go(event, what)
    return Ended(
        False,
        what,
        why.remedy,
        joints,
        _title(barrier),
        barrier.label,
        code=why.code,
        concerns=_concerned(barrier),
    )


def _lost(operation: Operation, barrier: Barrier, why: str, stands: Array) -> Ended:
    """The connection is lost while the robot stands: it goes on standing."""
    what = f"the connection was lost: {why}"
    operation.go(Event.LOST, what)
    operation.go(Event.FAULT, what)
    remedy = "the robot stands; find out why, run `yarc doctor`, then go on with --from"
    return Ended(
        False,
        what,
        remedy,
        stands,
        _title(barrier),
        barrier.label,
        code="Y1606",
        concerns=_concerned(barrier),
    )


def _concerned(barrier: Barrier) -> Concerned:
    return Concerned(barrier.label, barrier.kind.upper(), barrier.source_line)


def _title(barrier: Barrier) -> str:
    return f"{barrier.label or f'line {barrier.source_line}:'} {barrier.kind.upper()}"


def _state(value: float) -> str:
    return {0.0: "OFF", 1.0: "ON"}.get(value, f"{value:g}")
