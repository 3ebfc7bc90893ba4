"""Programs with barriers: leg after leg is streamed, and between two of them the robot stands until it may go on. No I/O."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

from yarclang.decisions import (
    DecisionError,
    Register,
    Value,
    bits_of,
    evaluated,
    filled,
    in_words,
    inputs_of,
    is_group,
    largest_of,
    registers_of,
    shown_variable,
    simple,
)
from yarclang.frozen import frozen
from yarclang.robot.model import Array
from yarclang.runtime.actions import Keep, Lost, Script, Stopped, Trouble, Wait
from yarclang.runtime.job import Barrier, Job, Leg, Part
from yarclang.runtime.notices import Abort, Fail, Hold, Override, Question, Reached, Resume, Stop
from yarclang.runtime.outcome import Concerned, Ended
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.outputs import Outputs
from yarclang.runtime.pmac.rest import leave, stands_at
from yarclang.runtime.signals import OutputSet, WaitBegan, WaitEnded, state_text
from yarclang.runtime.state import Event

LOST = "Y1606"
"""Code of a connection that was lost."""

_TAKEN = {True: "its lines are carried out", False: "its lines are left out"}
"""What a decision means for the lines under its word."""

_LEFT = {True: "the loop is left", False: "the loop goes on"}
"""The same of UNTIL."""

_COUNTED = ("REPEAT", "LOOP")
"""Words whose decisions and registers are the count of a loop."""

_LOOK = 0.02
"""Time between two looks at an input [s]."""

_UNSTEADY = 1.0
"""How long a group may change from look to look [s]."""

Perform = Callable[[Operation, Job], Script[Ended]]


@frozen(eq=False)
class _Standing:
    """The robot stands at a barrier: at `joints` (n,) [rad or m], `done` [s] into the program, or `clock` [s] with both ways of a WHEN at once."""

    barrier: Barrier
    joints: Array
    done: float
    clock: float


@dataclass(slots=True)
class _Passes:
    """A loop that is gone through: the number of this pass; how many WHENs and barriers were passed in front of its first one; `moved` once something was sent in this one."""

    ways: int
    barriers: int
    number: int = 1
    moved: bool = False


@dataclass(slots=True)
class Held:
    """What a run knows besides the controller: its registers, what the last decision has read of the inputs, and how often its loops were gone through."""

    registers: dict[str, int]
    inputs: dict[str, float]
    loops: dict[int, _Passes] = field(default_factory=dict)
    """By the number of the leg in front of it."""
    said: dict[str, str] = field(default_factory=dict)
    """What was told last of each place, since something has moved."""

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
            held.said.clear()
            for one in held.loops.values():
                one.moved = True
            ended = yield from perform(operation, replace(leg.job, offset=offset, clock=clock, part=part))
            if not ended.well:
                _tell_registers(operation, job, held)
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
            match leg.barrier.kind:
                case "when":
                    ways = (*ways, place == before + 1)
                case "loop":
                    held.loops[before] = _Passes(len(ways), barriers)
                case "next":
                    # all is as in front of the pass that has ended: what was done in it needn't be known any more
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
    """Tell what a run that ends early has counted: it isn't kept."""
    if held.registers:
        kept = [one.name for one in job.registers if one.kept]
        but = f", but for {', '.join(kept)}" if kept else ""
        operation.remark(
            f"{held.in_words()}; a run that goes on with --from begins with their first values{but}"
        )


def _pass(operation: Operation, job: Job, place: int, barrier: Barrier, held: Held) -> Script[int]:
    """Wait at a barrier, decide, begin a loop anew, or change a register; the number of the leg that comes next."""
    if barrier.kind in ("wait", "hold") or barrier.timeout is not None:
        operation.notices.append(Reached(operation.now, barrier.label))
    match barrier.kind:
        case "wait":
            if barrier.decided is None:
                yield from _wait_for_input(operation, barrier)
            else:
                met = yield from _wait_until(operation, barrier, barrier.decided, held)
                if not met:
                    raise Trouble(
                        f"{_title(barrier)} has waited {barrier.timeout:g} s until {_awaited(barrier, barrier.decided)}: {_known(barrier.decided, held)}",
                        "look at the inputs, then go on with --from",
                        "Y1604",
                    )
        case "hold":
            yield from _wait_for_operator(operation, job, barrier, held)
        case "when":
            holds = yield from _decided(operation, barrier, held)
            return place + 1 if holds else _behind(job.legs, place, "when", "else", "end")
        case "set":
            yield from _set(operation, job, barrier, held)
        case "say":
            operation.remark(f"{_title(barrier)}: {filled(barrier.name, held.registers)}")
        case "abort":
            what = f"{_title(barrier)} ends the program: {barrier.name}"
            raise Trouble(what, "see to its reason, then start the program anew", "Y1635")
        case "else":
            return _behind(job.legs, place, "when", "end")
        case "next":
            return (yield from _begin_anew(operation, job, place, held))
        case "exit":
            if barrier.word != "UNTIL":
                operation.remark(
                    f"{_title(barrier)}: the {'SUB' if barrier.word == 'RETURN' else 'loop'} is left"
                )
            return _behind(job.legs, place, "loop", "endloop")
    return place + 1


def _begin_anew(operation: Operation, job: Job, place: int, held: Held) -> Script[int]:
    """Go back to the first leg of a loop. A pass in which nothing has moved takes a while all the same, and people's orders are heard."""
    holds = any(isinstance(order, Hold) for order in operation.orders)
    if not (yield from _obey(operation)) and holds:
        operation.go(Event.HOLD, "held between two passes of a loop; Enter or `yarc resume` goes on")
        while not (yield from _obey(operation)):
            yield Wait(operation.now + _LOOK)
        operation.go(Event.END, "the operator goes on")
    head = _in_front(job.legs, place)
    loop = held.loops[head]
    if loop.moved:
        label = job.legs[head].barrier
        assert label is not None  # a loop begins at one
        operation.remark(f"{_title(label)}: pass {loop.number} is done", begins_pass=True)
        loop.number, loop.moved = loop.number + 1, False
    else:
        yield Wait(operation.now + _LOOK)
    return head + 1


def _in_front(legs: tuple[Leg, ...], place: int) -> int:
    """The leg in front of the innermost loop around a barrier."""
    depth = 0
    for number in range(place - 1, -1, -1):
        barrier = legs[number].barrier
        kind = barrier.kind if barrier is not None else ""
        if kind == "loop" and not depth:
            return number
        depth += (kind == "endloop") - (kind == "loop")
    raise AssertionError("a loop without a beginning was refused when the text was read")


def _decided(operation: Operation, barrier: Barrier, held: Held) -> Script[bool]:
    """Decide a WHEN. Each input is read once; the ways of a CASE are decided with what was read at the first of them."""
    assert barrier.decided is not None  # a WHEN without a condition was refused when the text was read
    if barrier.timeout is not None:
        met = yield from _wait_until(operation, barrier, barrier.decided, held)
        if not met:
            known = _known(barrier.decided, held)
            operation.remark(f"{_title(barrier)}: {known}: the lines behind its ELSE are carried out")
        return met
    if not barrier.again:
        held.inputs = yield from _read(operation, barrier, barrier.decided)
    holds = bool(_evaluated(barrier, barrier.decided, held))
    compared = simple(barrier.decided)
    said = in_words(barrier.decided) if compared is None or not barrier.name else barrier.name
    taken = (_LEFT if barrier.word == "UNTIL" else _TAKEN)[holds]
    if barrier.word in _COUNTED:
        (counted,) = registers_of(barrier.decided)
        left = max(held.registers[counted], 0)
        _say(operation, barrier, held, f"{left} pass{'es' * (left != 1)} to go")
        return holds
    if compared is not None and barrier.name:
        state = state_text(held.inputs[compared[0].variable])
        _say(operation, barrier, held, f"{said} is {state}: {taken}")
        return holds
    told = "holds" if holds else "does not hold"
    _say(operation, barrier, held, f"{barrier.name or said} {told}, {_known(barrier.decided, held)}: {taken}")
    return holds


def _say(operation: Operation, barrier: Barrier, held: Held, text: str) -> None:
    """Tell what was decided; once, as long as a loop comes here again and nothing has changed or moved."""
    place = f"{barrier.label} {barrier.source_line}"
    if held.said.get(place) != text:
        operation.remark(f"{_title(barrier)}: {text}")
    held.said[place] = text


def _set(operation: Operation, job: Job, barrier: Barrier, held: Held) -> Script[None]:
    """Give a register or an output its value, or end the run if that is out of range."""
    assert barrier.decided is not None  # as above
    if barrier.output:
        yield from _set_output(operation, barrier, barrier.decided, held)
        return
    register = next(one for one in job.registers if one.name == barrier.register)
    held.inputs = yield from _read(operation, barrier, barrier.decided)
    value = _evaluated(barrier, barrier.decided, held)
    if not value.is_integer() or not register.low <= value <= register.high:
        raise Trouble(
            f"{_title(barrier)} would make {register.name} {value:.15g}, and it is an integer from {register.low} to {register.high}",
            "look at the inputs and at what the program counts, then start it anew",
            "Y1630",
        )
    yield from _keep(barrier, register, int(value))
    held.registers[register.name] = int(value)
    if barrier.word not in _COUNTED:
        operation.remark(f"{_title(barrier)}: {register.name} is {int(value)}")


def _keep(barrier: Barrier, register: Register, value: int) -> Script[None]:
    """Keep the value of a KEPT register: what isn't on the disk hasn't happened, and the robot stands until it is."""
    if not register.kept:
        return
    why = yield Keep(register.name, value)
    if why is not None:
        what = f"{_title(barrier)} can't keep {register.name} = {value}: {why}"
        raise Trouble(what, "see to the disk and its rights, then start the program anew", "Y1636")


def _set_output(operation: Operation, barrier: Barrier, value: Value, held: Held) -> Script[None]:
    """Give an output its value, or all bits of a group theirs, the lowest first."""
    held.inputs = yield from _read(operation, barrier, value)
    number, bits = _evaluated(barrier, value, held), bits_of(barrier.output)
    name = barrier.name.partition(" = ")[0]
    if len(bits) > 1 and not (number.is_integer() and 0 <= number <= largest_of(barrier.output)):
        raise Trouble(
            f"{_title(barrier)} would make {name} {number:.15g}, and its {len(bits)} bits hold integers from 0 to {largest_of(barrier.output)}",
            "look at the inputs and at what the program counts, then start it anew",
            "Y1630",
        )
    for place, bit in enumerate(bits):
        one = number if len(bits) == 1 else float(int(number) >> place & 1)
        yield from operation.ask(f"{bit}={_digits(one)}")
        operation.notices.append(OutputSet(operation.now, operation.outputs.get(bit, bit), bit, one))
    operation.remark(f"{_title(barrier)}: {name} is {_digits(number)}")


def _digits(number: float) -> str:
    """Return a number as the controller reads it."""
    return f"{number + 0.0:.9f}".rstrip("0").rstrip(".")


def _read(operation: Operation, barrier: Barrier, value: Value) -> Script[dict[str, float]]:
    """Read the inputs of a value, each once; a group until it holds still."""
    found: dict[str, float] = {}
    for one in inputs_of(value):
        if is_group(one.variable):
            found[one.variable] = yield from _read_group(operation, barrier, one.variable)
        else:
            (found[one.variable],) = yield from operation.numbers(one.variable, 1)
    return found


def _read_group(operation: Operation, barrier: Barrier, group: str) -> Script[float]:
    """Read the bits of a group as one number.

    They are asked for in one question, and yet a PLC may change them in between, or not all of them in the same of its cycles: a number
    counts when a second look, `_LOOK` later, finds the same one. Orders stay in their queue meanwhile: a HOLD is for the motion behind.
    """
    bits, since = bits_of(group), operation.now
    before: tuple[float, ...] | None = None
    while True:
        read = yield from operation.numbers("".join(bits), len(bits))
        for bit, value in zip(bits, read, strict=True):
            if value not in (0.0, 1.0):
                raise Trouble(
                    f"{_title(barrier)}: {bit} of the group {shown_variable(group)} reads {value:.15g}, and a bit is 0 or 1",
                    f"let {bit} point to one bit, or declare it as an input of its own",
                    "Y1650",
                )
        if read == before:
            return float(sum(int(value) << place for place, value in enumerate(read)))
        if operation.now - since > _UNSTEADY:
            raise Trouble(
                f"{_title(barrier)}: the group {shown_variable(group)} changes all the time: no two looks in {_UNSTEADY:g} s were equal",
                "let the other side keep the number until the robot has gone on",
                "Y1651",
            )
        before = read
        yield Wait(operation.now + _LOOK)


def _said(variable: str, value: float) -> str:
    return f"{value:.0f}" if is_group(variable) else state_text(value)


def _evaluated(barrier: Barrier, value: Value, held: Held) -> float:
    try:
        return evaluated(value, held.registers, held.inputs)
    except DecisionError as error:
        remedy = "look at the inputs and at what the program counts, then start it anew"
        raise Trouble(f"{_title(barrier)}: {error}", remedy, "Y1630") from None


def _behind(legs: tuple[Leg, ...], place: int, opens: str, *kinds: str) -> int:
    """The leg behind the next barrier of some kinds that belongs to the same block; `opens` begins such a block, and the last kind ends it."""
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


def _wait_until(operation: Operation, barrier: Barrier, condition: Value, held: Held) -> Script[bool]:
    """Until a condition holds, or its time is over: False then. At each look all inputs are read, each once."""
    since, place = operation.now, barrier.label or f"line {barrier.source_line}"
    name = _awaited(barrier, condition)
    held.inputs = yield from _read(operation, barrier, condition)
    holds = _evaluated(barrier, condition, held)
    operation.notices.append(WaitBegan(since, place, name, "", 1.0, holds))
    waits = not holds
    if waits:
        operation.go(Event.HOLD, f"{_title(barrier)} waits until {name}")
    while not holds:
        waited = operation.now - since
        if barrier.timeout is not None and waited > barrier.timeout:
            operation.notices.append(WaitEnded(operation.now, place, name, "", 0.0, waited, met=False))
            if barrier.kind == "when":
                operation.go(Event.END)
            return False
        yield Wait(operation.now + _LOOK)
        yield from _obey(operation)
        held.inputs = yield from _read(operation, barrier, condition)
        holds = _evaluated(barrier, condition, held)
    operation.notices.append(WaitEnded(operation.now, place, name, "", 1.0, operation.now - since, met=True))
    if waits:
        operation.go(Event.END)
    return True


def _awaited(barrier: Barrier, condition: Value) -> str:
    """Return what is waited for, with the names of the program where the text has them."""
    compared = simple(condition)
    if barrier.kind == "when" and compared is not None and barrier.name:
        return f"{barrier.name} is {state_text(compared[1])}"
    return barrier.name or in_words(condition)


def _known(condition: Value, held: Held) -> str:
    """Return what the registers and inputs of a condition were."""
    known = [f"{name} is {held.registers[name]}" for name in registers_of(condition)]
    known += [
        f"{shown_variable(one.variable)} is {_said(one.variable, held.inputs[one.variable])}"
        for one in inputs_of(condition)
    ]
    return ", ".join(known)


def _tell_end(operation: Operation, barrier: Barrier, value: float, waited: float) -> None:
    """Tell that a WAIT is over."""
    place = barrier.label or f"line {barrier.source_line}"
    met = value == barrier.value
    operation.notices.append(
        WaitEnded(operation.now, place, barrier.name, barrier.variable, value, waited, met)
    )


def _wait_for_operator(operation: Operation, job: Job, barrier: Barrier, held: Held) -> Script[None]:
    """Until somebody says that it goes on, with an answer if there is a question; outputs are safe meanwhile."""
    outputs = Outputs(job)
    yield from outputs.remember(operation)
    yield from outputs.secure(operation)
    text = f": {barrier.name}" if barrier.name else ""
    register = next((one for one in job.registers if one.name == barrier.register), None)
    if register is None:
        operation.go(Event.HOLD, f"{_title(barrier)} holds{text}; Enter or `yarc resume` goes on")
        while not (yield from _obey(operation)):
            yield Wait(operation.now + _LOOK)
    else:
        yield from _ask(operation, barrier, register, held)
    yield from outputs.restore(operation, 0)
    operation.go(Event.END, "the operator goes on")


def _ask(operation: Operation, barrier: Barrier, register: Register, held: Held) -> Script[None]:
    """Until somebody answers with a number that the register can hold."""
    asks = Question(barrier.name, register.name, register.low, register.high)
    wanted = f"a number from {register.low} to {register.high}"
    how = f"{wanted} and Enter, or `yarc resume --answer N`, goes on"
    operation.go(Event.HOLD, f"{_title(barrier)} asks: {barrier.name or register.name}; {how}", asks=asks)
    answers: list[int | None] = []
    while True:
        if (yield from _obey(operation, answers)):
            answer = answers[-1]
            if answer is not None and register.low <= answer <= register.high:
                break
            said = "no answer" if answer is None else f"the answer {answer}"
            operation.remark(f"{_title(barrier)}: {said}, and it asks for {wanted}", warning=True)
        yield Wait(operation.now + _LOOK)
    yield from _keep(barrier, register, answer)
    held.registers[register.name] = answer
    operation.remark(f"{_title(barrier)}: {register.name} is {answer}")


def _obey(operation: Operation, answers: list[int | None] | None = None) -> Script[bool]:
    """What people order while the robot stands at a barrier; whether it may go on. What they answer is added to `answers`."""
    resumed = False
    while operation.orders:
        match operation.orders.popleft():
            case Stop():
                raise Stopped(abort=False)
            case Abort():
                raise Stopped(abort=True)
            case Fail(what=what, remedy=remedy):
                raise Trouble(what, remedy, code="")  # no command's fault
            case Resume(answer=answer):
                resumed = True
                if answers is not None:
                    answers.append(answer)
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
