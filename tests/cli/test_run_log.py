"""The log of a run: no log, no motion; and what stands in it."""

import re
import resource
import signal

import pytest

from tests.cli.run_processes import assert_on_path, run_on

FILLS_UP = 24_000
"""Bytes: what is known at the beginning takes about 19,000, and a second of the run 5,000."""


def logged(simulator, log):
    """The words of a run with a log."""
    return (*run_on(simulator)[:-1], "--log", log)


@pytest.mark.parametrize("log", ["/dev/full", "/proc/no/where", "p.yarc/run.mcap"])
def test_without_a_log_nothing_moves(workshop, simulator, log):
    text = workshop.here(*logged(simulator, log), status=1)
    assert re.search(rf"error: the log can't be made, {log[:5]}.*: [a-z ]+; nothing moved\n", text)
    assert "help: make room, or say --log PATH, or --no-log" in text
    assert "move\n" not in text
    assert (simulator.stands() == 0.0).all()


def test_a_log_that_fills_up(workshop, simulator):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (FILLS_UP, FILLS_UP))

    # compiled modules would be cut as well, for everybody
    no_others = {"PYTHONDONTWRITEBYTECODE": "1"}
    process = workshop.start(*logged(simulator, "run.mcap"), preexec_fn=limit, variables=no_others)
    text = process.end(1)
    assert "log: run.mcap, which ends early\n" in text
    assert (
        "error: the log can't be written: file too large\n  help: make room on the disk, or give --no-log"
        in text
    )
    assert_on_path(simulator.stands(), text)
    assert simulator.complaints() == []
    assert 0 < (workshop.folder / "run.mcap").stat().st_size <= FILLS_UP
    # what it has is read
    assert "move" in workshop.here("replay", "run.mcap", "--speed", "max")
    assert "drawn to run.png" in workshop.here("plot", "run.mcap", "-o", "run.png")


def test_what_stands_in_it(workshop):
    process = workshop.start("run", "p.yarc")
    process.wait_for("P0010")
    process.signal(signal.SIGINT)
    process.wait_for("hold: ")
    workshop.here("resume")
    text = process.end(0)
    (log,) = re.findall(r"log: (yarc-runs/p-\d{8}-\d{6}\.mcap)\n", text)
    replayed = workshop.here("replay", log, "--speed", "max")
    for words in (
        "ordered: hold",
        "hold: a hold was asked for",
        "ordered: resume",
        "P0030 MOVEJ",
        "came to its end",
    ):
        assert words in replayed


def test_a_part_stands_in_the_whole(workshop):
    text = workshop.yarc("run", "p.yarc", "--from", "P0020", "--rate", "3", "--log", "run.mcap")
    assert "P0020 MOVEJ  0.7 s to 1.4 s of 2.1 s\n" in text
    assert "P0010" not in text
    replayed = workshop.here("replay", "run.mcap", "--speed", "max")
    assert re.search(r"P0020 MOVEJ  (0\.[789]|1\.\d) s of 2.1 s", replayed)
    assert workshop.yarc("run", "p.yarc", "--rate", "5", "--log", "run.mcap").count("log: run-2.mcap\n") == 1
