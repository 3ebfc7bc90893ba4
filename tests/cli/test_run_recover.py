"""`yarc run --recover`, and start zones from which a program may begin without a question."""

import json
import re
import signal

import pytest

from tests.cli.run_processes import run_on

PROGRAM = """\
ROBOT INDUSTRIAL6
CELL "cell.toml"
START -8 0 0 0 0 0 (deg)
P0010 MOVEJ -10 0 0 0 0 0 [1] (deg,s)
P0020 MOVEJ -8 0 0 0 0 0 [1] (deg,s)
"""
POST = """\
units = "mm,deg"
[[obstacles]]
name = "POST"
shape = "box"
frame = "B"
xyz = [1500, 0, 900]
size = [120, 120, 1800]
"""
ZONE = """
[[starts]]
name = "HOME"
joints = { J1 = [-9, -1], J2 = [-5, 40], J3 = [-40, 5], J4 = [-10, 10], J5 = [-40, 5], J6 = [-10, 10] }
"""
START = [-8, 0, 0, 0, 0, 0]


@pytest.fixture
def away(workshop, simulator):
    """Start a robot away from the program's start."""
    workshop.write("cell.toml", POST)
    workshop.write("r.yarc", PROGRAM)
    return simulator


def test_it_goes_there_and_says_how_to_go_on(workshop, away):
    shown = workshop.here(*run_on(away, "--recover", "--dry-run", program="r.yarc"))
    told = re.search(
        r"recovery: to the start of r\.yarc, (\d+\.\d) s at 10 % of the joints' limits, all joints straight, to J1 -8\.000 deg",  # noqa: E501
        shown,
    )
    assert told, shown
    assert re.search(r"proved: .*\d+\.\d mm", shown)
    assert "nothing moved (--dry-run)" in shown
    assert away.stands()[0] == pytest.approx(0.0, abs=1e-4)
    text = workshop.yarc(*run_on(away, "--recover", "--yes", program="r.yarc"))
    assert "INDUSTRIAL6 is at the start of r.yarc, within one count" in text
    assert f"to continue: yarc run r.yarc --to {away.address} --tm 10" in text
    assert "P0010" not in text.replace("MOVEJ 1", "")  # nothing of the program was carried out
    assert away.stands() == pytest.approx(START, abs=1e-4)
    again = workshop.here(*run_on(away, "--recover", program="r.yarc"))
    assert "INDUSTRIAL6 is at the start of r.yarc already; nothing moved" in again
    assert "done" in workshop.yarc(*run_on(away, program="r.yarc"))


@pytest.mark.parametrize(("answer", "status"), [("n\n", 1), ("\x03", 1), ("y\n", 0)])
def test_it_is_asked_for(workshop, away, answer, status):
    terminal = workshop.terminal(*run_on(away, "--recover", program="r.yarc"))
    terminal.wait_for("Move there? [y/N]: ")
    assert away.joints()[0] == pytest.approx(0.0, abs=1e-4)
    terminal.type(answer)
    text = terminal.end(status)
    assert ("nothing moved" in text or "nothing was moved" in text) == bool(status)
    assert away.stands()[0] == pytest.approx(0.0 if status else -8.0, abs=1e-4)


def test_stopped_on_the_way_it_is_recovered_again(workshop, away):
    process = workshop.start(*run_on(away, "--recover", "--yes", program="r.yarc"))
    away.until(lambda joints: joints[0] < -2.0)
    process.signal(signal.SIGTERM)
    text = process.end(1)
    assert "it was on its way to the start" in text
    assert f"to continue: yarc run r.yarc --to {away.address} --tm 10 --recover" in text
    assert -7.9 < away.stands()[0] < -1.9
    workshop.yarc(*run_on(away, "--recover", "--yes", program="r.yarc"))
    assert away.stands() == pytest.approx(START, abs=1e-4)


def test_what_cannot_be_proved_is_refused(workshop, away):
    never = '[[zones]]\nname = "NEVER"\nrule = "forbidden"\nshape = "joints"\njoints = { J1 = [-5, -3] }\n'
    workshop.write("cell.toml", POST + never)
    text = workshop.here(*run_on(away, "--recover", "--yes", program="r.yarc"), status=1)
    assert "Y1660" in text
    assert "no motion from the robot's position to the start" in text
    assert "NEVER" in text
    assert "nothing moved" in text
    assert away.stands()[0] == pytest.approx(0.0, abs=1e-4)


def test_options_that_exclude_each_other(workshop):
    for words in (("--loop",), ("--step",), ("--approach",), ("--times", "2")):
        text = workshop.here("run", "p.yarc", "--recover", *words, status=2)
        assert f"--recover and {words[0]} exclude each other" in text


def test_from_a_start_zone_nobody_is_asked(workshop, simulator):
    """Outside of the start zone the run is refused without --approach, and inside it begins at once."""
    workshop.write("cell.toml", POST + ZONE)
    workshop.write("r.yarc", PROGRAM)
    refused = workshop.here(*run_on(simulator, program="r.yarc"), status=1)
    assert "--approach moves there slowly" in refused
    workshop.write("in.yarc", "ROBOT INDUSTRIAL6\nP0010 MOVEJ -2 0 0 0 0 0 [1] (deg,s)\n")
    workshop.yarc(*run_on(simulator, program="in.yarc"))
    text = workshop.here(*run_on(simulator, program="r.yarc"))
    assert "the robot is in the start zone HOME of the cell: it moves there without confirmation" in text
    assert "r.yarc: done" in text
    workshop.write(
        "in.yarc",
        "ROBOT INDUSTRIAL6\nSTART -8 0 0 0 0 0 (deg)\nP0010 MOVEJ -6 0 0 0 0 0 [1] (deg,s)\n",
    )
    workshop.yarc(*run_on(simulator, program="in.yarc"))
    lines = workshop.here("exec", "r.yarc", "--to", simulator.address, "--no-log").splitlines()
    events = [json.loads(one) for one in lines if one.startswith("{")]
    assert events[-1]["well"] is True
    assert any("start zone HOME" in one.get("text", "") for one in events)


def test_a_served_robot_is_recovered(workshop):
    process = workshop.start("serve", "--robot", "INDUSTRIAL6", "--no-log")
    process.wait_for("is served: ")
    workshop.write("cell.toml", POST)
    workshop.write("r.yarc", PROGRAM)
    text = workshop.yarc("run", "r.yarc", "--recover", "--yes")
    assert "serves the robot" in text
    assert "INDUSTRIAL6 is at the start of r.yarc, within one count" in text
    assert "done" in workshop.yarc("run", "r.yarc")
    process.signal(signal.SIGTERM)
    assert "Traceback" not in process.end(0)
