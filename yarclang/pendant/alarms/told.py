"""Alarms from the coordinator's reports. No I/O.

Ordered stops and holds, and jogs that were released, raise no alarm: they are in the audit trail.
"""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.coordinator.messages import events, replies
from yarclang.pendant.alarms.alarm import Raised
from yarclang.runtime.state import State

LOST, MOTOR = "Y1606", "Y1602"
"""Codes of a lost connection, and of a motor that can't move."""

_FAILED = {"amplifier fault", "fatal following error", "stopped on limit"}
"""Flags of a motor that has failed itself."""


def of_state(state: State, why: str, code: str | None = None, help_: str | None = None) -> tuple[Raised, ...]:
    """Return the causes of alarms in a state.

    Args:
        state: of the robot.
        why: reason of the state.
        code: of the finding.
        help_: what to do.
    """
    if state in (State.FAULT, State.DISCONNECTED):
        missing = LOST if state is State.DISCONNECTED else ""
        return (Raised("state", why or state.value, code or missing, help_ or ""),)
    if state is State.HOLD and (code or help_):  # the hold wasn't ordered
        return (Raised("state", why, code or "", help_ or ""),)
    return ()


def of_event(event: events.BaseEvent) -> Raised | None:
    """Return the cause of an alarm in an event; None if there is none."""
    match event:
        case events.Finished(well=False, what=str(what), code=str(code), help=help_):
            return Raised("run", what, code, help_ or "")
        case events.Told(text=text, warning=True, code=code):
            return Raised("message", text, code or "")
        case _:
            return None


def of_motors(motors: Sequence[replies.MotorHealth], why: str) -> tuple[Raised, ...]:
    """Return the motors that have failed, without those that the state names already. Motors that are
    open-loop because another motor failed are left out.

    Args:
        motors: their last known state.
        why: the reason of the robot's state.
    """
    failed = (one for one in motors if one.trouble and _FAILED & set(one.flags))
    found = (f"motor {one.number}: {one.trouble}" for one in failed)
    remedy = "find out why, then close its loop: look at the page Controller"
    return tuple(Raised("motors", what, MOTOR, remedy) for what in found if what not in why)


def of_guard(health: replies.Health | None, state: State) -> tuple[Raised, ...]:
    """Return an alarm if the guard PLC isn't known to work although the robot may move."""
    if health is None or health.guard or state in (State.FAULT, State.DISCONNECTED):
        return ()
    what = "the guard PLC isn't known to work: a robot whose computer falls silent may run on"
    return (Raised("guard", what, "", "press Look at everything on the page Controller, which tries it"),)


def of_trail(trouble: str) -> tuple[Raised, ...]:
    """Return an alarm if the audit trail can't be written; `trouble` says why."""
    if not trouble:
        return ()
    return (Raised("audit", trouble, "", "nothing can be ordered but a stop until it can be written"),)


def of_disk(low: str) -> tuple[Raised, ...]:
    """Return an alarm if the disk is nearly full; `low` says how little room is left, and is empty if there
    is enough.
    """
    return (
        (Raised("disk", low, "", "make room on the disk: logs of runs can be deleted on the page Files"),)
        if low
        else ()
    )


def of_keeping(trouble: str) -> tuple[Raised, ...]:
    """Return an alarm if alarms can't be written; `trouble` says why."""
    what = f"alarms are only in memory, and are lost when the pendant ends: {trouble}"
    return (Raised("alarms", what, "", "make room on the disk, or look at the file"),) if trouble else ()


def of_coordinator(robot: str) -> tuple[Raised, ...]:
    """Return the alarm that the coordinator of a robot can't be reached."""
    what = f"the coordinator of {robot} can't be reached"
    return (Raised("coordinator", what, LOST, "look at the robot; wait, or start `yarc serve` again"),)
