"""Snippets: lines with placeholders for the values."""

from __future__ import annotations

import re

from yarclang.assist.sketch import Sketch
from yarclang.assist.view import View
from yarclang.assist.vocabulary import command_of
from yarclang.commands.spec import CommandSpec, Values
from yarclang.syntax.words import BLOCK_HEADS

_STEP = 10
_HOLE = re.compile(r"\$\{\d+:([^}]*)\}|\$\{\d+\}|\$\d+")


_FILLED = re.compile(
    r'(?<=")[^"]+(?=")|(?<![A-Za-z0-9_(.-])(?:-?\d+(?:\.\d+)?|[A-Z][A-Z0-9_]*)(?![A-Za-z0-9_])'
)
"""Pattern of the names, numbers and texts in an example, which become placeholders. Units are left out."""


def plain_text(snippet: str) -> str:
    """Return a snippet with the proposed value in each placeholder."""
    return _HOLE.sub(lambda match: match[1] or "", snippet)


def next_index(sketch: Sketch, line: int) -> str:
    """Return an index for a new command in a line: greater than the index above and, if possible, less than
    the index below.
    """
    numbers = [(one.line, int(one.index.text[1:])) for one in sketch.module.statements if one.index]
    above = max((number for at, number in numbers if at < line), default=0)
    below = [number for at, number in numbers if at > line and number > above]
    step = _STEP
    if below and min(below) <= above + step:
        step = max((min(below) - above) // 2, 1)
    taken = {number for _, number in numbers}
    number = above // step * step + step
    while number in taken:
        number += 1
    return f"P{number:04d}"


def command_snippet(view: View, name: str) -> str:
    """Return a command with placeholders for its values, except those that DEFAULT gives."""
    found = command_of(name)
    if found is None:
        return name
    spec, target, _ = found
    parts = [name]
    values = spec.targets.get(target)
    default = view.sketch.default
    numbers = _Holes()
    if values is not None:
        if not values.of_joints and not (default and default.moving):
            parts.append(_braced(numbers.hole("TCP")))
        parts.append(_way_points(view, spec, values, numbers))
    if spec.is_timed:
        parts.append(f"[{numbers.hole('2')}]")
    elif spec.is_motion and not (default and default.time):
        parts.append(f"[{numbers.hole('MIN')}]")
    if values is not None and not (default and default.units):
        time = ",s" if spec.is_timed else ""
        parts.append(f"({'deg' + time if values.of_joints else 'mm' if values.is_quaternion else 'mm,deg'})")
    if values is not None and not values.of_joints and not (default and default.base):
        parts.append(_braced(numbers.hole("B")))
    return " ".join(parts)


class _Holes:
    def __init__(self) -> None:
        self._count = 0

    def hole(self, proposed: str) -> str:
        """Return the next placeholder."""
        self._count += 1
        return f"${{{self._count}:{proposed}}}"


def _braced(inner: str) -> str:
    return "{" + inner + "}"


def _way_points(view: View, spec: CommandSpec, values: Values, numbers: _Holes) -> str:
    joints = view.robot.joint_names if view.robot else ("J1", "J2", "J3", "J4", "J5", "J6")
    count = max(spec.waypoints[0], len(spec.leading) + 1)
    points = [spec.leading[n] if n < len(spec.leading) else values for n in range(count)]
    return "; ".join(" ".join(numbers.hole(label) for label in one.labels(joints)) for one in points)


def declaration_snippet(example: str) -> str:
    """Return a declaration with placeholders for its names and numbers. A block gets its END."""
    head, _, line = example.partition(" ")
    holes = _Holes()
    text = f"{head} {_FILLED.sub(lambda match: holes.hole(match[0]), line)}".rstrip()
    if head in BLOCK_HEADS:
        text += "\n  $0\nEND"
    return text
