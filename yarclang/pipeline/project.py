"""yarc.toml: what stands for options that are left out."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from yarclang.diagnostics import Diagnostic, Result, suggest
from yarclang.pipeline.sources import read_source
from yarclang.source import SourceFile, Span
from yarclang.toml.places import find_places

FILE_NAME = "yarc.toml"
_KEYS = ("robot", "start")


@dataclass(frozen=True, slots=True)
class Project:
    """The settings of a yarc.toml: a robot's name or path (relative to `folder`), and where the
    robot stands [deg, mm for prismatic joints].
    """

    folder: Path
    robot: str | None = None
    start: tuple[float, ...] | None = None
    source: SourceFile | None = None

    def span_of(self, key: str) -> Span | None:
        """Where a key's value stands in the file."""
        return find_places(self.source).of_value((key,)) if self.source else None


def find_project(folder: Path) -> Result[Project]:
    """The yarc.toml of a folder, or of the nearest one above it; empty settings where there is none."""
    folder = folder.resolve()
    for candidate in (folder, *folder.parents):
        if (candidate / FILE_NAME).is_file():
            return _read(candidate / FILE_NAME)
    return Result(Project(folder))


def _read(path: Path) -> Result[Project]:
    opened = read_source(str(path))
    if opened.value is None:
        return Result(None, opened.diagnostics)
    source = opened.value
    try:
        data = tomllib.loads(source.text)
    except tomllib.TOMLDecodeError as error:
        span = Span.on_line(_line_of(str(error)), 1, 2)
        return Result(
            None, (Diagnostic("Y1393", f"this is not TOML: {error}", source, span, "repair the line"),)
        )
    places = find_places(source)
    findings: list[Diagnostic] = []

    def say(key: str, message: str, help_: str) -> None:
        findings.append(Diagnostic("Y1393", message, source, places.of_key((key,)), help_))

    for key in data:
        if key not in _KEYS:
            say(
                key,
                f"{FILE_NAME} has no key {key}",
                suggest(key, _KEYS) or f"its keys are {', '.join(_KEYS)}",
            )
    robot, start = data.get("robot"), data.get("start")
    if robot is not None and (not isinstance(robot, str) or not robot.strip()):
        say("robot", "robot is a name or a path, in quotes", 'write robot = "INDUSTRIAL6"')
    if start is not None and not (
        isinstance(start, list) and all(type(value) in {int, float} for value in start)
    ):
        say(
            "start", "start is a list of numbers", "write one value a joint, in deg (mm for prismatic joints)"
        )
    if findings:
        return Result(None, tuple(findings))
    return Result(
        Project(path.parent, robot, tuple(map(float, start)) if start is not None else None, source)
    )


def _line_of(message: str) -> int:
    """The line that a message of tomllib speaks of; the end of the file has none, and is called line 1."""
    _, _, tail = message.partition("at line ")
    digits = tail.partition(",")[0]
    return int(digits) if digits.isdigit() else 1
