"""Tests of the transition table: a stop is allowed in all states, each state can be reached and left, and no
other transition is possible.
"""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from yarclang.runtime.pmac.operation import Operation
from yarclang.runtime.state import TRANSITIONS, Event, State, TransitionError, after

LEGAL = {(state, event) for state, events in TRANSITIONS.items() for event in events}


def reached_from(state):
    """Return all states that can be reached from a state."""
    found = {state}
    while more := {after(at, event) for at, event in LEGAL if at in found} - found:
        found |= more
    return found


@pytest.mark.parametrize("state", State)
def test_stop_fault_and_loss_are_legal_in_every_state(state):
    assert after(state, Event.STOP) in (State.STOP, State.FAULT, State.DISCONNECTED)
    assert after(state, Event.FAULT) is State.FAULT
    assert after(state, Event.LOST) in (State.DISCONNECTED, State.FAULT)


@pytest.mark.parametrize("state", State)
def test_a_stop_never_leads_to_motion(state):
    assert after(state, Event.STOP) not in (State.INIT, State.MOVE, State.HOLD)


def test_what_the_table_does_not_have_is_an_error():
    for state, event in itertools.product(State, Event):
        if (state, event) in LEGAL:
            assert after(state, event) is TRANSITIONS[state][event]
        else:
            with pytest.raises(TransitionError, match=f"{event.value} in state {state.value}"):
                after(state, event)


def test_the_table_cannot_be_changed():
    with pytest.raises(TypeError):
        TRANSITIONS[State.STOP] = {}


@pytest.mark.parametrize("state", State)
def test_every_state_is_reached_and_leads_back_to_stop(state):
    assert state in reached_from(State.DISCONNECTED)
    assert State.STOP in reached_from(state)


def test_each_event_leads_somewhere():
    assert {event for _, event in LEGAL} == set(Event)


def test_motion_begins_only_behind_a_load_and_a_fault_must_be_cleared():
    assert [state for state, event in LEGAL if after(state, event) is State.INIT] == [State.STOP]
    into_motion = {(state, event) for state, event in LEGAL if after(state, event) is State.MOVE}
    assert into_motion == {(State.INIT, Event.BEGIN), (State.HOLD, Event.RESUME)}
    assert [event for event in Event if after_or_none(State.FAULT, event) is State.STOP] == [Event.CLEAR]


def after_or_none(state, event):
    return after(state, event) if (state, event) in LEGAL else None


@given(st.lists(st.sampled_from(Event)))
def test_an_operation_follows_the_table_and_tells_each_change(events):
    operation = Operation()
    state, told = operation.state, []
    for event in events:
        if (state, event) not in LEGAL:
            with pytest.raises(TransitionError):
                operation.go(event)
        else:
            operation.go(event)
            if (then := after(state, event)) is not state:
                told.append(then)
            state = then
        assert operation.state is state
    assert [notice.state for notice in operation.notices] == told
