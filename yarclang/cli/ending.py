"""Texts about the end of a run: the reason, the place in the program, the command, and how to continue."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Iterator

import click

from yarclang.cli.faults import fault_text
from yarclang.coordinator.messages.message import Joints
from yarclang.coordinator.messages.replies import Ended, ProgramDescribed, Status
from yarclang.runtime.state import State


def say(text: str, *, err: bool = True) -> None:
    """Print a text. If the terminal was closed, do nothing, so that this doesn't change how a run ends."""
    with contextlib.suppress(OSError):
        click.echo(text, err=err)


def error_text(what: str, remedy: str) -> str:
    """Format an error that isn't a finding."""
    text = click.style("error", fg="red", bold=True) + f": {what}"
    return f"{text}\n  help: {remedy}" if remedy else text


def joints_text(joints: Joints, status: Status) -> str:
    """Format joint positions in deg or mm: `J1 10.000 deg, ...`."""
    return ", ".join(f"{one.name} {joints[one.name]:.3f} {one.unit}" for one in status.joints)


class Ending:
    """Texts about the end of a program's run.

    Args:
        name: name of the program.
        where: options for the controller and the robot, for recommended commands.
        again: the command line without --from, for continuing; empty or None if there is none.
        program: the program that was run; None if it wasn't loaded.
    """

    def __init__(
        self, name: str, where: str, again: str | None, program: ProgramDescribed | None = None
    ) -> None:
        self._name = name
        self._where = where
        self._again = again
        self._program = program

    def lines(self, ended: Ended, status: Status, option: str = "") -> Iterator[str]:
        """Yield the lines about a run that didn't end well.

        Args:
            ended: the end.
            status: status of the robot before the end.
            option: option with which the next run first moves the robot to its start; empty for the usual
                option.
        """
        what, remedy = self.filled(ended.what or ""), self.filled(ended.help or "")
        if ended.state is State.STOP and not ended.code:
            yield f"{self._name}: {what}"
        elif ended.where is not None:
            yield fault_text(ended.code or "", what, remedy, ended.where)
        else:
            yield error_text(what, remedy)
        if ended.joints is None and ended.moved:
            yield "  its position is unknown: inspect the robot"
        elif ended.joints is not None:
            yield f"  {status.robot} is at {joints_text(ended.joints, status)}"
        if not ended.moved:
            yield "  nothing had moved"
        elif ended.on_the_way:
            yield "  it was on its way to the start"
            yield from self.going_on(option or self._first_option)
        elif ended.command:
            yield from self._in_command(ended)

    def filled(self, text: str) -> str:
        """Return a text in which recommended commands name this controller and robot, so that users can
        copy them.
        """
        text = text.replace("`yarc stop --to ...`", f"`yarc stop {self._where}`")
        return text.replace("`yarc doctor`", f"`yarc doctor {self._where}`")

    def _in_command(self, ended: Ended) -> Iterator[str]:
        """Yield lines about the command that was being executed, and how to continue the program with this
        command.
        """
        option = f"--from {shlex.quote(ended.go_on)}" if ended.go_on else ""
        if not ended.is_motion:
            yield f"  it was at {ended.command}"
        elif ended.resting is not None:
            yield f"  on its path, in {ended.resting.title}, {ended.resting.done_s:.2f} s into the program"
        else:
            yield f"  it was executing {ended.command}, {ended.done_s:.1f} s into the program"
        if ended.go_on is not None:
            yield from self.going_on(option)

    def going_on(self, option: str) -> Iterator[str]:
        """Yield the command line for continuing, if there is one."""
        if self._again:
            yield f"  to continue: {self._again} {option}".rstrip()

    @property
    def _first_option(self) -> str:
        """Return the option that moves the robot, before the next run, to the place where this run began:
        `--from` with the first executed command if the run began in the middle of the program, else
        `--approach`.
        """
        program = self._program
        within = program is not None and program.begins_within and program.first
        return f"--from {shlex.quote(program.first)}" if program is not None and within else "--approach"
