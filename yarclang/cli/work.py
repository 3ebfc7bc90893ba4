"""Support of the commands: options, progress, files."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

from yarclang.cli.estimate import Estimate, left_text, stage_of
from yarclang.diagnostics import Diagnostic
from yarclang.files import reason_of, replace_file
from yarclang.progress import told_to

if TYPE_CHECKING:
    from yarclang.pipeline.inputs import Options

_SILENT = 1.0
"""Shortest duration of work for which progress is shown [s]."""

_EACH = 0.1
"""Time between two updates of the bar [s]."""


class Progress:
    """Progress bar on standard error for the work in a context. It is shown only on a terminal, and only if
    the work takes long.

    For a compilation the bar shows the progress over all stages and the remaining time. For other work it
    shows the progress of the current step. A thread draws the bar, so that it also moves during long steps
    without a report.
    """

    def __init__(self) -> None:
        self._wanted = sys.stderr.isatty()
        self._since = time.monotonic()
        self._told: tuple[str, int, int] | None = None
        self._bar: Any = None
        self._task: Any = None
        self._estimate = Estimate()
        self._lock = threading.Lock()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._draw, name="progress", daemon=True)
        self._listening = told_to(self)

    def __enter__(self) -> Progress:
        self._listening.__enter__()
        if self._wanted:
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._listening.__exit__(kind, error, trace)
        self._over.set()
        self.pause()
        if self._wanted:
            self._thread.join()

    def __call__(self, what: str, done: int, total: int) -> None:
        """Report the current step and its progress."""
        if (stage := stage_of(what)) is not None:
            self._estimate.tell(stage, done, total, time.monotonic())
        self._told = what, done, total
        if self._wanted and self._bar is None:
            self._draw_now()

    def file(self, number: int, count: int) -> None:
        """Report that `number` of `count` files are done. Later reports are about the next file."""
        self._estimate = Estimate(number, count)
        if count > 1:
            self("files", number, count)

    def pause(self) -> None:
        """Remove the bar, so that other text can be written."""
        with self._lock:
            self._told = None
            self._since = time.monotonic()
            if self._bar is not None:
                self._bar.stop()
                self._bar = None

    def _draw(self) -> None:
        while not self._over.wait(_EACH):
            self._draw_now()

    def _draw_now(self) -> None:
        """Draw the bar, if the work takes long enough."""
        with self._lock:
            if self._told is not None and time.monotonic() - self._since >= _SILENT:
                self._show(*self._told)

    def _show(self, what: str, done: int, total: int) -> None:
        if self._bar is None:
            from rich.console import Console
            from rich.progress import BarColumn, TextColumn
            from rich.progress import Progress as Bar

            columns = (
                TextColumn("{task.description}"),
                BarColumn(),
                TextColumn("{task.fields[share]}"),
                TextColumn("{task.fields[left]}"),
            )
            bar = Bar(*columns, console=Console(stderr=True), transient=True)
            # Ctrl-C may come between any two lines: store the bar after its task exists, and start it after
            # it is stored
            self._task = bar.add_task(what, total=None, share="", left="")
            self._bar = bar
            bar.start()
        now, counted = time.monotonic(), f" {done:,} of {total:,}" if total else ""
        share: float | None = done / total if total else None
        left = ""
        if stage_of(what) is not None:
            share, left = self._estimate.share(now), left_text(self._estimate.left(now))
        self._bar.update(
            self._task,
            description=f"{what}{counted}",
            completed=share or 0.0,
            total=None if share is None else 1.0,
            share="" if share is None else f"{100.0 * min(share, 0.99):.0f} %",
            left=left,
        )


def options_from(planning: dict[str, Any]) -> Options:
    """Return the options of a command line as an object."""
    from yarclang.pipeline.inputs import Options

    tolerance = planning.get("tolerance")
    return Options(
        robot=planning.get("robot"),
        start=planning.get("start"),
        tm=planning.get("tm"),
        tolerance=None if tolerance is None else (tolerance[0], tolerance[1] if len(tolerance) > 1 else None),
        target=planning.get("target", ""),
        cell=planning.get("cell"),
        avoid_effort=planning.get("avoid_effort", 1),
    )


def write_standard_output(content: str | bytes) -> tuple[Diagnostic, ...]:
    """Write to standard output. If the device is full, return a finding. If the reader has closed the pipe,
    exit silently.
    """
    import click

    try:
        click.echo(content, nl=False)
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        reason = reason_of(error)
        return (
            Diagnostic(
                "Y0107", f"standard output can't be written: {reason}", help="check where the output goes"
            ),
        )
    return ()


def write_all(files: Sequence[tuple[Path, str]]) -> tuple[Diagnostic, ...]:
    """Write several files. If one of them can't be written, restore those that were written before it."""
    before: list[tuple[Path, bytes | None]] = []
    for path, content in files:
        try:
            old = path.read_bytes() if path.is_file() else None
        except OSError:
            old = None
        found = write_whole(path, content)
        if found:
            for done, kept in before:
                if kept is None:
                    done.unlink(missing_ok=True)
                else:
                    write_whole(done, kept)
            return found
        before.append((path, old))
    return ()


def write_whole(path: Path, content: str | bytes) -> tuple[Diagnostic, ...]:
    """Write a file completely or not at all, as `replace_file` does. Return a finding if it can't be
    written.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    try:
        replace_file(path, data)
    except OSError as error:
        reason = reason_of(error)
        return (
            Diagnostic("Y0107", f"{path} can't be written: {reason}", help="check the path and its rights"),
        )
    return ()
