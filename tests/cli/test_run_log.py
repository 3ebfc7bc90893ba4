"""The log of a run: its contents, and no motion if it can't be written."""

import json
import re
import resource
import signal

import pytest

from tests.cli.run_processes import assert_on_path, run_on

FILLS_UP = 24_000
"""Size limit [bytes]: the beginning of a log takes about 19,000, and a second of the run 5,000."""


def logged(simulator, log):
    """Return the arguments of a run with a log."""
    return (*run_on(simulator)[:-1], "--log", log)


@pytest.mark.parametrize("log", ["/dev/full", "/proc/no/where", "p.yarc/run.mcap"])
def test_without_a_log_nothing_moves(workshop, simulator, log):
    text = workshop.here(*logged(simulator, log), status=1)
    assert re.search(rf"error: the log can't be created, {log[:5]}.*: [a-z ]+; nothing moved\n", text)
    assert "help: make room on the disk, or use --log PATH or --no-log" in text
    assert "move\n" not in text
    assert (simulator.stands() == 0.0).all()


def test_a_log_that_fills_up(workshop, simulator):
    def limit():
        resource.setrlimit(resource.RLIMIT_FSIZE, (FILLS_UP, FILLS_UP))

    # without this, compiled modules would be truncated, too, and used by other processes
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
    # other commands read the truncated log
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
        "hold: hold requested",
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


@pytest.mark.parametrize("what", ["file", "folder"])
def test_a_log_that_is_removed_during_the_run_is_lost(what, workshop, simulator):
    process = workshop.start(*logged(simulator, "logs/run.mcap"))
    process.wait_for("P0010")
    place = workshop.folder / "logs"
    (place / "run.mcap").unlink()
    if what == "folder":
        place.rmdir()
    text = process.end(1)
    assert "p.yarc: done; INDUSTRIAL6 is at the program's end" in text
    lost = (
        "error: the run log can't be used any more: logs/run.mcap doesn't exist any more; it was removed or "
        "moved during the run\n"
    )
    assert (
        f"{lost}  help: don't change the folder of the log during a run, or choose another one with "
        "--log PATH\n"
    ) in text
    assert "log: logs" not in text


def test_a_log_that_is_removed_from_a_run_that_is_stopped_is_lost(workshop, simulator):
    process = workshop.start(*logged(simulator, "run.mcap"))
    process.wait_for("P0010")
    (workshop.folder / "run.mcap").unlink()
    process.signal(signal.SIGTERM)
    text = process.end(1)
    assert "error: the run log can't be used any more: run.mcap doesn't exist any more" in text
    assert "log: run.mcap" not in text
    assert_on_path(simulator.stands(), text)


def test_a_program_without_a_terminal_tells_of_its_lost_log(workshop, simulator):
    words = ("exec", "p.yarc", "--to", simulator.address, "--log", "run.mcap")
    process = workshop.start(*words)
    process.wait_for('"state": "move"')
    (workshop.folder / "run.mcap").rename(workshop.folder / "mine.mcap")
    *_, message, last = map(json.loads, process.end(1).splitlines())
    assert (last["event"], last["well"], last["status"], last["log"]) == ("ended", True, 1, None)
    assert (message["event"], message["warning"]) == ("message", True)
    assert message["text"].startswith("the run log can't be used any more: run.mcap doesn't exist any more")
    text = workshop.yarc(*words)
    assert "the run log can't be used" not in text
    last = json.loads(text.splitlines()[-1])
    assert (last["status"], last["log"]) == (0, "run.mcap")
