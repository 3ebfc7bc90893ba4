"""Tests of `yarc repl` as a process, in a terminal and with lines on standard input."""

import os
import re
import signal
import subprocess
import sys
import time

import pexpect
import pytest

from yarclang.runtime.transports.lock import controller_lock

REPL = [
    sys.executable,
    "-c",
    "from yarclang.cli.yarc import main; main()",
    "repl",
    "--robot",
    "industrial6",
    "--no-log",
]
PLACE = re.compile(r"J1 (-?\d+\.\d+) deg")


@pytest.fixture
def place(tmp_path):
    return {
        "cwd": tmp_path,
        "env": {**os.environ, "XDG_STATE_HOME": str(tmp_path / "state"), "NO_COLOR": "1"},
    }


def read(lines, place, *options):
    return subprocess.run(
        [*REPL, *options],
        input="\n".join(lines) + "\n",
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        **place,
    )


@pytest.fixture
def terminal(place):
    env = {**place["env"], "PROMPT_TOOLKIT_NO_CPR": "1", "TERM": "xterm"}
    child = pexpect.spawn(
        REPL[0], REPL[1:], cwd=str(place["cwd"]), env=env, encoding="utf-8", timeout=30, dimensions=(40, 160)
    )
    child.expect("yarc>")
    yield child
    child.close(force=True)


def test_a_session_in_a_terminal(terminal):
    terminal.send("MOVEJ 30 0 0 0 60 0 [6] (deg,s)\r")
    terminal.expect(r"MOVEJ  6\.00 s")
    terminal.expect(r"go\? \[y/N\]")
    terminal.send("y\r")
    time.sleep(1.5)  # the robot moves in real time
    terminal.send("\x03")
    terminal.expect("stopping on the path")
    terminal.expect("stopped on its path")
    terminal.expect(PLACE)
    assert 0.0 < float(terminal.match[1]) < 30.0
    terminal.send(".wher\t")
    terminal.expect(r"\.where")
    terminal.send("\r")
    terminal.expect(r"\{TCP\} -?\d")
    terminal.send("\x04")
    terminal.expect(pexpect.EOF)
    terminal.wait()
    assert terminal.exitstatus == 0


def test_the_end_of_the_terminal_brings_the_robot_to_rest(terminal):
    terminal.send(".go\r")
    terminal.expect("begin at once")
    terminal.send("MOVEJ 30 0 0 0 60 0 [20] (deg,s)\r")
    time.sleep(1.5)
    since = time.monotonic()
    terminal.kill(signal.SIGHUP)
    terminal.expect("stopped on its path")
    terminal.expect(pexpect.EOF)
    terminal.wait()
    assert time.monotonic() - since < 10.0  # the motion would take 20 s
    assert terminal.exitstatus == 0


def test_lines_of_standard_input(place):
    done = read(["MOVEJ 10 0 0 0 20 0 [1] (deg,s)", "y", ".joints"], place)
    assert done.returncode == 0
    assert done.stdout.splitlines()[-2:] == [
        "done",
        "J1 10.000 deg, J2 0.000 deg, J3 0.000 deg, J4 0.000 deg, J5 20.000 deg, J6 0.000 deg",
    ]


def test_a_line_that_fails_is_the_status(place):
    done = read(["MOVJE 1"], place)
    assert done.returncode == 1
    assert "Y0202" in done.stdout
    assert "Traceback" not in done.stderr


def test_a_question_that_nobody_answers_is_no(place):
    done = read(["MOVEJ 10 0 0 0 20 0 [1] (deg,s)"], place)
    assert "nothing moved" in done.stdout
    assert read([""], place).returncode == 0


@pytest.mark.parametrize(
    ("options", "status", "word"),
    [
        (["--start", "999,0,0,0,0,0"], 1, "--start has J1 829 deg outside of its limits"),
        (["--start", "1,2"], 1, "has 2 values"),
        (["--to", "tcp://127.0.0.1:1", "--rate", "2"], 2, "works only with the simulator"),
        (["--to", "tcp://127.0.0.1:1"], 1, "help"),
        (["--log", "x", "--no-log"], 2, "exclude"),
        (["--robot", "nobody"], 1, "Y1301"),
    ],
)
def test_bad_options(place, options, status, word):
    done = read([], place, *options)
    assert done.returncode == status
    assert word in done.stderr
    assert "Traceback" not in done.stderr


def test_motions_are_logged(place):
    command = [one for one in REPL if one != "--no-log"]
    done = subprocess.run(
        [*command, "--go"],
        input="MOVEJ 10 0 0 0 20 0 [1] (deg,s)\n.log\n",
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        **place,
    )
    assert "the log is yarc-runs/" in done.stdout
    assert len(list((place["cwd"] / "yarc-runs").iterdir())) == 1


def test_a_log_that_is_removed_meanwhile_is_lost(place):
    command = [*(one for one in REPL if one != "--no-log"), "--go"]
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, text=True, **pipes, **place) as process:
        process.stdin.write("MOVEJ 10 0 0 0 20 0 [1] (deg,s)\n")
        process.stdin.flush()
        until = time.monotonic() + 60.0
        while not (found := list((place["cwd"] / "yarc-runs").glob("*.mcap"))):
            assert time.monotonic() < until
            time.sleep(0.02)
        found[0].unlink()
        out, err = process.communicate(".log\n", timeout=60)
    assert process.returncode == 1
    for text in (out, err):
        assert re.search(
            r"the run log can't be used any more: yarc-runs/\S+\.mcap doesn't exist any more", text
        )


def test_a_controller_that_somebody_else_drives_is_left_alone(place):
    with controller_lock("127.0.0.1", 1):
        done = read([], place, "--to", "tcp://127.0.0.1:1")
    assert done.returncode == 1
    assert "drive" in done.stderr
    assert "Traceback" not in done.stderr
