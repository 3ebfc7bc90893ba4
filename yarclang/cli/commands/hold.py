"""`yarc hold`."""

from __future__ import annotations

import click

from yarclang.cli.address import run_option, trouble_is_said

_PATIENCE = 5.0
"""Longest wait until a run holds [s]. It is longer than the time after which a lost connection is detected.
"""


@click.command("hold")
@run_option
def command(run: str | None) -> None:
    """Hold a run on its path. `yarc resume` goes on."""
    with trouble_is_said():
        from yarclang.cli.ordering import order
        from yarclang.runtime.transports.runs import the_run

        chosen = the_run(run)
        status = order(chosen, "hold", _PATIENCE)
        if status is None:
            click.echo(f"{chosen.name}: the run has ended in the meantime")
        elif status["state"] == "hold":
            click.echo(
                f"{chosen.name}: holding on the path, {status['done']:.1f} s done, {status['left']:.1f} s "
                "left"
            )
        else:
            click.echo(f"{chosen.name}: nothing moves ({status['state']})")
