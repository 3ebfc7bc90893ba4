"""`yarc`: everything but compiling."""

from __future__ import annotations

from importlib import import_module
from keyword import iskeyword

import click

from yarclang import __version__

_COMMANDS = {
    "check": "Check programs without writing anything.",
    "completion": "Print the shell's completion script.",
    "diff": "Compare two programs by path and time.",
    "doc": "Print the reference of a module.",
    "doctor": "Look at a controller before a program is run.",
    "explain": "Explain a finding's code.",
    "hold": "Hold a run on its path.",
    "import": "Make a program of a table, a trajectory, or named states.",
    "inspect": "Show all that is known of one command.",
    "new": "Make the folder of a new project.",
    "override": "Change a run's speed.",
    "plot": "Draw a program's motion.",
    "replay": "Show a recorded run as it happened.",
    "resume": "Go on behind a hold.",
    "robot": "Make, check and list robots.",
    "run": "Run a program on a controller, or simulated.",
    "settings": "Print the controller's settings for a robot.",
    "sim": "Simulate a Turbo PMAC on a TCP port.",
    "status": "Say how a run is going, or a controller is.",
    "stop": "End a run, or whatever a controller does.",
}


class _Lazy(click.Group):
    """Imports a command when it is called for; the list of commands needs none of them."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002  (click's signature)
        return list(_COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        if cmd_name not in _COMMANDS:
            return None
        module = f"{cmd_name}_" if iskeyword(cmd_name) else cmd_name
        command: click.Command = import_module(f"yarclang.cli.commands.{module}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        with formatter.section("Commands"):
            formatter.write_dl(list(_COMMANDS.items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Unknown commands get a suggestion."""
        if args and args[0] not in _COMMANDS and not args[0].startswith("-"):
            from difflib import get_close_matches

            near = get_close_matches(args[0], _COMMANDS, n=1)
            meant = f" Did you mean {near[0]}?" if near else ""
            raise click.UsageError(f"No such command {args[0]!r}.{meant}", ctx)
        return super().resolve_command(ctx, args)


@click.command(cls=_Lazy, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(__version__, message="yarc %(version)s")
def main() -> None:
    """Check, look at and understand YARC programs. `yarcc` compiles them."""
