"""`yarc run` in a terminal: keys, questions, and the line that is updated."""

import os
import re
import signal
import time

import pytest

from tests.cli.run_processes import LONGEST, run_on

MOVES = "\x1b[KP0010 MOVEJ  0."


def screen(text):
    """Return the lines on the screen, where text after a carriage return overwrites the line."""
    return [line.rpartition("\x1b[K")[2] for line in text.split("\n")]


def test_step_by_step(workshop):
    terminal = workshop.terminal("run", "p.yarc", "--step", "--no-log", "--rate", "4")
    terminal.wait_for("Enter or `yarc resume` for P0020 MOVEJ (2 of 3), Ctrl-C ends the run")
    time.sleep(0.3)
    assert "for P0030" not in terminal.text  # the run waits for Enter
    left = re.search(r"done, ([\d.]+) s left", workshop.here("status"))
    assert float(left[1]) > 0.5, "all that comes after this step"
    terminal.type("\n")
    terminal.wait_for("for P0030 MOVEJ (3 of 3)")
    assert "override 50 %" not in terminal.text
    assert "50 % of the programmed speed (stop)" in workshop.here("override", "50")
    workshop.here("resume")
    text = terminal.end(0)
    assert "override 50 %" in text
    assert "p.yarc: done; INDUSTRIAL6 is at the program's end, within one count" in text


def test_ctrl_c_between_two_steps(workshop):
    terminal = workshop.terminal("run", "p.yarc", "--step", "--log", "run.mcap", "--rate", "4")
    terminal.wait_for("for P0020")
    terminal.type("\x03")
    text = terminal.end(1)
    assert "p.yarc: ended before P0020 MOVEJ" in text
    assert "INDUSTRIAL6 is at J1 9.000 deg" in text
    assert "ended before P0020 MOVEJ" in workshop.here("replay", "run.mcap", "--speed", "max")


def test_enter_goes_on_behind_a_hold(workshop):
    terminal = workshop.terminal("run", "p.yarc", "--no-log")
    terminal.wait_for(MOVES)
    terminal.type("\x03")
    terminal.wait_for("hold  P0010 MOVEJ  0.")
    terminal.type("\n")
    assert "p.yarc: done" in terminal.end(0)


def test_a_terminal_shows_the_lines_of_a_pipe(workshop):
    piped = workshop.yarc("run", "p.yarc", "--no-log", "--rate", "4")
    shown = workshop.terminal("run", "p.yarc", "--no-log", "--rate", "4").end(0)
    lines = [line.strip("\r") for line in screen(shown)]
    # in `piped`, standard output comes first; on a terminal it comes last
    last, *before = piped.splitlines()
    assert sum(line.startswith(("P0010 ", "P0020 ", "P0030 ")) for line in lines) == 3
    assert lines == [*before, last, ""]


def test_the_line_that_changes(workshop):
    workshop.write(
        "long.yarc",
        "ROBOT INDUSTRIAL6\nP0010 MOVEJ -110 -20 -60 -100 -110 -100 [3] (deg,s)\n",
    )
    # at this rate even a busy computer updates the line while the robot moves
    text = workshop.terminal("run", "long.yarc", "--no-log").end(0)
    written = [part for line in text.split("\n") for part in line.split("\r\x1b[K")]
    begins = "P0010 MOVEJ  0.0 s to 3.0 s of 3.0 s"
    assert [part.rstrip("\r") for part in written].count(begins) == 1
    live = [part for part in written if part.startswith("P0010 MOVEJ") and part.rstrip("\r") != begins]
    assert len(live) > 3
    for part in written:
        assert len(part) < 80
    # no value is cut off, and each has two decimals
    for part in live:
        assert re.fullmatch(
            r"P0010 MOVEJ  \d\.\d s of \d\.\d s, \d\.\d s left(  J1 -?\d+\.\d\d( J\d -?\d+\.\d\d)*)?", part
        )
    assert screen(text)[-2] == "long.yarc: done; INDUSTRIAL6 is at the program's end, within one count"


@pytest.mark.parametrize(("answer", "status"), [("n\n", 1), ("\x03", 1), ("y\n", 0)])
def test_an_approach_is_asked_for(workshop, simulator, answer, status):
    workshop.write(
        "q.yarc", "ROBOT INDUSTRIAL6\nSTART 1 0 0 0 0 0 (deg)\nP0010 MOVEJ 2 0 0 0 0 0 [0.5] (deg,s)\n"
    )
    terminal = workshop.terminal(*run_on(simulator, "--approach", program="q.yarc"))
    terminal.wait_for("Move there? [y/N]: ")
    assert simulator.joints()[0] == pytest.approx(0.0, abs=1e-6)
    terminal.type(answer)
    text = terminal.end(status)
    assert ("nothing moved" in text or "nothing was moved" in text) == bool(status)
    assert simulator.stands()[0] == pytest.approx(0.0 if status else 2.0, abs=1e-4)


def test_aborted_on_the_way_to_the_start(workshop, simulator):
    workshop.write(
        "q.yarc", "ROBOT INDUSTRIAL6\nSTART 9 0 0 0 0 0 (deg)\nP0010 MOVEJ 8 0 0 0 0 0 [0.5] (deg,s)\n"
    )
    terminal = workshop.terminal(*run_on(simulator, "--approach", "--yes", program="q.yarc"))
    terminal.wait_for("\x1b[Kto the start  0.")
    terminal.type("\x03")
    terminal.wait_for("hold: ")
    terminal.type("\x03")
    text = terminal.end(1)
    assert "q.yarc: aborted: off its path\n" in text
    assert "  it was on its way to the start\n" in text
    assert f"  to continue: yarc run q.yarc --to {simulator.address} --tm 10 --approach\n" in text
    assert 0.0 < simulator.stands()[0] < 9.0


def test_a_window_that_is_closed(workshop, simulator):
    """If the terminal's window is closed, the run stops the robot, and its log says so."""
    terminal = workshop.terminal(*run_on(simulator)[:-1], "--log", "run.mcap")
    terminal.wait_for(MOVES)
    terminal.hang_up()
    assert terminal.wait() == 1
    simulator.stands()
    assert simulator.complaints() == []
    assert "stopped on its path (P0010 MOVEJ, " in workshop.here("replay", "run.mcap", "--speed", "max")


def test_a_terminal_that_is_stopped_delays_nobody(workshop, simulator):
    """After Ctrl-S, the output waits, but the robot doesn't."""
    terminal = workshop.terminal(*run_on(simulator))
    terminal.wait_for(MOVES)
    terminal.type("\x13")
    until = time.monotonic() + LONGEST
    away = False
    while not away or abs(simulator.joints()[0]) > 1e-4:
        away = away or simulator.joints()[0] > 1.0
        assert time.monotonic() < until
        time.sleep(0.1)
    terminal.type("\x11")
    assert "p.yarc: done" in terminal.end(0)


def test_it_doesnt_go_to_sleep(workshop):
    terminal = workshop.terminal("run", "p.yarc", "--no-log")
    terminal.wait_for(MOVES)
    terminal.type("\x1a")
    terminal.wait_for("hold: hold requested")
    assert "this process can't be suspended while it drives a robot" in terminal.text
    os.kill(terminal.pid, signal.SIGTERM)
    assert "p.yarc: stopped on its path" in terminal.end(1)
