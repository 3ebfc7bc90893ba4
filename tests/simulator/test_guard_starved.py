"""The host fails while few lines are in the buffer: wherever that happens, also among lines that don't move
the robot, the guard stops it on its path.
"""

import re

import numpy as np
import pytest
from programs import compiled
from simulator.machines import feed, lines_of, robot_machine, say

from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pmac.variables import ARMED
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.runtime.pmac.feed import Feed
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
    for last in range(sets[0] - low, min(sets[-1] + low, lines.index("P8100=0")), 2):
        away, by_guard = off_path(value, last)
        assert by_guard, last
        assert away < 2e-5, last


@pytest.mark.parametrize("tm", [50, 20])
def test_the_host_fails_before_the_last_packet_and_the_guard_is_late(tm, monkeypatch):
    """The runtime sends the last moves in one packet. So if they are missing, the guard holds, even if its
    PLC runs only every 0.1 s.
    """
    monkeypatch.setattr(plcs, "SCAN", 0.1)
    value, _ = compiled("DEFAULT (deg,s)\nP0010 MOVEJ 40 0 0 0 0 0 [5]\n" + END, tm=tm)
    lines, feeding, last = lines_of(value.text), Feed(job_of_compiled(value, "test")), 0
    while feeding.left:
        if packet := feeding.packet():
            last = len(packet)
            feeding.written(last)
        feeding.heard(feeding.at_most - 1, 0.0, 0.0)
    assert lines[-1] == "CLOSE"
    for late in (0, 1):
        away, _ = off_path(value, len(lines) - 1 - last - late)
        assert away < 2e-5, late
