"""`yarc run` without errors, with wrong usage, and without a controller."""

import re
import socket
import threading

import pytest

from tests.cli.run_processes import run_on
from tests.conftest import EXAMPLES


def test_listing_4(workshop):
    text = workshop.yarc(
        "run", str(EXAMPLES / "01_listing4.yarc"), "--robot", "INDUSTRIAL6", "--rate", "6", "--no-log"
    )
    assert "P0002 MOVEJ_SPLINE_LSPB  20.0 s to 40.0 s of 40.0 s\n" in text
    assert "01_listing4.yarc: done; INDUSTRIAL6 is at the program's end, within one count" in text


def test_the_second_robot(workshop):
    text = workshop.yarc("run", str(EXAMPLES / "03_differential_wrist.yarc"), "--rate", "5", "--no-log")
    assert (
        "03_differential_wrist.yarc: done; TRACKED_MANIPULATOR is at the program's end, within one count"
        in text
    )


def test_a_dry_run(workshop, simulator):
    text = workshop.here(*run_on(simulator, "--dry-run"))
    assert re.search(r"^\d+ checks passed; nothing moved \(--dry-run\)$", text, re.MULTILINE)
    assert (simulator.stands() == 0.0).all()
    workshop.write(
        "q.yarc", "ROBOT INDUSTRIAL6\nSTART 9 0 0 0 0 0 (deg)\nP0010 MOVEJ 5 0 0 0 0 0 [1] (deg,s)\n"
    )
    text = workshop.here(*run_on(simulator, "--dry-run", program="q.yarc"), status=1)
    assert "the robot doesn't stand where q.yarc starts: J1 -9.0000 deg\n" in text
    text = workshop.here(*run_on(simulator, "--dry-run", "--approach", program="q.yarc"))
    assert re.search(r"an approach takes \d\.\d s, all joints straight to J1 9.000 deg, ", text)
    assert (simulator.stands() == 0.0).all()


def test_twice(workshop):
    text = workshop.yarc("run", "p.yarc", "--times", "2", "--rate", "4", "--no-log")
    assert text.count("P0020 MOVEJ  0.7 s to 1.4 s of 2.1 s\n") == 2
    assert "pass 2 of 2\n" in text
    assert "p.yarc: done 2 times; INDUSTRIAL6 is at the program's end, within one count" in text


def test_twice_from_a_command(workshop):
    """The first pass begins at the command, and the second one is complete."""
    text = workshop.yarc("run", "p.yarc", "--times", "2", "--from", "P0030", "--rate", "4", "--no-log")
    assert (text.count("P0010 MOVEJ"), text.count("P0030 MOVEJ")) == (1, 2)


WAITS = """\
ROBOT INDUSTRIAL6
INPUT READY M11
P0010 WAIT READY ON [0.5] (s)
P0020 MOVEJ 3 0 0 0 0 0 [0.5] (deg,s)
P0030 HOLD "look"
P0040 MOVEJ 0 0 0 0 0 0 [0.5] (deg,s)
"""


@pytest.mark.parametrize("options", [[], ["--step"]])
def test_a_wait_comes_first(workshop, simulator, options):
    workshop.write("q.yarc", WAITS)
    text = workshop.yarc(*run_on(simulator, *options, program="q.yarc"), status=1)
    assert "q.yarc:3:1: error Y1604: P0010 WAIT has waited 0.5 s for READY (M11) to be ON: it is OFF" in text
    assert "    3 | P0010 WAIT READY ON [0.5] (s)\n" in text
    assert "  it was at P0010 WAIT\n" in text
    assert (simulator.stands() == 0.0).all()
    assert simulator.complaints() == []


def test_a_wait_on_the_simulator_says_what_sets_inputs(workshop):
    workshop.write("q.yarc", WAITS)
    words = "inputs of a simulated robot stay OFF until they are set by a sensor of the cell, --set INPUT=ON"
    assert words in workshop.yarc("run", "q.yarc", "--no-log", "--rate", "8", status=1)
    assert words not in workshop.yarc(
        "run", "q.yarc", "--no-log", "--rate", "8", "--set", "READY=OFF", status=1
    )


def test_stopped_at_a_hold(workshop, simulator):
    """After a stop at a HOLD, the run can continue with this HOLD, from the robot's position."""
    workshop.write("q.yarc", WAITS)
    process = workshop.start(*run_on(simulator, "--from", "P0020", program="q.yarc"))
    process.wait_for("P0030 HOLD holds: look; continue with Enter or `yarc resume`")
    workshop.here("stop")
    text = process.end(1)
    assert "q.yarc: stopped\n  INDUSTRIAL6 is at J1 3.000 deg, " in text
    assert "  it was at P0030 HOLD\n" in text
    assert text.endswith(f"  to continue: yarc run q.yarc --to {simulator.address} --tm 10 --from P0030\n")


@pytest.mark.parametrize("again", [["--loop"], ["--times", "2"]])
def test_a_loop_must_be_closed(workshop, simulator, again):
    workshop.write("q.yarc", "ROBOT INDUSTRIAL6\nP0010 MOVEJ 5 0 -3 0 0 0 [1] (deg,s)\n")
    text = workshop.here(*run_on(simulator, *again, program="q.yarc"), status=1)
    assert (
        "q.yarc can't be looped, since it doesn't end where it starts: its end is off by J1 +5.0000 deg, "
        "J3 -3.0000 deg\n"
    ) in text
    assert "help: add a last motion to its start" in text
    assert (simulator.stands() == 0.0).all()


def test_a_command_that_there_is_not(workshop, simulator):
    text = workshop.here(*run_on(simulator, "--from", "P0040"), status=1)
    assert "error Y1164: no motion has the index P0040\n  help: the indexes are P0010, P0020, P0030\n" in text


def test_a_program_with_mistakes(workshop, simulator):
    workshop.write("q.yarc", "ROBOT INDUSTRIAL6\nP0010 MOVEJ 500 0 0 0 0 0 [1] (deg,s)\n")
    assert "q.yarc:2:13: error Y" in workshop.here(*run_on(simulator, program="q.yarc"), status=1)
    assert "Y0107" in workshop.here("run", "nowhere.yarc", status=1)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (["--log", "a.mcap", "--no-log"], "--log and --no-log exclude each other"),
        (["--to", "tcp://127.0.0.1:1", "--rate", "2"], "a controller runs in real time"),
        (["--step", "--loop"], "--step and --loop exclude each other"),
        (["--step", "--times", "2"], "--step and --times exclude each other"),
        (["--loop", "--times", "2"], "--loop and --times exclude each other"),
        (["--times", "0"], "0 is not in the range"),
        (["--rate", "-1"], "isn't a positive number"),
        (["--patience", "nan"], "isn't a positive number"),
        (["--patience", "0.01"], "isn't between 0.1 and 60"),
        (["--patience", "1e9"], "isn't between 0.1 and 60"),
        (["--to", "127.0.0.1:1025"], "is tcp:// missing?"),
        (["--to", "tcp://127.0.0.1:99999"], "the port must be a number from 1 to 65535"),
        (["--start", "1,x"], "isn't a list of numbers"),
        (["--faster"], "No such option"),
        (["another.yarc"], "unexpected extra argument"),
    ],
)
def test_wrong_usage(workshop, arguments, reason):
    assert reason in workshop.here("run", "p.yarc", *arguments, status=2)


@pytest.mark.parametrize(
    "arguments",
    [["--from", "P0010"], ["--step"], ["--tm", "10"], ["--start", "0,0,0,0,0,0"]],
)
def test_what_a_compiled_program_cant_do(workshop, arguments):
    words = f"{arguments[0]}: only with the program itself, the .yarc file"
    assert words in workshop.here("run", "p.PMC", *arguments, status=2)


def test_no_program():
    from click.testing import CliRunner

    from yarclang.cli.yarc import main

    assert CliRunner().invoke(main, ["run"]).exit_code == 2


def test_nobody_is_there(workshop):
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
        for command in (("run", "p.yarc"), ("doctor", "--robot", "INDUSTRIAL6")):
            text = workshop.here(*command, "--to", f"tcp://127.0.0.1:{port}", status=1)
            assert f"error: 127.0.0.1:{port} can't be reached: connection refused\n" in text
            assert "help: check the address, the cable, and the controller's power" in text


def test_somebody_else_is_there(workshop):
    """Instead of a controller, something answers like a web server."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve():
            wire, _ = server.accept()
            with wire:
                wire.recv(100)
                wire.sendall(b"HTTP/1.1 400 Bad Request\r\nConnection: close\r\n\r\n")

        thread = threading.Thread(target=serve)
        thread.start()
        text = workshop.here("run", "p.yarc", "--to", f"tcp://127.0.0.1:{server.getsockname()[1]}", status=1)
        thread.join(10)
    assert "the device at that address doesn't answer like a PMAC: " in text
    assert "help: check the address" in text


def test_another_robot_hangs_on_it(workshop, simulator):
    text = workshop.here(
        "run", str(EXAMPLES / "03_differential_wrist.yarc"), "--to", simulator.address, "--no-log", status=1
    )
    assert "ERROR    axis definition of motor 5: " in text
    assert re.search(r"error: \d+ of \d+ checks failed; nothing moved", text)
    assert f"`yarc doctor --to {simulator.address} --robot TRACKED_MANIPULATOR` shows all of them" in text
    assert simulator.complaints() == []


ENDS = """ROBOT INDUSTRIAL6
START HOME
INPUT JOB M11
P0010 MOVEJ 3 0 0 0 0 0 [0.5] (deg,s)
WHEN JOB ON
P0020 ABORT "no such job"
ELSE
P0030 STOP
END
"""
GOES_ON = """ROBOT INDUSTRIAL6
START HOME
INPUT JOB M11
P0010 MOVEJ 3 0 0 0 0 0 [0.5] (deg,s)
WHEN JOB OFF
P0020 STOP
END
P0030 MOVEJ 5 0 0 0 0 0 [0.5] (deg,s)
"""


def test_an_abort_is_the_runs_reason(workshop, simulator):
    workshop.write("q.yarc", ENDS)
    workshop.yarc(*run_on(simulator, program="q.yarc"))
    workshop.write(
        "q.yarc", ENDS.replace("ON\n", "OFF\n", 1).replace("START HOME", "START 3 0 0 0 0 0 (deg)")
    )
    text = workshop.yarc(*run_on(simulator, program="q.yarc"), status=1)
    assert "q.yarc:6:1: error Y1635: P0020 ABORT ends the program: no such job\n" in text
    assert "to continue" not in text
    assert simulator.stands()[0] != 0.0
    assert simulator.complaints() == []


def test_steps_without_a_terminal_end_at_once(workshop):
    text = workshop.yarc("run", "p.yarc", "--step", "--no-log", status=2)
    assert "--step waits for Enter after each command, and standard input isn't a terminal" in text
    assert "init" not in text


@pytest.mark.parametrize("options", [[], ["--step"]])
def test_nothing_is_done_after_a_stop_in_a_way(workshop, simulator, options):
    """With and without single steps, a STOP in a branch also leaves out the motion after the WHEN."""
    workshop.write("q.yarc", GOES_ON)
    process = workshop.start(*run_on(simulator, *options, program="q.yarc"))
    text = process.end(0)
    assert "P0020 STOP: the program ends here" in text
    assert "P0030" not in text
    assert simulator.complaints() == []
