"""Hover texts: the explanation of the command, frame, name or word at a place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from yarclang.assist.declared import meaning_of
from yarclang.assist.lexemes import Lexeme, lexeme_at
from yarclang.assist.motions import MotionFacts, facts_of, first_motion, pace_in
from yarclang.assist.pose_lines import joints_text
from yarclang.assist.view import View
from yarclang.assist.vocabulary import DECLARED, command_text, unit_text, word_text
from yarclang.certify.outward import down, least, percent
from yarclang.findings.finding import Finding
from yarclang.report.inspection.limits import Pace
from yarclang.report.pose_text import pose_text
from yarclang.source import Span
from yarclang.syntax.ast import Statement
from yarclang.units import MM


@dataclass(frozen=True, slots=True)
class Hover:
    """An explanation that is shown when the mouse rests on a word of a program.

    Attributes:
        text: the explanation in Markdown.
        span: the range that the text explains.
    """

    text: str
    span: Span


def hover_at(view: View, line: int, column: int) -> Hover | None:
    """Return the explanation of the word at a place (line and column from 1); None if there is none."""
    text = view.sketch.source.line(line)
    lexeme = lexeme_at(text, column)
    if lexeme is None or lexeme.kind in {"open_frame", "string"}:
        return None
    span = Span.on_line(line, lexeme.start, lexeme.end)
    if lexeme.kind == "comment":
        return _of_suppression(line, lexeme, column)
    named = view.sketch.named_at(line, column)
    if named is not None:
        found = meaning_of(view, named, line)
        where = span if lexeme.kind == "frame" and "." not in lexeme.text else named.span
        return Hover("\n".join(found), where) if found else None
    statement = view.sketch.statement_at(line)
    lines = list(_of_word(view, statement, line, lexeme))
    return Hover("\n".join(lines), span) if lines else None


def _of_word(view: View, statement: Statement | None, line: int, lexeme: Lexeme) -> Iterator[str]:
    """Yield the paragraphs that explain a word of the language and its command. For a number, explain its
    command.
    """
    word = lexeme.name
    if statement is None:
        text = command_text(word) or word_text(word) or unit_text(word)
        yield from [text] if text and lexeme.kind == "word" else []
        return
    is_head = line == statement.line and lexeme.start == statement.name.place.start
    head = statement.name.name
    if statement.index is None and head in DECLARED:
        text = command_text(head) if is_head else _inner_word(lexeme)
        yield from [text] if text else []
        return
    if lexeme.kind == "word" and not is_head:
        if text := _inner_word(lexeme):
            yield text
        return
    if lexeme.kind in {"mark", "frame"}:
        return
    known = list(command_lines(view, line))
    yield from known
    if is_head and (text := command_text(head)):
        yield from ["", "---", "", text] if known else [text]


def _inner_word(lexeme: Lexeme) -> str:
    """Return the explanation of a word after the first one of a line."""
    return unit_text(lexeme.text) or word_text(lexeme.name)


def _of_suppression(line: int, lexeme: Lexeme, column: int) -> Hover | None:
    """Return the explanation of a finding's code in a comment that suppresses the finding."""
    import re

    from yarclang.lint.registry import codes_of, everything

    for match in re.finditer(r"[Yy]\d{4}", lexeme.text):
        start = lexeme.start + match.start()
        if start <= column <= start + 5:
            codes = codes_of(match[0].upper())
            if codes:
                return Hover(finding_text(everything()[codes[0]]), Span.on_line(line, start, start + 5))
    return None


def finding_text(finding: Finding) -> str:
    """Return the explanation of a finding, in Markdown."""
    lines = [f"**{finding.code} {finding.name}** ({finding.severity}): {finding.title}", "", finding.why]
    for title, text in (("For example", finding.example), ("Better", finding.better)):
        if text:
            lines += ["", f"{title}:", "", "```yarc", *text.splitlines(), "```"]
    return "\n".join(lines)


def command_lines(view: View, line: int) -> Iterator[str]:
    """Yield the facts about the motion in a line, such as its duration, in Markdown; nothing for other lines.

    This may plan the motion once more.
    """
    known, there = view.planned_at(line) or (view, line)
    steps = known.steps_in(there)
    number = first_motion(known, steps)
    if number is None or (facts := facts_of(known, number)) is None:
        return
    yield from motion_lines(known, facts, pace_in(known, number))
    if len(steps) > 1:
        yield f"- the first of {len(steps):,} times: {facts.label}"
    if known is not view:
        yield "- as it was before the last edits"


def motion_lines(view: View, facts: MotionFacts, pace: Pace | None) -> Iterator[str]:
    """Yield the lines for one motion."""
    robot = view.robot
    assert robot is not None
    if facts.in_base is not None:
        yield f"- ends with `{{{facts.frame}}}` in `{{{facts.base}}}` at {pose_text(facts.in_base)}"
    if facts.in_world is not None:
        yield f"- ends with `{{{facts.frame}}}` in `{{B}}` at {pose_text(facts.in_world)}"
    if facts.joints is not None:
        yield f"- joints {joints_text(robot, facts.joints)}"
    if facts.duration is None:
        yield "- not planned: the program has errors" if view.checked else "- being planned"
        return
    shortest = f", at least {pace.shortest:.3f} s" if pace is not None and pace.shortest is not None else ""
    yield f"- takes {facts.duration:.3f} s{shortest}, from {facts.begins:.3f} s on"
    if (load := facts.load) is not None:
        yield f"- nearest limit: {load[0]} of {load[1].name}, {percent(load[1].share)} %"
    if facts.certificate is not None and facts.certificate.position.name:
        position = facts.certificate.position
        yield f"- farthest joint: {position.name}, {percent(position.share)} % of the range to its limit"
    yield f"- smallest singular value {facts.smallest:.3f}"
    if (clear := facts.clearance) is not None:
        between = f" ({clear.first} and {clear.second})" if clear.first else ""
        yield f"- clearance at least {down(least(clear.distance, MM), 1)} mm{between}"
