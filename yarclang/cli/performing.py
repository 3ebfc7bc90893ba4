"""A run from the door's side: connect, look, ask, log, stream, and say how it ended."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from typing import Any

import click

from yarclang import __version__
from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.loading import Loaded, job_of_compiled
from yarclang.cli.running import Display, asked, orders_from_terminal
from yarclang.cli.show import show_findings
from yarclang.cli.table import checked_table
from yarclang.hir import Array
from yarclang.pipeline.jobs import items_of
from yarclang.pipeline.parts import approach
from yarclang.report.run_text import notice_text
from yarclang.runtime.inspection import Inspection
from yarclang.runtime.job import Job
from yarclang.runtime.log import RunLog
from yarclang.runtime.notices import Fail, Resume
from yarclang.runtime.performance import Ended, connect, look, off_the_start, perform
from yarclang.runtime.remote import About
from yarclang.runtime.rest import described
from yarclang.runtime.session import Session
from yarclang.runtime.transports.local import ControlSocket, controller_lock


def perform_run(loaded: Loaded, address: Address, options: dict[str, Any]) -> int:
    """Run what was loaded.

    Returns:
        The exit status.
    """
    try:
        with trouble_is_said(), controller_lock(address.host, address.port):
            return asyncio.run(_Run(loaded, address, options).whole())
    except asyncio.CancelledError:
        click.echo("given up; nothing moves", err=True)
    return 1


def _say(what: str, remedy: str) -> None:
    click.echo(click.style("error", fg="red", bold=True) + f": {what}", err=True)
    if remedy:
        click.echo(f"  help: {remedy}", err=True)


class _Run:
    """One `yarc run`."""

    def __init__(self, loaded: Loaded, address: Address, options: dict[str, Any]) -> None:
        self.loaded = loaded
        self.address = address
        self.options = options
        self.robot = loaded.job.robot
        self._log: RunLog | None = None
        self.session = Session(address.host, address.port, pace=options["rate"] or 1.0)

    async def whole(self) -> int:
        """Everything, in order."""
        task = asyncio.current_task()
        assert task is not None
        with orders_from_terminal(self.session, task.cancel):
            try:
                return await self._in_order()
            finally:
                self.session.close()

    async def _in_order(self) -> int:
        session, operation = self.session, self.session.operation
        await session.perform(connect(operation))
        inspection = await session.perform(look(operation, self.robot, items_of(self.robot)))
        if inspection.errors or inspection.joints is None:
            self._refuse(inspection)
            return 1
        first = self._way_to_start(inspection.joints)
        if isinstance(first, int):
            return first
        if self.options["dry_run"]:
            click.echo(
                f"{len(inspection.checked)} things looked at, all as they should be; nothing moved (--dry-run)"
            )
            return 0
        async with ControlSocket(session, self._describe):
            return await self._logged(first)

    def _refuse(self, inspection: Inspection) -> None:
        click.echo(checked_table(inspection.errors), err=True)
        count = len(inspection.errors)
        _say(
            f"{count} of {len(inspection.checked)} things aren't as they must be; nothing moved",
            f"`yarc doctor --to {self.address} --robot {self.robot.name}` shows all of them",
        )

    # what is run

    def _way_to_start(self, joints: Array) -> tuple[Job, ...] | int:
        """The motion to the start, if one is needed and wanted; the exit status where the run is refused."""
        job, options = self.loaded.job, self.options
        text = off_the_start(job, joints)
        if not text:
            return ()
        if not (options["approach"] or self.loaded.moved):
            _say(text, "--approach moves there slowly, certified")
            return 1
        made = approach(self.robot, joints, job.start)
        show_findings(made.diagnostics)
        if made.value is None:
            _say(text, "there is no slow joint motion to the start: jog the robot there")
            return 1
        way = job_of_compiled(made.value, "approach")
        click.echo(
            f"{text}\nan approach takes {way.duration:.1f} s, all joints straight to {described(self.robot, job.start)}",
            err=True,
        )
        if options["dry_run"]:
            return ()
        if not asked("Move there?", options["yes"]):
            click.echo("nothing moved", err=True)
            return 1
        return (way,)

    def _passes(self) -> Iterator[Job]:
        """The jobs of the program itself: once, in steps, or again and again."""
        job, options = self.loaded.job, self.options
        if self.loaded.steps:
            yield from self.loaded.steps
            return
        again = options["times"] or (None if options["loop"] else 1)
        count = 0
        while again is None or count < again:
            yield job
            count += 1

    # carrying it out

    async def _logged(self, first: tuple[Job, ...]) -> int:
        job, options = self.loaded.job, self.options
        if (options["loop"] or (options["times"] or 1) > 1) and off_the_start(job, job.end):
            _say(
                "the program doesn't end where it starts, so that it can't be looped",
                "end it with a motion to its start",
            )
            return 1
        try:
            log = None if options["no_log"] else self._open_log()
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            _say(
                f"the log can't be made: {reason}; nothing moved", "make room, or say --log PATH, or --no-log"
            )
            return 1
        if log is not None:
            self.session.listen(log.take)
        self._log = log
        display = Display(notice_text, job.duration)
        self.session.listen(display.take)
        ended = None
        try:
            for way in first:
                ended = await self._perform(way)
            if ended is None or ended.well:
                ended = await self._perform_program()
        finally:
            display.clear()
            if log is not None:
                log.close(ended)
        if log is not None:
            click.echo(f"log: {log.path}", err=True)
        return self._told(ended)

    def _open_log(self) -> RunLog:
        loop = asyncio.get_running_loop()

        def failed(reason: str) -> None:
            what = Fail(f"the log can't be written: {reason}", "make room on the disk, or give --no-log")
            loop.call_soon_threadsafe(self.session.order, what)

        return RunLog.open(
            self.options["log"],
            self.loaded.job,
            str(self.address),
            version=__version__,
            on_failure=failed,
            pace=self.session.pace,
        )

    async def _perform(self, job: Job) -> Ended:
        if self._log is not None:
            self._log.begin(job)
        return await self.session.perform(perform(self.session.operation, job))

    async def _perform_program(self) -> Ended:
        ended = Ended(True)
        for number, job in enumerate(self._passes()):
            if self.loaded.steps and number:
                click.echo("Enter or `yarc resume` for the next command", err=True)
                await self.session.order_given(Resume)
            ended = await self._perform(job)
            if not ended.well:
                break
        return ended

    def _told(self, ended: Ended) -> int:
        """Say how it ended."""
        if ended.well:
            click.echo(f"{self.loaded.job.name}: done; {self.robot.name} stands where it ends, to a count")
            return 0
        _say(ended.what, ended.remedy)
        if ended.command:
            click.echo(f"  it was executing {ended.command}, {ended.done:.1f} s into the program", err=True)
        if ended.joints is not None:
            click.echo(f"  {self.robot.name} stands at {described(self.robot, ended.joints)}", err=True)
        else:
            click.echo("  where it stands isn't known: look at the robot", err=True)
        if ended.command_index and self.loaded.plan is not None and ended.joints is not None:
            click.echo(f"  to go on: yarc run ... --from {ended.command_index}", err=True)
        return 1

    def _describe(self) -> About:
        """What `yarc status` tells besides the session's own state."""
        return About(self.loaded.job.name, self.robot)
