"""Shortcuts for tests: the pipeline with its usual settings, and the codes of findings."""

import functools

from yarclang.pipeline.stages import Request, check_program, compile_module, plan_module
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse


def source(text, name="test.yarc"):
    return SourceFile(name, text)


def robot_of(robot):
    """Return a robot from itself, its name or its path. Robots of the library are read once."""
    if not isinstance(robot, str):
        return robot
    return _of_library(robot) if robot.isidentifier() else load_robot(robot).value


@functools.cache
def _of_library(name):
    return load_robot(name).value


def checked(text, robot="INDUSTRIAL6", **request):
    parsed = parse(source(text))
    result = check_program(parsed.value, Request(robot_of(robot), **request))
    return result.value, (*parsed.diagnostics, *result.diagnostics)


def planned(text, robot="INDUSTRIAL6", **request):
    parsed = parse(source(text))
    result = plan_module(parsed.value, Request(robot_of(robot), **request))
    return result.value, (*parsed.diagnostics, *result.diagnostics)


def compiled(text, robot="INDUSTRIAL6", **request):
    parsed = parse(source(text))
    result = compile_module(parsed.value, Request(robot_of(robot), **request))
    return result.value, (*parsed.diagnostics, *result.diagnostics)


def codes(diagnostics):
    return [diagnostic.code for diagnostic in diagnostics]
