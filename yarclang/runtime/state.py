"""States of a run, and the events that change them (Fig. 2 of the paper, with Hold, Fault and
Disconnected).
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from types import MappingProxyType


class State(Enum):
    """The state of the robot in a run; the value is the text for people."""

    DISCONNECTED = "disconnected"
    """No connection. The controller works without this process; if the buffer gets no more lines, the
    controller's guard holds the motion.
    """
    STOP = "stop"
    """Connected, without a motion of this process: the controller is being inspected, or is idle."""
    INIT = "init"
    """The controller receives the first lines of a program; nothing moves."""
    MOVE = "move"
    """The controller executes streamed lines."""
    HOLD = "hold"
    """Held on the path; the motion can continue."""
    FAULT = "fault"
    """Something went wrong: the program is ended, and nothing moves before a person has looked at the
    robot.
    """


class Event(Enum):
    """Event that changes the state of a run."""

    CONNECTED = "connected"
    LOAD = "load"
    """All checks have passed, and the program is loaded."""
    BEGIN = "begin"
    """R was sent."""
    HOLD = "hold"
    """A person orders a hold, or the buffer runs low."""
    RESUME = "resume"
    END = "end"
    """All motions have ended, and the robot stands where the program ends."""
    STOP = "stop"
    """A person ends the program, on the path or by an abort."""
    FAULT = "fault"
    LOST = "lost"
    """The connection is lost."""
    CLEAR = "clear"
    """A fault was inspected and cleared."""


_S, _E = State, Event

TRANSITIONS: Mapping[State, Mapping[Event, State]] = MappingProxyType(
    {
        _S.DISCONNECTED: {
            _E.CONNECTED: _S.STOP,
            _E.STOP: _S.DISCONNECTED,
            _E.FAULT: _S.FAULT,
            _E.LOST: _S.DISCONNECTED,
        },
        _S.STOP: {
            _E.LOAD: _S.INIT,
            _E.HOLD: _S.HOLD,  # at a barrier, where the robot waits for an input or the operator
            _E.STOP: _S.STOP,
            _E.FAULT: _S.FAULT,
            _E.LOST: _S.DISCONNECTED,
        },
        _S.INIT: {
            _E.BEGIN: _S.MOVE,
            _E.HOLD: _S.HOLD,  # an input that the program watches holds the motion
            _E.STOP: _S.STOP,
            _E.FAULT: _S.FAULT,
            _E.LOST: _S.DISCONNECTED,
        },
        _S.MOVE: {
            _E.HOLD: _S.HOLD,
            _E.END: _S.STOP,
            _E.STOP: _S.STOP,
            _E.FAULT: _S.FAULT,
            _E.LOST: _S.DISCONNECTED,
        },
        _S.HOLD: {
            _E.HOLD: _S.HOLD,
            _E.RESUME: _S.MOVE,
            _E.END: _S.STOP,  # a wait at a barrier is over
            _E.STOP: _S.STOP,
            _E.FAULT: _S.FAULT,
            _E.LOST: _S.DISCONNECTED,
        },
        _S.FAULT: {_E.CLEAR: _S.STOP, _E.STOP: _S.FAULT, _E.FAULT: _S.FAULT, _E.LOST: _S.FAULT},
    }
)
"""All transitions: from each state, by each event. STOP is allowed in every state."""


class TransitionError(RuntimeError):
    """A transition that is not in the table: a bug in yarclang."""


def after(state: State, event: Event) -> State:
    """Return the state that follows a state after an event.

    Raises:
        TransitionError: the table has no such transition.
    """
    try:
        return TRANSITIONS[state][event]
    except KeyError:
        raise TransitionError(f"{event.value} in state {state.value}") from None
