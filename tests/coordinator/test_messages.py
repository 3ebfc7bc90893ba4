"""Tests of messages and their lines: round trips, and arbitrary other input."""

import json

import pytest
from floors import exercises
from hypothesis import example, given
from hypothesis import strategies as st

from yarclang.cli.ordering import fulfilled
from yarclang.coordinator.messages import events, orders, replies, wants
from yarclang.coordinator.messages.findings import finding_message, finding_of
from yarclang.coordinator.messages.lines import (
    MOST_LINE,
    name_of,
    read_answer,
    read_event,
    read_object,
    read_order,
    write_answer,
    write_event,
    write_order,
)
from yarclang.coordinator.messages.orders import Order
from yarclang.coordinator.messages.replies import Denied
from yarclang.diagnostics import Diagnostic, Edit, Fix
from yarclang.report.finding import finding_text
from yarclang.runtime.state import State
from yarclang.source import SourceFile, Span

numbers = st.floats(-1e9, 1e9)
ORDERS = st.one_of(
    [
        st.builds(
            kind,
            **{
                name: st.from_type(field.annotation)
                for name, field in kind.model_fields.items()
                if name
                not in (
                    "order",
                    "percent",
                    "speed",
                    "times",
                    "value",
                    "start",
                    "tolerance",
                    "tm",
                    "name",
                    "samples",
                )
                and name
                not in (
                    "base",
                    "moving",
                    "to",
                    "title",
                    "version",
                    "joints",
                    "rate",
                    "pose",
                    "velocity",
                    "twist",
                    "share",
                )
            },
        )
        for kind in (*orders.KINDS, wants.Finish)
        if kind
        not in (
            orders.Override,
            orders.SetOutput,
            orders.SetInput,
            orders.Give,
            orders.Read,
            orders.Home,
            orders.SendSettings,
            orders.Fill,
        )
    ]
    + [
        st.builds(orders.Override, percent=st.floats(1.0, 100.0)),
        st.builds(orders.SetOutput, name=st.text(max_size=9), value=numbers | st.sampled_from(["ON", "OFF"])),
        st.builds(orders.SetInput, name=st.text(max_size=9), value=numbers | st.sampled_from(["ON", "OFF"])),
        st.builds(
            orders.Fill,
            values=st.dictionaries(
                st.text(max_size=9),
                st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
            ),
            number=st.none() | st.integers(),
        ),
        st.builds(orders.Steer, share=st.floats(0.0, 1.0, exclude_min=True)),
        st.builds(orders.Home, motors=st.lists(st.integers(1, 32), min_size=1, max_size=9).map(tuple)),
        st.builds(orders.SendSettings, known=st.text(max_size=64)),
        st.builds(orders.Give, to=st.text(max_size=9)),
        st.builds(orders.AskCourse, program=st.integers(), samples=st.integers(2, 2000)),
        st.builds(orders.Run, program=st.integers(), times=st.none() | st.integers(1)),
        st.builds(wants.BeThere, joints=st.lists(numbers, max_size=7).map(tuple)),
        st.builds(wants.HoldPose, pose=st.tuples(*[numbers] * 6)),
        st.builds(wants.MoveTool, twist=st.tuples(*[numbers] * 6), axes=st.sampled_from(["base", "tool"])),
        st.builds(
            wants.MoveJoints, velocity=st.dictionaries(st.text(max_size=4), numbers, min_size=1, max_size=4)
        ),
    ]
)
"""Any order. Values that the types alone don't limit are given."""

STATUS = replies.Status(
    program="a.yarc",
    robot="INDUSTRIAL6",
    controller="127.0.0.1:1025",
    state=State.MOVE,
    why="",
    command=replies.Command(title="P0010 MOVEJ", line=2),
    done=1.0,
    left=2.0,
    override=100.0,
    joints=(replies.Joint(name="J1", position=None, unit="deg"),),
    waiting=0,
    pid=1,
    since="today",
)
ANSWERS = [
    Denied(error="no", help="why", code="Y1611"),
    replies.Done(),
    replies.Taken(state=State.HOLD),
    STATUS,
    replies.Ended(well=False, what="stopped", state=State.STOP, joints={"J1": 1.5}),
    replies.Wanted(lag_s=0.35, behind=None, why=""),
]
EVENTS = [
    events.StateChanged(time_s=1.0, state=State.MOVE, why=""),
    events.Position(time_s=1.0, joints={"J1": 1.0}, done_s=0.5),
    events.PartBegan(
        time_s=0.0, name="p", to_the_start=False, offset_s=0.0, duration_s=1.0, number=1, of=None
    ),
    events.Missed(time_s=0.0, count=3),
]
anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)
keys = st.sampled_from(
    ["order", "percent", "ok", "error", "state", "program", "joints", "id", "name", "text"]
)
near = st.dictionaries(
    keys, anything | st.sampled_from(["hold", "override", True, 50, "move", "offer", "hello"])
)


@given(ORDERS, st.none() | st.integers() | st.text(max_size=5))
def test_orders_come_back(order, id_):
    line = write_order(order, id_)
    assert line.count(b"\n") == 1
    assert line.endswith(b"\n")
    read = read_order(line)
    assert (read.what, read.id, read.ends) == (order, id_, False)


def test_every_order_has_a_word_an_answer_and_a_description():
    every = (*orders.KINDS, *wants.KINDS)
    assert all(kind.answer is not replies.Reply for kind in every)
    assert all(kind.__doc__ for kind in every)
    words = [
        kind.model_fields["order"].default if "order" in kind.model_fields else kind.key for kind in every
    ]
    assert len(set(words)) == len(words)
    bare = [
        f"{word}.{name}"
        for word, kind in zip(words, every, strict=True)
        for name, field in kind.model_fields.items()
        if name != "order" and not field.description
    ]
    assert bare == []  # each field needs a description, because error messages contain it


@pytest.mark.parametrize("answer", ANSWERS, ids=lambda one: type(one).__name__)
def test_answers_come_back(answer):
    content = read_object(write_answer(answer, 7))
    assert content["id"] == 7
    assert read_answer(content, type(answer)) == answer


@pytest.mark.parametrize("event", EVENTS, ids=lambda one: type(one).__name__)
def test_events_come_back(event):
    assert read_event(read_object(write_event(event))) == event
    assert read_event({"event": "something new", "time_s": 1.0}) is None


def test_a_finding_comes_back_as_people_see_it():
    source = SourceFile("p.yarc", "ROBOT X\nP0010 MOVE 1\nP0020 STOP\n")
    fix = Fix("write MOVEJ", (Edit(Span.on_line(2, 7, 11), "MOVEJ"),))
    one = Diagnostic(
        "Y0202", "MOVE is no command", source, Span.on_line(2, 7, 11), "did you mean MOVEJ?", fix
    )
    back = finding_of(finding_message(one))
    assert finding_text(back) == finding_text(one)
    assert back.fix == fix
    placeless = Diagnostic("Y0107", "a file can't be written")
    assert finding_text(finding_of(finding_message(placeless))) == finding_text(placeless)


@exercises(order=0.0, garbage=0.1)
@given(
    st.binary(max_size=200)
    | anything.map(lambda value: json.dumps(value).encode())
    | near.map(lambda value: json.dumps(value).encode())
    | ORDERS.map(write_order)
)
@example(b"")
@example(b"\n")
@example(b"[" * 60_000)
@example(b'{"order":' * 5000)
@example(b"9" * 5000)
@example(b"\xff\xfe\x00")
@example(b'{"order": "\\ud800"}')
@example(b'{"order": "hello", "name": "\\ud800"}')
@example(b'{"order": "go", "offer": 1e999}')
@example(b'{"id": [1], "order": "hold"}')
def test_garbage_is_one_clear_error(tally, line):
    what = read_order(line).what
    tally.count("order", not isinstance(what, Denied))
    tally.count("garbage", isinstance(what, Denied))
    if isinstance(what, Denied):
        assert 0 < len(what.error) < 500
        assert "\n" not in what.error
        assert read_answer(read_object(write_answer(what)), replies.Done) == what
    else:
        assert read_order(write_order(what)).what == what
        assert name_of(what)
    content = read_object(line)
    if isinstance(content, dict):
        assert isinstance(read_answer(content, replies.Status), replies.Status | Denied)
        read_event(content)


@pytest.mark.parametrize(
    ("line", "error"),
    [
        (b"hold\n", '"hold" isn\'t JSON'),
        (b"[1, 2]\n", "a list isn't a JSON object"),
        (b"null\n", "null isn't a JSON object"),
        (b"{}\n", 'there is no "order"; it may be hello, status, hold'),
        (b'{"order": "jump"}\n', '"order" is "jump"; it may be hello'),
        (b'{"order": ["hold"]}\n', '"order" is a list'),
        (b'{"order": "stop", "abort": true}\n', 'stop has no field "abort"'),
        (b'{"order": "override"}\n', 'override needs "percent"'),
        (b'{"order": "override", "percent": 0}\n', "from 1 to 100"),
        (b'{"order": "override", "percent": 100.5}\n', "from 1 to 100"),
        (b'{"order": "override", "percent": true}\n', "from 1 to 100"),
        (b'{"order": "override", "percent": "50"}\n', "from 1 to 100"),
        (b'{"order": "override", "percent": NaN}\n', "from 1 to 100"),
        (b'{"order": "hello", "version": 2, "colour": "red"}\n', "version 2 of the protocol isn't supported"),
        (b'{"order": "hello", "version": "1"}\n', "isn't supported; this is version 1"),
        (b'{"order": "go"}\n', 'go needs "offer", the number of an offer'),
        (b'{"id": {}, "order": "hold"}\n', '"id" is an object'),
        (b'{"order": "' + b"x" * 1000 + b'"}\n', 'x..."'),
        (b" " * MOST_LINE + b"\n", "longer than 4 MiB"),
    ],
)
def test_what_is_wrong_is_said(line, error):
    what = read_order(line).what
    assert isinstance(what, Denied)
    assert error in what.error


def test_an_answer_of_another_version_is_said():
    assert "another version" in read_answer({"ok": True}, replies.Status).error
    assert "another version" in read_answer({"ok": True, "program": "a"}, replies.Status).error
    assert read_answer({"ok": False, "error": "no"}, replies.Status) == Denied(error="no")


def status_in(state, waiting=0, override=100.0):
    return {"state": state, "waiting": waiting, "override": override}


def test_when_an_order_is_fulfilled():
    assert not fulfilled("hold", status_in("move"))
    assert not fulfilled("hold", status_in("init", 1))
    assert fulfilled("hold", status_in("hold"))
    assert fulfilled("hold", status_in("stop", 1))  # nothing moves, so there is nothing to hold
    assert not fulfilled("resume", status_in("hold"))
    assert not fulfilled("resume", status_in("stop", 1))
    assert fulfilled("resume", status_in("move"))
    for stop in ("stop", "abort"):
        assert not fulfilled(stop, status_in("hold"))
        assert not fulfilled(stop, status_in("disconnected"))
        assert not fulfilled(stop, status_in("stop", 1))  # the controller is still being inspected
        assert fulfilled(stop, status_in("stop"))
        assert fulfilled(stop, status_in("fault"))
    assert not fulfilled("override", status_in("move"), percent=50.0)
    assert fulfilled("override", status_in("move", override=50.0), percent=50.0)
    assert fulfilled("status", status_in("move"))


def test_messages_never_change():
    with pytest.raises(ValueError, match="frozen"):
        orders.Hold().order = "stop"
    assert isinstance(orders.Hold(), Order)
