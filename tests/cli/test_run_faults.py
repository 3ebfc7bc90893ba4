"""Faults of a run: the robot ends at rest, and the user is told the reason, the place and the command."""

import re

import numpy as np
import pytest

from tests.cli.run_processes import assert_on_path, places, run_on

LINE = 140
"""Number of a line 0.4 s into a program of 2.1 s, which is sent 100 lines ahead of the robot."""
IN = r"\n  (it was executing|on its path, in) P0010 MOVEJ, 0\.\d+ s into the program\n"
EXECUTED = r"\n  it was executing P0010 MOVEJ, 0\.\d s into the program\n"
GOES_ON = r"\n  to continue: yarc run p.yarc --to tcp://127.0.0.1:\d+ --tm 10 --from P0010\n"


def runs(workshop, *faults, status=1):
    """Make one run for each fault, all at once; return the simulators and the outputs of the runs."""
    simulators = [workshop.simulator(fault) for fault in faults]
    processes = [workshop.start(*run_on(simulator)) for simulator in simulators]
    return [
        (simulator, process.end(status)) for simulator, process in zip(simulators, processes, strict=True)
    ]


def assert_told(text, cause, *more):
    assert re.search(rf"^(?:\S+:\d+:\d+: )?error(?: Y16\d\d)?: [^\n]*{cause}", text, re.MULTILINE), text
    for words in more:
        assert re.search(words, text), (words, text)


def test_a_link_that_is_lost(workshop):
    """The connection is lost until after the end of the run, which doesn't know the robot's position.

    The guard PLC has held the robot.
    """
    found = runs(workshop, f"slow@line{LINE}:1.2", f"freeze@line{LINE}:60")
    for _, text in found:
        assert_told(
            text,
            "the connection was lost: no reply to .* in time; the controller can't be reached again: ",
            "its guard PLC holds the motion on the path after 0.4 s without data from this computer",
            "its position is unknown: inspect the robot",
            EXECUTED,
        )
    late, _ = found[0]  # the other simulator is frozen, so it can't report its position
    assert_on_path(late.stands())


def test_a_link_that_comes_back(workshop):
    causes = {
        f"drop@line{LINE}": "the connection was lost: the controller has closed the connection",
        f"freeze@line{LINE}:1.3": "the connection was lost: no reply to .* in time",
        f"busy@line{LINE}:2.6": "the controller has been busy for 2 s",
        "garble@line110:0.04": "",  # a wrong byte may cause any error
    }
    for cause, (simulator, text) in zip(causes.values(), runs(workshop, *causes), strict=True):
        assert_told(text, cause)
        stands = simulator.stands()
        assert places(text) == pytest.approx(stands, abs=2e-3)
        assert_on_path(stands, text)
        if cause:
            # the program is ended, and nothing of it is left in the controller
            assert simulator.complaints() == []


def test_what_a_link_may_do(workshop):
    """Late replies are only reported if the program can't be fed in time.

    A controller may be busy for a moment.
    """
    (slow, slowly), (busy, busily) = runs(workshop, "slow:0.012", f"busy@line{LINE}:0.8", status=0)
    assert "the controller has received nothing from this computer for 0.4 s, and holds" in busily
    for simulator, text in ((slow, slowly), (busy, busily)):
        assert "p.yarc: done; INDUSTRIAL6 is at the program's end, within one count" in text
        assert simulator.stands() == pytest.approx(np.zeros(6), abs=1e-4)


def test_a_motor_that_fails(workshop):
    causes = {
        f"following@line{LINE}:3": "motor 3: its following error is beyond Ixx11",
        f"limit@line{LINE}:2+": "motor 2: it was stopped by the positive limit",
        f"amplifier@line{LINE}:1": "motor 1: its amplifier reports a fault",
    }
    for cause, (simulator, text) in zip(causes.values(), runs(workshop, *causes), strict=True):
        assert_told(text, cause, "help: find out why, then close its loop: `#[123]J/`", IN, GOES_ON)
        assert places(text) == pytest.approx(simulator.stands(), abs=2e-3)
        refused = workshop.here(*run_on(simulator), status=1)
        assert cause.partition(": ")[2] in refused
        assert re.search("error: (6|1) of \\d+ checks failed; nothing moved", refused)
        assert f"`yarc doctor --to {simulator.address} --robot INDUSTRIAL6` shows all of them" in refused


def test_a_controller_that_resets(workshop):
    ((simulator, text),) = runs(workshop, f"reset@line{LINE}")
    assert_told(text, ".*reset", EXECUTED)
    assert "motor 1: it is open-loop" in workshop.here(*run_on(simulator), status=1)


def test_before_anything_moves(workshop):
    """The connection is lost while the program is loaded, before any motion."""
    ((simulator, text),) = runs(workshop, "drop@line40")
    assert_told(text, "the connection was lost: ", "\n  nothing had moved\n")
    assert "to continue" not in text
    assert simulator.stands() == pytest.approx(np.zeros(6), abs=1e-6)
