"""Tables of words and lines of other robot languages, with the help for each."""

from __future__ import annotations

import re
from types import MappingProxyType

MOVEJ = "write P0010 MOVEJ and the joint positions, or P0010 MOVEJ_RPY and a pose"
MOVEL = "write P0010 MOVEL and a pose: X Y Z, then roll, pitch and yaw"
MOVEC = "write P0010 MOVEC, the via point, a semicolon, and the pose at the end"
DMOVE = "write P0010 DMOVE and the increment X Y Z roll pitch yaw, and after it the frame whose axes count"
DMOVEJ = "write P0010 DMOVEJ and the angle by which each joint turns"
SET = "declare the output, as OUTPUT GLUE M1 OFF, and write P0010 SET GLUE ON"
WAIT_INPUT = "declare the input, as INPUT DOOR M11, and write P0010 WAIT DOOR ON"
WHEN = "declare the input, as INPUT DOOR M11, and write WHEN DOOR ON, the lines, and END"
SUB = "remove the line: a program begins with its first line; lines to be called are between SUB NAME and END"
TIME = "write P0010 WAIT [2] (s): the time is in square brackets"
REGISTER = (
    "declare it, as REGISTER N 0..17, and write P0010 SET N = N + 1; a number that never changes is LET N = 4"
)
JUMP = "the language has no jumps: put repeated lines in a SUB, and branch by WHEN, CASE and LOOP"
REPEAT = "write REPEAT I 4, the lines, and END: $I is 0, 1, 2 and 3"
_FRAME = (
    "declare the frame, as FRAME {BENCH} 0 1000 0 0 0 0 (mm,deg) {B}, and write {BENCH} at the end of the "
    "motions"
)
_TOOL = "write the moving frame before the values, as {TCP}; tools are declared in the robot's or cell's file"
_NUMBERS = (
    "write LET N = 4 for a number that never changes; for one that changes, REGISTER N 0..17 and SET N = N "
    "+ 1"
)
_POINTS = (
    "write JOINTS PICK and its joint values, or POSE PICK and X Y Z roll pitch yaw, and go there by name"
)
_SPEED = (
    "write the speed with its motion, as [V 200] or [50%], or once as DEFAULT [50%]; accelerations are "
    "given in the robot's file"
)
_LOAD = "remove the line: masses are given in the robot's or cell's file"
_HOLD = (
    'write P0010 HOLD "insert the part" to wait for the operator, or P0010 WAIT [2] (s) to wait for a time'
)
_SAY = 'write P0010 SAY "hello" to show the operator a message'
_NOTHING = "remove the line: YARC has no such setting"
_END = "write P0010 STOP, or nothing: a program ends with its last line"


def _all(words: str, help_: str) -> dict[str, str]:
    return dict.fromkeys(words.split(), help_)


WORDS = MappingProxyType(
    {
        **_all("PTP SPTP JMOVE MOVJ MOVABSJ MOVEABSJ G0 G00", MOVEJ),
        **_all("LIN MOVL G1 G01 SLIN MOVEP", MOVEL),
        **_all("CIRC MOVC G2 G3 G02 G03 C1MOVE C2MOVE SCIRC", MOVEC),
        **_all("LIN_REL SLIN_REL CIRC_REL TDRAW DRAW", DMOVE),
        **_all("PTP_REL SPTP_REL DRIVE", DMOVEJ),
        **_all("G91", "DMOVE and DMOVEJ are relative, MOVEJ, MOVEL and MOVEC absolute: remove the line"),
        **_all("G90", "remove the line: MOVEJ, MOVEL and MOVEC are absolute, DMOVE and DMOVEJ relative"),
        **_all("G28 G30", "write P0010 MOVEJ HOME"),
        **_all("G21 G71", "write the unit in brackets, once: DEFAULT (mm,deg,s)"),
        **_all("G20 G70", "write the unit in brackets, once: DEFAULT (in,deg,s)"),
        **_all("G17 G18 G19 G40 G49 G61 G64 G80 G94 G95 INI BAS CONFL CONFJ SINGAREA", _NOTHING),
        **_all("G54 G55 G56 G57 G58 G59 G92 $BASE UFRAME UFRAME_NUM WOBJDATA SET_BASE", _FRAME),
        **_all("$TOOL UTOOL UTOOL_NUM SET_TCP TOOLDATA T1 T2 T3 M6 M06 TOOL", _TOOL),
        **_all("SETDO SETGO SETAO SET_DIGITAL_OUT SET_STANDARD_DIGITAL_OUT SET_TOOL_DIGITAL_OUT DOUT", SET),
        **_all("M3 M4 M03 M04 M7 M8 M07 M08 SIGNAL BITS $OUT INVERTDO", SET),
        **_all("M5 M05 M9 M09 RESET", SET.removesuffix("ON") + "OFF"),
        **_all("OPEN CLOSE OPENI CLOSEI GRASP RELAX", SET),
        **_all("PULSEDO PULSEOUT", "write P0010 PULSE GLUE [0.5] (s), after OUTPUT GLUE M1 OFF"),
        **_all("WAITDI WAITUNTIL SWAIT $IN", WAIT_INPUT),
        **_all("DEF PROC DEFFCT FUNCTION PROGRAM MODULE BEGIN ROUTINE THREAD", SUB),
        **_all("ENDPROC ENDMODULE ENDDEF ENDFCT", SUB),
        **_all("DELAY TIMER TWAIT G4 G04 DWELL", TIME),
        **_all("M30 M2 M02 EXIT_PROGRAM", _END),
        **_all(
            "HALT",
            (
                'write P0010 STOP to end the program, or P0010 HOLD "look" to wait for the '
                "operator, or P0010 WAIT [2] (s) to wait for a time"
            ),
        ),
        **_all("PAUSE POPUP UIMSGBOX M0 M00 M1 M01", _HOLD),
        **_all("TEXTMSG TPWRITE MESSAGE PRINT TYPE DISPLAY", _SAY),
        **_all("IMPORT INCLUDE LOAD", "write USE PALLET, with the module's name"),
        **_all("VAR PERS CONST INT REAL DECL NUM BOOL LOCAL GLOBAL", _NUMBERS),
        **_all("ROBTARGET JOINTTARGET E6POS E6AXIS POINT", _POINTS),
        **_all("ACCSET VELSET OVERRIDE SPEED ACCEL ACCURACY $OV_PRO F WITH", _SPEED),
        **_all("SET_PAYLOAD SET_TARGET_PAYLOAD GRIPLOAD PAYLOAD LOAD_DATA", _LOAD),
        **_all("SWITCH TEST SELECT", "write CASE N, OF 1 and its lines, and END, after REGISTER N 0..3"),
        **_all("GOTO GO LABEL", JUMP),
        **_all(
            "INTERRUPT TRAP CONNECT",
            "write WHEN DOOR ON, the lines, and END at the place where the input is to be read",
        ),
        **_all(
            "LAPPRO JAPPRO LDEPART JDEPART APPRO DEPART",
            "write P0010 DMOVE 0 0 -100 0 0 0 {TCP}, which moves along the tool's axes, or MOVEL to a pose",
        ),
    }
)
"""Help texts for lines of other languages, by the first word of the line."""

BLOCKS = frozenset(("DEF", "PROC", "DEFFCT", "FUNCTION", "ROUTINE", "SWITCH", "TEST", "SELECT"))
"""Words that begin a block; an END further down belongs to them."""

WHOLE = frozenset(("VAR", "PERS", "CONST", "DECL"))
"""If a line begins with one of these words, its finding spans the whole line."""

FORMS: tuple[tuple[re.Pattern[str], str, bool], ...] = tuple(
    (re.compile(pattern, re.I), help_, begins)
    for pattern, help_, begins in (
        (r"CONST\s+(?:robtarget|jointtarget)\b|(?:DECL\s+)?E6(?:POS|AXIS)\b", _POINTS, False),
        (r"J\s+P\[.*", MOVEJ, False),
        (r"L\s+P\[.*", MOVEL, False),
        (r"C\s+P\[.*", MOVEC, False),
        (r"\$?R\[.*", REGISTER, False),
        (r"PR\[.*", _POINTS, False),
        (r"MOVE\s+TO\b", f"{MOVEJ}; MOVEL goes straight", False),
        (r"(?:OPEN|CLOSE)\s+HAND\b", SET, False),
        (r"WITH\s+\$SPEED\b", _SPEED, False),
        (r"(?:DO|RO|SO|GO)\s*\[.*\].*", SET, False),
        (r"IF\s+\(?\s*\$?[DRSG]?IN?\s*\[.*", WHEN, False),
        (r"if\s+get_\w*digital_in\b.*", WHEN, False),
        (r"(?:DI|RI|SI|GI)\s*\[.*\].*", WAIT_INPUT, False),
        (r"(?:LBL|JMP)\b", JUMP, False),
        (r"UFRAME_NUM\s*=.*|UFRAME\[.*", _FRAME, False),
        (r"UTOOL_NUM\s*=.*|UTOOL\[.*", _TOOL, False),
        (r"OVERRIDE\s*=.*", _SPEED, False),
        (r"MESSAGE\s*\[.*", _SAY, False),
        (r"while\s+(?:true|1)\s*(?:do)?\s*:?$", "write LOOP, the lines, and END", True),
        (r"for\s+\w+\s+in\b.*|for\s+\w+\s*[:=].*|for\s+\w+\s+from\b.*", REPEAT, True),
        (r"T[0-9]+\s+M0?6\b", _TOOL, False),
        (r"F[0-9.]+$", _SPEED, False),
        (r"[XYZ][-+]?[0-9.]+(?:\s+[XYZABC][-+]?[0-9.]+)+$", MOVEL, False),
    )
)
"""Lines that need more than their first word to be recognised: pattern, help, and True if the line begins
a block.
"""

NUMBERED: tuple[tuple[re.Pattern[str], str], ...] = (
    (re.compile(r"N[0-9]+\s+(?:G0?0(?![0-9])|[XYZ][-0-9.])", re.I), MOVEJ),
    (re.compile(r"N[0-9]+\s+G0?1(?![0-9])", re.I), MOVEL),
    (re.compile(r"N[0-9]+\s+G0?[23](?![0-9])", re.I), MOVEC),
    (re.compile(r"[0-9]+\s*:\s*J\s+P\[.*", re.I), MOVEJ),
    (re.compile(r"[0-9]+\s*:\s*L\s+P\[.*", re.I), MOVEL),
)
"""Patterns of lines that begin with their number, each with its help."""
