"""`yarc view`."""

from __future__ import annotations

import ipaddress
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.options import file_argument, planning_options, tm_option

if TYPE_CHECKING:
    from yarclang.view.show import Door
    from yarclang.view.stage import Stage

_LIBRARY = "viser"


@click.command("view")
@file_argument("file", metavar="FILE")
@click.option(
    "--port",
    type=click.IntRange(0, 65535),
    default=8080,
    show_default=True,
    help="TCP port; 0 takes a free one.",
)
@click.option(
    "--host",
    default="127.0.0.1",
    show_default=True,
    help="Where to listen. Other addresses than loopback let the network in.",
)
@click.option("--no-browser", is_flag=True, help="Open no browser; the address is printed in any case.")
@planning_options
@tm_option
def command(file: str, port: int, host: str, no_browser: bool, **planning: Any) -> None:
    """Show a program, its robot and its cell in three dimensions, in a browser, until Ctrl-C. - reads standard input.

    FILE is a program (.yarc), what yarcc made of one (.pmc), or the log of a run (.mcap), which is shown beside its plan.
    Programs with errors are shown as far as they can be planned; findings stand on the path.
    """
    from importlib.util import find_spec

    if find_spec(_LIBRARY) is None:
        raise click.ClickException(
            "yarc view needs viser, which isn't installed: pip install 'yarclang[view]' brings it"
        )
    if not host.strip():
        raise click.BadParameter("it is empty; all addresses are 0.0.0.0", param_hint="--host")
    from yarclang.view.show import Door

    stage = _stage(file, planning)
    _serve(stage, Door(host.strip(), port), opens=not no_browser)


def _stage(file: str, planning: dict[str, Any]) -> Stage:
    """What a file shows; without anything to show the exit status is 1."""
    from yarclang.cli.loading import is_compiled
    from yarclang.cli.show import show_findings
    from yarclang.cli.work import Progress, options_from
    from yarclang.pipeline.controller_text import robot_of_text
    from yarclang.report.cell import cell_text
    from yarclang.report.runs.kind import is_log
    from yarclang.view.opening import opened

    given = [
        f"--{name}" for name, value in planning.items() if value is not None and name not in ("robot", "cell")
    ]
    if given and (is_log(file) or is_compiled(file)):
        raise click.UsageError(f"{', '.join(given)}: {file} is planned already")
    with Progress() as progress:
        found = opened(file, options_from(planning), robot_of_text)
        progress.pause()
    show_findings(found.diagnostics)
    if found.value is None:
        click.echo(f"{file}: nothing to show", err=True)
        raise SystemExit(1)
    if found.value.cell is not None:
        click.echo(cell_text(found.value.cell.source.name), err=True)
    return found.value


def _serve(stage: Stage, door: Door, *, opens: bool) -> None:
    from yarclang.view.show import PortTakenError, show

    def ready(real: Door) -> None:
        if not _is_loopback(real.host):
            click.echo(
                f"warning: {real.host} can be reached over the network, and there is no password: "
                "anyone there can see the program",
                err=True,
            )
        click.echo(f"{stage.title} is shown at {real.url} (Ctrl-C ends)", err=True)
        if opens:
            import webbrowser

            webbrowser.open(real.url)

    try:
        show(stage, door, ready)
    except PortTakenError as error:
        raise click.ClickException(
            f"can't listen on {door.host} port {door.port}: {error}; --port 0 takes a free port"
        ) from None
    except KeyboardInterrupt:
        click.echo("\nended", err=True)


def _is_loopback(host: str) -> bool:
    if host.lower() == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False
