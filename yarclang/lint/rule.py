"""Definition of lint rules: their finding, their input, the check, and examples that are also tests."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Generic, TypeVar

from yarclang.diagnostics import Fix
from yarclang.findings import Finding
from yarclang.frozen import frozen
from yarclang.hir import Origin, Step
from yarclang.lint.names import Names, names_of
from yarclang.memory import NO_MEMORY, Memory
from yarclang.robot.model import Robot
from yarclang.source import SourceFile, Span
from yarclang.syntax.ast import Module

T = TypeVar("T")


@frozen
class Remark:
    """A remark of a lint rule about one place in a program.

    Attributes:
        message: the sentence, with its numbers.
        span: the place.
        help: remedy.
        fix: edit that removes the fault; None without one.
        source: file of the place; None for the file that is checked.
        place: the calls and loops around a command in unrolled code.
    """

    message: str
    span: Span
    help: str
    fix: Fix | None = None
    source: SourceFile | None = None
    place: str = ""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """Context for every lint rule, besides the product that the rule reads.

    Attributes:
        module: syntax tree of the file that is checked.
        robot: the robot.
        steps: the steps of the program.
        teach: True if the project is for teaching, at reduced speed.
        memory: cache of results of the rules.
    """

    module: Module
    robot: Robot
    steps: tuple[Step, ...] = ()
    teach: bool = False
    memory: Memory = NO_MEMORY

    @cached_property
    def names(self) -> Names:
        """Names that the file declares and uses."""
        return names_of(self.module)


@frozen(eq=False)
class Rule(Generic[T]):
    """A lint rule.

    A rule runs only if the product that it reads is available: a program with errors has no plan. Its remarks
    on commands with errors are dropped, unless the rule explains errors.

    Attributes:
        finding: the rule's entry in the catalogue: code, name, severity, and the documentation.
        reads: type of the product that `look` gets: the syntax tree (`Module`), the checked program
            (`Program`), the plan (`MotionPlan`) or the certificate (`Certificate`).
        look: function that takes a product and yields the remarks about it.
        valid: programs for INDUSTRIAL6 without the finding.
        invalid: programs for INDUSTRIAL6 with the finding. All programs compile, except that an `invalid` one
            may contain the error that the rule explains.
        explains_errors: True if the remarks stay on commands with errors.
        teach: True if the examples are checked with `teach = true`.
    """

    finding: Finding
    reads: type[T]
    look: Callable[[T, Surroundings], Iterator[Remark]]
    valid: tuple[str, ...]
    invalid: tuple[str, ...]
    explains_errors: bool = False
    teach: bool = False


def remark_at(origin: Origin, message: str, help_: str, fix: Fix | None = None) -> Remark:
    """Return a remark about a command.

    Args:
        origin: the command.
        message: the sentence, with its numbers.
        help_: remedy.
        fix: edit that removes the fault; None without one.
    """
    return Remark(message, origin.span, help_, fix, origin.source, origin.place)
