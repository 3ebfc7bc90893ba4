"""Completion: the commands, names, frames, units, options and modules that are possible at a place in a
program.

A text to insert contains placeholders such as `${1:x}` for its values. Clients that don't support
placeholders use `plain`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace

from yarclang.assist.candidates import Candidate, NameMaker
from yarclang.assist.cursor import Cursor, cursor_at
from yarclang.assist.signatures import called_sub, given_arguments
from yarclang.assist.snippets import command_snippet, declaration_snippet, next_index, plain_text
from yarclang.assist.view import View
from yarclang.assist.vocabulary import (
    DECLARED,
    OPTIONS,
    OTHERS,
    RATES,
    TIMES,
    Entry,
    action_entries,
    command_names,
    command_of,
    command_text,
    entry_text,
    unit_text,
)
from yarclang.cell.allowances import robot_bodies
from yarclang.cell.tools import NO_TOOL
from yarclang.commands.registry import actions
from yarclang.commands.spec import CommandSpec
from yarclang.decisions import Register
from yarclang.hir import Output
from yarclang.robot.library import list_robots
from yarclang.semantics.declared.watching import REACTIONS
from yarclang.semantics.names.scope import Input, JointPosition, Pose, RackTool, Routine
from yarclang.source import Span
from yarclang.syntax.words import STATES
from yarclang.units import UNITS
from yarclang.words.registry import word_specs
from yarclang.words.spec import Slot, WordSpec


def candidates_at(view: View, line: int, column: int) -> tuple[Candidate, ...]:
    """Return the completion candidates at a place (line and column from 1). They aren't filtered by the
    typed text.
    """
    cursor = cursor_at(view.sketch, line, column)
    text = view.sketch.source.line(line)
    maker = _Maker(view, cursor, Span.on_line(line, cursor.start, column), text[column - 1 : column])
    unique = {(one.label, one.kind): one for one in maker.candidates()}
    return tuple(unique.values())


class _Maker(NameMaker):
    """Creates all completion candidates for a place in a program."""

    def candidates(self) -> Iterator[Candidate]:
        cursor = self.cursor
        if cursor.is_comment:
            yield from self._suppressions()
        elif (cursor.kind in {"number", "index"} and not cursor.is_glued) or cursor.kind == "string":
            return
        elif cursor.kind == "open_frame":
            yield from self.frames(closing=self.behind != "}")
        elif cursor.is_glued:
            yield from self.numbers()
        elif cursor.is_expression:
            yield from self.numbers()
            yield from self.tables()
            if cursor.is_decided:
                yield from self.known(Register, "register")
                yield from self.known(Input, "input")
            else:
                yield from self.functions()
        elif cursor.is_head:
            yield from self._heads()
        elif cursor.bracket == "[":
            yield from self._times()
        elif cursor.bracket == "(":
            yield from self._units()
        else:
            yield from self._parts()

    # Candidates for the first word of a statement.

    def _heads(self) -> Iterator[Candidate]:
        """Yield the commands. If the line has no index, also yield the words of declarations."""
        front = "" if self.cursor.has_index else f"{next_index(self.view.sketch, self.cursor.line)} "
        typed = self.cursor.text.upper()
        for name in command_names():
            found = command_of(name)
            assert found is not None  # `name` is a command's name
            spec, _, _ = found
            suffixes = name.count("_") - spec.name.count("_")
            if suffixes and not (typed.startswith(spec.name) and len(typed) >= len(spec.name)):
                continue  # suffixes give too many names: propose them once the command is written
            text = front + command_snippet(self.view, name)
            yield self.make(name, "command", spec.summary, command_text(name), text, suffixes)
        for name, entry in action_entries().items():
            text = front + declaration_snippet(entry.example)
            yield self.make(name, "command", entry.summary, entry_text(name, entry), text)
        if self.cursor.has_index:
            return
        for name, entry in DECLARED.items():
            yield self.make(
                name,
                "declaration",
                entry.summary,
                entry_text(name, entry),
                declaration_snippet(entry.example),
                3,
            )

    # Candidates for the parts after the first word.

    def _parts(self) -> Iterator[Candidate]:
        head = self.cursor.head
        if (word := word_specs().get(head)) is not None:
            yield from self._slots(word.slots) if word.slots else self._proposed(word)
        elif (action := actions().get(head)) is not None:
            yield from self._slots(action.fullest.slots)
        elif command_of(head) is not None:
            yield from self._of_command(head)

    def _proposed(self, word: WordSpec) -> Iterator[Candidate]:
        """Yield the names of the kind that must follow a word."""
        match word.proposes:
            case "robots":
                for one in list_robots():
                    yield self.make(one.name, "robot", f"{one.title}, {one.size} joints", "", one.name)
            case "modules":
                yield from self.modules()
            case "joints":
                yield from self.known(JointPosition, "joints")
            case "arguments":
                yield from self._arguments()
            case "frames":
                yield from self.frames()
                if all(one.kind == "frame" for one in self.cursor.values):
                    for first, summary in word.first:
                        yield self.make(first, "word", summary, "", first)
            case "values":
                yield from self.known(Register, "register")
                yield from self.known(Input, "input")

    def _of_command(self, head: str) -> Iterator[Candidate]:
        """Yield candidates for a command's frames, joint positions and options."""
        cursor = self.cursor
        if cursor.option == "NEAR":
            yield from self.known(JointPosition, "joints")
            return
        if cursor.option == "ALLOW" and self.view.robot is not None:
            for name in robot_bodies(self.view.robot):
                yield self.make(name.upper(), "word", "a body of the robot", "", name.upper())
        if cursor.option:
            return
        found = command_of(head)
        assert found is not None  # the command was looked up above
        spec, target, _ = found
        if not cursor.has("[") and not cursor.has("("):
            values = spec.targets.get(target)
            if (
                values is not None
                and (values.of_joints or spec.name.startswith("MOVEJ"))
                and not values.is_delta
            ):
                yield from self.known(JointPosition, "joints")
            if values is not None and not values.is_delta and not spec.is_timed and not cursor.values:
                yield from self.known(Pose, "pose")
        if cursor.text == "" or cursor.kind == "open_frame":
            yield from self.frames()
        if spec.is_motion and cursor.values:
            for name, entry in _options(spec, cursor):
                text = declaration_snippet(entry.example)
                yield self.make(name, "option", entry.summary, entry_text(name, entry), text, 1)
        if spec.is_motion and not spec.is_timed and not cursor.has("[") and cursor.values:
            speeds = ("[V ${1:250}]", TIMES["V"]), ("[V<=${1:250}]", TIMES["V<="])
            for text, entry in (("[MIN]", TIMES["MIN"]), *speeds):
                if text != "[V ${1:250}]" or spec.moves_frame:
                    yield self.make(
                        plain_text(text), "time", entry.summary, entry_text(entry.example, entry), text, 2
                    )

    def _slots(self, slots: tuple[Slot, ...]) -> Iterator[Candidate]:
        """Yield inputs, outputs or states, depending on the value that is needed at this place."""
        at = len(self.cursor.before) - 1
        if self.cursor.head == "ON" and at == len(slots) and self.cursor.before[-1].name == "CALL":
            yield from self.known(Routine, "sub")
            return
        slot = slots[at] if at < len(slots) else None
        if slot is Slot.INPUT:
            yield from self.known(Input, "input")
            if self.cursor.head in ("WHEN", "WAIT", "WHILE", "UNTIL"):
                yield from self.known(Register, "register")
        elif slot is Slot.OUTPUT:
            yield from self.known(Output, "output")
            if self.cursor.head == "SET":
                yield from self.known(Register, "register")
        elif slot is Slot.REGISTER:
            yield from self.known(Register, "register")
        elif slot is Slot.TOOL:
            yield from self.known(RackTool, "tool")
            text = "no tool is on the flange afterwards"
            yield self.make(NO_TOOL, "word", text, text, NO_TOOL)
        elif slot is Slot.REACTION:
            for name in REACTIONS:
                yield self.make(name, "word", REACTIONS[name], REACTIONS[name], name)
        elif slot is Slot.STATE:
            for name in sorted(STATES):
                yield self.make(name, "word", OTHERS[name].summary, entry_text(name, OTHERS[name]), name)

    def _arguments(self) -> Iterator[Candidate]:
        """Yield the SUBs; after a SUB's name, the values for its parameters."""
        if len(self.cursor.before) == 1:
            yield from self.known(Routine, "sub")
            return
        yield from self.frames()
        yield from self.known(JointPosition, "joints")
        yield from self.known(Pose, "pose")
        yield from self.known(Input, "input")
        yield from self.known(Output, "output")
        yield from self._names_of_arguments()

    def _names_of_arguments(self) -> Iterator[Candidate]:
        """Yield the parameters that aren't given yet, each with its equals sign."""
        sub = called_sub(self.view, self.cursor)
        given, waits = given_arguments(self.cursor.before[2:])
        if sub is None or waits:
            return
        for one in sub.parameters[given.count("") :]:
            if one.word not in given:
                text = f"{one.word}={{${{1:{one.word}}}}}" if one.name.startswith("{") else f"{one.word}="
                yield self.make(f"{one.word}=", "word", one.written, one.meaning, text)

    # Candidates in brackets.

    def _times(self) -> Iterator[Candidate]:
        if self.cursor.inside:
            return
        found = command_of(self.cursor.head)
        closing = "" if self.behind == "]" else "]"
        for name, entry in TIMES.items():
            if name == "V" and found is not None and not found[0].moves_frame:
                continue
            text = {"MIN": "MIN", "V": "V ${1:250}"}.get(name, "V<=${1:250}")
            yield self.make(name, "time", entry.summary, entry_text(name, entry), text + closing)

    def _units(self) -> Iterator[Candidate]:
        """Yield the units of all kinds for which the brackets have no unit yet."""
        there = {UNITS[one.text.lower()].kind for one in self.cursor.inside if one.text.lower() in UNITS}
        for number, unit in enumerate(UNITS.values()):
            if unit.kind not in there:
                yield self.make(
                    unit.name, "unit", f"a unit of {unit.kind}", unit_text(unit.name), unit.name, number
                )

    # Candidates in comments.

    def _suppressions(self) -> Iterator[Candidate]:
        """Yield the codes of findings, in a comment that suppresses findings."""
        from yarclang.lint.registry import everything

        match = re.search(
            r"!\s*yarc\s*:\s*ignore\s*\[(?:[^\]]*[\s,])?([A-Za-z0-9]*)$", self.cursor.text, re.IGNORECASE
        )
        if match is None:
            return
        column = self.span.end_column - len(match[1])
        said = {
            one.code
            for one in (self.view.checked.diagnostics if self.view.checked else ())
            if one.span and one.span.line == self.cursor.line
        }
        for code, finding in everything().items():
            if finding.severity != "error":
                made = self.make(code, "finding", finding.title, finding.why, code, 0 if code in said else 1)
                yield replace(made, span=self.span._replace(column=column))


_OF_TABLES = ("STRETCH", "TOL", "ALLOW")
"""Options of a motion with a timetable."""


def _options(spec: CommandSpec, cursor: Cursor) -> Iterator[tuple[str, Entry]]:
    """Yield candidates for the options that can still be added to a command. After the time of a waypoint,
    also yield the words for joint speeds.
    """
    names = [one.name for one in cursor.before]
    if spec.is_timed:
        here = names[len(names) - names[::-1].index(";") :] if ";" in names else names
        if "]" in here:
            word = "ACC" if "VEL" in here else "VEL"
            if word not in here:
                yield word, RATES[word]
    for name, entry in OPTIONS.items():
        if (name in _OF_TABLES if spec.is_timed else name != "STRETCH") and name not in names:
            yield name, entry
