"""Barriers at which the robot stands until an input, a condition, a time or the operator lets it continue,
and the orders that are carried out during this wait. No I/O.
"""

from __future__ import annotations

from yarclang.decisions import (
    Register,
    Value,
    in_words,
    simple,
)
from yarclang.runtime.actions import Script, Stopped, Trouble, Wait
from yarclang.runtime.job import Barrier, Job
from yarclang.runtime.notices import Abort, Fail, Fill, Hold, Override, Question, Resume, Stop
from yarclang.runtime.operation import UNATTENDED
from yarclang.runtime.pmac.asked import LOOK, read_inputs, value_of
from yarclang.runtime.pmac.assigning import keep
from yarclang.runtime.pmac.filling import begin_anew, close, fill, is_given, needed_for, take_values
from yarclang.runtime.pmac.held import Held, title
from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.pmac.outputs import Outputs
from yarclang.runtime.signals import WaitBegan, WaitEnded, state_text
from yarclang.runtime.state import Event


def wait_for_input(operation: Operation, job: Job, barrier: Barrier) -> Script[None]:
    """Wait until an input has its wanted value. If a person orders a hold, the wait is over only after a
    resume, whatever value the input has. The duration of the hold doesn't count for the time limit.

    Raises:
        Trouble: the time limit of the WAIT is over.
    """
    since = operation.now
    (value,) = yield from operation.numbers(barrier.variable, 1)
    place = barrier.label or f"line {barrier.source_line}"
    operation.notices.append(
        WaitBegan(operation.now, place, barrier.name, barrier.variable, barrier.value, value)
    )
    if value == barrier.value:
        _tell_end(operation, barrier, value, 0.0)
        return
    reason = f"{title(barrier)} waits for {barrier.name} to be {state_text(barrier.value)}"
    operation.go(Event.HOLD, reason)
    while value != barrier.value:
        if barrier.timeout is not None and operation.now - since > barrier.timeout:
            _tell_end(operation, barrier, value, operation.now - since)
            raise Trouble(
                f"{title(barrier)} has waited {barrier.timeout:g} s for {barrier.name} "
                f"({barrier.variable}) to be "
                f"{state_text(barrier.value)}: it is {state_text(value)}",
                "check the input, then continue with --from",
                "Y1604",
            )
        yield Wait(operation.now + LOOK)
        if held := (yield from obey_or_hold(operation, job, f"at {title(barrier)}")):
            since += held
            operation.go(Event.HOLD, reason)
        (value,) = yield from operation.numbers(barrier.variable, 1)
    _tell_end(operation, barrier, value, operation.now - since)
    operation.go(Event.END)


def wait_until(
    operation: Operation, job: Job, barrier: Barrier, condition: Value, held: Held
) -> Script[bool]:
    """Wait until a condition is satisfied, or until the time limit of the WAIT is over. If a person orders a
    hold, the wait is over only after a resume. The duration of the hold doesn't count for the time limit.

    Each step reads every input once. Registers of the condition that other programs fill are reset first,
    and values for them are accepted until the end of the wait.

    Args:
        operation: state of the run, and access to the controller.
        job: the program with its outputs.
        barrier: the WAIT, with its time limit.
        condition: the condition.
        held: registers and inputs of the run.

    Returns:
        True if the condition is satisfied; False if the time limit is over.
    """
    since, place = operation.now, barrier.label or f"line {barrier.source_line}"
    name = awaited(barrier, condition)
    needed = needed_for(condition, held)
    begin_anew(held, needed)
    held.inputs = yield from read_inputs(operation, barrier, condition)
    holds = value_of(barrier, condition, held)
    operation.notices.append(WaitBegan(since, place, name, "", 1.0, holds))
    waits, reason = not holds, f"{title(barrier)} waits until {name}"
    if waits:
        operation.go(Event.HOLD, reason)
    try:
        while not holds:
            waited = operation.now - since
            is_over = barrier.timeout is not None and waited > barrier.timeout
            if is_over:
                operation.want(None)  # values that come after the time limit don't count
                if not is_given(operation):
                    operation.notices.append(
                        WaitEnded(operation.now, place, name, "", 0.0, waited, met=False)
                    )
                    if barrier.kind == "when":
                        operation.go(Event.END)
                    return False
            else:
                if needed and operation.wants is None and not is_given(operation):
                    take_values(operation, barrier, held, needed)
                yield Wait(operation.now + LOOK)
            place_held = f"at {title(barrier)}"
            if paused := (yield from obey_or_hold(operation, job, place_held, filling=(barrier, held))):
                since += paused
                operation.go(Event.HOLD, reason)
            held.inputs = yield from read_inputs(operation, barrier, condition)
            holds = value_of(barrier, condition, held)
    finally:
        close(operation, barrier, held)
    operation.notices.append(WaitEnded(operation.now, place, name, "", 1.0, operation.now - since, met=True))
    if waits:
        operation.go(Event.END)
    return True


def awaited(barrier: Barrier, condition: Value) -> str:
    """Return the condition of a wait in words, with the program's own names if the text has them."""
    compared = simple(condition)
    if barrier.kind == "when" and compared is not None and barrier.name:
        return f"{barrier.name} is {state_text(compared[1])}"
    return barrier.name or in_words(condition)


def _tell_end(operation: Operation, barrier: Barrier, value: float, waited: float) -> None:
    """Send the notice that a WAIT is over.

    Args:
        operation: state of the run, and access to the controller.
        barrier: the WAIT.
        value: value of the input.
        waited: duration of the wait [s].
    """
    place = barrier.label or f"line {barrier.source_line}"
    met = value == barrier.value
    operation.notices.append(
        WaitEnded(operation.now, place, barrier.name, barrier.variable, value, waited, met)
    )


def wait_for_operator(operation: Operation, job: Job, barrier: Barrier, held: Held) -> Script[None]:
    """Wait at a HOLD until a person resumes, with an answer if the HOLD asks a question. During the wait,
    outputs have their safe values.

    Args:
        operation: state of the run, and access to the controller.
        job: the program with its outputs and registers.
        barrier: the HOLD.
        held: registers of the run.
    """
    text = f": {barrier.name}" if barrier.name else ""
    register = next((one for one in job.registers if one.name == barrier.register), None)
    if register is None:
        yield from hold_with(
            operation,
            job,
            barrier,
            held,
            f"{title(barrier)} holds{text}; continue with Enter or `yarc resume`",
        )
    else:
        outputs = Outputs(job)
        yield from outputs.remember(operation)
        yield from outputs.secure(operation)
        yield from _ask(operation, barrier, register, held)
        yield from outputs.restore(operation, 0)
        operation.go(Event.END, "continued by the operator")


def hold_with(operation: Operation, job: Job, barrier: Barrier, held: Held, reason: str) -> Script[None]:
    """Report a reason, and wait until a person resumes. During the wait, outputs have their safe values.

    Args:
        operation: state of the run, and access to the controller.
        job: the program with its outputs.
        barrier: where the robot stands.
        held: registers of the run; during the wait, other programs may set their values.
        reason: the reason, and how the program continues, for people.
    """
    outputs = Outputs(job)
    yield from outputs.remember(operation)
    yield from outputs.secure(operation)
    operation.go(Event.HOLD, reason)
    yield from _hold(operation, barrier, held)
    yield from outputs.restore(operation, 0)
    operation.go(Event.END, "continued by the operator")


def _hold(
    operation: Operation, barrier: Barrier, held: Held, answers: list[int | None] | None = None
) -> Script[None]:
    """Wait until a person resumes. During the wait, other programs may set registers, but this doesn't make
    the program continue.
    """
    try:
        while True:
            if held.outside and operation.wants is None and not is_given(operation):
                take_values(operation, barrier, held, ())
            if (yield from obey(operation, answers, filling=(barrier, held))):
                return
            yield Wait(operation.now + LOOK)
    finally:
        close(operation, barrier, held)


def _ask(operation: Operation, barrier: Barrier, register: Register, held: Held) -> Script[None]:
    """Wait until a person answers with a number that the register can hold."""
    asks = Question(barrier.name, register.name, register.low, register.high)
    expected = f"a number from {register.low} to {register.high}"
    how = f"to continue, type {expected} and Enter, or use `yarc resume --answer N`"
    operation.go(Event.HOLD, f"{title(barrier)} asks: {barrier.name or register.name}; {how}", asks=asks)
    answers: list[int | None] = []
    while True:
        yield from _hold(operation, barrier, held, answers)
        answer = answers[-1]
        if answer is not None and register.low <= answer <= register.high:
            break
        said = "no answer" if answer is None else f"the answer {answer}"
        operation.remark(f"{title(barrier)}: {said}, but {expected} is needed", warning=True)
    yield from keep(barrier, register, answer)
    held.registers[register.name] = answer
    operation.remark(f"{title(barrier)}: {register.name} is {answer}")


def obey_or_hold(
    operation: Operation, job: Job, place: str, *, filling: tuple[Barrier, Held] | None = None
) -> Script[float]:
    """Carry out orders while the robot stands. If a hold was ordered, or this process was suspended for a
    long time, wait until a person resumes; outputs have their safe values meanwhile.

    Args:
        operation: state of the run, and access to the controller.
        job: the program with its outputs.
        place: where the robot stands, in words.
        filling: as for `obey`.

    Returns:
        The duration of the hold [s]; 0 if there was none.
    """
    given = [one for one in operation.orders if isinstance(one, Hold | Resume)]
    slept, operation.slept = operation.slept, 0.0
    if not slept and (not given or isinstance(given[-1], Resume)):
        yield from obey(operation, filling=filling)
        return 0.0
    since, outputs = operation.now, Outputs(job)
    yield from outputs.remember(operation)
    yield from outputs.secure(operation)
    if slept:
        operation.go(Event.HOLD, f"this process was suspended for {slept:.0f} s: held {place}")
        operation.remark(UNATTENDED, warning=True)
    else:
        operation.go(Event.HOLD, f"held {place}; continue with Enter or `yarc resume`")
    while not (yield from obey(operation, filling=filling)):
        yield Wait(operation.now + LOOK)
    yield from outputs.restore(operation, 0)
    operation.go(Event.END, "continued by the operator")
    return operation.now - since


def obey(
    operation: Operation,
    answers: list[int | None] | None = None,
    *,
    filling: tuple[Barrier, Held] | None = None,
) -> Script[bool]:
    """Carry out orders while the robot stands at a barrier.

    Args:
        operation: state of the run, and access to the controller.
        answers: list to which answers of people are added.
        filling: the barrier that accepts values from other programs, and the registers of the run; None: no
            values are accepted.

    Returns:
        True if a person has resumed the program, and hasn't ordered a hold after that.
    """
    resumed = False
    while operation.orders:
        match operation.orders.popleft():
            case Stop():
                raise Stopped(abort=False)
            case Abort():
                raise Stopped(abort=True)
            case Fail(what=what, remedy=remedy):
                raise Trouble(what, remedy, code="")  # no code: no command of the program is at fault
            case Resume() if operation.ignores_resume():
                pass
            case Resume(answer=answer):
                resumed = True
                operation.slept = 0.0  # a person has looked at the robot since
                if answers is not None:
                    answers.append(answer)
            case Override(percent=percent):
                operation.override = percent / 100.0
                operation.remark(f"override {percent:g} %")
            case Fill() as given if filling is not None:
                operation.want(None)  # each question accepts only one message
                fill(operation, *filling, given)
            case Hold():
                resumed = False
            case Fill():
                pass
    return resumed
    yield  # `yield` makes this function a script, although it asks nothing
