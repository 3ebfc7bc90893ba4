"""Convert a file to a YARC program: determine the kind of the file, and call the reader for this kind."""

from __future__ import annotations

import re
from pathlib import Path, PurePath

from yarclang.convert.bag import read_bag
from yarclang.convert.course import Content, Converted, Wishes
from yarclang.convert.documents import read_json, read_yaml
from yarclang.convert.from_table import content_of_table
from yarclang.convert.srdf import content_of_srdf
from yarclang.convert.trajectory import content_of_documents
from yarclang.convert.writing import program_text
from yarclang.diagnostics import Collector, Result
from yarclang.robot.model import Robot
from yarclang.source import SourceFile

_KINDS = {
    ".csv": "table",
    ".tsv": "table",
    ".json": "json",
    ".yaml": "yaml",
    ".yml": "yaml",
    ".srdf": "srdf",
    ".xml": "srdf",
}
_YAML_KEY = re.compile(r"\s*-?\s*[a-z_]+:(\s|$)")


def convert(source: SourceFile, robot: Robot, wishes: Wishes) -> Result[Converted]:
    """Convert a table, a trajectory or an SRDF to a program; return None, with an error, if this fails.

    The kind of the file is determined by its suffix, or by its beginning.

    Args:
        source: the file.
        robot: the robot of the program.
        wishes: the options.
    """
    findings = Collector(source)
    if not source.text.strip():
        findings.add("Y1504", "the file is empty", None, "check which file was given")
        return Result(None, tuple(findings.found))
    if (refusal := _other_joints(robot, wishes, findings)) is not None:
        return refusal
    return _made(source.name, _content(source, robot, wishes, findings), robot, wishes, findings)


def convert_bag(path: Path, robot: Robot, wishes: Wishes) -> Result[Converted]:
    """Convert the trajectories of a bag to a program; return None, with an error, if this fails.

    Args:
        path: the bag.
        robot: the robot of the program.
        wishes: the options.
    """
    findings = Collector(SourceFile(str(path), ""))
    if (refusal := _other_joints(robot, wishes, findings)) is not None:
        return refusal
    documents = read_bag(path, wishes.topic, findings)
    content = None if documents is None else content_of_documents(documents, robot, wishes, findings)
    return _made(path.name, content, robot, wishes, findings)


def _other_joints(robot: Robot, wishes: Wishes, findings: Collector) -> Result[Converted] | None:
    """Return an error if the option --joints names more or fewer joints than the robot has, else None."""
    if not wishes.joints or len(wishes.joints) == robot.size:
        return None
    message = f"--joints names {len(wishes.joints)} joints, but {robot.name} has {robot.size}"
    help_ = f"give the file's names for {', '.join(robot.joint_names)}, in this order"
    findings.add("Y1511", message, None, help_)
    return Result(None, tuple(findings.found))


def _made(
    name: str, content: Content | None, robot: Robot, wishes: Wishes, findings: Collector
) -> Result[Converted]:
    if content is None:
        return Result(None, tuple(findings.found))
    made = program_text(PurePath(name).name, content, robot, wishes, findings)
    return Result(made, tuple(findings.found))


def _content(source: SourceFile, robot: Robot, wishes: Wishes, findings: Collector) -> Content | None:
    kind = _kind(source)
    if kind == "table":
        return content_of_table(source, robot, wishes, findings)
    if kind == "srdf":
        return content_of_srdf(source, robot, wishes, findings)
    documents = (read_json if kind == "json" else read_yaml)(source, findings)
    return None if documents is None else content_of_documents(documents, robot, wishes, findings)


def _kind(source: SourceFile) -> str:
    """Return the kind of a file: `table`, `json`, `yaml` or `srdf`."""
    known = _KINDS.get(PurePath(source.name).suffix.lower())
    if known:
        return known
    text = source.text.lstrip()
    if text.startswith("<"):
        return "srdf"
    if text.startswith(("{", "[")):
        return "json"
    return "yaml" if text.startswith("---") or _YAML_KEY.match(text) else "table"
