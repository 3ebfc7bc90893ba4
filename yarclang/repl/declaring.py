"""Declare a position or pose of the robot under a name, in the session and in the loaded file. An older
declaration of the name is replaced.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from yarclang.assist.sketch import sketch_of
from yarclang.assist.symbols import Symbol
from yarclang.coordinator.messages import orders
from yarclang.coordinator.messages.findings import findings_of
from yarclang.repl.texts import read_exactly, write_exactly
from yarclang.source import SourceFile, lines_with_ends

if TYPE_CHECKING:
    from yarclang.repl.session import Session


async def declare(session: Session, name: str, line: str, *, is_frame: bool) -> bool:
    """Declare a name in the session, or change its value.

    If the loaded file declares the name, the file's line is changed as well, after asking the user.

    Args:
        session: the user's session.
        name: name in upper case, for a frame without braces.
        line: the whole declaration.
        is_frame: True for the name of a frame.

    Returns:
        True if the name was declared.
    """
    await session.renew()
    lines = session.lines.declarations
    known = next((at for at, text in enumerate(lines) if _declared(text, name, is_frame)), None)
    if known is None:
        return await session.carry_out(line)
    old = lines[known]
    new = _kept_comment(old, line)
    session.say(f"- {old.strip()}\n+ {new.strip()}")
    if not await session.agrees("change it?"):
        session.say("nothing was changed")
        return False
    if not await adopt(session, (*lines[:known], new, *lines[known + 1 :])):
        return False
    _in_file(session, name, is_frame, line)
    return True


async def adopt(session: Session, declarations: tuple[str, ...]) -> bool:
    """Replace all declarations of the session. Return True if the new ones were accepted."""
    adopted = await session.attached.ask(orders.Adopt(declarations=declarations))
    session.show(findings_of(adopted.findings))
    await session.renew()
    return adopted.holds


def _in_file(session: Session, name: str, is_frame: bool, line: str) -> None:
    """Change the declaration of a name in the loaded file, if the file declares the name."""
    file = session.file
    if file is None:
        return
    text = read_exactly(file.path)
    symbol = _declared(text, name, is_frame)
    if symbol is None:
        return
    lines = lines_with_ends(text)
    first, rows = symbol.statement.line - 1, symbol.statement.rows
    old = "".join(lines[first : first + rows])
    ending = old[len(old.rstrip("\r\n")) :]
    lines[first : first + rows] = [_kept_comment(old.rstrip("\r\n"), line) + ending]
    write_exactly(file.path, "".join(lines))
    session.say(f"{file.path}:{first + 1} is changed")


def _declared(text: str, name: str, is_frame: bool) -> Symbol | None:
    """Return the declaration of a name in a text, outside of blocks."""
    return sketch_of(SourceFile("<declaration>", text)).names.declared(name, is_frame)


def _kept_comment(old: str, line: str) -> str:
    """Return a new line with the indentation and the comment of the old one."""
    indent = old[: len(old) - len(old.lstrip())]
    statements = sketch_of(SourceFile("<declaration>", old)).module.statements
    comments = [comment.text for statement in statements for comment in statement.comments]
    return " ".join([indent + line, *comments])
