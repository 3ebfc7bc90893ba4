"""A run from its first question to its last: inspection, streaming, and the handling of faults. No I/O."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from yarclang.pmac.controller import turbo_pmac
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import (
    Connect,
    Connected,
    Found,
    Left,
    Lost,
    Script,
    Stopped,
    TooLate,
    Trouble,
    Unreachable,
    Wait,
)
from yarclang.runtime.inspection import Inspection, Item
from yarclang.runtime.job import Job
from yarclang.runtime.live import Live
from yarclang.runtime.notices import Abort, Fail, Hold, Stop
from yarclang.runtime.operation import Interrupted
from yarclang.runtime.outcome import Concerned, Ended
from yarclang.runtime.pmac.inspection import inspect
from yarclang.runtime.pmac.legs import LOST, perform_legs
from yarclang.runtime.pmac.link import figures, measure
from yarclang.runtime.pmac.live import LiveStream
from yarclang.runtime.pmac.messages import Control
from yarclang.runtime.pmac.operation import ABORT_ALL, CLOSE_ROTARY, HOLD_ALL, PATIENCE, Operation
from yarclang.runtime.pmac.outputs import Outputs
from yarclang.runtime.pmac.protocol import GREETING
from yarclang.runtime.pmac.rest import LONGEST, come_to_rest, leave, motor_statuses, stands_at, system_words
from yarclang.runtime.pmac.streaming import Stream
from yarclang.runtime.pmac.watching import RESET_REMEDY, were_reset
from yarclang.runtime.scripts import Measured
from yarclang.runtime.standing import described
from yarclang.runtime.state import Event, State

AGAIN_FOR = 10.0
"""Longest time for which a new connection is tried after one was lost [s]."""

_AGAIN_EACH = 0.5

_HELD_WITHIN = 3.0
"""Time to wait for rest after a hold, in addition to four hold times [s]. If the robot moves even after this
time, the hold can't stop it.
"""

_ABORTED = "aborted: off its path"

_MOTOR_FAULT = "Y1602"
"""Code of the finding that a motor can't move. After this fault the settings are compared again, since
another client may have changed the motor's limits.
"""

_PATIENCE_AT_REST = 10.0
"""Longest time that a controller may be busy while only the robot's position is asked for [s]."""


def connect(operation: Operation) -> Script[None]:
    """Connect to the controller, and set the format of its replies.

    Raises:
        Trouble: the controller can't be reached, or doesn't answer as a PMAC does.
    """
    outcome = yield Connect()
    if isinstance(outcome, Unreachable):
        raise Trouble(outcome.reason, "check the address, the cable, and the controller's power")
    assert isinstance(outcome, Connected)
    try:
        yield from _greet(operation)
    except TooLate as late:
        raise Trouble(
            f"the controller at that address answers too slowly, or not at all: {late}",
            "check whether it hangs or is busy, and how fast the link is",
        ) from None
    except Lost as lost:
        raise Trouble(
            f"the device at that address doesn't answer like a PMAC: {lost}",
            "check the address",
        ) from None
    if operation.state is State.DISCONNECTED:
        operation.go(Event.CONNECTED)


def _greet(operation: Operation) -> Script[None]:
    """Close the rotary, and set the format of replies. The order matters: a rotary that a failed run has left
    open would store the line that sets the format.
    """
    yield from operation.control(CLOSE_ROTARY)
    yield from operation.ask(GREETING)


def look(operation: Operation, robot: Robot, items: Sequence[Item]) -> Script[Inspection]:
    """Inspect the controller before anything moves. If nothing is wrong, the state Fault of the run is
    cleared.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot.
        items: the settings to compare, with their required values.

    Raises:
        Trouble: the controller can't be inspected.
    """
    try:
        inspection = yield from inspect(operation, robot, items)
    except Lost as lost:
        raise Trouble(f"the connection was lost while checking the controller: {lost}") from None
    if operation.state is State.FAULT and not inspection.errors:
        operation.go(Event.CLEAR, "the controller was checked: all checks passed")
    return inspection


def measured(operation: Operation, robot: Robot) -> Script[Measured]:
    """Measure the speed of the connection.

    Raises:
        Trouble: the connection can't be measured.
    """
    try:
        return figures((yield from measure(operation, len(robot.controller.axes))))
    except Lost as lost:
        raise Trouble(f"the connection was lost while the link was measured: {lost}") from None


def perform(operation: Operation, job: Job) -> Script[Ended]:
    """Run a job on a controller that was inspected.

    At the end the robot is at rest, or the result states that the robot's state isn't known.
    """
    operation.stay_awake()
    if operation.state is not State.STOP:
        problem = f"nothing can be started in state {operation.state.value}"
        return Ended(False, problem, "check the controller first: `yarc doctor`")
    work = perform_legs(operation, job, _stream) if job.legs else _stream(operation, job)
    ended = yield from work
    if ended.well and job.outputs:
        try:
            yield from Outputs(job).secure(operation)
        except (Trouble, Lost) as trouble:
            problem = f"the program has ended, but its outputs can't be set to their safe values: {trouble}"
            operation.go(
                Event.FAULT, problem, trouble.code if isinstance(trouble, Trouble) else LOST, "look at them"
            )
            return Ended(False, problem, "look at them", ended.joints)
    return ended


def _stream(operation: Operation, job: Job) -> Script[Ended]:
    """Run a job without barriers."""
    return (yield from _carried_out(operation, Stream(operation, job)))


def perform_live(operation: Operation, live: Live) -> Script[Ended]:
    """Carry out a live motion on a controller that was inspected, as `perform` does with a job."""
    if operation.state is not State.STOP:
        what = f"nothing can be started in state {operation.state.value}"
        return Ended(False, what, "check the controller first: `yarc doctor`")
    return (yield from _carried_out(operation, LiveStream(operation, live)))


def _carried_out(operation: Operation, stream: Stream | LiveStream) -> Script[Ended]:
    """Run the stream of a motion to its end. If it is ended early, bring the robot to rest."""
    try:
        yield from stream.run()
    except (Found, Left) as reason:
        ended = yield from _left_at_rest(operation, stream, reason.way if isinstance(reason, Left) else "")
        operation.watch, operation.patience = (), PATIENCE
        return ended
    except Stopped as stopped:
        what = _ABORTED if stopped.abort else "stopped on its path"
        ended = yield from _settle(operation, stream, Event.STOP, Trouble(what, code=""))
    except Trouble as trouble:
        ended = yield from _settle(operation, stream, Event.FAULT, trouble)
    except Lost as lost:
        ended = yield from _recover(operation, stream, str(lost))
    else:
        job = stream.job
        return Ended(True, joints=job.end, done=job.offset + job.duration, clock=job.clock + job.duration)
    operation.watch, operation.patience = (), PATIENCE
    operation.orders.clear()
    return ended


def _left_at_rest(operation: Operation, stream: Stream | LiveStream, way: str) -> Script[Ended]:
    """Come to rest on the path after an input has ended or held the motion, and discard the remaining lines.

    Args:
        operation: state of the run, and access to the controller.
        stream: the motion.
        way: name of the SUB by which the robot is to retreat; empty if the input has ended a search.
    """
    try:
        joints, aborted = yield from _end_at_rest(operation, stream.job.robot)
    except Trouble as trouble:
        return (yield from _settle(operation, stream, Event.FAULT, trouble))
    except Lost as lost:
        return (yield from _recover(operation, stream, str(lost)))
    ends = Stop | Abort | Fail | Hold if way else Stop | Abort | Fail
    if aborted or joints is None or any(isinstance(order, ends) for order in operation.orders):
        operation.orders.clear()
        return (
            yield from _settle(
                operation,
                stream,
                Event.STOP,
                Trouble(_ABORTED if aborted else "stopped on its path", code=""),
            )
        )
    if way:
        operation.orders.clear()
        what = f"the motion is abandoned: back along its path, then away by {way}"
        operation.go(Event.STOP, what)
        return replace(_ended(stream, what, "", joints, Trouble("", code="")), leaves=way)
    operation.go(Event.END)
    return replace(_ended(stream, "", "", joints, Trouble("", code="")), well=True, found=True)


def _settle(operation: Operation, stream: Stream | LiveStream, event: Event, cause: Trouble) -> Script[Ended]:
    """Come to rest after a stop or a fault, and leave the controller in a known state."""
    robot = stream.job.robot
    problem, remedy = cause.what, cause.remedy
    try:
        if event is Event.FAULT and operation.state is State.MOVE:
            # Hold on the path now, although some lines are left: without a hold the buffer would run empty.
            yield from operation.hold(turbo_pmac(robot).coordinate_system, robot.controller.hold_time)
        joints, aborted = yield from _end_at_rest(operation, robot)
        if aborted and _ABORTED not in problem:
            problem = _ABORTED if event is Event.STOP else f"{problem}; then {_ABORTED}"
        if (
            cause.code == _MOTOR_FAULT
            and joints is not None
            and (told := (yield from stream.supervision.compare(all_=True)))
        ):
            problem, remedy = (
                f"{problem}; and since the check, {told}",
                "find other clients of this controller",
            )
        yield from Outputs(stream.job).secure(operation)
    except Trouble as trouble:
        operation.go(event, problem, cause.code, remedy)
        return _ended(stream, f"{problem}; then: {trouble.what}", trouble.remedy or remedy, None, cause)
    except Lost as lost:
        return (yield from _recover(operation, stream, f"{problem}; then: {lost}"))
    operation.go(event, problem, cause.code, remedy)
    return _ended(stream, problem, remedy, joints, cause)


def _end_at_rest(operation: Operation, robot: Robot) -> Script[tuple[Array | None, bool]]:
    """Wait for rest, and end the program on the controller. If a person orders an abort during the wait,
    abort.

    Returns:
        The robot's joint positions, and True if the motion was aborted. The positions are None after a reset,
        because the registers count from the position at the reset.
    """
    aborted = False
    operation.watch, operation.patience = (Abort,), _PATIENCE_AT_REST
    while True:
        try:
            longest = LONGEST if aborted else _HELD_WITHIN + 4.0 * robot.controller.hold_time
            motors = yield from come_to_rest(operation, robot, longest)
            break
        except Interrupted:
            operation.orders.clear()
        except Trouble:
            if aborted:
                raise
        # A person has ordered an abort, or the hold doesn't stop the motion, for example another client's
        # jog.
        aborted = True
        yield from operation.abort()
    operation.watch = ()
    yield from leave(operation, robot)
    if were_reset(motors):
        return None, aborted
    return (yield from stands_at(operation, robot)), aborted


def _recover(operation: Operation, stream: Stream | LiveStream, reason: str) -> Script[Ended]:
    """Recover from a lost connection: make another one, hold the motion, and read the robot's position.

    Until there is another connection, the guard PLC holds the motion when the buffer runs low.
    """
    operation.go(Event.LOST, reason, LOST)
    operation.watch = ()
    robot = stream.job.robot
    until = operation.now + AGAIN_FOR
    problem = f"the connection was lost: {reason}"
    # A connection whose replies make no sense may still deliver the hold or the abort.
    yield Control(ABORT_ALL if Abort() in operation.orders else HOLD_ALL)
    while True:
        outcome = yield Connect()
        if isinstance(outcome, Connected):
            try:
                yield from operation.hold_all(robot.controller.hold_time)
                yield from _greet(operation)
                joints, aborted = yield from _end_at_rest(operation, robot)
                if aborted:
                    problem = f"{problem}; then {_ABORTED}"
                yield from Outputs(stream.job).secure(operation)
            except Lost as lost:
                outcome = Unreachable(str(lost))
            except Trouble as trouble:
                operation.go(Event.FAULT, problem, LOST, trouble.remedy)
                return _ended(stream, f"{problem}; then: {trouble.what}", trouble.remedy, None)
            else:
                remedy = (
                    "find the cause, run `yarc doctor`, then continue with --from"
                    if joints is not None
                    else RESET_REMEDY
                )
                operation.go(Event.FAULT, problem, LOST, remedy)
                return _ended(stream, problem, remedy, joints)
        if operation.now >= until:
            silence = f"after {operation.silence:.2g} s without data from this computer"
            remedy = (
                f"its guard PLC holds the motion on the path {silence}; inspect the robot, then run "
                "`yarc doctor`"
            )
            operation.go(Event.FAULT, problem, LOST, remedy)
            return _ended(
                stream, f"{problem}; the controller can't be reached again: {_reason(outcome)}", remedy, None
            )
        yield Wait(operation.now + _AGAIN_EACH)


def _reason(outcome: object) -> str:
    """Return the reason why there is no connection."""
    return outcome.reason if isinstance(outcome, Unreachable) else "it doesn't stay"


_LOST = Trouble("", code=LOST)
"""The fault that is reported if the connection was lost."""


def _ended(
    stream: Stream | LiveStream, problem: str, remedy: str, joints: Array | None, cause: Trouble = _LOST
) -> Ended:
    job, command = stream.job, stream.command if stream.begun else None
    about = command
    if cause.line is not None and 0 <= cause.line < len(job.lines):
        about = job.command_at(float(job.times[cause.line]))
    return Ended(
        False,
        problem,
        remedy,
        joints,
        command.title if command else "",
        command.index if command else "",
        job.offset + stream.done if stream.begun else 0.0,
        cause.code,
        Concerned(about.index, about.name, about.source_line) if about and cause.code else None,
        clock=job.clock + stream.done if stream.begun else 0.0,
    )


def end_leftovers(operation: Operation, robot: Robot) -> Script[bool]:
    """End a program that a failed computer has left unfinished on the controller, in a hold or with an empty
    buffer.

    This is done only if the robot is at rest with all loops closed. A controller on which something moves, or
    a loop is open, is left unchanged.

    Returns:
        True if a program was ended.
    """
    motors = yield from motor_statuses(operation, robot)
    words = yield from system_words(operation, robot)
    if not words.running or any(motor.has("open loop") or not motor.at_rest for motor in motors):
        return False
    yield from come_to_rest(operation, robot)
    yield from leave(operation, robot)
    operation.remark("an unfinished program is ended at the robot's position", warning=True)
    return True


def end_what_runs(operation: Operation, robot: Robot, *, abort: bool) -> Script[Array | None]:
    """Hold or abort everything that the coordinate system does, and end its program at rest. This script is
    for a controller on which no job of this process runs.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot.
        abort: True: abort, and leave the path if necessary; False: hold.

    Returns:
        The robot's joint positions (n,) [rad or m]; None if the controller was reset, so that the position
        isn't known.
    """
    if abort:
        yield from operation.abort()
    else:
        yield from operation.hold(turbo_pmac(robot).coordinate_system, robot.controller.hold_time)
    joints, _ = yield from _end_at_rest(operation, robot)
    if joints is None:
        operation.remark(f"the controller was reset: {RESET_REMEDY}", warning=True)
    else:
        operation.remark(f"the robot is at {described(robot, joints)}")
    return joints
