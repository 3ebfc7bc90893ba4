"""`yarc exec`: events as JSON lines, exit statuses, signals, and readers that are slow or gone."""

import json
import os
import signal

import pytest

from tests.cli.run_processes import FINE, assert_on_path

LAST = {"event", "time_s", "status", "well", "what", "help", "code", "command", "done_s", "joints", "log"}
"""The keys that the last event always has."""


def exec_on(simulator, *options, program="p.yarc"):
    return ("exec", program, "--to", simulator.address, *FINE, "--no-log", *options)


def events_in(text):
    found = [json.loads(line) for line in text.splitlines()]
    assert found[-1]["event"] == "ended"
    assert set(found[-1]) == LAST
    times = [one["time_s"] for one in found]
    assert times == sorted(times)
    return found


def test_a_program_is_carried_out_and_told(workshop):
    found = events_in(workshop.yarc("exec", "p.yarc", "--positions", "--log", "run.mcap"))
    kinds = {one["event"] for one in found}
    assert {"began", "state", "progress", "position", "finished", "ended"} <= kinds
    states = [one["state"] for one in found if one["event"] == "state"]
    assert states == ["init", "move", "stop"]
    commands = [one["command"] for one in found if one["event"] == "progress" and one["command"]]
    assert {"P0010 MOVEJ", "P0020 MOVEJ", "P0030 MOVEJ"} == set(commands)
    last = found[-1]
    assert (last["status"], last["well"], last["log"]) == (0, True, "run.mcap")
    assert last["joints"] == pytest.approx({f"J{number}": 0.0 for number in range(1, 7)}, abs=1e-4)
    shown = workshop.here("replay", "run.mcap")
    assert "P0010 MOVEJ" in shown


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGQUIT])
def test_a_termination_stops_the_robot_on_its_path(workshop, simulator, number):
    process = workshop.start(*exec_on(simulator))
    process.wait_for('"state": "move"')
    process.signal(number)
    last = events_in(process.end(1))[-1]
    assert (last["well"], last["what"]) == (False, "stopped on its path")
    assert_on_path(simulator.stands())


def test_a_closed_terminal_is_nothing(workshop, simulator):
    terminal = workshop.terminal(*exec_on(simulator))
    terminal.wait_for('"state": "move"')
    terminal.hang_up()
    assert terminal.wait() == 0
    assert simulator.stands() == pytest.approx([0.0] * 6, abs=1e-4)


def test_a_reader_that_does_not_read_delays_nothing(workshop, simulator):
    """The pipe is full after the first positions, and the robot still reaches the program's end."""
    reading, writing = os.pipe()
    try:
        import fcntl
        import subprocess

        fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 4096)
        from tests.cli.run_processes import YARC

        process = subprocess.Popen(
            [*YARC, *exec_on(simulator, "--positions")],
            cwd=workshop.folder,
            env=workshop.environment,
            stdin=subprocess.DEVNULL,
            stdout=writing,
            stderr=subprocess.DEVNULL,
        )
        os.close(writing)
        writing = -1
        simulator.until(lambda joints: abs(joints).max() > 1.0)
        simulator.until(lambda joints: abs(joints).max() < 1e-4)
        assert simulator.stands() == pytest.approx([0.0] * 6, abs=1e-4)
        with os.fdopen(reading) as lines:
            reading = -1
            events_in(lines.read())
        assert process.wait(30.0) == 0
    finally:
        for descriptor in (reading, writing):
            if descriptor >= 0:
                os.close(descriptor)


def test_other_terminals_order_it_about(workshop, simulator):
    process = workshop.start(*exec_on(simulator))
    process.wait_for('"state": "move"')
    workshop.here("hold")
    process.wait_for('"state": "hold"')
    status = json.loads(workshop.here("status", "--format", "json"))
    assert (status["state"], status["program"]) == ("hold", "p.yarc")
    workshop.here("resume")
    events_in(process.end(0))


def test_findings_are_events_too(workshop):
    workshop.write("bad.yarc", "ROBOT INDUSTRIAL6\nP0010 MOVEJ 900 0 0 0 0 0 [1] (deg,s)\n")
    found = events_in(workshop.here("exec", "bad.yarc", status=1))
    assert found[0]["findings"][0]["code"] == "Y0502"
    assert found[0]["findings"][0]["line"] == 2


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (("nope.yarc",), "the program has errors; nothing moved"),
        (("p.yarc", "--to", "tcp://127.0.0.1:9"), "127.0.0.1:9 can't be reached: connection refused"),
    ],
)
def test_what_cannot_be_begun_ends_with_what_is_the_matter(workshop, arguments, what):
    assert events_in(workshop.here("exec", *arguments, status=1))[-1]["what"] == what


def test_a_robot_that_stands_elsewhere_is_approached_only_if_that_is_wanted(workshop):
    workshop.write(
        "there.yarc", "ROBOT INDUSTRIAL6\nSTART 5 0 0 0 0 0 (deg)\nP0010 MOVEJ 0 0 0 0 0 0 [1] (deg,s)\n"
    )
    simulator = workshop.simulator()
    last = events_in(workshop.yarc(*exec_on(simulator, program="there.yarc"), status=1))[-1]
    assert "the robot doesn't stand where there.yarc starts: J1 -5.0000 deg" in last["what"]
    assert "--approach" in last["help"]
    found = events_in(workshop.yarc(*exec_on(simulator, "--approach", program="there.yarc")))
    parts = [one for one in found if one["event"] == "part"]
    assert [(one["name"], one["to_the_start"]) for one in parts] == [
        ("to the start", True),
        ("there.yarc", False),
    ]


@pytest.mark.parametrize(
    "options",
    [
        ("--times", "0"),
        ("--rate", "2", "--to", "tcp://127.0.0.1"),
        ("--log", "x", "--no-log"),
    ],
)
def test_wrong_usage(workshop, options):
    workshop.here("exec", "p.yarc", *options, status=2)
