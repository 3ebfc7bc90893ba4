"""Give a name to the robot's current position."""

from __future__ import annotations

import re

import numpy as np

from yarclang.calibration.writing import frame_line
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import findings_of
from yarclang.repl.cell_frames import cell_file, cell_of, write_into_cell
from yarclang.repl.declaring import declare
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.session import Session
from yarclang.robot.model import Array, Robot

_NAME = re.compile(r"(\{)?([A-Za-z_]\w*)(?(1)\})")


async def _teach(session: Session, rest: str) -> None:
    words = rest.split()
    into_cell = words[:1] == ["cell"] and len(words) > 1
    words = words[into_cell:]
    found = _NAME.fullmatch(words[0]) if words else None
    if found is None:
        raise Misused("a name is missing: {PICK} for a frame, READY for a joint position")
    name, is_frame = found[2].upper(), bool(found[1])
    if into_cell:
        await _teach_cell(session, name, words) if is_frame else _no_joints_in_cell()
        return
    if not is_frame:
        if len(words) > 1:
            raise Misused("a joint position has no frame")
        joints = await session.stands()
        await declare(session, name, joints_line(name, session.robot, joints), is_frame=False)
        return
    base, moving = (
        *(f"{{{word.strip('{}').upper()}}}" for word in words[1:3]),
        *("{B}", "{TCP}")[len(words) - 1 :],
    )
    where = await session.attached.ask(orders.AskPlace(base=base, moving=moving))
    session.show(findings_of(where.findings))
    if where.pose is not None:
        line = frame_line(name, np.array(where.pose), base.strip("{}"))
        await declare(session, name, line, is_frame=True)


def _no_joints_in_cell() -> None:
    raise Misused("a frame is taught into the cell: .teach cell {PICK}")


async def _teach_cell(session: Session, name: str, words: list[str]) -> None:
    """Write the tool's pose as a frame into the cell.toml of the session."""
    path = await cell_file(session)
    if path is None:
        raise Misused('there is no cell: write `cell = "cell.toml"` into yarc.toml, or type CELL "cell.toml"')
    known = cell_of(session, path).frames.get(name)
    parent = words[1].strip("{}").upper() if words[1:] else known.parent if known is not None else "B"
    if known is not None and parent != known.parent:
        raise Misused(f"{{{name}}} has the parent {{{known.parent}}} in {path.name}, and keeps it")
    moving = f"{{{words[2].strip('{}').upper()}}}" if words[2:] else "{TCP}"
    where = await session.attached.ask(orders.AskPlace(base="{B}", moving=moving))
    session.show(findings_of(where.findings))
    if where.pose is not None:
        await write_into_cell(session, path, name, np.array(where.pose), parent)


def joints_line(name: str, robot: Robot, joints: Array) -> str:
    """Return the line `JOINTS NAME q1 ... (deg)` for joint positions (n,) [rad or m], to 0.0001 deg or mm."""
    values = " ".join(
        f"{value:.4f}".rstrip("0").rstrip(".") for value in np.round(joints / robot.axis_units, 4) + 0.0
    )
    return f"JOINTS {name} {values} ({','.join(dict.fromkeys(robot.axis_unit_names))})"


COMMANDS = (
    DotCommand(
        ".teach",
        "NAME | [cell] {NAME} [BASE [MOVING]]",
        "give the present position a name: joints, or the tool's pose as a frame",
        "teaching",
        _teach,
        doc=(
            "If the name is already declared, its values are changed: you see both lines and are asked, "
            "and the line of the loaded file is changed as well. `.teach cell {NAME}` writes the frame "
            "into the cell.toml; an existing frame keeps its parent, and comments and order are kept."
        ),
    ),
)
