"""`yarc lsp`."""

from __future__ import annotations

import click

from yarclang.files import reason_of


def _address(ctx: click.Context, param: click.Parameter, value: str | None) -> tuple[str, int] | None:
    """Parse HOST:PORT, or PORT for this machine."""
    if value is None:
        return None
    host, _, port = value.rpartition(":")
    if not port.isdecimal() or not 0 < int(port) < 65536:
        raise click.BadParameter(f"{value!r} is neither PORT nor HOST:PORT", ctx, param)
    return host or "127.0.0.1", int(port)


@click.command("lsp")
@click.option("--stdio", is_flag=True, help="Talk over standard input and output (default).")
@click.option(
    "--tcp",
    callback=_address,
    metavar="[HOST:]PORT",
    help="Wait for one editor on this TCP port instead (of this computer, unless HOST is given).",
)
@click.option(
    "--robot", metavar="NAME|PATH", help="The robot for programs without a ROBOT line, as for yarc check."
)
def command(stdio: bool, tcp: tuple[str, int] | None, robot: str | None) -> None:
    """Start the language server, which checks programs during typing. Editors start it themselves.

    docs/editors.md says how to set up an editor.
    """
    if stdio and tcp is not None:
        raise click.UsageError("--stdio and --tcp: choose one")
    from yarclang.lsp.serving import serve

    if tcp is not None:
        click.echo(f"waiting for an editor on {tcp[0]}:{tcp[1]}; Ctrl-C ends", err=True)
    try:
        serve(tcp, robot)
    except OSError as error:
        reason = reason_of(error)
        where = f"{tcp[0]}:{tcp[1]}" if tcp else "standard input and output"
        raise click.ClickException(f"{where}: {reason}; choose another port, or none") from None
    except KeyboardInterrupt:
        click.echo(err=True)
