"""The host fails while few lines are in the buffer: wherever that happens, also among lines that don't move
the robot, the guard stops it on its path.
"""

import re

import numpy as np
import pytest
from programs import compiled
from simulator.machines import feed, lines_of, robot_machine, say

from yarclang.pmac.variables import ARMED, DISARMS
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.simulator.programs import plcs

BEGIN = "OUTPUT A M20\nDEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [4]\n"
SETS = "".join(f"P{100 + k:04d} SET A {('ON', 'OFF')[k % 2]}\n" for k in range(24))
BLENDED = (
    "P0020 MOVEL 120 1174.4 1176 0 0 0 [1.6] BLEND 20\n"
    "{sets}P0400 MOVEL 120 1174.4 1060 0 0 0 [1.6] BLEND 20\n"
    "P0410 MOVEL 240 1174.4 1060 0 0 0 [1.6]\n"
)
SEPARATE = "P0020 MOVEL 120 1174.4 1176 0 0 0 [2]\n{sets}P0400 MOVEL 120 1174.4 1060 0 0 0 [2]\n"
END = "P0900 STOP\n"


def off_path(value, last):
    """Return how far the robot stands from its planned path if line `last` is the last one that the host
    sends [rad, m], and whether the guard has held it.
    """
    robot, machine = robot_machine("INDUSTRIAL6")
    for motor, counts in zip(
        robot.controller.motors, to_counts(robot, value.plan.program.start), strict=True
    ):
        say(machine, f"#{motor}J={counts:.3f}")
    machine.advance(30)
    feed(machine, lines_of(value.text)[:last], keep=50, step=0.02)
    machine.advance(15)
    q = from_counts(robot, machine.positions())
    times = np.linspace(0, value.plan.duration, 100001)
    return float(np.abs(value.plan.sample(times)[0] - q).max(axis=1).min()), say(machine, ARMED) == ("2",)


@pytest.mark.parametrize("motions", [BLENDED, SEPARATE], ids=["blended", "separate"])
def test_the_robot_stops_on_its_path(motions):
    value, found = compiled(BEGIN + motions.format(sets=SETS) + END)
    assert value is not None, [one.message for one in found]
    lines = lines_of(value.text)
    sets = [place for place, line in enumerate(lines) if line.startswith("M20=")]
    low = int(re.search(r"(?m)^I16=(\d+)$", value.text)[1])
    assert sets[0] > low + 60  # the motion begins before these lines are needed
    for last in range(sets[0] - low, sets[-1] + low, 2):
        away, by_guard = off_path(value, last)
        assert by_guard, last
        assert away < 2e-5, last


@pytest.mark.parametrize("slow", [False, True])
def test_the_host_fails_when_only_a_few_lines_are_missing(monkeypatch, slow):
    """Whichever lines are missing at the end, the robot comes to rest smoothly: at the end, or held by the
    guard, even if its PLC runs only every 0.1 s. A hold while the motion brakes brakes twice as much. Without
    one, the robot would stop at its last point at once.
    """
    if slow:
        monkeypatch.setattr(plcs, "SCAN", 0.1)
    value, _ = compiled("DEFAULT (deg,s)\nP0010 MOVEJ_TOPP 40 0 0 0 0 0 [MIN]\n" + END)
    lines, robot = lines_of(value.text), value.plan.robot
    assert lines[-1] == "CLOSE"
    low = int(re.search(r"(?m)^I16=(\d+)$", value.text)[1])
    held = []
    for missing in (*range(low), *range(low, 3 * low, 5)):
        _, machine = robot_machine("INDUSTRIAL6", True)
        feed(machine, lines[: len(lines) - 1 - missing], keep=50, step=0.02)
        machine.advance(5)
        times = np.arange(0.0, machine.now, 0.002)
        first = machine.record.positions(1, times) / to_counts(robot, np.eye(6)[0])[0]
        acceleration = np.abs(np.diff(first, 2)).max() / 0.002**2
        assert acceleration < 2.0 * np.radians(240.0), missing
        held.append(say(machine, ARMED) == ("2",))
    assert not held[0]
    assert held[-1]


LAMP = (
    "OUTPUT A M20 OFF\nDEFAULT (deg,s)\nP0010 MOVEJ 10 0 0 0 0 0 [1.2]\nP0015 SET A ON\n"
    "P0020 MOVEJ 20 0 0 0 0 0 [1.5]\nP0030 SET A OFF\n"
)


@pytest.mark.parametrize("scan", [0.005, 0.02, 0.1])
def test_outputs_are_safe_after_a_hold_near_the_end(monkeypatch, scan):
    """While the robot brakes, the program reaches lines that disarm the guard: they leave the flag at 2, so
    that PLC 28 sees it even if it runs seldom.
    """
    monkeypatch.setattr(plcs, "SCAN", scan)
    value, _ = compiled(LAMP, tm=10)
    lines = lines_of(value.text)[:-1]
    count = lines.count(DISARMS)
    last = lines.index(DISARMS)
    held = 0
    for missing in range(1, count, 2):
        _, machine = robot_machine("INDUSTRIAL6")
        say(machine, "M20->*", "M20=0")
        feed(machine, lines[: last + count - missing], keep=int(mark(value.text, "I17")) + 5, step=0.02)
        machine.advance(6)
        flag, output, percent = (machine.command(one, 9).items for one in (ARMED, "M20", "&1%"))
        if percent == ("0",):
            held += 1
            assert (flag, output) == (("2",), ("0",)), missing
    assert held > 3


def mark(text, name):
    return re.search(rf"(?m)^{name}=(\d+)$", text)[1]
