"""Stages of programs, made as `yarc view` makes them."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from yarclang.pipeline.inputs import Options
from yarclang.source import SourceFile
from yarclang.view.opening import program_stage
from yarclang.view.stage import Stage

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

CRASH = """\
ROBOT INDUSTRIAL6
CELL "cell.toml"
DEFAULT {GRIPPER} [50%] (mm,deg,s) {FIXTURE}
FRAME {PART} 0 0 100 0 0 0
START READY
P0010 MOVEJ_RPY -200 0 150 0 0 0
P0020 MOVEL -200 0 -60 0 0 0 [2]
P0030 MOVEL -200 0 -260 0 0 0 [2]
P0040 WAIT [1]
P0050 MOVEL -200 0 150 0 0 0 [5] {PART}
"""
"""A program in which the gripper's fingers collide with the bench."""


@cache
def stage_of(text: str, robot: str | None = None) -> Stage:
    """Return the stage of a program that is in the folder of the examples."""
    result = program_stage(SourceFile("made.yarc", text), EXAMPLES, Options(robot=robot))
    assert result.value is not None, result.diagnostics
    return result.value
