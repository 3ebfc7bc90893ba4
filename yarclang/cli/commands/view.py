"""`yarc view`."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.address import Address, AddressType, run_option, trouble_is_said
from yarclang.cli.options import file_argument, planning_options, tm_option
from yarclang.hosts import is_loopback

if TYPE_CHECKING:
    from yarclang.view.door import Door
    from yarclang.view.stage import Stage

_LIBRARY = "viser"


@click.command("view")
@file_argument("file", metavar="[FILE]", required=False)
@click.option(
    "--live",
    is_flag=True,
    help="Instead of FILE: show a running robot. If it is simulated, its inputs can be set.",
)
@partial(run_option, which="With --live: the run")
@click.option(
    "--to",
    type=AddressType(sim=False),
    metavar="tcp://HOST[:PORT]",
    help="With --live: the robot at this controller, which a process of this computer drives.",
)
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
    help="Address to listen on. Addresses other than loopback are reachable over the network.",
)
@click.option("--no-browser", is_flag=True, help="Don't open a browser; the address is always printed.")
@planning_options
@tm_option
def command(
    file: str | None,
    live: bool,
    run: str | None,
    to: Address | None,
    port: int,
    host: str,
    no_browser: bool,
    **planning: Any,
) -> None:
    """Show a program, its robot and its cell in three dimensions, in a browser, until Ctrl-C.

    FILE is a program (.yarc; - for standard input), a controller text (.pmc), or the log of a run (.mcap),
    which is shown beside its plan. Programs with errors are shown as far as they can be planned; findings are
    marked on the path. --live shows a robot that `yarc serve`, `run` or `repl` drives now, without moving it.
    """
    _check_usage(file, live, run, to, planning)
    from importlib.util import find_spec

    if find_spec(_LIBRARY) is None:
        raise click.ClickException(
            "yarc view needs viser, which isn't installed: pip install '.[view]' in yarclang's folder "
            "brings it"
        )
    if not host.strip():
        raise click.BadParameter("it is empty; use 0.0.0.0 for all addresses", param_hint="--host")
    from yarclang.view.door import Door

    door = Door(host.strip(), port)
    if file is None:
        _serve_live(run, to, door, opens=not no_browser)
        return
    _serve(_stage(file, planning), door, opens=not no_browser)


def _check_usage(
    file: str | None, live: bool, run: str | None, to: Address | None, planning: dict[str, Any]
) -> None:
    """Check that either a file or --live is given, and only options that apply to the one that is given.

    Raises:
        click.UsageError: the combination is wrong.
    """
    if not live:
        given = [name for name, value in (("--run", run), ("--to", to)) if value is not None]
        if given:
            raise click.UsageError(f"{' and '.join(given)}: only with --live")
        if file is None:
            raise click.UsageError("Missing argument 'FILE'; --live shows a running robot.")
        return
    if file is not None:
        raise click.UsageError(f"--live shows a running robot instead of a file: leave {file} out")
    if run is not None and to is not None:
        raise click.UsageError("--to and --run exclude each other")
    if given := [f"--{name}" for name, value in planning.items() if value is not None]:
        raise click.UsageError(
            f"{', '.join(given)}: not with --live; this comes from the process that drives the robot"
        )


def _stage(file: str, planning: dict[str, Any]) -> Stage:
    """Return the stage of a file: what the three-dimensional view shows. If there is nothing to show, exit
    with status 1.
    """
    from yarclang.cli.show import show_findings, show_without_notes
    from yarclang.cli.work import Progress, options_from
    from yarclang.pipeline.controller_text import is_compiled, robot_of_text
    from yarclang.report.cell import cell_text
    from yarclang.report.runs.kind import is_log
    from yarclang.view.opening import opened

    given = [
        f"--{name}" for name, value in planning.items() if value is not None and name not in ("robot", "cell")
    ]
    if given and (is_log(file) or is_compiled(file)):
        raise click.UsageError(f"{', '.join(given)}: {file} contains its plan already")
    with Progress() as progress:
        found = opened(file, options_from(planning), robot_of_text)
        progress.pause()
    if is_log(file) or is_compiled(file):
        show_findings(found.diagnostics)
    else:
        show_without_notes(found.diagnostics, file)
    if found.value is None:
        click.echo(f"{file}: nothing to show", err=True)
        raise SystemExit(1)
    if found.value.cell is not None:
        click.echo(cell_text(found.value.cell.source.name), err=True)
    return found.value


def _serve_live(run: str | None, to: Address | None, door: Door, *, opens: bool) -> None:
    from yarclang.view.live import show_live
    from yarclang.view.reaching import Whose

    whose = Whose(run) if to is None else Whose(None, to.host, to.port)
    with trouble_is_said():
        _until_interrupted(
            door,
            lambda: show_live(
                whose,
                door,
                lambda real, name: _ready(
                    real, name, "the robot, and set its inputs if it is simulated", opens
                ),
            ),
        )


def _serve(stage: Stage, door: Door, *, opens: bool) -> None:
    from yarclang.view.show import show

    _until_interrupted(
        door, lambda: show(stage, door, lambda real: _ready(real, stage.title, "the program", opens))
    )


def _ready(real: Door, title: str, seen: str, opens: bool) -> None:
    """Print the address of the three-dimensional view.

    Args:
        real: address at which the view is served.
        title: title of the view.
        seen: what others can see or do if they open the address.
        opens: True to open a browser.
    """
    if not is_loopback(real.host):
        click.echo(
            f"warning: {real.host} can be reached over the network, and there is no password: "
            f"anyone there can see {seen}",
            err=True,
        )
    click.echo(f"{title} is shown at {real.url} (Ctrl-C ends)", err=True)
    if opens:
        import webbrowser

        webbrowser.open(real.url)


def _until_interrupted(door: Door, serve: Callable[[], None]) -> None:
    from yarclang.view.door import PortTakenError

    try:
        serve()
    except PortTakenError as error:
        raise click.ClickException(
            f"can't listen on {door.host} port {door.port}: {error}; --port 0 takes a free port"
        ) from None
    except KeyboardInterrupt:
        click.echo("\nended", err=True)
