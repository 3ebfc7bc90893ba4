"""`yarc resume`."""

from __future__ import annotations

import click

from yarclang.cli.address import run_option, trouble_is_said

_PATIENCE = 20.0
"""Longest wait until a run continues [s]. It is long because the robot may have to come to rest first."""


@click.command("resume")
@run_option
@click.option("--answer", type=int, metavar="N", help="Answer to the question of a HOLD.")
def command(run: str | None, answer: int | None) -> None:
    """Go on after a hold, or to the next command of `yarc run --step`."""
    with trouble_is_said():
        from yarclang.cli.ordering import order, status_of
        from yarclang.runtime.transports.runs import the_run

        chosen = the_run(run)
        asks = status_of(chosen).get("asks")
        if asks is not None and (answer is None or not asks["low"] <= answer <= asks["high"]):
            what = "" if answer is None else f", not {answer}"
            wanted = f"--answer with a number from {asks['low']} to {asks['high']}{what}"
            raise click.UsageError(f"{chosen.name} asks: {asks['text'] or asks['into']}: {wanted}")
        status = order(chosen, "resume", _PATIENCE, **({} if answer is None else {"value": answer}))
        if status is None:
            click.echo(f"{chosen.name}: the run has ended in the meantime")
        else:
            # after the order the state may still be `init`, while the next part is being loaded
            state = "going on" if status["state"] == "init" else status["state"]
            click.echo(f"{chosen.name}: {state}, {status['done']:.1f} s done, {status['left']:.1f} s left")
