"""Parse the text of a program to a syntax tree, one statement at a time.

This is the only module that knows the parser library Lark. Each statement is parsed by itself, so that a
fault causes one finding and doesn't affect other statements, and so that an unchanged statement is parsed
only once.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from functools import cache
from typing import Any

from yarclang.diagnostics import Diagnostic, Edit, Fix, Result
from yarclang.internal_errors import internal_error
from yarclang.memory import Lately
from yarclang.progress import tell
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Module, Place, Statement, Word
from yarclang.syntax.build import statement
from yarclang.syntax.characters import fault_in
from yarclang.syntax.explain import unexpected, unexpected_character
from yarclang.syntax.faults import Fault, FaultError
from yarclang.syntax.lines import code_of, opens_statement
from yarclang.syntax.nodes import Nodes
from yarclang.syntax.plain import GRAMMAR, plain_statement
from yarclang.syntax.words import LONGEST_INDEX

LONGEST_LINE = 100_000
"""Largest length of a line [characters]. A file with a longer line is probably damaged."""

_EVERY = 16
"""Number of statements between two progress reports. A larger number would make reports too rare, since a
statement that can't be parsed takes 1 ms.
"""

LONGEST_TEXT = 20_000_000
"""Largest length of a text that is read [characters]."""


def parse(source: SourceFile) -> Result[Module]:
    """Parse a program.

    Returns:
        The syntax tree of all statements that could be read, and a finding for each that couldn't. The tree
        is never None.
    """
    if len(source.text) > LONGEST_TEXT:
        return Result(Module(source, (), (), ()), (_too_long_text(source),))
    statements: list[Statement] = []
    diagnostics: list[Diagnostic] = []
    unreadable: list[int] = []
    comment_lines: list[tuple[int, str]] = []
    for kept in _LATELY:
        kept.expect(len(source.lines))
    for number, (line, text) in enumerate(_statements(source)):
        if number % _EVERY == 0:
            tell("reading", line, len(source.lines))
        if len(text) > LONGEST_LINE and max(map(len, text.split("\n"))) > LONGEST_LINE:
            diagnostics.append(_too_long(source, line, text))
            unreadable.append(line)
            continue
        try:
            parsed = _placed(text, line)
        except Exception as error:  # a bug of ours: the other lines are still read
            diagnostics.append(internal_error(error, source, Span.on_line(line, 1, 2)))
            unreadable.append(line)
            continue
        if isinstance(parsed, Statement):
            statements.append(parsed)
        elif parsed is None:
            if text and (comment := text.strip()):
                comment_lines.append((line, comment))
        else:
            place = parsed.place
            span = _span(line, place)
            fix = _fix(line, parsed)
            found = Diagnostic(
                parsed.code, parsed.message, source, span, parsed.help, fix, subject=parsed.subject
            )
            diagnostics.append(found)
            unreadable.append(line)
    module = Module(source, tuple(statements), tuple(unreadable), tuple(comment_lines))
    return Result(module, tuple(diagnostics))


def _read_in_place(text: str, line: int) -> Statement | Fault | None:
    """Parse a text that begins in a line of the file. Return the statement at this line, or None if the text
    has only a comment.

    Results are cached by text and line: while a program is edited, most of its lines keep their numbers.
    """
    if not code_of(text).strip():
        return fault_in(text)
    parsed = parse_statement(text)
    return parsed.at_line(line) if isinstance(parsed, Statement) else parsed


def _span(line: int, place: Place) -> Span:
    return Span.on_line(line + place.row, place.start, place.end)


def _fix(line: int, fault: Fault) -> Fix | None:
    """Return the fix of a syntax error in a statement that begins in a line."""
    edits = tuple(Edit(_span(line, place), put) for place, put in fault.edits)
    return Fix(fault.title, edits, uncovers=True) if edits else None


_KEPT = 1024
"""Smallest number of statements that the cache holds. For longer texts, it holds all statements."""

_placed = Lately(_read_in_place, _KEPT)


def _statements(source: SourceFile) -> Iterator[tuple[int, str]]:
    """Yield the text of each statement and the number of its first line. A list of waypoints over several
    lines is one text with line ends.
    """
    lines = source.lines
    at = 0
    while at < len(lines):
        end = at + 1
        text = lines[at]
        if ";" in text and len(text) <= LONGEST_LINE and code_of(text).rstrip().endswith(";"):
            end = _end_of_list(lines, at)
            text = "\n".join(lines[at:end])
        yield at + 1, text
        at = end


def _end_of_list(lines: tuple[str, ...], at: int) -> int:
    """Return the line after a list of waypoints. The list begins in line `at`, which ends with a
    semicolon.
    """
    end = ahead = at + 1
    while ahead < len(lines):
        code = code_of(lines[ahead]) if len(lines[ahead]) <= LONGEST_LINE else "?"
        if not code.strip():
            ahead += 1
            continue
        if opens_statement(code) or code == "?":
            return end
        end = ahead = ahead + 1
        if not code.rstrip().endswith(";"):
            return end
    return end


def _too_long(source: SourceFile, line: int, text: str) -> Diagnostic:
    return Diagnostic(
        "Y0106",
        f"this line has {len(text):,} characters; the limit is {LONGEST_LINE:,}",
        source,
        Span.on_line(line, 1, 2),
        "break a waypoint list after a semicolon, or check that the right file was given",
    )


def _too_long_text(source: SourceFile) -> Diagnostic:
    message = f"this text has {len(source.text):,} characters; the limit is {LONGEST_TEXT:,}"
    help_ = "divide the program, or check that the right file was given"
    return Diagnostic("Y0106", message, source, Span.on_line(1, 1, 2), help_)


def _read(text: str) -> Statement | Fault:
    """Parse the text of one statement; `line` of the result is 0 until the caller sets it."""
    if (wrong := fault_in(text)) is not None:
        return _operator_instead(text, wrong) or wrong
    plain = plain_statement(text)
    parsed = statement_by_grammar(text) if plain is None else plain
    if isinstance(parsed, Statement) and parsed.index and len(parsed.index.text) > LONGEST_INDEX + 1:
        return _long_index(parsed.index)
    return parsed


def _long_index(index: Word) -> Fault:
    message = (
        f"the index {index.text} has {len(index.text) - 1:,} digits; at most {LONGEST_INDEX} are allowed"
    )
    return Fault("Y0119", message, "write a smaller number: P0010", index.place)


def _operator_instead(text: str, wrong: Fault) -> Fault | None:
    """Return a syntax error for an operator of another language, such as `×`, with the right operator in
    the help.
    """
    if wrong.code != "Y0118" or wrong.edits:
        return None
    parsed = statement_by_grammar(text)
    return parsed if isinstance(parsed, Fault) and parsed.code == "Y0111" else None


parse_statement = Lately(_read, _KEPT)

_LATELY: tuple[Lately[Any], ...] = (_placed, parse_statement)


def forget() -> None:
    """Clear the caches of statements. They save time only if the same lines are parsed again."""
    for kept in _LATELY:
        kept.cache_clear()


def statement_by_grammar(text: str) -> Statement | Fault:
    """Parse the text of any statement by the grammar, without the faster parser for common statements. The
    result is the same as that of `_read`.
    """
    from lark.exceptions import UnexpectedCharacters, UnexpectedToken

    try:
        return statement(text, _parser().parse(text))
    except FaultError as error:
        return error.fault
    except UnexpectedToken as error:
        return unexpected(text, error.token, set(error.accepts or error.expected), _stack(error))
    except UnexpectedCharacters as error:
        place = Place(error.line - 1, error.column, error.column + 1)
        parser: Any = error.interactive_parser
        return unexpected_character(text, place, parser.accepts())


def _stack(error: Any) -> list[Any]:
    """Return the tokens and trees that the parser has read but not yet combined. Unfinished lists are left
    out.
    """
    return [one for one in error.state.value_stack if not str(getattr(one, "data", "")).startswith("__")]


TABLES = GRAMMAR.with_suffix(".json")
"""File with the parser's tables, which Lark computes from the grammar and `made_tables` writes."""


@cache
def _parser() -> Any:
    grammar = GRAMMAR.read_text(encoding="utf-8")
    return _loaded(grammar) or _built(grammar, Nodes())


def _built(grammar: str, transformer: Nodes | None) -> Any:
    from lark import Lark

    return Lark(grammar, start="statement", parser="lalr", maybe_placeholders=False, transformer=transformer)


def _loaded(grammar: str) -> Any:
    """Return a parser with saved tables, since computing the tables takes 60 ms. None if the saved tables
    belong to another grammar or another version of Lark.
    """
    import lark

    try:
        kept = json.loads(TABLES.read_text(encoding="utf-8"))
    except (OSError, ValueError):  # an installation without the file, or with a damaged one, still parses
        return None
    if kept.get("of") != _key(grammar):
        return None
    data, tables = kept["data"], kept["data"]["parser"]["parser"]
    # JSON has only texts as keys, so convert them back to numbers.
    tables["tokens"] = _by_number(tables["tokens"])
    tables["states"] = {state: _by_number(actions) for state, actions in _by_number(tables["states"]).items()}
    parser: Any = lark.Lark
    return parser._load_from_dict(data, _by_number(kept["memo"]), transformer=Nodes())


def _by_number(content: dict[str, Any]) -> dict[int, Any]:
    return {int(key): one for key, one in content.items()}


def _key(grammar: str) -> str:
    """Return a hash of everything on which the parser's tables depend."""
    import lark

    return f"lark {lark.__version__}, grammar {hashlib.sha256(grammar.encode()).hexdigest()}"


def made_tables() -> str:
    """Compute the content of the file `TABLES` (the parser's tables) from the grammar. Two runs may give
    different files, since Lark numbers the states in an arbitrary order.
    """
    from lark.grammar import Rule
    from lark.lexer import TerminalDef

    grammar = GRAMMAR.read_text(encoding="utf-8")
    data, memo = _built(grammar, None).memo_serialize([TerminalDef, Rule])
    return json.dumps({"of": _key(grammar), "data": data, "memo": memo}, separators=(",", ":")) + "\n"
