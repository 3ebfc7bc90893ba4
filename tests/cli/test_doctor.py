"""`yarc doctor`: its checks and their texts."""

import json
import re

import pytest

from tests.cli.run_processes import run_on
from tests.simulator.serving import Client
from yarclang.pipeline.settings import items_of
from yarclang.runtime.pmac.protocol import GREETING, Ask


def examine(workshop, *options, status=0):
    return workshop.here("doctor", "--robot", "INDUSTRIAL6", *options, status=status)


def tell(simulator, *lines):
    """Change something at the controller without the knowledge of others."""
    with Client(simulator.port) as client:
        for line in (GREETING, *lines):
            assert client.ask(Ask(line)).error is None


@pytest.fixture
def own(workshop):
    """Start a simulator that a test may change."""
    return workshop.simulator()


def test_all_is_well(workshop, simulator, industrial6):
    text = examine(workshop, "--to", simulator.address)
    lines = text.splitlines()
    assert lines[0] == "ok       controller: TURBO2, X4 (CID 602413)"
    count = (
        len(items_of(industrial6)) + 2 + 6 + 1 + 3
    )  # the controller, what runs, motors, guard, watchdog and PLCs
    assert sum(line.startswith("ok ") for line in lines) == count
    assert lines[-1] == f"all {count} checks passed"
    assert "INDUSTRIAL6 is commanded to J1 0.000 deg, J2 0.000 deg, " in text
    assert re.search(
        r"^link: a reply takes \d+\.\d+ ms \(median\), .* \d+ program lines/s, ", text, re.MULTILINE
    )
    assert simulator.complaints() == []


def test_without_a_controller(workshop):
    text = examine(workshop)
    assert "INDUSTRIAL6 is simulated" in text
    assert "checks passed" in text


def test_as_json(workshop, simulator):
    text = examine(workshop, "--to", simulator.address, "--format", "json")
    found = json.loads(text)
    assert found["controller"] == simulator.address
    assert {one["verdict"] for one in found["checked"]} == {"ok"}
    assert found["joints"][0] == {"name": "J1", "commanded": 0.0, "unit": "deg"}
    assert found["link"]["lines_per_s"] > 100
    assert found["link"]["first_line"] == 1


def test_what_is_wrong_stands_last(workshop, own):
    tell(own, "I5195=0", "#2K", "M161->D:$000089")
    text = examine(workshop, "--to", own.address, status=1)
    lines = text.splitlines()
    first = next(number for number, line in enumerate(lines) if line.startswith("ERROR"))
    assert not any(line.startswith("ok ") for line in lines[first:])
    assert "ERROR    I5195, slew rate of the hold, for 250 ms: 0\n         wanted: 6576\n" in text
    assert "         help: download `yarc settings INDUSTRIAL6` and SAVE\n" in text
    assert "ERROR    address of M161: D:$000089\n         wanted: D:$000088\n" in text
    assert "ERROR    motor 2: it is open-loop\n" in text
    wrong = text.count("ERROR ")
    assert (
        f"\n{wrong} of {len([*filter(re.compile('ok |ERROR').match, lines)])} checks failed: no program"
        in text
    )
    assert "INDUSTRIAL6 is commanded to" not in text
    refused = workshop.here(*run_on(own), status=1)
    assert f"error: {wrong} of " in refused
    assert refused.count("ERROR ") == wrong


def test_a_guard_that_does_nothing(workshop, own):
    """The guard's text is right but it doesn't run, which only a test of the guard shows."""
    tell(own, "DISABLE PLC 29")
    text = examine(workshop, "--to", own.address, status=1)
    assert (
        "ERROR    guard PLC 29: armed, but it doesn't react\n         wanted: holds when the rotary "
        "buffer runs low\n" in text
    )
    assert "without it the robot isn't stopped if this computer fails" in text
    assert "1 of 104 checks failed: no program can be run" in text


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ([], "Missing option '--robot'"),
        (["--robot", "INDUSTRIAL6", "--to", "here"], "is tcp:// missing?"),
        (["--robot", "INDUSTRIAL6", "--format", "xml"], "is not one of"),
        (["--robot", "INDUSTRIAL6", "--fix"], "No such option"),
    ],
)
def test_wrong_usage(workshop, arguments, reason):
    assert reason in workshop.here("doctor", *arguments, status=2)


def test_a_robot_that_there_is_not(workshop):
    assert "error Y1301" in workshop.here("doctor", "--robot", "NOPE", status=1)
