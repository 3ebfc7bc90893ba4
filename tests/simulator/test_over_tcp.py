"""Compiled programs for both targets, sent over TCP to a commissioned machine, end within a count."""

import time

import numpy as np
import pytest

import yarclang
from tests.simulator.serving import Client, served
from yarclang.backend_pmac.settings import settings_text
from yarclang.robot.actuation import to_counts
from yarclang.runtime.actions import Violation
from yarclang.runtime.pmac.protocol import Ask, AskControl, Control, Write, Written, fitting
from yarclang.simulator.commissioning import commissioned

AWAY = "P0010 MOVEJ 10 -20 15 5 6 7 [2] (deg,s)\n"


def lines_of(text):
    stripped = (line.partition(";")[0].strip() for line in text.splitlines())
    return [line for line in stripped if line]


def write(client, lines):
    """Send lines in as few packets as possible, each of which must be accepted completely."""
    first = 0
    while first < len(lines):
        packet = Write(tuple(lines[first : first + fitting(lines, first)]))
        event = client.ask(packet)
        assert isinstance(event, Written), event
        assert event.error is None, (event.error, packet.lines[event.line - 1])
        first += len(packet.lines)


def numbers(client, question):
    event = client.ask(Ask(question))
    assert event.error is None, event
    return [float(item) for item in event.items]


def when_it_stands(client, motors):
    """Wait until the program has ended, and all motors' desired velocities are zero."""
    for _ in range(2000):
        running = int(client.ask(Ask("&1??")).items[0][:6], 16) & 1
        words = [int(client.ask(Ask(f"#{motor}?")).items[0][:6], 16) for motor in motors]
        if not running and all(word >> 13 & 1 for word in words):
            return
        time.sleep(0.005)
    raise AssertionError("the program doesn't end")


@pytest.fixture
def robot(industrial6):
    return industrial6


def test_a_prog_at_the_greatest_rate(robot):
    compiled = yarclang.compile(AWAY, robot="INDUSTRIAL6", target="prog").value
    machine = commissioned(robot, settings_text(robot))
    with served(machine, rate=None) as port, Client(port) as client:
        client.ask(Ask("I6=1 I3=2"))
        write(client, lines_of(compiled.text))
        client.ask(Ask("&1B1R"))
        when_it_stands(client, robot.controller.motors)
        assert_at(client, robot, [10, -20, 15, 5, 6, 7])


def test_a_rotary_at_twenty_times_real_time(robot):
    compiled = yarclang.compile(AWAY, robot="INDUSTRIAL6").value
    machine = commissioned(robot, settings_text(robot))
    with served(machine, rate=20.0) as port, Client(port) as client:
        client.ask(Ask("I6=1 I3=2"))
        write(client, lines_of(compiled.text))
        client.ask(Ask("&1R"))
        for _ in range(1000):
            left = numbers(client, "PR")[0]
            if left == 0:
                break
            time.sleep(0.01)
        time.sleep(0.2)
        assert_at(client, robot, [10, -20, 15, 5, 6, 7])


def assert_at(client, robot, degrees):
    """Check the commanded positions in counts, and the joint positions of PLC 0 in degrees."""
    counts = to_counts(robot, np.radians(degrees))
    motors = robot.controller.motors
    found = np.array(numbers(client, "".join(f"M{motor}61" for motor in motors)))
    scale = np.array(numbers(client, "".join(f"I{motor}08" for motor in motors)))
    assert np.abs(found / (scale * 32) - counts).max() < 1.0
    positions = client.ask(AskControl("\x10")).items[0].split()
    assert np.abs(np.array(positions[: len(motors)], dtype=float) - counts).max() < 2.0
    joints = numbers(client, "".join(robot.controller.feedback))
    assert np.abs(np.array(joints) - degrees).max() < 1e-3


def test_an_abort_stops_a_motion(robot):
    compiled = yarclang.compile(AWAY, robot="INDUSTRIAL6", target="prog").value
    machine = commissioned(robot, settings_text(robot))
    with served(machine, rate=1.0) as port, Client(port) as client:
        client.ask(Ask("I6=1 I3=2"))
        write(client, lines_of(compiled.text))
        client.ask(Ask("&1B1R"))
        time.sleep(0.8)
        client.ask(Control("\x01"))
        when_it_stands(client, robot.controller.motors)
        stands = np.array(numbers(client, "".join(f"#{motor}P" for motor in robot.controller.motors)))
        away = np.abs(stands - to_counts(robot, np.radians([10, -20, 15, 5, 6, 7])))
        assert away.max() > 1000


@pytest.mark.parametrize(
    ("fault", "bit"), [("amplifier@0.5:2", 3), ("following@0.5:2", 2), ("limit@0.5:2-", None)]
)
def test_faults_of_the_machine_show_in_its_status(robot, fault, bit):
    compiled = yarclang.compile(AWAY, robot="INDUSTRIAL6", target="prog").value
    machine = commissioned(robot, settings_text(robot))
    with served(machine, fault, rate=5.0) as port, Client(port) as client:
        client.ask(Ask("I6=1 I3=2"))
        write(client, lines_of(compiled.text))
        client.ask(Ask("&1B1R"))
        for _ in range(500):
            words = int(client.ask(Ask("#2?")).items[0], 16)
            seen = words >> 24 + 22 & 1 if bit is None else words >> bit & 1
            if seen:
                break
            time.sleep(0.01)
        assert seen


def test_after_a_reset_the_framing_tells(robot):
    """$$$ restores the saved I3, so the client notices that the form of replies has changed."""
    machine = commissioned(robot, settings_text(robot))
    with served(machine, "reset@0.3") as port, Client(port, timeout=1.0) as client:
        client.ask(Ask("I6=1 I3=2"))
        time.sleep(0.5)
        event = client.ask(Ask("P1"))
        assert isinstance(event, Violation)
        assert "reset" in event.reason
