"""Groups of commands that are imported only when they are called. Listing the commands imports none of
them.
"""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from importlib import import_module
from keyword import iskeyword
from typing import Any

import click

from yarclang.cli.door import Door


class LazyGroup(Door, click.Group):
    """A group of commands. Each command is a module of `yarclang.cli.commands` that has an object `command`.

    Args:
        commands_by_section: for each section of --help, its commands and their summaries.
        prefix: beginning of the names of the commands' modules.
        on_unix: commands that work with a robot. They need Unix sockets, locks and signals.
    """

    def __init__(
        self,
        *args: Any,
        commands_by_section: Mapping[str, Mapping[str, str]] | None = None,
        prefix: str = "",
        on_unix: Collection[str] = (),
        **settings: Any,
    ) -> None:
        super().__init__(*args, **settings)
        self.commands_by_section = dict(commands_by_section or {})
        self.commands_by_name = {
            name: summary
            for commands in self.commands_by_section.values()
            for name, summary in commands.items()
        }
        self.prefix = prefix
        self.on_unix = on_unix

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002  (click's signature)
        """Return the names of the commands."""
        return list(self.commands_by_name)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        """Return the command with a name."""
        if cmd_name not in self.commands_by_name:
            return None
        module = f"{cmd_name}_" if iskeyword(cmd_name) else f"{self.prefix}{cmd_name}"
        command: click.Command = import_module(f"yarclang.cli.commands.{module}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        """Write the commands for --help in their sections, with all summaries in one column."""
        width = max(map(len, self.commands_by_name), default=0)
        for title, commands in self.commands_by_section.items():
            with formatter.section(title):
                formatter.write_dl([(f"{name:<{width}}", summary) for name, summary in commands.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Resolve a command; for an unknown name, suggest a similar one."""
        if args and args[0] not in self.commands_by_name and not args[0].startswith("-"):
            from difflib import get_close_matches

            near = get_close_matches(args[0], self.commands_by_name, n=1)
            meant = f" Did you mean {near[0]}?" if near else ""
            raise click.UsageError(f"No such command {args[0]!r}.{meant}", ctx)
        name, command, more = super().resolve_command(ctx, args)
        if name in self.on_unix and not hasattr(os, "fork") and not {"-h", "--help"} & {*more}:
            raise click.ClickException(
                f"{ctx.command_path} {name} needs Unix sockets and locks, which this system doesn't "
                "have: use Linux. Programs can be checked, compiled, plotted and viewed here"
            )
        return name, command, more
