"""`yarc settings`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from yarclang.cli.options import robot_argument

if TYPE_CHECKING:
    from yarclang.robot.model import Robot


@click.command("settings")
@robot_argument("robot", metavar="ROBOT")
@click.option(
    "--check",
    "file",
    type=click.Path(allow_dash=True),
    metavar="FILE",
    help="Check a saved or edited settings text instead, and report the differences. - is standard input.",
)
def command(robot: str, file: str | None) -> None:
    """Print the settings that a controller needs once for ROBOT (a name or a path): axis definitions,
    feedback, limits, and the guard of the rotary buffer.

    The text is read back and proved before it is printed; exit status 1 means that the proof failed and
    nothing is printed.
    """
    from yarclang.cli.show import show_findings
    from yarclang.pipeline.inputs import named_robot
    from yarclang.pipeline.settings import settings_of

    loaded = named_robot(Path(), robot)
    show_findings(loaded.diagnostics)
    if loaded.value is None:
        raise SystemExit(1)
    if file is not None:
        _check(file, loaded.value)
        return
    judged = settings_of(loaded.value)
    show_findings(judged.diagnostics)
    if judged.value is None:
        raise SystemExit(1)
    click.echo(judged.value, nl=False)


def _check(file: str, robot: Robot) -> None:
    """Check a settings text in a file, and print what was proved."""
    from yarclang.cli.show import show_findings
    from yarclang.pipeline.settings import check_settings
    from yarclang.pipeline.sources import name_of, read_content
    from yarclang.source import SourceFile

    content = read_content(file)
    show_findings(content.diagnostics)
    if content.value is None:
        raise SystemExit(1)
    # latin-1 keeps every byte: the controller doesn't decode the text either
    judged = check_settings(SourceFile(name_of(file), content.value.decode("latin-1")), robot)
    show_findings(judged.diagnostics)
    if judged.value is None:
        raise SystemExit(1)
    click.echo(f"{name_of(file)}: proved for {robot.name}; {', '.join(judged.value)}")
