"""Default values of the I-variables that yarclang uses, as after `$$$***` (TSRM 37-46, 95-98, 177-193).

Variables that are not listed here default to 0. Values marked as assumed aren't from the manuals, but from
memory or similar controllers.
"""

MOTORS = 32
SYSTEMS = 16
VARIABLES = 8192

GLOBAL: dict[int, float] = {
    1: 0,
    2: 1,
    3: 1,
    5: 0,
    6: 1,
    7: 0,
    8: 2,
    9: 2,
    10: 3_713_707,
    15: 0,
    16: 5,
    17: 10,
    20: 0x78400,
    42: 0,
}

MOTOR: dict[int, float] = {
    0: 0,
    8: 96,
    9: 96,
    11: 32_000,
    12: 16_000,
    13: 0,
    14: 0,
    15: 0.25,
    16: 32,
    17: 0.5,
    19: 0.15625,
    20: 0,
    21: 50,
    22: 32,
    23: 32,
    24: 0,
    26: 0,
    27: 0,
    28: 160,
    90: 1,
}
"""Default values of Ixx`number`. They are the same for every motor, except I100, which is 1: motor 1 is
activated. Those of Ixx12, 19, 21, 22, 23, 28 and 90 are assumed.
"""

SYSTEM: dict[int, float] = {
    13: 0,
    20: 0,
    50: 0,
    87: 0,
    88: 50,
    89: 1000,
    90: 1000,
    94: 1644,
    95: 1644,
    98: 1000,
}
"""Defaults of Isx`number`, the same for every coordinate system."""

HEXADECIMAL = frozenset({20, 21, 22, 23}) | {
    100 * motor + number for motor in range(1, 33) for number in (1, 2, 3, 4, 5, 10, 24, 25)
}
"""Numbers of the I-variables that are addresses or bits. With I9 bit 1 set, the controller reports them as
$hex.
"""


def default_variables() -> dict[int, float]:
    """Return all I-variables that are not 0 after `$$$***`, by number."""
    values = {number: float(value) for number, value in GLOBAL.items()}
    for motor in range(1, MOTORS + 1):
        values |= {100 * motor + number: float(value) for number, value in MOTOR.items()}
    for system in range(1, SYSTEMS + 1):
        values |= {5000 + 100 * system + number: float(value) for number, value in SYSTEM.items()}
    values[100] = 1.0
    return {number: value for number, value in values.items() if value}
