"""Tests of the coordinator's socket, by which other terminals on this computer reach a run, and of its
folder.
"""

import asyncio
import contextlib
import json
import os
import shutil
import socket
import tempfile
import threading
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from yarclang.cli.ordering import GoneError, order, send, status_of
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.lines import MOST_LINE, write_order
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.serving import ControlSocket
from yarclang.runtime.notices import Abort, Hold, Override, Resume, Stop
from yarclang.runtime.state import State
from yarclang.runtime.transports.lock import controller_lock
from yarclang.runtime.transports.private import ControlError, folder
from yarclang.runtime.transports.runs import find_runs, run_on, the_run

STATUS = write_order(orders.AskStatus())
DEAD = 2**22 + 1
"""A process number above the kernel's largest one."""


@pytest.fixture(autouse=True)
def home(monkeypatch):
    """Use a runtime folder with a short path, because a socket's path has at most 107 characters."""
    path = Path(tempfile.mkdtemp(prefix="yarc-test-"))
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(path))
    yield path
    shutil.rmtree(path)


class Ran:
    """A coordinator that pretends to move its robot, with its socket, in a thread of its own."""

    def __init__(self, robot):
        self.coordinator = None
        self.path = None
        self.worst = 0.0
        self._robot = robot
        self._ready = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._main()))

    def __enter__(self):
        self._thread.start()
        assert self._ready.wait(10)
        return self

    def __exit__(self, *_):
        self.end()

    def end(self):
        with contextlib.suppress(RuntimeError):  # the event loop has ended
            self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join(10)
        assert not self._thread.is_alive()

    @property
    def operation(self):
        return self.coordinator.engine.operation

    @property
    def orders(self):
        return list(self.operation.orders)

    async def _main(self):
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        self.coordinator = coordinator_of(self._robot)
        self.coordinator.own("test", shared=True)
        self.coordinator.engine.under_way = "a.yarc"
        self.operation.state = State.MOVE
        async with ControlSocket(self.coordinator) as control:
            self.path = control.path
            ticking = asyncio.create_task(self._tick())
            self._ready.set()
            await self._end.wait()
            ticking.cancel()

    async def _tick(self):
        """Measure the longest time for which the event loop is blocked."""
        while True:
            begun = time.monotonic()
            await asyncio.sleep(0.001)
            self.worst = max(self.worst, time.monotonic() - begun)


def coordinator_of(robot):
    """Return a coordinator that isn't started."""
    return Coordinator(robot, OrderedSession("127.0.0.1", 1025), folder=Path(), log=NO_LOG)


@pytest.fixture
def ran(industrial6):
    with Ran(industrial6) as run:
        yield run


class Fellow:
    """A client that can send any bytes."""

    def __init__(self, path):
        self.wire = socket.socket(socket.AF_UNIX)
        self.wire.settimeout(10)
        self.wire.connect(str(path))
        self.lines = self.wire.makefile("rb")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.lines.close()
        self.wire.close()

    def say(self, data):
        with contextlib.suppress(ConnectionError):
            self.wire.sendall(data)

    def hear(self):
        return json.loads(self.lines.readline())


# the folder


def mode(path):
    return path.lstat().st_mode & 0o777


def test_the_folder_is_made_for_its_owner_alone(home, monkeypatch):
    assert folder() == home / "yarc"
    assert mode(folder()) == 0o700
    assert folder() == home / "yarc"
    for nowhere in ("", "relative", str(home / "missing")):
        monkeypatch.setenv("XDG_RUNTIME_DIR", nowhere)
        monkeypatch.setattr(tempfile, "tempdir", str(home))
        assert folder() == home / f"yarc-{os.getuid()}"
        assert mode(folder()) == 0o700


@pytest.mark.parametrize("rights", [0o770, 0o707, 0o750, 0o701, 0o755])
def test_a_folder_that_others_may_enter_is_refused(home, rights):
    folder().chmod(rights)
    for ask in (folder, find_runs):
        with pytest.raises(ControlError, match="other users have access to") as found:
            ask()
        assert "chmod 700" in found.value.remedy


def test_the_folder_of_somebody_else_is_refused(home, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(home))
    monkeypatch.setattr(os, "getuid", lambda: os.geteuid() + 1)
    (home / f"yarc-{os.getuid()}").mkdir(0o700)
    with pytest.raises(ControlError, match="belongs to user"):
        folder()


def test_the_runtime_folder_of_somebody_else_is_not_ours(home, monkeypatch):
    """A runtime folder of another user isn't used: after `su`, XDG_RUNTIME_DIR may still name the previous
    user's folder.
    """
    assert folder() == home / "yarc"
    monkeypatch.setattr(tempfile, "tempdir", str(home))
    stat = Path.stat

    def other(path, *, follow_symlinks=True):
        found = stat(path, follow_symlinks=follow_symlinks)
        return os.stat_result((*found[:4], found.st_uid + 1, *found[5:])) if path == home else found

    monkeypatch.setattr(Path, "stat", other)
    assert folder() == home / f"yarc-{os.getuid()}"


def test_what_is_no_folder_is_refused(home):
    (home / "elsewhere").mkdir(0o700)
    (home / "yarc").symlink_to("elsewhere")
    with pytest.raises(ControlError, match="isn't a folder"):
        folder()
    (home / "yarc").unlink()
    (home / "yarc").write_text("")
    with pytest.raises(ControlError, match="isn't a folder"):
        folder()


def test_a_folder_that_cannot_be_made_is_one_error(home, monkeypatch):
    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(ControlError, match="can't be made: permission denied"):
        folder()


# the socket


def test_the_socket_is_its_owners_alone(ran, home):
    assert ran.path == home / "yarc" / f"industrial6-{os.getpid()}.sock"
    assert mode(ran.path) == 0o600


def test_the_socket_goes_with_the_run(industrial6):
    with Ran(industrial6) as run:
        path = run.path
        with Fellow(path) as fellow:
            fellow.say(STATUS)
            fellow.hear()
            run.end()
            assert fellow.lines.readline() == b""
    assert not path.exists()
    assert find_runs() == ()


def test_a_status(ran):
    with Fellow(ran.path) as fellow:
        fellow.say(STATUS)
        status = fellow.hear()
    assert status["ok"] is True
    assert status["program"] == "a.yarc"
    assert status["controller"] == "127.0.0.1:1025"
    assert status["pid"] == os.getpid()
    assert status["state"] == "move"
    assert len(status["joints"]) == 6
    assert status["since"][:2] == "20"


def test_orders_reach_the_session_in_order(ran):
    said = [orders.Hold(), orders.Resume(), orders.Override(percent=30.0), orders.Stop(), orders.Abort()]
    with Fellow(ran.path) as fellow:
        fellow.say(b"".join(map(write_order, said)))
        for _ in said:
            assert fellow.hear() == {"ok": True, "state": "move"}
    assert ran.orders == [Hold(), Resume(), Override(30.0), Stop(), Abort()]


def test_an_order_wakes_a_session_that_waits(ran):
    session = ran.coordinator.engine.session
    waited = asyncio.run_coroutine_threadsafe(session.pause(), ran._loop)
    with Fellow(ran.path) as fellow:
        ran.operation.state = State.STOP
        while not session.paused:
            time.sleep(0.01)
        fellow.say(b'{"order": "step"}\n')
        assert fellow.hear()["ok"]
    waited.result(5)


def test_an_order_that_cannot_be_is_denied(ran):
    with Fellow(ran.path) as fellow:
        fellow.say(write_order(orders.Resume()))
        assert fellow.hear() == {"ok": False, "error": "the robot isn't held: there is nothing to resume"}
    assert ran.orders == []


def test_two_clients_at_a_time(ran):
    with Fellow(ran.path) as one, Fellow(ran.path) as two:
        two.say(STATUS)
        one.say(b'{"order": "hold"}\n{"order"')
        assert two.hear()["program"] == "a.yarc"
        assert one.hear() == {"ok": True, "state": "move"}
        two.say(b'{"order": "stop"}\n')
        assert two.hear()["ok"]
        one.say(b': "abort"}\n')
        assert one.hear()["ok"]
    assert ran.orders == [Hold(), Stop(), Abort()]


def test_half_an_order_is_none(ran):
    """A line without an end isn't executed, since its sender may have died while writing it."""
    with Fellow(ran.path) as fellow:
        fellow.say(b'{"order": "stop"')
        fellow.wire.shutdown(socket.SHUT_WR)
        assert "an incomplete line" in fellow.hear()["error"]
        assert fellow.lines.readline() == b""
    assert ran.orders == []


@pytest.mark.parametrize("end", [b"\n", b""])
def test_a_line_too_long_ends_the_connection(ran, end):
    with Fellow(ran.path) as fellow:
        fellow.say(b"x" * (2 * MOST_LINE) + end)
        assert fellow.hear() == {"ok": False, "error": "a line is longer than 4 MiB"}
        with contextlib.suppress(ConnectionError):
            assert fellow.lines.readline() == b""
    with Fellow(ran.path) as fellow:
        fellow.say(STATUS)
        assert fellow.hear()["ok"]


@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.binary(min_size=1, max_size=100).filter(lambda one: b"\n" not in one))
def test_garbage_is_answered_once(ran, line):
    """A line that isn't a JSON object gets one reply, and ends the connection. Its sender uses another
    protocol, and later lines might look like orders.
    """
    with Fellow(ran.path) as fellow:
        fellow.say(line + b'\n{"order": "hold"}\n')
        assert fellow.hear()["ok"] is False
        with contextlib.suppress(ConnectionError):
            assert fellow.lines.readline() == b""
    assert ran.orders == []
    with Fellow(ran.path) as fellow:
        fellow.say(b"{}\n" + STATUS)
        assert fellow.hear()["ok"] is False
        assert fellow.hear()["program"] == "a.yarc"


def test_who_does_not_read_keeps_nobody(ran):
    with Fellow(ran.path) as deaf, Fellow(ran.path) as other:
        deaf.wire.setblocking(False)
        sent = 0
        until = time.monotonic() + 1.0
        while time.monotonic() < until:
            try:
                sent += deaf.wire.send(STATUS * 1000)
            except BlockingIOError:
                time.sleep(0.01)
            except ConnectionError:  # the server has disconnected this client
                break
        for _ in range(20):
            other.say(STATUS)
            assert other.hear()["ok"]
        # Asyncio reads ahead up to twice the longest line, and the kernel has a buffer as well.
        assert sent < 2 * MOST_LINE + (1 << 20)
        assert ran.worst < 1.0


def test_who_asks_without_end_keeps_nobody(ran):
    stop = threading.Event()

    def ask():
        with Fellow(ran.path) as fellow:
            while not stop.is_set():
                fellow.say(STATUS * 500)
                for _ in range(500):
                    fellow.hear()

    threads = [threading.Thread(target=ask) for _ in range(2)]
    for thread in threads:
        thread.start()
    with Fellow(ran.path) as other:
        ran.worst = 0.0
        for _ in range(50):
            other.say(b'{"order": "hold"}\n')
            assert other.hear()["ok"]
            time.sleep(0.01)
    worst = ran.worst
    stop.set()
    for thread in threads:
        thread.join(10)
    assert worst < 1.0


def test_a_second_socket_of_the_same_process_is_refused(ran, industrial6):
    async def second():
        async with ControlSocket(coordinator_of(industrial6)):
            pass

    with pytest.raises(ControlError, match=r"another process already listens on "):
        asyncio.run(second())
    assert status_of(the_run())["program"] == "a.yarc"


def test_a_path_that_is_too_long_is_one_error(home, monkeypatch, industrial6):
    long = home / ("x" * 100)
    long.mkdir()
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(long))

    async def listen():
        async with ControlSocket(coordinator_of(industrial6)):
            pass

    with pytest.raises(ControlError, match=r"can't be listened on: .*too long"):
        asyncio.run(listen())


# finding runs


def forgotten(name):
    """Create a socket's file like the one that a killed process leaves."""
    path = folder() / f"{name}.sock"
    with socket.socket(socket.AF_UNIX) as wire:
        wire.bind(str(path))
    return path


def test_sockets_of_dead_processes_are_removed(industrial6):
    dead, mine = forgotten(f"industrial6-{DEAD}"), forgotten(f"industrial6-{os.getpid()}")
    odd = forgotten("odd")
    assert find_runs() == ()
    assert not dead.exists()
    assert mine.exists()  # not removed: its process lives, and may begin to listen at any moment
    assert odd.exists()
    dead = forgotten(f"industrial6-{DEAD}")
    with Ran(industrial6) as run:
        assert not dead.exists()
        assert run.path == mine
        assert [each.pid for each in find_runs()] == [os.getpid()]


def test_no_run():
    with pytest.raises(ControlError, match=r"^no yarc run on this computer$"):
        the_run()


def test_the_only_run_is_taken(ran):
    assert the_run().path == ran.path
    for name in (f"industrial6-{os.getpid()}", "INDUSTRIAL6", str(os.getpid())):
        assert the_run(name).path == ran.path
    with pytest.raises(ControlError, match="there is no run 'scara'") as found:
        the_run("scara")
    assert "industrial6-" in found.value.remedy


def test_of_several_runs_one_must_be_named(ran, tracked):
    with Ran(tracked) as other:
        assert len(find_runs()) == 2
        with pytest.raises(
            ControlError, match=r"several runs: industrial6-.*, tracked_manipulator-"
        ) as found:
            the_run()
        assert found.value.remedy == "choose one with --run NAME"
        assert the_run("tracked_manipulator").path == other.path
        with pytest.raises(ControlError, match="several runs"):
            the_run(str(os.getpid()))


def test_send(ran):
    run = the_run()
    assert send(run, "hold")["state"] == "move"
    assert send(run, "status")["program"] == "a.yarc"
    assert status_of(run)["waiting"] == 1
    ran.operation.orders.clear()
    with pytest.raises(ControlError, match="nothing to resume"):
        send(run, "resume")


def test_a_run_that_hangs_is_said(home):
    path = folder() / f"industrial6-{os.getpid()}.sock"
    with socket.socket(socket.AF_UNIX) as wire:
        wire.bind(str(path))
        wire.listen(0)
        with pytest.raises(ControlError, match=r"doesn't answer within 0\.1 s") as found:
            send(the_run(), "hold", timeout=0.1)
        assert "yarc stop --to" in found.value.remedy
        for _ in range(5):  # now many callers wait to be accepted
            with pytest.raises(ControlError, match=r"doesn't answer within 0\.1 s"):
                send(the_run(), "hold", timeout=0.1)


def test_a_run_that_has_ended_is_said(industrial6):
    with Ran(industrial6):
        run = the_run()
    with pytest.raises(GoneError, match="has ended"):
        send(run, "hold")


def test_an_answer_that_is_none_is_said(home):
    path = folder() / f"industrial6-{os.getpid()}.sock"
    for answer in (b"hello\n", b"x" * 100_000 + b"\n", b'{"ok": 1}\n'):
        with socket.socket(socket.AF_UNIX) as wire:
            wire.bind(str(path))
            wire.listen()
            run = the_run()
            wire.accept()[0].close()  # this connection only checked if the process lives
            answering = threading.Thread(target=_answer, args=(wire, answer))
            answering.start()
            with pytest.raises(ControlError, match="understood"):
                send(run, "hold")
            answering.join(10)
        path.unlink()


def _answer(wire, answer):
    one, _ = wire.accept()
    with one, contextlib.suppress(ConnectionError):
        one.recv(1000)
        one.sendall(answer)


def test_an_order_is_waited_for(ran):
    def hold_later():
        time.sleep(0.2)
        ran.operation.orders.clear()
        ran.operation.state = State.HOLD

    threading.Thread(target=hold_later).start()
    begun = time.monotonic()
    assert order(the_run(), "hold", 5.0)["state"] == "hold"
    assert time.monotonic() - begun > 0.15


def test_an_order_that_is_not_done_is_said(ran):
    with pytest.raises(ControlError, match=r"after 0\.2 s its state is still move"):
        order(the_run(), "hold", 0.2)


def test_a_run_that_ends_meanwhile(industrial6):
    with Ran(industrial6) as run:
        chosen = the_run()
        ender = threading.Timer(0.2, run.end)
        ender.start()
        assert order(chosen, "stop", 5.0) is None
        ender.join()
    with pytest.raises(GoneError):
        order(chosen, "stop", 5.0)


def test_which_run_drives_a_controller(ran):
    assert run_on("127.0.0.1", 1025) is None
    with controller_lock("127.0.0.1", 1025):
        assert run_on("localhost", 1025).path == ran.path
        assert run_on("127.0.0.1", 1026) is None
    assert run_on("127.0.0.1", 1025) is None


def test_a_run_is_found_from_another_environment(industrial6, home, monkeypatch):
    """A run is found even if its terminal has another XDG_RUNTIME_DIR (a service, `su`, ssh without a
    session) than the terminal that shall stop it.
    """
    elsewhere = home / "elsewhere"
    elsewhere.mkdir(0o700)
    with contextlib.ExitStack() as stack:
        stack.enter_context(controller_lock("127.0.0.1", 1025))
        run = stack.enter_context(Ran(industrial6))
        monkeypatch.setenv("XDG_RUNTIME_DIR", str(elsewhere))
        assert folder() == elsewhere / "yarc"
        assert [one.path for one in find_runs()] == [run.path]
        assert the_run("industrial6").path == run.path
        assert run_on("127.0.0.1", 1025).path == run.path
        assert send(the_run(), "hold")["state"] == "move"
        run.path.parent.chmod(0o755)
        assert find_runs() == ()
        assert run_on("127.0.0.1", 1025) is None
        run.path.parent.chmod(0o700)
    assert find_runs() == ()
