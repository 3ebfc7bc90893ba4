"""How a run has ended, in words: why, where, in which command, and how to go on."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from dataclasses import replace

import click

from yarclang.cli.faults import fault_text, where_of
from yarclang.cli.resting import Resting, motion_before, resting_place
from yarclang.coordinator.programs import Loaded
from yarclang.pipeline.parts import chain_place
from yarclang.runtime.outcome import Concerned, Ended
from yarclang.runtime.rest import described
from yarclang.runtime.state import State


def error_text(what: str, remedy: str) -> str:
    """An error that is no finding."""
    text = click.style("error", fg="red", bold=True) + f": {what}"
    return f"{text}\n  help: {remedy}" if remedy else text


class Ending:
    """Knows what was run, and where it may be looked up.

    Args:
        loaded: what was run.
        where: options that name the controller and the robot, for commands that are recommended.
        again: the command line without --from, for whoever wants to go on; empty or None: there is none.
    """

    def __init__(self, loaded: Loaded, where: str, again: str | None) -> None:
        self._loaded = loaded
        self._where = where
        self._again = again
        self._resting: Resting | None = None

    def placed(self, ended: Ended) -> Ended:
        """With the place in the source of the command that a fault is about. What was heard last of a robot that rests on its path
        may be old: it is looked up there.
        """
        plan, program, concerned = self._loaded.plan, self._loaded.program, ended.concerns
        executed = ended.command in {command.title for command in program.commands}
        if plan is not None and ended.joints is not None and executed:
            self._resting = resting_place(plan, program, ended.joints, ended.done)
        if concerned is None:
            return ended
        if self._resting is not None and concerned.index == ended.command_index:
            there = self._resting.command
            concerned = Concerned(there.index, there.name, there.source_line)
        return replace(ended, concerns=concerned, where=where_of(self._loaded.origins(), concerned))

    def lines(self, ended: Ended, state: State, *, moved: bool, on_the_way: bool) -> Iterator[str]:
        """What is said of an end that isn't well.

        Args:
            ended: as `placed` gives it.
            state: of the run.
            moved: whether anything has moved.
            on_the_way: whether it was on its way to the program's start.
        """
        program = self._loaded.program
        what, remedy = self.filled(ended.what), self.filled(ended.remedy)
        if state is State.STOP:
            yield f"{program.name}: {what}"
        elif ended.where is not None:
            yield fault_text(ended.code, what, remedy, ended.where)
        else:
            yield error_text(what, remedy)
        if ended.joints is None:
            yield "  where it stands isn't known: look at the robot"
        else:
            yield f"  {program.robot.name} stands at {described(program.robot, ended.joints)}"
        if not moved:
            yield "  nothing had moved"
        elif on_the_way:
            yield "  it was on its way to the start"
            yield from self._going_on(self._first_option)
        elif ended.command:
            yield from self._in_command(ended)

    def filled(self, text: str) -> str:
        """Commands that a text recommends, with this controller and robot, so that they can be copied."""
        text = text.replace("`yarc stop --to ...`", f"`yarc stop {self._where}`")
        return text.replace("`yarc doctor`", f"`yarc doctor {self._where}`")

    def _in_command(self, ended: Ended) -> Iterator[str]:
        """Which command was executed, and how to go on with it."""
        plan, index, found = self._loaded.plan, ended.command_index, self._resting
        if ended.command not in {command.title for command in self._loaded.program.commands}:
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
        if self._again:
            yield f"  to go on: {self._again} {option}".rstrip()

    @property
    def _first_option(self) -> str:
        """What was given for the way to the start."""
        first = self._loaded.rest.commands[:1]
        return (
            f"--from {shlex.quote(first[0].index)}" if self._loaded.begins_within and first else "--approach"
        )
