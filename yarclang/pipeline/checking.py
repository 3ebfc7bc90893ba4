"""All that is to be said of one file: what yarcc finds, what the rules find, and what the project and comments make of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

from yarclang.diagnostics import Diagnostic, Result, grouped, has_errors, in_order
from yarclang.findings import Severity
from yarclang.hir import Program
from yarclang.lint.engine import lint
from yarclang.lint.rule import Surroundings
from yarclang.lint.suppression import suppress
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.cells import SUFFIX, check_description
from yarclang.pipeline.followers import without_followers
from yarclang.pipeline.inputs import Opened, Options, open_source
from yarclang.pipeline.project import Project, find_project
from yarclang.pipeline.sources import STANDARD_INPUT, read_source
from yarclang.pipeline.stages import Compiled, certified, check_program, plan_checked
from yarclang.source import SourceFile


@dataclass(frozen=True, slots=True, eq=False)
class Checked:
    """What was found in a file, and what the stages made of it, as far as they came.

    `source` is None where the file couldn't be read, or is no program; `opened` where it isn't known for which robot. `program` may have
    gaps. `compiled` is there only if nothing is an error, not even by the project's settings.
    """

    diagnostics: tuple[Diagnostic, ...]
    source: SourceFile | None = None
    opened: Opened | None = None
    program: Program | None = None
    plan: MotionPlan | None = None
    compiled: Compiled | None = None


def check_file(path: str, options: Options, *, plans: bool = True) -> Checked:
    """Check a program, or the description of a cell or a robot (a .toml file).

    Args:
        path: the file, or `-` for standard input.
        options: what was said besides.
        plans: whether motions are planned and proved; without, only what needs no planning is found.
    """
    if path.lower().endswith(SUFFIX):
        return Checked(in_order(check_description(path, options.robot)))
    return check_program_file(path, options, plans=plans)


def check_program_file(path: str, options: Options, *, plans: bool = True) -> Checked:
    """Check a program, whatever its file is called; else as `check_file`."""
    read = read_source(path)
    if read.value is None:
        return Checked(in_order(read.diagnostics))
    folder = Path.cwd() if path == STANDARD_INPUT else Path(path).parent
    return check_text(read.value, folder, options, plans=plans)


def check_text(source: SourceFile, folder: Path, options: Options, *, plans: bool = True) -> Checked:
    """Check the text of a program that belongs to a folder; else as `check_file`."""
    opened = open_source(source, folder, options)
    project = find_project(folder).value or Project(folder)
    if opened.value is None:
        return Checked(settled(opened.diagnostics, source, project), source)
    made, is_whole = _staged(opened, project, plans)
    told = settled(made.diagnostics, source, project, is_whole=is_whole)
    compiled = None if has_errors(told) else made.compiled
    return replace(made, diagnostics=told, compiled=compiled)


def _staged(opened: Result[Opened], project: Project, plans: bool) -> tuple[Checked, bool]:
    """What the stages made, with all findings of theirs and of the rules; whether all of them were asked.

    Lines that couldn't be read are missing from the plan: what such a program does isn't proved.
    """
    assert opened.value is not None
    module, request = opened.value.module, opened.value.request
    checked = check_program(module, request)
    assert checked.value is not None  # a check always gives a program
    program = checked.value
    products: list[object] = [module, program]
    found, plan, compiled = checked.diagnostics, None, None
    if plans:
        planned = plan_checked(checked, request)
        found, plan = planned.diagnostics, planned.value
        if plan is not None:
            products.append(plan)
        if plan is not None and not has_errors(opened.diagnostics):
            made = certified(plan, request)
            found, compiled = (*found, *made.diagnostics), made.value
            if compiled is not None:
                products.append(compiled.certificate)
    else:
        found = grouped(found)
    off = {code for code, level in project.levels.items() if level == "off"}
    around = Surroundings(module, request.robot, program.steps, project.teach, request.memory)
    found = (*opened.diagnostics, *found, *lint(products, around, found, off))
    is_whole = compiled is not None and not has_errors(found)
    return Checked(found, module.source, opened.value, program, plan, compiled), is_whole


def told(diagnostics: Iterable[Diagnostic], source: SourceFile, folder: Path) -> tuple[Diagnostic, ...]:
    """Findings of some stages about a program that belongs to a folder, as its comments and its yarc.toml want them told."""
    return settled(diagnostics, source, find_project(folder).value or Project(folder))


def settled(
    diagnostics: Iterable[Diagnostic], source: SourceFile, project: Project, *, is_whole: bool = False
) -> tuple[Diagnostic, ...]:
    """Findings as they are told: without those that follow from others or that the source's comments suppress, as severe as the project says.

    Args:
        diagnostics: all findings.
        source: the program's file.
        project: its settings.
        is_whole: whether all was looked for: only then a comment that suppresses nothing is needless.
    """
    told: list[Diagnostic] = []
    for one in suppress(source, without_followers(diagnostics, source), is_whole=is_whole):
        level = project.levels.get(one.code, "")
        if one.is_error or not level:
            told.append(one)
        elif level != "off":
            told.append(replace(one, level=cast("Severity", level)))
    return in_order(told)
