"""Write a frame into the cell.toml of the session."""

from __future__ import annotations

import difflib
from pathlib import Path

from yarclang.calibration.cell_frames import CellFrameError, read_frame_cell, with_measured_frame
from yarclang.cell.description import Names
from yarclang.cell.model import Cell
from yarclang.coordinator.messages import orders
from yarclang.repl.session import Session
from yarclang.repl.texts import read_exactly, write_exactly
from yarclang.robot.model import Array
from yarclang.runtime.actions import Trouble
from yarclang.semantics.declared.meanings import is_word
from yarclang.source import SourceFile


async def cell_file(session: Session) -> Path | None:
    """Return the cell.toml of the program that was run last, or else that of the session; None without
    one.
    """
    around = await session.attached.ask(orders.AskSurroundings())
    return None if around.cell is None else Path(around.cell)


def cell_of(session: Session, path: Path) -> Cell:
    """Return the cell in a file, read from the disk now.

    Raises:
        Trouble: the file can't be read.
    """
    try:
        return read_frame_cell(SourceFile(str(path), read_exactly(path)), path, Names(is_word, session.robot))
    except CellFrameError as error:
        raise Trouble(str(error), error.help) from None


async def write_into_cell(
    session: Session, path: Path, name: str, base_from_frame: Array, parent: str
) -> bool:
    """Write the pose of a frame into a cell.toml, after showing the changed lines and asking the user.

    Args:
        session: the user's session.
        path: the cell.toml.
        name: name of the frame, in upper case without braces.
        base_from_frame: (4, 4) pose of the frame in {B} [m].
        parent: parent of a new frame.

    Returns:
        True if the file was written.

    Raises:
        Trouble: the file can't be read or written, or the frame can't be added to it.
    """
    old = read_exactly(path)
    try:
        made = with_measured_frame(
            SourceFile(str(path), old), path, Names(is_word, session.robot), name, base_from_frame, parent
        )
    except CellFrameError as error:
        raise Trouble(str(error), error.help) from None
    session.show(made.findings)
    changed = [one for one in difflib.ndiff(old.splitlines(), made.text.splitlines()) if one[:1] in "+-"]
    session.say("\n".join((*(one for one in changed if one[2:].strip()), made.what)))
    if not await session.agrees(f"write {path.name}?"):
        session.say("nothing was written")
        return False
    if read_exactly(path) != old:
        raise Trouble(f"{path.name} was changed by another program in the meantime", "teach the frame again")
    write_exactly(path, made.text)
    session.say(f"{path.name} is written; it applies from the next motion on")
    return True
