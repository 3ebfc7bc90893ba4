"""`yarc override`."""

from __future__ import annotations

import math

import click

from yarclang.cli.address import run_option, trouble_is_said

_PATIENCE = 5.0
"""Longest wait until a run has changed its override [s]."""


def _number(ctx: click.Context, param: click.Parameter, value: float) -> float:
    """Reject nan, which click's range accepts."""
    if math.isnan(value):
        raise click.BadParameter("'nan' isn't a number", ctx, param)
    return value


@click.command("override")
@click.argument("percent", type=click.FloatRange(1.0, 100.0), callback=_number)
@run_option
def command(percent: float, run: str | None) -> None:
    """Run at PERCENT of the programmed speed, 1 to 100, on the same path."""
    with trouble_is_said():
        from yarclang.cli.ordering import order
        from yarclang.runtime.transports.runs import the_run

        chosen = the_run(run)
        status = order(chosen, "override", _PATIENCE, percent=percent)
        if status is None:
            click.echo(f"{chosen.name}: the run has ended in the meantime")
        else:
            click.echo(f"{chosen.name}: {status['override']:g} % of the programmed speed ({status['state']})")
