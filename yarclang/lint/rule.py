"""What a rule is: what it says, what it reads, how it looks, and the examples that are its tests."""

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
    """What a rule says of one place: a sentence with its figures, and what to do.

    `source` is None for the file that is checked; `place` tells what led to a command in unrolled code.
    """

    message: str
    span: Span
    help: str
    fix: Fix | None = None
    source: SourceFile | None = None
    place: str = ""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """What every rule may know besides what it reads: the file that is checked, its robot, the steps of the program by their numbers,
    whether the project is for teaching (reduced speed), and what rules remember of texts that they looked at before.
    """

    module: Module
    robot: Robot
    steps: tuple[Step, ...] = ()
    teach: bool = False
    memory: Memory = NO_MEMORY

    @cached_property
    def names(self) -> Names:
        """What the file declares and speaks of."""
        return names_of(self.module)


@frozen(eq=False)
class Rule(Generic[T]):
    """One rule.

    `finding` is its entry in the catalogue: code, name, severity, and the documentation. `reads` is what `look` gets: the syntax tree
    (`Module`), the checked program (`Program`), the plan (`MotionPlan`) or the certificate (`Certificate`). A rule is asked only where
    that is there: a program with errors has no plan. It is left out at a command that has an error, unless it `explains_errors`.

    `valid` and `invalid` are programs for INDUSTRIAL6 without and with the finding; both compile, but that an `invalid` one may have the error that
    is explained. `teach` says that they are looked at with `teach = true`.
    """

    finding: Finding
    reads: type[T]
    look: Callable[[T, Surroundings], Iterator[Remark]]
    valid: tuple[str, ...]
    invalid: tuple[str, ...]
    explains_errors: bool = False
    teach: bool = False


def remark_at(origin: Origin, message: str, help_: str, fix: Fix | None = None) -> Remark:
    """A remark about a command."""
    return Remark(message, origin.span, help_, fix, origin.source, origin.place)
