"""Faults: their notation, their times, and their repeatability."""

import math
import re

import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.simulator.echo import Echo
from yarclang.simulator.faults import HELD_BACK, Fault, Troubles, When, parse_fault


def troubles(*texts, seed=0):
    machine = Echo()
    return machine, Troubles(machine, [parse_fault(text) for text in texts], seed)


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("drop@12.5", Fault("drop", When(12.5))),
        ("freeze@3:2.0", Fault("freeze", When(3.0), 2.0)),
        ("freeze@3", Fault("freeze", When(3.0), math.inf)),
        ("slow:0.02", Fault("slow", When(), 0.02)),
        ("slow@1.5:.005-.02", Fault("slow", When(1.5), 0.005, 0.02)),
        ("garble:0.001", Fault("garble", When(), share=0.001)),
        ("garble@2:1", Fault("garble", When(2.0), share=1.0)),
        ("busy@4:1", Fault("busy", When(4.0), 1.0)),
        ("busy@4", Fault("busy", When(4.0), math.inf)),
        ("reset@7", Fault("reset", When(7.0))),
        ("reset@line120", Fault("reset", When(lines=120))),
        ("following@5:3", Fault("following", When(5.0), motor=3, counts=HELD_BACK)),
        ("following@5:3,-2500", Fault("following", When(5.0), motor=3, counts=-2500.0)),
        ("limit@5:2+", Fault("limit", When(5.0), motor=2, side=1)),
        ("limit@5:12-", Fault("limit", When(5.0), motor=12, side=-1)),
        (" AMPLIFIER@6:1 ", Fault("amplifier", When(6.0), motor=1)),
    ],
)
def test_syntax(text, fault):
    assert parse_fault(text) == fault


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "KIND@SECONDS"),
        ("@3", "KIND@SECONDS"),
        ("fire@3", "there are drop, freeze"),
        ("drop", "must say when"),
        ("freeze:2", "must say when"),
        ("drop@soon", "isn't a number of seconds"),
        ("drop@1e3", "isn't a number of seconds"),
        ("drop@-1", "isn't a number of seconds"),
        ("drop@line", "isn't a number of seconds"),
        ("drop@3:1", "it is written drop@SECONDS"),
        ("busy@3:soon", "it is written busy@SECONDS or busy@SECONDS:DURATION"),
        ("slow@3", "it is written slow:DELAY"),
        ("slow:0.02-0.01", "larger delay comes second"),
        ("garble:2", "0 to 1"),
        ("limit@5:2", "it is written limit@SECONDS:MOTOR+"),
        ("amplifier@5:0", "motors are 1 to 32"),
        ("amplifier@5:33", "motors are 1 to 32"),
    ],
)
def test_what_is_no_fault(text, reason):
    with pytest.raises(ValueError, match=re.escape(reason)):
        parse_fault(text)


PIECES = st.tuples(
    st.sampled_from(["drop", "freeze", "slow", "garble", "busy", "reset", "limit", "amplifier", "following"]),
    st.sampled_from(["@1", "@0.5", "@line7", "@", "@soon", ""]),
    st.sampled_from(["", ":1", ":0.5", ":0.1-2", ":1+", ":2-", ":3,5", ":33", ":", ":soon"]),
).map("".join)


@exercises(fault=0.01, refused=0.2)
@settings(max_examples=300)
@given(st.text("dropslwgabei@:+-,.0123456789line", max_size=20) | PIECES)
def test_any_text_is_a_fault_or_a_value_error(tally, text):
    try:
        found = parse_fault(text)
    except ValueError:
        found = None
    assert found is None or isinstance(found, Fault)
    tally.count("fault", found is not None)
    tally.count("refused", found is None)


def test_machine_faults_come_at_their_exact_time():
    machine, trouble = troubles("amplifier@0.25:1", "limit@0.1:2-", "following@0.1:3", "reset@2")
    trouble.advance(1.0)
    assert machine.done == [
        (0.1, "limit", 2, -1, True),
        (0.1, "following", 3, HELD_BACK),
        (0.25, "amplifier", 1),
    ]
    assert machine.now == 1.0
    trouble.advance(0.5)
    assert len(machine.done) == 3
    trouble.advance(0.5)
    trouble.advance(0.5)
    assert machine.done[3:] == [(2.0, "reset")]


def test_faults_are_told_as_they_were_written():
    told = []
    machine = Echo()
    faults = [parse_fault(text) for text in ("Limit@0.5:2-", "slow:0.1", "drop@line3")]
    trouble = Troubles(machine, faults, tell=lambda text: told.append((machine.now, text)))
    trouble.advance(1.0)
    trouble.lines_written(3)
    assert told == [(0.0, "fault slow:0.1"), (0.5, "fault Limit@0.5:2-"), (1.0, "fault drop@line3")]


def test_faults_by_lines():
    machine, trouble = troubles("amplifier@line10:1", "drop@line20")
    trouble.lines_written(9)
    assert machine.done == []
    trouble.lines_written(5)
    assert machine.done == [(0.0, "amplifier", 1)]
    assert not trouble.dropped()
    trouble.lines_written(6)
    assert trouble.dropped()
    assert not trouble.dropped()


def test_drop_at_its_time():
    _, trouble = troubles("drop@1", "drop@2")
    trouble.advance(0.9)
    assert not trouble.dropped()
    trouble.advance(0.2)
    assert trouble.dropped()
    trouble.advance(0.2)
    assert not trouble.dropped()
    trouble.advance(2.0)
    assert trouble.dropped()


def test_freeze_and_busy_last():
    _, trouble = troubles("freeze@1:0.5", "busy@1:1")
    seen = []
    for seconds in (0.9, 0.1, 0.4, 0.1, 0.4, 0.2):
        trouble.advance(seconds)
        seen.append((trouble.frozen, trouble.busy))
    no, yes = False, True
    assert seen == [(no, no), (yes, yes), (yes, yes), (no, yes), (no, yes), (no, no)]


def test_freeze_for_ever():
    _, trouble = troubles("freeze@1")
    trouble.advance(1e6)
    assert trouble.frozen


def test_slow_replies():
    _, trouble = troubles("slow:0.005-0.02", "slow@1:1")
    delays = [trouble.spoil(b"\x06")[1] for _ in range(500)]
    assert 0.005 <= min(delays) < 0.006
    assert 0.019 < max(delays) < 0.02
    trouble.advance(1.0)
    assert trouble.spoil(b"\x06")[1] > 1.005
    assert trouble.spoil(b"") == (b"", 0.0)


def test_garbled_replies():
    reply = b"1234.5\r\x06"
    _, trouble = troubles("garble:0.1")
    spoiled = [trouble.spoil(reply)[0] for _ in range(5000)]
    wrong = [one for one in spoiled if one != reply]
    assert 400 < len(wrong) < 600
    assert all(sum(a != b for a, b in zip(one, reply, strict=True)) == 1 for one in wrong)
    places = {[a == b for a, b in zip(one, reply, strict=True)].index(False) for one in wrong}
    assert places == set(range(len(reply)))


def test_the_seed_decides():
    def replies(seed):
        _, trouble = troubles("garble:0.5", "slow:0-1", seed=seed)
        return [trouble.spoil(b"1234.5\r\x06") for _ in range(50)]

    assert replies(1) == replies(1)
    assert replies(1) != replies(2)


def test_no_faults_cost_nothing():
    machine, trouble = troubles()
    trouble.advance(0.5)
    assert machine.advanced == [0.5]
    assert trouble.spoil(b"x") == (b"x", 0.0)
    assert not trouble.frozen
