"""Show the list of commands that can be typed."""

from __future__ import annotations

from itertools import groupby

from yarclang.repl.dot import DotCommand, dot_commands
from yarclang.repl.session import Session
from yarclang.subjects import suggest

_HEAD = (
    "A line of YARC, with or without an index, is planned from the robot's present position, certified, "
    "shown, and carried out after you confirm it."
)


def _help(session: Session, rest: str) -> None:
    commands = dot_commands()
    if not rest:
        width = max(len(one.line) for one in commands.values())
        lines = [_HEAD]
        for group, members in groupby(commands.values(), key=lambda one: one.group):
            lines += ["", group, *(f"  {one.line:{width}}  {one.summary}" for one in members)]
        session.say("\n".join(lines))
        return
    name = rest if rest.startswith(".") else f".{rest}"
    command = commands.get(name.lower())
    if command is None:
        session.refuse(
            f"there is no command {name}; {suggest(name.lower(), commands).lower() or '.help lists them'}"
        )
    else:
        session.say("\n".join(filter(None, (f"{command.line}: {command.summary}", command.doc))))


COMMANDS = (
    DotCommand(
        ".help",
        "[NAME]",
        "this list, or more about one of them",
        "session",
        _help,
        overtakes=True,
        complete=lambda _, begun: (one for one in dot_commands() if one.startswith(begun)),
    ),
)
