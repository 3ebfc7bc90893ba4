"""YARC: a robot language compiled to certified motion programs for a Turbo PMAC.

    >>> import yarclang
    >>> made = yarclang.compile("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)", robot="INDUSTRIAL6")
    >>> made.ok, made.value.certificate.duration
    (True, 2.0)

Each function takes the text of a program. `check` gives the findings; the others a `Result`: a `value`, None where an error forbids one, and
`diagnostics`, the findings. What a user writes raises nothing, but in `format`; a bug of ours is a finding too (Y2001). The planner is imported when
it is first needed.

Comments that suppress findings, and the yarc.toml of `folder` or of one above it, hold here as in `yarc check` and `yarcc`. docs/api.md tells more.
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

__version__ = "0.1.0"

_MARK = "\ufeff"
"""A byte order mark before a text is no part of it."""

__all__ = ["__version__", "check", "compile", "format", "parse", "plan", "prove"]


def parse(text: str, *, name: str = "<text>") -> Result[Module]:
    """Text to syntax tree; knows no robot, and reads no other file.

    There is always a tree: of lines that can't be read it has none, and `diagnostics` has their errors.

        >>> import yarclang
        >>> tree = yarclang.parse("P0010 MOVEJ HOME [5] (s)  ! home").value
        >>> [statement.name.name for statement in tree.statements]
        ['MOVEJ']

    Args:
        text: the program.
        name: how findings call the text.
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
    """All that `yarc check` says of a program, in the order of its lines.

        >>> import yarclang
        >>> for one in yarclang.check("P0010 MOVEJ 200 0 0 0 0 0 [5] (deg,s)", robot="INDUSTRIAL6"):
        ...     print(one.span.line, one.severity, one.code, one.message)
        1 error Y0502 J1 at 200 deg is out of its limits by 30 deg
        >>> yarclang.check("P0010 MOVEJ 20 0 0 0 0 0 [5] (deg,s)", robot="INDUSTRIAL6")
        ()

    Args:
        text: the program.
        robot: a robot's name or the path of a robot.toml, if neither a ROBOT line nor yarc.toml names it.
        name: how findings call the text.
        folder: where the program belongs: its modules, its cell and its yarc.toml are looked for there.
        start: where the robot stands [deg, mm for prismatic joints], one value a joint; without it what the program says, else yarc.toml, else
            the robot's home.
        cell: the path of a cell.toml that the program keeps to; without it that of a CELL line or of yarc.toml. If several are named, they must be one file.
        plans: whether motions are planned and proved; without, only what needs neither is found.
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
    """Text to motion plan: the joints as a function of time.

        >>> import numpy as np
        >>> import yarclang
        >>> planned = yarclang.plan("P0010 MOVEJ 40 0 0 0 0 0 [2] (deg,s)", robot="INDUSTRIAL6").value
        >>> planned.duration
        2.0
        >>> q, v, a = planned.sample(np.array([0.0, 1.0, 2.0]))  # (N, n) each, at N instants [s], in SI
        >>> np.degrees(q[:, 0]).round(6).tolist()
        [0.0, 20.0, 40.0]

    The findings are those of planning; what the certificate and the rules say, `check` and `compile` tell.

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
    """Text to certified controller text, as `yarcc` writes it, with all that led to it.

        >>> import yarclang
        >>> made = yarclang.compile("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)", robot="INDUSTRIAL6")
        >>> made.value.text.splitlines()[-1]
        'CLOSE'
        >>> row = made.value.certificate.commands[0]
        >>> row.index, row.duration
        ('P0010', 2.0)
        >>> yarclang.compile("P0010 MOVEK", robot="INDUSTRIAL6").value is None
        True

    The findings are those of `check`. An error leaves no value, nor does a finding that yarc.toml calls an error.

    Args:
        text: the program.
        robot: see `check`.
        target: `rotary` for streaming into the rotary buffer, `prog` for a program buffer to download.
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
    """Prove what a controller text (.pmc) does, and that it is what the program says.

    The text is read anew, whoever wrote it or changed it since; the certificate holds for it and the robot as it is described today.

        >>> import yarclang
        >>> program = "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)"
        >>> made = yarclang.compile(program, robot="INDUSTRIAL6").value
        >>> yarclang.prove(made.text, program, robot="INDUSTRIAL6").value.duration
        2.0
        >>> edited = made.text.replace("X7.962963", "X8.962963")
        >>> edited != made.text, yarclang.prove(edited, program, robot="INDUSTRIAL6").value
        (True, None)

    Without the program, the text is judged for all that needs none: limits, collisions, the guard, what it assigns, where it rests. A note
    says what isn't judged.

        >>> judged = yarclang.prove(made.text)
        >>> judged.value.position, judged.diagnostics[0].code
        (inf, 'Y1193')

    Args:
        controller_text: what `yarcc` has written.
        text: the program that it is to carry out; None if that isn't at hand.
        robot: see `check`; without the program, a text's own header names it.
        name: how findings call the program, or the controller text if there is none.
        folder: see `check`.
        start: see `check`.
        cell: see `check`; without the program, the path of a cell.toml with the surroundings.
    """
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
        proved = prove_against(SourceFile(f"{name}.pmc", controller_text), opened.value)
        return Result(proved.value, (*found, *proved.diagnostics))
    except Exception as error:
        return Result(None, (*found, failure(error, SourceFile(name, text or ""))))


def format(text: str) -> str:  # noqa: A001  (the word that people look for)
    r"""A program in its usual form, as `yarc fmt` writes it: names in upper case, blocks indented, comments below each other.

        >>> import yarclang
        >>> yarclang.format("p1   movej  home [1](s)")
        'P1 MOVEJ HOME [1] (s)\n'

    Raises:
        ValueError: the program has syntax errors, or its usual form isn't proved to say the same; the message names the first line.
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
