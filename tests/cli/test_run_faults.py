"""Whatever goes wrong: the robot ends at rest, and the user is told why, where, and in which command."""

import re

import numpy as np
import pytest

from tests.cli.run_processes import assert_on_path, places, run_on

LINE = 140
"""About 0.4 s into a program of 2.1 s, 100 lines ahead of the robot."""
IN = r"\n  (it was executing|on its path, in) P0010 MOVEJ, 0\.\d+ s into the program\n"
EXECUTED = r"\n  it was executing P0010 MOVEJ, 0\.\d s into the program\n"
GOES_ON = r"\n  to go on: yarc run p.yarc --to tcp://127.0.0.1:\d+ --tm 10 --from P0010\n"


def runs(workshop, *faults, status=1):
    """One run with each of the faults, all at the same time: the simulators, and what the runs have said."""
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
    """For so long that the run ends without knowing where the robot is. The guard PLC has held it."""
    found = runs(workshop, f"slow@line{LINE}:1.2", f"freeze@line{LINE}:60")
    for _, text in found:
        assert_told(
            text,
            "the connection was lost: no reply to .* in time; the controller can't be reached again: ",
            "its guard PLC holds the motion on the path when it has received nothing from this computer "
            "for 0.4 s",
            "where it stands isn't known: look at the robot",
            EXECUTED,
        )
    late, _ = found[0]  # the other one doesn't say where it stands
    assert_on_path(late.stands())


def test_a_link_that_comes_back(workshop):
    causes = {
        f"drop@line{LINE}": "the connection was lost: the controller has closed the connection",
        f"freeze@line{LINE}:1.3": "the connection was lost: no reply to .* in time",
        f"busy@line{LINE}:2.6": "the controller has been busy for 2 s",
        "garble@line110:0.04": "",  # a wrong byte may look like anything
    }
    for cause, (simulator, text) in zip(causes.values(), runs(workshop, *causes), strict=True):
        assert_told(text, cause)
        stands = simulator.stands()
        assert places(text) == pytest.approx(stands, abs=2e-3)
        assert_on_path(stands, text)
        if cause:
            assert simulator.complaints() == []  # what ran is ended, and nothing is left of it


def test_what_a_link_may_do(workshop):
    """Late replies are no news, but a pace at which the program can't be fed; a controller may be busy for
    a moment.
    """
    (slow, slowly), (busy, busily) = runs(workshop, "slow:0.012", f"busy@line{LINE}:0.8", status=0)
    assert "the controller has received nothing from this computer for 0.4 s, and holds" in busily
    for simulator, text in ((slow, slowly), (busy, busily)):
        assert "p.yarc: done; INDUSTRIAL6 stands where it ends, to a count" in text
        assert simulator.stands() == pytest.approx(np.zeros(6), abs=1e-4)


def test_a_motor_that_fails(workshop):
    causes = {
        f"following@line{LINE}:3": "motor 3: its following error is beyond Ixx11",
        f"limit@line{LINE}:2+": "motor 2: it was stopped at the positive limit",
        f"amplifier@line{LINE}:1": "motor 1: its amplifier reports a fault",
    }
    for cause, (simulator, text) in zip(causes.values(), runs(workshop, *causes), strict=True):
        assert_told(text, cause, "help: find out why, then close its loop: `#[123]J/`", IN, GOES_ON)
        assert places(text) == pytest.approx(simulator.stands(), abs=2e-3)
        refused = workshop.here(*run_on(simulator), status=1)
        assert cause.partition(": ")[2] in refused
        assert re.search(
            "error: (6 of \\d+ things aren't as they|1 of \\d+ things isn't as it) must be; ", refused
        )
        assert f"`yarc doctor --to {simulator.address} --robot INDUSTRIAL6` shows all of them" in refused


def test_a_controller_that_resets(workshop):
    ((simulator, text),) = runs(workshop, f"reset@line{LINE}")
    assert_told(text, ".*reset", EXECUTED)
    assert "motor 1: it is open-loop" in workshop.here(*run_on(simulator), status=1)


def test_before_anything_moves(workshop):
    """A link that is lost while the program is loaded."""
    ((simulator, text),) = runs(workshop, "drop@line40")
    assert_told(text, "the connection was lost: ", "\n  nothing had moved\n")
    assert "to go on" not in text
    assert simulator.stands() == pytest.approx(np.zeros(6), abs=1e-6)
