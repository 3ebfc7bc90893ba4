"""`yarc inspect`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.options import file_argument, format_option, planning_options, tm_option

if TYPE_CHECKING:
    from yarclang.emitted.purposes import Stretch
    from yarclang.hir import Program
    from yarclang.pipeline.line_map import LineMap
    from yarclang.pipeline.origins import Origins
    from yarclang.report.inspection.inspected import Studied

_MOST_PLACES = 8
"""Largest number of places of a command that are listed."""


@click.command("inspect")
@file_argument("file", metavar="FILE.yarc|FILE.pmc")
@click.argument("place", required=False, metavar="[P0010]")
@click.option(
    "--line",
    type=click.IntRange(1),
    metavar="N",
    help="Show the command to which line N of the file belongs.",
)
@click.option(
    "--source",
    metavar="FILE.yarc",
    type=click.Path(),
    help="For a .pmc: its program (default: looked for beside it, and in the working folder).",
)
@click.option(
    "--ways", is_flag=True, help="Show all branches and loops of a program as a tree, with their durations."
)
@click.option("--all-lines", is_flag=True, help="Show all lines of the command's controller text.")
@planning_options
@tm_option
@format_option
def command(
    file: str,
    place: str | None,
    line: int | None,
    source: str | None,
    ways: bool,
    all_lines: bool,
    format_: str,
    **planning: Any,
) -> None:
    """Show everything about one command: frames, target, joints, every inverse-kinematics solution and why it
    was or wasn't chosen, the limits of its time, its proof, and the lines for the controller.

    Name the command by its index, by its place in loops and calls ("P0020(I=2)>P0010"), or by --line. A line
    of a .pmc leads back to its command. With --ways show the whole program: its branches, and their
    durations.
    """
    from yarclang.pipeline.controller_text import is_compiled

    if ways:
        if place is not None or line is not None or source is not None or is_compiled(file):
            raise click.UsageError("--ways needs the program itself, a .yarc file, and no command")
        raise SystemExit(_ways_of(file, format_, planning))
    if (place is None) == (line is None):
        raise click.UsageError("name a command: its index, such as P0010, or --line N; or use --ways")
    if is_compiled(file):
        _check_compiled_usage(planning)
        raise SystemExit(_of_text(file, place, line, source, all_lines, format_, planning))
    if source is not None:
        raise click.UsageError("--source can be used only with a .pmc")
    raise SystemExit(_of_program(file, place, line, all_lines, format_, planning))


def _check_compiled_usage(planning: dict[str, Any]) -> None:
    if names := [f"--{name}" for name in ("start", "tm", "tolerance") if planning.get(name) is not None]:
        raise click.UsageError(f"{', '.join(names)}: only with the program itself, the .yarc file")


# a program


def _ways_of(file: str, format_: str, planning: dict[str, Any]) -> int:
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import Progress, options_from
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.checking import check_program_file
    from yarclang.report.inspection.outline import outline_lines, outline_of

    with Progress() as progress:
        checked = check_program_file(file, options_from(planning))
        progress.pause()
        if has_errors(checked.diagnostics) or checked.plan is None:
            show_findings(checked.diagnostics)
            return 1
        rows = outline_of(checked.plan)
        if format_ == "json":
            import json

            takes = checked.plan.lasting.to_json()
            document = {"version": 1, "takes": takes, "ways": [row.to_json() for row in rows]}
            click.echo(json.dumps(document, indent=2, ensure_ascii=False))
            return 0
        for text in outline_lines(rows):
            click.echo(text)
        click.echo(f"in all {checked.plan.lasting.text()}")
    return 0


def _of_program(
    file: str, place: str | None, line: int | None, all_lines: bool, format_: str, planning: dict[str, Any]
) -> int:
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import Progress, options_from
    from yarclang.diagnostics import has_errors
    from yarclang.pipeline.checking import check_program_file
    from yarclang.report.inspection.inspected import study

    with Progress() as progress:
        checked = check_program_file(file, options_from(planning))
        progress.pause()
        studied, findings = study(checked), checked.diagnostics
        if studied is None:
            show_findings(findings)
            return 1
        numbers = _numbers(studied.program, place, line)
        if not numbers:
            _say_unknown(studied.program, place, line, has_errors(findings), findings)
            return 1
        _show(studied, numbers, place or f"line {line}", all_lines, format_, findings)
    return int(has_errors(findings))


def _numbers(program: Program, place: str | None, line: int | None) -> tuple[int, ...]:
    """Return the numbers of the selected steps."""
    from yarclang.hir import Gap
    from yarclang.pipeline.places import labels_of, matching

    if place is not None:
        return matching(labels_of(program), place)
    return tuple(
        number
        for number, step in enumerate(program.steps)
        if not isinstance(step, Gap)
        and step.origin.source is program.source
        and step.origin.span.line == line
    )


def _say_unknown(program: Program, place: str | None, line: int | None, wrong: bool, findings: Any) -> None:
    """Report that no command matches the user's selection. Show the errors that may be the reason, and list
    existing commands.
    """
    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import Diagnostic, grouped, in_order
    from yarclang.pipeline.places import labels_of
    from yarclang.subjects import suggest

    if wrong:
        show_findings(in_order(grouped(one for one in findings if one.is_error)))
    labels = list(dict.fromkeys(labels_of(program).values()))
    what = f"there is no command {place}" if place is not None else f"line {line} has no command"
    meant = suggest(place, labels) if place is not None and not wrong else ""
    listed = ", ".join(labels[:_MOST_PLACES]) + (", ..." if len(labels) > _MOST_PLACES else "")
    hidden = "; errors may hide it" if wrong else ""
    help_ = meant or (f"there are {listed}" if listed else "the program has no readable command")
    show_findings((Diagnostic("Y1164", what + hidden, program.source, help=help_),))


def _show(
    studied: Studied,
    numbers: tuple[int, ...],
    wanted: str,
    all_lines: bool,
    format_: str,
    findings: Any,
) -> None:
    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import grouped
    from yarclang.findings import YARCLANG
    from yarclang.hir import Gap
    from yarclang.pipeline.places import labels_of
    from yarclang.report.finding import count_text, finding_json
    from yarclang.report.inspection.inspected import inspect_step

    inspected = inspect_step(studied, numbers[0])
    labels = labels_of(studied.program)
    places = [labels.get(number, "") for number in numbers]
    own = set(inspected.findings)
    others = [one for one in grouped(findings) if one not in own]
    if format_ == "json":
        import json

        from yarclang.report.inspection.as_json import inspected_json

        document = {
            "version": 1,
            "places": places,
            "command": inspected_json(inspected),
            "diagnostics": [finding_json(one) for one in inspected.findings],
            "diagnostics_elsewhere": [finding_json(one) for one in others],
        }
        click.echo(json.dumps(document, indent=2, ensure_ascii=False))
        return
    ours = [one for one in others if one.family == YARCLANG]
    show_findings((*inspected.findings, *ours))
    if elsewhere := count_text(others):
        click.echo(f"elsewhere: {elsewhere}; `yarc check` shows them", err=True)
    if len(different := list(dict.fromkeys(places))) > 1:
        click.echo(
            f"{wanted} is at {len(different):,} places; this is the first. Choose another one:", err=True
        )
        for one in different[:_MOST_PLACES]:
            click.echo(f"  {one}", err=True)
        if len(different) > _MOST_PLACES:
            click.echo(f"  ... to {different[-1]}", err=True)
    from yarclang.report.inspection.text import sections_of

    _print_sections(sections_of(inspected, all_lines=all_lines))
    for number in numbers[1:]:
        step = studied.program.steps[number]
        if not isinstance(step, Gap) and step.origin == inspected.origin:  # a command with several steps
            click.echo()
            _print_sections(sections_of(inspect_step(studied, number), all_lines=all_lines))


def _print_sections(sections: Any) -> None:
    for number, section in enumerate(sections):
        if number:
            click.echo("")
        click.echo(click.style(section.title, bold=True))
        for line in section.lines:
            click.echo(f"  {line}")


# a controller text


def _of_text(
    file: str,
    place: str | None,
    line: int | None,
    source: str | None,
    all_lines: bool,
    format_: str,
    planning: dict[str, Any],
) -> int:
    from yarclang.cli.show import show_findings
    from yarclang.diagnostics import Diagnostic
    from yarclang.pipeline.controller_text import read_controller_text
    from yarclang.pipeline.line_map import is_compiled_text, map_lines
    from yarclang.pipeline.places import matching

    read = read_controller_text(file)
    if read.value is None:
        show_findings(read.diagnostics)
        return 1
    text = read.value.text
    if not is_compiled_text(text):
        message = "this text wasn't written by yarcc"
        show_findings((Diagnostic("Y1151", message, read.value, help="give a .pmc that yarcc wrote"),))
        return 1
    mapped = map_lines(text)
    if line is not None:
        found = mapped.at(line)
        if found is None:
            count = mapped.stretches[-1].last
            message = f"the text has no line {line}: it has {count:,}"
            show_findings((Diagnostic("Y1164", message, read.value, help="give a smaller number"),))
            return 1
        stretches: tuple[Stretch, ...] = (found,)
    else:
        labels = {one.step: one.index for one in mapped.commands if one.index}
        steps = matching(labels, place or "")
        if not steps:
            listed = ", ".join(list(labels.values())[:_MOST_PLACES])
            message = f"there is no command {place}"
            show_findings((Diagnostic("Y1164", message, read.value, help=f"there are {listed}"),))
            return 1
        first = labels[steps[0]]
        stretches = tuple(one for step in steps if labels[step] == first for one in mapped.of(step))
        different = len({labels[step] for step in steps})
        if different > 1 and format_ == "text":
            click.echo(f"{place} is at {different:,} places; this is the first", err=True)
    origins = _origins(file, read.value, source, planning.get("robot"), planning.get("cell"))
    if format_ == "json":
        _print_text_json(mapped, stretches, line, origins, text)
    else:
        _print_sections(_text_sections(mapped, stretches, line, origins, text, all_lines))
    return 0


def _origins(file: str, source: Any, program: str | None, robot: str | None, cell: str | None) -> Origins:
    """Return the sources of a controller text's commands, if they can be found."""
    from yarclang.pipeline.controller_text import robot_of_text
    from yarclang.pipeline.origins import Origins, origins_of_text

    found = robot_of_text(source, robot)
    if found.value is None:
        return Origins(None, "its robot wasn't found: give the path of its robot.toml with --robot PATH")
    return origins_of_text(source.text, Path(file).parent, found.value, program, cell)


def _text_sections(
    mapped: LineMap,
    stretches: tuple[Stretch, ...],
    line: int | None,
    origins: Origins,
    text: str,
    all_lines: bool,
) -> list[Any]:
    from yarclang.emitted.purposes import MOVE
    from yarclang.report.inspection.text import Section, stretch_lines

    lines = tuple(text.split("\n"))
    sections = []
    if line is not None:
        what = stretches[0].what
        what = f"{what} of the command below" if what == MOVE else what
        sections.append(Section(f"line {line}", (lines[line - 1], what)))
    listed = next((one.command for one in stretches if one.command is not None), None)
    if listed is None:
        if line is None:
            sections.append(Section("controller text", ("the command has no lines of its own",)))
        return sections
    origin = origins.of_listed(listed)
    told: list[str] = []
    if origin is not None:
        told.append(f"{origin.source.name}:{origin.span.line}: {listed.title}")
        told.append(origin.source.line(origin.span.line).strip())
    else:
        told.append(f"{listed.title}, line {listed.source_line} of {mapped.program} or of a module of it")
        told.append(
            f"according to the text's own comments: {origins.missing or 'the program has no such command'}"
        )
    told.append(f"step {listed.step} of the program")
    sections.append(Section("command", tuple(told)))
    own = mapped.of(listed.step)
    sections.append(Section("controller text", tuple(stretch_lines(own, lines, all_lines=all_lines))))
    return sections


def _print_text_json(
    mapped: LineMap, stretches: tuple[Stretch, ...], line: int | None, origins: Origins, text: str
) -> None:
    import json

    listed = next((one.command for one in stretches if one.command is not None), None)
    origin = origins.of_listed(listed) if listed is not None else None
    lines = text.split("\n")
    command_ = None
    if listed is not None:
        command_ = {
            "place": listed.index,
            "name": listed.name,
            "step": listed.step,
            "program": mapped.program,
            "line_in_text": listed.source_line,
            "file": origin.source.name if origin else None,
            "line": origin.span.line if origin else None,
            "source": origin.source.line(origin.span.line) if origin else None,
            "controller_text": [
                {"first": one.first, "last": one.last, "what": one.what} for one in mapped.of(listed.step)
            ],
        }
    document = {
        "version": 1,
        "line": line,
        "text": lines[line - 1] if line is not None else None,
        "what": stretches[0].what if line is not None else None,
        "command": command_,
        "source_missing": origins.missing or None,
    }
    click.echo(json.dumps(document, indent=2, ensure_ascii=False))
