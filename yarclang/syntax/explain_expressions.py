"""Explain why an expression can't be parsed."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from yarclang.syntax.faults import Fault, called, kind_of, open_brackets, shown, unclosed
from yarclang.syntax.leaves import Place
from yarclang.syntax.lines import code_of
from yarclang.syntax.words import FUNCTIONS

_ENDS = {"$END", "LSQB", "RSQB", "_SEMICOLON"}
"""Tokens that can only follow an expression, or never occur near one."""

_PIECE = re.compile(r".[^ \t]*")
_LAST_PIECE = re.compile(r'[^\s()+\-*/%<>=,;\[\]{}!"]+$|\S$')

_FOREIGN = {
    "===": "write `=` for equal",
    "==": "write `=` for equal",
    "!=": "write `<>` for unequal; `!` starts a comment",
    "=<": "write `<=` for less or equal",
    "=>": "write `>=` for greater or equal",
    "&&": "write AND",
    "||": "write OR",
    "//": "write FLOOR(a / b)",
    "<<": "write *2 or *2**n",
    ">>": "write FLOOR(a / 2**n)",
    ":=": "write `=`",
    "^": "write `**` for a power",
    "&": "write AND",
    "|": "write OR",
    "~": "write NOT",
    "≤": "write `<=`",
    "≥": "write `>=`",
    "≠": "write `<>`",
    "×": "write `*`",
    "·": "write `*`",
    "÷": "write `/`",
    "²": "write `**2`",
    "³": "write `**3`",
    "√": "write SQRT(...)",
    "π": "write PI",
    "°": "write the unit after the number, `30 (deg)`",
}
_FOREIGN_WORDS = {
    "MOD": "write `%` for the remainder",
    "DIV": "write FLOOR(a / b)",
    "XOR": "write `<>` between two comparisons in brackets",
    "THEN": "end the line after the condition; write the commands in the next lines, up to END",
}


def no_operand(text: str, token: Any, place: Place, stack: Sequence[Any]) -> Fault:
    """Explain a token where a number, a name or a bracket is expected."""
    last = stack[-1]
    if fault := _cut_off(text, token, place) or foreign(text, place):
        return fault
    if token.type == "NOT":
        message = f"NOT isn't allowed after `{last}`, which binds more strongly"
        return Fault("Y0101", message, "put it in brackets: (NOT A)", place)
    if token.type == "VARIABLE":
        message = "inside an expression write names without `$`"
        return Fault("Y0101", message, f"write {str(token)[1:]}", place)
    if token.type == "OPEN":
        return Fault("Y0101", "inside an expression write brackets without `$`", "write (", place)
    if token.type in {"FRAME", "STRING", "OTHER"}:
        return strange(text, place)
    opened = open_brackets(stack)
    innermost = bool(opened) and opened[-1] is last
    if innermost and token.type == "RPAR":
        return Fault("Y0101", "these brackets are empty", "write a number or a name", place)
    if innermost and token.type in _ENDS:
        return unclosed(stack)
    if kind_of(last) == "IF":
        return Fault("Y0101", "the condition after IF is missing", "write IF PITCH > 50", place)
    if kind_of(last) == "WHENS":
        return Fault(
            "Y0101",
            f"the condition after {str(last).upper()} is missing",
            f"write {str(last).upper()} N < 3",
            place,
        )
    if kind_of(last) == "WAITS":
        return Fault(
            "Y0101", "the condition after WAIT is missing", "write WAIT DOOR = ON AND JOB > 2", place
        )
    if kind_of(last) == "ASSIGN":
        return Fault("Y0101", "the value after `=` is missing", "write LET PITCH = 60 (mm)", place)
    help_ = "write a number, a name, or an expression in brackets"
    if str(last) == "%":
        help_ += "; `%` is the remainder of a division"
    return Fault("Y0101", f"a number or name is missing after `{last}`", help_, place)


def no_operator(text: str, token: Any, place: Place, stack: Sequence[Any]) -> Fault:
    """Explain a token where an operator or the end of the expression is expected."""
    if fault := _cut_off(text, token, place) or foreign(text, place):
        return fault
    opened = len(open_brackets(stack))
    if opened and not _is_closed(text, place, opened):
        return unclosed(stack)
    if token.type == "RPAR":
        help_ = "remove it, or open the bracket"
        return Fault("Y0102", "this `)` has no opening bracket", help_, place)
    if token.type == "COMMA":
        help_ = "write a decimal point; commas are allowed only between arguments of functions"
        return Fault("Y0101", "a comma isn't allowed here", help_, place)
    if token.type in {"COMPARE", "ASSIGN"}:
        help_ = "write A < B AND B < C, or put one of them in brackets"
        return Fault("Y0101", f"`{token}` follows another comparison", help_, place)
    if token.type in {*_ENDS, "FRAME", "STRING"}:
        message = f"{called(token)} isn't allowed {'inside' if opened else 'after'} an expression"
        help_ = "close the bracket before it" if opened else "end the line after the expression of LET or IF"
        return Fault("Y0101", message, help_, place)
    if shown(token).upper() in _FOREIGN_WORDS:
        message = f"`{token}` is no operator of the language"
        return Fault("Y0111", message, _FOREIGN_WORDS[shown(token).upper()], place)
    if token.type == "OTHER":
        return strange(text, place)
    return _side_by_side(text, token, place)


def _side_by_side(text: str, token: Any, place: Place) -> Fault:
    """Explain two operands without an operator between them."""
    row = text.split("\n")[place.row]
    piece = _LAST_PIECE.search(row[: place.start - 1].rstrip())
    left, right = piece.group() if piece else "", shown(token)
    if left[:1].isdigit() and row.endswith(left, 0, place.start - 1):
        place = Place(place.row, place.start - len(left), place.end)
        message = f"`{left}{right}` is neither a number nor a name"
        return Fault("Y0101", message, "write `*` for a product", place)
    help_ = "write `*` for a product"
    if left.upper() in FUNCTIONS:
        help_ = f"write {left.upper()}({right})"
    elif right.upper() in {"ON", "OFF"}:
        # `DOOR OFF` is allowed only as a whole condition.
        help_ = f"write `{left} = {right}`"
    elif token.type == "INDEX":
        help_ = "write the command in a line of its own"
    elif token.type == "LPAR":
        help_ = "write `*` for a product; a unit can only follow a number"
    return Fault("Y0101", f"an operator is missing between `{left}` and `{right}`", help_, place)


def _cut_off(text: str, token: Any, place: Place) -> Fault | None:
    """Explain that a `!`, which was meant as an operator, cuts off an expression."""
    row = text.split("\n")[place.row]
    column = len(code_of(row)) + 1
    if token.type != "$END":
        return None
    comment = row[column - 1 :]
    if re.match(r"![A-Za-z_(]", comment) and not row[: column - 1].rstrip().endswith(")"):
        message = "`!` starts a comment, and the expression before it isn't complete"
        return Fault("Y0111", message, "write NOT", Place(place.row, column, column + 1))
    return unequal(comment, place.row, column)


def unequal(comment: str, row: int, column: int) -> Fault | None:
    """Explain that a comment after an expression was meant as the operator `!=`."""
    if comment.startswith("!=") and not comment.startswith("!=="):
        message = "`!=` is no operator of the language"
        return Fault("Y0111", message, _FOREIGN["!="], Place(row, column, column + 2))
    return None


def foreign(text: str, place: Place) -> Fault | None:
    """Explain a syntax error by an operator of another language that begins at this place, or one character
    before it.
    """
    row = text.split("\n")[place.row]
    for column in (place.start - 1, place.start):
        for operator, help_ in _FOREIGN.items():
            end = column + len(operator)
            if column > 0 and end > place.start and row.startswith(operator, column - 1):
                message = f"`{operator}` is no operator of the language"
                return Fault("Y0111", message, help_, Place(place.row, column, end))
    return None


def strange(text: str, place: Place) -> Fault:
    """Explain a token that can't occur in expressions."""
    match = _PIECE.match(text.split("\n")[place.row], place.start - 1)
    piece = match[0][:40] if match else ""
    message = f"`{piece}` isn't allowed in an expression"
    if piece.startswith("$"):
        message = "inside an expression write names without `$`"
    help_ = "use only numbers, names, operators and functions"
    return Fault("Y0101", message, help_, place)


def _is_closed(text: str, place: Place, opened: int) -> bool:
    """Return True if the rest of the row closes all brackets in `opened`."""
    for character in code_of(text.split("\n")[place.row])[place.start - 1 :]:
        opened += (character == "(") - (character == ")")
        if opened == 0:
            return True
    return False
