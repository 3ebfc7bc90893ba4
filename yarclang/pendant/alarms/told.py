"""Conversion of reports from the coordinator, the process that drives the robot, to alarms. No I/O.

Stops, holds and releases of a jog button raise no alarm if a user has ordered them; they are in the audit
trail.
"""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.coordinator.messages import events, replies
from yarclang.pendant.alarms.alarm import Raised
from yarclang.runtime.state import State

LOST, MOTOR = "Y1606", "Y1602"
"""Codes of a lost connection, and of a motor that can't move."""

_FAILED = {"amplifier fault", "fatal following error", "stopped on limit"}
"""Flags of a motor that has failed by itself."""


def of_state(
    state: State, reason: str, code: str | None = None, help_: str | None = None
) -> tuple[Raised, ...]:
    """Return the causes of the alarms that follow from the robot's state; empty if nothing is wrong.

    Args:
        state: state of the robot.
        reason: reason for the state, in words.
        code: code of the finding that led to the state; None if there is none.
        help_: what the user should do; None if unknown.
    """
    if state in (State.FAULT, State.DISCONNECTED):
        missing = LOST if state is State.DISCONNECTED else ""
        return (Raised("state", reason or state.value, code or missing, help_ or ""),)
    if state is State.HOLD and (code or help_):  # the hold wasn't ordered
        return (Raised("state", reason, code or "", help_ or ""),)
    return ()


def of_event(event: events.BaseEvent) -> Raised | None:
    """Return the cause of the alarm that an event reports; None if there is none."""
    match event:
        case events.Finished(well=False, what=str(what), code=str(code), help=help_):
            return Raised("run", what, code, help_ or "")
        case events.Told(text=text, warning=True, code=code):
            return Raised("message", text, code or "")
        case _:
            return None


def of_motors(motors: Sequence[replies.MotorHealth], reason: str) -> tuple[Raised, ...]:
    """Return the causes of alarms for motors that have failed. A motor is left out if `reason` already names
    it, or if its loop was opened only because another motor has failed.

    Args:
        motors: last known state of the motors.
        reason: reason for the robot's state, in words.
    """
    failed = (one for one in motors if one.trouble and _FAILED & set(one.flags))
    found = (f"motor {one.number}: {one.trouble}" for one in failed)
    remedy = "find the cause, then close its loop on the page Controller"
    return tuple(Raised("motors", what, MOTOR, remedy) for what in found if what not in reason)


def of_guard(health: replies.Health | None, state: State) -> tuple[Raised, ...]:
    """Return the cause of an alarm if the robot may move but the guard PLC isn't known to work."""
    if health is None or health.guard or state in (State.FAULT, State.DISCONNECTED):
        return ()
    what = "the guard PLC hasn't been tested: the robot might not stop if this computer fails"
    return (Raised("guard", what, "", "test it with Look at everything on the page Controller"),)


def of_trail(trouble: str) -> tuple[Raised, ...]:
    """Return an alarm if the audit trail can't be written; `trouble` is the reason."""
    if not trouble:
        return ()
    return (Raised("audit", trouble, "", "until it can be written, only stop orders are accepted"),)


def of_disk(low: str) -> tuple[Raised, ...]:
    """Return the cause of an alarm if the disk is nearly full. `low` is the warning about the disk, empty
    if it has enough space.
    """
    return (
        (Raised("disk", low, "", "make room on the disk: logs of runs can be deleted on the page Files"),)
        if low
        else ()
    )


def of_keeping(trouble: str) -> tuple[Raised, ...]:
    """Return an alarm if the alarms themselves can't be written to the database; `trouble` is the reason."""
    what = f"alarms are kept only in memory, and are lost when the pendant ends: {trouble}"
    return (Raised("alarms", what, "", "make room on the disk, or check the file"),) if trouble else ()


def of_coordinator(robot: str) -> tuple[Raised, ...]:
    """Return the alarm for a coordinator that can't be reached."""
    what = f"the coordinator of {robot} can't be reached"
    return (Raised("coordinator", what, LOST, "inspect the robot; wait, or restart `yarc serve`"),)
