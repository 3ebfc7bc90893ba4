"""A run from the door's side: connect, look, ask, log, stream, and say how it ended."""

from __future__ import annotations

import asyncio
import contextlib
import shlex
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import click

from yarclang import __version__
from yarclang.cli.address import Address, trouble_is_said
from yarclang.cli.controllers import robot_argument
from yarclang.cli.faults import fault_text, where_of
from yarclang.cli.loading import Loaded, job_of_compiled
from yarclang.cli.resting import Resting, motion_before, resting_place
from yarclang.cli.running import Display, OrderedSession, Screen, Terminal
from yarclang.cli.show import show_findings
from yarclang.cli.table import checked_table
from yarclang.hir import Array
from yarclang.pipeline.jobs import items_of
from yarclang.pipeline.parts import approach, chain_place
from yarclang.runtime.inspection import Inspection
from yarclang.runtime.job import Job
from yarclang.runtime.log import FOLDER, RunLog
from yarclang.runtime.notices import Fail, Resume
from yarclang.runtime.outcome import Concerned, Ended
from yarclang.runtime.performance import (
    connect,
    end_what_runs,
    look,
    off_the_start,
    perform,
)
from yarclang.runtime.remote import About
from yarclang.runtime.rest import described
from yarclang.runtime.session import REPLY_TIME, Session
from yarclang.runtime.state import Event, State
from yarclang.runtime.transports.local import ControlSocket, controller_lock

_APPROACH = "approach"

_RESCUE = 30.0
"""How long to try to bring a robot to rest behind a bug of ours [s]."""


_SIMULATED_REPLY_TIME = 20.0
"""A simulator of our own isn't lost before [s]: where it is late, this computer has much to do."""


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


def _error_text(what: str, remedy: str) -> str:
    text = click.style("error", fg="red", bold=True) + f": {what}"
    return f"{text}\n  help: {remedy}" if remedy else text


def _say_error(what: str, remedy: str) -> None:
    _say(_error_text(what, remedy))


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
            reply_time=_SIMULATED_REPLY_TIME if again is None else REPLY_TIME,
            pace=options["rate"] or 1.0,
        )
        self.screen = Screen()
        self.display = Display(self.screen, self.session.operation, loaded.program)
        self.terminal: Terminal
        self.where = f"--to {address} --robot {robot_argument(self.robot, options['robot'])}"
        self.passes = 0
        self.on_the_way = False
        self._moved = False
        self._resting: Resting | None = None
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
        await session.perform(connect(operation))
        inspection = await session.perform(look(operation, self.robot, items_of(self.robot)))
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
        self.screen.say(self._filled(checked_table(inspection.errors)))
        self._wrong(
            f"{count} of {len(inspection.checked)} things "
            f"{'isn' if count == 1 else 'aren'}'t as {'it' if count == 1 else 'they'} must be; nothing moved",
            "`yarc doctor` shows all of them",
        )

    # what is run

    async def _way_to_start(self, joints: Array) -> Job | int | None:
        """The motion to the start, if one is needed and wanted; the exit status where the run is refused."""
        job, options = self.loaded.rest, self.options
        whose = job.commands[0].title if self.loaded.begins_within and job.commands else job.name
        text = off_the_start(replace(job, name=whose), joints)
        if not text:
            return None
        if not (options["approach"] or self.loaded.begins_within):
            self._wrong(text, "--approach moves there slowly, certified")
            return 1
        made = approach(self.robot, joints, job.start)
        if made.value is None:
            show_findings(made.diagnostics)
            self._wrong(text, "there is no slow joint motion to the start: jog the robot there")
            return 1
        way = job_of_compiled(made.value, _APPROACH)
        self.screen.say(
            f"{text}\nan approach takes {way.duration:.1f} s, all joints straight to {described(self.robot, job.start)}"
        )
        if options["dry_run"]:
            return None
        if not (options["yes"] or await self.terminal.agrees("Move there?")):
            self.screen.say("nothing moved")
            return 1
        return way

    def _jobs(self) -> Iterator[Job]:
        """The jobs of the program itself: once, in steps, or again and again."""
        if self.loaded.steps:
            yield from self.loaded.steps
            return
        wanted = self.options["times"] or (None if self.options["loop"] else 1)
        job = self.loaded.rest
        while wanted is None or self.passes < wanted:
            self.passes += 1
            yield job
            job = self.loaded.program

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
            ended = self._placed(await self._perform_all(way))
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

    async def _perform_all(self, way: Job | None) -> Ended:
        """The way to the start, then the program."""
        if way is not None:
            self.display.begin(way, instead="to the start")
            self.on_the_way = True
            ended = await self._perform(way)
            if not ended.well:
                # its command is none of the program's
                return replace(ended, command="", command_index="", done=0.0, concerns=None)
            self.on_the_way = False
        ended = Ended(True)
        for number, job in enumerate(self._jobs()):
            if number and self.loaded.steps and (stopped := await self._pause(job, number)) is not None:
                return stopped
            if number and not self.loaded.steps:
                of = f" of {self.options['times']}" if self.options["times"] else ""
                self.screen.say(f"pass {self.passes}{of}")
            self.display.begin(job, brief=bool(number or self.loaded.steps))
            ended = await self._perform(job)
            if not ended.well:
                break
        return ended

    async def _pause(self, job: Job, number: int) -> Ended | None:
        """Until somebody wants the next step; how it ended, if nobody does."""
        session, operation = self.session, self.session.operation
        title = job.commands[0].title if job.commands else "the next command"
        self.screen.say(
            f"Enter or `yarc resume` for {title} ({number + 1} of {len(self.loaded.steps)}), Ctrl-C ends the run"
        )
        session.paused = True
        await session.order_given(Resume)
        session.paused = False
        ends = bool(operation.orders)  # only what ends the run stays
        operation.orders.clear()
        if (failure := session.failure) is not None:
            operation.go(Event.FAULT, failure.what)
            return Ended(False, failure.what, failure.remedy, job.start, done=job.offset)
        if ends:
            operation.go(Event.STOP, f"ended before {title}")
            return Ended(False, f"ended before {title}", joints=job.start, done=job.offset)
        return None

    async def _perform(self, job: Job) -> Ended:
        if self._log is not None:
            self._log.begin(job)
        ended = await self.session.perform(perform(self.session.operation, job))
        self._moved = self._moved or ended.well or bool(ended.command)
        return ended

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
        failed = log is not None and log.failure is not None
        if log is not None:
            self.screen.say(f"log: {log.path}{', which ends early' if failed else ''}")
        if not ended.well:
            for line in self._ending(ended):
                self.screen.say(line)
            return 1
        self.screen.close()  # what follows goes elsewhere
        times = f" {self.passes} times" if self.passes > 1 else ""
        name = self.loaded.program.name
        _say(f"{name}: done{times}; {self.robot.name} stands where it ends, to a count", err=False)
        if failed and log is not None:
            _say_error(f"the log can't be written: {log.failure}", "make room on the disk")
        return int(failed)

    def _ending(self, ended: Ended) -> Iterator[str]:
        """Why, where, in which command, and how to go on."""
        what, remedy = self._filled(ended.what), self._filled(ended.remedy)
        if self.session.operation.state is State.STOP:
            yield f"{self.loaded.program.name}: {what}"
        elif ended.where is not None:
            yield fault_text(ended.code, what, remedy, ended.where)
        else:
            yield _error_text(what, remedy)
        if ended.joints is None:
            yield "  where it stands isn't known: look at the robot"
        else:
            yield f"  {self.robot.name} stands at {described(self.robot, ended.joints)}"
        if not self._moved:
            yield "  nothing had moved"
        elif self.on_the_way:
            yield "  it was on its way to the start"
            yield from self._going_on(self._first_option)
        elif ended.command:
            yield from self._in_command(ended)

    def _placed(self, ended: Ended) -> Ended:
        """With the place in the source of the command that a fault is about. What was heard last of a robot that rests on its path
        may be old: it is looked up there.
        """
        plan, program, concerned = self.loaded.plan, self.loaded.program, ended.concerns
        executed = ended.command in {command.title for command in program.commands}
        if plan is not None and ended.joints is not None and executed:
            self._resting = resting_place(plan, program, ended.joints, ended.done)
        if concerned is None:
            return ended
        if self._resting is not None and concerned.index == ended.command_index:
            there = self._resting.command
            concerned = Concerned(there.index, there.name, there.source_line)
        return replace(ended, concerns=concerned, where=where_of(self.loaded.origins(), concerned))

    def _in_command(self, ended: Ended) -> Iterator[str]:
        """Which command was executed, and how to go on with it."""
        plan, index, found = self.loaded.plan, ended.command_index, self._resting
        if ended.command not in {command.title for command in self.loaded.program.commands}:
            # what isn't a motion is stood at: what goes on begins in front of it
            yield f"  it stood at {ended.command}"
            if plan is not None:
                before = motion_before(plan, index)
                yield from self._going_on(
                    f"--from {shlex.quote(chain_place(plan, before))}" if before else ""
                )
            return
        if found is not None:
            index = found.command.index
            yield f"  on its path, in {found.command.title}, {found.done:.2f} s into the program"
        else:
            yield f"  it was executing {ended.command}, {ended.done:.1f} s into the program"
        if plan is not None and ended.joints is not None and index not in ("", "-"):
            yield from self._going_on(f"--from {shlex.quote(chain_place(plan, index))}")

    def _going_on(self, option: str) -> Iterator[str]:
        if self.again:
            yield f"  to go on: {self.again} {option}".rstrip()

    @property
    def _first_option(self) -> str:
        """What was given for the way to the start."""
        first = self.loaded.rest.commands[:1]
        return (
            f"--from {shlex.quote(first[0].index)}" if self.loaded.begins_within and first else "--approach"
        )

    def _wrong(self, what: str, remedy: str) -> None:
        """Say what is wrong, behind what the screen shows."""
        self.screen.say(_error_text(what, self._filled(remedy)))

    def _filled(self, text: str) -> str:
        """Commands that a text recommends, with this controller and robot, so that they can be copied."""
        text = text.replace("`yarc stop --to ...`", f"`yarc stop {self.where}`")
        return text.replace("`yarc doctor`", f"`yarc doctor {self.where}`")

    def _describe(self) -> About:
        """What `yarc status` tells besides the session's own state."""
        return About(self.loaded.program.name, self.robot)
