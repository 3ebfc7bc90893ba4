"""Look-up of the frames and signals that the lines of a session declare. Used by orders that name a frame or
a signal outside of a command. No I/O.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

from yarclang.coordinator.lines import TYPED, Lines
from yarclang.coordinator.offers import Planner
from yarclang.diagnostics import Collector, Result, has_errors
from yarclang.hir import Program, Signal
from yarclang.pipeline.stages import check_program, context_of
from yarclang.semantics.control.unroll import declared_names
from yarclang.semantics.names.frames import base_axes, moving_frame
from yarclang.semantics.names.scope import Frame, Scope
from yarclang.semantics.names.signals import input_named, output_named, signal_named
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import FrameName, Place, Word
from yarclang.syntax.parse import parse

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class _Alone:
    """A source text that contains only one name."""

    def span(self, place: Place) -> Span:
        return Span(1, place.start, 1, place.end)


class Names:
    """Looks up frames and signals by name, as the lines of a session declare them.

    Args:
        lines: lines of the session.
        planner: planner with the robot and folder of the session.
    """

    def __init__(self, lines: Lines, planner: Planner) -> None:
        self._lines = lines
        self._planner = planner

    def scope(self) -> Scope:
        """Return the names that the session's lines declare, with their meanings."""
        module = parse(self._lines.behind("").source).value
        assert module is not None  # parsing always gives a tree
        return declared_names(module, context_of(self._planner.request(self._planner.robot.home)))

    def cell(self) -> Result[Program]:
        """Return the session's declarations as a program.

        The program contains the cell that motions respect, with the cell's parts in the places that the
        cell's file gives. If the cell can't be used, findings are returned instead.
        """
        parsed = parse(self._lines.behind("").source)
        assert parsed.value is not None  # parsing always gives a tree
        request = replace(self._planner.request(self._planner.robot.home), present=None)
        checked = check_program(parsed.value, request)
        # Y0104, a file without a command, is normal for the declarations of a session.
        found = tuple(one for one in checked.diagnostics if one.code != "Y0104")
        return Result(None if has_errors(found) else checked.value, found)

    def moving(self, name: str) -> Result[Frame]:
        """Return the frame with a given name, if motions can move it. Its transform is flange_from_frame
        (4, 4) [m].
        """
        return self._frame(name, lambda frame, found: moving_frame(_Alone(), frame, self.scope(), found))

    def base(self, name: str) -> Result[Frame]:
        """Return the frame with a given name, if a pose can be given in it. The transform of the frame is
        base_from_frame (4, 4) [m].
        """
        return self._frame(name, lambda frame, found: base_axes(_Alone(), frame, self.scope(), False, found))

    def frames(self) -> dict[str, Frame]:
        """Return all frames by their names, without braces; {B} comes first."""
        scope = self.scope()
        found = {name: scope.frame(name) for name in scope.frame_names()}
        return {name: frame for name, frame in found.items() if frame is not None}

    def signal(self, name: str) -> Result[Signal]:
        """Return the input or output with a given name."""
        return _looked_up(name, lambda found: signal_named(_word(name), self.scope(), _Alone(), found))

    def input(self, name: str) -> Result[Signal]:
        """Return the input with a given name."""
        return _looked_up(name, lambda found: input_named(_word(name), self.scope(), _Alone(), found))

    def output(self, name: str) -> Result[Signal]:
        """Return the output with a given name."""
        return _looked_up(name, lambda found: output_named(_word(name), self.scope(), _Alone(), found))

    def _frame(self, name: str, look: Callable[[FrameName, Collector], Frame | None]) -> Result[Frame]:
        text = name.strip()
        if not (text.startswith("{") and text.endswith("}")):
            text = f"{{{text}}}"
        frame = FrameName(text, Place(0, 1, len(text) + 1))
        return _looked_up(text, lambda found: look(frame, found))


def _word(name: str) -> Word:
    text = name.strip()
    return Word(text, Place(0, 1, len(text) + 1))


def _looked_up(text: str, look: Callable[[Collector], T | None]) -> Result[T]:
    """Return the result of a function for a name. The findings refer to the text of the name."""
    findings = Collector(SourceFile(TYPED, f"{text.strip()}\n"))
    found = look(findings)
    return Result(found, tuple(findings.found))
