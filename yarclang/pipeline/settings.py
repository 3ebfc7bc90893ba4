"""Write and verify a robot's controller settings, and list the settings that the runtime checks before
the robot moves. Both use the same verified text.
"""

from __future__ import annotations

from dataclasses import replace

from yarclang.backend import backend_of
from yarclang.diagnostics import Result
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Trouble
from yarclang.runtime.inspection import Item
from yarclang.source import SourceFile


def settings_of(robot: Robot) -> Result[str]:
    """Write the settings text of a robot's controller, and verify it.

    Returns:
        The text; None, with findings, if not all of it is proved.
    """
    settings = backend_of(robot).settings()
    text = settings.text(robot)
    judged = settings.judge(SourceFile(f"yarc settings {robot.name}", text), robot)
    remedy = "correct robot.toml; if its values are right, this is a fault of yarclang: report it"
    told = tuple(replace(one, help=remedy) for one in judged.diagnostics)
    return Result(None if judged.value is None else text, told)


def proved_settings(robot: Robot) -> str:
    """Return the settings text of a robot's controller, exactly as it was proved.

    Raises:
        Trouble: not all of it is proved.
    """
    judged = settings_of(robot)
    if judged.value is None:
        first = judged.diagnostics[0]
        what = f"the settings of {robot.name} aren't proved: {first.message}"
        raise Trouble(what, f"`yarc settings {robot.name}` shows all that is wrong", first.code)
    return judged.value


def check_settings(source: SourceFile, robot: Robot) -> Result[tuple[str, ...]]:
    """Verify a settings text that was saved or edited, and report how it differs from the output of `yarc
    settings`.

    Args:
        source: the text, with one character per byte.
        robot: robot whose controller it is for.

    Returns:
        Descriptions of what was proved, with a warning for each difference; None, with the errors, if not all
        of it is proved.
    """
    settings = backend_of(robot).settings()
    judged, own = settings.judge(source, robot), settings_of(robot)
    if judged.value is None or own.value is None:
        return replace(judged, diagnostics=judged.diagnostics or own.diagnostics)
    return replace(judged, diagnostics=settings.differences(source, robot))


def items_of(robot: Robot) -> tuple[Item, ...]:
    """List the settings that a robot's controller must have: for each permanent setting that `yarc settings`
    writes, the query and the answer that the controller must give.

    Raises:
        Trouble: the settings aren't proved.
    """
    proved_settings(robot)
    return backend_of(robot).settings().items(robot)
