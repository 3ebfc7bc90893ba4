"""One simulated Turbo PMAC: its time, and the commands of its ports."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from yarclang.pmac.defaults import MOTORS, SYSTEMS
from yarclang.pmac.errors import NO_PROGRAM
from yarclang.simulator.motion import trips
from yarclang.simulator.motion.motors import WATCHED, Motor
from yarclang.simulator.motion.pieces import Array
from yarclang.simulator.motion.recorder import Recorder
from yarclang.simulator.motion.system import CoordinateSystem
from yarclang.simulator.network.ports import Port
from yarclang.simulator.network.reply import Refusal, Reply, framed
from yarclang.simulator.online import background, controls, interpreter
from yarclang.simulator.online.background import Background
from yarclang.simulator.online.questions import answered, questions
from yarclang.simulator.programs.buffers import Buffers
from yarclang.simulator.programs.plcs import Plcs
from yarclang.simulator.state.registers import Variables
from yarclang.simulator.state.saved import Saved, restore, saved
from yarclang.simulator.state.wiring import wire

_MOST_WORDS = 1000


class Companion(Protocol):
    """A machine outside of the controller that runs in the controller's time, such as a machine around the
    robot.
    """

    @property
    def next_event(self) -> float:
        """Time of its next event [s]; -inf for now."""
        ...

    def handle(self) -> None:
        """Handle the events that are due."""
        ...


class Machine:
    """One Turbo PMAC in the state after `$$$***`. `commissioning` creates machines that are ready for a
    robot.

    The machine has no clock: `advance` moves its time from event to event. It has no connections either: each
    line comes with the number of a port. A port has its own addressing (#, &) and its own open buffer.

    Attributes:
        record: records the motions; None for no recording.
        variables: variables and memory.
        under_way: motors with a motion of their own (jog, home search or abort), outside a coordinate
            system's program, by number.
        motors: motors by number, 1 to 32.
        systems: coordinate systems by number, 1 to 16.
        ports: ports by number.
        plcs: the PLCs.
        buffers: PROG, PLC and rotary buffers.
        programs: PROG buffers by number.
        background: interpreter of the lines that programs send (CMD).
        unknown_words: the words of programs that the simulator skips, in the order of their first use,
            each with its number of uses.
        companions: machines outside of the controller that run in its time.
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
        self.ports: dict[int, Port] = {}
        self.plcs = Plcs(self.variables, self)
        self.buffers = Buffers(self.systems, self.plcs, self.ports, self.variables.i)
        self.programs = self.buffers.programs
        self.background = Background(self)
        self.unknown_words: dict[str, int] = {}
        self.companions: list[Companion] = []
        self._messages: dict[int, deque[str]] = {0: deque(maxlen=_MOST_WORDS)}
        self._saved: Saved | None = None
        self.timers = wire(self)
        self.variables.on_i = self._variable_changed
        self.initialise()

    # time

    @property
    def now(self) -> float:
        """Virtual time [s]."""
        return self._now

    @property
    def servo_period(self) -> float:
        """Time between servo interrupts [s] (TSRM 43). At least 0.05 ms: no controller of this kind is
        faster.
        """
        return max(self.variables.i[10] / 8_388_608.0, 0.05) * 1e-3

    @property
    def interrupt(self) -> float:
        """Time between real-time interrupts [s]: I8 + 1 servo periods."""
        return (min(max(self.variables.i[8], 0.0), 255.0) + 1.0) * self.servo_period

    def advance(self, seconds: float) -> None:
        """Advance the time [s], and execute the motions, PLCs and programs of this interval."""
        end = self._now + seconds
        while (when := self._next_event()) <= end:
            self._now = max(when, self._now)
            self._handle()
        self._now = end

    def _next_event(self) -> float:
        event_time = self.plcs.next_event
        for motor in self.under_way.values():
            event_time = min(event_time, motor.next_event)
        for system in self._used:
            event_time = min(event_time, system.next_event)
        for companion in self.companions:
            event_time = min(event_time, companion.next_event)
        return event_time

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
            system.handle()
        self.plcs.handle()
        self.background.handle()
        for companion in self.companions:
            companion.handle()

    # ports

    def command(self, line: str, port: int = 0) -> Reply:
        """Execute a line, or store it in the buffer that is open on its port."""
        on = self.ports.get(port) or self._port(port)
        if not on.open and (asked := questions(line)):
            return answered(self, on, asked)
        return interpreter.execute(self, on, line)

    def control(self, character: int, port: int = 0) -> Reply:
        """Execute a control character, 1 for ^A to 26 for ^Z."""
        return controls.control_reply(self, character, self._port(port))

    def respond(self, line: str, port: int = 0) -> bytes:
        """Execute a line as `command` does, and return the reply in bytes, framed according to I3 and I6."""
        reply = self.command(line, port)
        return framed(reply, int(self.variables.i[3]), int(self.variables.i[6]))

    def messages(self, port: int = 0) -> tuple[str, ...]:
        """Return the texts that programs have sent (SEND) since the last call for this port."""
        self._port(port)
        sent = tuple(self._messages[port])
        self._messages[port].clear()
        return sent

    def _port(self, number: int) -> Port:
        if number not in self.ports:
            self.ports[number] = Port()
        if number not in self._messages and number != background.PORT:
            self._messages[number] = deque(maxlen=_MOST_WORDS)
        return self.ports[number]

    def run(self, number: int, single_step: bool = False) -> None:
        """Execute R, or S for a single step, in a coordinate system.

        Raises:
            Refusal: ERR010 to ERR017; ERR015 while a PROG or PLC is open (TSRM 381).
        """
        if any(port.open in ("prog", "plc") for port in self.ports.values()):
            raise Refusal(NO_PROGRAM)
        self.systems[number].run(single_step)

    # for programs

    def say(self, text: str) -> None:
        """Execute SEND: send a text to every port of the controller (assumed; a real controller sends it only
        to the port that SEND names).
        """
        for messages in self._messages.values():
            messages.append(text)

    def queue(self, text: str, system: int, motor: int = 1) -> None:
        """Execute CMD: give a line to the background interpreter.

        Args:
            text: the line.
            system: number of the coordinate system that the line addresses.
            motor: number of the motor that the line addresses.
        """
        self.background.put(text, system, motor)

    def unknown(self, word: str) -> None:
        """Count a word of a program that the simulator skips."""
        if word in self.unknown_words or len(self.unknown_words) < _MOST_WORDS:
            self.unknown_words[word] = self.unknown_words.get(word, 0) + 1

    def switch_plcs(self, name: str, numbers: Sequence[int]) -> None:
        """Execute ENABLE, DISABLE, PAUSE or RESUME for PLCs."""
        self.plcs.switch(name, numbers)

    # for the components of the machine

    def changed(self, motors: Sequence[Motor]) -> None:
        """Record that motors move differently from now on."""
        if self.record is None:
            return
        for motor in motors:
            if motor.profile is not None:
                self.record.note(self._now, motor.number, motor.profile, 0)
            elif motor.driver is not None:
                driver, index = motor.driver
                self.record.note(self._now, motor.number, driver.motion, index)
            else:
                self.record.stands(self._now, motor.number, motor.stand)

    def defined(self) -> None:
        """Update the list of coordinate systems in use (those with motors) after a change of axis
        definitions.
        """
        self._used = tuple(system for system in self.systems.values() if system.motors)

    def system_of(self, motor: Motor) -> CoordinateSystem | None:
        """Return the coordinate system in which a motor is defined; None without one."""
        for system in self.systems.values():
            if motor.number in system.definitions:
                return system
        return None

    def tripped(self, motor: Motor, cause: str) -> None:
        """Handle a limit or a fatal following error of a motor."""
        trips.tripped(self, motor, cause)

    def _variable_changed(self, number: int) -> None:
        if number % 100 in WATCHED and 1 <= number // 100 <= MOTORS:
            trips.look(self, self.motors[number // 100])
        if number == 5:
            self.plcs.changed()

    # faults, reset and power-up

    def fault_amplifier(self, motor: int) -> None:
        """Set an amplifier fault on a motor, and kill it."""
        self.motors[motor].amplifier_fault = True
        trips.kill(self, self.motors[motor])

    def clear_fault(self, motor: int) -> None:
        """Clear the amplifier fault of a motor, so that its loop can be closed."""
        self.motors[motor].amplifier_fault = False

    def set_limit_switch(self, motor: int, side: int, on: bool) -> None:
        """Set the state of a limit switch of a motor. If Ixx24 bit 17 disables the switches, the switch stays
        off.

        Args:
            motor: number of the motor.
            side: +1 or -1, the positive or the negative switch.
            on: True if the switch is hit.
        """
        trips.switch(self.motors[motor], side, on)
        trips.look(self, self.motors[motor])

    def disturb(self, motor: int, counts: float) -> None:
        """Keep a motor a number of counts away from its commanded position. This causes a following error."""
        self.motors[motor].disturbance = counts
        trips.look(self, self.motors[motor])

    def reset(self) -> None:
        """Execute `$$$`: restart with the saved state. Time continues; ports lose their state."""
        self._power_up(self._saved)

    def initialise(self) -> None:
        """Execute `$$$***`: restart with defaults. The saved state is kept."""
        self._power_up(None)

    def save(self) -> None:
        """Execute SAVE."""
        self._saved = saved(self.variables, self.programs, self.plcs, self.systems)

    def _power_up(self, saved: Saved | None) -> None:
        """Restart with a saved state, or with defaults (None)."""
        self.variables.initialise()
        self.buffers.forget()
        self.ports.clear()
        self.background.clear()
        self.timers.clear()
        self.under_way.clear()
        for motor in self.motors.values():
            motor.clear()
        for system in self.systems.values():
            system.clear()
        if saved is not None:
            restore(saved, self.variables, self.programs, self.plcs, self.systems, self.motors)
        self.defined()
        self.plcs.changed()
        self.changed(list(self.motors.values()))

    # for observers

    def positions(self, times: Array | None = None, motors: Sequence[int] | None = None) -> Array:
        """Return commanded positions of motors [counts], now or in the past.

        Args:
            times: (N,) [s], between the start of the recording and now; they need a recorder. None for now.
            motors: numbers of the motors; None for all motors with an axis.

        Returns:
            The positions as (len(motors),), or as (N, len(motors)) for `times`.

        Raises:
            ValueError: for times in the future, or for times without a recorder.
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
            raise ValueError("positions of the future aren't known")
        return np.stack([self.record.positions(n, times) for n in numbers], axis=1)
