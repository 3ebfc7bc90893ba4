"""Whatever goes wrong: the robot ends at rest, and the user is told why, where, and in which command."""

import re

import numpy as np
import pytest

from tests.cli.run_processes import assert_on_path, places, run_on

LINE = 160
"""About 0.6 s into a program of 2.7 s, 100 lines ahead of the robot."""
STANDS = r"\n  INDUSTRIAL6 stands at J1 "
IN = r"\n  (it was executing|on its path, in) P0010 MOVEJ, 0\.\d+ s into the program\n"
EXECUTED = r"\n  it was executing P0010 MOVEJ, 0\.\d s into the program\n"
GOES_ON = r"\n  to go on: yarc run p.yarc --to tcp://127.0.0.1:\d+ --tm 10 --from P0010\n"


def run(workshop, fault):
    """A run that doesn't come to its end; its words, and where the robot stands."""
    simulator = workshop.simulator(fault)
    text = workshop.yarc(*run_on(simulator), status=1)
    stands = simulator.stands()
    return simulator, text, stands


def assert_told(text, cause, *more):
    assert re.search(rf"^error: [^\n]*{cause}", text, re.MULTILINE), text
    for words in more:
        assert re.search(words, text), (words, text)


def test_a_link_that_is_lost(workshop):
    """For so long that the run ends without knowing where the robot is. The guard PLC has held it."""
    faults = f"slow@line{LINE}:1.2", f"freeze@line{LINE}:60"
    simulators = [workshop.simulator(fault) for fault in faults]
    runs = [workshop.start(*run_on(simulator)) for simulator in simulators]
    for process in runs:
        assert_told(
            process.end(1),
            "the connection was lost: no reply to .* in time; the controller can't be reached again: ",
            "its guard PLC holds the motion on the path when the buffer runs low",
            "where it stands isn't known: look at the robot",
            EXECUTED,
        )
    late, _ = simulators  # the other one doesn't say where it stands
    assert_on_path(late.stands())


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        (f"drop@line{LINE}", "the connection was lost: the controller has closed the connection"),
        (f"freeze@line{LINE}:1.3", "the connection was lost: no reply to .* in time"),
        (f"busy@line{LINE}:3", "the controller has been busy for 2 s"),
    ],
)
def test_a_link_that_comes_back(workshop, fault, cause):
    simulator, text, stands = run(workshop, fault)
    assert_told(text, cause, STANDS)
    assert places(text) == pytest.approx(stands, abs=2e-3)
    assert_on_path(stands, text)
    assert simulator.complaints() == []  # what ran is ended, and nothing is left of it


def test_a_link_that_garbles(workshop):
    _, text, stands = run(workshop, "garble@line110:0.05")
    assert_told(text, "the connection was lost: ")
    assert_on_path(stands)


def test_a_controller_that_is_late(workshop):
    """Late replies are no news, but a pace at which the program can't be fed; nothing is lost."""
    simulator = workshop.simulator("slow:0.015")
    text = workshop.yarc(*run_on(simulator), status=0)
    assert "p.yarc: done; INDUSTRIAL6 stands where it ends, to a count" in text
    assert simulator.stands() == pytest.approx(np.zeros(6), abs=1e-3)


def test_a_controller_that_is_busy_for_a_moment(workshop):
    simulator = workshop.simulator(f"busy@line{LINE}:0.8")
    text = workshop.yarc(*run_on(simulator), status=0)
    assert "the buffer ran low: holding to refill it" in text
    assert simulator.stands() == pytest.approx(np.zeros(6), abs=1e-3)


@pytest.mark.parametrize(
    ("fault", "cause"),
    [
        (f"following@line{LINE}:3", "motor 3: its following error is beyond Ixx11"),
        (f"limit@line{LINE}:2+", r"motor 2: it was stopped at the positive limit"),
        (f"amplifier@line{LINE}:1", "motor 1: its amplifier reports a fault"),
    ],
)
def test_a_motor_that_fails(workshop, fault, cause):
    simulator, text, stands = run(workshop, fault)
    assert_told(text, cause, "help: find out why, then close its loop: `#[123]J/`", STANDS, IN, GOES_ON)
    assert places(text) == pytest.approx(stands, abs=2e-3)
    refused = workshop.here(*run_on(simulator), status=1)
    assert cause.partition(": ")[2] in refused
    assert re.search(
        r"error: \d of \d+ things aren't as they must be|error: 1 of \d+ things isn't as it", refused
    )
    assert f"`yarc doctor --to {simulator.address} --robot INDUSTRIAL6` shows all of them" in refused


def test_a_controller_that_resets(workshop):
    simulator, text, _ = run(workshop, f"reset@line{LINE}")
    assert_told(text, ".*reset", EXECUTED)
    assert "motor 1: it is open-loop" in workshop.here(*run_on(simulator), status=1)
