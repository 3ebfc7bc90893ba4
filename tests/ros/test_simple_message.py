"""The codec, tested with frames of the unmodified C++ nodes, and with any streams.

The frames in `simple_message_vectors.json` were exchanged between the client nodes of
ros-industrial/industrial_core 0.7.3 (commit 2b7ef65) and a toy controller; its "about" describes how.
"""

import json
import struct
from dataclasses import asdict
from itertools import pairwise
from pathlib import Path

import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.ros.simple_message import (
    MOST,
    ByteOrder,
    Code,
    Comm,
    Decoder,
    FrameError,
    FullPoint,
    JointFeedback,
    JointPosition,
    Message,
    Other,
    Ping,
    RobotStatus,
    TrajectoryPoint,
    encode,
    reply_to,
)

VECTORS = json.loads((Path(__file__).parent / "simple_message_vectors.json").read_text())["vectors"]
ORDERS = {"little": ByteOrder.LITTLE, "big": ByteOrder.BIG}
NAMES = {"robot_id": "robot", "valid_fields": "valid"}
KINDS = {10: JointPosition, 11: TrajectoryPoint, 13: RobotStatus, 14: FullPoint, 15: JointFeedback, 1: Ping}


def single(value):
    return struct.unpack("f", struct.pack("f", value))[0]


def wanted(vector):
    """Return the message that a frame's fields describe."""
    fields = dict(vector["fields"])
    comm, code, kind = Comm(fields.pop("comm_type")), Code(fields.pop("reply_code")), fields.pop("msg_type")
    fields.pop("length")
    made = {}
    for name, value in fields.items():
        rounded = single(value) if isinstance(value, float) else value
        made[NAMES.get(name, name)] = tuple(map(single, value)) if isinstance(value, list) else rounded
    return Message(comm, KINDS[kind](**made), code)


def test_there_are_vectors_of_both_orders():
    assert len(VECTORS) == 40
    assert {one["byte_order"] for one in VECTORS} == {"little", "big"}


@pytest.mark.parametrize("vector", VECTORS, ids=lambda one: one["name"])
def test_a_frame_is_read_and_written(vector):
    frame, order = bytes.fromhex(vector["hex"]), ORDERS[vector["byte_order"]]
    assert list(Decoder(order).feed(frame)) == [wanted(vector)]
    assert encode(wanted(vector), order) == frame


@pytest.mark.parametrize("vector", VECTORS, ids=lambda one: one["name"])
def test_a_frame_is_read_byte_by_byte(vector):
    frame, decoder = bytes.fromhex(vector["hex"]), Decoder(ORDERS[vector["byte_order"]])
    found = [list(decoder.feed(frame[place : place + 1])) for place in range(len(frame))]
    assert found[:-1] == [[]] * (len(frame) - 1)
    assert found[-1] == [wanted(vector)]
    assert decoder.waiting == 0


@pytest.mark.parametrize("name", ORDERS)
def test_glued_frames_are_read(name):
    vectors = [one for one in VECTORS if one["byte_order"] == name]
    stream = b"".join(bytes.fromhex(one["hex"]) for one in vectors)
    assert list(Decoder(ORDERS[name]).feed(stream)) == [*map(wanted, vectors)]


@exercises(cut=0.3)
@settings(max_examples=60, deadline=None)
@given(data=st.data(), name=st.sampled_from(sorted(ORDERS)))
def test_a_stream_is_read_however_it_is_cut(tally, data, name):
    known = [one for one in VECTORS if one["byte_order"] == name]
    vectors = data.draw(st.lists(st.sampled_from(known), max_size=8))
    stream = b"".join(bytes.fromhex(one["hex"]) for one in vectors)
    cuts = sorted(data.draw(st.lists(st.integers(0, len(stream)), max_size=12)))
    decoder, found, halves = Decoder(ORDERS[name]), [], 0
    for begin, end in pairwise([0, *cuts, len(stream)]):
        found += decoder.feed(stream[begin:end])
        halves += bool(decoder.waiting)
    assert found == [*map(wanted, vectors)]
    tally.count("cut", reached=halves > 0)


def test_a_length_of_a_gigabyte_isnt_waited_for():
    decoder = Decoder()
    with pytest.raises(FrameError, match="a length of 1000000000 bytes"):
        list(decoder.feed(struct.pack("<i", 10**9)))


@pytest.mark.parametrize("length", [-1, 0, 11, MOST + 1, 2**31 - 1])
def test_a_length_that_cant_be_is_an_error(length):
    with pytest.raises(FrameError):
        list(Decoder().feed(struct.pack("<i", length)))


@pytest.mark.parametrize("order", ByteOrder)
def test_the_other_order_is_told(order):
    frame = encode(Message(Comm.REQUEST, TrajectoryPoint(0)), order)
    with pytest.raises(FrameError, match="--swap-bytes"):
        list(Decoder(order.other).feed(frame))


def test_good_frames_before_garbage_are_read():
    good = encode(Message(Comm.REQUEST, TrajectoryPoint(-4)))
    found = Decoder().feed(good + b"GET / HTTP/1.1\r\n\r\n")
    assert next(found).body.sequence == -4
    with pytest.raises(FrameError):
        next(found)


@pytest.mark.parametrize(
    ("head", "text"),
    [
        ((12, 1, 0, 0), "neither topic"),
        ((12, 1, 4, 0), "neither topic"),
        ((12, 1, 2, 1), "reply code 1"),
        ((12, 1, 3, 0), "reply code 0"),
        ((12, 1, 3, 3), "reply code 3"),
        ((16, 1, 2, 0), "has 4 bytes, 0 are wanted"),
    ],
)
def test_a_header_that_cant_be_is_an_error(head, text):
    with pytest.raises(FrameError, match=text):
        list(Decoder().feed(struct.pack("<4i", *head) + bytes(max(0, head[0] - 12))))


def test_reals_of_eight_bytes_are_told():
    frame = struct.pack("<4i", 112, 11, 2, 0) + bytes(100)
    with pytest.raises(FrameError, match="FLOAT64"):
        list(Decoder().feed(frame))


def test_other_kinds_pass():
    message = Message(Comm.REQUEST, Other(2001, b"12345678"))
    assert list(Decoder().feed(encode(message))) == [message]
    assert reply_to(message, success=False).code is Code.FAILURE


@settings(max_examples=150, deadline=None)
@given(st.lists(st.binary(max_size=200), max_size=10), st.sampled_from(list(ByteOrder)))
def test_garbage_keeps_the_decoder_small(pieces, order):
    decoder = Decoder(order)
    for piece in pieces:
        try:
            list(decoder.feed(piece))
        except FrameError:
            return
        assert decoder.waiting <= MOST + 4


full = st.tuples(*[st.floats(width=32, allow_nan=False)] * 10)


@given(full, full, full, st.floats(width=32, allow_nan=False), st.sampled_from(list(ByteOrder)))
@settings(max_examples=60, deadline=None)
def test_what_is_written_is_read(one, other, third, time, order):
    for body in (
        FullPoint(0, 3, 15, time, one, other, third),
        JointFeedback(0, 7, time, one, other, third),
        JointPosition(one),
    ):
        message = Message(Comm.TOPIC, body)
        (found,) = Decoder(order).feed(encode(message, order))
        assert asdict(found.body) == asdict(body)
