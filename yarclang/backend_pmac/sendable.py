"""The lines of a text for a Turbo PMAC that can be streamed."""

from __future__ import annotations

from yarclang.backend import Sendable
from yarclang.certify.pmac.own import own_of
from yarclang.certify.read.text import ControllerText
from yarclang.diagnostics import Diagnostic
from yarclang.robot.model import Robot
from yarclang.runtime.pmac.loading import Loading, capacity_of


def sendable(content: ControllerText, robot: Robot) -> Sendable | Diagnostic:
    """Return the lines of a text that go into the rotary buffer, or a finding if the text is for a program
    buffer.
    """
    own = own_of(content)
    if own.marks is None or content.start.printed is None:
        message = "this text is for a program buffer, which isn't streamed"
        help_ = "compile it without --target prog; a program buffer is downloaded and run by hand"
        return Diagnostic("Y1162", message, help=help_)
    return Sendable(
        lines=tuple(numbered for sent in own.loaded for numbered in sent.numbered()),
        guarded=tuple(one.line for one in own.arms if one.on),
        capacity=capacity_of(robot, own.marks.words),
        own=Loading(own.setup, own.marks.words, own.marks.low, own.marks.full),
    )
