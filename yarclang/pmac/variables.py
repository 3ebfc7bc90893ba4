"""Variables of the controller that yarclang uses, and where they live (TSRM 43, 96-98, 177-193, 281-287)."""

from __future__ import annotations

import re
from collections.abc import Container

from yarclang.robot.controller import SignalVariable

ARMED = "P8100"
"""1 while a rotary program wants its buffer guarded, 2 after the guard has held the motion, else 0."""

ASTRAY = "P8101"
"""1 while a program finds the robot away from its start."""

WAITING = "P8102"
"""1 while a program waits for an input."""

HEARTBEAT = "P8103"
"""Counts the scans of the guard PLC."""

WATCHED = "P8104"
"""1 while the controller waits for words of the computer that streams, 2 after it has held since none came, else 0."""

ECHO = "P8105"
"""The heartbeat as the feedback PLC has seen it last."""

HOMING = "P8106"
"""1 while a motor searches its home and the controller waits for words of this computer, 2 after it has stopped the search since none came, else 0."""

FEEDBACK_PLC = 0
"""The foreground PLC that computes the joint positions from those of the motors."""

HOMING_PLC = 27
"""The background PLC that stops a home search when this computer falls silent; it is loaded for a search, and deleted after it."""

OUTPUTS_PLC = 28
"""The background PLC of a program that gives its outputs their safe values when the guard has held the motion."""

GUARD_PLC = 29
"""The background PLC that holds the motion when the rotary buffer runs low, or when the computer that streams falls silent."""

ROTARY_FULL = "M8116"
"""Coordinate system status word 2 bit 16: 1 from I17 program lines ahead on, 0 below I16."""


def motor_variable(motor: int, number: int) -> str:
    """I-variable Ixx`number` of a motor: I108 is Ixx08 of motor 1."""
    return f"I{motor}{number:02d}"


def system_variable(system: int, number: int) -> str:
    """I-variable Isx`number` of a coordinate system: I5195 is Isx95 of coordinate system 1."""
    return f"I{5000 + 100 * system + number}"


def watchdog(system: int) -> str:
    """I-variable of the timer that the computer that streams winds up with each word: Isx12, in servo cycles (TSRM 176)."""
    return system_variable(system, 12)


def commanded_position(motor: int) -> tuple[str, str]:
    """M-variable of a motor's commanded position and its address; the unit is 1/(Ixx08 32) count."""
    return f"M{motor}61", f"D:${0x88 + 0x80 * (motor - 1):06X}"


def actual_position(motor: int) -> tuple[str, str]:
    """M-variable of a motor's actual position and its address; the unit is 1/(Ixx08 32) count."""
    return f"M{motor}62", f"D:${0x8B + 0x80 * (motor - 1):06X}"


def rotary_full(system: int) -> tuple[str, str]:
    """M-variable of the rotary-full bit of a coordinate system, and its address."""
    return ROTARY_FULL, f"Y:${0x203F + 0x100 * (system - 1):06X},16,1"


LARGEST = 8191
"""The largest number of a variable."""

_SHOWN = 3
"""Stretches of free variables that a remedy names."""

_VARIABLE = re.compile(r"([MPQ])([0-9]{1,4})")
_OUR_OWN = re.compile(r"P81[0-9][0-9]|M8116|M[0-9]{1,2}6[0-9]")
"""Variables that yarclang itself uses: the guard's, and the motors' positions."""


def signal_variable(text: str, feedback: Container[str]) -> SignalVariable:
    """What a text in upper case names; `feedback` are the variables in which a robot tells its positions."""
    found = _VARIABLE.fullmatch(text)
    if found is None or int(found[2]) > LARGEST:
        fault = "is no variable of the controller: M, P or Q and 0 to 8191"
        return SignalVariable(None, fault, "for example M11")
    name = f"{found[1]}{int(found[2])}"
    if _OUR_OWN.fullmatch(name) or name in feedback:
        return SignalVariable(None, "is used by yarclang itself", _free(found[1], feedback), is_taken=True)
    return SignalVariable(name)


def _free(letter: str, feedback: Container[str]) -> str:
    """Return which variables of a letter are free, as a remedy."""
    stretches: list[list[int]] = []
    for number in range(LARGEST + 1):
        name = f"{letter}{number}"
        if _OUR_OWN.fullmatch(name) or name in feedback:
            continue
        if stretches and stretches[-1][1] == number - 1:
            stretches[-1][1] = number
        else:
            stretches.append([number, number])
    told = [f"{letter}{a}" if a == b else f"{letter}{a} to {letter}{b}" for a, b in stretches[:_SHOWN]]
    more = " and more" if len(stretches) > _SHOWN else ""
    return f"free are {', '.join(told)}{more}"
