"""Show the robot's position, frames, signals and messages."""

from __future__ import annotations

import numpy as np

from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import findings_of
from yarclang.hir import Output
from yarclang.repl.answers import joints_text, where_text
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.session import Session
from yarclang.report.pose_text import pose_text
from yarclang.semantics.names.scope import Input

_SHOWN = 20
"""Number of messages that `.log` shows."""


async def _where(session: Session, rest: str) -> None:
    frames = [f"{{{word.strip('{}').upper()}}}" for word in rest.split()]
    if len(frames) > 2:
        raise Misused("at most two frames")
    base, moving = (*frames, *("{B}", "{TCP}")[len(frames) :])
    found = await session.attached.ask(orders.AskPlace(base=base, moving=moving))
    session.show(findings_of(found.findings))
    if found.pose is not None:
        session.say(where_text(moving, np.array(found.pose), base))


async def _joints(session: Session, rest: str) -> None:  # noqa: ARG001 - the command has no arguments
    session.say(joints_text(session.robot, await session.stands()))


def _frames(session: Session, rest: str) -> None:  # noqa: ARG001
    scope = session.scope()
    rows = []
    for name in scope.frame_names():
        frame = scope.frame(name)
        assert frame is not None  # the scope has listed this name
        parent = "FLANGE" if frame.on_flange else "B"
        if name != parent:
            rows.append((f"{{{name}}}", f"{pose_text(np.asarray(frame.transform))} in {{{parent}}}"))
    width = max((len(name) for name, _ in rows), default=0)
    session.say("\n".join(f"{name:{width}}  {text}" for name, text in rows) or "only {B} and {FLANGE}")


async def _io(session: Session, rest: str) -> None:  # noqa: ARG001
    scope = session.scope()
    signals = [(name, "input") for name in sorted(set(scope.names(Input)))]
    signals += [(name, "output") for name in sorted(set(scope.names(Output)))]
    if not signals:
        session.say("no INPUT and no OUTPUT is declared; for example: INPUT DOOR M11")
    for name, kind in signals:
        value = await session.attached.ask(orders.Read(name=name))
        session.show(findings_of(value.findings))
        if value.value is not None:
            session.say(f"{name}  {kind}  {value.value:g}")


async def _log(session: Session, rest: str) -> None:
    if rest and not rest.isdigit():
        raise Misused(f"{rest!r} isn't a number of messages")
    status = await session.attached.ask(orders.AskStatus())
    told = list(session.messages)[-int(rest or _SHOWN) :]
    if status.log is None:
        place = "nothing is logged yet"
    else:
        lost = status.log_lost
        place = (
            f"the run log can't be used any more: {status.log} {lost}" if lost else f"the log is {status.log}"
        )
    session.say("\n".join([*told, place]))


COMMANDS = (
    DotCommand(
        ".where", "[FRAME [MOVING]]", "the pose of the tool, in {B} or another frame", "looking", _where
    ),
    DotCommand(".joints", "", "the joint positions", "looking", _joints),
    DotCommand(".frames", "", "all known frames", "looking", _frames),
    DotCommand(".io", "", "all declared inputs and outputs, with their values", "looking", _io),
    DotCommand(
        ".log", "[NUMBER]", "the last messages, and the path of the run log", "looking", _log, overtakes=True
    ),
)
