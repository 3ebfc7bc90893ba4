"""Tests of the TCP port for values: it accepts only callers with the token, and only values. No caller can
delay others.
"""

import asyncio
import contextlib
import json
import threading
import time
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from yarclang.client import Gone, Refused, Robot
from yarclang.coordinator.coordinator import Coordinator
from yarclang.coordinator.engine import NO_LOG
from yarclang.coordinator.live.serving import Patience, TcpDoor
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.values_door import ValuesDoor
from yarclang.runtime.notices import Fill, Wanted
from yarclang.runtime.state import State

WANTED = Wanted(1, "P0020 WAIT", (("SEEN", 0, 2), ("X", -100, 100)), ("SEEN", "X"))


class Opened:
    """A door of a coordinator whose program pretends to wait for values, in a thread of its own. Each
    accepted message opens the next question.
    """

    def __init__(self, robot):
        self.worst = 0.0
        self.taken = []
        self._robot = robot
        self._ready = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._main()))

    def __enter__(self):
        self._thread.start()
        assert self._ready.wait(10)
        return self

    def __exit__(self, *_):
        self._loop.call_soon_threadsafe(self._end.set)
        self._thread.join(10)
        assert not self._thread.is_alive()

    async def _main(self):
        self._loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        session = self._session = OrderedSession("127.0.0.1", 1025)
        self.coordinator = Coordinator(self._robot, session, folder=Path(), log=NO_LOG)
        self.coordinator.engine.under_way = "a.yarc"
        self.operation = session.operation
        self.operation.state = State.HOLD
        self.operation.want(WANTED)
        async with ValuesDoor(self.coordinator, TcpDoor(), patience=Patience(first=0.5)) as door:
            self.port, self.token = door.port, door.door.token
            ticking = asyncio.create_task(self._tick())
            self._ready.set()
            await self._end.wait()
            ticking.cancel()

    async def _tick(self):
        while True:
            begun = time.monotonic()
            await asyncio.sleep(0.001)
            self.worst = max(self.worst, time.monotonic() - begun)
            while self.operation.orders:
                order = self.operation.orders.popleft()
                self.taken.append(order)
                self.operation.asked_for += 1
                number = WANTED.number + self.operation.asked_for
                self.operation.want(Wanted(number, WANTED.place, WANTED.registers, WANTED.needed))
            self._session._tell()  # a session does this between two steps of its work

    @property
    def url(self):
        return f"tcp://127.0.0.1:{self.port}"

    def camera(self, **options):
        return Robot(self.url, **{"name": "camera", "token": self.token, **options})


@pytest.fixture
def opened(industrial6):
    with Opened(industrial6) as door:
        yield door


def test_a_camera_gives_values(opened):
    with opened.camera() as camera:
        wanted = camera.wanted(5.0)
        assert (wanted["number"], wanted["needed"]) == (1, ["SEEN", "X"])
        assert camera.fill({"seen": 1, "X": 12}, wanted["number"])["values"] == {"SEEN": 1, "X": 12}
        with pytest.raises(Refused, match=r"question 1 isn't open any more|no WAIT or HOLD") as refused:
            camera.fill({"seen": 1, "X": 12}, wanted["number"])
        assert refused.value.code == "Y1661"
        assert camera.wanted(5.0)["number"] == 2
        with pytest.raises(Refused, match="X can't be 101: it is an integer from -100 to 100"):
            camera.fill({"SEEN": 1, "X": 101})
    assert opened.taken == [Fill((("SEEN", 1), ("X", 12)), "camera")]


def test_it_takes_nothing_but_values(opened):
    with opened.camera() as camera:
        for order in ("own", "stop", "abort", "hold", "resume", "go", "load", "run", "set", "adopt", "give"):
            with pytest.raises(Refused) as refused:
                camera.ask(order, **({"offer": 1} if order == "go" else {}))
            assert refused.value.error
        with pytest.raises(
            Refused, match="own isn't accepted at this port, which accepts hello, status, listen and fill"
        ):
            camera.ask("own")
        with pytest.raises(Refused, match="isn't accepted at this port"):
            camera.want(velocity={"J1": 5})
        assert camera.status()["owner"] is None
    assert opened.taken == []
    assert opened.operation.state is State.HOLD


@pytest.mark.parametrize("token", ["", "wrong", "\udcff", "x" * 10_000])
def test_without_the_token_nothing_is_taken(opened, token):
    with pytest.raises((Refused, Gone), match=r"token is wrong|has ended"):
        Robot(opened.url, token=token)
    assert opened.taken == []


def talk(opened, *lines, patience=3.0):
    """Send lines. Return all replies until the door closes the connection or sends nothing more."""

    async def spoken():
        reader, writer = await asyncio.open_connection("127.0.0.1", opened.port)
        for line in lines:
            writer.write(line)
        with contextlib.suppress(OSError):  # the connection is closed already
            writer.write_eof()
        answers = b""
        with contextlib.suppress(ConnectionError, TimeoutError):
            async with asyncio.timeout(patience):
                answers = await reader.read()
        writer.close()
        return [json.loads(one) for one in answers.splitlines()]

    return asyncio.run(spoken())


def test_callers_that_speak_something_else_are_sent_away(opened):
    token = json.dumps({"token": opened.token}).encode() + b"\n"
    fill = b'{"order": "fill", "values": {"SEEN": 1, "X": 1}}\n'
    # If a connection is closed with unread bytes, it may be reset before the client reads the reply.
    assert not any(one["ok"] for one in talk(opened, b"GET / HTTP/1.1\r\n", b"\r\n"))
    assert talk(opened, b'{"order": "status"}\n')[0]["ok"] is False
    assert talk(opened, b"\xff\xfe\n")[0]["ok"] is False
    assert not any(one["ok"] for one in talk(opened, b"[" * 100_000 + b"\n"))
    assert not any(one["ok"] for one in talk(opened, b'{"token": 3}\n', fill))
    (nothing,) = talk(opened, token[:-1]) or [None]
    assert nothing is None  # no reply to an incomplete line
    said = talk(opened, token, fill)
    assert [one["ok"] for one in said] == [True, False]
    assert "introduce the client first" in said[1]["error"]
    hello = b'{"order": "hello", "version": 1, "name": "eye"}\n'
    said = talk(opened, token, hello, b"POST / HTTP/1.1\r\n", fill)
    assert [one["ok"] for one in said] == [True, True, False]
    said = talk(opened, token, hello, b'{"order": "fill", "values": 3}\n', b'{"order": "fill"}\n', fill[:-1])
    assert [one["ok"] for one in said] == [True, True, False, False, False]
    assert opened.taken == []
    assert opened.worst < 0.5


def test_silent_callers_cost_a_place_for_a_while(opened):
    async def crowd():
        wires = [await asyncio.open_connection("127.0.0.1", opened.port) for _ in range(30)]
        await asyncio.sleep(0.1)
        with_token = await asyncio.to_thread(opened.camera)
        with_token.fill({"SEEN": 1, "X": 1})
        with_token.close()
        await asyncio.sleep(1.0)
        ends = [await asyncio.wait_for(reader.read(), 3.0) for reader, _ in wires]
        for _, writer in wires:
            writer.close()
        return ends

    ends = asyncio.run(crowd())
    assert len(ends) == 30
    assert sum(b"no line was received for 0.5 s" in one for one in ends) >= 6
    assert len(opened.taken) == 1


def test_more_than_a_few_with_the_token_are_sent_away(opened):
    cameras = [opened.camera() for _ in range(8)]
    with pytest.raises(Refused, match="8 connections send values already"):
        opened.camera()
    cameras[0].close()
    time.sleep(0.2)
    with opened.camera() as another:
        another.fill({"SEEN": 0, "X": 0})
    for one in cameras[1:]:
        one.close()


def test_one_that_does_not_read_is_sent_away_and_keeps_nobody_waiting(opened):
    token = json.dumps({"token": opened.token}).encode() + b"\n"
    hello = b'{"order": "hello", "version": 1, "name": "deaf"}\n'

    async def deaf():
        _, writer = await asyncio.open_connection("127.0.0.1", opened.port)
        writer.write(token + hello)
        with contextlib.suppress(ConnectionError, TimeoutError):
            async with asyncio.timeout(5.0):
                for _ in range(200):
                    writer.write(b'{"order": "status"}\n' * 500)
                    await writer.drain()
        writer.close()

    asyncio.run(deaf())
    with opened.camera() as camera:
        camera.fill({"SEEN": 1, "X": 1})
    assert opened.worst < 1.0


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.binary(max_size=60), max_size=4), st.booleans())
def test_any_bytes(opened, pieces, with_token):
    before = len(opened.taken)
    token = json.dumps({"token": opened.token}).encode() + b"\n"
    said = talk(opened, *([token] if with_token else []), *pieces)
    assert all(one["ok"] is False for one in said[with_token:])
    assert len(opened.taken) == before
