"""Tests of event streams: their length is limited, only the newest position is stored, and dropped events are
counted.
"""

from hypothesis import given
from hypothesis import strategies as st

from yarclang.coordinator.mailbox import Mailbox
from yarclang.coordinator.messages.events import Missed, Position, Told
from yarclang.runtime.state import State

EVENTS = st.lists(st.sampled_from("mpt"), max_size=60)


@given(EVENTS, st.integers(4, 12))
def test_nothing_is_lost_without_being_told(kinds, capacity):
    box, put, taken = Mailbox(capacity), 0, []
    for number, kind in enumerate(kinds):
        if kind == "m":
            box.put(Told(time_s=float(number), text=str(number)))
            put += 1
        elif kind == "p":
            box.put(Position(time_s=float(number), joints={}, done_s=0.0))
        elif (event := box.take()) is not None:
            taken.append(event)
        assert len(box) <= capacity + 1
    while (event := box.take()) is not None:
        taken.append(event)
    messages = [one for one in taken if isinstance(one, Told)]
    missed = sum(one.count for one in taken if isinstance(one, Missed))
    assert len(messages) + missed == put
    times = [one.time_s for one in taken if not isinstance(one, Missed)]
    assert times == sorted(times)


def test_only_the_newest_position_waits():
    box = Mailbox(8)
    for number in range(1000):
        box.put(Position(time_s=float(number), joints={}, done_s=0.0))
    assert box.take().time_s == 999.0
    assert box.take() is None


def test_states_have_names():
    assert {state.value for state in State} >= {"stop", "move", "hold", "fault"}
