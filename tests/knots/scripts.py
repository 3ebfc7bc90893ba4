"""The dialogue with the controller of a table of knots: each text line is a request, and gets one line in
reply. Nothing moves by itself except the loaded table.
"""

from __future__ import annotations

import numpy as np

from yarclang.robot.actuation import to_counts
from yarclang.runtime.actions import Closed, Connect, Late, Lost, Trouble, Unreachable, Wait
from yarclang.runtime.inspection import Checked, Inspection
from yarclang.runtime.notices import Abort, Hold, Override, Progress, Resume, Stop
from yarclang.runtime.operation import Operation
from yarclang.runtime.outcome import Ended
from yarclang.runtime.sample import Sample
from yarclang.runtime.scripts import JointPlace, Picture, Scripts
from yarclang.runtime.state import Event, State


class Exchange:
    """A connection that sends a line and receives a line."""

    def __init__(self):
        self.lost, self.deadline, self._got = False, None, b""

    def send(self, request, now, timeout):
        self.deadline = now + timeout
        return request.encode() + b"\n"

    def outgoing(self):
        return b""

    def receive(self, data, now):
        self._got += data
        line, end, rest = self._got.partition(b"\n")
        if not end:
            return ()
        self._got, self.deadline = rest, None
        return (line.decode(),)

    def check(self, now):
        return self._lose(Late("")) if self.deadline is not None and now >= self.deadline else ()

    def close(self):
        return self._lose(Closed(""))

    def _lose(self, event):
        self.lost, self.deadline = True, None
        return (event,)


def ask(operation, line):
    """Send a line, and return the state, the number of rows left, and the position [axis units]."""
    answer = yield line
    if not isinstance(answer, str):
        raise Lost("no answer")
    state, left, place = answer.split(" ")
    return state, int(left), np.array([float(one) for one in place.split(",")])


def connect(operation):
    outcome = yield Connect()
    if isinstance(outcome, Unreachable):
        raise Trouble(outcome.reason, "look at its cable")
    yield from ask(operation, "where")
    if operation.state is State.DISCONNECTED:
        operation.go(Event.CONNECTED)


def look(operation, robot, items):
    state, _, place = yield from ask(operation, "clear" if operation.state is State.FAULT else "where")
    found = Checked("drives", state, "idle", "ok" if state == "idle" else "error", "clear the fault")
    if state == "idle" and operation.state is State.FAULT:
        operation.go(Event.CLEAR, "looked at")
    return Inspection((found,), place * robot.axis_units, state == "idle")


def stands_at(operation, robot):
    _, _, place = yield from ask(operation, "where")
    return place * robot.axis_units


def _tell(operation, robot, place, done):
    counts = to_counts(robot, place * robot.axis_units)
    operation.notices.append(Sample(operation.now, done, counts, np.zeros(len(counts))))


def idle(operation, robot, wanted):
    while not wanted():
        operation.orders.clear()
        _, _, place = yield from ask(operation, "where")
        _tell(operation, robot, place, 0.0)
        yield Wait(operation.now + operation.positions_each)


def perform(operation, job):
    """Load the whole table, run it, and supervise it to its end."""
    robot = job.robot
    operation.go(Event.LOAD, f"loading {job.name}")
    place = yield from stands_at(operation, robot)
    if (np.abs(place - job.start) > job.slack + 1e-6).any():
        operation.go(Event.STOP)
        return Ended(False, "the robot doesn't stand at the start", "move it there", place)
    for line in job.lines:
        yield from ask(operation, f"push {line}")
    yield from ask(operation, "run")
    operation.go(Event.BEGIN)
    rows, done = sum(line[0] not in "T" for line in job.lines), 0.0
    while True:
        while operation.orders:
            order = operation.orders.popleft()
            if isinstance(order, Stop | Abort):
                _, _, place = yield from ask(operation, "stop")
                operation.go(Event.STOP, "stopped on its path")
                return Ended(False, "stopped on its path", "", place * robot.axis_units, done=done)
            if isinstance(order, Hold) and operation.state is State.MOVE:
                yield from ask(operation, "hold")
                operation.go(Event.HOLD, "hold requested")
            if isinstance(order, Resume) and operation.state is State.HOLD:
                yield from ask(operation, "run")
                operation.go(Event.RESUME)
            if isinstance(order, Override):
                operation.remark("it has one pace only", warning=True)
        state, left, place = yield from ask(operation, "where")
        done = job.time_of(len(job.lines) * (rows - left) // max(rows, 1))
        _tell(operation, robot, place, done)
        operation.notices.append(Progress(operation.now, done, job.duration - done, "", 0))
        if state == "fault":
            operation.go(Event.FAULT, "its drives have failed", "Y1602", "look at them")
            return Ended(
                False, "its drives have failed", "look at them", place * robot.axis_units, code="Y1602"
            )
        if state == "idle":
            operation.go(Event.END, f"at the end of {job.name}")
            return Ended(True, joints=job.end, done=job.offset + job.duration, clock=job.clock + job.duration)
        yield Wait(operation.now + operation.positions_each)


def end_what_runs(operation, robot, *, abort):
    _, _, place = yield from ask(operation, "stop")
    return place * robot.axis_units


def end_leftovers(operation, robot):
    state, _, _ = yield from ask(operation, "where")
    if state not in ("run", "hold"):
        return False
    yield from ask(operation, "stop")
    return True


def picture(operation, robot):
    state, left, place = yield from ask(operation, "where")
    joints = zip(robot.joint_names, robot.axis_unit_names, place, strict=True)
    places = tuple(JointPlace(name, unit, float(one), float(one)) for name, unit, one in joints)
    return Picture("a table of knots", "1", f"{state}, {left} rows", 100.0, 0.0, "none", {}, places)


SCRIPTS = Scripts(
    operation=Operation,
    exchange=Exchange,
    last_words=lambda abort: b"hold\n",
    connect=connect,
    look=look,
    idle=idle,
    stands_at=stands_at,
    perform=perform,
    perform_live=None,
    end_leftovers=end_leftovers,
    end_what_runs=end_what_runs,
    picture=picture,
    patience=1.0,
)
