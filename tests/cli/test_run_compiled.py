"""`yarc run FILE.pmc` judges the text again, and refuses a changed text before it contacts the controller."""

import re
import shutil

import pytest

import yarclang
from tests.cli.run_processes import ROUND
from yarclang.robot.description import load_robot

PATH = "tcp://127.0.0.1:1"
"""An address without a controller, as errors in a text are found before a connection is made."""


@pytest.fixture(scope="module")
def text():
    return yarclang.compile(ROUND, name="p.yarc").value.text


def move_lines(text):
    return re.findall(r"^X.*$", text, re.MULTILINE)


def refused(workshop, text, *options):
    workshop.write("p.pmc", text)
    shown = workshop.here("run", "p.pmc", "--to", PATH, "--no-log", *options, status=1)
    assert "can't be reached" not in shown
    return shown


def test_it_runs(workshop, simulator, text):
    workshop.write("P.PMC", text)
    shown = workshop.yarc("run", "P.PMC", "--to", simulator.address, "--no-log")
    assert "P.PMC: done; INDUSTRIAL6 is at the program's end, within one count" in shown
    assert (abs(simulator.stands()) < 1e-4).all()


def test_one_point_beyond_the_limits(workshop, text):
    line = move_lines(text)[10]
    shown = refused(workshop, text.replace(line, re.sub("^X[^Y]*", "X60", line), 1))
    assert re.search(
        r"^p\.pmc:\d+:1: error Y1157: P0010 MOVEJ: J1 has a peak velocity of ", shown, re.MULTILINE
    )
    assert "was changed after yarcc wrote it, or p.yarc has changed since: compile the program again" in shown


def test_too_fast(workshop, text):
    """All motions take a tenth of their time."""
    shown = refused(workshop, re.sub(r"^TM\d.*$", "TM3", text, flags=re.MULTILINE))
    assert "error Y11" in shown
    assert "velocity" in shown


def test_cut(workshop, text):
    shown = refused(workshop, text[: len(text) // 2])
    assert re.search(r"p\.pmc(:\d+:\d+)?: error Y115\d: ", shown)


def test_a_line_more(workshop, text):
    shown = refused(workshop, text.replace("OPEN ROT", "I130=100000\nOPEN ROT"))
    assert re.search(r"p\.pmc(:\d+:\d+)?: error Y1151: line \d+ ", shown)


def test_another_robot(workshop, text):
    shown = refused(workshop, text, "--robot", "TRACKED_MANIPULATOR")
    assert (
        "error Y1163: the text was made for INDUSTRIAL6, but the command line names TRACKED_MANIPULATOR"
        in shown
    )
    robot = re.search("^; robot INDUSTRIAL6 (.*)$", text, re.MULTILINE)[1]
    shown = refused(workshop, text.replace(robot, "0" * 64))
    assert "error Y1163: the text was made for INDUSTRIAL6 as it was then" in shown
    assert "help: compile the program again" in shown


def test_a_robot_that_only_the_program_names(workshop):
    """The program's ROBOT line gives a path. The text's header has only the robot's name."""
    folder = workshop.folder / "arms" / "mine"
    shutil.copytree(load_robot("INDUSTRIAL6").value.folder, folder)
    described = folder / "robot.toml"
    described.write_text(re.sub("(?m)^name = .*$", 'name = "MINE"', described.read_text(), count=1))
    (workshop.folder / "made").mkdir()
    (workshop.folder / "sent").mkdir()
    program = 'ROBOT "../arms/mine/robot.toml"\nP0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n'
    workshop.write("made/own.yarc", program)
    made = yarclang.compile(program, name="own.yarc", folder=workshop.folder / "made").value.text
    workshop.write("made/own.pmc", made)
    assert "error" not in workshop.here("check", "made/own.pmc")
    workshop.write("sent/own.pmc", made)
    assert "Y1301" in workshop.here("check", "sent/own.pmc", status=1)
    run = ("run", "sent/own.pmc", "--source", "made/own.yarc", "--to", PATH, "--no-log")
    shown = workshop.here(*run, status=1)
    assert "can't be reached" in shown


def test_a_robot_of_nobody(workshop, text):
    shown = refused(workshop, text.replace("; robot INDUSTRIAL6 ", "; robot MINE "))
    assert "p.pmc: error Y1301: " in shown
    assert "help: if it is your own robot, give its path: --robot PATH" in shown
    shown = refused(workshop, re.sub(r"^; robot .*\n", "", text, flags=re.MULTILINE))
    assert "error Y1151: line 3 is '; program " in shown
    assert "expected in the header: the robot" in shown


def test_for_a_program_buffer(workshop):
    text = yarclang.compile(ROUND, target="prog").value.text
    shown = refused(workshop, text)
    assert "error Y1162: this text is for a program buffer, which isn't streamed" in shown
    assert "help: compile it without --target prog" in shown


@pytest.mark.parametrize("content", ["", "X1\n", "ROBOT INDUSTRIAL6\nP0010 MOVEJ HOME\n"])
def test_something_else(workshop, content):
    assert "error Y1151: this text wasn't written by yarcc" in refused(workshop, content)


def test_bytes_that_are_no_text(workshop):
    (workshop.folder / "p.pmc").write_bytes(b"; yarcc \xff\x00")
    shown = workshop.here("run", "p.pmc", "--to", PATH, status=1)
    assert "error Y1151: line 1 has a byte that is no ASCII (0xFF) in column 9" in shown
    assert "error Y0107" in workshop.here("run", "q.pmc", "--to", PATH, status=1)
