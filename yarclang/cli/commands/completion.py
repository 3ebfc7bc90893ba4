"""`yarc completion`."""

from __future__ import annotations

import click


@click.command("completion")
@click.argument("shell", type=click.Choice(["bash", "zsh", "fish"]))
def command(shell: str) -> None:
    """Print the completion script of a shell, for yarc and yarcc.

    For bash: yarc completion bash > ~/.local/share/bash-completion/completions/yarc, or eval "$(yarc
    completion bash)" in ~/.bashrc.
    """
    from click.shell_completion import get_completion_class

    from yarclang.cli.yarc import main as yarc
    from yarclang.cli.yarcc import main as yarcc

    kind = get_completion_class(shell)
    assert kind is not None  # the option allows only shells of click
    for program, name in ((yarc, "yarc"), (yarcc, "yarcc")):
        click.echo(kind(program, {}, name, f"_{name.upper()}_COMPLETE").source())
