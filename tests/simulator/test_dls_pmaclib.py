"""A client by others: dls-pmaclib of Diamond Light Source."""

import pytest

from tests.simulator.serving import served
from yarclang.simulator.machine import Machine

pmac_remote = pytest.importorskip("dls_pmaclib.dls_pmacremote")

PROGRAM = [
    "CLOSE",
    "DELETE GATHER",
    "OPEN PROG 7",
    "CLEAR",
    "LINEAR",
    "ABS",
    "TA100",
    "TS0",
    "F50",
    "X10Y20",
    "DWELL100",
    "P1=P1+1",
    "CLOSE",
]


@pytest.fixture
def peer():
    """Yield the library's client, connected to a bare controller."""
    with served(Machine()) as port:
        pmac = pmac_remote.PmacEthernetInterface(timeout=5)
        pmac.setConnectionParams("127.0.0.1", port)
        assert pmac.connect() is None
        yield pmac
        pmac.disconnect()


def value(peer, question):
    """Return the only value that a line asks for."""
    reply, good = peer.sendCommand(question)
    assert good
    assert reply.endswith("\r\x06")
    return float(reply[:-2])


def test_connects_and_leaves(peer):
    assert peer.isConnectionOpen
    peer.disconnect()
    assert not peer.isConnectionOpen
    assert peer.connect() is None


def test_model_and_axes(peer):
    assert peer.getPmacModel() in {"Turbo PMAC2 Clipper", "Turbo PMAC2-VME", "Geo Brick (3U Turbo PMAC2)"}
    assert peer.getNumberOfAxes() % 8 == 0
    assert peer.getNumberOfAxes() >= 8


def test_variables(peer):
    assert peer.sendCommand("P100=12.5 Q7=-3") == ("\x06", True)
    assert value(peer, "P100") == 12.5
    assert peer.sendCommand("p100 p101=p100*2 p101") == ("12.5\r25\r\x06", True)
    peer.setVar("I122", 30)
    assert value(peer, "I122") == 30
    assert peer.getIVars(100, [22, 0]) == ["30", str(int(value(peer, "I100")))]


def test_errors_as_the_library_expects_them(peer):
    assert peer.sendCommand("NONSENSE") == ("\x07ERR003\r", True)
    assert peer.sendCommand("P1 P2 @") == ("0\r0\r\x07ERR003\r", True)
    assert peer.sendCommand("X10") == ("\x07ERR005\r", True)


def test_status_of_several_motors_in_one_line(peer):
    reply, good = peer.sendCommand("#1?#2?")
    assert good
    assert [len(word) for word in reply[:-1].split("\r")] == [12, 12, 0]


def test_a_program_up_and_back(peer):
    sent = list(peer.sendSeries(enumerate(PROGRAM, 1)))
    assert [(good, number) for good, number, _, _ in sent] == [(True, n + 1) for n in range(len(PROGRAM))]
    reply, good = peer.sendCommand("LIST PROG 7")
    assert good
    listed = "".join(reply.rstrip("\x06").split()).replace(" ", "")
    for line in PROGRAM[4:-1]:
        assert line.replace(" ", "") in listed


def test_a_series_says_which_line_was_refused(peer):
    lines = ["CLOSE", "OPEN PROG 8", "CLEAR", "X10", "ENDIF", "X20", "CLOSE"]
    refused = [number for good, number, _, _ in peer.sendSeries(enumerate(lines, 1)) if not good]
    assert refused == [5]


def test_a_long_listing_comes_in_several_packets(peer):
    """The library takes a CR at the end of a full packet for an error. So the lines are chosen so that no
    full packet ends with CR: 1400 isn't a multiple of their length.
    """
    lines = ["CLOSE", "OPEN PROG 9", "CLEAR", "P1=1", *(f"P{n}=1" for n in range(1000, 1500)), "CLOSE"]
    assert all(good for good, *_ in peer.sendSeries(enumerate(lines, 1)))
    reply, good = peer.sendCommand("LIST PROG 9")
    assert good, reply
    assert reply.endswith("\r\x06")
    assert len(reply) > 3000
    assert "P1499=1" in reply
