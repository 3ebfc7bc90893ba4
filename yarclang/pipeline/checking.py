"""Collect all findings about one file: those of the compiler and of the lint rules, filtered by the project's
settings and by comments.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import cast

from yarclang.diagnostics import Diagnostic, Result, grouped, has_errors, in_order
from yarclang.findings import Severity
from yarclang.frozen import frozen
from yarclang.hir import Program
from yarclang.lint.engine import Remarks, findings_of, remarks
from yarclang.lint.rule import Surroundings
from yarclang.lint.suppression import has_suppressions, suppress
from yarclang.memory import Forgetful
from yarclang.mistakes.answers import answered
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.boxes import box_findings
from yarclang.pipeline.callers import at_callers, uncalled_lines
from yarclang.pipeline.cells import SUFFIX, check_description
from yarclang.pipeline.controller_text import check_controller_text, is_compiled
from yarclang.pipeline.explained import explained
from yarclang.pipeline.followers import few_in_a_line, without_followers
from yarclang.pipeline.guarding import failure
from yarclang.pipeline.inputs import Opened, Options, open_source
from yarclang.pipeline.project import Project, find_project
from yarclang.pipeline.sources import STANDARD_INPUT, read_source
from yarclang.pipeline.stages import Compiled, certified_whole, check_program, plan_checked
from yarclang.progress import each, go_on, tell
from yarclang.source import SourceFile
from yarclang.syntax.parse import forget


@frozen(eq=False)
class Begun:
    """The state of a check in which no motion is planned yet; `check_further` continues from it.

    Attributes:
        opened: the parsed program and its request.
        found: findings from opening the file.
        program: the checked program, with its findings.
        around: surroundings of the program.
        said: remarks of the lint rules that read only the syntax tree or the checked program, by rule.
        boxes: True if the OFFSETs are also to be tried in the whole range of their registers.
    """

    opened: Opened
    found: tuple[Diagnostic, ...]
    project: Project
    program: Result[Program]
    around: Surroundings
    said: Remarks
    boxes: bool = False

    @property
    def source(self) -> SourceFile:
        """Return the program's file."""
        return self.opened.module.source


@frozen(eq=False)
class Checked:
    """The findings about a file, and the results of the compiler's stages that were reached.

    `source` is None if the file couldn't be read, or is no program; `opened` is None if the robot isn't
    known. `program` may have gaps in place of commands with errors. `compiled` exists only if there is no
    error; findings that the project's settings raise to errors count as well. `begun` is the state of a check
    without planning, from which `check_further` can continue with planning.
    """

    diagnostics: tuple[Diagnostic, ...]
    source: SourceFile | None = None
    opened: Opened | None = None
    program: Program | None = None
    plan: MotionPlan | None = None
    compiled: Compiled | None = None
    begun: Begun | None = None


def check_file(path: str, options: Options, *, plans: bool = True, boxes: bool = False) -> Checked:
    """Check a program, the description of a cell or a robot (a .toml file), or a controller text (a .pmc
    file).

    Args:
        path: the file, or `-` for standard input.
        options: the user's options.
        plans: True to plan and prove the motions. False for only the findings that need no planning.
        boxes: True to try the OFFSETs in the whole range of their registers, which takes a while.
    """
    if path.lower().endswith(SUFFIX):
        try:
            return Checked(in_order(check_description(path, options.robot)))
        except Exception as error:  # a bug of ours: other files are still checked
            return Checked((failure(error, SourceFile(path, "")),))
    if is_compiled(path):
        try:
            return Checked(in_order(check_controller_text(path, options)))
        except Exception as error:  # a bug of ours
            return Checked((failure(error, SourceFile(path, "")),))
    return check_program_file(path, options, plans=plans, boxes=boxes)


def check_program_file(path: str, options: Options, *, plans: bool = True, boxes: bool = False) -> Checked:
    """Check a program like `check_file`, whatever the name of its file is."""
    read = read_source(path)
    if read.value is None:
        return Checked(in_order(read.diagnostics))
    folder = Path.cwd() if path == STANDARD_INPUT else Path(path).parent
    return check_text(read.value, folder, options, plans=plans, boxes=boxes)


def check_text(
    source: SourceFile, folder: Path, options: Options, *, plans: bool = True, boxes: bool = False
) -> Checked:
    """Check the text of a program in a folder, like `check_file`. An exception in a stage becomes a
    finding.
    """
    try:
        begun = _opened(source, folder, options)
        if isinstance(begun, Checked):
            return begun
        return _planned_if_possible(replace(begun, boxes=boxes)) if plans else _unplanned(begun)
    except Exception as error:  # a bug of ours
        return Checked((failure(error, source),), source)


def check_further(checked: Checked, early: Callable[[Checked], None] | None = None) -> Checked:
    """Plan and prove the motions of a program that was checked without planning, and return the result.

    No stage is repeated, except that loops are now carried out in full.

    Args:
        checked: result of the check without planning.
        early: function that gets the intermediate result when all motions are planned, but not proved yet. It
            is not called for a program with errors.
    """
    begun = checked.begun
    if begun is None:
        return checked
    request = begun.opened.request
    if request.enough is not None:
        opened = replace(begun.opened, request=replace(request, enough=None))
        assert begun.program.value is not None  # a check always gives a program
        is_whole = not begun.program.value.is_cut
        begun = replace(begun, opened=opened) if is_whole else _begun(opened, begun.found, begun.project)
    return _planned_if_possible(begun, early)


def _planned_if_possible(begun: Begun, early: Callable[[Checked], None] | None = None) -> Checked:
    """Return the result of all stages. If a stage raises an exception, return the findings so far and a
    finding about the exception.
    """
    try:
        return _planned(begun, early)
    except Exception as error:  # a bug of ours
        checked = _unplanned(begun)
        found = in_order((*checked.diagnostics, failure(error, begun.source)))
        return replace(checked, diagnostics=found, begun=None)


_LONG = 10_000
"""Number of lines of a text above which the parser's cache of statements is cleared after parsing. This is
done only if no other results are cached: then the statements aren't needed again.
"""


def _opened(source: SourceFile, folder: Path, options: Options) -> Begun | Checked:
    """Check a program without planning any motion. If it can't be parsed or its robot isn't known, return
    only findings.
    """
    opened = open_source(source, folder, options)
    if isinstance(options.memory, Forgetful) and len(source.lines) > _LONG:
        forget()
    project = find_project(folder, options.texts).value or Project(folder)
    if opened.value is None:
        return Checked(settled(opened.diagnostics, source, project), source)
    return _begun(opened.value, opened.diagnostics, project)


def _begun(opened: Opened, findings: tuple[Diagnostic, ...], project: Project) -> Begun:
    request = opened.request
    program = check_program(opened.module, request)
    assert program.value is not None  # a check always gives a program
    around = Surroundings(opened.module, request.robot, program.value.steps, project.teach, request.memory)
    said = remarks((opened.module, program.value), around, _silent(project))
    return Begun(opened, findings, project, program, around, said)


def _unplanned(begun: Begun) -> Checked:
    assert begun.program.value is not None  # a check always gives a program
    told = grouped(begun.program.diagnostics, at_least=begun.program.value.is_cut)
    found = (*begun.found, *told)
    diagnostics = settled(
        (*found, *findings_of(begun.said, begun.around, found)), begun.source, begun.project, begun.opened
    )
    return Checked(diagnostics, begun.source, begun.opened, begun.program.value, begun=begun)


def _planned(begun: Begun, early: Callable[[Checked], None] | None) -> Checked:
    """Plan and prove the motions of a checked program, and return the result of all stages.

    Lines that couldn't be parsed are missing from the plan. The motions of a program with such lines are
    therefore not proved.
    """
    request, source, project = begun.opened.request, begun.source, begun.project
    planned = plan_checked(begun.program, request)
    findings, compiled, remarked = (*begun.found, *planned.diagnostics), None, dict(begun.said)
    program, around = begun.program.value, begun.around
    if planned.value is not None:
        # use the program in the plan: in it, a line that was led around obstacles has become several steps
        program = planned.value.program
        around = replace(around, steps=program.steps)
        remarked |= remarks((planned.value,), around, _silent(project))
        if not has_errors(begun.found):
            if early is not None:
                early(_before_the_proof(begun, planned.value, findings, remarked))
            made = certified_whole(planned.value, request)
            findings, compiled = (*findings, *made.diagnostics), made.value
            if compiled is not None:
                tell("looking for warnings and notes", 0)
                remarked |= remarks((compiled.certificate,), around, _silent(project))
                if begun.boxes:
                    findings = (*findings, *box_findings(compiled.plan, request))
    go_on()
    findings = (*findings, *findings_of(remarked, around, findings))
    is_whole = compiled is not None and not has_errors(findings)
    diagnostics = settled(findings, source, project, begun.opened, is_whole=is_whole)
    proved = None if has_errors(diagnostics) else compiled
    return Checked(diagnostics, source, begun.opened, program, planned.value, proved)


def _before_the_proof(
    begun: Begun, plan: MotionPlan, findings: tuple[Diagnostic, ...], remarked: Remarks
) -> Checked:
    """Return the intermediate result for a program whose motions are planned but not proved yet."""
    findings = (*findings, *findings_of(remarked, begun.around, findings))
    diagnostics = settled(findings, begun.source, begun.project, begun.opened)
    return Checked(diagnostics, begun.source, begun.opened, plan.program, plan)


def _silent(project: Project) -> set[str]:
    """Return the codes of the findings that the project switches off."""
    return {code for code, level in project.levels.items() if level == "off"}


def settled_in_folder(
    diagnostics: Iterable[Diagnostic], source: SourceFile, folder: Path, opened: Opened | None = None
) -> tuple[Diagnostic, ...]:
    """Return the findings that some stages have made about a program in a folder, filtered by the program's
    comments and by yarc.toml.
    """
    return settled(diagnostics, source, find_project(folder).value or Project(folder), opened)


def settled(
    diagnostics: Iterable[Diagnostic],
    source: SourceFile,
    project: Project,
    opened: Opened | None = None,
    *,
    is_whole: bool = False,
) -> tuple[Diagnostic, ...]:
    """Filter findings for output.

    Findings that follow from other findings or that comments suppress are dropped. Findings in modules are
    moved to the CALLs that lead to them. The project's settings give the severities.

    Args:
        diagnostics: all findings.
        source: the program's file.
        project: settings of the project.
        opened: the parsed program; None if it couldn't be opened. Without it, findings in modules aren't
            moved.
        is_whole: True if all checks were made: only then a comment that suppresses nothing is reported.
    """
    levelled: list[Diagnostic] = []
    go_on()
    findings = without_followers(explained(answered(diagnostics, source)), source)
    unjudged: frozenset[int] = frozenset()
    if opened is not None:
        unjudged = uncalled_lines(opened.module) if is_whole and has_suppressions(source) else unjudged
        findings = at_callers(findings, opened.module, opened.request.load)
    go_on()
    findings = few_in_a_line(suppress(source, findings, is_whole=is_whole, unjudged=unjudged))
    for finding in each(findings):
        level = project.levels.get(finding.code, "")
        if finding.is_error or not level:
            levelled.append(finding)
        elif level != "off":
            levelled.append(replace(finding, level=cast("Severity", level)))
    return in_order(levelled)
