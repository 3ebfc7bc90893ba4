"""Judgement of a settings text: returns findings and proved bounds from a text and a robot."""

from __future__ import annotations

import numpy as np

from yarclang.certify.kinematics.described import ContradictionError, own_robot
from yarclang.certify.pmac.settings.coupling import Row, coupling_of
from yarclang.certify.pmac.settings.motors import check_motors
from yarclang.certify.pmac.settings.positions import check_definitions, check_feedback
from yarclang.certify.pmac.settings.rates import check_rates
from yarclang.certify.pmac.settings.read import read_settings
from yarclang.certify.pmac.settings.system import check_system
from yarclang.certify.pmac.settings.text import SettingsText
from yarclang.certify.read.text import Unreadable
from yarclang.diagnostics import Collector, Result
from yarclang.frozen import frozen
from yarclang.robot.model import Array, Robot
from yarclang.source import SourceFile, Span


@frozen(eq=False)
class ProvedSettings:
    """Proved settings of a controller, on which certificates can rely.

    Attributes:
        text: the settings text.
        content: the definitions and values in the text.
        commanded: (n,) largest error of the axis definitions within the limits of the joints [axis units].
        feedback: (n,) largest error of the positions from PLC 0 within the limits of the joints [axis units].
    """

    text: str
    content: SettingsText
    commanded: Array
    feedback: Array


def certify_settings(source: SourceFile, robot: Robot) -> Result[ProvedSettings]:
    """Prove that a settings text configures a controller as the certificates of a robot's programs assume.

    Args:
        source: the settings text, with the file name that findings use.
        robot: the robot of the controller.

    Returns:
        The proved settings; None, with findings, if the text cannot be read or is wrong.
    """
    findings = Collector(source)

    def say(code: str, line: int, message: str) -> None:
        span = Span.on_line(line, 1, max(2, len(source.line(line)) + 1))
        findings.add(code, message, span, f"download what `yarc settings {robot.name}` prints")

    try:
        robot = own_robot(robot)
    except ContradictionError as error:
        say("Y1194", 1, f"{robot.name} isn't what its files describe: {error}")
        return Result(None, tuple(findings.found))
    content = read_settings(source.text, robot)
    if isinstance(content, Unreadable):
        say(content.code, content.line, f"line {content.line} {content.reason}")
        return Result(None, tuple(findings.found))
    coupling = coupling_of(robot)
    if coupling is None:
        say("Y1172", content.definitions[0].line, f"K J of {robot.name} can't be inverted")
        return Result(None, tuple(findings.found))
    commanded = check_definitions(content, robot, coupling, say)
    feedback = check_feedback(content, robot, coupling, say, as_printed=commanded is not None)
    check_motors(content, robot, coupling, say)
    check_rates(content, robot, coupling, say)
    check_system(content, robot, say)
    if findings.has_errors or commanded is None or feedback is None:
        return Result(None, tuple(findings.found))
    return Result(ProvedSettings(source.text, content, _floats(commanded), _floats(feedback)))


def _floats(values: Row) -> Array:
    array = np.array([float(value) for value in values], dtype=np.float64)
    array.setflags(write=False)
    return array
