"""Names and addresses of the bits in the status words of motors and coordinate systems (TSRM 281-287)."""

MOTOR_WORD_1: dict[str, int] = {
    "activated": 23,
    "negative limit set": 22,
    "positive limit set": 21,
    "extended servo": 20,
    "amplifier enabled": 19,
    "open loop": 18,
    "move timer active": 17,
    "integration mode": 16,
    "dwell in progress": 15,
    "data block error": 14,
    "desired velocity zero": 13,
    "abort deceleration": 12,
    "block request": 11,
    "home search in progress": 10,
}
"""Names of the bits in the first word of `#n?`, at X:$0000B0 + $80 (n - 1)."""

MOTOR_WORD_2: dict[str, int] = {
    "assigned": 15,
    "foreground in position": 13,
    "stopped on desired position limit": 12,
    "stopped on limit": 11,
    "home complete": 10,
    "integrated following error fault": 6,
    "I2T fault": 5,
    "amplifier fault": 3,
    "fatal following error": 2,
    "warning following error": 1,
    "in position": 0,
}
"""Names of the bits in the second word of `#n?`, at Y:$0000C0 + $80 (n - 1).

Bits 23 to 20 are the number of the coordinate system minus 1; bits 19 to 16 are the axis code.
"""

SYSTEM_WORD_1: dict[str, int] = {
    "continuous motion request": 4,
    "move by time": 3,
    "continuous motion": 2,
    "single step": 1,
    "running": 0,
}
"""Names of the bits in the first word of `&n??`, at X:$002040 + $100 (n - 1).

Each axis has a pair of bits: the axis takes part in the vector feedrate, and the axis is incremental.
"""

SYSTEM_WORD_2: dict[str, int] = {
    "lookahead": 23,
    "run-time error": 22,
    "move in stack": 21,
    "amplifier fault": 20,
    "fatal following error": 19,
    "warning following error": 18,
    "in position": 17,
    "rotary full": 16,
    "delayed calculation": 15,
    "end of block stop": 14,
    "synchronous M one-shot": 13,
    "dwell buffered": 12,
    "pre-jog": 8,
    "segmented": 7,
}
"""Names of the bits in the second word of `&n??`, at Y:$00203F + $100 (n - 1)."""

SYSTEM_WORD_3: dict[str, int] = {
    "radius error": 3,
    "resume error": 2,
    "desired position limit stop": 1,
    "in-program PMATCH": 0,
}
"""Names of the bits in the third word of `&n??`, at Y:$002040 + $100 (n - 1)."""

MODE_BITS: dict[str, int] = {
    "LINEAR": 0b000,
    "RAPID": 0b010,
    "SPLINE1": 0b101,
    "SPLINE2": 0b101,
    "CIRCLE1": 0b001,
    "CIRCLE2": 0b011,
    "PVT": 0b110,
}
"""The move mode, as bits 4, 1 and 0 of a coordinate system's second word."""

INCREMENTAL_BITS: dict[str, int] = {
    axis: 22 - 2 * place for place, axis in enumerate(("Z", "Y", "X", "W", "V", "U", "C", "B", "A"))
}
"""For each axis, the bit of the first word that is set if the axis is incremental: the lower bit of the
axis's pair.
"""

AXIS_CODES: dict[str, int] = {
    "A": 1,
    "B": 2,
    "C": 3,
    "UVW": 4,
    "U": 4,
    "V": 4,
    "W": 4,
    "X": 7,
    "Y": 7,
    "Z": 7,
}
"""For each axis, the code in bits 19 to 16 of the second status word of the motors that are assigned to the
axis.

Definitions by UVW and by XYZ share a code (assumed).
"""

MOTOR_STATUS_1 = 0xB0
MOTOR_STATUS_2 = 0xC0
SYSTEM_STATUS_1 = 0x2040
SYSTEM_STATUS_2 = 0x203F
MOTOR_STEP = 0x80
SYSTEM_STEP = 0x100
COMMANDED = 0x88
ACTUAL = 0x8B
TARGET = 0xC7
