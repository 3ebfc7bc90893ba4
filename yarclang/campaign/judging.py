"""Drawing, compiling and checking of random programs."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path
from time import process_time

import numpy as np

from yarclang.campaign.chains import drawn_chain
from yarclang.campaign.drawing import Drawn, drawn, features
from yarclang.campaign.pieces import Piece
from yarclang.campaign.rules import drawn_ruled
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.independent.arm import Arm
from yarclang.independent.judging import judge
from yarclang.internal_errors import internal_error
from yarclang.memory import NO_MEMORY
from yarclang.pipeline.cells import cell_loader
from yarclang.pipeline.project import Project
from yarclang.pipeline.sources import NO_TEXTS
from yarclang.pipeline.stages import Compiled, Request, compile_module
from yarclang.robot.description import load_robot
from yarclang.robot.model import Robot
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

MOST = 6
"""Largest number of motions that are drawn for a program that isn't a chain."""

CHAINS = 20
"""Number of programs of which one is a chain of short motions."""

RULED = 10
"""Number of programs of which one has motions that must keep to rules (KEEP) and may avoid obstacles."""

CERTIFICATE = "11"
"""Prefix of the codes of findings of the certificate. A text that the compiler has written must never get
such a finding.
"""


@frozen
class Task:
    """Robots and cell for which random programs are drawn.

    Attributes:
        robots: names or paths of the robots.
        cell: path of a cell.toml; None if there is none.
    """

    robots: tuple[str, ...]
    cell: str | None = None

    def robot_of(self, seed: int) -> str:
        """Return the robot for which the program of a seed is drawn."""
        return self.robots[seed % len(self.robots)]


@frozen
class Program:
    """A random program, and the result of its check.

    Attributes:
        seed: seed of the program.
        robot: name or path of its robot.
        text: text of the program.
        refused: code of the first error if the program doesn't compile; empty if it compiles.
        faults: faults of the compiled text, as sentences.
        worst: by name, the largest used fractions of tolerances and limits, as in
            `independent.judging.Judgement`.
        duration: time of all motions [s].
        features: for each motion, the names under which it is counted.
    """

    seed: int
    robot: str
    text: str
    refused: str
    faults: tuple[str, ...]
    worst: dict[str, float]
    duration: float
    features: tuple[tuple[str, ...], ...]


def judged_chunk(chunk: tuple[int, int], task: Task) -> Piece:
    """Draw and check the programs of a chunk, given by its first seed and the number of programs. Return the
    sum of their results.
    """
    first, count = chunk
    begin = process_time()
    piece = Piece(first, count)
    robots = {name: _robot(name) for name in task.robots}
    for seed in range(first, first + count):
        one = judged_program(seed, task, robots[task.robot_of(seed)])
        piece.add(seed, one.robot, one.refused, one.faults, one.worst, one.duration, one.features)
    piece.seconds = process_time() - begin
    return piece


def _robot(name: str) -> Robot:
    robot = load_robot(name).value
    assert robot is not None  # it was read when the campaign began
    return robot


def judged_program(seed: int, task: Task, robot: Robot | None = None) -> Program:
    """Draw and check the program of a seed. Its robot is read if it isn't given."""
    name = task.robot_of(seed)
    robot = robot or _robot(name)
    arm = arm_of(robot)
    random = np.random.default_rng(seed)
    # The robots alternate from seed to seed. Chains are counted in rounds of all robots, so that each robot
    # gets chains.
    is_chain = seed // len(task.robots) % CHAINS == CHAINS - 1
    is_ruled = seed // len(task.robots) % RULED == RULED - 2 and len(arm.lower) >= 6
    if is_ruled:
        program = drawn_ruled(arm, random)
    else:
        program = drawn_chain(arm, random) if is_chain else drawn(arm, random, MOST)
    refused, faults, worst, duration = _judged(program, seed, robot, arm, task.cell)
    said = tuple(names for _, names in features(program))
    return Program(seed, name, program.text, refused, faults, worst, duration, said)


def arm_of(robot: Robot) -> Arm:
    """Return the arm of a robot, which the independent check reads from the robot's files.

    Raises:
        ValueError: the robot's files lack something that the check needs.
    """
    if robot.written is None:
        raise ValueError("its files aren't known")
    return _arm(robot.written.toml, robot.written.urdf)


@lru_cache(maxsize=16)
def _arm(description: str, urdf: str) -> Arm:
    try:
        arm = Arm(description, urdf)
        if len(arm.data["positions"]["HOME"]) != len(arm.lower):
            raise ValueError("HOME has another number of joints")
    except KeyError as error:
        raise ValueError(f"it says no {error.args[0]}") from None
    return arm


def _judged(
    program: Drawn, seed: int, robot: Robot, arm: Arm, cell: str | None
) -> tuple[str, tuple[str, ...], dict[str, float], float]:
    """Compile and check a program. Return the code of its first error, the faults, the largest used fractions
    of tolerances and limits, and the duration [s].
    """
    source = SourceFile(f"seed-{seed}.yarc", program.text)
    try:
        made = _compiled(source, robot, cell)
    except Exception as error:  # a bug in yarclang, which the campaign looks for
        return "", (internal_error(error, source).message,), {}, 0.0
    errors = [one for one in made.diagnostics if one.is_error]
    faults = [f"{one.code}: {one.message}" for one in errors if one.family == CERTIFICATE]
    if made.value is None:
        if not errors:
            faults.append("it isn't compiled, but there is no error")
        return ("" if faults else errors[0].code), tuple(faults), {}, 0.0
    faults += [f"compiled in spite of {one.code}: {one.message}" for one in errors]
    chosen = {motion.step: motion.waypoints for motion in made.value.plan.motions}
    try:
        found = judge(arm, program.said, made.value.text, chosen, told_by_step(made.diagnostics))
    except Exception as error:  # the text can't be read
        fault = f"the text can't be judged: {type(error).__name__}: {error}"
        return "", (*faults, fault), {}, 0.0
    return "", (*faults, *found.faults), found.worst, found.duration


def _compiled(source: SourceFile, robot: Robot, cell: str | None) -> Result[Compiled]:
    parsed = parse(source)
    assert parsed.value is not None  # parsing always gives a tree
    given = None
    loader = cell_loader(Path(), robot, NO_TEXTS, NO_MEMORY)
    if cell is not None:
        given = loader.given(Project(Path()), cell).value
    made = compile_module(parsed.value, Request(robot, load_cell=loader, cell=given))
    return Result(made.value, (*parsed.diagnostics, *made.diagnostics))


def told_by_step(diagnostics: Iterable[Diagnostic]) -> dict[int, set[str]]:
    """Return the codes of findings by the steps of the commands that they concern. The step follows from the
    index at the start of the finding's source line, such as P0030.
    """
    told: dict[int, set[str]] = {}
    for one in diagnostics:
        if one.span is None or one.source is None:
            continue
        index = re.match(r"P(\d+) ", one.source.line(one.span.line))
        if index:
            told.setdefault(max(int(index[1]) // 10 - 1, 0), set()).add(one.code)
    return told
