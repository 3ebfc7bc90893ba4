"""The server on a real socket of the loopback interface: clients, time and faults."""

import asyncio
import os
import re
import signal
import socket
import subprocess
import sys
import time
from typing import get_args

import pytest
from click.testing import CliRunner

from tests.simulator.echo import Echo
from tests.simulator.serving import Client, served
from yarclang.cli.yarc import main as yarc
from yarclang.runtime.actions import Closed, Late, Violation
from yarclang.runtime.pmac.protocol import (
    Answer,
    Ask,
    Busy,
    IsReady,
    Ready,
    Send,
    Taken,
    Write,
    Written,
    encode,
)
from yarclang.simulator.faults import Kind, parse_fault
from yarclang.simulator.network.server import SimulatorServer

ASK = Ask("P1")


def answered(data: bytes, port: int, wanted: int) -> bytes:
    """Return the answer to raw bytes."""
    with socket.create_connection(("127.0.0.1", port), timeout=5) as raw:
        raw.sendall(data)
        back = b""
        while len(back) < wanted and (part := raw.recv(65536)):
            back += part
        return back


def test_questions_and_long_replies():
    with served(Echo()) as port, Client(port) as client:
        assert client.ask(ASK) == Answer(ASK, ("P1",))
        assert client.ask(Ask("ERR3")) == Answer(Ask("ERR3"), ("before",), 3)
        assert len(client.ask(Ask("LONG5000")).items) == 5000
        lines = tuple(f"X{number}" for number in range(200))
        assert client.ask(Write(lines)) == Written(Write(lines))
        assert client.ask(ASK) == Answer(ASK, ("P1",))


def test_listens_on_loopback_only_unless_told():
    async def address():
        async with SimulatorServer(Echo(), port=0) as server:
            return server._server.sockets[0].getsockname()[0]

    assert asyncio.run(address()) == "127.0.0.1"


def test_packets_in_one_piece_and_byte_by_byte():
    data = encode(ASK) + encode(IsReady()) + encode(Write(("X1", "ERR6")))
    reply = b"P1\r\x06" + b"\0\0" + b"\x02\0\x06\x80"
    with served(Echo()) as port:
        assert answered(data, port, len(reply)) == reply
        with socket.create_connection(("127.0.0.1", port), timeout=5) as raw:
            raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            for at in range(len(data)):
                raw.sendall(data[at : at + 1])
                time.sleep(0.0002)
            back = b""
            while len(back) < len(reply):
                back += raw.recv(100)
        assert back == reply


def test_two_clients_have_a_port_each_and_a_third_is_sent_away():
    machine = Echo()
    with served(machine) as port, Client(port) as one, Client(port) as two:
        assert one.ask(Send("A")) == Taken(Send("A"))
        assert two.ask(IsReady()) == Ready(IsReady(), False)
        assert two.ask(Ask("B")) == Answer(Ask("B"), ("B",))
        assert one.ask(IsReady()) == Ready(IsReady(), True)
        with Client(port) as three:
            assert three.ask(ASK) == Closed(ASK)
        assert one.ask(IsReady()) == Ready(IsReady(), True)
        assert machine.heard == [(0, "A"), (1, "B")]


def test_a_client_that_has_gone_makes_room():
    machine = Echo()
    with served(machine) as port:
        with Client(port) as one, Client(port) as two:
            one.ask(ASK)
            two.ask(ASK)
        for _ in range(20):
            with Client(port) as client:
                event = client.ask(ASK)
                if event == Closed(ASK):
                    time.sleep(0.05)  # the server notices the closed connections a moment later
                    continue
            break
        assert event == Answer(ASK, ("P1",))


def test_a_connection_that_ends_in_the_middle_of_a_packet():
    machine = Echo()
    with served(machine) as port:
        with socket.create_connection(("127.0.0.1", port)) as raw:
            raw.sendall(encode(Write(("X1", "X2")))[:-3])
        with Client(port) as client:
            assert client.ask(ASK) == Answer(ASK, ("P1",))
    assert [line for _, line in machine.heard] == ["P1"]


def test_nonsense_ends_the_connection():
    with served(Echo()) as port:
        assert answered(encode(ASK) + b"GET / HTTP/1.1\r\n\r\n", port, 100) in {b"P1\r\x06", b""}
        with Client(port) as client:
            assert client.ask(ASK) == Answer(ASK, ("P1",))


def test_a_client_that_never_reads_is_not_read_either():
    """If a client doesn't read its answers, the server stops reading its questions."""
    machine, questions = Echo(), 50_000

    async def run():
        async with SimulatorServer(machine, port=0) as server:
            _, writer = await asyncio.open_connection("127.0.0.1", server.port, limit=1000)
            writer.write(encode(Ask("LONG100")) * questions)
            await asyncio.sleep(0)
            while not (client := next(iter(server._clients.values()), None)) or not client._full:
                await asyncio.sleep(0.01)
            heard = len(machine.heard)
            await asyncio.sleep(0.1)
            assert len(machine.heard) == heard
            assert client._transport.get_write_buffer_size() < 200_000
            writer.transport.abort()

    asyncio.run(asyncio.wait_for(run(), 60))
    assert len(machine.heard) < questions


def test_a_name_with_several_addresses_has_one_port():
    """With port 0, all addresses of a name such as `localhost` get the same port."""

    async def run():
        async with SimulatorServer(Echo(), host=["127.0.0.1", "127.0.0.2"], port=0) as server:
            ends = {each.getsockname() for each in server._server.sockets}
            assert ends == {("127.0.0.1", server.port), ("127.0.0.2", server.port)}

    asyncio.run(run())


def test_what_is_odd_is_told():
    told = []
    with served(Echo(), "amplifier@0:3", tell=told.append) as port:
        with Client(port) as one, Client(port) as two:
            one.ask(ASK)
            two.ask(ASK)
            with Client(port) as three:
                assert three.ask(ASK) == Closed(ASK)
        time.sleep(0.1)
        answered(b"GET / HTTP/1.1\r\n\r\n", port, 100)
    assert told[0] == "fault amplifier@0:3"
    assert "another client is refused: the controller keeps 2 connections" in told
    assert told[-1].startswith("a connection is closed: 47 45 54")
    assert len(told) == 3


class Heavy(Echo):
    """A machine that needs a hundredth of its time in real time."""

    def advance(self, seconds):
        time.sleep(seconds / 100)
        super().advance(seconds)


def test_a_rate_that_the_computer_cannot_keep_up_with():
    """If the rate is too high for the computer, time passes more slowly, and clients are still answered."""
    machine = Heavy()
    with served(machine, rate=10_000.0) as port, Client(port) as client:
        begun = time.monotonic()
        for _ in range(5):
            assert client.ask(ASK) == Answer(ASK, ("P1",))
        assert time.monotonic() - begun < 2.0
    assert machine.now > 1.0


@pytest.mark.parametrize("rate", [0.5, 1.0, 10.0])
def test_time_passes_with_the_wall_clock(rate):
    """Time doesn't pass faster than the rate; on a busy computer it may pass more slowly."""
    machine, begun = Echo(), time.monotonic()
    with served(machine, rate=rate):
        time.sleep(0.5)
    assert 0.1 * rate < machine.now < (time.monotonic() - begun) * rate
    assert max(machine.advanced) <= 0.25 * rate


def test_as_fast_as_it_goes():
    machine = Echo()
    with served(machine, rate=None) as port, Client(port) as client:
        assert client.ask(ASK) == Answer(ASK, ("P1",))
        time.sleep(0.3)
    assert machine.now > 10.0


def test_a_question_finds_the_time_up_to_date():
    machine = Echo()
    with served(machine) as port, Client(port) as client:
        client.ask(ASK)
        before, begun = machine.now, time.monotonic()
        while time.monotonic() < begun + 0.002:
            pass
        client.ask(ASK)
        assert machine.now - before > 0.0015


def test_drop():
    with served(Echo(), "drop@0.1") as port:
        with Client(port) as client:
            client.ask(ASK)
            time.sleep(0.2)
            assert client.ask(ASK) == Closed(ASK)
        with Client(port) as client:
            assert client.ask(ASK) == Answer(ASK, ("P1",))


def test_drop_in_the_middle_of_a_stream():
    """The fault drops the connection at the packet with the given line, before its reply."""
    machine = Echo()
    with served(machine, "drop@line5") as port, Client(port) as client:
        write = Write(("X1", "X2", "X3"))
        assert client.ask(write) == Written(write)
        assert client.ask(write) == Closed(write)
        assert len(machine.heard) == 6


def test_freeze():
    with served(Echo(), "freeze@0.05:0.3") as port, Client(port) as client:
        time.sleep(0.1)
        begun = time.monotonic()
        assert client.ask(ASK) == Answer(ASK, ("P1",))
        assert time.monotonic() - begun > 0.1


def test_freeze_for_ever():
    with served(Echo(), "freeze@0") as port, Client(port, timeout=0.2) as client:
        assert client.ask(ASK) == Late(ASK)


def test_slow():
    with served(Echo(), "slow:0.03") as port, Client(port) as client:
        begun = time.monotonic()
        for _ in range(5):
            assert client.ask(ASK) == Answer(ASK, ("P1",))
        assert time.monotonic() - begun >= 0.15


def test_slow_replies_keep_their_order():
    with served(Echo(), "slow:0-0.02") as port:
        data = b"".join(encode(Ask(f"P{number}")) for number in range(20))
        back = b"".join(b"P%d\r\x06" % number for number in range(20))
        assert answered(data, port, len(back)) == back


def test_busy():
    machine = Echo()
    with served(machine, "busy@0:0.2") as port, Client(port) as client:
        assert client.ask(ASK) == Busy(ASK)
        assert machine.heard == []
        time.sleep(0.25)
        assert client.ask(ASK) == Answer(ASK, ("P1",))


def test_garbled():
    with served(Echo(), "garble:1", seed=3) as port, Client(port, timeout=0.3) as client:
        event = client.ask(Ask("A" * 50))
        assert isinstance(event, Answer | Violation)
        assert event != Answer(Ask("A" * 50), ("A" * 50,))


def test_a_bug_in_the_machine_is_not_silent():
    async def run():
        async with SimulatorServer(Echo(), port=0) as server:
            reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
            writer.write(encode(Ask("BUG")))
            with pytest.raises(ZeroDivisionError):
                await asyncio.wait_for(server.serve(), 5)
            assert await reader.read() == b""
            writer.close()

    asyncio.run(run())


def run_sim(*arguments):
    return subprocess.Popen(
        [
            sys.executable,
            "-c",
            "from yarclang.cli.yarc import main; main()",
            "sim",
            "--port",
            "0",
            *arguments,
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )


@pytest.mark.parametrize("arguments", [(), ("--robot", "INDUSTRIAL6"), ("--rate", "max")])
def test_yarc_sim_serves_until_interrupted(arguments):
    with run_sim(*arguments) as process:
        try:
            said = process.stdout.readline()
            port = int(re.search(r":(\d+),", said)[1])
            with Client(port) as client:
                assert client.ask(Ask("I6=1 I3=2 VER")).items == ("1.945",)
        finally:
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=20)
    assert (process.returncode, out, err) == (0, "", "stopped\n")


@pytest.mark.parametrize(("host", "warned"), [("127.0.0.1", False), ("0.0.0.0", True), ("robot.local", True)])
def test_yarc_sim_warns_where_the_network_gets_in(monkeypatch, host, warned):
    async def nothing(server):
        pass

    for name in ("start", "serve", "close"):
        monkeypatch.setattr(SimulatorServer, name, nothing)
    done = CliRunner().invoke(yarc, ["sim", "--host", host])
    assert (done.exit_code, "no password" in done.stderr) == (0, warned)
    assert f"{host}:1025, real time" in done.stdout


def test_yarc_sim_says_when_the_port_is_taken():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with run_sim("--port", str(port)) as process:
            _, err = process.communicate(timeout=20)
    assert process.returncode == 1
    assert err == f"Error: can't listen on 127.0.0.1:{port}: address already in use\n"


def test_yarc_sim_says_what_address_it_has_not():
    with run_sim("--host", "192.0.2.1") as process:
        _, err = process.communicate(timeout=20)
    assert process.returncode == 1
    assert err == "Error: can't listen on 192.0.2.1:0: cannot assign requested address\n"


def test_an_address_with_colons_is_in_brackets(monkeypatch):
    async def nothing(server):
        pass

    for name in ("start", "serve", "close"):
        monkeypatch.setattr(SimulatorServer, name, nothing)
    assert "listens on [::1]:1025," in CliRunner().invoke(yarc, ["sim", "--host", "::1"]).stdout


def test_yarc_sim_says_what_happens():
    """`yarc sim` prints faults when they occur, and words of programs that are executed in another way."""
    with run_sim("--fault", "amplifier@0.3:2") as process:
        try:
            port = int(re.search(r":(\d+),", process.stdout.readline())[1])
            assert process.stderr.readline() == "0.300 s: fault amplifier@0.3:2\n"
            with Client(port) as client:
                client.ask(Ask("I6=1 I3=2"))
                lines = ("I100=1", "#1->X", "OPEN PROG 1 CLEAR", "CIRCLE1", "X1", "CLOSE", "A", "&1B1R")
                assert client.ask(Write(lines)).error is None
                assert re.fullmatch(r"\d+\.\d{3} s: CIRCLE1 .*\n", process.stderr.readline())
        finally:
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=20)
    assert (process.returncode, err) == (0, "stopped\n")


def test_help_shows_every_fault():
    shown = CliRunner().invoke(yarc, ["sim", "--help"]).stdout
    table = re.findall(r"^ +([a-z]+[@:]\S+)  ", shown, re.MULTILINE)
    assert [parse_fault(text).kind for text in table] == list(get_args(Kind))


@pytest.mark.parametrize("text", ["REAL", "Max", "10", "0.5"])
def test_rates(monkeypatch, text):
    async def nothing(server):
        pass

    for name in ("start", "serve", "close"):
        monkeypatch.setattr(SimulatorServer, name, nothing)
    shown = {"REAL": "real time", "Max": "as fast as possible"}.get(text, f"{text} times real time")
    assert f", {shown};" in CliRunner().invoke(yarc, ["sim", "--rate", text]).stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ("--rate", "0"),
        ("--rate", "fast"),
        ("--fault", "fire@3"),
        ("--port", "70000"),
        ("--host", ""),
    ],
)
def test_yarc_sim_refuses_wrong_usage(arguments):
    with run_sim(*arguments) as process:
        _, err = process.communicate(timeout=20)
    assert process.returncode == 2
    assert arguments[1] in err


def test_codec_has_no_memory_of_a_connection():
    """A new connection doesn't get what was left on an old one."""
    with served(Echo()) as port:
        with Client(port) as client:
            client.ask(Send("LONG1000"))
        with Client(port) as client:
            assert client.ask(IsReady()) == Ready(IsReady(), False)
