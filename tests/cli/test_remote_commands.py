"""`yarc hold`, `resume`, `stop`, `override` and `status`.

They are used during a run that streams to a simulator, and directly with a controller.
"""

import asyncio
import contextlib
import json
import os
import re
import shutil
import tempfile
import threading
import time
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

import yarclang
from yarclang.backend_pmac.settings import settings_text
from yarclang.cli.address import SIM, Address, AddressType
from yarclang.cli.commands import stop
from yarclang.cli.yarc import main as yarc
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.serving import ControlSocket
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.pipeline.settings import items_of
from yarclang.pmac.requests import PORT
from yarclang.runtime.notices import Changed
from yarclang.runtime.pmac.performance import connect, look
from yarclang.runtime.session import Session
from yarclang.runtime.state import State
from yarclang.runtime.transports.lock import controller_lock
from yarclang.simulator.commissioning import commissioned
from yarclang.simulator.network.embedded import EmbeddedSimulator

PROGRAM = "P0010 MOVEJ 30 -20 15 5 6 7 [20] (deg,s)\n"


@pytest.fixture(autouse=True)
def home(monkeypatch):
    path = Path(tempfile.mkdtemp(prefix="yarc-test-"))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(path))
    yield path
    shutil.rmtree(path)


@pytest.fixture(scope="module")
def job():
    compiled = yarclang.compile(PROGRAM, robot="INDUSTRIAL6").value
    return job_of_compiled(compiled, "a.yarc")


@pytest.fixture
def simulator(job):
    machine = commissioned(job.robot, settings_text(job.robot))
    with EmbeddedSimulator(machine) as simulator:
        yield simulator


class Running:
    """A `yarc run` in a thread, as other terminals see it; the robot moves when the context begins."""

    def __init__(self, job, port, *, heard_of=True):
        self.session = None
        self.ended = None
        self._job, self._port, self._heard_of = job, port, heard_of
        self._moves = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def __enter__(self):
        self._thread.start()
        assert self._moves.wait(20)
        return self

    def __exit__(self, *_):
        self.kill()
        self._thread.join(20)
        assert not self._thread.is_alive()

    def kill(self):
        """End the run as if its process was killed, without sending anything more."""
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._task.cancel)

    def wait(self):
        self._thread.join(20)
        return self.ended

    def _run(self):
        with contextlib.suppress(asyncio.CancelledError):
            asyncio.run(self._main())

    async def _main(self):
        self._loop, self._task = asyncio.get_running_loop(), asyncio.current_task()
        session = self.session = OrderedSession("127.0.0.1", self._port)
        session.listen(self._hear)
        coordinator = Coordinator(self._job.robot, session, folder=Path(), log=NO_LOG, name=self._job.name)
        try:
            with controller_lock("127.0.0.1", self._port):
                await coordinator.start()
                async with contextlib.AsyncExitStack() as stack:
                    if self._heard_of:
                        await stack.enter_async_context(ControlSocket(coordinator))
                    client = coordinator.attach("run")
                    client.session.own(shared=True)
                    self.ended = await client.motion.run(Loaded(self._job, self._job))
                await coordinator.close()
        finally:
            coordinator.give_up()
            session.close()

    def _hear(self, notice):
        if isinstance(notice, Changed) and notice.state is State.MOVE:
            self._moves.set()


@pytest.fixture
def running(job, simulator):
    with Running(job, simulator.port) as run:
        yield run


def call(*arguments, status=0):
    done = CliRunner().invoke(yarc, arguments)
    assert done.exception is None or isinstance(done.exception, SystemExit), done.exception
    assert done.exit_code == status, (done.stdout, done.stderr)
    return done


def status():
    return json.loads(call("status", "--format", "json").stdout)


def wait_for(look):
    """Return the first result of `look` that is true."""
    until = time.monotonic() + 30.0
    while not (seen := look()):
        assert time.monotonic() < until
        time.sleep(0.02)
    return seen


def told_at_rest():
    """Return the status of a robot whose newly reported positions haven't changed."""
    one = status()
    time.sleep(0.3)  # positions are reported every 0.1 s
    two = status()
    return two if one["joints"] == two["joints"] else None


def places(text):
    """Return the joint positions in a text."""
    return [float(value) for value in re.findall(r"J\d (?:commanded )?(-?[\d.]+) deg", text)]


def test_hold_resume_override_stop(running):
    moving = status()
    assert (moving["state"], moving["program"], moving["robot"]) == ("move", "a.yarc", "INDUSTRIAL6")
    assert moving["pid"] == os.getpid()
    assert moving["controller"] == f"127.0.0.1:{running.session.port}"

    held = call("hold").stdout
    assert held.startswith(f"industrial6-{os.getpid()}: holding on the path, ")
    assert status()["state"] == "hold"
    assert "holding" in call("hold", "--run", "industrial6").stdout
    one = wait_for(told_at_rest)
    assert one["why"] == "hold requested"
    assert one["command"] == {"title": "P0010 MOVEJ", "line": 1}

    assert ": move, " in call("resume").stdout
    assert "nothing to resume" in call("resume", status=1).stderr
    assert "37.5 % of the programmed speed (move)" in call("override", "37.5").stdout
    assert status()["override"] == 37.5

    text = call("status").stdout
    for line in (
        "program     a.yarc",
        "state       move",
        "command     P0010 MOVEJ, line 1",
        "override    37.5 %",
    ):
        assert line in text.splitlines()
    assert len(places(re.sub(" +", " ", text))) == 6

    assert "ended" in call("stop").stdout
    ended = running.wait()
    assert ended.what == "stopped on its path"
    assert ended.joints is not None
    assert "no yarc run on this computer" in call("stop", status=1).stderr


def test_stop_from_a_hold(running):
    call("hold")
    assert "ended" in call("stop", "--run", str(os.getpid())).stdout
    assert running.wait().what == "stopped on its path"


def test_abort(running):
    assert "ended" in call("stop", "--abort").stdout
    assert running.wait().what == "aborted: off its path"


@pytest.mark.parametrize("command", [["hold"], ["resume"], ["stop"], ["override", "50"], ["status"]])
def test_without_a_run(command):
    done = call(*command, status=1)
    assert done.stderr.startswith("error: no yarc run on this computer\n  help: ")
    assert done.stdout == ""


def test_which_run(running):
    assert f"there is industrial6-{os.getpid()}" in call("hold", "--run", "scara", status=1).stderr
    assert running.session.operation.state is State.MOVE


def test_runs_are_completed(running):
    environment = {"_YARC_COMPLETE": "bash_complete", "COMP_WORDS": "yarc hold --run ind", "COMP_CWORD": "3"}
    done = CliRunner().invoke(yarc, [], prog_name="yarc", env=environment)
    assert f"industrial6-{os.getpid()}" in done.stdout


def test_a_folder_that_others_may_enter(home):
    (home / "yarc").mkdir()
    (home / "yarc").chmod(0o755)
    assert "other users have access to" in call("status", status=1).stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["override"],
        ["override", "0"],
        ["override", "100.1"],
        ["override", "nan"],
        ["override", "half"],
        ["hold", "now"],
        ["stop", "--to", "tcp://127.0.0.1:1"],
        ["stop", "--robot", "INDUSTRIAL6"],
        ["stop", "--to", "tcp://127.0.0.1:1", "--robot", "INDUSTRIAL6", "--run", "x"],
        ["stop", "--to", "sim", "--robot", "INDUSTRIAL6"],
        ["status", "--to", "127.0.0.1:1", "--robot", "INDUSTRIAL6"],
        ["status", "--format", "xml"],
        ["status", "--abort"],
    ],
)
def test_wrong_usage(arguments):
    assert "Error: " in call(*arguments, status=2).stderr


# a controller without a run of this computer


def to(simulator):
    return ["--to", f"tcp://127.0.0.1:{simulator.port}", "--robot", "INDUSTRIAL6"]


def picture(simulator):
    return json.loads(call("status", *to(simulator), "--format", "json").stdout)


def complaints(job, simulator):
    """Return the errors that would keep a run from a controller."""

    async def looked():
        session = Session("127.0.0.1", simulator.port)
        await session.perform(connect(session.operation))
        found = await session.perform(look(session.operation, job.robot, items_of(job.robot)))
        session.close()
        return found.errors

    return asyncio.run(looked())


def test_the_state_of_a_controller_that_does_nothing(job, simulator):
    now = picture(simulator)
    assert now["controller"] == f"tcp://127.0.0.1:{simulator.port}"
    assert now["kind"] == "TURBO2, X4 (CID 602413)"
    assert now["firmware"] == "1.945"
    assert now["program"] == "none runs in coordinate system 1"
    assert (now["override"], now["guard"]) == (100.0, 0.0)
    assert now["motors"] == {str(motor): "closed-loop, homed, at rest" for motor in range(1, 7)}
    for joint, at in zip(now["joints"], job.robot.home / job.robot.axis_units, strict=True):
        assert joint["commanded"] == pytest.approx(at, abs=1e-3)
        assert joint["actual"] == pytest.approx(at, abs=1e-3)
    text = call("status", *to(simulator)).stdout
    assert "guard       not armed (P8100 is 0)" in text.splitlines()
    assert complaints(job, simulator) == ()


def test_motors_in_plain_language(job):
    machine = commissioned(job.robot, settings_text(job.robot))
    machine.command("#2K")
    machine.fault_amplifier(3)
    machine.set_limit_switch(4, 1, True)
    with EmbeddedSimulator(machine) as simulator:
        motors = picture(simulator)["motors"]
    assert motors["2"] == "it is open-loop"
    assert motors["3"] == "its amplifier reports a fault"


def test_looking_changes_nothing(job, simulator, running):
    """`yarc status` changes nothing, neither during a run nor in its open rotary."""
    done = call("status", *to(simulator), "--format", "json")
    assert f"`yarc status --run industrial6-{os.getpid()}`" in done.stderr
    now = json.loads(done.stdout)
    assert now["program"] == "one runs"
    assert now["guard"] == 1.0
    assert now["motors"]["1"] == "closed-loop, homed, moves"
    call("hold")
    now = wait_for(lambda: (seen := picture(simulator))["motors"]["1"].endswith("at rest") and seen)
    assert now["program"].startswith("one is unfinished: held, or waiting for lines")
    assert now["motors"]["1"] == "closed-loop, homed, at rest"
    assert ": move" in call("resume").stdout
    assert running.session.operation.state is State.MOVE


def test_a_rotary_that_was_left_open(job, simulator):
    """A killed run leaves its rotary open, and the next client may get the same port."""
    with Running(job, simulator.port, heard_of=False) as run:
        run.kill()
        run.wait()
        now = picture(simulator)
    assert now["program"] == "one runs"
    assert all(joint["actual"] is not None for joint in now["joints"])


@pytest.mark.parametrize("abort", [[], ["--abort"]])
def test_what_a_killed_run_has_left_is_ended(job, simulator, abort):
    with Running(job, simulator.port) as run:
        wait_for(lambda: picture(simulator)["joints"][0]["commanded"] > 0.05)
        run.kill()
        run.wait()
    done = call("stop", *to(simulator), *abort)
    assert done.stdout.startswith(
        f"no program runs on tcp://127.0.0.1:{simulator.port}; INDUSTRIAL6 is at J1 "
    )
    stands = places(done.stdout)
    assert len(stands) == 6
    assert 0.0 < stands[0] < 30.0
    now = picture(simulator)
    assert now["program"] == "none runs in coordinate system 1"
    assert set(now["motors"].values()) == {"closed-loop, homed, at rest"}
    assert [joint["commanded"] for joint in now["joints"]] == pytest.approx(stands, abs=2e-3)
    assert (now["override"], now["guard"]) == (100.0, 0.0)
    assert complaints(job, simulator) == ()


def test_the_run_behind_one_that_was_stopped_is_not_refused(job, simulator, running):
    call("stop")
    running.wait()
    assert complaints(job, simulator) == ()


@pytest.mark.parametrize("abort", [[], ["--abort"]])
def test_a_run_of_this_computer_is_told_first(job, simulator, running, abort, monkeypatch):
    monkeypatch.setattr(stop, "_TELL", 10.0)  # on a computer with much to do
    monkeypatch.setattr(stop, "_LET_END", 20.0)
    done = call("stop", *to(simulator), *abort)
    assert f"industrial6-{os.getpid()} drives this controller, and was asked to end" in done.stderr
    ended = running.wait()
    assert ended.what == ("aborted: off its path" if abort else "stopped on its path")
    assert places(done.stdout) == pytest.approx(list(ended.joints / job.robot.axis_units), abs=1e-3)


def test_a_process_without_a_socket_is_named(job, simulator):
    """A run without a socket, such as another user's, is named.

    The controller itself can still be asked and stopped.
    """
    with Running(job, simulator.port, heard_of=False) as run:
        told = f"process {os.getpid()} (user "
        assert f"{told}" in call("status", *to(simulator)).stderr
        assert run.session.operation.state is State.MOVE
        done = call("stop", *to(simulator))
        assert re.search(rf"{re.escape(told)}.*\) drives this controller and can't be reached: ", done.stderr)
        run.kill()
        run.wait()


@pytest.mark.parametrize("abort", [[], ["--abort"]])
def test_nothing_to_end_is_fine(job, simulator, abort):
    home = list(job.robot.home / job.robot.axis_units)
    assert places(call("stop", *to(simulator), *abort).stdout) == pytest.approx(home, abs=1e-3)
    assert complaints(job, simulator) == ()


@pytest.mark.parametrize("command", ["stop", "status"])
def test_nobody_at_the_address(command, simulator):
    arguments = to(simulator)
    simulator.__exit__(None, None, None)
    done = call(command, *arguments, status=1)
    assert f"error: 127.0.0.1:{simulator.port} can't be reached" in done.stderr
    assert "Traceback" not in done.stderr


def test_somebody_else_at_the_address(simulator):
    async def serve(reader, writer):
        await reader.read(100)
        writer.write(b"HTTP/1.1 400 Bad Request\r\n\r\n")
        await reader.read()
        writer.close()

    ready, ports, loops = threading.Event(), [], []

    async def main():
        async with await asyncio.start_server(serve, "127.0.0.1", 0) as server:
            ports.append(server.sockets[0].getsockname()[1])
            loops.append((asyncio.get_running_loop(), asyncio.Event()))
            ready.set()
            await loops[0][1].wait()

    thread = threading.Thread(target=lambda: asyncio.run(main()))
    thread.start()
    ready.wait(10)
    try:
        done = call("status", "--to", f"tcp://127.0.0.1:{ports[0]}", "--robot", "INDUSTRIAL6", status=1)
    finally:
        loops[0][0].call_soon_threadsafe(loops[0][1].set)
        thread.join(10)
    assert "doesn't answer like a PMAC" in done.stderr


def test_a_robot_that_there_is_not():
    for command in ("stop", "status"):
        assert "Y1301" in call(command, "--to", "tcp://127.0.0.1:1", "--robot", "NOPE", status=1).stderr


# addresses of controllers


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("tcp://192.168.0.200", Address("192.168.0.200", PORT)),
        ("tcp://192.168.0.200:1026", Address("192.168.0.200", 1026)),
        ("tcp://robot-1.lab.example/", Address("robot-1.lab.example", PORT)),
        ("tcp://localhost.:1", Address("localhost.", 1)),
        (" tcp://[::1]:65535 ", Address("::1", 65535)),
        ("tcp://[fe80::1%eth0]", Address("fe80::1%eth0", PORT)),
        (SIM, None),
        ("SIM", None),
        (Address("a", 1), Address("a", 1)),
    ],
)
def test_addresses(text, expected):
    address = AddressType().convert(text, None, None)
    assert address == expected
    if address is not None:
        assert AddressType().convert(str(address), None, None) == address


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "is tcp:// missing?"),
        ("192.168.0.200:1025", "is tcp:// missing?"),
        ("udp://a", "only tcp:// addresses"),
        ("TCP://a", "only tcp:// addresses"),
        ("tcp://", "isn't a valid host name"),
        ("tcp://:1025", "isn't a valid host name"),
        ("tcp://a:", "from 1 to 65535"),
        ("tcp://a:0", "from 1 to 65535"),
        ("tcp://a:65536", "from 1 to 65535"),
        ("tcp://a:9" + "9" * 5000, "from 1 to 65535"),
        ("tcp://a:-1", "from 1 to 65535"),
        ("tcp://a:٣", "from 1 to 65535"),
        ("tcp://a:pmac", "from 1 to 65535"),
        ("tcp://::1", "in [ ]"),
        ("tcp://[::1", "isn't tcp://HOST[:PORT]"),
        ("tcp://[host]", "isn't a valid host name"),
        ("tcp://a b", "isn't tcp://HOST[:PORT]"),
        ("tcp://-a", "isn't a valid host name"),
        ("tcp://a..b", "isn't a valid host name"),
        ("tcp://" + "a" * 64, "isn't a valid host name"),
        ("tcp://" + "a." * 130, "isn't a valid host name"),
        ("tcp://user@a", "isn't tcp://HOST[:PORT]"),
        ("tcp://a/path", "isn't tcp://HOST[:PORT]"),
    ],
)
def test_what_is_no_address(text, said):
    with pytest.raises(click.BadParameter) as found:
        AddressType().convert(text, None, None)
    assert said in found.value.message


def test_a_simulator_where_there_is_none():
    with pytest.raises(click.BadParameter, match="`sim` can't be used here"):
        AddressType(sim=False).convert(SIM, None, None)
