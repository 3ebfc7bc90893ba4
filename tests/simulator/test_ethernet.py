"""The controller's end of the Ethernet protocol: packets in any pieces, and their effects."""

import itertools
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.simulator.echo import Echo
from yarclang.pmac.requests import DOWN, HEADER, MOST_DATA, MOST_REPLY, UP, Code
from yarclang.runtime.pmac.protocol import (
    Answer,
    Ask,
    AskControl,
    Busy,
    Connection,
    Control,
    Fetch,
    Flush,
    IsReady,
    Memory,
    ReadMemory,
    Ready,
    Send,
    Taken,
    Write,
    WriteMemory,
    Written,
    encode,
)
from yarclang.simulator.machine import Machine
from yarclang.simulator.network.ethernet import Packet, PacketReader, Station


def packet(direction, code, data=b"", value=0, index=0, length=None):
    return struct.pack(HEADER, direction, code, value, index, len(data) if length is None else length) + data


def chop(data, cuts):
    places = sorted({0, len(data), *(cut % (len(data) + 1) for cut in cuts)})
    return [data[a:b] for a, b in itertools.pairwise(places)]


def read(parts):
    reader = PacketReader()
    packets = [one for part in parts for one in reader.receive(part)]
    return packets, reader.broken


class Pair:
    """A client's connection and a station, with bytes that are passed on one by one."""

    def __init__(self, machine=None, port=0):
        self.machine = machine or Echo()
        self.connection, self.reader = Connection(), PacketReader()
        self.station = Station(self.machine, port)
        self.replies = []

    def ask(self, request):
        data = self.connection.send(request, 0.0, 1.0)
        events = []
        while data:
            for at in range(len(data)):
                for one in self.reader.receive(data[at : at + 1]):
                    self.replies.append(self.station.answer(one))
                    for byte in self.replies[-1]:
                        events += self.connection.receive(bytes([byte]), 0.0)
            data = self.connection.outgoing()
        (event,) = events
        return event


def test_a_packet():
    data = packet(DOWN, Code.GETRESPONSE, b"P1", value=0x102, index=0x304)
    assert read([data]) == ([Packet(False, 0xBF, 0x102, 0x304, 2, b"P1")], None)
    assert read([packet(UP, Code.GETBUFFER, length=2048)]) == ([Packet(True, 0xC5, 0, 0, 2048, b"")], None)


@pytest.mark.parametrize("direction", [0x00, 0x41, 0x80, 0xC1, 0xFF])
def test_unknown_directions_break_the_stream(direction):
    good = packet(UP, Code.READREADY, length=2)
    packets, broken = read([good + packet(direction, Code.GETRESPONSE, b"P1") + good])
    assert len(packets) == 1
    assert "isn't the header" in broken


def test_oversized_data_break_the_stream():
    assert read([packet(DOWN, Code.GETRESPONSE, b"X" * MOST_DATA)])[1] is None
    reader = PacketReader()
    assert reader.receive(packet(DOWN, Code.GETRESPONSE, length=MOST_DATA + 1)) == []
    assert reader.broken
    assert reader.receive(b"x" * 100) == []


def test_a_length_that_is_only_wanted_may_be_any():
    assert read([packet(UP, Code.GETBUFFER, length=65535)])[1] is None


@given(
    st.lists(
        st.tuples(
            st.sampled_from([UP, DOWN, DOWN, 0x77]),
            st.integers(0, 255),
            st.binary(max_size=60),
            st.integers(0, 65535),
        ),
        max_size=6,
    ),
    st.binary(max_size=20),
    st.lists(st.integers(0, 400), max_size=9),
)
def test_any_chopping_gives_the_same_packets(requests, tail, cuts):
    data = b"".join(
        packet(way, code, body if way == DOWN else b"", value) for way, code, body, value in requests
    )
    whole = read([data + tail])
    assert read(chop(data + tail, cuts)) == whole
    assert read([bytes([byte]) for byte in data + tail]) == whole


@given(st.lists(st.binary(max_size=4000), max_size=10))
def test_random_bytes_are_bounded(parts):
    """Random bytes cause no exception, and at most one packet is kept."""
    reader, station = PacketReader(), Station(Echo(), 0)
    for part in parts:
        for one in reader.receive(part):
            if not one.data.startswith((b"LONG", b"ERR", b"BUG")):
                assert len(station.answer(one)) <= MOST_REPLY
        assert len(reader._in) < MOST_DATA + 8


@given(
    st.sampled_from([*Code]),
    st.sampled_from([UP, DOWN]),
    st.binary(max_size=1492),
    st.integers(0, 65535),
    st.integers(0, 65535),
)
def test_any_packet_can_be_answered(code, direction, data, value, length):
    if data.startswith((b"ERR", b"LONG", b"BUG")):
        data = b""
    body = data if direction == DOWN else b""
    one = Packet(direction == UP, code, value, 0, length if direction == UP else len(body), body)
    assert len(Station(Echo(), 0).answer(one)) <= MOST_REPLY


def test_lines():
    pair = Pair()
    assert pair.ask(Ask("P1")) == Answer(Ask("P1"), ("P1",))
    assert pair.ask(Ask("SET")) == Answer(Ask("SET"), ())
    assert pair.ask(Ask("ERR14")) == Answer(Ask("ERR14"), ("before",), 14)
    assert pair.machine.heard == [(0, "P1"), (0, "SET"), (0, "ERR14")]


def test_line_ends_that_some_clients_send():
    machine = Echo()
    Station(machine, 1).answer(Packet(False, Code.GETRESPONSE, 0, 0, 0, b"P1\r\n"))
    Station(machine, 1).answer(Packet(False, Code.GETRESPONSE, 0, 0, 0, b"P\xe9\0"))
    assert machine.heard == [(1, "P1"), (1, "Pé")]


@pytest.mark.parametrize("lines", [1, 140, 141, 142, 154, 155, 156, 2000])
def test_long_replies(lines):
    pair = Pair()
    event = pair.ask(Ask(f"LONG{lines}"))
    assert event.items == tuple(f"LINE {number}" for number in range(lines))
    assert all(len(reply) == MOST_REPLY for reply in pair.replies[:-1])
    assert 0 < len(pair.replies[-1]) <= MOST_REPLY


def test_getbuffer_gives_no_more_than_is_wanted():
    station = Station(Echo(), 0)
    whole = station.answer(Packet(False, Code.GETRESPONSE, 0, 0, 0, b"LONG400"))
    whole += station.answer(Packet(True, Code.GETBUFFER, 0, 0, 100, b""))
    assert len(whole) == 1500
    while not whole.endswith(b"\x06"):
        whole += (part := station.answer(Packet(True, Code.GETBUFFER, 0, 0, 2048, b"")))
        assert len(part) <= MOST_REPLY
    assert whole == Echo().respond("LONG400")


def test_a_line_whose_reply_waits():
    pair = Pair()
    assert pair.ask(IsReady()) == Ready(IsReady(), False)
    assert pair.ask(Fetch()) == Busy(Fetch())
    assert pair.ask(Send("P1")) == Taken(Send("P1"))
    assert pair.ask(IsReady()) == Ready(IsReady(), True)
    assert pair.ask(Fetch()) == Answer(Fetch(), ("P1",))
    assert pair.ask(IsReady()) == Ready(IsReady(), False)


def test_getline():
    station = Station(Echo(), 0)
    station.answer(Packet(False, Code.SENDLINE, 0, 0, 0, b"LONG2"))
    lines = [station.answer(Packet(True, Code.GETLINE, 0, 0, 255, b"")) for _ in range(4)]
    assert lines == [b"LINE 0\r", b"LINE 1\r", b"\x06", b"\x00"]


def test_what_is_left_waits_until_flush():
    pair = Pair()
    pair.ask(Send("P1"))
    assert pair.ask(Flush()) == Taken(Flush())
    assert pair.ask(IsReady()) == Ready(IsReady(), False)
    pair.ask(Send("P1"))
    pair.ask(Control("\x18"))
    assert pair.ask(IsReady()) == Ready(IsReady(), False)


def test_what_programs_send():
    pair = Pair()
    pair.machine.news[0] = ("HELLO",)
    assert pair.ask(IsReady()) == Ready(IsReady(), True)
    assert pair.station.answer(Packet(True, Code.GETLINE, 0, 0, 255, b"")) == b"HELLO\r"


def test_control_characters():
    pair = Pair()
    assert pair.ask(AskControl("\x10")) == Answer(AskControl("\x10"), ("1.5 2.5",))
    assert pair.ask(Control("\x01")) == Taken(Control("\x01"))
    assert pair.machine.heard == [(0, 0x10), (0, 1)]
    assert pair.station.answer(Packet(True, Code.CTRL_RESPONSE, 11, 0, 1, b"")) == b"\0"


def test_writebuffer():
    pair = Pair()
    write = Write(("OPEN ROT", "X1", "ERR6", "X2"))
    assert pair.ask(write) == Written(write, 6, 3)
    assert [line for _, line in pair.machine.heard] == ["OPEN ROT", "X1", "ERR6"]
    assert pair.replies == [b"\x03\x00\x06\x80"]
    assert pair.station.take_lines() == 2
    assert pair.station.answer(Packet(True, Code.WRITEERROR, 0, 0, 4, b"")) == b"\x03\x00\x06\x80"
    assert pair.ask(Write(("X2",))) == Written(Write(("X2",)))
    assert pair.station.take_lines() == 1


def test_writebuffer_line_numbers_have_two_bytes():
    station = Station(Echo(), 0)
    data = b"X\0" * 300 + b"ERR3\0"
    assert station.answer(Packet(False, Code.WRITEBUFFER, 0, 0, 0, data)) == b"\x2d\x01\x03\x80"


def test_writebuffer_without_its_last_nul():
    machine = Echo()
    assert Station(machine, 0).answer(Packet(False, Code.WRITEBUFFER, 0, 0, 0, b"A\0B")) == bytes(4)
    assert machine.heard == [(0, "A"), (0, "B")]


def test_writebuffer_that_is_too_long_is_refused():
    machine = Echo()
    assert Station(machine, 0).answer(Packet(False, Code.WRITEBUFFER, 0, 0, 0, b"A\0" * 513))[3] == 0x80
    assert machine.heard == []


def test_memory():
    pair = Pair()
    assert pair.ask(WriteMemory(10, b"abc")) == Taken(WriteMemory(10, b"abc"))
    assert pair.ask(ReadMemory(9, 5)) == Memory(ReadMemory(9, 5), b"\0abc\0")
    assert pair.ask(ReadMemory(65535, 1)).data == b"\0"
    assert pair.ask(WriteMemory(65535, b"abc")) == Taken(WriteMemory(65535, b"abc"))
    assert pair.ask(ReadMemory(9, 5)).data == b"\0abc\0"


@pytest.mark.parametrize("code", [0x00, 0xB2, Code.FWDOWNLOAD, 0xE1, 0xFF])
@pytest.mark.parametrize("direction", [UP, DOWN])
def test_unknown_codes_have_no_reply_and_do_no_harm(code, direction):
    data = packet(direction, code, b"P1" if direction == DOWN else b"") + encode(Ask("P2"))
    packets, broken = read([data])
    station = Station(Echo(), 0)
    assert [station.answer(one) for one in packets] == [b"", b"P2\r\x06"]
    assert broken is None


def test_every_code_is_known():
    station = Station(Echo(), 0)
    silent = {
        code
        for code in Code
        if not any(station.answer(Packet(up, code, 0, 0, 1, b"")) for up in (False, True))
    }
    assert silent == {Code.FWDOWNLOAD}


REQUESTS = st.one_of(
    st.builds(Ask, st.from_regex(r"(LONG[0-9]{1,3}|ERR([1-9]|1[0-9])|SET|[A-Z][0-9]{1,5})", fullmatch=True)),
    st.builds(Write, st.lists(st.sampled_from(["X1", "Y-2.5", "ERR6", "SET"]), min_size=1).map(tuple)),
    st.sampled_from([Flush(), IsReady(), Send("P1"), Fetch(), Control("\x01"), AskControl("\x10")]),
    st.builds(ReadMemory, st.integers(0, 65535), st.integers(1, 1400)),
    st.builds(WriteMemory, st.integers(0, 65535), st.binary(min_size=1, max_size=50)),
)


@given(st.lists(REQUESTS, max_size=12), st.randoms(use_true_random=False))
def test_both_ends_together_in_any_chopping(requests, random):
    """Each request gets the same event, into whatever pieces the bytes are cut."""

    def conversation(cut):
        station, reader, connection, events = Station(Echo(), 0), PacketReader(), Connection(), []
        for request in requests:
            if connection._left and isinstance(request, Ask | Send):
                continue
            data, got = connection.send(request, 0.0, 1.0), []
            while data:
                packets = [one for part in cut(data) for one in reader.receive(part)]
                for part in cut(b"".join(station.answer(one) for one in packets)):
                    got += connection.receive(part, 0.0)
                data = connection.outgoing()
            assert len(got) == 1
            assert reader._in == b""
            events += got
        return events

    chopped = conversation(
        lambda data: chop(data, [random.randrange(len(data) + 1) for _ in range(random.randrange(6))])
    )
    assert chopped == conversation(lambda data: [data])


WORDS = """
I6=1 I3=2 I3=1 VER P1 P1..6 P1=-2.5 M161 M161-> #1P #2? &1?? ??? #1->X #1->100X+5 #1J+ #1J/ #1HM I100=1 &1DEFINEROT480
OPENROT OPENPROG1CLEAR CLOSE CLEAR X10 Y-2.5 SPLINE1TM50 LINEAR TM100 B0 B1 R Q A H K % %50 PR LISTPROG1 DWELL100
IF(P1=0) ENDIF WHILE(P1<9) ENDWHILE ENABLEPLC0 OPENPLC0CLEAR P1=P1+1 CMD"P1=1" $$$ DELETEROT UNDEFINEALL ; !
"""  # noqa: E501
LINES = st.one_of(
    st.binary(max_size=300),
    st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=60).map(str.encode),
    st.lists(st.sampled_from(WORDS.split()), max_size=6).map(lambda words: " ".join(words).encode()),
)


@given(
    st.lists(
        st.tuples(st.sampled_from([*Code]), st.booleans(), LINES, st.integers(0, 31), st.booleans()),
        max_size=25,
    )
)
def test_a_real_machine_behind_random_packets(packets):
    """No packets stop the machine, or cause a reply that is longer than a packet."""
    machine = Machine()
    stations = [Station(machine, port) for port in (0, 1)]
    for code, up, data, value, second in packets:
        one = Packet(up, code, value, 0, 1400 if up else len(data), b"" if up else data)
        assert len(stations[second].answer(one)) <= MOST_REPLY
        machine.advance(0.01)
