"""One Turbo PMAC: what its ports may ask of it, and its time."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from yarclang.pmac.defaults import MOTORS, SYSTEMS, default_variables
from yarclang.pmac.errors import DATA, NO_PROGRAM
from yarclang.robot.actuation import to_counts
from yarclang.robot.model import Robot
from yarclang.simulator.axes import AxisDefinition
from yarclang.simulator.buffers import Buffers
from yarclang.simulator.controls import control_reply
from yarclang.simulator.motors import WATCHED, Motor
from yarclang.simulator.online import OnLine, Port
from yarclang.simulator.pieces import Array
from yarclang.simulator.plc import Plc
from yarclang.simulator.programs import Program
from yarclang.simulator.questions import Question, questions
from yarclang.simulator.recorder import Recorder
from yarclang.simulator.registers import Definition, Variables
from yarclang.simulator.reply import Refusal, Reply, framed
from yarclang.simulator.status import (
    motor_word_1,
    motor_word_2,
    system_word_1,
    system_word_2,
    system_word_3,
)
from yarclang.simulator.system import CoordinateSystem
from yarclang.simulator.wiring import wire

SCAN = 5e-3
"""The time between two scans of the background PLCs [s] (assumed; it depends on what the controller has to do)."""

_COMMAND_PORT = -1
_LONGEST_QUEUE = 64
_MOST_WORDS = 1000


@dataclass(frozen=True, slots=True)
class _Saved:
    """What SAVE keeps: all but rotaries, positions and what runs."""

    i: list[float]
    p: list[float]
    q: list[dict[int, float]]
    m: dict[int, Definition]
    programs: dict[int, Program]
    plcs: dict[int, Program]
    definitions: dict[int, dict[int, AxisDefinition]]


class Machine:
    """One Turbo PMAC after `$$$***`, or as `commissioned` leaves it.

    It has no clock: time passes by `advance`, from event to event. It has no ports either: a port is a number
    that comes with a line, and has its own addressing (#, &) and its own open buffer.

    Attributes:
        motors: by number, 1 to 32.
        systems: coordinate systems by number, 1 to 16.
        programs: PROG buffers by number.
        plcs: PLCs by number, as far as they were opened.
        unknown_words: words of programs that were skipped, in the order of their first use.
    """

    def __init__(self, *, record: Recorder | None = None) -> None:
        self._now = 0.0
        self.record = record
        self.variables = Variables()
        self.under_way: dict[int, Motor] = {}
        self.motors = {n: Motor(n, self.variables.i, self.under_way) for n in range(1, MOTORS + 1)}
        self.systems = {
            n: CoordinateSystem(n, self.variables.i, self.variables.scope(n), self)
            for n in range(1, SYSTEMS + 1)
        }
        self._used: tuple[CoordinateSystem, ...] = ()
        self.programs: dict[int, Program] = {}
        self.plcs: dict[int, Plc] = {}
        self.unknown_words: dict[str, int] = {}
        self.gathering = False
        self.ports: dict[int, Port] = {}
        self._messages: dict[int, deque[str]] = {0: deque(maxlen=_MOST_WORDS)}
        self._queue: deque[tuple[str, int, int]] = deque()
        self._saved: _Saved | None = None
        self._next_scan = math.inf
        self._next_interrupt = math.inf
        self._refreshing = False
        self._background: list[Plc] = []
        self._eager: Plc | None = None
        self._lazy: Plc | None = None
        self.buffers = Buffers(self)
        self._timers = wire(self)
        self.variables.refresh = self._refresh
        self.variables.on_i = self._variable_changed
        self.initialise()

    # time

    @property
    def now(self) -> float:
        """The virtual time [s]."""
        return self._now

    @property
    def servo_period(self) -> float:
        """The time between servo interrupts [s] (TSRM 43), not below 0.05 ms: no such controller keeps up."""
        return max(self.variables.i[10] / 8_388_608.0, 0.05) * 1e-3

    @property
    def interrupt(self) -> float:
        """The time between real-time interrupts [s]: I8 + 1 servo periods."""
        return (min(max(self.variables.i[8], 0.0), 255.0) + 1.0) * self.servo_period

    def advance(self, seconds: float) -> None:
        """Let time pass [s]: motions, PLCs and programs do what they do in it."""
        end = self._now + seconds
        while (when := self._next_event()) <= end:
            self._now = max(when, self._now)
            self._handle()
        self._now = end

    def _next_event(self) -> float:
        when = min(self._next_scan, self._next_interrupt)
        for motor in self.under_way.values():
            when = min(when, motor.next_event)
        for system in self._used:
            when = min(when, system.next_event)
        return when

    def _handle(self) -> None:
        now = self._now
        for motor in list(self.under_way.values()):
            if motor.trip is not None and now >= motor.trip[0]:
                self.tripped(motor, motor.trip[1])
            elif motor.profile is not None and now >= motor.profile.end:
                motor.arrive()
                self.changed([motor])
                for system in self.systems.values():
                    if motor in system.homing:
                        system.wake()
        for system in self._used:
            if system.next_event <= now:
                system.handle()
        if now >= self._next_interrupt:
            self._next_interrupt = now + self.interrupt
            if self._eager is not None:
                self._eager.scan(self.variables, self)
        if now >= self._next_scan:
            self._next_scan = now + SCAN
            for plc in self._background:
                if plc.active:
                    plc.scan(self.variables, self)
        if self._queue:
            self._run_queue()

    def _run_queue(self) -> None:
        """CMD: the background interpreter. What it answers goes nowhere; an error neither (I6 = 2 and 0 hush it)."""
        due, self._queue = self._queue, deque()
        for text, system, motor in due:
            port = self.ports[_COMMAND_PORT] = Port(motor, system)
            if text.startswith("^"):
                self.control(ord(text[1]) - 64, _COMMAND_PORT)
            else:
                self.command(text, _COMMAND_PORT)
            if _COMMAND_PORT not in self.ports:
                # a reset: nothing that was queued before it is left
                return
            self.buffers.release(port)

    # ports

    def command(self, line: str, port: int = 0) -> Reply:
        """Execute a line, or store it in the buffer that is open on this port."""
        on = self.ports.get(port) or self._port(port)
        if not on.open and (asked := questions(line)):
            return self._answered(asked, on)
        work = OnLine(self, on)
        try:
            work.execute(line)
        except Refusal as refusal:
            return Reply(tuple(work.items), refusal.number)
        return Reply(tuple(work.items))

    def _answered(self, asked: tuple[Question, ...], on: Port) -> Reply:
        """What a line that only asks is told: values up to the first that is refused."""
        items: list[str] = []
        error = None
        try:
            for question in asked:
                item = question(self, on)
                if item is not None:
                    items += (item,)
        except Refusal as refusal:
            error = refusal.number
        return Reply(tuple(items), error)

    def control(self, character: int, port: int = 0) -> Reply:
        """Execute a control character, 1 for ^A to 26 for ^Z."""
        return control_reply(self, character, self._port(port))

    def respond(self, line: str, port: int = 0) -> bytes:
        """`command`, and the reply as bytes, framed as I3 and I6 say."""
        reply = self.command(line, port)
        return framed(reply, int(self.variables.i[3]), int(self.variables.i[6]))

    def messages(self, port: int = 0) -> tuple[str, ...]:
        """What programs have sent (SEND) since this port last asked; it comes without a request."""
        self._port(port)
        sent = tuple(self._messages[port])
        self._messages[port].clear()
        return sent

    def forget_port(self, port: int) -> None:
        """A port is gone: its buffer is closed, its messages are lost."""
        if found := self.ports.pop(port, None):
            self.buffers.release(found)
        if port:
            self._messages.pop(port, None)

    def _port(self, number: int) -> Port:
        if number not in self.ports:
            self.ports[number] = Port()
        if number not in self._messages and number != _COMMAND_PORT:
            self._messages[number] = deque(maxlen=_MOST_WORDS)
        return self.ports[number]

    # what programs reach

    def say(self, text: str) -> None:
        """SEND: to every port (the controller sends to the port that the word names; assumed)."""
        for messages in self._messages.values():
            messages.append(text)

    def queue(self, text: str, system: int, motor: int = 1) -> None:
        """CMD: a line for the background interpreter, and what it addresses."""
        if len(self._queue) < _LONGEST_QUEUE:
            self._queue.append((text, system, motor))

    def unknown(self, word: str) -> None:
        """A word of a program that is skipped."""
        if word in self.unknown_words or len(self.unknown_words) < _MOST_WORDS:
            self.unknown_words[word] = self.unknown_words.get(word, 0) + 1

    def switch_plcs(self, name: str, numbers: Sequence[int]) -> None:
        """ENABLE, DISABLE, PAUSE or RESUME PLCs; those that don't exist are passed over."""
        for number in numbers:
            if (plc := self.plcs.get(number)) is None:
                continue
            match name:
                case "ENABLE":
                    plc.enable()
                case "DISABLE":
                    plc.disable()
                case _:
                    plc.paused = name == "PAUSE"
        self.plcs_changed()

    def changed(self, motors: Sequence[Motor]) -> None:
        """Motors move otherwise from now on."""
        if self.record is None:
            return
        for motor in motors:
            if motor.profile is not None:
                self.record.note(self._now, motor.number, motor.profile, 0)
            elif motor.driver is not None:
                system, index = motor.driver
                if isinstance(system, CoordinateSystem):
                    self.record.note(self._now, motor.number, system.motion, index)
            else:
                self.record.stands(self._now, motor.number, motor.stand)

    def defined(self) -> None:
        """Axis definitions have changed: only coordinate systems with motors have anything to do."""
        self._used = tuple(system for system in self.systems.values() if system.motors)

    def system_of(self, motor: Motor) -> CoordinateSystem | None:
        """The coordinate system that a motor is defined in."""
        for system in self.systems.values():
            if motor.number in system.definitions:
                return system
        return None

    def status(self, marks: int, motor: int, system: int) -> str:
        """The hexadecimal digits of ?, ?? or ???."""
        if marks == 1:
            found = self.motors[motor]
            owner = self.system_of(found)
            words: tuple[int, ...] = (
                motor_word_1(found, owner, self._now),
                motor_word_2(found, owner, self._now),
            )
        elif marks == 2:
            each = self.systems[system]
            words = system_word_1(each), system_word_2(each, self._now), system_word_3(each)
        else:
            words = self.global_words()
        return "".join(f"{word:06X}" for word in words)

    def global_words(self) -> tuple[int, int]:
        """Both words of `???`: bits 20 to 16 of the first say which buffers are open (assumed)."""
        kinds = {port.open for port in self.ports.values()}
        opened = ("rotary" in kinds) << 16 | ("prog" in kinds) << 17 | ("plc" in kinds) << 18
        return opened, 0

    def run(self, number: int, single_step: bool = False) -> None:
        """R or S in a coordinate system.

        Raises:
            Refusal: ERR010 to ERR017; ERR015 while a PROG or PLC is open (TSRM 381).
        """
        if any(port.open in ("prog", "plc") for port in self.ports.values()):
            raise Refusal(NO_PROGRAM)
        self.systems[number].run(single_step)

    # PLCs

    def plcs_changed(self) -> None:
        """Find out which PLCs want time, and whether PLC 0 can wait until its results are read."""
        i5 = int(self.variables.i[5])
        foreground = self.plcs.get(0)
        self._eager = self._lazy = None
        self.variables.lazy = frozenset()
        if foreground is not None and foreground.active and i5 & 1:
            if results := foreground.results():
                self._lazy, self.variables.lazy = foreground, results
            else:
                self._eager = foreground
        self._background = [
            plc for number, plc in sorted(self.plcs.items()) if number and plc.active and i5 & 2
        ]
        if not self._background:
            self._next_scan = math.inf
        elif self._next_scan == math.inf:
            self._next_scan = self._now + SCAN
        if self._eager is None:
            self._next_interrupt = math.inf
        elif self._next_interrupt == math.inf:
            self._next_interrupt = self._now + self.interrupt

    def _refresh(self) -> None:
        """Somebody reads what PLC 0 computes: it is computed now, not at the interrupt before."""
        if self._lazy is None or self._refreshing:
            return
        self._refreshing = True
        try:
            self._lazy.scan(self.variables, self)
        finally:
            self._refreshing = False

    # what happens to it

    def tripped(self, motor: Motor, cause: str) -> None:
        """A motor meets a limit (its coordinate system aborts) or a fatal following error (it is killed)."""
        system = self.system_of(motor)
        motor.trip = None
        if cause == "limit":
            motor.limit_stop = True
            if system is not None and system.busy:
                system.limit_stop = True
                system.abort()
            else:
                motor.abort(self._now)
            motor.limit_stop = True
            self.changed([motor])
            return
        motor.fatal_error = True
        self._killed(motor)

    def fault_amplifier(self, motor: int) -> None:
        """The amplifier of a motor reports a fault."""
        self.motors[motor].amplifier_fault = True
        self._killed(self.motors[motor])

    def clear_fault(self, motor: int) -> None:
        """The amplifier is well again, so that the loop can be closed."""
        self.motors[motor].amplifier_fault = False

    def _killed(self, motor: Motor) -> None:
        """A fault kills the motor; with which others, Ixx24 bits 22 and 21 say: 0 all, 1 those of its
        coordinate system, else none (assumed).
        """
        extent = int(motor.tuning(24)) >> 21 & 3
        system = self.system_of(motor)
        if system is not None:
            system.abort()
        others: list[Motor] = []
        if extent == 0:
            others = [other for other in self.motors.values() if other.activated]
            for each in self.systems.values():
                if each is not system and each.busy:
                    each.abort()
        elif extent == 1 and system is not None:
            others = system.motors
        for other in {id(m): m for m in (motor, *others)}.values():
            other.kill(self._now)
            self.changed([other])

    def set_limit_switch(self, motor: int, side: int, on: bool) -> None:
        """A limit switch of a motor opens or closes; `side` is +1 or -1. Ixx24 bit 17 makes it not be looked at."""
        found = self.motors[motor]
        found.switches[1 if side > 0 else -1] = on and not int(found.tuning(24)) & 0x20000
        self._look(found)

    def disturb(self, motor: int, counts: float) -> None:
        """Something holds the motor `counts` away from where it would be: a following error."""
        found = self.motors[motor]
        found.disturbance = counts
        self._look(found)

    def _look(self, motor: Motor) -> None:
        """Whether a motor trips at once."""
        if motor.closed and (cause := motor.tripped(*motor.place(self._now))):
            self.tripped(motor, cause)
            return
        motor.look_again()
        system = self.system_of(motor)
        if system is not None:
            system.look_again()

    def reset(self) -> None:
        """What `$$$` does: power-up with what was saved. Time goes on, ports keep nothing."""
        self._power_up(self._saved)

    def initialise(self) -> None:
        """What `$$$***` does: everything at its default. What was saved stays saved."""
        self._power_up(None)

    def save(self) -> None:
        """SAVE."""
        v = self.variables
        self._saved = _Saved(
            list(v.i),
            list(v.p),
            [dict(q) for q in v.q],
            dict(v.m),
            {number: program.copy() for number, program in self.programs.items()},
            {number: plc.program.copy() for number, plc in self.plcs.items()},
            {number: dict(system.definitions) for number, system in self.systems.items()},
        )

    def _power_up(self, saved: _Saved | None) -> None:
        v = self.variables
        i = v.i
        v.initialise()
        i[:] = saved.i if saved else v.i
        v.i = i
        if saved:
            v.p, v.q, v.m = list(saved.p), [dict(q) for q in saved.q], dict(saved.m)
        self.programs = {n: program.copy() for n, program in saved.programs.items()} if saved else {}
        self.plcs = {}
        for number, program in (saved.plcs if saved else {}).items():
            plc = self.plcs[number] = Plc(number)
            plc.program = program.copy()
            plc.enable()
        self.ports.clear()
        self._queue.clear()
        self._timers.ends.clear()
        self.gathering = False
        self.under_way.clear()
        for motor in self.motors.values():
            motor.clear()
        for number, system in self.systems.items():
            system.motors, system.definitions = [], {}
            system.calculation.rotary = None
            system.clear()
            for motor_number, definition in (saved.definitions[number] if saved else {}).items():
                system.define(self.motors[motor_number], definition)
        self.defined()
        self.plcs_changed()
        self.changed(list(self.motors.values()))

    def default_of(self, letter: str, first: int, last: int) -> list[float]:
        """The factory values of variables (I1=*)."""
        if letter != "I":
            raise Refusal(DATA)
        defaults = default_variables()
        return [defaults.get(index, 0.0) for index in range(first, last + 1)]

    def _variable_changed(self, number: int) -> None:
        if number % 100 in WATCHED and 1 <= number // 100 <= MOTORS:
            self._look(self.motors[number // 100])
        if number == 5:
            self.plcs_changed()

    # for those who look

    def positions(self, times: Array | None = None, motors: Sequence[int] | None = None) -> Array:
        """Commanded positions [counts] of `motors` (all that have an axis, if none are named).

        Args:
            times: (N,) instants [s]: any, with a recorder, since it records, and not later than now; None for now.
            motors: their numbers.

        Returns:
            (len(motors),), or (N, len(motors)) for `times`.

        Raises:
            ValueError: for instants in the future, or in the past without a recorder.
        """
        numbers = (
            motors
            if motors is not None
            else sorted(n for system in self.systems.values() for n in system.definitions)
        )
        if times is None:
            return np.array([self.motors[n].place(self._now)[0] for n in numbers])
        if self.record is None:
            raise ValueError("positions of the past need a recorder")
        if len(times) and max(times) > self._now + 1e-9:
            raise ValueError("the future isn't known")
        return np.stack([self.record.positions(n, times) for n in numbers], axis=1)


def commissioned(robot: Robot, settings: str, *, record: Recorder | None = None) -> Machine:
    """A machine as a robot's controller stands ready: settings loaded and saved, PLCs enabled, motors activated,
    closed-loop and homed, at the robot's HOME.

    Args:
        robot: whose controller it is.
        settings: what `yarc settings` prints.
        record: keeps the motions.

    Raises:
        ValueError: where the machine refuses a line of the settings.
    """
    machine = Machine(record=record)
    for motor in robot.controller.motors:
        machine.command(f"I{motor}00=1")
    for number, line in enumerate(settings.splitlines(), 1):
        reply = machine.command(line)
        if reply.error is not None:
            raise ValueError(f"line {number} of the settings, {line!r}: ERR{reply.error:03d}")
    machine.save()
    stand(machine, robot, robot.home)
    return machine


def stand(machine: Machine, robot: Robot, q: Array) -> None:
    """Put the motors of a machine, closed-loop and homed, where the joints are at `q` (n,) [rad or m]."""
    for motor, counts in zip(robot.controller.motors, to_counts(robot, q), strict=True):
        found = machine.motors[motor]
        found.hold(machine.now)
        found.stand = float(counts)
        found.closed = found.enabled = found.homed = True
        machine.changed([found])
    for system in machine.systems.values():
        system.pmatch()
