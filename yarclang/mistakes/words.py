"""Recognise mistakes in the name of a command: wrong suffixes, relative motions, and misspelt words."""

from __future__ import annotations

import re

from yarclang.commands.registry import actions, commands
from yarclang.mistakes.line import Guess, Line, is_number, only
from yarclang.motion.profile import profile_names
from yarclang.semantics.names.commands import is_command
from yarclang.suggestions import is_slip, near
from yarclang.syntax.words import AVOID, DECLARATIONS

_TARGETS = ("RPY", "QUAT")
_RELATIVE = re.compile(
    r"(?:R|REL|D|INC|I)_?(?:MOVE|LMOVE|MOV|LIN|MOVEL|PTP)[LR]?(?:_.*)?|(?:MOVE|MOV|LIN|PTP)[LJC]?_?(?:REL"
    r"|RELATIVE|INC|DELTA|OFFSET|OFFS)",
    re.I,
)
_APART = re.compile(r"(?P<sign>\s*[-.]\s*|\s+)(?P<suffix>[A-Za-z][A-Za-z0-9]*)(?=\s|$)")
_POSITION = 3
"""Number of values of a position."""

_SAME = {"DMOVEL": "DMOVE", "DMOVEC": "DMOVE", "DMOVE_L": "DMOVE", "DMOVE_J": "DMOVEJ"}


def suffix(line: Line) -> Guess | None:
    """Recognise a suffix that is mistyped, after a blank or hyphen, or in the wrong order."""
    if not line.is_motion:
        return None
    upper = line.word.upper()
    base = max((one for one in commands() if upper == one or upper.startswith(one + "_")), key=len)
    spec = commands()[base]
    laws = tuple(profile_names()) if spec.is_motion and not spec.is_timed else ()
    known = (*(one for one in spec.targets if one), *((AVOID,) if spec.may_avoid else ()), *laws)
    apart = _APART.match(line.values)
    if apart and apart["suffix"].upper() in known and f"_{apart['suffix'].upper()}" not in upper:
        name = f"{line.word}_{apart['suffix'].upper()}"
        begin = line.behind + apart.start("suffix") if apart["sign"].isspace() else line.begin
        end = line.behind + apart.end()
        repaired = line.text[: line.begin] + name + line.text[end:]
        return Guess(
            begin, end, f"a suffix is written directly after its command: {name}", f"write {name}", repaired
        )
    own = [one for one in upper[len(base) :].split("_") if one]
    if not own:
        return None
    unknown = [one for one in own if one not in known]
    if not unknown:
        rank = {one: number for number, one in enumerate(known)}
        kinds = [0 if one in spec.targets else 1 if one == AVOID else 2 for one in own]
        if kinds != sorted(kinds) and len(set(kinds)) == len(kinds):
            name = "_".join(
                (
                    base,
                    *(
                        one
                        for _, one in sorted(
                            zip(kinds, own, strict=True), key=lambda each: (each[0], rank[each[1]])
                        )
                    ),
                )
            )
            return line.guess(
                line.begin, line.behind, f"the suffixes of {line.word} are in the wrong order", name
            )
        return None
    at = line.begin + upper.index(f"_{unknown[0]}", len(base))
    end = at + 1 + len(unknown[0])
    if re.fullmatch(r"REL.*|INC.*|DELTA|OFFS.*", unknown[0]):
        return None
    meant = only(unknown[0], known)
    takes = ", ".join(f"_{one}" for one in known) or "none"
    if meant and meant not in own:
        return line.guess(
            at,
            end,
            f"{base} has no suffix _{unknown[0]}",
            f"_{meant}",
            f"write {upper[: at - line.begin]}_{meant}",
        )
    return line.guess(at, end, f"{base} has no suffix _{unknown[0]}", None, f"its suffixes are {takes}")


def relative(line: Line) -> Guess | None:
    """Recognise a foreign word for a relative motion. An absolute motion is never suggested."""
    upper = line.word.upper()
    if (meant := _SAME.get(upper)) is not None:
        if len(line.values.split()) == _POSITION and all(map(is_number, line.values.split())):
            help_ = f"write {meant} {line.values.strip()} 0 0 0: the increment, then no rotation"
            return line.guess(line.begin, line.behind, f"{line.word} is no command", meant, help_)
        return line.guess(line.begin, line.behind, f"{line.word} is no command", meant)
    if _RELATIVE.fullmatch(upper) and not (is_command(upper) and upper in commands()):
        return line.guess(
            line.begin, line.behind, f"{line.word} is no command", None,
            "relative motions are DMOVE, for the moving frame, and DMOVEJ, for the joints; "
            "MOVEL and MOVEJ are absolute",
        )  # fmt: skip
    return None


def word(line: Line) -> Guess | None:
    """Recognise a word that is no command, and suggest similar known words."""
    upper = line.word.upper()
    if not upper or line.is_command or line.is_declaration or line.values.lstrip()[:1] in ("=", ":", "("):
        return None
    if upper in {one.upper() for one in line.around.declared.get("SUB", ())}:
        repaired = f"{line.text[: line.begin]}CALL {line.text[line.begin :]}"
        return Guess(
            line.begin,
            line.behind,
            f"{line.word} is a SUB, which CALL carries out",
            f"write CALL {line.word}",
            repaired,
        )
    if upper in ("MOVE", "MOV"):
        return line.guess(
            line.begin, line.behind, f"{line.word} is no command", None,
            "write MOVEJ (in joint space), MOVEJ_RPY (in joint space, to a pose), MOVEL (straight) or "
            "DMOVE (relative)",
        )  # fmt: skip
    known = {*commands(), *actions(), "CALL"}
    likely = near(upper, (*known, *DECLARATIONS))
    slips = tuple(one for one in likely if is_slip(upper, one))
    likely = slips if len(slips) == 1 else likely
    if len(likely) == 1:
        return line.guess(
            line.begin, line.behind, f"{line.word} is no command", likely[0], f"did you mean {likely[0]}?"
        )
    help_ = (
        f"did you mean {', or '.join(sorted(likely))}?"
        if likely
        else f"the commands are {', '.join(sorted(known))}"
    )
    return line.guess(line.begin, line.behind, f"{line.word} is no command", None, help_)
