"""Calibration by touching: tools, frames, joints."""

from __future__ import annotations

import re
from collections.abc import Callable

import numpy as np

from yarclang.calibration.touching import FrameTouching, HomeTouching, TipTouching, Touching
from yarclang.calibration.writing import frame_line, with_offsets, with_tip
from yarclang.repl.cell_frames import cell_file, cell_of, write_into_cell
from yarclang.repl.declaring import declare
from yarclang.repl.dot import DotCommand, Misused
from yarclang.repl.session import Session
from yarclang.repl.texts import read_exactly, write_exactly
from yarclang.robot.joint_names import joint_number, listed_joints
from yarclang.robot.library import list_robots
from yarclang.robot.model import Array, Robot
from yarclang.source import SourceFile

_NAME = re.compile(r"\{?([A-Za-z_]\w*)\}?")
_KINDS = ("tcp", "frame", "home")
_THEN: dict[type[Touching], str] = {
    TipTouching: ".done writes it; .touch adds another one",
    FrameTouching: ".done writes it; .touch adds another point of the plane",
    HomeTouching: ".done writes it; approach the mark again and .touch to see how well it repeats",
}


def _calibrate(session: Session, rest: str) -> None:
    kind, *words = rest.split() or [""]
    robot = session.robot
    match kind.lower():
        case "tcp":
            touching: Touching = TipTouching(robot, _name(words))
        case "frame":
            name = _name(words[:1])
            tip = _name(words[1:]) if words[1:] else "TCP"
            frame = session.scope().frame(tip)
            if frame is None or not frame.on_flange:
                raise Misused(f"{{{tip}}} isn't a frame on the flange: it can't touch")
            touching = FrameTouching(robot, name, np.asarray(frame.transform))
        case "home":
            touching = HomeTouching(robot, _marks(robot, words))
        case _:
            raise Misused(f".calibrate takes {', '.join(_KINDS)}")
    session.touching = touching
    session.say(_told(touching))


async def _touch(session: Session, rest: str) -> None:  # noqa: ARG001 - the command has no arguments
    touching = _going_on(session)
    touching.touch(await session.stands())
    session.show(touching.findings)
    session.say(_told(touching))


def _untouch(session: Session, rest: str) -> None:  # noqa: ARG001
    touching = _going_on(session)
    if not touching.joints:
        raise Misused("nothing was touched yet")
    touching.untouch()
    session.show(touching.findings)
    session.say(_told(touching))


def _cancel(session: Session, rest: str) -> None:  # noqa: ARG001
    _going_on(session)
    session.touching = None
    session.say("the calibration is discarded; nothing was written")


async def _done(session: Session, rest: str) -> None:  # noqa: ARG001
    touching = _going_on(session)
    match touching:
        case TipTouching(value=found) if found is not None:
            written = await _write_tip(session, touching.name, touching)
        case FrameTouching(value=found) if found is not None:
            written = await _write_frame(session, touching.name, found.base_from_frame)
        case HomeTouching(value=found) if found is not None:
            written = await _write_robot(session, lambda file: with_offsets(file, found.offsets))
        case _:
            session.refuse(f"there is no result yet\n  {_told(touching)}")
            return
    if written:
        session.touching = None


async def _write_frame(session: Session, name: str, base_from_frame: Array) -> bool:
    """Write a calibrated frame into the cell.toml if the cell defines it; otherwise declare it by a FRAME
    line.
    """
    path = await cell_file(session)
    if path is not None and name in cell_of(session, path).frames:
        return await write_into_cell(session, path, name, base_from_frame, "B")
    return await declare(session, name, frame_line(name, base_from_frame, "B"), is_frame=True)


async def _write_tip(session: Session, name: str, touching: TipTouching) -> bool:
    """Write a calibrated tool into robot.toml if that file defines a frame of this name; otherwise declare it
    by a FRAME line.
    """
    assert touching.value is not None
    tip = touching.value.flange_from_tip
    robot = session.robot
    if name in robot.flange_from_frame:
        return await _write_robot(session, lambda file: with_tip(file, name, tip))
    pose = np.eye(4)
    pose[:3, 3] = tip
    return await declare(session, name, frame_line(name, pose, "FLANGE"), is_frame=True)


async def _write_robot(session: Session, change: Callable[[SourceFile], str]) -> bool:
    robot = session.robot
    path = robot.file
    if any(one.folder == robot.folder for one in list_robots()):
        session.refuse(
            f"{robot.name} is a robot of the standard library, which can't be changed\n  help: copy "
            f"{robot.folder} to your project, and start with --robot and the path of the copy"
        )
        return False
    old = read_exactly(path)
    new = change(SourceFile(str(path), old))
    changed = [
        (before, after)
        for before, after in zip(old.splitlines(), new.splitlines(), strict=False)
        if before != after
    ]
    session.say(
        "\n".join(f"- {before}\n+ {after}" for before, after in changed[:3]) or new[len(old) :].strip()
    )
    if not await session.agrees(f"write {path}?"):
        session.say("nothing was written")
        return False
    write_exactly(path, new)
    session.say(
        f"{path} is written. This session still uses the old values: end it, load `yarc settings` into the "
        "controller, and start a new session"
    )
    return True


def _told(touching: Touching) -> str:
    """Return the measured values, and what the user should type next."""
    if touching.missing:
        return f"{len(touching.joints)} of {touching.fewest}: {touching.next_step()}, then .touch"
    text = touching.result_text()
    return (
        f"{text}\n  {_THEN[type(touching)]}"
        if text
        else "not yet: see above; touch again, or .untouch the last one"
    )


def _going_on(session: Session) -> Touching:
    if session.touching is None:
        raise Misused("no calibration is in progress; start one, for example .calibrate tcp NAME")
    return session.touching


def _name(words: list[str]) -> str:
    found = _NAME.fullmatch(words[0]) if len(words) == 1 else None
    if found is None:
        raise Misused("one name is needed")
    return found[1].upper()


def _marks(robot: Robot, words: list[str]) -> dict[str, float]:
    """Parse the joints and their positions at the marks, in deg or mm, that a user has typed (J2 0 J3 90)."""
    if not words or len(words) % 2:
        raise Misused("joints and their positions at the marks are needed: J2 0 J3 90")
    marks = {}
    for name, value in zip(words[::2], words[1::2], strict=True):
        joint = joint_number(robot.joint_names, name)
        if joint is None:
            raise Misused(
                f"{robot.name} has no joint {name}; its joints are {listed_joints(robot.joint_names)}"
            )
        if robot.joint_names[joint] in marks:
            raise Misused(f"joint {name} is named twice")
        try:
            number = float(value)
        except ValueError:
            raise Misused(f"{value!r} isn't a position") from None
        marks[robot.joint_names[joint]] = number * float(robot.axis_units[joint])
    return marks


COMMANDS = (
    DotCommand(
        ".calibrate",
        "tcp NAME | frame NAME [TOOL] | home J2 0 ...",
        "begin a calibration; move and .touch, then .done",
        "calibration",
        _calibrate,
        complete=lambda _, begun: (one for one in _KINDS if one.startswith(begun)),
        doc="tcp: the tip of a tool, from four or more touches of one point. frame: a frame, from its "
        "origin, a point on its x axis, and points in its plane.\nhome: the motors' offsets, from "
        "joints that are at their marks. Move the robot between two touches in any way.",
    ),
    DotCommand(".touch", "", "record the present position as the next point", "calibration", _touch),
    DotCommand(".untouch", "", "discard the last touch", "calibration", _untouch),
    DotCommand(".done", "", "write what was calibrated", "calibration", _done),
    DotCommand(".cancel", "", "discard the calibration", "calibration", _cancel),
)
