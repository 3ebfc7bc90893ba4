"""Templates for new programs: files of the standard library that are filled in with positions within the
robot's reach.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from yarclang.diagnostics import Diagnostic, has_errors
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.robot.checklist.geometry import outwards
from yarclang.robot.kinematics.fk import flange_poses, poses_and_jacobians
from yarclang.robot.library import list_robots, stdlib_folder
from yarclang.robot.model import Array, Robot
from yarclang.runtime.actions import Trouble
from yarclang.semantics.declared.meanings import is_word
from yarclang.semantics.values.units import joint_kinds
from yarclang.source import SourceFile
from yarclang.teaching.fields import Field, FieldKind
from yarclang.teaching.holding import joint_numbers, pose_numbers
from yarclang.units import DEG, MM, Kind, number_text

_UNITS: Mapping[Kind, str] = {"length": "mm", "angle": "deg"}
_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,59}")
_MARK = re.compile(r"@([A-Z]+)((?: [A-Z0-9.-]+)*)@")
_TRIED = 3000
_WIDEST = 75.0 * DEG
_SHARES = (0.08, 0.05, 0.03)
"""Distances of a template's positions from READY, as shares of the robot's reach. The shares are tried in
this order until the program can be proved.
"""


@dataclass(frozen=True, slots=True)
class Asked:
    """A value of a template that the user fills in: the name of a signal, or a number.

    Attributes:
        mark: name of the value in the file of the template.
        label: name that is displayed.
        kind: kind of the value.
        value: proposed value.
        least: smallest allowed number.
        most: largest allowed number.
        unit: unit of the number.
    """

    mark: str
    label: str
    kind: FieldKind
    value: str
    least: float = 0.0
    most: float = 0.0
    unit: str = ""


_SPEED = Asked("SPEED", "Speed, share of the limits", "percent", "30", 1, 100, "%")
_GRIP = Asked("GRIP", "Output that shuts the gripper", "signal", "GRIP")
_TITLES: Mapping[str, tuple[str, tuple[Asked, ...]]] = {
    "pick-place": (
        "Pick and place",
        (_GRIP, Asked("TIMES", "How often", "number", "3", 1, 10), _SPEED),
    ),
    "pallet": (
        "Palletising",
        (
            _GRIP,
            Asked("COLUMNS", "Columns", "number", "2", 1, 4),
            Asked("ROWS", "Rows", "number", "2", 1, 4),
            _SPEED,
        ),
    ),
    "weld": (
        "Weld seam",
        (
            Asked("ARC", "Output that lights the arc", "signal", "ARC"),
            Asked("TRAVEL", "Speed along the seam", "number", "8", 1, 50, "mm/s"),
            _SPEED,
        ),
    ),
    "glue": (
        "Gluing",
        (
            Asked("GLUE", "Output that opens the nozzle", "signal", "GLUE"),
            Asked("TRAVEL", "Speed of the bead", "number", "30", 1, 200, "mm/s"),
            _SPEED,
        ),
    ),
    "tend": ("Machine tending", (_GRIP, _SPEED)),
    "empty": ("Empty program", (_SPEED,)),
}


@dataclass(frozen=True, slots=True)
class Template:
    """A complete program with which a user can begin.

    Attributes:
        name: name of the template's file.
        title: name that is displayed.
        summary: what the program does.
        fields: fields to fill in, with proposed values.
    """

    name: str
    title: str
    summary: str
    fields: tuple[Field, ...]


def templates() -> tuple[Template, ...]:
    """Return all templates."""
    found = []
    for name, (title, asked) in _TITLES.items():
        summary = _text(name).split("\n", 1)[0].lstrip("! ").partition(": ")[2]
        fields = tuple(Field(one.mark.lower(), one.label, one.kind, one.value, one.unit) for one in asked)
        found.append(Template(name, title, summary, fields))
    return tuple(found)


def _text(name: str) -> str:
    return (stdlib_folder() / "project" / "templates" / f"{name}.yarc").read_text(encoding="utf-8")


def filled(name: str, robot: Robot, fields: Mapping[str, str], share: float = _SHARES[0]) -> str:
    """Return the program that results from a template, for a robot and with filled-in values.

    Args:
        name: name of the template.
        robot: the robot to move.
        fields: texts by field name; missing fields keep their proposed values.
        share: distance of the positions from READY, as a share of the robot's reach.

    Raises:
        Trouble: there is no such template, a value isn't allowed, or the robot can't execute the program.
    """
    if name not in _TITLES:
        known = ", ".join(_TITLES)
        raise Trouble(f"there is no template {name[:40]!r}", f"there are {known}", "template")
    values = _checked(_TITLES[name][1], fields)
    ready, reach = _ready(robot)
    size = max(round(share * reach / MM / 5.0), 1) * 5.0
    pose = flange_poses(robot.chain, ready[None])[0]
    tip = np.asarray(robot.flange_from_frame.get("TCP", np.eye(4)))
    tool = np.eye(4)
    tool[:3, :3], tool[:3, 3] = pose[:3, :3].T, tip[:3, 3]
    place = (pose @ tool)[:3, 3]
    out = np.array([place[0], place[1], 0.0])
    out /= np.linalg.norm(out)
    side = np.array([out[1], -out[0], 0.0])
    joints = " ".join(joint_numbers(robot, ready, dict.fromkeys(joint_kinds(robot), "") | dict(_UNITS)))
    units = ",".join(dict.fromkeys(robot.axis_unit_names))

    def frame(rest: str) -> str:
        called, *shares = rest.split()
        across, along, up = (float(one) * size * MM for one in shares)
        there = np.eye(4)
        there[:3, 3] = place + across * side + along * out + np.array([0.0, 0.0, up])
        there[:3, 3] = np.round(there[:3, 3] / MM) * MM
        return f"FRAME {{{called}}} {' '.join(pose_numbers(there, _UNITS))}"

    marks: dict[str, Callable[[str], str]] = {
        "ROBOT": lambda _: _robot_line(robot),
        "TOOL": lambda _: f"FRAME {{GRIPPER}} {' '.join(pose_numbers(tool, _UNITS))} (mm,deg) {{FLANGE}}",
        "READY": lambda _: f"JOINTS READY {joints} ({units})",
        "ABOVE": lambda _: number_text(size, 1),
        "STEP": lambda rest: number_text(float(rest) * size, 1),
        "FRAME": frame,
        **{mark: (lambda _, value=value: value) for mark, value in values.items()},  # type: ignore[misc]
    }
    text = _MARK.sub(lambda match: marks[match[1]](match[2].strip()), _text(name))
    return "".join(line + "\n" for line in text.splitlines() if line != _NOTHING)


_NOTHING = "!-"


def _robot_line(robot: Robot) -> str:
    """Return the ROBOT line that names a robot of the library. Another robot is named in the project's
    yarc.toml; return `_NOTHING` (no line) for it.
    """
    is_known = any(one.folder == robot.folder for one in list_robots())
    return f"ROBOT {robot.name}" if is_known else _NOTHING


def _checked(asked: tuple[Asked, ...], fields: Mapping[str, str]) -> dict[str, str]:
    names = {one.mark.lower() for one in asked}
    stranger = next((name for name in fields if name not in names), None)
    if stranger is not None:
        raise Trouble(
            f"this template has no field {stranger[:40]!r}",
            f"its fields are {', '.join(sorted(names))}",
            "field",
        )
    return {one.mark: _value(one, fields.get(one.mark.lower(), "").strip() or one.value) for one in asked}


def _value(asked: Asked, text: str) -> str:
    if asked.kind == "signal":
        if _NAME.fullmatch(text) is None or is_word(text.upper()):
            raise Trouble(
                f"{asked.label}: {text[:40]!r} can't be a name",
                "letters, digits and _, a letter first",
                "field",
            )
        if text.upper() in (
            "GAS",
            "CHUCK_SHUT",
            "CYCLE",
            "DONE",
            "READY",
            "LENGTH",
            "WELDS",
            "WIDTH",
            "HEIGHT",
            "ROUND",
            "TRAVEL",
            "COLUMNS",
            "ROWS",
            "ROW",
            "COLUMN",
            "PITCH_X",
            "PITCH_Y",
            "PICKPLACE",
            "PALLET",
            "PATTERN",
            "APPROACH",
        ):
            raise Trouble(
                f"{asked.label}: {text.upper()} is already used by this template",
                "choose another name",
                "field",
            )
        return text.upper()
    text = text.rstrip("% ")
    if not re.fullmatch(r"[0-9]{1,6}", text) or not asked.least <= float(text) <= asked.most:
        raise Trouble(
            f"{asked.label}: {text[:40]!r} is no integer from {asked.least:g} to {asked.most:g}",
            "choose another one",
            "field",
        )
    return text


def _ready(robot: Robot) -> tuple[Array, float]:
    """Return a ready position (n,) [rad or m] for a robot, and the robot's reach [m].

    The ready position is the best of many random positions: the joints are near the middle of their ranges,
    the robot is far from singularities, and the tool points down.
    """
    lower, upper = robot.limits.lower, robot.limits.upper
    random = np.random.default_rng(0)
    turning = ~robot.chain.is_prismatic
    room = 0.8 * np.minimum(robot.home - lower, upper - robot.home)
    middle = np.where(room > 0.0, robot.home, (lower + upper) / 2)
    width = np.where(room > 0.0, room, 0.4 * (upper - lower))
    width = np.where(turning, np.minimum(width, _WIDEST), width)
    tried = middle + random.uniform(-1.0, 1.0, (_TRIED, robot.size)) * width
    tip = np.asarray(robot.flange_from_frame.get("TCP", np.eye(4)))
    poses, jacobians = poses_and_jacobians(robot.chain, tried, tip)
    flat = np.linalg.norm(poses[:, :2, 3], axis=1)
    reach = float(np.linalg.norm(poses[:, :3, 3], axis=1).max())
    scaled = jacobians.copy()
    scaled[:, :3] /= reach
    singular = np.linalg.svd(scaled, compute_uv=False)[:, min(6, robot.size) - 1]
    out = outwards(robot)
    down = np.zeros(len(tried))
    if out is not None:  # `out` is the direction of the tool with all joints at zero, in {B}
        at_zero = robot.chain.base_from_flange[:3, :3] @ tip[:3, :3]
        down = -(poses[:, :3, :3] @ (at_zero.T @ out))[:, 2]
    bent = np.abs((tried - middle) / np.where(width > 0, width, 1.0)).mean(axis=1)
    score = 3.0 * np.minimum(singular, 0.2) + 0.5 * down - 0.4 * bent
    score -= 2.0 * (flat < 0.3 * reach)
    score -= 2.0 * ((poses[:, 2, 3] < 0.15 * reach) & turning.all())
    units = np.asarray(robot.axis_units)
    best = tried[int(score.argmax())]
    return np.clip(np.round(best / units) * units, lower, upper), reach


def new(name: str, robot: Robot, fields: Mapping[str, str], folder: Path) -> str:
    """Return the program that results from a template, proved for a robot in a project.

    Args:
        name: name of the template.
        robot: the robot to move.
        fields: texts by field name.
        folder: folder for the program.

    Raises:
        Trouble: a value isn't allowed, or no positions were found for which the program can be proved.
    """
    first: Diagnostic | None = None
    for share in _SHARES:
        text = filled(name, robot, fields, share)
        told = check_text(
            SourceFile(str(folder / f"{name}.yarc"), text),
            folder,
            Options(robot=str(robot.file)),
        )
        if not has_errors(told.diagnostics):
            return text
        first = first or next(one for one in told.diagnostics if one.is_error)
    why, help_ = (first.message, first.help) if first else ("", "")
    raise Trouble(
        f"no places for {name} could be proved for {robot.name}: {why}",
        f"{help_}{'; or ' * bool(help_)}begin with the template empty, and teach the places",
        "template",
    )
