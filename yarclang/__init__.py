"""YARC: a robot language compiled to certified motion programs for a Turbo PMAC.

    >>> import yarclang
    >>> made = yarclang.compile("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)", robot="INDUSTRIAL6")
    >>> made.ok, made.value.certificate.duration
    (True, 2.0)

Each function takes the text of a program. `check` returns the findings and `format` a text. All other
functions return a `Result`: its `value` is None if an error prevents a result, and its `diagnostics` are the
findings. Only `format` raises an exception if a program has errors. Bugs of yarclang are reported as findings
too (Y2001). The planner is imported when it is first needed.

Comments that suppress findings, and the yarc.toml of `folder` or of a folder above it, apply as in
`yarc check` and `yarcc`. See docs/api.md for more.
"""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from yarclang.certify.certificate import Certificate
    from yarclang.diagnostics import Diagnostic, Result
    from yarclang.motion.plan import MotionPlan
    from yarclang.pipeline.inputs import Opened, Options
    from yarclang.pipeline.stages import Compiled
    from yarclang.source import SourceFile
    from yarclang.syntax.ast import Module

__version__ = "0.2.0"

_MARK = "\ufeff"
"""Byte order mark, which is removed from the beginning of a text."""

__all__ = ["__version__", "check", "compile", "format", "parse", "plan", "prove"]


def parse(text: str, *, name: str = "<text>") -> Result[Module]:
    """Parse a text without a robot and without other files.

    The syntax tree always exists. Lines that can't be parsed are missing in it and have errors in
    `diagnostics`.

        >>> import yarclang
        >>> tree = yarclang.parse("P0010 MOVEJ HOME [5] (s)  ! home").value
        >>> [statement.name.name for statement in tree.statements]
        ['MOVEJ']

    Args:
        text: the program.
        name: name of the text in findings.

    Returns:
        The syntax tree.
    """
    from yarclang.source import SourceFile
    from yarclang.syntax.parse import parse as parse_source

    return parse_source(SourceFile(name, text.removeprefix(_MARK)))


def check(
    text: str,
    *,
    robot: str | None = None,
    name: str = "<text>",
    folder: str | PathLike[str] = ".",
    start: Sequence[float] | None = None,
    cell: str | PathLike[str] | None = None,
    plans: bool = True,
) -> tuple[Diagnostic, ...]:
    """Return the findings of `yarc check` for a program, in the order of its lines.

        >>> import yarclang
        >>> for one in yarclang.check("P0010 MOVEJ 200 0 0 0 0 0 [5] (deg,s)", robot="INDUSTRIAL6"):
        ...     print(one.span.line, one.severity, one.code, one.message)
        1 error Y0502 J1 at 200 deg is outside its limits by 30 deg
        >>> yarclang.check("P0010 MOVEJ 20 0 0 0 0 0 [5] (deg,s)", robot="INDUSTRIAL6")
        ()

    Args:
        text: the program.
        robot: name of a robot or path of a robot.toml, if neither a ROBOT line nor yarc.toml names one.
        name: name of the text in findings.
        folder: the program's folder, with its modules, its cell and its yarc.toml.
        start: start position [deg, mm for prismatic joints], one value for each joint. None: the start
            position of the program or of yarc.toml, or else the robot's home.
        cell: path of the program's cell.toml; None if only a CELL line or yarc.toml names it. If more than
            one of them names a cell, it must be the same file.
        plans: True to plan and prove motions; otherwise only findings that need neither are returned.
    """
    from yarclang.pipeline.checking import check_text

    source, options = _asked(text, name, robot, start, cell)
    return check_text(source, Path(folder), options, plans=plans).diagnostics


def plan(
    text: str,
    *,
    robot: str | None = None,
    name: str = "<text>",
    folder: str | PathLike[str] = ".",
    start: Sequence[float] | None = None,
    cell: str | PathLike[str] | None = None,
) -> Result[MotionPlan]:
    """Plan the motions of a program: compute its joint positions as a function of time.

        >>> import numpy as np
        >>> import yarclang
        >>> planned = yarclang.plan("P0010 MOVEJ 40 0 0 0 0 0 [2] (deg,s)", robot="INDUSTRIAL6").value
        >>> planned.duration
        2.0
        >>> q, v, a = planned.sample(np.array([0.0, 1.0, 2.0]))  # (N, n) each, at N instants [s], in SI
        >>> np.degrees(q[:, 0]).round(6).tolist()
        [0.0, 20.0, 40.0]

    The findings are only those of planning. `check` and `compile` also return the findings of the proof and
    of the lint rules.

    Args:
        text: the program.
        robot: see `check`.
        name: see `check`.
        folder: see `check`.
        start: see `check`.
        cell: see `check`.
    """
    from yarclang.diagnostics import Result, has_errors
    from yarclang.pipeline.checking import settled_in_folder
    from yarclang.pipeline.guarding import failure
    from yarclang.pipeline.stages import plan_module

    source = _asked(text, name, robot, start, cell)[0]
    found: tuple[Diagnostic, ...] = ()
    value: MotionPlan | None = None
    try:
        opened = _opened(text, name, robot, folder, start, cell)
        found = opened.diagnostics
        if opened.value is not None:
            planned = plan_module(opened.value.module, opened.value.request)
            found, value = (*found, *planned.diagnostics), planned.value
        found = settled_in_folder(found, source, Path(folder), opened.value)
    except Exception as error:
        found = (*found, failure(error, source))
    return Result(None if has_errors(found) else value, found)


def compile(  # noqa: A001  (the word that people look for)
    text: str,
    *,
    robot: str | None = None,
    target: str = "",
    name: str = "<text>",
    folder: str | PathLike[str] = ".",
    start: Sequence[float] | None = None,
    cell: str | PathLike[str] | None = None,
) -> Result[Compiled]:
    """Compile a program to certified controller text, as `yarcc` does, with all intermediate results.

        >>> import yarclang
        >>> made = yarclang.compile("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)", robot="INDUSTRIAL6")
        >>> made.value.text.splitlines()[-1]
        'CLOSE'
        >>> row = made.value.certificate.commands[0]
        >>> row.index, row.duration
        ('P0010', 2.0)
        >>> yarclang.compile("P0010 MOVEK", robot="INDUSTRIAL6").value is None
        True

    The findings are those of `check`. There is no value if one of them is an error, by itself or because
    yarc.toml has raised its severity.

    Args:
        text: the program.
        robot: see `check`.
        target: a target that the robot's kind of controller offers for its texts. For a Turbo PMAC, a text
            for `rotary` is streamed, and a text for `prog` is a program buffer to download.
        name: see `check`.
        folder: see `check`.
        start: see `check`.
        cell: see `check`.
    """
    from dataclasses import replace

    from yarclang.diagnostics import Result
    from yarclang.pipeline.checking import check_text

    source, options = _asked(text, name, robot, start, cell)
    checked = check_text(source, Path(folder), replace(options, target=target))
    return Result(checked.compiled, checked.diagnostics)


def prove(
    controller_text: str,
    text: str | None = None,
    *,
    robot: str | None = None,
    name: str = "<text>",
    folder: str | PathLike[str] = ".",
    start: Sequence[float] | None = None,
    cell: str | PathLike[str] | None = None,
) -> Result[Certificate]:
    """Prove the effects of a controller text, and that the program asks for exactly these effects.

    The text is read from scratch, whether or not yarclang wrote it. The certificate holds for this text and
    for the robot's present description.

        >>> import yarclang
        >>> program = "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)"
        >>> made = yarclang.compile(program, robot="INDUSTRIAL6").value
        >>> yarclang.prove(made.text, program, robot="INDUSTRIAL6").value.duration
        2.0
        >>> edited = made.text.replace("X7.962963", "X8.962963")
        >>> edited != made.text, yarclang.prove(edited, program, robot="INDUSTRIAL6").value
        (True, None)

    Without the program, only properties are checked that don't depend on it: limits, collisions, the guard,
    assignments, places of rest. A note names the properties that aren't checked.

        >>> judged = yarclang.prove(made.text)
        >>> judged.value.position, judged.diagnostics[0].code
        (inf, 'Y1193')

    Args:
        controller_text: text written by `yarcc`.
        text: the program that the controller text should perform; None if it isn't available.
        robot: see `check`; without the program, the controller text's header names the robot.
        name: name of the program in findings; without one, name of the controller text.
        folder: see `check`.
        start: see `check`.
        cell: see `check`; without the program, path of a cell.toml with the surroundings.
    """
    from yarclang.backend import backend_of
    from yarclang.diagnostics import Result
    from yarclang.pipeline.controller_text import judge_alone, prove_against
    from yarclang.pipeline.guarding import failure
    from yarclang.source import SourceFile

    found: tuple[Diagnostic, ...] = ()
    try:
        if text is None:
            around = None if cell is None else str(Path(cell))
            judged = judge_alone(SourceFile(name, controller_text), robot, around)
            return Result(None if judged.value is None else judged.value.certificate, judged.diagnostics)
        opened = _opened(text, name, robot, folder, start, cell)
        found = opened.diagnostics
        if opened.value is None:
            return Result(None, found)
        suffix = backend_of(opened.value.request.robot).suffix
        proved = prove_against(SourceFile(f"{name}{suffix}", controller_text), opened.value)
        return Result(proved.value, (*found, *proved.diagnostics))
    except Exception as error:
        return Result(None, (*found, failure(error, SourceFile(name, text or ""))))


def format(text: str) -> str:  # noqa: A001  (the word that people look for)
    r"""Return a program formatted as by `yarc fmt`: names in upper case, blocks indented, comments aligned.

        >>> import yarclang
        >>> yarclang.format("p1   movej  home [1](s)")
        'P1 MOVEJ HOME [1] (s)\n'

    Raises:
        ValueError: the program has syntax errors, or the formatted program isn't proved to mean the same; the
            message names the first line.
    """
    from yarclang.source import SourceFile
    from yarclang.syntax.form import usual_form

    made = usual_form(SourceFile("<text>", text.removeprefix(_MARK)))
    if made.value is None:
        first = made.diagnostics[0]
        raise ValueError(f"line {first.span.line if first.span else 1}: {first.message}")
    return made.value


def _asked(
    text: str,
    name: str,
    robot: str | None,
    start: Sequence[float] | None,
    cell: str | PathLike[str] | None,
) -> tuple[SourceFile, Options]:
    from yarclang.pipeline.inputs import Options
    from yarclang.source import SourceFile

    stands = None if start is None else tuple(map(float, start))
    around = None if cell is None else str(Path(cell))
    return SourceFile(name, text.removeprefix(_MARK)), Options(robot=robot, start=stands, cell=around)


def _opened(
    text: str,
    name: str,
    robot: str | None,
    folder: str | PathLike[str],
    start: Sequence[float] | None,
    cell: str | PathLike[str] | None,
) -> Result[Opened]:
    from yarclang.pipeline.inputs import open_source

    source, options = _asked(text, name, robot, start, cell)
    return open_source(source, Path(folder), options)
