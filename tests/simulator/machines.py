"""Machines for the tests: bare ones with simple axes, commissioned ones, and programs loaded into them."""

from functools import cache

from programs import compiled

from yarclang.backend_pmac.settings import settings_text
from yarclang.robot.description import load_robot
from yarclang.simulator.commissioning import commissioned
from yarclang.simulator.machine import Machine
from yarclang.simulator.motion.recorder import Recorder

EXAMPLES = {"INDUSTRIAL6": "01_listing4", "TRACKED_MANIPULATOR": "03_differential_wrist"}


def bare(*definitions, record=True):
    """Return a machine with closed-loop motors in &1, without limits, and with a rotary of 1000 words."""
    machine = Machine(record=Recorder() if record else None)
    say(machine, "I3=2I6=1", "&1")
    for number, definition in enumerate(definitions or ("1000X", "1000Y"), 1):
        say(machine, f"I{number}00=1", f"#{number}->{definition}", f"#{number}J/")
    say(machine, "DEFINE ROT 1000")
    return machine


def say(machine, *lines):
    """Send commands, which must be accepted, and return the answer to the last one."""
    for line in lines:
        reply = machine.command(line)
        assert reply.error is None, (line, reply)
    return reply.items


def error(machine, line):
    return machine.command(line).error


def program(machine, *lines, number=1):
    say(machine, f"OPEN PROG {number} CLEAR", *lines, "CLOSE")


def rotary(machine, *lines):
    say(machine, "B0", "OPEN ROT", *lines, "CLOSE")


def robot_machine(name, record=True):
    robot = load_robot(name).value
    return robot, commissioned(robot, settings_text(robot), record=Recorder() if record else None)


@cache
def example(robot, target, **request):
    """Return the compiled example of a robot."""
    from conftest import EXAMPLES as FOLDER

    text = (FOLDER / f"{EXAMPLES[robot]}.yarc").read_text()
    value, _ = compiled(text, robot, target=target, **request)
    return value


def lines_of(text):
    return [line for line in text.splitlines() if not line.startswith(";")]


def feed(machine, lines, keep=60, step=0.05, until=1e9):
    """Load a rotary's text as a streaming client does; return how many lines were accepted.

    Lines are sent whenever there is room, and R once the buffer is loaded.
    """
    started, at = False, 0
    while at < len(lines) and machine.now < until:
        while at < len(lines):
            reply = machine.command(lines[at])
            if reply.error == 6:
                break
            assert reply.error is None, (lines[at], reply)
            at += 1
        if not started:
            say(machine, "R")
            started = True
        machine.advance(step)
        while at < len(lines) and int(say(machine, "PR")[0]) > keep:
            machine.advance(step)
    return at
