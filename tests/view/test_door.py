"""Tests of the server: its address, its answers, and the requests that it refuses."""

import socket
import threading

import pytest
import viser
from view.stages import CRASH, stage_of
from websockets.asyncio import server as websocket_server

from yarclang.hosts import is_called, is_loopback, is_own
from yarclang.view.door import Door, PortTakenError, _names
from yarclang.view.server import GuardedServer
from yarclang.view.show import show


def test_it_is_served_and_ends(capfd):
    """The server starts and ends, and the table that viser would print isn't shown."""
    seen = []

    def ready(door):
        seen.append(door)
        with socket.create_connection((door.host, door.port), timeout=10) as stream:
            stream.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1:%d\r\n\r\n" % door.port)
            assert b"200 OK" in stream.recv(100)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        show(stage_of(CRASH), Door("127.0.0.1", 0), ready)
    assert seen[0].port > 0
    assert capfd.readouterr().out == ""
    with socket.socket() as again:  # the port is free again
        again.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        again.bind(("127.0.0.1", seen[0].port))


def test_a_port_in_use():
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        door = Door("127.0.0.1", other.getsockname()[1])
        with pytest.raises(PortTakenError, match="in use"):
            show(stage_of(CRASH), door, lambda _: None)


@pytest.mark.parametrize("host", ["192.0.2.1", "nowhere.invalid", "a..b"])
def test_an_address_that_is_not_ours(host):
    with pytest.raises(PortTakenError):
        show(stage_of(CRASH), Door(host, 0), lambda _: None)


@pytest.mark.parametrize(
    ("origin", "host", "own"),
    [
        (None, "127.0.0.1:8080", True),
        ("http://127.0.0.1:8080", "127.0.0.1:8080", True),
        ("http://localhost:8080", "127.0.0.1:8080", True),
        ("http://[::1]:8080", "[::1]:8080", True),
        ("http://robot.lan:8080", "robot.lan:8080", True),
        ("http://127.0.0.1:9000", "127.0.0.1:8080", False),
        ("https://elsewhere.example", "127.0.0.1:8080", False),
        ("http://127.0.0.1:8080", None, False),
        ("null", "127.0.0.1:8080", False),
        ("http://127.0.0.1:x", "127.0.0.1:8080", False),
    ],
)
def test_pages_of_other_sites_are_strangers(origin, host, own):
    assert is_own(origin, host) is own


def test_addresses_as_they_are_typed():
    assert Door("127.0.0.1", 8080).url == "http://127.0.0.1:8080"
    assert Door("::1", 80).url == "http://[::1]:80"


NAMES = {"localhost", "127.0.0.1", "::1", "robot.lan", "192.168.0.5"}


@pytest.mark.parametrize(
    ("host", "known"),
    [
        ("localhost:8080", True),
        ("LOCALHOST.:8080", True),
        ("127.0.0.1:8080", True),
        ("[::1]:8080", True),
        ("[0:0:0:0:0:0:0:1]:8080", True),
        ("robot.lan:8080", True),
        ("192.168.0.5:8080", True),
        ("[::ffff:192.168.0.5]:8080", True),
        ("evil.example:8080", False),
        ("127.0.0.1.evil.example:8080", False),
        ("evil.example@127.0.0.1:8080", False),
        ("127.0.0.1:8080@evil.example", False),
        ("localhost", False),
        ("localhost:80", False),
        ("localhost:8081", False),
        ("localhost:", False),
        ("localhost:8080:8080", False),
        ("localhost:٨٠٨٠", False),
        ("192.168.0.6:8080", False),
        ("::1:8080", False),
        ("[::1", False),
        ("", False),
        (" localhost:8080", False),
        ("localhost:8080/x", False),
        ("a" * 70000, False),
    ],
)
def test_names_that_are_its_own(host, known):
    assert is_called(host, 8080, NAMES) is known
    assert is_called("localhost", 80, NAMES)


def test_names_in_the_network():
    assert _names(Door("127.0.0.1", 0)) == _names(Door("robot.lan", 0)) == frozenset()
    assert socket.gethostname() in _names(Door("0.0.0.0", 0))


@pytest.fixture(scope="module")
def served():
    """Yield the port of a stage that is served."""
    ready, ports, end = threading.Event(), [], threading.Event()

    def listen(door):
        ports.append(door.port)
        ready.set()
        end.wait(600)
        raise KeyboardInterrupt

    def run():
        with pytest.raises(KeyboardInterrupt):
            show(stage_of(CRASH), Door("127.0.0.1", 0), listen)

    thread = threading.Thread(target=run)
    thread.start()
    assert ready.wait(120)
    yield ports[0]
    end.set()
    thread.join(30)


SOCKET = (
    "Upgrade: websocket\r\n"
    "Connection: Upgrade\r\n"
    "Sec-WebSocket-Version: 13\r\n"
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
)


def answered(port, *headers, path="/", scene=False):
    """Return the raw answer of the server to a request.

    If the server opens a WebSocket, this includes the beginning of the scene.
    """
    lines = [f"GET {path} HTTP/1.1", *headers]
    if scene:
        lines.append(f"{SOCKET}Sec-WebSocket-Protocol: viser-v{viser.__version__}")
    with socket.create_connection(("127.0.0.1", port), timeout=10) as stream:
        stream.sendall("\r\n".join([*lines, "", ""]).encode())
        got = b""
        while len(got) < 5000 and (part := stream.recv(65536)):
            got += part
    return got


def own(port):
    return (f"localhost:{port}", f"127.0.0.1:{port}", f"[::1]:{port}", f"LocalHost:{port}")


@pytest.mark.parametrize("scene", [False, True])
def test_by_its_own_names_it_answers(served, scene):
    for host in own(served):
        got = answered(served, f"Host: {host}", scene=scene)
        assert got.startswith(b"HTTP/1.1 101 " if scene else b"HTTP/1.1 200 ")
        assert len(got) >= 5000
    got = answered(served, f"Host: localhost:{served}", f"Origin: http://127.0.0.1:{served}", scene=True)
    assert got.startswith(b"HTTP/1.1 101 ")


@pytest.mark.parametrize("scene", [False, True])
@pytest.mark.parametrize(
    "headers",
    [
        ("Host: evil.example:{port}",),
        ("Host: evil.example:{port}", "Origin: http://evil.example:{port}"),
        ("Host: evil.example:{port}", "Origin: http://127.0.0.1:{port}"),
        ("Host: 127.0.0.1.evil.example:{port}",),
        ("Host: 127.0.0.1",),
        ("Host: 127.0.0.1:1",),
        ("Host: 192.168.0.1:{port}",),
        ("Host: localhost:{port}", "Host: evil.example:{port}"),
        ("Host: evil.example:{port}", "Host: localhost:{port}"),
        ("Host: localhost:{port}", "Origin: http://evil.example:{port}"),
        ("Host: localhost:{port}", "Origin: http://localhost:9000"),
        ("Host: localhost:{port}", "Origin: null"),
        ("Host: localhost:{port}", "Origin: http://localhost:{port}", "Origin: http://evil.example"),
        ("Host:",),
        ("X-Forwarded-Host: localhost:{port}", "Host: evil.example"),
        (),
    ],
)
def test_by_another_name_it_shows_nothing(served, headers, scene):
    got = answered(served, *(one.format(port=served) for one in headers), scene=scene)
    assert got.startswith(b"HTTP/1.1 403 Forbidden\r\n")
    assert len(got) < 600
    assert b"viser" not in got
    for path in ("/index.html", f"http://localhost:{served}/"):
        got = answered(served, *(one.format(port=served) for one in headers), path=path, scene=scene)
        assert got.startswith(b"HTTP/1.1 403 Forbidden\r\n")


def test_a_library_that_does_not_ask_the_guard_is_not_used(monkeypatch):
    serve = websocket_server.serve
    monkeypatch.setattr(viser.ViserServer, "__init__", lambda self, **_: None)
    monkeypatch.setattr(viser.ViserServer, "stop", lambda self: None)
    with pytest.raises(RuntimeError, match="can't be guarded"):
        GuardedServer("127.0.0.1", 0)
    assert websocket_server.serve is serve


@pytest.mark.parametrize(
    ("host", "is_only_here"),
    [
        ("127.0.0.1", True),
        ("::1", True),
        ("localhost", True),
        ("Localhost", True),
        ("::1%lo", True),
        ("0.0.0.0", False),
        ("192.168.1.5", False),
        ("robot", False),
        ("", False),
    ],
)
def test_only_this_machine_reaches_a_loopback_address(host, is_only_here):
    assert is_loopback(host) is is_only_here
