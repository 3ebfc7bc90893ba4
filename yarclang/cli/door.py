"""Base class of all commands: exceptions aren't shown as tracebacks, and any text can be written."""

from __future__ import annotations

import errno
import io
import sys
from typing import TYPE_CHECKING, Any

import click

from yarclang.cli.garbage import end_quietly
from yarclang.cli.interrupts import repeat_lost_interrupts

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic


class Door(click.Command):
    """A command that reports its own bugs as findings; the exit status is then 1."""

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run the command. Characters that the terminal's encoding lacks, as in file names, are written as
        ASCII escapes.
        """
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="backslashreplace")
        end_quietly()
        repeat_lost_interrupts()
        return super().main(*args, **extra)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command's function."""
        try:
            return super().invoke(ctx)
        except Exception as error:
            if not is_failure(error):
                raise
            from yarclang.cli.show import show_findings

            show_findings((failure_of(error),))
            raise SystemExit(1) from None


def is_failure(error: Exception) -> bool:
    """Return True if an exception is a bug of this software; False for click's usage errors and exits, and
    for closed pipes.
    """
    if isinstance(error, click.ClickException | click.exceptions.Exit | click.Abort):
        return False
    return not (isinstance(error, OSError) and error.errno == errno.EPIPE)


def failure_of(error: Exception, file: str | None = None) -> Diagnostic:
    """Convert an exception to a finding, about a file if a file is given."""
    from yarclang.internal_errors import internal_error
    from yarclang.source import SourceFile

    source = None if file is None else SourceFile(file, "")
    try:
        from yarclang.pipeline.guarding import failure
    except ImportError:  # the failure itself may be an import
        return internal_error(error, source)
    return failure(error, source)
