"""What of all that is told of a robot is an alarm. No I/O.

Stops and holds that somebody has ordered, and jogs that were let go, are none: the audit trail has them.
"""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.coordinator.messages import events, replies
from yarclang.pendant.alarms.alarm import Raised
from yarclang.runtime.state import State

LOST, MOTOR = "Y1606", "Y1602"
"""Codes of a connection that was lost, and of a motor that can't move."""

_FAILED = {"amplifier fault", "fatal following error", "stopped on limit"}
"""Flags of a motor that has failed itself."""


def of_state(state: State, why: str, code: str | None = None, help_: str | None = None) -> tuple[Raised, ...]:
    """Return what is wrong in a state.

    Args:
        state: of the robot.
        why: it is in this state.
        code: of the finding.
        help_: what to do.
    """
    if state in (State.FAULT, State.DISCONNECTED):
        missing = LOST if state is State.DISCONNECTED else ""
        return (Raised("state", why or state.value, code or missing, help_ or ""),)
    if state is State.HOLD and (code or help_):  # nobody has ordered it
        return (Raised("state", why, code or "", help_ or ""),)
    return ()


def of_event(event: events.BaseEvent) -> Raised | None:
    """Return what an event tells that went wrong once; None: nothing."""
    match event:
        case events.Finished(well=False, what=str(what), code=str(code), help=help_):
            return Raised("run", what, code, help_ or "")
        case events.Told(text=text, warning=True, code=code):
            return Raised("message", text, code or "")
        case _:
            return None


def of_motors(motors: Sequence[replies.MotorHealth], why: str) -> tuple[Raised, ...]:
    """Return which motors have failed, except for what the state tells already; others are open-loop because of them.

    Args:
        motors: as they were heard last.
        why: the reason of the state.
    """
    failed = (one for one in motors if one.trouble and _FAILED & set(one.flags))
    found = (f"motor {one.number}: {one.trouble}" for one in failed)
    remedy = "find out why, then close its loop: look at the page Controller"
    return tuple(Raised("motors", what, MOTOR, remedy) for what in found if what not in why)


def of_guard(health: replies.Health | None, state: State) -> tuple[Raised, ...]:
    """Return what is wrong with the guard PLC: it isn't known to work though the robot may move."""
    if health is None or health.guard or state in (State.FAULT, State.DISCONNECTED):
        return ()
    what = "the guard PLC isn't known to work: a robot whose computer falls silent may run on"
    return (Raised("guard", what, "", "press Look at everything on the page Controller, which tries it"),)


def of_trail(trouble: str) -> tuple[Raised, ...]:
    """Return what is wrong with the audit trail; `trouble` says why it can't be written."""
    if not trouble:
        return ()
    return (Raised("audit", trouble, "", "nothing can be ordered but a stop until it can be written"),)


def of_disk(low: str) -> tuple[Raised, ...]:
    """Return what is wrong with the disk; `low` says how little room is left, empty: there is enough."""
    return (
        (Raised("disk", low, "", "make room on the disk: logs of runs can be deleted on the page Files"),)
        if low
        else ()
    )


def of_keeping(trouble: str) -> tuple[Raised, ...]:
    """Return what is wrong with keeping alarms; `trouble` says why they can't be written."""
    what = f"alarms are only in memory, and are lost when the pendant ends: {trouble}"
    return (Raised("alarms", what, "", "make room on the disk, or look at the file"),) if trouble else ()


def of_coordinator(robot: str) -> tuple[Raised, ...]:
    """Return that the coordinator of a robot can't be reached."""
    what = f"the coordinator of {robot} can't be reached"
    return (Raised("coordinator", what, LOST, "look at the robot; wait, or start `yarc serve` again"),)
