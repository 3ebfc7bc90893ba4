"""Jogging."""

from __future__ import annotations

from yarclang.repl.dot import DotCommand
from yarclang.repl.interpreter import Interpreter
from yarclang.repl.jogging import Jogging, axis_of, jog


async def _jog(interpreter: Interpreter, rest: str) -> None:
    robot = interpreter.robot
    axis, sign, moving = axis_of(robot, rest.split())
    if not interpreter.has_keys:
        interpreter.refuse("a jog is hold-to-run: it needs a terminal with keys")
        return
    await interpreter.own()
    jogging = Jogging(robot, axis, sign, moving)
    interpreter.jogging = jogging
    try:
        await jog(interpreter, jogging)
    finally:
        interpreter.jogging = None


COMMANDS = (
    DotCommand(
        ".jog",
        "J3 [+|-] | {TCP} [+x|-x|+a|...] [tool]",
        "move while a key is held",
        "motions",
        _jog,
        doc="+ and - (or the arrows, or the space bar) move while they are held; a number chooses a joint, x y z a b c an axis of the tool, t the tool's axes or those of {B};\n"
        "up and down change the speed, Enter ends. The tool keeps below 250 mm/s, or what the robot says in [jog] of its robot.toml; limits, cell and zones are kept, and near a singularity it gets slower.",
    ),
)
