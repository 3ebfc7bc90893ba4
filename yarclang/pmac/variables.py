"""Variables of the controller that yarclang uses, and where they live (TSRM 43, 96-98, 177-193, 281-287)."""

ARMED = "P8100"
"""1 while a rotary program wants its buffer guarded, 2 after the guard has held the motion, else 0."""

ASTRAY = "P8101"
"""1 while a program finds the robot away from its start."""

WAITING = "P8102"
"""1 while a program waits for an input."""

OUTPUTS_PLC = 28
"""The background PLC of a program that gives its outputs their safe values when the guard has held the motion."""

GUARD_PLC = 29
"""The background PLC that holds the motion when the rotary buffer runs low."""

ROTARY_FULL = "M8116"
"""Coordinate system status word 2 bit 16: 1 from I17 program lines ahead on, 0 below I16."""


def motor_variable(motor: int, number: int) -> str:
    """I-variable Ixx`number` of a motor: I108 is Ixx08 of motor 1."""
    return f"I{motor}{number:02d}"


def system_variable(system: int, number: int) -> str:
    """I-variable Isx`number` of a coordinate system: I5195 is Isx95 of coordinate system 1."""
    return f"I{5000 + 100 * system + number}"


def commanded_position(motor: int) -> tuple[str, str]:
    """M-variable of a motor's commanded position and its address; the unit is 1/(Ixx08 32) count."""
    return f"M{motor}61", f"D:${0x88 + 0x80 * (motor - 1):06X}"


def actual_position(motor: int) -> tuple[str, str]:
    """M-variable of a motor's actual position and its address; the unit is 1/(Ixx08 32) count."""
    return f"M{motor}62", f"D:${0x8B + 0x80 * (motor - 1):06X}"


def rotary_full(system: int) -> tuple[str, str]:
    """M-variable of the rotary-full bit of a coordinate system, and its address."""
    return ROTARY_FULL, f"Y:${0x203F + 0x100 * (system - 1):06X},16,1"
