"""Programs with barriers: leg after leg is streamed, and between two of them the robot stands until it may go on. No I/O."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from yarclang.decisions import (
    DecisionError,
    Value,
    evaluated,
    in_words,
    inputs_of,
    registers_of,
    simple,
)
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.runtime.actions import Lost, Script, Stopped, Trouble, Wait
from yarclang.runtime.job import Barrier, Job, Leg, Part
from yarclang.runtime.notices import Abort, Fail, Hold, Override, Reached, Resume, Stop
from yarclang.runtime.outcome import Concerned, Ended
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.outputs import Outputs
from yarclang.runtime.pmac.rest import leave, stands_at
from yarclang.runtime.signals import WaitBegan, WaitEnded, state_text
from yarclang.runtime.state import Event

LOST = "Y1606"
"""Code of a connection that was lost."""

_TAKEN = {True: "its lines are carried out", False: "its lines are left out"}
"""What a decision means for the lines under its word."""

_LOOK = 0.02
"""Time between two looks at an input [s]."""

Perform = Callable[[Operation, Job], Script[Ended]]


@frozen(eq=False)
class _Standing:
    """The robot stands at a barrier: at `joints` (n,) [rad or m], `done` [s] into the program, or `clock` [s] with both ways of a WHEN at once."""

    barrier: Barrier
    joints: Array
    done: float
    clock: float


@dataclass(slots=True)
class Held:
    """What a run knows besides the controller: its registers, and what the last decision has read of the inputs."""

    registers: dict[str, int]
    inputs: dict[str, float]

    @classmethod
    def of(cls, job: Job) -> Held:
        """Return what is held when a run begins."""
        return cls({one.name: one.first for one in job.registers}, {})

    @property
    def told(self) -> tuple[tuple[str, int], ...]:
        """The registers, by their names."""
        return tuple(self.registers.items())

    def in_words(self) -> str:
        """Return the registers as the log tells them."""
        return "registers: " + ", ".join(f"{name} is {value}" for name, value in self.registers.items())


def perform_legs(operation: Operation, job: Job, perform: Perform) -> Script[Ended]:
    """Stream the legs of a job; at a barrier, wait, or choose the way that is taken.

    Args:
        operation: the run.
        job: with legs.
        perform: runs a job without any.
    """
    place: int | None = 0
    held = Held.of(job)
    if held.registers:
        operation.remark(held.in_words())
    stands, begun = job.start, False
    ways: tuple[bool, ...] = ()
    barriers = 0
    while place is not None and place < len(job.legs):
        leg = job.legs[place]
        if leg.job is not None:
            offset, clock = job.offset + leg.job.offset, job.clock + leg.job.clock
            part = Part(begun, _title(leg.barrier) if leg.barrier is not None else "")
            begun = True
            ended = yield from perform(operation, replace(leg.job, offset=offset, clock=clock, part=part))
            if not ended.well:
                _tell_registers(operation, held)
                return replace(ended, ways=ways, barriers=barriers, registers=held.told)
            stands = leg.job.end
        if leg.barrier is None:
            break
        here = _Standing(leg.barrier, stands, job.offset + leg.ends, job.clock + leg.clock)
        if leg.barrier.kind == "stop":
            operation.remark(f"{_title(leg.barrier)}: the program ends here")
            return Ended(
                True,
                joints=stands,
                done=here.done,
                clock=here.clock,
                ways=ways,
                barriers=barriers,
                registers=held.told,
                finished=True,
            )
        try:
            before, place = place, (yield from _pass(operation, job, place, leg.barrier, held))
        except Stopped as stopped:
            ended = yield from _ended(operation, job, here, Event.STOP, Trouble(str(stopped), code=""))
        except Trouble as trouble:
            ended = yield from _ended(operation, job, here, Event.FAULT, trouble)
        except Lost as lost:
            ended = _lost(operation, here, str(lost))
        else:
            barriers += 1
            if leg.barrier.kind == "when":
                ways = (*ways, place == before + 1)
            continue
        _tell_registers(operation, held)
        return replace(ended, ways=ways, barriers=barriers, at_barrier=True, registers=held.told)
    clock = job.clock + job.lasting.most
    done = job.offset + job.duration
    return Ended(
        True, joints=stands, done=done, clock=clock, ways=ways, barriers=barriers, registers=held.told
    )


def _tell_registers(operation: Operation, held: Held) -> None:
    """Tell what a run that ends early has counted: it isn't kept."""
    if held.registers:
        operation.remark(f"{held.in_words()}; a run that goes on with --from begins with their first values")


def _pass(operation: Operation, job: Job, place: int, barrier: Barrier, held: Held) -> Script[int]:
    """Wait at a barrier, decide, or change a register; the number of the leg that comes next."""
    if barrier.kind in ("wait", "hold"):
        operation.notices.append(Reached(operation.now, barrier.label))
    match barrier.kind:
        case "wait":
            yield from _wait_for_input(operation, barrier)
        case "hold":
            yield from _wait_for_operator(operation, job, barrier)
        case "when":
            holds = yield from _decided(operation, barrier, held)
            return place + 1 if holds else _behind(job.legs, place, "else", "end")
        case "set":
            yield from _set(operation, job, barrier, held)
        case "abort":
            what = f"{_title(barrier)} ends the program: {barrier.name}"
            raise Trouble(what, "see to its reason, then start the program anew", "Y1635")
        case "else":
            return _behind(job.legs, place, "end")
    return place + 1


def _decided(operation: Operation, barrier: Barrier, held: Held) -> Script[bool]:
    """Decide a WHEN. Each input is read once; the ways of a CASE are decided with what was read at the first of them."""
    assert barrier.decided is not None  # a WHEN without a condition was refused when the text was read
    if not barrier.again:
        held.inputs = yield from _read(operation, barrier.decided)
    holds = bool(_evaluated(barrier, barrier.decided, held))
    compared = simple(barrier.decided)
    said = in_words(barrier.decided) if compared is None or not barrier.name else barrier.name
    if compared is not None and barrier.name:
        state = state_text(held.inputs[compared[0].variable])
        operation.remark(f"{_title(barrier)}: {said} is {state}: {_TAKEN[holds]}")
        return holds
    known = [f"{name} is {held.registers[name]}" for name in registers_of(barrier.decided)]
    known += [
        f"{one.variable} is {state_text(held.inputs[one.variable])}" for one in inputs_of(barrier.decided)
    ]
    operation.remark(
        f"{_title(barrier)}: {barrier.name or said} {'holds' if holds else 'does not hold'}, {', '.join(known)}: {_TAKEN[holds]}"
    )
    return holds


def _set(operation: Operation, job: Job, barrier: Barrier, held: Held) -> Script[None]:
    """Give a register its value, or end the run if that is out of range."""
    assert barrier.decided is not None  # as above
    register = next(one for one in job.registers if one.name == barrier.register)
    held.inputs = yield from _read(operation, barrier.decided)
    value = _evaluated(barrier, barrier.decided, held)
    if not value.is_integer() or not register.low <= value <= register.high:
        raise Trouble(
            f"{_title(barrier)} would make {register.name} {value:.15g}, and it is an integer from {register.low} to {register.high}",
            "look at the inputs and at what the program counts, then start it anew",
            "Y1630",
        )
    held.registers[register.name] = int(value)
    operation.remark(f"{_title(barrier)}: {register.name} is {int(value)}")


def _read(operation: Operation, value: Value) -> Script[dict[str, float]]:
    """Read the inputs of a value, each once."""
    found: dict[str, float] = {}
    for one in inputs_of(value):
        (found[one.variable],) = yield from operation.numbers(one.variable, 1)
    return found


def _evaluated(barrier: Barrier, value: Value, held: Held) -> float:
    try:
        return evaluated(value, held.registers, held.inputs)
    except DecisionError as error:
        remedy = "look at the inputs and at what the program counts, then start it anew"
        raise Trouble(f"{_title(barrier)}: {error}", remedy, "Y1630") from None


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
    place = barrier.label or f"line {barrier.source_line}"
    operation.notices.append(
        WaitBegan(operation.now, place, barrier.name, barrier.variable, barrier.value, value)
    )
    if value == barrier.value:
        _tell_end(operation, barrier, value, 0.0)
        return
    operation.go(Event.HOLD, f"{_title(barrier)} waits for {barrier.name} to be {state_text(barrier.value)}")
    while value != barrier.value:
        if barrier.timeout is not None and operation.now - since > barrier.timeout:
            _tell_end(operation, barrier, value, operation.now - since)
            raise Trouble(
                f"{_title(barrier)} has waited {barrier.timeout:g} s for {barrier.name} ({barrier.variable}) to be "
                f"{state_text(barrier.value)}: it is {state_text(value)}",
                "look at the input, then go on with --from",
                "Y1604",
            )
        yield Wait(operation.now + _LOOK)
        yield from _obey(operation)
        (value,) = yield from operation.numbers(barrier.variable, 1)
    _tell_end(operation, barrier, value, operation.now - since)
    operation.go(Event.END)


def _tell_end(operation: Operation, barrier: Barrier, value: float, waited: float) -> None:
    """Tell that a WAIT is over."""
    place = barrier.label or f"line {barrier.source_line}"
    met = value == barrier.value
    operation.notices.append(
        WaitEnded(operation.now, place, barrier.name, barrier.variable, value, waited, met)
    )


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


def _ended(operation: Operation, job: Job, here: _Standing, event: Event, why: Trouble) -> Script[Ended]:
    """The robot stands: leave the controller in a state that is known, outputs safe."""
    operation.orders.clear()
    barrier, joints, what = here.barrier, here.joints, why.what
    try:
        yield from leave(operation, job.robot)
        yield from Outputs(job).secure(operation)
        joints = yield from stands_at(operation, job.robot)
    except Trouble as trouble:
        what = f"{what}; then: {trouble.what}"
    except Lost as lost:
        return _lost(operation, here, f"{what}; then: {lost}")
    operation.go(event, what, why.code, why.remedy)
    return Ended(
        False,
        what,
        why.remedy,
        joints,
        _title(barrier),
        barrier.label,
        here.done,
        code=why.code,
        concerns=_concerned(barrier),
        clock=here.clock,
    )


def _lost(operation: Operation, here: _Standing, why: str) -> Ended:
    """The connection is lost while the robot stands: it goes on standing."""
    what = f"the connection was lost: {why}"
    remedy = "the robot stands; find out why, run `yarc doctor`, then go on with --from"
    operation.go(Event.LOST, what, LOST, remedy)
    operation.go(Event.FAULT, what, LOST, remedy)
    return Ended(
        False,
        what,
        remedy,
        here.joints,
        _title(here.barrier),
        here.barrier.label,
        here.done,
        code=LOST,
        concerns=_concerned(here.barrier),
        clock=here.clock,
    )


def _concerned(barrier: Barrier) -> Concerned:
    return Concerned(barrier.label, barrier.word or barrier.kind.upper(), barrier.source_line)


def _title(barrier: Barrier) -> str:
    return f"{barrier.label or f'line {barrier.source_line}:'} {barrier.word or barrier.kind.upper()}"
