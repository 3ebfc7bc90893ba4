"""`yarc resume`."""

from __future__ import annotations

import click

from yarclang.cli.address import run_option, trouble_is_said

_PATIENCE = 20.0
"""How long a run may take to go on [s]: the robot must be at rest first."""


@click.command("resume")
@run_option
def command(run: str | None) -> None:
    """Go on behind a hold, or to the next command of `yarc run --step`."""
    with trouble_is_said():
        from yarclang.cli.ordering import order
        from yarclang.runtime.transports.runs import the_run

        chosen = the_run(run)
        status = order(chosen, "resume", _PATIENCE)
        if status is None:
            click.echo(f"{chosen.name}: has ended meanwhile")
        else:
            # what comes next may be loaded yet
            state = "going on" if status["state"] == "init" else status["state"]
            click.echo(f"{chosen.name}: {state}, {status['done']:.1f} s done, {status['left']:.1f} s left")
