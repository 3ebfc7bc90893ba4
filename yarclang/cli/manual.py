"""Manual pages, created from the commands' help texts, arguments and options, as man(7) text.

A page contains nothing that depends on the date, the terminal or the computer, so that the same version
always gives the same bytes.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Iterator

import click

from yarclang.cli.lazy import LazyGroup

_EXIT = (
    ("0", "Success: the programs have no error, the run came to its end, the two programs are equal."),
    ("1", "A program has an error, or the command failed; the message names the cause and the remedy."),
    ("2", "The command was called with wrong options or arguments."),
)
_FURTHER = {
    "yarc verify": (("3", "All checked properties hold, but some weren't checked: they are listed."),)
}
_SPECIAL = re.compile(r"([\\-])")


def manual_pages(root: click.Command, name: str, version: str) -> Iterator[tuple[str, str]]:
    """Yield the manual pages of a command: the file name, such as `yarc-robot-new.1`, and the text.

    Args:
        root: the command. If it is a group, all of its commands have a page.
        name: name of the command as users type it.
        version: version of the program.
    """
    yield from _pages(click.Context(root, info_name=name), version)


def _pages(context: click.Context, version: str) -> Iterator[tuple[str, str]]:
    yield f"{_title(context)}.1", _page(context, version)
    command = context.command
    if isinstance(command, click.Group):
        for name, inner in _commands(context, command):
            yield from _pages(click.Context(inner, info_name=name, parent=context), version)


def _commands(context: click.Context, group: click.Group) -> Iterator[tuple[str, click.Command]]:
    """Yield the commands of a group that --help lists."""
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        if command is not None and not command.hidden:
            yield name, command


def _summary(group: click.Group, name: str, command: click.Command) -> str:
    """Return the summary of a command as it is shown in the --help of its group."""
    listed = group.commands_by_name if isinstance(group, LazyGroup) else {}
    return listed.get(name) or command.get_short_help_str(limit=200)


def _title(context: click.Context) -> str:
    """Return the name of a command's page: `yarc-robot-new`."""
    return context.command_path.replace(" ", "-")


def _page(context: click.Context, version: str) -> str:
    command = context.command
    first, *more = _paragraphs(command.help or "") or [""]
    lines = [
        f'.TH "{_title(context).upper()}" "1" "" "yarclang {version}" "yarclang"',
        ".SH NAME",
        f"{_plain(_title(context))} \\- {_plain(first.rstrip('.'))}",
        ".SH SYNOPSIS",
        f".B {_plain(context.command_path)}",
        _plain(" ".join(command.collect_usage_pieces(context))),
        ".SH DESCRIPTION",
        _plain(first),
    ]
    for paragraph in more:
        lines += [".PP", _plain(paragraph)]
    records = [one.get_help_record(context) for one in command.get_params(context)]
    rows = [row for row in records if row is not None and row[1]]
    if rows:
        lines.append(".SH OPTIONS")
        for option, meaning in rows:
            lines += [".TP", f".B {_plain(option)}", _plain(meaning)]
    if isinstance(command, click.Group):
        lines.append(".SH COMMANDS")
        for name, inner in _commands(context, command):
            lines += [".TP", f".B {_plain(name)}", _plain(_summary(command, name, inner))]
    lines.append(".SH EXIT STATUS")
    for status, meaning in (*_EXIT, *_FURTHER.get(context.command_path, ())):
        lines += [".TP", f".B {status}", _plain(meaning)]
    if others := _others(context):
        lines += [
            ".SH SEE ALSO",
            ",\n".join(f".BR {_plain(one)} (1)" for one in others).replace("(1),", "(1) ,"),
        ]
    return "\n".join(lines) + "\n"


def _others(context: click.Context) -> list[str]:
    """Return the titles of the pages to which a command's page refers: those of its group and of its own
    commands. The pages of yarc and yarcc refer to each other.
    """
    found = [_title(context.parent)] if context.parent is not None else []
    if isinstance(context.command, click.Group):
        found += [f"{_title(context)}-{name}" for name, _ in _commands(context, context.command)]
    if context.parent is None:
        found.append({"yarc": "yarcc", "yarcc": "yarc"}.get(_title(context), ""))
    return [one for one in found if one]


def _paragraphs(help_: str) -> list[str]:
    """Return the paragraphs of a help text, each as one line. A paragraph that is marked as not to be wrapped
    keeps its separate lines.
    """
    text = inspect.cleandoc(help_).partition("\f")[0]
    found = []
    for part in text.split("\n\n"):
        kept = part.startswith("\b")
        rows = [row.rstrip() for row in part.strip("\b\n").split("\n")]
        found.append("\n.br\n".join(rows) if kept else " ".join(row.strip() for row in rows))
    return [one for one in found if one]


def _plain(text: str) -> str:
    """Escape a text for man(7): backslashes and hyphens are escaped, and no line of text begins a request."""
    rows = []
    for row in text.split("\n"):
        if row == ".br":
            rows.append(row)
            continue
        escaped = _SPECIAL.sub(lambda found: "\\e" if found[0] == "\\" else "\\-", row)
        rows.append(f"\\&{escaped}" if escaped[:1] in (".", "'") else escaped)
    return "\n".join(rows)
