"""Jog the robot: the command, and the loop that sends the wanted motion."""

from __future__ import annotations

import asyncio

from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.events import Finished
from yarclang.repl.dot import DotCommand
from yarclang.repl.jogging import Jogging, axis_of
from yarclang.repl.session import Session
from yarclang.runtime.actions import Trouble

EACH = 0.05
"""Time between two messages with the wanted motion [s]. It is shorter than the timeout of the robot's
watchdog.
"""

_LOOKED_EACH = 0.005
"""Time between two checks if the live motion has ended [s]."""


async def _jog(session: Session, rest: str) -> None:
    robot = session.robot
    axis, sign, moving = axis_of(robot, rest.split())
    if not session.has_keys:
        session.refuse("a jog is hold-to-run: it needs a terminal with keys")
        return
    await session.own()
    jogging = Jogging(robot, axis, sign, moving)
    session.jogging = jogging
    try:
        await _moved(session, jogging)
    finally:
        session.jogging = None


async def _moved(session: Session, jogging: Jogging) -> None:
    """Jog: move the robot while keys are pressed, until the user or an event ends the jog.

    When a key is released, the robot stops at once, without the delay of the controller's buffer.
    """
    loop = asyncio.get_running_loop()
    robot = session.attached
    moving = False
    while not jogging.ended:
        now = loop.time()
        if moving and session.ended_live is not None:
            session.over(session.ended_live)
            return
        if not jogging.moves(now):
            if moving:
                await _at_rest(session)
                moving = False
        elif moving:
            try:
                await robot.ask(jogging.want(now))
            except Trouble:
                session.over(await _ended(session))
                return
        else:
            session.ended_live = None
            await robot.ask(orders.Steer(moving=jogging.moving, again=False, title="jog"))
            try:
                await robot.ask(jogging.want(now))
                moving = True
            except Trouble as trouble:
                session.refuse(trouble.what + (f"\n  help: {trouble.remedy}" if trouble.remedy else ""))
        await asyncio.sleep(EACH)
    if moving:
        await _at_rest(session)


async def _at_rest(session: Session) -> None:
    session.order(orders.Leave())
    await _ended(session)


async def _ended(session: Session) -> Finished:
    """Wait for the end of the live motion, and return its result."""
    while session.ended_live is None:
        await asyncio.sleep(_LOOKED_EACH)
    return session.ended_live


COMMANDS = (
    DotCommand(
        ".jog",
        "J3 [+|-] | {TCP} [+x|-x|+a|...] [tool]",
        "move while a key is held",
        "motions",
        _jog,
        doc="+ and - (or the arrows, or the space bar) move while they are held; a number chooses a "
        "joint, x y z a b c an axis of the tool, t the tool's axes or those of {B};\nup and down "
        "change the speed, Enter ends. The tool stays below 250 mm/s, or below the speed in [jog] of "
        "robot.toml. Limits, cell and zones are observed, and near a singularity the tool slows down.",
    ),
)
