"""The server: where it listens, what it says, and whom it lets in."""

import socket

import pytest
from view.stages import CRASH, stage_of

from yarclang.view.server import is_own
from yarclang.view.show import Door, PortTakenError, show


def test_it_is_served_and_ends(capfd):
    """viser prints a table of its own, which nobody wants."""
    seen = []

    def ready(door):
        seen.append(door)
        with socket.create_connection((door.host, door.port), timeout=10) as stream:
            stream.sendall(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
            assert b"200 OK" in stream.recv(100)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        show(stage_of(CRASH), Door("127.0.0.1", 0), ready)
    assert seen[0].port > 0
    assert capfd.readouterr().out == ""
    with socket.socket() as again:  # nobody listens there any more
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
