"""On-line commands for the addressed motor: reports, jogs, home, K and O."""

from __future__ import annotations

import re

from yarclang.pmac.defaults import MOTORS
from yarclang.pmac.errors import BUSY_PROGRAM, DATA, OPEN_LOOP
from yarclang.simulator.language.arithmetic import value_of
from yarclang.simulator.motion.motors import Motor
from yarclang.simulator.network.reply import Refusal
from yarclang.simulator.online.line import Line
from yarclang.simulator.online.questions import REPORTS


def address(line: Line, match: re.Match[str]) -> None:
    """Execute #n or ##n, or answer # alone."""
    if not match[1]:
        line.items.append(str(line.port.motor))
        return
    if not 1 <= int(match[1]) <= MOTORS:
        raise Refusal(DATA)
    line.port.motor = int(match[1])


def report(line: Line, match: re.Match[str]) -> None:
    """Answer P (counts), V (counts per servo cycle) or F (counts)."""
    if text := REPORTS[match[0]](line.machine, line.port):
        line.items.append(text)


def jog(line: Line, match: re.Match[str]) -> None:
    """Execute a jog command: J and the rest of it."""
    machine, now = line.machine, line.machine.now
    motor = _free(line)
    if not motor.activated:
        raise Refusal(DATA)
    kind = match[1]
    if kind == "/":
        if motor.amplifier_fault:
            raise Refusal(OPEN_LOOP)
        if motor.closed:
            motor.jog_stop(now)
        else:
            motor.close(now)
        machine.changed([motor])
        return
    target = _target(line, motor, kind)
    if not motor.closed:
        raise Refusal(OPEN_LOOP)
    if not motor.jogging:
        motor.before_jog = motor.place(now)[0]
    if kind in "+-":
        motor.jog(now, 1 if kind == "+" else -1)
    else:
        motor.jog_to(now, target)
    machine.changed([motor])


def _free(line: Line) -> Motor:
    """Return the addressed motor if it is free for a command: no program runs in its coordinate system, or
    the program is held.

    Raises:
        Refusal: ERR001 while a program runs.
    """
    motor = line.motor
    system = line.machine.system_of(motor)
    if system is not None and system.busy and system.drive.held_at is None:
        raise Refusal(BUSY_PROGRAM)
    return motor


def _target(line: Line, motor: Motor, kind: str) -> float:
    if kind in "+-":
        return 0.0
    now = line.machine.now
    if line.reader.has_data():
        value = value_of(line.reader.data(), line.scope)
    elif kind == "=":
        return motor.before_jog
    else:
        raise Refusal(DATA)
    base = {"=": 0.0, "^": motor.actual(now), ":": motor.place(now)[0]}[kind]
    return base + value


def home(line: Line, match: re.Match[str]) -> None:
    """Execute HM or HMZ."""
    motor, now = _free(line), line.machine.now
    if not motor.activated:
        raise Refusal(DATA)
    if match[0].endswith("Z"):
        motor.zero(now)
    else:
        if not motor.closed:
            raise Refusal(OPEN_LOOP)
        motor.home(now)
    line.machine.changed([motor])


def kill(line: Line, _: re.Match[str]) -> None:
    """Execute K."""
    motor = _free(line)
    motor.kill(line.machine.now)
    line.machine.changed([motor])


def open_loop(line: Line, _: re.Match[str]) -> None:
    """Execute O: open the loop, with an output in percent. The motor doesn't move (assumed)."""
    motor = _free(line)
    line.reader.constant()
    motor.kill(line.machine.now)
    motor.enabled = True
    line.machine.changed([motor])
