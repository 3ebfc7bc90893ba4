"""Lines of other robot languages: what serves instead."""

from __future__ import annotations

import re
from types import MappingProxyType

from yarclang.mistakes.line import Guess, Line

_MOVEJ = "write P0010 MOVEJ and the joint positions, or P0010 MOVEJ_RPY and a pose"
_MOVEL = "write P0010 MOVEL and a pose: X Y Z, then roll, pitch and yaw"
_MOVEC = "write P0010 MOVEC, the point on the way, a semicolon, and the pose at the end"
_SET = "declare the output, as OUTPUT GLUE M1 OFF, and write P0010 SET GLUE ON"
_WAIT_INPUT = "declare the input, as INPUT DOOR M11, and write P0010 WAIT DOOR ON"
_SUB = "a program begins with its first line; lines that are called stand between SUB NAME and END"
_TIME = "write P0010 WAIT [2] (s): the time stands in square brackets"
_REGISTER = (
    "declare it, as REGISTER N 0..17, and write P0010 SET N = N + 1; a number that never changes is LET N = 4"
)
_JUMP = "no line is jumped to: lines that are used in several places stand in a SUB; WHEN, CASE and REPEAT lead the way"

_WORDS = MappingProxyType(
    {
        **dict.fromkeys(("PTP", "JMOVE", "MOVJ", "MOVABSJ", "G0", "G00"), _MOVEJ),
        **dict.fromkeys(("LIN", "LMOVE_", "MOVL", "G1", "G01", "SLIN"), _MOVEL),
        **dict.fromkeys(("CIRC", "MOVC", "G2", "G3", "G02", "G03", "C1MOVE", "SCIRC"), _MOVEC),
        **dict.fromkeys(
            (
                "SETDO",
                "SET_DIGITAL_OUT",
                "SET_STANDARD_DIGITAL_OUT",
                "DOUT",
                "M3",
                "M4",
                "M5",
                "M03",
                "M05",
                "M7",
                "M8",
                "M9",
                "SIGNAL",
            ),
            _SET,
        ),
        **dict.fromkeys(("WAITDI", "WAITUNTIL", "SWAIT"), _WAIT_INPUT),
        **dict.fromkeys(("DEF", "PROC", "DEFFCT", "FUNCTION", "PROGRAM", "MODULE", "BEGIN", "ROUTINE"), _SUB),
        **dict.fromkeys(("ENDPROC", "ENDMODULE", "ENDDEF"), _SUB),
        **dict.fromkeys(("DELAY", "TIMER", "TWAIT", "G4", "G04", "DWELL"), _TIME),
        **dict.fromkeys(
            ("M30", "M2", "M02", "HALT", "EXIT_PROGRAM"),
            "write P0010 STOP, or nothing: a program ends with its last line",
        ),
        **dict.fromkeys(("IMPORT", "INCLUDE", "LOAD"), "write USE PALLET, with the module's name"),
        **dict.fromkeys(
            ("VAR", "PERS", "CONST", "INT", "REAL", "DECL", "NUM", "BOOL", "LOCAL", "GLOBAL"),
            "write LET N = 4 for a number that never changes; one that does is declared, as REGISTER N 0..17, and changed by SET N = N + 1",
        ),
        **dict.fromkeys(
            ("LAPPRO", "JAPPRO", "LDEPART", "JDEPART", "APPRO", "DEPART"),
            "write P0010 DMOVE 0 0 -100 0 0 0 {TCP}, which goes by a way along the tool, or MOVEL to a pose",
        ),
    }
)
"""By the word that begins a line of another language, what serves instead."""

_FORMS: tuple[tuple[re.Pattern[str], str], ...] = tuple(
    (re.compile(pattern, re.I), help_)
    for pattern, help_ in (
        (r"J\s+P\[.*", _MOVEJ),
        (r"L\s+P\[.*", _MOVEL),
        (r"C\s+P\[.*", _MOVEC),
        (r"\$?R\[.*", _REGISTER),
        (r"MOVE\s+TO\b", f"{_MOVEJ}; MOVEL goes straight"),
        (r"(?:DO|RO|SO|GO)\s*\[.*\].*", _SET),
        (r"(?:DI|RI|SI|GI)\s*\[.*\].*", _WAIT_INPUT),
        (r"(?:LBL|JMP)\b", _JUMP),
        (r"for\s+\w+\s+in\b.*|for\s+\w+\s*[:=].*", "write REPEAT I 4, the lines, and END"),
    )
)
_HEAD = re.compile(r"\s*(?P<word>\$?[A-Za-z_][A-Za-z0-9_.]*)")
_ROBTARGETS = re.compile(r"\s+(?P<all>[A-Za-z_]\w*\s*,\s*(?P<speed>v[0-9]+|vmax)\s*,.*)", re.I)
_OFFSET = re.compile(r"\s+(?P<all>(?:Offs|RelTool)\s*\(.*\)).*", re.I)
_CALLED = re.compile(r"\s*(?P<all>(?P<word>[A-Za-z_]\w*)\s*\((?P<inside>.*)\)\s*;?)\s*$")
_WAITTIME = re.compile(
    r"\s*(?P<all>(?:WaitTime|sleep)\s*\(?\s*(?P<time>[0-9]+\.?[0-9]*)\s*\)?\s*;?)\s*$", re.I
)


def foreign(line: Line) -> Guess | None:
    """Answer a line that another language would take."""
    said = line.bare.strip()
    if (found := _WAITTIME.fullmatch(line.bare)) and not line.index.strip():
        return line.guess(
            found.start("all"),
            found.end("all"),
            "the time of a WAIT stands in square brackets",
            f"{line.around.free_index(line.number)} WAIT [{found['time']}]",
        )
    for form, help_ in _FORMS:
        if found := form.match(said):
            at = len(line.bare) - len(line.bare.lstrip())
            return line.guess(
                at, at + found.end(), f"`{_short(found[0])}` belongs to another robot language", None, help_
            )
    if line.is_motion and (found := _ROBTARGETS.fullmatch(line.values)):
        at = line.behind + found.start("all")
        speed = found["speed"][1:]
        help_ = (
            f"write {line.word.upper()} with the pose's numbers and [V {speed}]; {found['speed']}, zones and tools are no values here"
            if speed.isdigit()
            else "write the pose's numbers and [MIN]"
        )
        return line.guess(
            at,
            len(line.bare),
            f"{line.word} takes a pose, not names with commas between them: {found['speed']} belongs to RAPID",
            None,
            help_,
        )
    if line.is_motion and (found := _OFFSET.fullmatch(line.values)):
        at = line.behind + found.start("all")
        return line.guess(
            at,
            at + len(found["all"]),
            "no function moves a pose",
            None,
            "write DMOVE 0 0 100 0 0 0 to go by a way, or add numbers by $(Z+100)",
        )
    return _by_head(line)


def _by_head(line: Line) -> Guess | None:
    head = _HEAD.match(line.bare, len(line.index))
    if head is None:
        return None
    word, begin, end = head["word"], head.start("word"), head.end("word")
    upper = word.upper()
    if upper.startswith(("$VEL", "$ACC")):
        return line.guess(
            begin,
            end,
            f"{word} belongs to KRL",
            None,
            "a speed belongs to its motion: write [V 200] behind the values, or DEFAULT [V 200] once",
        )
    if upper in ("$OUT", "$IN"):
        return line.guess(
            begin, end, f"{word} belongs to KRL", None, _SET if upper == "$OUT" else _WAIT_INPUT
        )
    if (
        upper.startswith("MOVE")
        and (called := _CALLED.fullmatch(line.bare))
        and ("p[" in called["inside"] or "=" in called["inside"])
    ):
        serves = {"MOVEJ": _MOVEJ, "MOVEL": _MOVEL, "MOVEC": _MOVEC}.get(upper)
        if serves:
            whole = "=" in called["inside"]
            last = called.end("all") if whole else end
            return line.guess(
                begin,
                last,
                f"`{word}(...)` belongs to URScript, whose angles are in rad and lengths in m",
                None,
                serves,
            )
    if upper.startswith("MOVE") and (
        called := re.match(r"\s*(?P<word>\w+)\((?P<inside>\s*[A-Za-z]\w*\s*,.*)\)", line.bare)
    ):
        serves = {"MOVEJ": _MOVEJ, "MOVEL": _MOVEL, "MOVEC": _MOVEC}.get(upper)
        if serves:
            return line.guess(begin, end + 1, f"`{word}(...)` with names belongs to VAL3", None, serves)
    help_ = _WORDS.get(upper)
    if help_ is None:
        return None
    if upper in ("VAR", "PERS", "CONST", "DECL"):
        end = len(line.bare)
    return line.guess(begin, end, f"{word} is no command", None, help_)


def _short(text: str) -> str:
    return text if len(text) < 30 else text[:27] + "..."
