"""`yarc replay`."""

from __future__ import annotations

import math
import sys
import time
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.parameter import ParamType

if TYPE_CHECKING:
    from yarclang.report.runs.log import RecordedRun
    from yarclang.report.runs.text import Moment, View


class _Speed(ParamType[float]):
    """A number, or `max` for infinity."""

    name = "N|max"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        if isinstance(value, float):
            return value
        if str(value).lower() == "max":
            return math.inf
        try:
            speed = float(value)
        except ValueError:
            speed = math.nan
        if not 0.0 < speed < math.inf:
            self.fail(f"{value!r} is neither a positive number nor max", param, ctx)
        return speed


@click.command("replay")
@click.argument("file", metavar="FILE.mcap", type=click.Path())
@click.option(
    "--speed",
    type=_Speed(),
    metavar="N|max",
    default="1",
    show_default=True,
    help="Speed: 1 as recorded, N times as fast, or max for no delays.",
)
def command(file: str, speed: float) -> None:
    """Show a recorded run: states, remarks, progress, joint positions (deg, mm)."""
    from yarclang.cli.show import show_findings
    from yarclang.report.runs.log import read_run

    result = read_run(file)
    show_findings(result.diagnostics)
    if result.value is None:
        raise SystemExit(1)
    try:
        _show(result.value, speed)
    except KeyboardInterrupt:
        click.echo("\nstopped", err=True)


def _show(run: RecordedRun, speed: float) -> None:
    from yarclang.report.pictures.style import printable
    from yarclang.report.runs.text import head_text, moments_of

    click.echo(head_text(run))
    # at infinite speed, the output is to be read afterwards, not watched
    screen = _Screen(live=sys.stdout.isatty() and math.isfinite(speed))
    since = time.monotonic()
    try:
        for moment in moments_of(run):
            ahead = moment.time / speed - (time.monotonic() - since)
            if ahead > 0.0:
                sys.stdout.flush()
                time.sleep(ahead)
            screen.show(moment)
    finally:
        screen.clear()
    outcome = run.outcome
    if outcome is not None and outcome.where is not None:
        from yarclang.cli.faults import fault_text

        click.echo(
            fault_text(outcome.code, printable(outcome.what), printable(outcome.remedy), outcome.where)
        )


class _Screen:
    """Standard output for a replayed run. On a terminal, a status line changes in place; elsewhere it is
    printed again from time to time.
    """

    def __init__(self, *, live: bool) -> None:
        self._live = live
        self._shown = False
        self._command = ""
        self._written = -math.inf

    def show(self, moment: Moment) -> None:
        """Show the messages and the progress at one instant of the run."""
        if moment.line:
            self.clear()
            click.echo(f"{moment.time:9.3f} s  {moment.line}")
        elif self._live:
            self._change(moment.view)
        elif self._is_due(moment):
            click.echo(f"{moment.time:9.3f} s  {moment.view.line}")

    def clear(self) -> None:
        """Remove the changing line."""
        if self._shown:
            from yarclang.report.runs.text import over

            click.echo(over("", 0), nl=False)
            self._shown = False

    def _change(self, view: View) -> None:
        import shutil

        from yarclang.report.runs.text import over

        click.echo(over(view.line, shutil.get_terminal_size().columns), nl=False)
        self._shown = True

    def _is_due(self, moment: Moment) -> bool:
        """Return True if the progress is to be printed in a new line: a new command has begun, or some
        time has passed.
        """
        from yarclang.report.runs.text import PLAIN_EACH

        progress = moment.view.progress
        if progress is None or progress.time != moment.time:
            return False
        if progress.command == self._command and moment.time - self._written < PLAIN_EACH:
            return False
        self._command, self._written = progress.command, moment.time
        return True
