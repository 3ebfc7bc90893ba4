"""A killed run: the guard PLC holds the robot on its path, and it moves again only after an order."""

import contextlib
import re
import signal
import time
from dataclasses import replace

import pytest
from click.testing import CliRunner

from tests.cli.run_processes import assert_on_path, command_at, off_the_path, places, run_on
from yarclang.cli.yarc import main as yarc
from yarclang.coordinator.engine import Engine
from yarclang.runtime.pmac.performance import perform
from yarclang.runtime.state import State


def is_under_way(joints):
    """Return True if the robot has left the program's start."""
    return abs(joints).max() > 1.0


def test_kill_9(workshop):
    simulator = workshop.simulator()
    process = workshop.start(*run_on(simulator))
    process.wait_for("P0010 MOVEJ")
    simulator.until(is_under_way)
    process.kill()
    stands = simulator.comes_to_rest()  # the buffer lasts for a second
    assert_on_path(stands)
    time.sleep(0.5)
    assert simulator.stands() == pytest.approx(stands, abs=1e-4)  # the robot stays at rest

    address = simulator.address
    end_it = f"yarc stop --to {address} --robot INDUSTRIAL6"
    refused = workshop.here(*run_on(simulator), status=1)
    assert "ERROR    coordinate system 1: an unfinished program is held, or waits for lines\n" in refused
    assert f"help: end it at the robot's position with `{end_it}`" in refused
    assert "error: 1 of 103 checks failed; nothing moved" in refused
    examined = workshop.here("doctor", "--robot", "INDUSTRIAL6", "--to", address, status=1)
    assert f"`{end_it}`" in examined
    assert "1 of 103 checks failed: no program can be run" in examined
    assert "lines/s" not in examined  # the link isn't measured while a program is held

    ended = workshop.here(*end_it.split()[1:])
    assert places(ended) == pytest.approx(stands, abs=2e-3)
    refused = workshop.here(*run_on(simulator), status=1)
    assert "the robot doesn't stand where p.yarc starts: J1 +" in refused
    index = command_at(off_the_path(stands)[1])
    text = workshop.yarc(*run_on(simulator, "--from", index, "--yes"))
    assert re.search(rf"doesn't stand where {index} MOVEJ starts: .*\nan approach takes \d\.\d s", text)
    assert "p.yarc: done; INDUSTRIAL6 is at the program's end, within one count" in text
    assert simulator.stands() == pytest.approx([0.0] * 6, abs=1e-4)


def test_a_bug_of_ours(workshop, simulator, monkeypatch):
    """An internal error ends the run, but the robot is held on its path, and its program is ended."""

    def with_a_bug(operation, job):
        script, outcome, moves = perform(operation, job), None, None
        while True:
            action = script.send(outcome)
            if operation.state is State.MOVE:
                moves = moves or operation.now
                if operation.now - moves > 0.4:
                    raise RuntimeError("a bug")
            outcome = yield action

    monkeypatch.setattr(
        Engine, "scripts", property(lambda one: replace(one.session.scripts, perform=with_a_bug))
    )
    shell = CliRunner(env=workshop.environment)
    with contextlib.chdir(workshop.folder):
        done = shell.invoke(yarc, run_on(simulator))
    assert done.exit_code == 1
    assert "RuntimeError: a bug" in done.output
    assert_on_path(simulator.stands())
    assert "a bug of yarclang has ended the current motion" in done.output
    assert places(done.output) == pytest.approx(simulator.stands(), abs=2e-3)
    assert simulator.complaints() == []


def test_a_process_that_sleeps(workshop, simulator):
    """The process is stopped for less time than the buffer lasts, and the robot stays on its path."""
    process = workshop.start(*run_on(simulator))
    process.wait_for("P0010 MOVEJ")
    process.signal(signal.SIGSTOP)
    simulator.until(is_under_way)  # the buffer lasts for a second
    assert_on_path(simulator.comes_to_rest())
    process.signal(signal.SIGCONT)
    text = process.end(0)
    assert "the controller has received nothing from this computer for 0.4 s, and holds" in text
    assert simulator.stands() == pytest.approx([0.0] * 6, abs=1e-4)
