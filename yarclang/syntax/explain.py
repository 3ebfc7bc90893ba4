"""Explain why a statement can't be parsed: a message of one sentence, its place, and a help text."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from typing import Any

from yarclang.syntax.explain_expressions import foreign, no_operand, no_operator, strange
from yarclang.syntax.faults import Fault, called, kind_of, not_closed, unclosed
from yarclang.syntax.leaves import Place, place_of
from yarclang.syntax.lines import end_of

_ORDER = (
    "the order is: index, name, {moving frame}, values, [motion time], (units), {base frame}, options; "
    "a comment starts with `!`"
)
_LET = "write LET PITCH = 60 (mm)"
_FUNC = "write FUNC MID(A, B) = (A + B) / 2"
_SUB = "write SUB DRILL {AT} DEPTH (mm) T (s): a frame in braces, a number's unit after its name"
_CALL = "arguments follow the name, with blanks between: CALL DRILL {HOLE} 20 1.5"

_BEGINNINGS = {"WORD", "INDEX", "CALL", "SUB", "LET", "FUNC", "SETS", "IF", "WHENS", "WAITS", "LONE"}
_RUN = re.compile(r'[^\s;\[\](){}!"]*')
_CUT_FRAME = re.compile(r'([^{}!"]*+[!"])[^{}]*+\}')


def unexpected(text: str, token: Any, expected: Collection[str], stack: Sequence[Any]) -> Fault:
    """Explain an unexpected token in one sentence."""
    place = end_of(text) if token.type == "$END" else place_of(token)
    kinds = [kind_of(one) for one in stack]
    before = kinds[-1] if kinds else ""
    if "NUMBER" in expected:
        return no_operand(text, token, place, stack)
    if "OR" in expected:
        return no_operator(text, token, place, stack)
    if before == "NAMED":
        name = str(stack[-1]).rstrip("= \t")
        help_ = f"write {name.upper()}=4: the value directly follows the `=`"
        return Fault("Y0101", f"no value follows `{name}=`", help_, place)
    if before == "LET":
        return _no_name(token, place)
    if "FUNC" in kinds and "ASSIGN" not in kinds:
        return Fault("Y0101", f"{called(token)} isn't allowed {_place_in_function(kinds)}", _FUNC, place)
    if "ASSIGN" in expected:
        return _no_equals(text, token, place, stack)
    if before == "LONE":
        return _not_alone(token, place, stack)
    if before == "SUB":
        return Fault("Y0101", "SUB is followed by its name", _SUB, place)
    if expected == {"WORD"} and before == "LPAR":
        return _no_unit(text, token, place)
    if expected == {"RPAR"}:
        return _second_unit(token, place, stack)
    if "SUB" in kinds:
        return Fault("Y0101", f"{called(token)} isn't allowed in the head of a SUB", _SUB, place)
    if token.type == "$END":
        return _incomplete(place, expected, stack)
    if token.type not in {"VARIABLE", "OPEN"} and (fault := _dollar(text, place)):
        return fault
    if "RSQB" in expected:
        return unclosed(stack)
    if "COMMA" in expected and token.type in {"LSQB", "FRAME", "LPAR", "STRING"}:
        return unclosed(stack)
    return _out_of_order(token, place, expected, kinds)


def unexpected_character(text: str, place: Place, expected: Collection[str]) -> Fault:
    """Explain a syntax error at a character that begins no token: a brace or quote without its partner, or
    a `$`.
    """
    row = text.split("\n")[place.row]
    character = row[place.start - 1]
    if character == "{":
        return _cut_frame(row, place) or not_closed(character, place)
    if character == '"':
        return Fault("Y0102", "this text is not closed", 'close it with `"` in the same line', place)
    if character == "}":
        return Fault("Y0102", "this `}` has no opening bracket", "remove it", place)
    if "NUMBER" in expected or "OR" in expected:
        return foreign(text, place) or strange(text, place)
    message = f"the character `{character}` (U+{ord(character):04X}) isn't allowed here"
    return _dollar(text, place) or Fault("Y0101", message, _ORDER, place)


def _cut_frame(row: str, place: Place) -> Fault | None:
    """Explain a syntax error in a frame's name that a `!` or a `"` between the braces cuts off; None if this
    isn't the cause.
    """
    match = _CUT_FRAME.match(row, place.start)
    if match is None:
        return None
    here = Place(place.row, match.end(1), match.end(1) + 1)
    help_ = (
        "a frame's name has letters, digits and `_`, and the module's name before a point: {TABLE}, "
        "{PALLET.CORNER}"
    )
    if match[1].endswith('"'):
        return Fault("Y0101", '`"` starts a text, and no text is allowed in braces', help_, here)
    return Fault("Y0102", "`!` starts a comment, and the `{` before it is not closed", help_, here)


# Explanations for LET, END and ELSE, and for units.


def _no_name(token: Any, place: Place) -> Fault:
    if token.type in {"OR", "AND", "NOT"}:
        message = f"{str(token).upper()} is a word of the language and can't be declared"
        return Fault("Y0101", message, "choose another name", place)
    return Fault("Y0101", "LET is followed by the name that is declared", _LET, place)


def _place_in_function(kinds: Sequence[str]) -> str:
    """Return a description of the misplaced item's position in the head of a FUNC."""
    if "RPAR" in kinds and "LPAR" in kinds:
        return "the `=` after the parameters of a FUNC is missing"
    return (
        "between the brackets with the parameters of a FUNC"
        if "LPAR" in kinds
        else "in the name and the parameters of a FUNC"
    )


def _no_equals(text: str, token: Any, place: Place, stack: Sequence[Any]) -> Fault:
    help_ = f"write the unit after the number: {_LET}" if token.type == "LPAR" else _LET
    missing = Fault("Y0101", f"`=` is missing after {stack[-1]}", help_, place)
    return foreign(text, place) or missing


def _not_alone(token: Any, place: Place, stack: Sequence[Any]) -> Fault:
    word = str(stack[-1]).upper()
    help_ = "END ends the innermost block, whatever its kind"
    if word == "ELSE":
        help_ = "write the rest in the next line; an IF there needs its own END"
    return Fault("Y0101", f"{word} must be alone in its line, without {called(token)}", help_, place)


def _no_unit(text: str, token: Any, place: Place) -> Fault:
    if token.type == "$END":
        return not_closed("(", Place(place.row, place.start - 1, place.start))
    match = _RUN.match(text.split("\n")[place.row], place.start - 1)
    message = f"these brackets must hold a unit, not `{match.group() if match else token}`"
    if token.type == "RPAR":
        message = "the brackets have no unit"
    help_ = "write a unit in them, as in 60 (mm), or `*` for a product"
    return Fault("Y0101", message, help_, place)


def _second_unit(token: Any, place: Place, stack: Sequence[Any]) -> Fault:
    if token.type in {"$END", "LSQB", "FRAME", "LPAR", "STRING"}:
        return unclosed(stack)
    message = f"one number has one unit: {called(token)} isn't allowed here"
    return Fault("Y0101", message, "write each unit after its number: 20 (mm) 1.5 (s)", place)


# Explanations for all other lines.


def _incomplete(place: Place, expected: Collection[str], stack: Sequence[Any]) -> Fault:
    if stack and kind_of(stack[-1]) == "COMMA":
        return unclosed(stack)
    if "RSQB" in expected or "RPAR" in expected:
        return unclosed(stack)
    if "NUMBERS" in expected:
        help_ = "write the next waypoint, or remove the semicolon"
        return Fault("Y0101", "the list of waypoints ends with a semicolon", help_, place)
    return Fault("Y0101", "the name of the command is missing", _ORDER, place)


def _dollar(text: str, place: Place) -> Fault | None:
    """Explain that a blank is missing between values and a `$`."""
    row = text.split("\n")[place.row]
    match = _RUN.match(row, place.start - 1)
    run = match.group() if match else ""
    if "$" not in run:
        return None
    place = Place(place.row, place.start, place.start + len(run))
    if run.endswith("$") and row.startswith("(", place.end - 1):
        help_ = "put the whole expression in brackets: $(...)"
        if run in {"-$", "+$"}:
            help_ = "put the sign inside the brackets: $(-(...))"
        return Fault("Y0101", f"`{run}(` can't be read: one value runs into another", help_, place)
    message, help_ = f"`{run}` can't be read: an expression needs brackets", ""
    if run == "$":
        message = "`$` must be followed by a name, or by an expression in round brackets"
        help_ = "write $NAME or $(2*NAME)"
    elif re.fullmatch(r"\$[0-9.]+", run):
        message, help_ = f"`{run}` can't be read", "write the number without `$`"
    elif run.endswith(","):
        message, help_ = f"`{run}` can't be read", "write blanks between values, not commas"
    elif re.search(r"[A-Za-z0-9_.]\$", run):
        message = f"`{run}` can't be read: one value runs into another"
        help_ = "write blanks between values, or $(2*NAME) for a product"
    elif re.fullmatch(r"\$[A-Za-z0-9_.]+", run):
        message, help_ = f"`{run}` can't be read", "write $NAME, or $MODULE.NAME"
    else:
        help_ = f"write $({run.replace('$', '')})"
    return Fault("Y0101", message, help_, place)


def _out_of_order(token: Any, place: Place, expected: Collection[str], kinds: Sequence[str]) -> Fault:
    what = called(token)
    before = kinds[-1] if kinds else ""
    if token.type in {"RSQB", "RPAR"}:
        return Fault("Y0102", f"{what} has no opening bracket", "remove it, or open the bracket", place)
    if before == "_SEMICOLON":
        message = "the list of waypoints ends with a semicolon"
        help_ = "write the next waypoint, or remove the semicolon"
        if token.type == "_SEMICOLON":
            message = "an empty waypoint: there is nothing between two semicolons"
            help_ = "remove one"
        return Fault("Y0101", message, help_, place)
    if "CALL" in kinds or "call" in kinds:
        return Fault("Y0101", f"{what} isn't allowed here", _CALL, place)
    if token.type == "_SEMICOLON" and "NUMBERS" in expected and before != "OPTION":
        message = "an empty waypoint: there is nothing before the semicolon"
        return Fault("Y0101", message, "remove it", place)
    if set(expected) <= _BEGINNINGS:
        message = f"a statement begins with an index and a command's name, not with {what}"
        return Fault("Y0101", message, _ORDER, place)
    return Fault("Y0101", f"{what} isn't allowed here", _ORDER, place)
