"""Implement `yarc run`: questions, display, and the report of the end."""

from __future__ import annotations

import asyncio
from dataclasses import dataclass
from typing import Any

from yarclang.cli.address import trouble_is_said
from yarclang.cli.attaching import Place, attached
from yarclang.cli.display import Axes, Display
from yarclang.cli.ending import Ending, error_text, joints_text, say
from yarclang.cli.recovering import how_it_goes, recover
from yarclang.cli.screen import Screen
from yarclang.cli.show import show_findings
from yarclang.cli.table import checked_table
from yarclang.cli.terminal import Terminal
from yarclang.coordinator.attached import Attached, Here
from yarclang.coordinator.describing import program_described
from yarclang.coordinator.engine import NotReady
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import findings_of
from yarclang.coordinator.messages.replies import Ended, LogTold, ProgramDescribed, Status
from yarclang.coordinator.picture import Picture
from yarclang.coordinator.programs import Loaded
from yarclang.coordinator.subscription import Subscription
from yarclang.report.cell import cell_text
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble

_LAST_WORDS = 5.0
"""Longest wait for pending events after the end [s]."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """A program that `yarc run` is to run.

    Attributes:
        loaded: program that was loaded in this process; None if the coordinator loads it.
        load: order by which the coordinator loads it; None if it is loaded in this process.
        robot: robot of the program; None if unknown.
        name: name of the program for people.
        where: options for the controller and the robot, for recommended commands.
        again: the command line without --from; empty if there is none.
    """

    loaded: Loaded | None
    load: orders.Load | None
    robot: Robot | None
    name: str
    where: str
    again: str


def run_program(wanted: Wanted, place: Place, options: dict[str, Any]) -> int:
    """Run a program for `yarc run`.

    Args:
        wanted: the program.
        place: controller or running coordinator of the robot.
        options: options of the command line.

    Returns:
        The exit status.
    """
    if wanted.loaded is not None and not _may_loop(program_described(0, wanted.loaded), options):
        return 1
    run = _Run(wanted, place, options)
    try:
        with trouble_is_said():
            return asyncio.run(run.whole())
    except asyncio.CancelledError:
        run.screen.close()
        if run.terminal.gave_up:
            guarded = run.program is not None and run.program.guarded
            guard = " (its guard PLC holds the motion when the buffer runs low)" * guarded
            _say_error(
                f"given up without a connection: the robot's state is unknown{guard}", "inspect the robot"
            )
        else:
            say("given up; nothing was moved")
    return 1


_SETS_INPUTS = (
    "  inputs of a simulated robot stay OFF until they are set by a sensor of the cell, --set INPUT=ON, "
    "or --inputs SCRIPT.toml"
)


def _may_loop(program: ProgramDescribed, options: dict[str, Any]) -> bool:
    if not (options["loop"] or (options["times"] or 1) > 1) or not program.not_looped:
        return True
    _say_error(
        f"{program.name} can't be looped, since it doesn't end where it starts: {program.not_looped}",
        "add a last motion to its start",
    )
    return False


def _say_error(what: str, remedy: str) -> None:
    say(error_text(what, remedy))


class _Run:
    """One execution of `yarc run`."""

    terminal: Terminal

    def __init__(self, wanted: Wanted, place: Place, options: dict[str, Any]) -> None:
        self.wanted = wanted
        self.place = place
        self.options = options
        self.screen = Screen()
        self.program: ProgramDescribed | None = None
        self._attached: Attached | None = None

    async def whole(self) -> int:
        """Run all steps in order, and return the exit status."""
        task = asyncio.current_task()
        assert task is not None

        def give_up() -> None:
            if isinstance(self._attached, Here):
                self._attached.give_up()
            task.cancel()

        self.terminal = Terminal(self.screen, give_up)
        wanted = self.wanted
        with self.terminal:
            try:
                async with attached(
                    self.place, wanted.robot, "run", self.options, what=wanted.name
                ) as self._attached:
                    cell = self._attached.welcome.status.cell
                    if self.place.served is not None and cell is not None:
                        self.screen.say(cell_text(cell))
                    return await self._in_order(self._attached)
            except NotReady as trouble:
                return self._refuse(trouble)
            finally:
                self.screen.close()

    def _refuse(self, trouble: NotReady) -> int:
        ending = Ending(self.wanted.name, self.wanted.where, self.wanted.again)
        inspection = trouble.inspection
        count = len(inspection.errors)
        self.screen.say(ending.filled(checked_table(inspection.errors)))
        wrong = f"{count} of {len(inspection.checked)} checks failed; nothing moved"
        self.screen.say(error_text(wrong, ending.filled("`yarc doctor` shows all of them")))
        return 1

    async def _in_order(self, robot: Attached) -> int:
        program = self.program = await self._loaded(robot)
        if program is None or not _may_loop(program, self.options):
            return 1
        await robot.ask(orders.Own(shared=True))
        status = robot.welcome.status
        ending = Ending(self.wanted.name, self.wanted.where, self.wanted.again, program)
        picture = Picture(status)
        self.terminal.serve(robot, picture)
        if self.options["recover"]:
            return await recover(robot, program, picture, self.terminal, self.screen, ending, self.options)
        goes = await self._way_to_start(robot, program, ending)
        if goes is None or self.options["dry_run"]:
            if goes is not None:
                self.screen.close()
                looked = await robot.ask(orders.Look())
                say(
                    f"{looked.checked} checks passed; nothing moved (--dry-run)",
                    err=False,
                )
            return int(goes is None)
        if not await self._has_its_tool(program, simulated=robot.welcome.simulated):
            return 1
        display = Display(self.screen, picture, Axes.of(status), program)
        with await robot.listen() as stream:
            showing = asyncio.create_task(self._show(stream, picture, display))
            try:
                self.terminal.performing = True
                ended = await robot.ask(orders.Run(program=program.number, approach=goes, times=self._times))
            except Trouble as trouble:
                # the robot's state has changed since it was checked
                self.screen.say(error_text(trouble.what, ending.filled(trouble.remedy)))
                return 1
            finally:
                self.terminal.performing = False
                stream.close()
                await asyncio.wait((showing,), timeout=_LAST_WORDS)
        released = await robot.ask(orders.Release())
        return self._told(ended, ending, released.log, status)

    @property
    def _times(self) -> int | None:
        return self.options["times"] or (None if self.options["loop"] else 1)

    async def _loaded(self, robot: Attached) -> ProgramDescribed | None:
        """Return the program as the coordinator describes it; None if it has errors."""
        if self.wanted.loaded is not None:
            assert isinstance(robot, Here)  # a program loaded in this process runs in this process
            return robot.desk.keep(self.wanted.loaded)
        assert self.wanted.load is not None
        made = await robot.ask(self.wanted.load)
        show_findings(findings_of(made.findings))
        return made.program

    async def _way_to_start(self, robot: Attached, program: ProgramDescribed, ending: Ending) -> bool | None:
        """Ask the user whether the robot may move to the program's start, unless the robot is there already.

        Returns:
            True if the robot has to move there first, False if it is there already; None if the run is
            refused.
        """
        options = self.options
        way = await robot.ask(orders.AskWay(program=program.number))
        if not way.text:
            return False
        if not (options["approach"] or program.begins_within or way.zone):
            self._wrong(way.text, "--approach moves there slowly, certified", ending)
            return None
        if way.duration_s is None:
            show_findings(findings_of(way.findings))
            self._wrong(
                way.text, "no slow joint motion to the start is possible: jog the robot there", ending
            )
            return None
        how = how_it_goes(way.title)
        where = joints_text(way.end, robot.welcome.status)
        self.screen.say(f"{way.text}\nan approach takes {way.duration_s:.1f} s, {how} to {where}")
        if way.zone:
            self.screen.say(
                f"the robot is in the start zone {way.zone} of the cell: it moves there without confirmation"
            )
        if options["dry_run"] or way.zone:
            return True
        if not (options["yes"] or await self.terminal.agrees("Move there?")):
            self.screen.say("nothing moved")
            return None
        return True

    async def _has_its_tool(self, program: ProgramDescribed, *, simulated: bool) -> bool:
        """Ask the user whether the flange has the tool that the program needs at its start. Return False only
        if the user denies it.
        """
        if program.tools is None:
            return True
        on = " or ".join(program.tools) or "no tool"
        self.screen.say(f"it begins with {on} on the flange")
        if simulated or self.place.served is not None or self.options["yes"]:
            # a running coordinator knows the mounted tool itself
            return True
        if await self.terminal.agrees("Is that so?"):
            return True
        self.screen.say("nothing moved: change the tool by hand, or begin at another command with --from")
        return False

    async def _show(self, stream: Subscription, picture: Picture, display: Display) -> None:
        async for event in stream:
            picture.hear(event)
            self.terminal.hear(event)
            display.take(event)

    def _told(self, ended: Ended, ending: Ending, log: LogTold | None, status: Status) -> int:
        """Report the end.

        Returns:
            The exit status.
        """
        if log is not None and not log.lost:
            self.screen.say(f"log: {log.path}{', which ends early' if log.problem else ''}")
        if not ended.well:
            if log is not None and log.lost:
                self._wrong(log.problem, log.help, ending)
            for line in ending.lines(ended, status):
                self.screen.say(line)
            if (
                ended.code == "Y1604"
                and self.place.own
                and not (self.options["set"] or self.options["inputs"])
            ):
                self.screen.say(_SETS_INPUTS)
            return 1
        self.screen.close()  # later output goes to standard output
        times = f" {ended.passes} times" if ended.passes > 1 else ""
        where = f"{status.robot} is at the program's end, within one count"
        say(f"{self.wanted.name}: done{times}; {where}", err=False)
        if log is None or not log.problem:
            return 0
        _say_error(log.problem, log.help)
        return 1

    def _wrong(self, what: str, remedy: str, ending: Ending) -> None:
        """Print an error after the remaining output of the screen."""
        self.screen.say(error_text(what, ending.filled(remedy)))
