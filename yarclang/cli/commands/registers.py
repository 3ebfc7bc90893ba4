"""`yarc registers`."""

from __future__ import annotations

import click

from yarclang.cli.address import trouble_is_said


@click.command("registers")
@click.argument("file", required=False, metavar="[FILE.yarc]")
@click.option("--forget", is_flag=True, help="Delete the values: the next run begins with the initial ones.")
def command(file: str | None, forget: bool) -> None:
    """Print the last values of KEPT registers and the taught places (JPOS, LPOS), of one program or of all,
    on each controller.
    """
    if forget and file is None:
        raise click.UsageError("--forget: name the program")
    with trouble_is_said():
        from yarclang.coordinator import kept_registers, taught_places

        program = "" if file is None else kept_registers.program_of(file)
        if forget:
            count = kept_registers.forget(program) + taught_places.forget(program)
            click.echo(f"{file}: {count} value{'s' * (count != 1)} forgotten")
            return
        found = kept_registers.listed(program=program)
        places = taught_places.places(program)
    if not found and not places:
        click.echo("no register values are stored" + (f" for {file}" if file else ""))
    lines: dict[tuple[str, str], list[str]] = {}
    for one in found:
        lines.setdefault((one.program, one.controller), []).append(f"{one.register} is {one.value}")
    for place in places:
        lines.setdefault((place.program, place.controller), []).append(place.line)
    for (program, controller), said in lines.items():
        click.echo(f"{program} on {controller}")
        for line in said:
            click.echo(f"  {line}")
