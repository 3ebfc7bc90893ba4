"""Variables of the controller that yarclang uses, and their addresses (TSRM 43, 96-98, 177-193, 281-287)."""

from __future__ import annotations

import re
from collections.abc import Container

from yarclang.robot.controller import SignalVariable

ARMED = "P8100"
"""Variable of the guard's flag: 1 while a rotary program needs its buffer guarded, 2 after the guard has held
the motion, else 0.
"""

DISARMS = f"{ARMED}={ARMED}&2"
"""Line with which a program disarms the guard. It changes the flag from 1 to 0, and leaves it at 2: the
program may go on for a moment after the guard has held it.
"""

ASTRAY = "P8101"
"""Variable that is 1 while the robot isn't at the program's start, else 0."""

WAITING = "P8102"
"""Variable that is 1 while a program waits for an input."""

HEARTBEAT = "P8103"
"""Variable in which the guard PLC counts its scans."""

WATCHED = "P8104"
"""Variable of the watchdog's flag: 1 while the controller expects messages from the streaming computer, 2
after the guard has held the motion because no message came, else 0.
"""

ECHO = "P8105"
"""Variable in which the feedback PLC copies the guard's heartbeat, to show that both run."""

HOMING = "P8106"
"""Variable of the home search's flag: 1 while a motor searches its home and the controller expects messages
from this computer, 2 after the search was stopped because no message came, else 0.
"""

FEEDBACK_PLC = 0
"""Number of the foreground PLC that computes the joint positions from the motor positions."""

HOMING_PLC = 27
"""Number of the background PLC that stops a home search when this computer falls silent. The PLC is loaded
for a search and deleted afterwards.
"""

OUTPUTS_PLC = 28
"""Number of a program's background PLC that sets the program's outputs to their safe values after the guard
has held the motion.
"""

GUARD_PLC = 29
"""Number of the background PLC that holds the motion when the rotary buffer runs low or the streaming
computer falls silent.
"""

ROTARY_FULL = "M8116"
"""M-variable of the rotary-full bit (word 2, bit 16 of the coordinate system's status): 1 if at least I17
program lines are ahead, 0 if fewer than I16 are.
"""


def motor_variable(motor: int, number: int) -> str:
    """Return the I-variable Ixx`number` of a motor: I108 is Ixx08 of motor 1."""
    return f"I{motor}{number:02d}"


def system_variable(system: int, number: int) -> str:
    """Return the I-variable Isx`number` of a coordinate system: I5195 is Isx95 of coordinate system 1."""
    return f"I{5000 + 100 * system + number}"


def watchdog(system: int) -> str:
    """Return the I-variable of the watchdog timer, Isx12, in servo cycles (TSRM 176).

    Each message of the streaming computer restarts the timer.
    """
    return system_variable(system, 12)


def commanded_position(motor: int) -> tuple[str, str]:
    """Return the M-variable of a motor's commanded position and its address; the unit is 1/(Ixx08 32)
    count.
    """
    return f"M{motor}61", f"D:${0x88 + 0x80 * (motor - 1):06X}"


def actual_position(motor: int) -> tuple[str, str]:
    """Return the M-variable of a motor's actual position and its address; the unit is 1/(Ixx08 32) count."""
    return f"M{motor}62", f"D:${0x8B + 0x80 * (motor - 1):06X}"


def rotary_full(system: int) -> tuple[str, str]:
    """Return the M-variable of the rotary-full bit of a coordinate system, and its address."""
    return ROTARY_FULL, f"Y:${0x203F + 0x100 * (system - 1):06X},16,1"


LARGEST = 8191
"""Largest number of a variable."""

_SHOWN = 3
"""Number of ranges of free variables that the remedy of a finding names."""

_VARIABLE = re.compile(r"([MPQ])([0-9]{1,4})")
_OUR_OWN = re.compile(r"P81[0-9][0-9]|M8116|M[0-9]{1,2}6[0-9]")
"""Variables that yarclang reserves: those of the guard and of the motor positions."""


def signal_variable(text: str, feedback: Container[str]) -> SignalVariable:
    """Return the variable that a text names.

    Args:
        text: name of the variable, in upper case.
        feedback: variables in which the robot reports its positions; they can't be used for signals.
    """
    found = _VARIABLE.fullmatch(text)
    if found is None or int(found[2]) > LARGEST:
        fault = "isn't a variable of the controller: M, P or Q and 0 to 8191"
        return SignalVariable(None, fault, "for example M11")
    name = f"{found[1]}{int(found[2])}"
    if _OUR_OWN.fullmatch(name) or name in feedback:
        return SignalVariable(None, "is used by yarclang itself", _free(found[1], feedback), is_taken=True)
    return SignalVariable(name)


def _free(letter: str, feedback: Container[str]) -> str:
    """Return the free variables of a letter, as a remedy."""
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
    return f"{', '.join(told)}{more} are free"
