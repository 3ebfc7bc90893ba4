"""Where the robot stands, what there is, what was told."""

from __future__ import annotations

import numpy as np

from yarclang.hir import Output
from yarclang.repl.answers import joints_text, where_text
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.interpreter import Interpreter
from yarclang.report.pose_text import pose_text
from yarclang.semantics.scope import Input

_SHOWN = 20
"""Messages that `.log` shows."""


async def _where(interpreter: Interpreter, rest: str) -> None:
    frames = [f"{{{word.strip('{}').upper()}}}" for word in rest.split()]
    if len(frames) > 2:
        raise Misused("at most two frames")
    base, moving = (*frames, *("{B}", "{TCP}")[len(frames) :])
    found = await interpreter.client.where(base, moving)
    interpreter.show(found.diagnostics)
    if found.value is not None:
        interpreter.say(where_text(moving, found.value.base_from_moving, base))


async def _joints(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001 - it takes nothing
    interpreter.say(joints_text(interpreter.coordinator.robot, await interpreter.coordinator.stands()))


def _frames(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001
    scope = interpreter.scope()
    rows = []
    for name in scope.frame_names():
        frame = scope.frame(name)
        assert frame is not None  # its name was just told
        parent = "FLANGE" if frame.on_flange else "B"
        if name != parent:
            rows.append((f"{{{name}}}", f"{pose_text(np.asarray(frame.transform))} in {{{parent}}}"))
    width = max((len(name) for name, _ in rows), default=0)
    interpreter.say("\n".join(f"{name:{width}}  {text}" for name, text in rows) or "only {B} and {FLANGE}")


async def _io(interpreter: Interpreter, rest: str) -> None:  # noqa: ARG001
    scope = interpreter.scope()
    signals = [(name, "input") for name in sorted(set(scope.names(Input)))]
    signals += [(name, "output") for name in sorted(set(scope.names(Output)))]
    if not signals:
        interpreter.say("no INPUT and no OUTPUT is declared; for example: INPUT DOOR M11")
    for name, kind in signals:
        value = await interpreter.client.read(name)
        interpreter.show(value.diagnostics)
        if value.value is not None:
            interpreter.say(f"{name}  {kind}  {value.value:g}")


def _log(interpreter: Interpreter, rest: str) -> None:
    if rest and not rest.isdigit():
        raise Misused(f"{rest!r} isn't a number of messages")
    run_log = interpreter.coordinator.engine.run_log
    told = list(interpreter.messages)[-int(rest or _SHOWN) :]
    if run_log is None:
        place = "nothing is logged yet"
    else:
        lost = run_log.lost()
        place = f"the log is lost: {run_log.path} {lost}" if lost else f"the log is {run_log.path}"
    interpreter.say("\n".join([*told, place]))


COMMANDS = (
    DotCommand(
        ".where", "[FRAME [MOVING]]", "the pose of the tool, in {B} or another frame", "looking", _where
    ),
    DotCommand(".joints", "", "the joint positions", "looking", _joints),
    DotCommand(".frames", "", "all frames that are known", "looking", _frames),
    DotCommand(".io", "", "the inputs and outputs that are declared, with their values", "looking", _io),
    DotCommand(
        ".log", "[NUMBER]", "the last messages, and where the run log is", "looking", _log, overtakes=True
    ),
)
