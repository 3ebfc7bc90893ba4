"""Build an outline of a program as a tree: its branches and loops with their durations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from yarclang.decisions import SHIFTS, called, in_words, registers_of
from yarclang.frozen import frozen
from yarclang.hir import (
    Assign,
    Dwell,
    Else,
    EndLoop,
    EndWhen,
    Exit,
    Finish,
    Gap,
    Hold,
    JointMove,
    LineMove,
    Loop,
    MotionHead,
    NextPass,
    Offset,
    Say,
    Search,
    SetOutput,
    Step,
    Stop,
    WaitInput,
    WaitUntil,
    When,
)
from yarclang.lasting import Lasting, Part, schedule_of
from yarclang.motion.plan import MotionPlan


@frozen
class Row:
    """A line in the outline of a program.

    Attributes:
        depth: number of enclosing branches and loops.
        kind: `step`, `way` (a branch), `loop` or `block`.
        label: the command's place; for a command without an index, its line.
        text: description of the step.
        takes: duration of a motion, a branch, or one pass of a loop; None for others.
        step: number of the step in the program.
    """

    depth: int
    kind: str
    label: str
    text: str
    takes: Lasting | None
    step: int

    def to_json(self) -> dict[str, Any]:
        """Return the line of the outline as plain data."""
        takes = None if self.takes is None else self.takes.to_json()
        return {
            "depth": self.depth,
            "kind": self.kind,
            "place": self.label,
            "text": self.text,
            "takes": takes,
            "step": self.step,
        }


def outline_of(plan: MotionPlan) -> tuple[Row, ...]:
    """Return the tree of a planned program."""
    return tuple(_Outline(plan.program.steps, plan.parts).rows())


class _Outline:
    """Builder of a program's tree."""

    def __init__(self, steps: Sequence[Step], parts: Sequence[Part]) -> None:
        self._steps, self._parts = steps, parts
        self._ends = _ends(steps)
        self._found = {
            one.search.flag: one.search.name
            for one in steps
            if isinstance(one, JointMove | LineMove) and one.search is not None
        }
        """Names of the inputs for which the program searches, by the register that becomes 1 when the input
        is found.
        """

    def rows(self) -> Iterator[Row]:
        """Yield the lines from the first step on."""
        yield from self._range(0, len(self._steps), 0)

    def _range(self, begin: int, end: int, depth: int) -> Iterator[Row]:
        number = begin
        while number < end:
            step = self._steps[number]
            if isinstance(step, Loop):
                yield from self._loop(number, depth)
                number = self._ends[number][1] + 1
            elif isinstance(step, When):
                yield from self._when(step, number, depth)
                number = self._ends[number][1] + 1
            elif isinstance(step, Assign) and step.target in self._found:
                number += 1
            else:
                if (text := _text(step)) and not isinstance(step, Gap):
                    part = self._parts[number]
                    takes = (
                        self._branch_taken(number, number + 1) if part and isinstance(part, float) else None
                    )
                    yield Row(depth, "step", _label(step), text, takes, number)
                number += 1

    def _loop(self, number: int, depth: int) -> Iterator[Row]:
        step, end = self._steps[number], self._ends[number][1]
        is_sub = not any(isinstance(one, NextPass) for one in self._steps[number:end])
        # the longest duration of a loop is the duration of a whole pass; the shortest is the time until the
        # loop is left
        told = self._branch_taken(number, end + 1)
        if not any(isinstance(one, Loop) for one in self._steps[number + 1 : end]):
            told = replace(told, loops=False)
        text = "a SUB that some branches leave" if is_sub else "repeated; one pass"
        assert isinstance(step, Loop)
        yield Row(
            depth, "block" if is_sub else "loop", _label(step), f"{step.origin.name}: {text}", told, number
        )
        yield from self._range(number + 1, end, depth + 1)

    def _when(self, step: When, number: int, depth: int) -> Iterator[Row]:
        middle, end = self._ends[number]
        limit = "" if step.within is None else f", within {step.within:g} s"
        first = end if middle is None else middle
        shift_text = in_words(step.condition) if step.again else _said(step)
        for flag in self._found.keys() & set(registers_of(step.condition)):
            shift_text = f"{self._found[flag]} is found"
        if step.offset is not None:
            shift_text = (
                f"{{{step.offset.name}}} by {offset_words(step.offset)}, if the lines can be carried out "
                "there"
            )
        text = f"{step.origin.name} {shift_text}{limit}"
        yield Row(depth, "way", _label(step), text, self._branch_taken(number + 1, first), number)
        yield from self._range(number + 1, first, depth + 1)
        if middle is not None:
            other = self._steps[middle]
            assert isinstance(other, Else)
            yield Row(depth, "way", _label(other), "ELSE", self._branch_taken(middle + 1, end), middle)
            yield from self._range(middle + 1, end, depth + 1)

    def _branch_taken(self, begin: int, end: int) -> Lasting:
        return schedule_of(self._parts[begin:end]).lasting


def _ends(steps: Sequence[Step]) -> dict[int, tuple[int | None, int]]:
    """Return for each WHEN and loop the numbers of the steps with its ELSE (None without an ELSE) and its
    END. A WHEN or loop without END ends with the program.
    """
    ends: dict[int, tuple[int | None, int]] = {}
    opened: list[tuple[int, int | None]] = []
    for number, step in enumerate(steps):
        match step:
            case When() | Loop():
                opened.append((number, None))
            case Else() if opened:
                opened[-1] = opened[-1][0], number
            case EndWhen() | EndLoop() if opened:
                begin, middle = opened.pop()
                ends[begin] = middle, number
            case _:
                pass
    return ends | {begin: (middle, len(steps)) for begin, middle in opened}


def offset_words(offset: Offset) -> str:
    """Return the registers that shift a frame: `X DX, RZ TURN`."""
    both = zip(SHIFTS, offset.registers, strict=True)
    return ", ".join(f"{axis} {register}" for axis, register in both if register)


def _said(step: When) -> str:
    named = called(step.condition)
    whole = in_words(step.condition)
    return whole if named in whole else f"{named}: {whole}"


def _label(step: Step) -> str:
    assert not isinstance(step, Gap)  # steps with errors have no line in the outline
    return step.origin.label or f"line {step.origin.span.line}"


def _text(step: Step) -> str:
    """Return a step's description in a few words; empty for the end of a block."""
    match step:
        case JointMove(search=Search(name=name)) | LineMove(search=Search(name=name)):
            return f"{step.origin.name} UNTIL {name}"
        case MotionHead() | Dwell() | Exit() | Stop():
            return step.origin.name
        case SetOutput(tool=str(tool)):
            return f"TOOL {tool or 'NONE'}"
        case SetOutput(output=output, value=value):
            return f"SET {output.name} {value:.9g}"
        case Assign(target=target, value=value):
            return f"SET {target if isinstance(target, str) else target.name} = {in_words(value)}"
        case WaitInput(input=signal, value=value):
            return f"WAIT {signal.name} = {value:.9g}"
        case WaitUntil(condition=condition):
            return f"WAIT {in_words(condition)}"
        case Hold(text=text):
            return f'HOLD "{text}"' if text else "HOLD"
        case Say(text=name, teaches=teaches) if teaches:
            return f"{step.origin.name} {name}"
        case Say(text=text):
            return f'SAY "{text}"'
        case Finish(fails=fails, text=text):
            return f'ABORT "{text}"' if fails else "STOP"
        case NextPass():
            return "begin the next pass of the loop"
        case _:
            return ""


def outline_lines(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the tree as text: indented by depth, times on the right."""
    left = [f"{'  ' * row.depth}{row.label} {row.text}" for row in rows]
    width = min(max(map(len, left), default=0), 90)
    for text, row in zip(left, rows, strict=True):
        yield text if row.takes is None else f"{text:<{width}}  {row.takes.text()}"
