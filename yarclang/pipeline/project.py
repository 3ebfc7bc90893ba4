"""Read yarc.toml: defaults for options that aren't given."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import field
from pathlib import Path
from typing import Any

from yarclang.consulted import nearest_folder
from yarclang.diagnostics import Diagnostic, Result
from yarclang.frozen import frozen
from yarclang.pipeline.sources import NO_TEXTS, read_source
from yarclang.source import SourceFile, Span
from yarclang.subjects import Name, unknown
from yarclang.toml.places import find_places

FILE_NAME = "yarc.toml"
_KEYS = ("robot", "cell", "start", "teach", "jobs", "findings")
_LARGEST_JOB = 65535
"""Largest value of a group of inputs, and so the largest number of a job."""
_LEVELS = ("off", "note", "warning", "error")


@frozen
class Project:
    """The settings of a project, from its yarc.toml.

    Attributes:
        folder: folder to which the paths are relative.
        robot: name of a robot, or its path relative to `folder`.
        start: joint position at which programs start [deg, mm for prismatic joints].
        cell: path of a cell.toml for all programs, relative to `folder`.
        source: text of the yarc.toml; None without one.
        teach: True if the programs are for teaching at reduced speed.
        levels: severity of findings by their codes (`off`: not reported).
        jobs: programs by their numbers, as paths relative to `folder`.
    """

    folder: Path
    robot: str | None = None
    start: tuple[float, ...] | None = None
    cell: str | None = None
    source: SourceFile | None = None
    teach: bool = False
    levels: Mapping[str, str] = field(default_factory=dict)
    jobs: Mapping[int, str] = field(default_factory=dict)

    def span_of(self, key: str) -> Span | None:
        """Return the place of a key's value in yarc.toml."""
        return find_places(self.source).of_value((key,)) if self.source else None


def find_project(folder: Path, texts: Mapping[Path, SourceFile] = NO_TEXTS) -> Result[Project]:
    """Read the yarc.toml of a folder or of the nearest folder above it; without one, return empty settings.
    Open files in `texts` take precedence over saved files.
    """
    folder = folder.resolve()
    open_ = {path.resolve(): text for path, text in texts.items() if path.name == FILE_NAME}
    saved = nearest_folder(folder, FILE_NAME)
    for candidate in (folder, *folder.parents):
        path = candidate / FILE_NAME
        if path in open_:
            return read_project(open_[path], candidate)
        if candidate == saved:
            return _read(path)
    return Result(Project(folder))


def _read(path: Path) -> Result[Project]:
    opened = read_source(str(path))
    if opened.value is None:
        return Result(None, opened.diagnostics)
    return read_project(opened.value, path.parent)


def read_project(source: SourceFile, folder: Path) -> Result[Project]:
    """Parse the text of a yarc.toml in a folder, for example while it is being edited."""
    try:
        data = tomllib.loads(source.text)
    except tomllib.TOMLDecodeError as error:
        span = Span.on_line(_line_of(str(error)), 1, 2)
        return Result(
            None, (Diagnostic("Y1393", f"this is not TOML: {error}", source, span, "repair the line"),)
        )
    places = find_places(source)
    findings: list[Diagnostic] = []

    def say(key: str, message: str, help_: str, subject: Name | None = None) -> None:
        findings.append(Diagnostic("Y1393", message, source, places.of_key((key,)), help_, subject=subject))

    for key in data:
        if key not in _KEYS:
            subject = unknown(key, _KEYS)
            help_ = subject.question or f"its keys are {', '.join(_KEYS)}"
            say(key, f"{FILE_NAME} has no key {key}", help_, subject)
    robot, start = data.get("robot"), data.get("start")
    if robot is not None and (not isinstance(robot, str) or not robot.strip()):
        say("robot", "robot is a name or a path, in quotes", 'write robot = "INDUSTRIAL6"')
    cell = data.get("cell")
    if cell is not None and (not isinstance(cell, str) or not cell.strip()):
        say(
            "cell",
            f"cell is the path of a file in quotes, relative to the folder of {FILE_NAME}",
            'write cell = "cell.toml"',
        )
    if start is not None and not (
        isinstance(start, list) and all(type(value) in {int, float} for value in start)
    ):
        say(
            "start",
            "start is a list of numbers",
            "write one value per joint, in deg (mm for prismatic joints)",
        )
    teach = data.get("teach", False)
    if not isinstance(teach, bool):
        say("teach", "teach is true or false", "write teach = true if people are within reach of the robot")
    levels = _levels(data.get("findings", {}), source, findings)
    jobs = _jobs(data.get("jobs", {}), source, findings)
    if findings:
        return Result(None, tuple(findings))
    given = tuple(map(float, start)) if start is not None else None
    return Result(Project(folder, robot, given, cell, source, teach, levels, jobs))


def _jobs(table: Any, source: SourceFile, findings: list[Diagnostic]) -> dict[int, str]:
    """Parse the table [jobs]: programs by their numbers."""
    places = find_places(source)

    def say(path: tuple[str, ...], message: str, help_: str) -> None:
        findings.append(Diagnostic("Y1393", message, source, places.of_key(path), help_))

    if not isinstance(table, dict):
        say(("jobs",), "jobs is a table", 'write [jobs], and below it 1 = "left.yarc"')
        return {}
    programs: dict[int, str] = {}
    for word, file in table.items():
        number = int(word) if word.isascii() and word.isdigit() and len(word) <= 5 else -1
        if not 0 <= number <= _LARGEST_JOB:
            say(
                ("jobs", word),
                f"{word[:40]!r} isn't the number of a job",
                f"write an integer from 0 to {_LARGEST_JOB}",
            )
        elif number in programs:
            say(("jobs", word), f"job {number} is given twice", "remove one of them")
        elif not isinstance(file, str) or not file.lower().endswith(".yarc"):
            say(
                ("jobs", word),
                f"job {number} isn't the path of a program",
                f'write {number} = "left.yarc", a path relative to the folder of {FILE_NAME}',
            )
        else:
            programs[number] = file
    return programs


def _levels(table: Any, source: SourceFile, findings: list[Diagnostic]) -> dict[str, str]:
    """Parse the table [findings] of yarc.toml into the severity of each finding's code. A key is a code, a
    name, or the beginning of codes.
    """
    if not table and isinstance(table, dict):
        return {}
    from yarclang.lint.registry import codes_of, everything

    places = find_places(source)

    def say(path: tuple[str, ...], message: str, help_: str, subject: Name | None = None) -> None:
        findings.append(Diagnostic("Y1393", message, source, places.of_key(path), help_, subject=subject))

    levels: dict[str, str] = {}
    if not isinstance(table, dict):
        say(("findings",), "findings is a table", 'write [findings], and below it Y0611 = "off"')
        return levels
    known_words = [*everything(), *(one.name for one in everything().values())]
    # Apply short keys first, so that a more specific key takes precedence in any order of the file.
    for word, level in sorted(table.items(), key=lambda entry: len(entry[0])):
        path = ("findings", word)
        codes = codes_of(word)
        if not codes:
            subject = unknown(word, known_words)
            help_ = subject.question or "yarc explain lists all codes"
            say(path, f"there is no finding {word}", help_, subject)
        elif level not in _LEVELS:
            say(path, f"{word} is set to {level!r}", f"a finding is one of {', '.join(_LEVELS)}")
        elif len(codes) == 1 and everything()[codes[0]].severity == "error" and level != "error":
            say(
                path,
                f"{codes[0]} is an error, which can't be changed",
                "a program with an error can't be executed",
            )
        else:
            levels |= {code: level for code in codes if everything()[code].severity != "error"}
    return levels


def _line_of(message: str) -> int:
    """Return the line number in an error message of tomllib; 1 if the message names the end of the file."""
    _, _, tail = message.partition("at line ")
    digits = tail.partition(",")[0]
    return int(digits) if digits.isdigit() else 1
