"""Process many files in the same way, with the options --jobs, --scheduler and --no-cache."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, TypeVar

import click

from yarclang.cli.outputs import STANDARD

if TYPE_CHECKING:
    from yarclang.diagnostics import Diagnostic
    from yarclang.fleet.doing import Doing
    from yarclang.fleet.outcome import Lost
    from yarclang.fleet.reuse import Reuse
    from yarclang.fleet.spreading import RacingWork, Work
    from yarclang.fleet.store import Store

R = TypeVar("R")
T = TypeVar("T")


class Fleet:
    """Processes many files in the same way. Results of earlier calls may be reused, and the work may be
    distributed to several processes or other computers.

    Args:
        jobs: number of processes; None for one per core.
        scheduler: address of a dask scheduler; empty for this machine.
        reuses: True to reuse results of earlier calls, and to store new ones.
    """

    def __init__(self, jobs: int | None = None, scheduler: str = "", *, reuses: bool = False) -> None:
        from yarclang.fleet.spreading import Place

        self._place = Place(jobs, scheduler)
        self._reuses = reuses
        self._doing: Doing | None = None
        self._store: Store | None = None

    def results(
        self,
        work: Callable[[str], R],
        files: Sequence[str],
        *,
        name: Callable[[str], Hashable],
        is_lasting: Callable[[R], bool],
        lost: Callable[[str, Lost], R],
    ) -> Iterator[R]:
        """Yield the result for each file, in order, like `Doing.results`.

        Args:
            work: function that computes the result for a file.
            files: paths; `-` for standard input, which only this process can read.
            name: function that returns a key for the work on a file. The key must contain everything on which
                the result depends, except the contents of files.
            is_lasting: function that returns True if a result may be stored for later calls, because the same
                work would have the same result the next time.
            lost: function that returns the result for a file whose processes were killed.

        Raises:
            click.ClickException: the scheduler can't be used.
        """
        from yarclang.fleet.doing import Doing
        from yarclang.fleet.outcome import Lost
        from yarclang.fleet.spreading import Place, own_file

        standard = STANDARD in files
        place: Place = Place(1) if standard else self._place
        with_store = self._reuses and not standard
        self._doing = Doing(place, self._reuse() if with_store else None)
        made = self._doing.results(work, files, files=own_file, name=name, is_lasting=is_lasting)
        try:
            for file, result in zip(files, _said(made), strict=True):
                yield lost(file, result) if isinstance(result, Lost) else result
        finally:
            made.close()
            if self._store is not None:
                self._store.close()

    @contextmanager
    def workers(self, work: Callable[[T], R]) -> Iterator[Work[T, R]]:
        """Yield a function that applies `work` to many items that aren't files. Its results are not reused.

        Raises:
            click.ClickException: the scheduler can't be used.
        """
        from yarclang.fleet.outcome import UnreachableError
        from yarclang.fleet.spreading import workers

        try:
            with workers(work, self._place, lambda _: ()) as do:
                yield do
        except UnreachableError as error:
            raise click.ClickException(str(error)) from None

    @contextmanager
    def racing_workers(self, work: Callable[[T], R]) -> Iterator[RacingWork[T, R]]:
        """Yield a function that applies `work` to many items, as `workers` does, but returns each result as
        soon as it is computed.
        """
        from yarclang.fleet.outcome import UnreachableError
        from yarclang.fleet.spreading import racing_workers

        try:
            with racing_workers(work, self._place, lambda _: ()) as do:
                yield do
        except UnreachableError as error:
            raise click.ClickException(str(error)) from None

    def _reuse(self) -> Reuse | None:
        from yarclang.files import cache_folder
        from yarclang.fleet.reuse import Reuse
        from yarclang.fleet.store import Store
        from yarclang.signing import secret_file

        folder = cache_folder()
        if folder is None:
            return None
        self._store = Store(folder, secret_file())
        return Reuse(self._store)

    @property
    def remark(self) -> str:
        """Remark on the number of reused results, and on problems of the cache; empty if there is nothing to
        report.
        """
        remarks = []
        if self._doing is not None and self._doing.reused:
            remarks.append(f"{self._doing.reused:,} as before (--no-cache computes everything again)")
        if self._store is not None and self._store.trouble:
            remarks.append(f"the cache can't be used: {self._store.trouble}")
        return "; ".join(remarks)


def _said(made: Iterator[R]) -> Iterator[R]:
    """Yield the results of `made`. If the scheduler can't be used, raise a click.ClickException."""
    from yarclang.fleet.outcome import UnreachableError

    try:
        yield from made
    except UnreachableError as error:
        raise click.ClickException(str(error)) from None


def ended(file: str, lost: Lost) -> Diagnostic:
    """Return the finding for a file that has no result because the processes that worked on it were
    killed.
    """
    from yarclang.diagnostics import Diagnostic
    from yarclang.source import SourceFile, Span

    message = f"{file} has no result: {lost.reason}"
    return Diagnostic(
        "Y2004", message, SourceFile(file, ""), Span.on_line(1, 1, 1), "try --jobs 1, or check it alone"
    )
