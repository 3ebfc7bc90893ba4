"""`yarc registers`."""

from __future__ import annotations

import click

from yarclang.cli.address import trouble_is_said


@click.command("registers")
@click.argument("file", required=False, metavar="[FILE.yarc]")
@click.option("--forget", is_flag=True, help="Delete the values: the next run begins with the initial ones.")
def command(file: str | None, forget: bool) -> None:
    """Print the last values of KEPT registers, of one program or of all, on each controller."""
    if forget and file is None:
        raise click.UsageError("--forget: say of which program")
    with trouble_is_said():
        from yarclang.coordinator import kept_registers

        program = "" if file is None else kept_registers.program_of(file)
        if forget:
            count = kept_registers.forget(program)
            click.echo(f"{file}: {count} value{'s' * (count != 1)} forgotten")
            return
        found = kept_registers.listed(program=program)
    if not found:
        click.echo("no register is kept" + (f" of {file}" if file else ""))
    before = None
    for one in found:
        if (one.controller, one.program) != before:
            before = one.controller, one.program
            click.echo(f"{one.program} on {one.controller}")
        click.echo(f"  {one.register} is {one.value}")
