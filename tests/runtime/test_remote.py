"""Requests and replies between terminals and a run, as lines: round trips, and whatever else may come."""

import json

import numpy as np
import pytest
from floors import exercises
from hypothesis import example, given
from hypothesis import strategies as st

from yarclang.robot.actuation import to_counts
from yarclang.runtime.feedback import Sample
from yarclang.runtime.notices import Abort, Hold, Override, Progress, Remark, Resume, Stop
from yarclang.runtime.operation import Operation
from yarclang.runtime.remote import (
    MOST_LINE,
    TOO_LONG,
    About,
    AskStatus,
    Command,
    Denied,
    Joint,
    Status,
    Step,
    Taken,
    Watch,
    as_json,
    fulfilled,
    order_in,
    read_reply,
    read_request,
    write_reply,
    write_request,
)
from yarclang.runtime.state import Event, State

REQUESTS = [Hold(), Resume(), Stop(), Abort(), Override(50.0), Override(12.5), Step(), AskStatus()]

numbers = st.floats(allow_nan=False, allow_infinity=False)
statuses = st.builds(
    Status,
    program=st.text(),
    robot=st.text(),
    controller=st.text(),
    state=st.sampled_from(State),
    why=st.text(),
    command=st.none() | st.builds(Command, st.text(), st.integers()),
    done=numbers,
    left=numbers,
    override=numbers,
    joints=st.lists(st.builds(Joint, st.text(), st.none() | numbers, st.sampled_from(["deg", "mm"]))).map(
        tuple
    ),
    waiting=st.integers(0),
    pid=st.integers(0),
    since=st.text(),
)
anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)
keys = st.sampled_from(["order", "percent", "ok", "error", "state", "program", "joints", "command"])
near = st.dictionaries(keys, anything | st.sampled_from(["hold", "override", True, 50, "move"]))
orders = st.sampled_from(REQUESTS).map(lambda one: json.loads(write_request(one))) | st.builds(
    lambda percent: {"order": "override", "percent": percent}, st.floats(0, 200) | anything
)


@pytest.mark.parametrize("request_", REQUESTS, ids=repr)
def test_requests_come_back(request_):
    line = write_request(request_)
    assert line.count(b"\n") == 1
    assert line.endswith(b"\n")
    assert read_request(line) == request_


@given(statuses | st.builds(Taken, st.sampled_from(State)) | st.builds(Denied, st.text()))
def test_replies_come_back(reply):
    line = write_reply(reply)
    assert line.count(b"\n") == 1
    assert read_reply(line) == reply


@exercises(request=0.0, garbage=0.1)
@given(
    st.binary(max_size=200)
    | anything.map(lambda value: json.dumps(value).encode())
    | near.map(lambda value: json.dumps(value).encode())
    | orders.map(lambda value: json.dumps(value).encode())
)
@example(b"")
@example(b"\n")
@example(b"[" * 60_000)
@example(b'{"order":' * 5000)
@example(b"9" * 5000)
@example(b"\xff\xfe\x00")
@example(b'{"order": "\\ud800"}')
@example(b'{"ok": true, "program": 1, "joints": [1e999]}')
@example(b'{"ok": true, "state": "move"}')
def test_garbage_is_one_clear_error(tally, line):
    request = read_request(line)
    tally.count("request", not isinstance(request, Denied))
    tally.count("garbage", isinstance(request, Denied))
    if isinstance(request, Denied):
        assert 0 < len(request.error) < 300
        assert "\n" not in request.error
        assert read_reply(write_reply(request)) == request
    else:
        assert read_request(write_request(request)) == request
    assert isinstance(read_reply(line), Taken | Status | Denied)


@pytest.mark.parametrize(
    ("line", "error"),
    [
        (b"hold\n", '"hold" isn\'t JSON'),
        (b"[1, 2]\n", "a list isn't a JSON object"),
        (b"null\n", "null isn't a JSON object"),
        (b"{}\n", '"order" is null; it may be hold, resume, step, stop, abort, status, override'),
        (b'{"order": "jump"}\n', '"order" is "jump"'),
        (b'{"order": ["hold"]}\n', '"order" is a list'),
        (b'{"order": "stop", "abort": true}\n', 'stop takes no "abort"'),
        (b'{"order": "override"}\n', 'override needs "percent"'),
        (b'{"order": "override", "percent": 0}\n', "from 1 to 100"),
        (b'{"order": "override", "percent": 100.5}\n', "from 1 to 100"),
        (b'{"order": "override", "percent": true}\n', "from 1 to 100"),
        (b'{"order": "override", "percent": "50"}\n', "from 1 to 100"),
        (b'{"order": "override", "percent": NaN}\n', "from 1 to 100"),
        (b'{"order": "' + b"x" * 1000 + b'"}\n', 'x..."'),
        (b" " * MOST_LINE + b"\n", TOO_LONG.error),
    ],
)
def test_what_is_wrong_is_said(line, error):
    request = read_request(line)
    assert isinstance(request, Denied)
    assert error in request.error


def test_a_reply_of_another_version_is_said():
    assert "another version" in read_reply(b'{"ok": true}').error
    assert "another version" in read_reply(b'{"ok": true, "program": "a"}').error
    assert read_reply(b'{"ok": false, "error": "no"}') == Denied("no")


def operation_in(state, *orders):
    operation = Operation()
    operation.state = state
    operation.orders.extend(orders)
    return operation


def test_orders_of_requests():
    assert order_in(Hold(), operation_in(State.MOVE)) == Hold()
    assert order_in(Stop(), operation_in(State.FAULT)) == Stop()
    assert order_in(Step(), operation_in(State.STOP)) == Resume()
    assert order_in(Resume(), operation_in(State.HOLD)) == Resume()
    assert order_in(Resume(), operation_in(State.MOVE, Hold())) == Resume()
    for request in (Resume(), Step()):
        assert "nothing to resume" in order_in(request, operation_in(State.MOVE)).error
    assert isinstance(order_in(AskStatus(), operation_in(State.MOVE)), Denied)


def status_in(state, waiting=0, override=100.0):
    return Status("p", "r", "c", state, "", None, 0.0, 0.0, override, (), waiting, 1, "")


def test_when_an_order_is_fulfilled():
    assert not fulfilled(Hold(), status_in(State.MOVE))
    assert not fulfilled(Hold(), status_in(State.INIT, 1))
    assert fulfilled(Hold(), status_in(State.HOLD))
    assert fulfilled(Hold(), status_in(State.STOP, 1))  # nothing moves
    assert not fulfilled(Resume(), status_in(State.HOLD))
    assert not fulfilled(Resume(), status_in(State.STOP, 1))
    assert fulfilled(Resume(), status_in(State.MOVE))
    for stop in (Stop(), Abort()):
        assert not fulfilled(stop, status_in(State.HOLD))
        assert not fulfilled(stop, status_in(State.DISCONNECTED))
        assert not fulfilled(stop, status_in(State.STOP, 1))  # it looks at the controller still
        assert fulfilled(stop, status_in(State.STOP))
        assert fulfilled(stop, status_in(State.FAULT))
    assert not fulfilled(Override(50.0), status_in(State.MOVE))
    assert fulfilled(Override(50.0), status_in(State.MOVE, override=50.0))
    assert fulfilled(AskStatus(), status_in(State.MOVE))


def test_a_watch_knows_what_it_has_heard(industrial6):
    watch, operation, about = Watch(), Operation(), About("a.yarc", industrial6)

    def status():
        return watch.status(operation, about, "host:1025", 4711, "today")

    fresh = status()
    assert (fresh.program, fresh.robot, fresh.controller) == ("a.yarc", "INDUSTRIAL6", "host:1025")
    assert (fresh.pid, fresh.since, fresh.state, fresh.command) == (4711, "today", State.DISCONNECTED, None)
    assert [joint.position for joint in fresh.joints] == [None] * 6
    assert [joint.unit for joint in fresh.joints] == ["deg"] * 6
    assert read_reply(write_reply(fresh)) == fresh

    joints = np.radians([10, -20, 30, 40, 50, 60])
    counts = to_counts(industrial6, joints)
    for event in (Event.CONNECTED, Event.LOAD, Event.BEGIN):
        operation.go(event)
    operation.go(Event.HOLD, "a hold was asked for")
    operation.notices.append(Progress(1.0, 2.0, 3.0, "P0010 MOVEJ", 7))
    operation.notices.append(Sample(1.0, 2.0, counts, np.zeros(6)))
    operation.notices.append(Remark(1.0, "something"))
    operation.override = 0.4
    operation.orders.append(Resume())
    for notice in operation.notices:
        watch.hear(notice)
    now = status()
    assert (now.state, now.why, now.waiting) == (State.HOLD, "a hold was asked for", 1)
    assert (now.done, now.left, now.override) == (2.0, 3.0, 40.0)
    assert now.command == Command("P0010 MOVEJ", 7)
    assert [joint.position for joint in now.joints] == pytest.approx([10, -20, 30, 40, 50, 60], abs=1e-5)
    assert as_json(now)["state"] == "hold"
    assert json.loads(json.dumps(as_json(now)))["command"] == {"title": "P0010 MOVEJ", "line": 7}
