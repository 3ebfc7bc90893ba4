"""Read ALLOW: the bodies that may touch during a motion. Check that these bodies exist."""

from __future__ import annotations

from collections.abc import Sequence

from yarclang.cell.allowances import body_names, pair_fault, repeated_parts
from yarclang.cell.model import Cell
from yarclang.diagnostics import Collector
from yarclang.hir import Allowed, Motion, Step
from yarclang.robot.model import Robot
from yarclang.semantics.motions.line import Line
from yarclang.source import SourceFile, Span
from yarclang.subjects import unknown
from yarclang.syntax.ast import Option, Word


def allowed_by(line: Line) -> tuple[Allowed, ...]:
    """Read the options of a motion that allow two bodies to touch, such as ALLOW GRIPPER BOX; report options
    that don't name two bodies.

    `check_allowed` checks later, when the cell is known, that the bodies exist.
    """
    found: dict[Allowed, Allowed] = {}
    for option in line.statement.options:
        if option.word.name != "ALLOW":
            continue
        one = _allowed(line, option)
        if one is not None and one in found:
            message = f"ALLOW {one.first} {one.second} is given twice"
            line.findings.add("Y0412", message, _span(line, option), "remove one of them")
        elif one is not None:
            found[one] = one
    return tuple(found)


def _allowed(line: Line, option: Option) -> Allowed | None:
    if not isinstance(option.argument, Word) or option.state is None:
        help_ = "name two links, tools, obstacles or parts, for example ALLOW GRIPPER BOX"
        line.findings.add("Y0412", "ALLOW needs the names of two bodies", _span(line, option), help_)
        return None
    first, second = sorted((option.argument.name, option.state.name))
    word, end = option.word.place, option.state.place
    # If the names are on a later line than the word ALLOW, use the place of the last name.
    begin = word if word.row == end.row else end
    return Allowed(first, second, end.row, begin.start, end.end)


def _span(line: Line, option: Option) -> Span:
    """Return the place of an option in the source; only the place of its word if its names are on another
    line.
    """
    begin, end = option.word.place, (option.state or option.argument or option.word).place
    first = line.statement.span(begin)
    return first if end.row != begin.row else Span.on_line(first.line, begin.start, end.end)


def check_allowed(steps: Sequence[Step], robot: Robot, cell: Cell | None, findings: Collector) -> None:
    """Check that the bodies of each ALLOW exist.

    An ALLOW that is carried out several times, as in a loop, is checked once.

    Args:
        steps: steps of the program.
        robot: its links and tools are bodies.
        cell: its obstacles and parts are bodies; None without a cell.
        findings: receives the findings.
    """
    allowing = [step for step in steps if isinstance(step, Motion) and step.allowed]
    if not allowing:
        return
    names, repeated = body_names(robot, cell), repeated_parts(cell)
    seen: set[tuple[SourceFile, Span]] = set()
    for step in allowing:
        for one in step.allowed:
            source, span = step.origin.source, one.span(step.origin)
            if (source, span) in seen:
                continue
            seen.add((source, span))
            place = Collector(source)
            place.place = step.origin.place
            missing = [name for name in dict.fromkeys((one.first, one.second)) if name not in names]
            for name in missing:
                subject = unknown(name, names)
                listed = ", ".join(sorted(names)[:20]) + ", ..." * (len(names) > 20)
                help_ = f"the bodies are {listed}" if names else "neither the robot nor the cell has bodies"
                help_ = f"{subject.question} {help_}" if subject.question else help_
                place.add("Y0217", f"no body is named {name}", span, help_, subject=subject)
            fault = "" if missing else pair_fault((one.first, one.second), names, repeated)
            if fault:
                place.add("Y0412", fault, span, "give each body a name of its own")
            findings.found += place.found
