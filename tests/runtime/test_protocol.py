"""Tests of the client side of the Ethernet protocol: bytes of requests, replies that arrive in arbitrary
pieces, and invalid replies.
"""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.pmac.requests import MOST_LINES, MOST_REPLY
from yarclang.runtime.actions import Closed, Late, Violation
from yarclang.runtime.pmac.protocol import (
    MOST_TEXT,
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
    ProtocolError,
    ReadMemory,
    Ready,
    Send,
    Taken,
    Write,
    WriteMemory,
    Written,
    encode,
    fitting,
)

ASK = Ask("P1")
WRITE = Write(("X1", "X2", "X3"))
LONG = b"".join(b"LINE%04d\r" % i for i in range(800))


def chop(data: bytes, cuts: list[int]) -> list[bytes]:
    places = sorted({0, len(data), *(cut % (len(data) + 1) for cut in cuts)})
    return [data[a:b] for a, b in itertools.pairwise(places)]


def events_of(request, replies: list[bytes], cuts: list[int] | None = None):
    """Return the events and the sent bytes. Each further packet arrives only after it was requested."""
    connection = Connection()
    sent = [connection.send(request, 0.0, 1.0)]
    events = []
    for reply in replies:
        for part in chop(reply, cuts) if cuts is not None else [reply]:
            events += connection.receive(part, 0.5)
            if more := connection.outgoing():
                sent.append(more)
    return events, sent


def packets_of(reply: bytes) -> list[bytes]:
    return [reply[i : i + MOST_REPLY] for i in range(0, len(reply), MOST_REPLY)]


@pytest.mark.parametrize(
    ("request_", "packet"),
    [
        (Ask("i6=1 i3=2 ver"), b"\x40\xbf\0\0\0\0\0\x0di6=1 i3=2 ver"),
        (Send("R"), b"\x40\xb0\0\0\0\0\0\x01R"),
        (Write(("OPEN ROT", "X1")), b"\x40\xc6\0\0\0\0\0\x0cOPEN ROT\0X1\0"),
        (Fetch(), b"\xc0\xc5\0\0\0\0\x05\x78"),
        (IsReady(), b"\xc0\xc2\0\0\0\0\0\x02"),
        (Flush(), b"\x40\xb3\0\0\0\0\0\0"),
        (Control("\x01"), b"\x40\xb6\0\x01\0\0\0\0"),
        (AskControl("\x10"), b"\xc0\xc4\0\x10\0\0\0\0"),
        (ReadMemory(0x1234, 300), b"\xc0\xb4\x12\x34\0\0\x01\x2c"),
        (WriteMemory(2, b"\0\xff"), b"\x40\xb5\0\x02\0\0\0\x02\0\xff"),
    ],
)
def test_packets(request_, packet):
    assert encode(request_) == packet
    assert Connection().send(request_, 0.0, 1.0) == packet


REPLIES = [
    (ASK, b"\x06", Answer(ASK, ())),
    (ASK, b"1.5\r\x06", Answer(ASK, ("1.5",))),
    (ASK, b"1\r2\r\r\x06", Answer(ASK, ("1", "2", ""))),
    (ASK, b"\x07ERR003\r", Answer(ASK, (), 3)),
    (ASK, b"12\r\x07ERR014\r", Answer(ASK, ("12",), 14)),
    (ASK, b"\0", Busy(ASK)),
    (Fetch(), b"\0", Busy(Fetch())),
    (AskControl("\x10"), b"1 2 3\r", Answer(AskControl("\x10"), ("1 2 3",))),
    (Control("\x01"), b"\0", Taken(Control("\x01"))),
    (Send("R"), b"\x06", Taken(Send("R"))),
    (Flush(), b"\x40", Taken(Flush())),
    (Flush(), b"\x18", Taken(Flush())),
    (IsReady(), b"\x01\0", Ready(IsReady(), True)),
    (IsReady(), b"\0\0", Ready(IsReady(), False)),
    (WRITE, b"\0\0\0\0", Written(WRITE)),
    (WRITE, b"\x02\x00\x06\x80", Written(WRITE, 6, 2)),
    (ReadMemory(0, 3), b"\0\x06\x07", Memory(ReadMemory(0, 3), b"\0\x06\x07")),
    (WriteMemory(0, b"x"), b"\0", Taken(WriteMemory(0, b"x"))),
]


@pytest.mark.parametrize(("request_", "reply", "event"), REPLIES)
def test_replies(request_, reply, event):
    assert events_of(request_, [reply]) == ([event], [encode(request_)])


@pytest.mark.parametrize(("request_", "reply", "event"), REPLIES)
def test_byte_by_byte(request_, reply, event):
    assert events_of(request_, [reply], list(range(len(reply)))) == ([event], [encode(request_)])


def test_one_after_the_other():
    connection = Connection()
    for request, reply, event in sorted(REPLIES, key=lambda case: isinstance(case[0], Send)):
        connection.send(request, 0.0, 1.0)
        assert connection.in_flight is request
        assert connection.receive(reply, 0.1) == (event,)
        assert connection.in_flight is connection.deadline is None


@pytest.mark.parametrize("size", [1398, 1399, 1400, 1401, 2799, 2800, 2801, 7000])
@pytest.mark.parametrize("end", [b"\x06", b"\x07ERR006\r"])
def test_long_replies_are_fetched(size, end):
    """The end of a long reply may be the last byte of a full packet, the first byte of the next packet, or
    anywhere in between.
    """
    text = b"x" * (size - len(end) - 1) + b"\r" + end
    packets = packets_of(text)
    events, sent = events_of(ASK, packets)
    error = 6 if len(end) > 1 else None
    assert events == [Answer(ASK, ("x" * (size - len(end) - 1),), error)]
    assert sent == [encode(ASK)] + [encode(Fetch())] * (len(packets) - 1)
    assert events_of(ASK, packets, list(range(0, size, 7))) == (events, sent)


VIOLATIONS = [
    (ASK, b"\n1\r\n", "line feed"),
    (ASK, b"12\x06", "last CR"),
    (ASK, b"1\r\x02", "byte 02"),
    (ASK, b"1\0", "byte 00"),
    (ASK, b"\xff", "byte FF"),
    (ASK, b"\x07\r", "without its number"),
    (ASK, b"\x07ERR3\r", "without its number"),
    (ASK, b"1\x07ERR003\r", "without its number"),
    (ASK, b"\x07\x07", "byte 07"),
    (ASK, b"\x07ERR\x06", "byte 06"),
    (WRITE, b"\x01\0\x03\x40", "isn't a state"),
    (WRITE, b"\x04\0\x03\x80", "isn't a state"),
    (WRITE, b"\x01\0\0\x80", "isn't a state"),
    (WRITE, b"\x01\0\0\0", "isn't a state"),
    (AskControl("\x10"), b"1\x06\r", "control character"),
    (AskControl("\x10"), b"1" * 1401, "control character"),
]


@pytest.mark.parametrize(("request_", "reply", "reason"), VIOLATIONS)
def test_what_is_no_reply_loses_the_connection(request_, reply, reason):
    connection = Connection()
    connection.send(request_, 0.0, 1.0)
    (event,) = connection.receive(reply, 0.1)
    assert isinstance(event, Violation)
    assert reason in event.reason
    assert connection.lost
    assert connection.receive(b"1\r\x06", 0.2) == connection.check(9.0) == connection.close() == ()
    with pytest.raises(ProtocolError, match="lost"):
        connection.send(ASK, 0.3, 1.0)


@pytest.mark.parametrize("reply", [b"1\r\x06x", b"\x06\x06", b"\0\0", b"\x07ERR001\r\x06"])
@pytest.mark.parametrize("cuts", [None, [1, 2, 3, 4, 5, 6, 7, 8]])
def test_more_than_the_reply(reply, cuts):
    events, _ = events_of(ASK, [reply], cuts)
    assert len(events) == 2
    assert events[1] == Violation(None, "unexpected bytes")


def test_bytes_without_a_request():
    assert Connection().receive(b"\x06", 0.0) == (Violation(None, "unexpected bytes"),)


def test_one_request_at_a_time():
    connection = Connection()
    connection.send(ASK, 0.0, 1.0)
    with pytest.raises(ProtocolError, match="in flight"):
        connection.send(ASK, 0.0, 1.0)
    assert connection.receive(b"\x06", 0.0) == (Answer(ASK, ()),)


def test_a_waiting_reply_is_fetched_before_the_next_question():
    connection = Connection()

    def done(request, reply):
        connection.send(request, 0.0, 1.0)
        connection.receive(reply, 0.0)

    for fetch, reply in ((Fetch(), b"1\r\x06"), (Flush(), b"\x40")):
        done(Send("P1"), b"\0")
        done(IsReady(), b"\1\0")
        done(Control("\x01"), b"\0")
        for request in (ASK, Send("P2")):
            with pytest.raises(ProtocolError, match="Fetch"):
                connection.send(request, 0.0, 1.0)
        done(fetch, reply)
        done(ASK, b"\x06")


def test_a_refused_request_leaves_the_connection_usable():
    connection = Connection()
    with pytest.raises(ProtocolError):
        connection.send(Ask(""), 0.0, 1.0)
    assert connection.send(ASK, 0.0, 1.0) == encode(ASK)


@pytest.mark.parametrize(
    "request_",
    [
        Ask(""),
        Ask("P1\r"),
        Ask("P1\x01"),
        Ask("Pé"),
        Ask("X" * 255),
        Send("\0"),
        Write(()),
        Write(("",)),
        Write(("X1\0",)),
        Write(("X" * 200,) * 6),
        AskControl("A"),
        AskControl("\x01"),
        Control("A"),
        Control("\0"),
        Control("\x10"),
        Control(""),
        ReadMemory(0, 0),
        ReadMemory(0, 1401),
        ReadMemory(70000, 1),
        WriteMemory(0, b""),
        WriteMemory(0, bytes(1493)),
    ],
)
def test_requests_that_cannot_be_coded(request_):
    with pytest.raises(ProtocolError):
        encode(request_)


def test_late():
    connection = Connection()
    connection.send(ASK, 10.0, 0.5)
    assert connection.deadline == 10.5
    assert connection.check(10.4) == ()
    assert connection.receive(b"1", 10.45) == ()
    assert connection.check(10.5) == (Late(ASK),)
    assert connection.lost
    assert connection.check(11.0) == connection.receive(b"\r\x06", 11.0) == ()


def test_each_packet_has_its_own_time():
    connection = Connection()
    connection.send(ASK, 0.0, 1.0)
    connection.receive(LONG[:MOST_REPLY], 0.9)
    assert connection.outgoing() == encode(Fetch())
    assert connection.deadline == 1.9


def test_closed_in_the_middle():
    connection = Connection()
    connection.send(WRITE, 0.0, 1.0)
    connection.receive(b"\0\0", 0.1)
    assert connection.close() == (Closed(WRITE),)
    assert connection.lost
    assert Connection().close() == (Closed(None),)


def test_a_stop_goes_out_whatever_is_in_flight():
    connection = Connection()
    connection.send(ASK, 0.0, 1.0)
    assert connection.last_words("\x01") == encode(Control("\x01"))
    assert connection.lost


def test_fitting():
    lines = ["X1.5"] * 1000
    assert fitting(lines) == MOST_LINES // 5
    assert fitting(lines, 990) == 10
    assert fitting(lines, 1000) == 0
    assert fitting(["X" * 254] * 5) == 4
    encode(Write(tuple(lines[: fitting(lines)])))


@given(st.sampled_from(REPLIES), st.binary(max_size=6), st.lists(st.integers(0, 40), max_size=8))
def test_any_chopping_gives_the_same_events(case, more, cuts):
    request, reply, _ = case
    assert events_of(request, [reply + more]) == events_of(request, [reply + more], cuts)


TEXT = st.text(st.characters(min_codepoint=32, max_codepoint=126), max_size=900)


@given(st.lists(TEXT, max_size=9), st.none() | st.integers(1, 22), st.lists(st.integers(0, 9000), max_size=9))
def test_any_text_comes_back(items, error, cuts):
    end = b"\x06" if error is None else b"\x07ERR%03d\r" % error
    packets = packets_of(b"".join(item.encode() + b"\r" for item in items) + end)
    for chopping in (None, cuts):
        events, sent = events_of(ASK, packets, chopping)
        assert events == [Answer(ASK, tuple(items), error)]
        assert len(sent) == len(packets)


REQUESTS = st.sampled_from([request for request, _, _ in REPLIES])


@given(REQUESTS, st.binary(max_size=3000), st.lists(st.integers(0, 3000), max_size=8))
def test_random_bytes(request, data, cuts):
    """Random bytes cause no crash. They give at most one reply, followed by at most one violation, however
    they are split.
    """
    events, _ = events_of(request, [data])
    assert events == events_of(request, [data], cuts)[0]
    assert len(events) <= 2
    assert not any(isinstance(event, Violation) for event in events[:-1])


def test_a_reply_without_end_ends():
    connection = Connection()
    connection.send(ASK, 0.0, 1.0)
    events = ()
    for _ in range(MOST_TEXT // MOST_REPLY + 2):
        events = connection.receive(b"x" * MOST_REPLY, 0.0)
        connection.outgoing()
        if events:
            break
    assert events == (Violation(ASK, "a reply that doesn't end"),)
