"""Table of the on-line commands: their forms, and the functions that execute them."""

from __future__ import annotations

import re
from collections.abc import Callable

from yarclang.simulator.online import buffers, controller, motors, systems, variables
from yarclang.simulator.online.line import Line

Action = Callable[[Line, "re.Match[str]"], None]
"""Function that executes a command, called with the match of the command's pattern. The line's reader is at
the end of the match.
"""

_LONE = r"(?![A-Z\d(.$+\-=])"
"""Pattern that follows a single letter. It prevents matching the first letter of a longer word."""


def command_at(text: str, at: int) -> tuple[Action, re.Match[str]] | None:
    """Return the function of the command that begins at index `at` of a text, and the match of its pattern;
    None if no command begins there.
    """
    for pattern, action in _BY_FIRST.get(text[at], ()):
        if found := pattern.match(text, at):
            return action, found
    return None


_COMMANDS: tuple[tuple[str, re.Pattern[str], Action], ...] = tuple(
    (firsts, re.compile(pattern), action)
    for firsts, pattern, action in (
        ("#", r"#(\d+)->((?:I(?!\d)|[0-9.+\-A-CU-Z]+)?)", systems.axes),
        ("#", r"##?(\d{0,3})", motors.address),
        ("&", r"&(\d{0,3})", systems.address),
        ("$", r"\$\$\$(\*\*\*)?", controller.reset),
        ("O", r"OPEN(PROG?|PLC|ROT(?:ARY)?)", buffers.open_buffer),
        ("C", r"CLOSE(ALL)?|CLS(?!\w)", buffers.close),
        ("C", r"(?:CLEAR|CLR)(ALL|PLC)?", buffers.clear),
        (
            "D",
            r"DEF(?:INE)?(ROT(?:ARY)?|GAT(?:HER)?|LOOK(?:AHEAD)?|BLCOMP|TCOMP|COMP|TBUF|UBUF|CCBUF(?:FER)?)",
            buffers.define,
        ),
        (
            "D",
            (
                r"DEL(?:ETE)?(ROT(?:ARY)?|GAT(?:HER)?|LOOK(?:AHEAD)?|BLCOMP|TCOMP|COMP|TBUF|UBUF|TRACE|PLCC?"
                r"|CCBUF(?:FER)?)\d*"
            ),
            buffers.delete,
        ),
        ("EG", r"END(?:GAT(?:HER)?|G)|GAT(?:HER)?(?:TRIGGER)?", controller.nothing),
        ("L", r"LISTP[CE]", systems.program_counter),
        ("L", r"LIST(PROG?|PLC|ROT(?:ARY)?)", buffers.listing),
        ("U", r"UNDEF(?:INE)?(ALL)?", systems.undefine),
        ("EDPR", r"(ENA(?:BLE)?|DIS(?:ABLE)?|PAUSE|RESUME)PLC(C)?", controller.plcs),
        ("P", r"PMATCH", systems.match_positions),
        ("P", r"PR(?!O)", systems.lines_ahead),
        ("P", r"PQ(?!\d|\()", systems.queued),
        ("P", r"P[CE](?![A-Z])", systems.program_counter),
        ("VTCSD", r"VER(?:SION)?|TYPE|CID|VID|SID|DATE|CPU|CHKS|CHECKSUM", controller.fixed),
        ("T", r"TIME", controller.time),
        ("S", r"SAVE", controller.save),
        ("SC", r'(SEND|CMD)[SPRA]?"([^"]*)"?', controller.message),
        ("LSIP", r"LEARN|STN(?:=\d+)?|IDC|PASSWORD=\S*|LOCK|SIZE", controller.nothing),
        ("IPQM", r"([IPQM])(?=\d|\()", variables.variable),
        ("?", r"\?{1,3}", controller.status_words),
        ("%", r"%", systems.override),
        ("B", r"B(\d{1,5}(?:\.\d{1,5})?|(?![A-Z(+\-$.]))", systems.point),
        ("J", r"J([+\-/=^:])", motors.jog),
        ("H", r"(?:HOME|HM)Z?", motors.home),
        ("O", r"O(?=[\d+\-.])", motors.open_loop),
        ("K", rf"K{_LONE}", motors.kill),
        ("R", r"R(H?)([XYDFL]):?\$?([0-9A-F]{1,6})", variables.read_memory),
        ("W", r"W([XYDFL]):?\$?([0-9A-F]{1,6}),", variables.write_memory),
        ("RS", rf"[RS]{_LONE}", systems.run),
        ("QHA/\\", rf"[QHA]{_LONE}|/|\\", systems.order),
        ("PVF", rf"[PVF](?=[PVF]*{_LONE})", motors.report),
    )
)
"""First characters, pattern and function of each command. The first pattern that matches applies."""

_BY_FIRST: dict[str, tuple[tuple[re.Pattern[str], Action], ...]] = {
    first: tuple((pattern, action) for firsts, pattern, action in _COMMANDS if first in firsts)
    for first in sorted({first for firsts, _, _ in _COMMANDS for first in firsts})
}
