"""Recognise blocks, conditions and assignments written as in other languages, and several commands on a
line.
"""

from __future__ import annotations

import re

from yarclang.mistakes.line import Guess, Line
from yarclang.semantics.names.commands import is_command

_ENDS = re.compile(
    r"(?P<index>\s*)(?P<word>END[_ ]?(?:IF|FOR|WHILE|REPEAT|WHEN|CASE|SUB|SWITCH|SELECT|LOOP|PROC|FCT|DEF"
    r"|FUNCTION)|NEXT|FI|OD|DONE|WEND|ENDSUB|\})\s*(?:[A-Za-z_]\w*)?\s*;?\s*$",
    re.I,
)
_MAIN = re.compile(r"END[_ ]?(?:PROC|FCT|DEF|FUNCTION)", re.I)
_OPERATORS = {"==": "=", "!=": "<>", "/=": "<>", "&&": "AND", "||": "OR", ":=": "=", "=>": ">=", "=<": "<="}
_SIGNS = re.compile(r"==|!=|/=|&&|\|\||:=|=>|=<")
_THEN = re.compile(r"(?:\s+(?P<word>THEN|DO|\{)|\s*(?P<sign>:))\s*$", re.I)
_ELSE_IF = re.compile(r"\s*(?P<word>ELSE\s?IF|ELIF|ELSIF)\b.*", re.I)
_ASSIGNED = re.compile(r"\s*(?P<name>[A-Za-z_][A-Za-z0-9_]*)\s*:?=(?!=)\s*(?P<value>[^=].*?)\s*;?\s*$")
_SECOND = re.compile(r"(?<=\s)(?P<index>[Pp][0-9]{2,9})\s+(?P<word>[A-Za-z_]+)")


def end(line: Line) -> Guess | None:
    """Recognise ENDIF, END IF and similar words."""
    found = _ENDS.fullmatch(line.bare)
    if found is None or (found["word"].upper() in ("DONE",) and line.values.strip()):
        return None
    if _MAIN.fullmatch(found["word"]) and not line.around.has_open_block(line.number):
        return None  # this word ends the whole program, not a block
    if found["word"] == "}" and not line.around.has_open_block(line.number):
        return None
    begin = found.start("word")
    apart = re.match(r"END\s+(?P<kind>\w+)", line.bare[begin:], re.I)
    at = begin + apart.start("kind") if apart else begin
    repaired = f"{line.text[:begin]}END{line.comment and ' ' + line.comment.lstrip()}"
    guess = Guess(at, len(line.bare.rstrip("; ")), "every block ends with END alone", "write END", repaired)
    guess.ends_block = True
    return guess


def condition(line: Line) -> Guess | None:
    """Recognise THEN, and operators of other languages."""
    word = line.word.upper()
    if word in ("IF", "WHEN", "REPEAT", "LET", "FUNC", "SET", "WHILE", "UNTIL", "WAIT"):
        # Search in the whole text: `bare` lacks the text after the ! of !=, which counts as a comment.
        if (found := _SIGNS.search(line.text, line.behind)) and '"' not in line.text[: found.start()]:
            meant = _OPERATORS[found[0]]
            return line.guess(
                found.start(),
                found.end(),
                f"`{found[0]}` is no operator of the language",
                meant,
                _how(line, found, meant),
            )
        if (found := _THEN.search(line.bare)) and word in ("IF", "WHEN", "WHILE", "REPEAT"):
            kind = "word" if found["word"] else "sign"
            return line.guess(
                found.start(kind), found.end(kind), f"`{found[kind]}` isn't allowed after the condition", "",
                "remove it, and write the commands in the next lines, up to END",
            )  # fmt: skip
    if found := re.fullmatch(r"\s*(?P<word>ELSE|LOOP)\s*(?P<sign>:|THEN|DO|\{|;)", line.bare, re.I):
        repaired = f"{line.text[: found.end('word')]}{line.comment and ' ' + line.comment}"
        what = f"`{found['sign']}` isn't allowed after {found['word']}"
        return Guess(found.start("sign"), found.end("sign"), what, "remove it", repaired)
    inputs = [one.upper() for one in line.around.declared.get("INPUT", ())]
    found = re.match(r"\s+(?P<name>[A-Za-z_]\w*)", line.values)
    negated = re.fullmatch(r"\s+(?P<all>NOT\s+(?P<name>[A-Za-z_]\w*))", line.values, re.I)
    if word in ("IF", "WHEN") and negated and negated["name"].upper() in inputs:
        at, name = line.behind + negated.start("all"), negated["name"]
        message = f"{name} is an input: it is read only when the program runs"
        help_ = f"write WHEN {name} OFF ... ELSE ... END"
        return line.guess(at, len(line.bare), message, None, help_)
    if word == "IF" and found and found["name"].upper() in inputs:
        at, name = line.behind + found.start("name"), found["name"]
        return line.guess(
            at,
            at + len(name),
            f"IF can't read the input {name}: it is decided before the program runs",
            None,
            f"write WHEN {name} ON ... ELSE ... END, which is decided when the program runs",
        )
    if found := _ELSE_IF.fullmatch(line.bare):
        return line.guess(
            found.start("word"), len(line.bare), f"{found['word']} : ELSE must be alone in its line",
                None,
            "write ELSE, then IF in the next line, and an END for each of both",
        )  # fmt: skip
    return None


def _how(line: Line, found: re.Match[str], meant: str) -> str:
    if line.word.upper() == "LET":
        return f"write {line.text[: found.start()].strip()} {meant} {line.text[found.end() :].strip()}"
    return f"write {meant}" + ("; `!` starts a comment" if found[0] == "!=" else "")


def assignment(line: Line) -> Guess | None:
    """Recognise LET without its equals sign, and an equals sign without LET."""
    if line.word.upper() == "LET":
        found = re.fullmatch(r"\s+(?P<name>[A-Za-z_]\w*)\s+(?P<value>[-+$0-9(].*)", line.values)
        if found is None:
            return None
        at = line.behind + found.start("value")
        repaired = f"{line.text[:at]}= {line.text[at:]}"
        shown = repaired.strip().partition(" !")[0].strip()
        return Guess(at, len(line.bare), "`=` is missing", f"write {shown}", repaired)
    if line.is_declaration or line.is_command:
        return None
    found = _ASSIGNED.fullmatch(line.bare, len(line.index))
    if found is None:
        return None
    name, value = found["name"], found["value"]
    is_register = name.upper() in {one.upper() for one in line.around.declared.get("REGISTER", ())}
    if not re.fullmatch(r"[\w\s.+*/()$-]+" if is_register else r"[-+0-9.$(][\w\s.+*/()$-]*", value):
        return None
    if is_register:
        put = f"SET {name} = {value}"
    elif line.index.strip():
        return None
    else:
        put = f"LET {name} = {value}"
    return line.guess(found.start("name"), len(line.bare), f"{name} is no command", put)


def hold(line: Line) -> Guess | None:
    """Recognise the text of a HOLD without quotes, or in other quotes."""
    if line.word.upper() != "HOLD" or not line.values.strip():
        return None
    at = line.behind + len(line.values) - len(line.values.lstrip())
    said = line.text[at:].rstrip()
    if said.startswith('"') and said.endswith('"') and said.count('"') == 4:
        inner = said[1:-1].replace('"', "'")
        message = "quotes aren't allowed inside a text"
        return line.guess(at, at + len(said), message, None, f'write "{inner}"')
    if said.startswith('"') and said.count('"') == 1:
        inner = said[1:]
    elif said[0] in "'`" and said[-1] in "'`" and len(said) > 1:
        inner = said[1:-1]
    elif re.match(r"[A-Za-z]+(\s|$)", said) and '"' not in said and "[" not in said and "!" not in said:
        inner = said
    else:
        return None
    what = "this text is not closed" if said.startswith('"') else "a text must be in double quotes"
    return line.guess(at, at + len(said), what, f'"{inner}"')


def several(line: Line) -> Guess | None:
    """Recognise two commands on a line, a semicolon at the end of a line, and empty brackets after a CALL."""
    if line.is_command and (found := _SECOND.search(line.bare, line.behind)) and is_command(found["word"]):
        first = line.text[: found.start()].rstrip()
        begin, end = found.start("index"), found.end("index")
        if first.endswith(";"):
            first, begin, end = first[:-1].rstrip(), len(first) - 1, len(first)
        both = (first, line.text[found.start("index") :])
        return Guess(
            begin,
            end,
            f"a line can have only one command, and {found['index']} begins a second one",
            "write it in a line of its own",
            *both,
        )
    if (line.is_command or line.is_declaration) and line.bare.endswith(";"):
        bare = line.bare.rstrip("; ")
        if line.after[:1].isspace() and re.match(r"\s+[-+]?[0-9.]", line.after):
            return None
        at = len(bare)
        return line.guess(at, len(line.bare), "a command doesn't end with `;`", "", "remove the `;`")
    if line.word.upper() == "CALL" and (
        found := re.fullmatch(r"\s+[A-Za-z_][\w.]*\s*(?P<all>\(\s*\))", line.values)
    ):
        at = line.behind + found.start("all")
        return line.guess(
            at,
            at + len(found["all"]),
            "a CALL takes no brackets",
            "",
            f"write {line.bare[line.begin : at].strip()}",
        )
    if line.is_motion and (found := re.match(r"\s*(?P<sign>:?=)\s+", line.values)):
        at = line.behind + found.start("sign")
        repaired = f"{line.text[: line.behind]} {line.text[line.behind + found.end() :]}"
        return Guess(
            at,
            at + len(found["sign"]),
            f"`{found['sign']}` isn't allowed after {line.word}",
            "remove it",
            repaired,
        )
    return None
