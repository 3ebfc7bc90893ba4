"""Orders during a run: Ctrl-C, termination, and commands in other terminals."""

import json
import re
import signal
import time

import pytest

from tests.cli.run_processes import assert_on_path, places, run_on

HOME = [0.0] * 6
MOVES = "P0010 MOVEJ  0.0 s to 0.7 s of 2.1 s"
"""The first line of output while the robot moves."""


@pytest.fixture
def process(workshop, simulator):
    """Start a run, and return its process when the robot moves."""
    process = workshop.start(*run_on(simulator))
    process.wait_for(MOVES)
    return process


def test_ctrl_c_holds_and_yarc_resume_goes_on(workshop, simulator, process):
    process.signal(signal.SIGINT)
    process.wait_for("hold: hold requested")
    assert "continue with Enter or `yarc resume`, end with `yarc stop`, abort with Ctrl-C" in process.text
    assert_on_path(simulator.comes_to_rest())
    status = json.loads(workshop.here("status", "--format", "json"))
    assert (status["state"], status["program"]) == ("hold", "p.yarc")
    assert ": move, " in workshop.yarc("resume")
    assert "p.yarc: done; INDUSTRIAL6 is at the program's end, within one count" in process.end(0)
    assert simulator.stands() == pytest.approx(HOME, abs=1e-4)  # a count is 0.00004 deg and more


def test_a_second_ctrl_c_aborts(workshop, simulator, process):
    process.signal(signal.SIGINT)
    process.wait_for("hold: ")
    process.signal(signal.SIGINT)
    text = process.end(1)
    assert "aborting: each motor stops at once" in text
    assert "p.yarc: aborted: off its path\n" in text
    stands = simulator.stands()
    assert places(text) == pytest.approx(stands, abs=2e-3)

    refused = workshop.here(*run_on(simulator), status=1)
    off = re.search(r"error: the robot doesn't stand where p.yarc starts: J1 \+([\d.]+) deg, ", refused)
    assert float(off[1]) == pytest.approx(stands[0], abs=1e-3)
    assert "help: --approach moves there slowly, certified" in refused
    assert simulator.stands() == pytest.approx(stands, abs=1e-4)
    text = workshop.yarc(*run_on(simulator, "--approach", "--yes"))
    assert re.search(r"an approach takes \d\.\d s, all joints straight to J1 0.000 deg, ", text)
    assert "stop: at the end of approach, to a count" in text
    assert simulator.stands() == pytest.approx(HOME, abs=1e-4)


def test_a_termination_ends_it_on_its_path(simulator, process):
    process.signal(signal.SIGTERM)
    text = process.end(1)
    assert "p.yarc: stopped on its path\n" in text
    assert_on_path(simulator.stands(), text)
    assert simulator.complaints() == []


def test_yarc_stop_and_going_on(workshop, simulator, process):
    process.wait_for("P0020 MOVEJ  0.7 s to ")
    assert "ended" in workshop.here("stop")
    text = process.end(1)
    assert "p.yarc: stopped on its path\n" in text
    assert_on_path(simulator.stands(), text)
    (index,) = re.findall(r"--from (P00\d0)\n", text)
    asked = workshop.here(*run_on(simulator, "--from", index), status=2)
    assert "Move there? There is no terminal to ask on: give --yes" in asked
    text = workshop.yarc(*run_on(simulator, "--from", index.replace("P00", "p"), "--yes"))
    assert f"the robot doesn't stand where {index} MOVEJ starts: J1 " in text
    assert "P0010" not in text
    assert simulator.stands() == pytest.approx(HOME, abs=1e-4)


def test_another_pace(workshop, simulator, process):
    assert "50 % of the programmed speed" in workshop.here("override", "50")
    begun = time.monotonic()
    text = process.end(0)
    assert "override 50 %" in text
    assert time.monotonic() - begun > 1.5  # at 50 %, the rest of the program takes about 2 s
    assert simulator.stands() == pytest.approx(HOME, abs=1e-4)


def test_ctrl_c_before_anything_moves(workshop):
    simulator = workshop.simulator("freeze@0.1:2")
    process = workshop.start(*run_on(simulator))
    time.sleep(1.2)  # the run inspects the controller, which doesn't answer
    process.signal(signal.SIGINT)
    assert re.search("given up; nothing was moved|Aborted!", process.end(1))


def test_two_runs_on_one_controller(workshop, simulator, process):
    process.signal(signal.SIGINT)  # the first Ctrl-C only holds the robot
    process.wait_for("hold: ")
    driven = f"process {process.pid} on this computer already drives 127.0.0.1:{simulator.port}"
    assert driven in workshop.yarc(*run_on(simulator), status=1)
    assert driven in workshop.here("doctor", "--robot", "INDUSTRIAL6", "--to", simulator.address, status=1)
    workshop.here("resume")
    process.end(0)
