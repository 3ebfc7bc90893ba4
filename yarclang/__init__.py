"""YARC: a robot language compiled to certified motion programs for a Turbo PMAC.

    >>> import yarclang
    >>> made = yarclang.compile("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)", robot="INDUSTRIAL6")
    >>> made.value.certificate.duration
    2.0

Each function takes program text, and gives a `Result`: a value (None where an error forbids one) and
the findings. Nothing here raises for what a user writes. The planner is imported when it is first needed.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic, Result
    from yarclang.motion.plan import MotionPlan
    from yarclang.pipeline.inputs import Opened
    from yarclang.pipeline.stages import Compiled
    from yarclang.pmac.program import Target
    from yarclang.syntax.ast import Module

__version__ = "0.1.0"

__all__ = ["__version__", "check", "compile", "format", "parse", "plan"]


def parse(text: str, *, name: str = "<text>") -> Result[Module]:
    """Text to syntax tree; knows no robot."""
    from yarclang.source import SourceFile
    from yarclang.syntax.parse import parse as parse_source

    return parse_source(SourceFile(name, text))


def check(text: str, *, robot: str | None = None, name: str = "<text>") -> tuple[Diagnostic, ...]:
    """All findings of a program, planning included.

    Args:
        text: the program.
        robot: a robot's name or the path of a robot.toml, if no ROBOT line names it.
        name: how findings call the text.
    """
    return plan(text, robot=robot, name=name).diagnostics


def plan(text: str, *, robot: str | None = None, name: str = "<text>") -> Result[MotionPlan]:
    """Text to motion plan: the joints as a function of time, `plan(...).value.sample(times)`."""
    from yarclang.diagnostics import Result
    from yarclang.pipeline.stages import plan_module

    opened = _open(text, name, robot, "rotary")
    if opened.value is None:
        return Result(None, opened.diagnostics)
    planned = plan_module(opened.value.module, opened.value.request)
    return Result(planned.value, (*opened.diagnostics, *planned.diagnostics))


def compile(  # noqa: A001  (the word that people look for)
    text: str, *, robot: str | None = None, target: Target = "rotary", name: str = "<text>"
) -> Result[Compiled]:
    """Text to certified controller text, `compile(...).value.text`, with its certificate."""
    from yarclang.diagnostics import Result
    from yarclang.pipeline.stages import compile_module

    opened = _open(text, name, robot, target)
    if opened.value is None:
        return Result(None, opened.diagnostics)
    compiled = compile_module(opened.value.module, opened.value.request)
    return Result(compiled.value, (*opened.diagnostics, *compiled.diagnostics))


def format(text: str) -> str:  # noqa: A001  (the word that people look for)
    """A program in its usual form, as `yarc fmt` writes it: names in upper case, blocks indented, comments below each other.

    Raises:
        ValueError: the program has syntax errors; the message names the first.
    """
    from yarclang.syntax.print import print_module

    parsed = parse(text)
    if parsed.value is None or parsed.diagnostics:
        first = parsed.diagnostics[0]
        raise ValueError(f"line {first.span.line if first.span else 1}: {first.message}")
    return print_module(parsed.value)


def _open(text: str, name: str, robot: str | None, target: Target) -> Result[Opened]:
    from yarclang.pipeline.inputs import Options, open_source
    from yarclang.source import SourceFile

    return open_source(SourceFile(name, text), Path.cwd(), Options(robot=robot, target=target))
