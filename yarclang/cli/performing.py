"""A run from the door's side: connect, look, ask, log, stream, and say how it ended."""

from __future__ import annotations

import asyncio
import contextlib
from typing import Any

import click

from yarclang import __version__
from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.controllers import SIMULATED_REPLY_TIME, robot_argument
from yarclang.cli.ending import Ending, error_text
from yarclang.cli.running import Display, Screen, Terminal
from yarclang.cli.show import show_findings
from yarclang.cli.table import checked_table
from yarclang.coordinator.ordered import OrderedSession
from yarclang.coordinator.programs import Loaded, way_to_start
from yarclang.coordinator.undertaking import Undertaking
from yarclang.hir import Array
from yarclang.pipeline.settings import items_of
from yarclang.runtime.inspection import Inspection
from yarclang.runtime.job import Job
from yarclang.runtime.log import FOLDER, RunLog
from yarclang.runtime.notices import Fail
from yarclang.runtime.outcome import Ended
from yarclang.runtime.performance import (
    connect,
    end_what_runs,
    look,
    perform,
)
from yarclang.runtime.remote import About
from yarclang.runtime.rest import described, off_the_start
from yarclang.runtime.session import REPLY_TIME, Session
from yarclang.runtime.state import State
from yarclang.runtime.transports.local import ControlSocket
from yarclang.runtime.transports.lock import controller_lock

_RESCUE = 30.0
"""How long to try to bring a robot to rest behind a bug of ours [s]."""


def perform_run(loaded: Loaded, address: Address, options: dict[str, Any], again: str | None) -> int:
    """Run what was loaded.

    Args:
        loaded: what.
        address: of the controller.
        options: of the command line.
        again: the command line without --from, for whoever wants to go on, or empty; None where the controller is a simulator of our
            own, which is gone with the run.

    Returns:
        The exit status.
    """
    looped = options["loop"] or (options["times"] or 1) > 1
    if looped and (off := off_the_start(loaded.program, loaded.program.end)):
        _say_error(
            f"{loaded.program.name} doesn't end where it starts, so that it can't be looped: its end is off by "
            + off.partition(": ")[2],
            "end it with a motion to its start",
        )
        return 1
    run: _Run | None = None
    try:
        with trouble_is_said(), controller_lock(address.host, address.port):
            run = _Run(loaded, address, options, again)
            return asyncio.run(run.whole())
    except asyncio.CancelledError:
        assert run is not None  # nothing is cancelled before
        run.screen.close()
        if run.terminal.gave_up:
            guard = " (its guard PLC holds the motion when the buffer runs low)" * loaded.rest.guarded
            _say_error(
                f"given up without a connection: nobody knows what the robot does{guard}", "look at the robot"
            )
        else:
            _say("given up; nothing was moved")
    return 1


def _say(text: str, *, err: bool = True) -> None:
    """Say something; a terminal that is gone doesn't change how a run ends."""
    with contextlib.suppress(OSError):
        click.echo(text, err=err)


def _say_error(what: str, remedy: str) -> None:
    _say(error_text(what, remedy))


class _Run:
    """One `yarc run`."""

    def __init__(self, loaded: Loaded, address: Address, options: dict[str, Any], again: str | None) -> None:
        self.loaded = loaded
        self.address = address
        self.options = options
        self.again = again
        self.robot = loaded.program.robot
        self.session = OrderedSession(
            address.host,
            address.port,
            reply_time=SIMULATED_REPLY_TIME if again is None else REPLY_TIME,
            pace=options["rate"] or 1.0,
        )
        self.screen = Screen()
        self.display = Display(self.screen, self.session.operation, loaded.program)
        self.terminal: Terminal
        where = f"--to {address} --robot {robot_argument(self.robot, options['robot'])}"
        self.ending = Ending(loaded, where, again)
        times = options["times"] or (None if options["loop"] else 1)
        self.undertaking = Undertaking(loaded, self.session, self._perform, self, times)
        self._log: RunLog | None = None

    async def whole(self) -> int:
        """Everything, in order."""
        task = asyncio.current_task()
        assert task is not None
        self.terminal = Terminal(self.session, self.screen, task.cancel)
        with self.terminal:
            try:
                return await self._in_order()
            finally:
                self.session.close()
                self.screen.close()

    async def _in_order(self) -> int:
        session, operation = self.session, self.session.operation
        items = items_of(self.robot)
        await session.perform(connect(operation))
        inspection = await session.perform(look(operation, self.robot, items))
        if inspection.errors or inspection.joints is None:
            self._refuse(inspection)
            return 1
        way = await self._way_to_start(inspection.joints)
        if isinstance(way, int):
            return way
        if self.options["dry_run"]:
            self.screen.close()
            _say(
                f"{len(inspection.checked)} things looked at, all as they should be; nothing moved (--dry-run)",
                err=False,
            )
            return 0
        async with ControlSocket(session, self._describe):
            return await self._logged(way)

    def _refuse(self, inspection: Inspection) -> None:
        count = len(inspection.errors)
        self.screen.say(self.ending.filled(checked_table(inspection.errors)))
        self._wrong(
            f"{count} of {len(inspection.checked)} things "
            f"{'isn' if count == 1 else 'aren'}'t as {'it' if count == 1 else 'they'} must be; nothing moved",
            "`yarc doctor` shows all of them",
        )

    # what is run

    async def _way_to_start(self, joints: Array) -> Job | int | None:
        """The motion to the start, if one is needed and wanted; the exit status where the run is refused."""
        options = self.options
        found = way_to_start(self.robot, self.loaded, joints)
        text, way = found.text, found.job
        if not text:
            return None
        if not (options["approach"] or self.loaded.begins_within):
            self._wrong(text, "--approach moves there slowly, certified")
            return 1
        if way is None:
            show_findings(found.findings)
            self._wrong(text, "there is no slow joint motion to the start: jog the robot there")
            return 1
        how = "round what is in the way" if "SPLINE" in way.commands[0].name else "all joints straight"
        self.screen.say(
            f"{text}\nan approach takes {way.duration:.1f} s, {how} to {described(self.robot, way.end)}"
        )
        if options["dry_run"]:
            return None
        if not (options["yes"] or await self.terminal.agrees("Move there?")):
            self.screen.say("nothing moved")
            return 1
        return way

    # carrying it out

    async def _logged(self, way: Job | None) -> int:
        try:
            log = self._log = None if self.options["no_log"] else self._open_log()
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            place = error.filename or self.options["log"] or FOLDER
            self._wrong(
                f"the log can't be made, {place}: {reason}; nothing moved",
                "make room, or say --log PATH, or --no-log",
            )
            return 1
        if log is not None:
            self.session.listen(log.take)
            self.session.log = log
        self.session.listen(self.display.take)
        ended = None
        try:
            self.terminal.performing = True
            ended = self.ending.placed(await self.undertaking.carry_out(way))
        except Exception:
            await self._rescue()
            raise
        finally:
            self.terminal.performing = False
            if log is not None:
                log.close(ended)
        return self._told(ended, log)

    def _open_log(self) -> RunLog:
        loop = asyncio.get_running_loop()

        def failed(reason: str) -> None:
            what = Fail(f"the log can't be written: {reason}", "make room on the disk, or give --no-log")
            loop.call_soon_threadsafe(self.session.order, what)

        return RunLog.open(
            self.options["log"],
            self.loaded.program,
            str(self.address),
            version=__version__,
            on_failure=failed,
            pace=self.session.pace,
        )

    # how far it is: what `Undertaking` tells

    def begins(self, job: Job, *, instead: str = "", brief: bool = False) -> None:
        """A job begins."""
        self.display.begin(job, instead=instead, brief=brief)

    def pauses(self, title: str, number: int, of: int) -> None:
        """It stands between two steps."""
        self.screen.say(f"Enter or `yarc resume` for {title} ({number} of {of}), Ctrl-C ends the run")

    def passes(self, number: int, of: int | None) -> None:
        """Once more."""
        self.screen.say(f"pass {number}{f' of {of}' if of else ''}")

    async def _perform(self, job: Job) -> Ended:
        if self._log is not None:
            self._log.begin(job)
        return await self.session.perform(perform(self.session.operation, job))

    async def _rescue(self) -> None:
        """Behind a bug of ours: bring the robot to rest and end what runs, if that can be done. Nothing of the session is trusted."""
        if self.session.operation.state in (State.STOP, State.FAULT):
            return
        self.session.close()
        session = Session(self.address.host, self.address.port, pace=self.session.pace)
        with contextlib.suppress(Exception):
            async with asyncio.timeout(_RESCUE):
                await session.perform(connect(session.operation))
                joints = await session.perform(end_what_runs(session.operation, self.robot, abort=False))
                where = (
                    f"stands at {described(self.robot, joints)}"
                    if joints is not None
                    else "isn't homed any more"
                )
                self.screen.say(f"a bug of yarclang has ended the run; {self.robot.name} {where}")
        session.close()

    # saying how it ended

    def _told(self, ended: Ended, log: RunLog | None) -> int:
        """Say how it ended.

        Returns:
            The exit status.
        """
        if log is not None and not log.loss:
            self.screen.say(f"log: {log.path}{', which ends early' if log.failure is not None else ''}")
        if not ended.well:
            if log is not None and log.loss:
                self._wrong(log.problem, log.remedy)
            state, under = self.session.operation.state, self.undertaking
            for line in self.ending.lines(ended, state, moved=under.moved, on_the_way=under.on_the_way):
                self.screen.say(line)
            return 1
        self.screen.close()  # what follows goes elsewhere
        passes = self.undertaking.passes
        times = f" {passes} times" if passes > 1 else ""
        name = self.loaded.program.name
        _say(f"{name}: done{times}; {self.robot.name} stands where it ends, to a count", err=False)
        if log is None or not log.problem:
            return 0
        _say_error(log.problem, log.remedy)
        return 1

    def _wrong(self, what: str, remedy: str) -> None:
        """Say what is wrong, behind what the screen shows."""
        self.screen.say(error_text(what, self.ending.filled(remedy)))

    def _describe(self) -> About:
        """What `yarc status` tells besides the session's own state."""
        return About(self.loaded.program.name, self.robot)
