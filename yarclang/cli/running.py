"""What `yarc run` does around the session: signals, keys, the display, the log."""

from __future__ import annotations

import asyncio
import contextlib
import signal
import sys
from collections.abc import Callable, Iterator

import click

from yarclang.runtime.notices import Abort, Changed, Hold, Notice, Progress, Remark, Resume, Stop
from yarclang.runtime.session import Session
from yarclang.runtime.state import State

_MOVING = (State.INIT, State.MOVE, State.HOLD)


@contextlib.contextmanager
def orders_from_terminal(session: Session, give_up: Callable[[], object]) -> Iterator[None]:
    """Ctrl-C holds, and aborts the second time; Enter goes on behind a hold; a termination stops on the path.

    Args:
        session: what is ordered.
        give_up: called where nothing moves yet, so that there is nothing to hold.
    """
    loop = asyncio.get_running_loop()

    def interrupted() -> None:
        state = session.operation.state
        if state is State.MOVE:
            session.order(Hold())
            click.echo(
                "\nholding on the path; Enter or `yarc resume` goes on, Ctrl-C again aborts, `yarc stop` ends",
                err=True,
            )
        elif state in _MOVING:
            session.order(Abort())
        else:
            give_up()

    def terminated() -> None:
        if session.operation.state in _MOVING:
            session.order(Stop())
        else:
            give_up()

    def entered() -> None:
        if not sys.stdin.readline():
            loop.remove_reader(sys.stdin)
        elif session.operation.state is State.HOLD:
            session.order(Resume())

    loop.add_signal_handler(signal.SIGINT, interrupted)
    for number in (signal.SIGTERM, signal.SIGHUP):
        loop.add_signal_handler(number, terminated)
    keys = sys.stdin is not None and sys.stdin.isatty()
    if keys:
        loop.add_reader(sys.stdin, entered)
    try:
        yield
    finally:
        if keys:
            loop.remove_reader(sys.stdin)
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            loop.remove_signal_handler(number)


class Display:
    """Shows a run on standard error: on a terminal one line that changes, else a line now and then."""

    def __init__(self, text_of: Callable[[Notice], str], total: float) -> None:
        self._text_of = text_of
        self._live = sys.stderr.isatty()
        self._total = total
        self._shown = False
        self._told = -1e9

    def take(self, notice: Notice) -> None:
        """Show a notice."""
        text = self._text_of(notice)
        if not text:
            return
        if isinstance(notice, Progress):
            if self._live:
                click.echo(f"\r\x1b[K{text}", err=True, nl=False)
                self._shown = True
            elif notice.time - self._told > 5.0:
                self._told = notice.time
                click.echo(text, err=True)
            return
        if isinstance(notice, Changed | Remark):
            self.clear()
            click.echo(text, err=True)

    def clear(self) -> None:
        """Leave the line that changes."""
        if self._shown:
            click.echo("", err=True)
            self._shown = False


def asked(question: str, yes: bool) -> bool:
    """Whether the user agrees; without a terminal nobody can be asked, and that is wrong usage."""
    if yes:
        return True
    if not sys.stdin.isatty():
        raise click.UsageError(f"{question} Nobody can be asked here: give --yes")
    return click.confirm(question, err=True)
