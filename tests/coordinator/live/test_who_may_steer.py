"""Tests of the right to steer a robot from another process: all kinds of forged callers, and a fake robot
that only records what it gets.
"""

import asyncio
import contextlib
import json
import os
import socket
import stat
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

from yarclang.coordinator.live import serving
from yarclang.coordinator.live.serving import MOST_LINE, MasterServer, Patience, TcpDoor, UnixDoor
from yarclang.coordinator.messages.orders import Leave
from yarclang.coordinator.messages.replies import Done, Wanted
from yarclang.coordinator.messages.wants import Finish, Want
from yarclang.runtime.actions import Trouble

QUICK = Patience(first=0.4, silence=0.6)
ORDER = b'{"velocity": {"J1": 10}}\n'


class Robot:
    """Fake client for a server that records all targets.

    Attributes:
        drives: targets of each motion that was begun.
        alive: True while the last motion goes on.
    """

    def __init__(self):
        self.drives = []
        self.alive = False

    async def ask(self, order):
        if isinstance(order, Want) and not isinstance(order, Finish):
            if not self.alive:
                self.drives.append(0)
                self.alive = True
            self.drives[-1] += 1
        return Wanted(lag_s=0.35, behind=None, why="") if isinstance(order, Want) else Done()

    def send(self, order, refused=None):
        assert isinstance(order, Leave)
        self.alive = False


class Fellow:
    """A caller that can send any bytes."""

    def __init__(self, reader, writer):
        self.reader, self.writer = reader, writer

    async def say(self, data):
        self.writer.write(data)
        with contextlib.suppress(ConnectionError):
            await self.writer.drain()

    async def hear(self):
        async with asyncio.timeout(10):
            return json.loads(await self.reader.readline())

    async def hears_the_end(self):
        """Return True if the connection is closed without further data."""
        async with asyncio.timeout(10):
            try:
                return await self.reader.read() == b""
            except ConnectionError:
                return True

    async def ask(self, data):
        await self.say(data)
        return await self.hear()

    def close(self):
        self.writer.close()


async def called(server):
    if server.path is not None:
        return Fellow(*await asyncio.open_unix_connection(str(server.path)))
    return Fellow(*await asyncio.open_connection("127.0.0.1", server.port))


async def let_in(server):
    """Return a caller that has proved its right to steer."""
    fellow = await called(server)
    if server.path is None:
        assert await fellow.ask(token(server)) == {"ok": True}
    return fellow


def token(server):
    return json.dumps({"token": server.door.token}).encode() + b"\n"


def meeting(work, door, patience=QUICK):
    """Run a test with a server that listens at a door. Return the fake robot, and the longest time for which
    the event loop was busy [s].
    """

    async def whole():
        robot, worst = Robot(), 0.0

        async def tick():
            nonlocal worst
            while True:
                begun = time.monotonic()
                await asyncio.sleep(0.001)
                worst = max(worst, time.monotonic() - begun)

        async with MasterServer(robot, door, patience=patience) as server:
            ticking = asyncio.create_task(tick())
            await asyncio.wait_for(work(server), 60)
            ticking.cancel()
        return robot, worst

    return asyncio.run(whole())


both = pytest.mark.parametrize("door", [UnixDoor(), TcpDoor()], ids=["unix", "tcp"])


def test_a_token_is_long_and_never_the_same():
    tokens = {TcpDoor().token for _ in range(100)}
    assert len(tokens) == 100
    assert min(map(len, tokens)) >= 43  # 256 bits, with 6 bits for each character
    assert TcpDoor().token not in repr(TcpDoor())


def test_only_who_says_the_token_steers():
    async def work(server):
        other = TcpDoor().token
        for line in (
            ORDER,
            b"{}\n",
            b'{"token": ""}\n',
            b'{"token": null}\n',
            b'{"token": ["' + server.door.token.encode() + b'"]}\n',
            json.dumps({"token": other}).encode() + b"\n",
            json.dumps({"token": server.door.token[:-1]}).encode() + b"\n",
            json.dumps({"token": server.door.token + " "}).encode() + b"\n",
            b'{"token": "\\ud800\xc3\xa9"}\n',
            json.dumps({"token": server.door.token, "velocity": {"J1": 10}}).encode() + b"\n",
        ):
            fellow = await called(server)
            answer = await fellow.ask(line + ORDER)
            assert answer["ok"] is False
            assert "token" in answer["error"]
            assert server.door.token not in answer["error"]
            assert await fellow.hears_the_end()
        fellow = await let_in(server)
        assert (await fellow.ask(ORDER))["ok"] is True

    robot, _ = meeting(work, TcpDoor())
    assert len(robot.drives) == 1


def test_a_unix_socket_is_for_its_owner_alone():
    async def work(server):
        found = server.path.lstat()
        assert stat.S_ISSOCK(found.st_mode)
        assert stat.S_IMODE(found.st_mode) == 0o600
        assert stat.S_IMODE(server.path.parent.lstat().st_mode) == 0o700
        fellow = await called(server)
        assert (await fellow.ask(ORDER))["ok"] is True
        work.path = server.path

    meeting(work, UnixDoor())
    assert not work.path.exists()


def test_the_kernel_is_asked_for_the_callers_user(monkeypatch):
    """A caller of another user is refused even if it can open the socket's file, for example because of wrong
    permissions.
    """

    async def work(server):
        monkeypatch.setattr(os, "getuid", lambda: 4711)
        monkeypatch.setattr(serving, "peer_of", lambda _: type(peer)(peer.pid, 4712))
        fellow = await called(server)
        assert "other users" in (await fellow.ask(ORDER))["error"]
        assert await fellow.hears_the_end()

    one, other = socket.socketpair()
    peer = serving.peer_of(one)
    assert (peer.pid, peer.uid) == (os.getpid(), os.getuid())
    one.close()
    other.close()
    robot, _ = meeting(work, UnixDoor())
    assert robot.drives == []


@pytest.mark.skipif(os.getuid() != 0, reason="only root can start a process of another user")
def test_another_user_is_refused_even_where_the_file_lets_it_in():
    code = (
        "import contextlib, os, socket, sys\n"
        "os.setuid(65534)\n"
        "wire = socket.socket(socket.AF_UNIX)\n"
        "wire.connect(sys.argv[1])\n"
        "with contextlib.suppress(ConnectionError):\n"
        '  wire.sendall(b\'{"velocity": {"J1": 10}}\\n\')\n'
        "print(wire.recv(1000).decode())\n"
    )

    async def work(server):
        def tries():
            command = [sys.executable, "-c", code, str(server.path)]
            return subprocess.run(command, capture_output=True, text=True, check=False)

        assert "Permission" in (await asyncio.to_thread(tries)).stderr
        server.path.chmod(0o666)
        folder.chmod(0o755)
        assert "other users" in (await asyncio.to_thread(tries)).stdout

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        robot, _ = meeting(work, UnixDoor(folder / "s"))
    assert robot.drives == []


REQUESTS = [
    b"POST / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\nContent-Type: text/plain\r\nContent-Length: 60\r\nA: b\r\nC: d\r\nE: f\r\nG: h\r\nI: j\r\n\r\n",  # noqa: E501
    b"GET / HTTP/1.1\r\nUpgrade: websocket\r\n\r\n",
    b"OPTIONS /a HTTP/1.0\r\n\r\n",
    b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
]


@both
@pytest.mark.parametrize("request_", REQUESTS)
def test_a_web_page_moves_nothing(door, request_):
    """A web page that sends ten lines that aren't JSON, and then an order, moves nothing."""

    async def work(server):
        fellow = await called(server)
        first = token(server) if server.path is None else b""
        answer = await fellow.ask(request_ + first + ORDER * 50)
        assert answer == {"ok": False, "error": "this isn't a web server: a web page can't steer a robot"}
        assert await fellow.hears_the_end()

    robot, _ = meeting(work, door)
    assert robot.drives == []


@both
@pytest.mark.parametrize(
    "line", [b"nonsense\n", b"[1]\n", b"\n", b"\x00\xff\n", b"\x16\x03\x01\n", b'{"velocity":\n', b"null\n"]
)
def test_the_first_line_that_is_no_object_ends_it(door, line):
    async def work(server):
        fellow = await called(server)
        assert (await fellow.ask(line + ORDER))["ok"] is False
        assert await fellow.hears_the_end()
        # such a line also ends the connection if it comes after an accepted order
        fellow = await let_in(server)
        assert (await fellow.ask(ORDER))["ok"] is True
        assert (await fellow.ask(line + ORDER))["ok"] is False
        assert await fellow.hears_the_end()

    robot, _ = meeting(work, door)
    assert len(robot.drives) == 1
    assert robot.drives[0] == 1
    assert not robot.alive


@both
def test_an_object_that_is_wrong_ends_nothing(door):
    async def work(server):
        fellow = await let_in(server)
        for line in (
            b"{}\n",
            b'{"velocity": {"J9": "1"}}\n',
            b'{"joints": 1}\n',
            b'{"token": "x"}\n',
            b'{"order": "own"}\n',
        ):
            assert (await fellow.ask(line))["ok"] is False
        assert (await fellow.ask(ORDER))["ok"] is True

    meeting(work, door)


@both
@pytest.mark.parametrize("end", [b"\n", b""])
def test_a_line_too_long_ends_it(door, end):
    async def work(server):
        for fellow in (await called(server), await let_in(server)):
            answer = await fellow.ask(b'{"velocity": "' + b"x" * (20 * MOST_LINE) + b'"}' + end)
            assert answer == {"ok": False, "error": "a line is longer than 16 KiB"}
            assert await fellow.hears_the_end()

    robot, worst = meeting(work, door)
    assert robot.drives == []
    assert worst < 1.0


@both
def test_half_a_line_is_no_order(door):
    async def work(server):
        fellow = await let_in(server)
        await fellow.say(ORDER[:-1])
        fellow.writer.write_eof()
        assert await fellow.hears_the_end()

    robot, _ = meeting(work, door)
    assert robot.drives == []


@both
def test_who_says_nothing_is_sent_away(door):
    async def work(server):
        mute, silent = await called(server), await let_in(server)
        since = time.monotonic()
        assert (await mute.hear())["error"] == "no line was received for 0.4 s"
        assert await mute.hears_the_end()
        assert time.monotonic() - since < 5.0
        if server.path is None:
            assert (await silent.hear())["error"] == "no line was received for 0.6 s"
        assert (await (await let_in(server)).ask(ORDER))["ok"] is True
        silent.close()

    meeting(work, door)


@both
def test_a_byte_at_a_time_wins_no_time(door):
    async def work(server):
        fellow = await called(server)
        since = time.monotonic()
        with contextlib.suppress(ConnectionError):
            for number in range(200):
                fellow.writer.write(ORDER[number % 20 : number % 20 + 1])
                await fellow.writer.drain()
                with contextlib.suppress(TimeoutError):
                    async with asyncio.timeout(0.02):
                        assert b"no line was received" in await fellow.reader.readline()
                    break
        assert time.monotonic() - since < 3.0

    robot, _ = meeting(work, door)
    assert robot.drives == []


@both
def test_one_that_steers_is_sent_away_when_it_falls_silent(door):
    async def work(server):
        first = await let_in(server)
        assert (await first.ask(ORDER))["ok"] is True
        second = await called(server)
        if server.path is None:
            await second.say(token(server))
        assert (await second.hear())["error"] == "another process already steers the robot"
        assert await second.hears_the_end()
        assert (await first.hear())["error"] == "no line was received for 0.6 s"
        assert (await (await let_in(server)).ask(ORDER))["ok"] is True

    robot, _ = meeting(work, door)
    assert len(robot.drives) == 2
    assert not robot.alive


def test_who_has_not_said_the_token_takes_nobodys_place():
    async def work(server):
        idle = [await called(server) for _ in range(5)]
        assert (await (await let_in(server)).ask(ORDER))["ok"] is True
        for one in idle:
            one.close()

    robot, _ = meeting(work, TcpDoor(), Patience())
    assert len(robot.drives) == 1


@both
def test_a_hundred_connections_cost_little(door):
    """A hundred connections that send nothing need few resources. The oldest of them are closed, so that a
    new caller that proves its right at once is served.
    """

    async def work(server):
        many = [await called(server) for _ in range(100)]
        await asyncio.sleep(0.1)
        assert len(server._waiting) <= server._patience.waiting
        steering = await let_in(server)
        assert (await steering.ask(ORDER))["ok"] is True
        assert (await many[0].hear())["error"] == "too many processes are waiting to steer the robot"
        more = [await called(server) for _ in range(100)]
        assert (await steering.ask(ORDER))["ok"] is True
        if server.path is not None:
            assert (await more[0].hear())["error"] == "another process already steers the robot"
        for one in (*many, *more):
            one.close()

    _, worst = meeting(work, door, Patience())
    assert worst < 1.0


@both
def test_lines_without_end_leave_the_event_loop_alone(door):
    """Endless lines don't block the event loop, which also streams to the controller."""

    async def work(server):
        fellow = await let_in(server)
        since = time.monotonic()
        while time.monotonic() - since < 1.0:
            fellow.writer.write(ORDER * 500)
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(fellow.writer.drain(), 0.1)
        fellow.close()

    _, worst = meeting(work, door)
    assert worst < 0.5


@both
def test_who_does_not_read_is_closed_all_the_same(door):
    async def work(server):
        fellow = await let_in(server)
        fellow.reader._limit = 1
        fellow.writer.transport.pause_reading()
        for _ in range(40):
            fellow.writer.write(b'{"x": 1}\n' * 2000)
            with contextlib.suppress(TimeoutError):
                await asyncio.wait_for(fellow.writer.drain(), 0.1)
        await fellow.say(b"nonsense\n")
        while server._steers is not None or server._tasks:
            await asyncio.sleep(0.05)

    meeting(work, door)


def lasting(path):
    """Return the attributes of a path that reading doesn't change. (Following a link counts as an access to
    it.)
    """
    found = path.lstat()
    return found.st_ino, found.st_mode, found.st_uid, found.st_size, found.st_mtime_ns, found.st_ctime_ns


@pytest.mark.parametrize("what", ["file", "folder", "link", "listener", "missing"])
def test_a_path_that_is_something_else_is_left_as_it_is(what):
    with tempfile.TemporaryDirectory() as name, contextlib.ExitStack() as stack:
        path = Path(name) / "here"
        match what:
            case "file":
                path.write_text("mine")
            case "folder":
                path.mkdir()
            case "link":
                (Path(name) / "mine").write_text("mine")
                path.symlink_to("mine")
            case "listener":
                wire = stack.enter_context(socket.socket(socket.AF_UNIX))
                wire.bind(str(path))
                wire.listen()
            case "missing":
                path = path / "below"
        before = lasting(path) if what != "missing" else None
        with pytest.raises(Trouble, match=r"listen"):
            meeting(None, UnixDoor(path))
        assert before is None or lasting(path) == before


def test_the_socket_of_a_dead_process_is_replaced():
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "here"
        with socket.socket(socket.AF_UNIX) as wire:
            wire.bind(str(path))

        async def work(server):
            assert (await (await called(server)).ask(ORDER))["ok"] is True

        meeting(work, UnixDoor(path))
        assert not path.exists()


def test_the_socket_of_somebody_who_came_later_is_left():
    with tempfile.TemporaryDirectory() as name:
        path = Path(name) / "here"

        async def work(server):
            path.unlink()
            path.write_text("mine")

        meeting(work, UnixDoor(path))
        assert path.read_text() == "mine"
