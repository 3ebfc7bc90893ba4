"""`yarc serve`: one process owns the robot, and others use it one at a time, watch it, and stop it."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.cli.run_processes import YARC, assert_on_path
from yarclang import client as client_module
from yarclang.client import VERSION, Gone, Refused, Robot, find

OLD_PYTHONS = [path for path in Path.home().glob(".pyenv/versions/3.8*/bin/python3") if path.exists()]


@pytest.fixture
def served(workshop, simulator):
    """Serve a robot whose controller is a simulator in another process; return the server's process."""
    return serve(workshop, "--to", simulator.address)


@pytest.fixture
def home(workshop, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", workshop.environment["XDG_RUNTIME_DIR"])


def serve(workshop, *options):
    process = workshop.start("serve", "--robot", "INDUSTRIAL6", *options)
    process.wait_for("is served: ")
    text = next(line for line in process.out if "is served: " in line)
    process.path = text.split("is served: ")[1].strip()
    return process


LONG = """\
ROBOT INDUSTRIAL6
P0010 MOVEJ 9 4 -6 3 6 3 [7] (deg,s)
P0020 MOVEJ 6 -4 -3 5 2 8 [7] (deg,s)
P0030 MOVEJ 0 0 0 0 0 0 [7] (deg,s)
"""
"""A program long enough for other processes to begin and end while it runs."""


def to(simulator):
    return ("--to", simulator.address)


def test_a_program_is_run_there(workshop, simulator, served):
    text = workshop.yarc("run", "p.yarc", *to(simulator))
    assert f"industrial6-{served.pid} serves the robot" in text
    assert "P0020 MOVEJ  0.7 s to 1.4 s of 2.1 s" in text
    assert "p.yarc: done; INDUSTRIAL6 is at the program's end, within one count" in text
    events = [json.loads(line) for line in workshop.yarc("exec", "p.yarc", *to(simulator)).splitlines()]
    assert events[-1]["well"] is True
    assert {"began", "part", "state", "progress", "finished"} <= {one["event"] for one in events}
    logs = sorted((workshop.folder / "yarc-runs").glob("p-*.mcap"))
    assert len(logs) == 2  # each owner has a log of its own
    assert events[-1]["log"] in {str(log.relative_to(workshop.folder)) for log in logs}
    assert "P0010 MOVEJ" in workshop.here("replay", str(logs[0]))
    assert {"run owns the robot", "exec owns the robot"} <= {line.strip() for line in served.err}


def test_a_simulated_robot_is_found_without_an_address(workshop):
    process = serve(workshop, "--no-log")
    text = workshop.yarc("run", "p.yarc")
    assert f"industrial6-{process.pid} serves the robot" in text
    workshop.write("other.yarc", "ROBOT TRACKED_MANIPULATOR\nP0010 STOP\n")
    assert "TRACKED_MANIPULATOR is simulated" in workshop.yarc("run", "other.yarc")
    elsewhere = "ROBOT INDUSTRIAL6\nSTART 5 0 0 0 0 0 (deg)\nP0010 MOVEJ 0 0 0 0 0 0 [1] (deg,s)\n"
    workshop.write("elsewhere.yarc", elsewhere)
    assert "doesn't stand where elsewhere.yarc starts" in workshop.yarc("run", "elsewhere.yarc", status=1)
    assert "done" in workshop.yarc("run", "elsewhere.yarc", "--approach", "--yes")
    process.signal(signal.SIGINT)
    assert "Traceback" not in process.end(0)


def test_a_real_controller_moves_only_by_its_address(workshop, simulator, served):
    assert "INDUSTRIAL6 is simulated" in workshop.yarc("run", "p.yarc")
    assert simulator.stands() == pytest.approx([0.0] * 6, abs=1e-6)


def test_one_owns_it_and_everybody_stops_it(workshop, simulator, served):
    workshop.write("long.yarc", LONG)
    first = workshop.start("run", "long.yarc", *to(simulator))
    first.wait_for("P0010 MOVEJ")
    refused = workshop.yarc("run", "p.yarc", *to(simulator), status=1)
    assert "run owns the robot; run-2 can only watch" in refused
    last = json.loads(workshop.yarc("exec", "p.yarc", *to(simulator), status=1).splitlines()[-1])
    assert (last["code"], last["well"]) == ("Y1611", False)
    assert workshop.here("hold").startswith(f"industrial6-{served.pid}: holding on the path")
    assert_on_path(simulator.comes_to_rest())
    assert "run" in workshop.here("status")
    # commands in other terminals also reach the run of a served robot
    assert ": move, " in workshop.here("resume")
    assert "ended" in workshop.here("stop")
    assert "long.yarc: stopped on its path" in first.end(1)
    assert "done" in workshop.yarc("run", "p.yarc", "--approach", "--yes", *to(simulator))


def test_an_owner_that_is_killed_leaves_it_at_rest_for_the_next(workshop, simulator, served):
    first = workshop.start("exec", "p.yarc", "--tm", "10", *to(simulator))
    first.wait_for('"state": "move"')
    first.kill()
    served.wait_for("nobody owns the robot")
    assert_on_path(simulator.comes_to_rest())
    assert simulator.complaints() == []
    assert "done" in workshop.yarc("run", "p.yarc", "--approach", "--yes", *to(simulator))


def test_a_terminal_of_run_holds_and_aborts_there(workshop, simulator, served):
    terminal = workshop.terminal("run", "p.yarc", "--tm", "10", *to(simulator))
    terminal.wait_for("move")
    terminal.type("\x03")
    terminal.wait_for("holding")
    assert_on_path(simulator.comes_to_rest())
    terminal.type("\r")
    terminal.wait_for("P0030 MOVEJ")
    assert "done" in terminal.end(0)


def test_steps_and_errors_are_told_as_by_a_run_of_its_own(workshop, simulator, served):
    workshop.write("bad.yarc", "ROBOT INDUSTRIAL6\nP0010 MOVEJ 500 0 0 0 0 0 [1] (deg,s)\n")
    text = workshop.yarc("run", "bad.yarc", *to(simulator), status=1)
    assert "bad.yarc:2:13: error Y0502" in text
    assert "    2 | P0010 MOVEJ 500 0 0 0 0 0 [1] (deg,s)" in text
    workshop.yarc("run", "nothing.yarc", *to(simulator), status=1)
    terminal = workshop.terminal("run", "p.yarc", "--step", *to(simulator))
    for title in ("P0020 MOVEJ (2 of 3)", "P0030 MOVEJ (3 of 3)"):
        terminal.wait_for(f"Enter or `yarc resume` for {title}")
        terminal.type("\r")
    assert "done" in terminal.end(0)


def test_options_of_the_server_are_refused(workshop, simulator, served):
    for option in (("--log", "x.mcap"), ("--no-log",)):
        text = workshop.yarc("run", "p.yarc", *to(simulator), *option, status=2)
        assert f"{option[0]}: industrial6-{served.pid} serves this robot" in text


def test_another_robot_is_refused(workshop, simulator, served):
    workshop.write("other.yarc", "ROBOT TRACKED_MANIPULATOR\nP0010 STOP\n")
    text = workshop.yarc("run", "other.yarc", *to(simulator), status=1)
    assert "serves another robot than TRACKED_MANIPULATOR" in text


def test_the_prompt_attaches(workshop, simulator, served):
    lines = "MOVEJ 5 0 0 0 20 0 [1] (deg,s)\n.where\nLET A = 3\n.plot way.png\n.back\n.log\n.quit\n"
    done = subprocess.run(
        [*YARC, "repl", "--go", "--robot", "INDUSTRIAL6", *to(simulator)],
        cwd=workshop.folder,
        env=workshop.environment,
        input=lines,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("done") == 2
    assert "it is valid from now on" in done.stdout
    assert (workshop.folder / "way.png").read_bytes().startswith(b"\x89PNG")
    assert "the log is yarc-runs" in done.stdout
    assert simulator.stands() == pytest.approx([0.0] * 6, abs=1e-4)


def test_a_master_steers_what_is_served(workshop, simulator, served):
    follow = workshop.start("follow", "--robot", "INDUSTRIAL6", *to(simulator))
    follow.wait_for('"listening"')
    path = json.loads(follow.out[0])["unix"]
    with socket.socket(socket.AF_UNIX) as wire:
        wire.connect(path)
        lines = wire.makefile("rw")
        for _ in range(40):
            lines.write(json.dumps({"velocity": {"J1": 5}}) + "\n")
            lines.flush()
            answer = json.loads(lines.readline())
            assert answer["ok"], answer
            time.sleep(0.02)
        lines.close()
    simulator.comes_to_rest()
    assert simulator.stands()[0] > 0.2
    follow.signal(signal.SIGTERM)
    last = json.loads(follow.end(0).splitlines()[-1])
    assert last["joints"]["J1"] == pytest.approx(simulator.stands()[0], abs=1e-3)


def test_a_server_that_ends_stops_its_robot_and_says_so_to_its_clients(workshop, simulator, served):
    first = workshop.start("exec", "p.yarc", "--tm", "10", *to(simulator))
    first.wait_for('"state": "move"')
    served.signal(signal.SIGTERM)
    served.end(0)
    assert_on_path(simulator.comes_to_rest())
    last = json.loads(first.end(1).splitlines()[-1])
    assert last["well"] is False
    assert last["what"] in ("stopped on its path", f"industrial6-{served.pid} has ended")
    assert simulator.complaints() == []


def test_a_server_that_is_killed(workshop, simulator, served):
    first = workshop.start("exec", "p.yarc", "--tm", "10", *to(simulator))
    first.wait_for('"state": "move"')
    served.kill()
    last = json.loads(first.end(1).splitlines()[-1])
    assert last["what"] == f"industrial6-{served.pid} has ended"
    assert_on_path(simulator.comes_to_rest())  # the guard PLC holds the robot
    assert (
        "done" in workshop.yarc("run", "p.yarc", "--approach", "--yes", *to(simulator), status=None) or True
    )


def test_a_server_that_hangs_is_given_up(workshop, simulator, served):
    first = workshop.start("exec", "p.yarc", "--tm", "10", *to(simulator))
    first.wait_for('"state": "move"')
    served.signal(signal.SIGSTOP)
    try:
        assert_on_path(simulator.comes_to_rest())  # the guard PLC holds the robot
        first.signal(signal.SIGTERM)
        time.sleep(3.5)
        first.signal(signal.SIGTERM)
        assert "the robot's state is unknown" in json.loads(first.end(1).splitlines()[-1])["what"]
        text = workshop.yarc("run", "p.yarc", *to(simulator), status=1)
        assert f"process {served.pid}" in text  # the process that holds the controller's lock
    finally:
        served.signal(signal.SIGCONT)


def test_a_terminal_that_is_not_read_delays_nobody(workshop, simulator, home):
    """The pipe for the server's output is full, and orders are still carried out."""
    import fcntl

    reading, writing = os.pipe()
    fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 4096)
    process = subprocess.Popen(
        [*YARC, "serve", "--robot", "INDUSTRIAL6", "--no-log", *to(simulator)],
        cwd=workshop.folder,
        env=workshop.environment,
        stdout=subprocess.PIPE,
        stderr=writing,
        text=True,
    )
    try:
        path = process.stdout.readline().split("is served: ")[1].strip()
        with Robot(path, name="somebody with a long name") as robot:
            for _ in range(150):
                robot.own()
                robot.release()
            assert robot.status()["owner"] is None
    finally:
        process.kill()
        process.wait()
        process.stdout.close()
        os.close(reading)
        os.close(writing)


# the client that consists of one file


def test_the_client_finds_and_moves_a_robot(workshop, simulator, served, home):
    assert [(one.robot, one.path) for one in find()] == [("industrial6", served.path)]
    with Robot("industrial6", name="me") as robot, Robot(served.path, name="me") as other:
        assert (robot.welcome["name"], other.welcome["name"]) == ("me", "me-2")
        assert robot.welcome["version"] == VERSION
        robot.own()
        made = robot.offer("MOVEJ 5 0 0 0 20 0 [1] (deg,s)")["offer"]
        assert made["duration_s"] == pytest.approx(1.0)
        assert made["motions"][0]["peaks"]["velocity"]["share"] < 1.0
        assert made["course"]["joints"][-1] == pytest.approx([5, 0, 0, 0, 20, 0], abs=1e-3)
        with pytest.raises(Refused, match="me owns the robot") as refused:
            other.go(made["number"])
        assert refused.value.code == "Y1611"
        assert robot.go(made["number"])["well"]
        assert simulator.stands() == pytest.approx([5, 0, 0, 0, 20, 0], abs=1e-3)
        with pytest.raises(Refused, match="isn't any more at the position"):
            robot.go(made["number"])
        wrong = robot.offer("MOVEJ 500 0 0 0 0 0 [1] (deg,s)")
        assert wrong["offer"] is None
        assert wrong["findings"][0]["code"] == "Y0502"
        assert robot.load(str(workshop.folder / "p.yarc"))["program"]["name"] == "p.yarc"
    with pytest.raises(Gone):
        Robot("nobody")


def test_the_client_hears_events_and_stops_from_elsewhere(workshop, simulator, served, home):
    import threading

    with Robot(name="me") as robot, Robot(name="watcher") as watcher:
        robot.own()
        number = robot.offer("MOVEJ 40 0 0 0 20 0 [8] (deg,s)")["offer"]["number"]
        ended = {}
        mover = threading.Thread(target=lambda: ended.update(robot.go(number)))
        mover.start()
        for event in watcher.events(positions=True):
            if event["event"] == "position" and event["joints"]["J1"] > 1.0:
                break
        watcher.stop()
        mover.join(20)
        assert (ended["well"], ended["what"]) == (False, "stopped on its path")
    assert_rests(simulator)


def test_what_one_connection_orders_is_heard_in_this_order(workshop, simulator, served, home):
    """Orders on one connection are carried out in their order.

    A stop just after a run ends it, even if it is sent before the run's answer.
    """
    with Robot(name="me") as robot:
        robot.own()
        for _ in range(5):
            number = robot.offer("DMOVEJ 1 0 0 0 0 0 [4] (deg,s)")["offer"]["number"]
            going, stopping = robot.order("go", offer=number), robot.order("stop")
            assert robot.answer(stopping)["ok"]
            assert not robot.answer(going, 20.0)["well"]
        refused = robot.order("go", offer=0)
        with pytest.raises(Refused, match="no offer 0"):
            robot.answer(refused)
    assert_rests(simulator)


def test_a_stop_since_its_client_owns_the_robot_keeps_a_run_from_beginning(workshop, simulator, served, home):
    with Robot(name="me") as robot, Robot(name=None) as other:
        robot.own()
        number = robot.load(str(workshop.folder / "p.yarc"), here=True)["program"]["number"]
        other.ask("stop")
        ended = robot.ask("run", program=number, approach=True, unless_stopped=True, patience=60.0)
        assert (ended["well"], ended["moved"]) == (False, False)
        assert ended["what"] == "stopped before it began; nothing moved"
        robot.own()
        ended = robot.ask("run", program=number, approach=True, unless_stopped=True, patience=60.0)
        assert ended["well"], ended


def test_a_connection_is_closed_while_somebody_waits_for_an_event(served, home):
    import threading

    robot = Robot(name="watcher")
    heard = []
    waiting = threading.Thread(target=lambda: heard.extend(robot.events()))
    waiting.start()
    time.sleep(0.3)
    robot.close()
    waiting.join(5.0)
    assert not waiting.is_alive()


def assert_rests(simulator):
    before = simulator.comes_to_rest()
    time.sleep(0.3)
    assert np.abs(simulator.stands() - before).max() < 1e-6


def test_attaching_is_quick(served, home):
    """The time from connecting to the first event is short."""
    took = []
    for _ in range(5):
        begun = time.perf_counter()
        with Robot(served.path, name="quick") as robot:
            for _ in robot.events(positions=True):
                break
        took.append(time.perf_counter() - begun)
    assert min(took) < 0.5  # the figure itself is measured by benchmarks/coordinator.py


def test_the_client_needs_nothing_but_the_standard_library():
    code = (
        "import sys, importlib.util as util; before = set(sys.modules)\n"
        f"spec = util.spec_from_file_location('client', {client_module.__file__!r})\n"
        "module = util.module_from_spec(spec); sys.modules['client'] = module; "
        "spec.loader.exec_module(module)\n"
        "new = {name.partition('.')[0] for name in set(sys.modules) - before}\n"
        "names = getattr(sys, 'stdlib_module_names', new)\n"
        "assert new - set(names) - {'client'} == set(), new\n"
        "assert module.find('/nowhere') == []\n"
    )
    for python in (sys.executable, *map(str, OLD_PYTHONS)):
        done = subprocess.run([python, "-I", "-c", code], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr


def test_the_client_is_written_for_python_3_8():
    import ast

    ast.parse(Path(client_module.__file__).read_text(encoding="utf-8"), feature_version=(3, 8))


def test_the_socket_is_its_users_alone(served):
    path = Path(served.path)
    assert path.lstat().st_mode & 0o777 == 0o600
    assert path.parent.lstat().st_mode & 0o777 == 0o700
    assert path.lstat().st_uid == os.getuid()


def test_a_controller_that_isnt_there_yet(workshop):
    """A server waits for its controller and says so, and a run is refused with this reason."""
    served = serve(workshop, "--to", "tcp://127.0.0.1:9")
    served.wait_for("no connection yet: 127.0.0.1:9 can't be reached")
    shown = workshop.yarc("run", "p.yarc", "--to", "tcp://127.0.0.1:9", status=1)
    assert "no connection" in shown
    served.signal(signal.SIGTERM)
    served.end(0)
