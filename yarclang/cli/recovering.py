"""Implement `yarc run --recover`: move the robot from its position to the start of a program, or to the
nearest place at which the program may begin.
"""

from __future__ import annotations

import asyncio
import shlex
from typing import Any

from yarclang.cli.display import Axes, Display
from yarclang.cli.ending import Ending, error_text, joints_text, say
from yarclang.cli.screen import Screen
from yarclang.cli.show import show_findings
from yarclang.cli.terminal import Terminal
from yarclang.coordinator.attached import Attached
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import findings_of
from yarclang.coordinator.messages.replies import OfferDescribed, ProgramDescribed, Recovery
from yarclang.coordinator.picture import Picture
from yarclang.coordinator.subscription import Subscription
from yarclang.runtime.actions import Trouble

_LAST_WORDS = 5.0
"""Longest wait for pending events after the end [s]."""

_HOW = {"MOVEJ": "all joints straight", "MOVEL": "along the line of the program, from the robot's position"}
"""Descriptions of slow motions, by the command's name without its profile (`MOVEJ` for MOVEJ_POLY5)."""


def how_it_goes(title: str) -> str:
    """Describe a slow motion to a program's start (straight or around obstacles), given the title of its
    command.
    """
    return _HOW.get(title.rsplit(maxsplit=1)[-1].rpartition("_")[0], "round what is in the way")


async def recover(
    robot: Attached,
    program: ProgramDescribed,
    picture: Picture,
    terminal: Terminal,
    screen: Screen,
    ending: Ending,
    options: dict[str, Any],
) -> int:
    """Show the motions to a program's start, ask the user, and carry them out. The program itself isn't run.

    Args:
        robot: client that owns the robot.
        program: the program, which is loaded.
        picture: state of the robot.
        terminal: terminal for questions and keys.
        screen: screen for output.
        ending: texts about the end.
        options: options of the command line.

    Returns:
        The exit status.
    """
    status = robot.welcome.status
    way = await robot.ask(orders.OfferRecovery(program=program.number))
    if way.place is None:
        show_findings(findings_of(way.findings))
        screen.say("nothing moved")
        return 1
    show_findings(findings_of(way.refused))
    if way.offer is None:
        screen.close()
        say(f"{status.robot} is at {_place(way, program)} already; nothing moved", err=False)
        _say_next(way, ending)
        return 0
    screen.say(_told(way, way.offer, program, joints_text(way.offer.end, status)))
    if options["dry_run"]:
        screen.say("nothing moved (--dry-run)")
        return 0
    if not (options["yes"] or await terminal.agrees("Move there?")):
        screen.say("nothing moved")
        return 1
    return await _go(robot, program, way, way.offer, picture, terminal, screen, ending)


async def _go(
    robot: Attached,
    program: ProgramDescribed,
    way: Recovery,
    offer: OfferDescribed,
    picture: Picture,
    terminal: Terminal,
    screen: Screen,
    ending: Ending,
) -> int:
    status = robot.welcome.status
    shown = program.model_copy(update={"commands": (), "duration_s": offer.duration_s, "takes": offer.takes})
    display = Display(screen, picture, Axes.of(status), shown)
    with await robot.listen() as stream:
        showing = asyncio.create_task(_show(stream, picture, display, terminal))
        try:
            terminal.performing = True
            ended = await robot.ask(orders.Go(offer=offer.number))
        except Trouble as trouble:
            screen.say(error_text(trouble.what, ending.filled(trouble.remedy)))
            return 1
        finally:
            terminal.performing = False
            stream.close()
            await asyncio.wait((showing,), timeout=_LAST_WORDS)
    log = (await robot.ask(orders.Release())).log
    if log is not None and not log.lost:
        screen.say(f"log: {log.path}{', which ends early' if log.problem else ''}")
    if log is not None and log.problem:
        screen.say(error_text(log.problem, log.help))
    if not ended.well:
        # the robot stopped before it reached the program: advise to use --recover again
        for line in ending.lines(ended.model_copy(update={"on_the_way": True}), status, "--recover"):
            screen.say(line)
        return 1
    screen.close()
    say(f"{status.robot} is at {_place(way, program)}, within one count", err=False)
    _say_next(way, ending)
    return int(log is not None and bool(log.problem))


async def _show(stream: Subscription, picture: Picture, display: Display, terminal: Terminal) -> None:
    async for event in stream:
        picture.hear(event)
        terminal.hear(event)
        display.take(event)


def _told(way: Recovery, offer: OfferDescribed, program: ProgramDescribed, where: str) -> str:
    """Return the text about the motions that is shown before the user is asked."""
    how = how_it_goes(offer.motions[0].title)
    lines = [
        (
            f"recovery: to {_place(way, program)}, {offer.duration_s:.1f} s at {100.0 * way.share:g} % of "
            f"the joints' limits, {how}, to {where}"
        ),
    ]
    if way.assumed:
        names = ", ".join(way.assumed[:8]) + (", ..." if len(way.assumed) > 8 else "")
        lines.append(
            f"the place of {names} is unknown: assumed to be where {program.name} has them at {way.title}"
        )
    clearances = [one.clearance for one in offer.motions if one.clearance is not None]
    if clearances:
        near = min(clearances, key=lambda one: one.distance_mm)
        least = f"at least {near.distance_mm:.1f} mm"
        named = f"{near.first} stays {least} away from {near.second}"
        lines.append(f"proved: {named if near.first else f'all bodies stay {least} apart'}")
    return "\n".join(lines)


def _place(way: Recovery, program: ProgramDescribed) -> str:
    line = f" (line {way.line})" if way.line else ""
    return f"{way.title}{line} of {program.name}"


def _say_next(way: Recovery, ending: Ending) -> None:
    option = f"--from {shlex.quote(way.place)}" if way.place else ""
    for line in ending.going_on(option):
        say(line)
