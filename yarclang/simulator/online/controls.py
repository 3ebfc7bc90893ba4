"""Control characters (TSRM 259-270): commands to all motors or coordinate systems, and reports for groups of
8 motors.
"""

from __future__ import annotations

from yarclang.pmac.defaults import MOTORS
from yarclang.simulator.network.ports import Port
from yarclang.simulator.network.reply import Refusal, Reply
from yarclang.simulator.online.surroundings import Controller
from yarclang.simulator.state import status
from yarclang.simulator.state.registers import printed


def control_reply(machine: Controller, character: int, port: Port) -> Reply:
    """Execute a control character, 1 for ^A to 26 for ^Z. Unknown characters have no effect."""
    letter = chr(character + 64) if 1 <= character <= 26 else ""
    try:
        return Reply(tuple(_done(machine, letter, port)))
    except Refusal as refusal:
        return Reply((), refusal.number)


def _done(machine: Controller, letter: str, port: Port) -> list[str]:
    first = (port.motor - 1) // 8 * 8 + 1
    group = [machine.motors[n] for n in range(first, min(first + 8, MOTORS + 1))]
    now = machine.now
    match letter:
        case "A":
            for system in machine.systems.values():
                if system.motors:
                    system.abort()
            for motor in machine.motors.values():
                if machine.system_of(motor) is None and motor.jogging:
                    motor.abort(now)
                    machine.changed([motor])
        case "D":
            machine.switch_plcs("DISABLE", range(32))
        case "K":
            for system in machine.systems.values():
                if system.motors:
                    system.stop_program()
            for motor in machine.motors.values():
                if motor.activated:
                    motor.kill(now)
            machine.changed(list(machine.motors.values()))
        case "L":
            machine.buffers.close(port)
        case "O" | "Q":
            for system in machine.systems.values():
                if system.motors:
                    system.drive.hold() if letter == "O" else system.quit()
        case "R" | "S":
            for number, system in machine.systems.items():
                if system.motors:
                    machine.run(number, single_step=letter == "S")
        case "U":
            machine.buffers.open(port, "rotary", 0)
        case "B":
            return [" ".join(status.digits(machine, 1, motor.number, 1) for motor in group)]
        case "C":
            return [" ".join(status.digits(machine, 2, 1, n) for n in range(1, 9))]
        case "G":
            return [status.digits(machine, 3, 1, 1)]
        case "F":
            return [" ".join(printed(motor.following_error(now), 1) for motor in group)]
        case "P":
            return [" ".join(printed(round(motor.actual(now) * 32.0) / 32.0, 5) for motor in group)]
        case "V":
            rate = machine.servo_period
            return [" ".join(printed(motor.place(now)[1] * rate, 3) for motor in group)]
        case _:
            pass
    return []
