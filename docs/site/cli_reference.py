"""Make the reference of the commands from the commands themselves."""

import inspect
import re

import click

from yarclang.cli.lazy import LazyGroup
from yarclang.cli.yarc import main as yarc
from yarclang.cli.yarcc import main as yarcc


def cli_page() -> str:
    """Return the page: yarcc, then the commands of yarc in the sections of its --help."""
    lines = [
        "# Commands",
        "",
        (
            "This page is made from the commands themselves; `yarc COMMAND --help` prints the same. "
            "Exit status: 0 without errors, 1 with errors, 2 if the command line is wrong."
        ),
        "",
        "## yarcc",
        "",
        *described(yarcc, click.Context(yarcc, info_name="yarcc")),
    ]
    top = click.Context(yarc, info_name="yarc")
    assert isinstance(yarc, LazyGroup)
    for section, names in yarc.commands_by_section.items():
        lines += [f"## {section}", ""]
        for name in names:
            lines += entry(yarc, name, top)
    return "\n".join(lines)


def entry(group: click.Group, name: str, above: click.Context) -> list[str]:
    """Return the lines of a command, and of its own commands if it is a group."""
    command = group.get_command(above, name)
    assert command is not None
    context = click.Context(command, info_name=name, parent=above)
    lines = [f"### {context.command_path}", "", *described(command, context)]
    if isinstance(command, click.Group):
        for inner in command.list_commands(context):
            lines += entry(command, inner, context)
    return lines


def described(command: click.Command, context: click.Context) -> list[str]:
    """Return usage, description and options of a command."""
    usage = " ".join([context.command_path, *command.collect_usage_pieces(context)])
    lines = ["```text", usage, "```", "", *paragraphs(command.help or ""), ""]
    records = [
        record
        for each in command.get_params(context)
        if isinstance(each, click.Option) and (record := each.get_help_record(context))
    ]
    options = [(declared, text) for declared, text in records if "--help" not in declared]
    if options:
        lines += ["| option | what it does |", "|---|---|"]
        lines += [f"| {code(declared)} | {prose(text)} |" for declared, text in options]
        lines.append("")
    return lines


def paragraphs(text: str) -> list[str]:
    """Return a help text as Markdown. Paragraphs that click doesn't rewrap become blocks of plain text."""
    lines: list[str] = []
    for paragraph in inspect.cleandoc(text.split("\f", maxsplit=1)[0]).split("\n\n"):
        if paragraph.startswith("\b\n"):
            lines += ["```text", paragraph[2:], "```", ""]
        else:
            lines += [prose(paragraph), ""]
    return lines


def code(text: str) -> str:
    """Return a text as inline code. In Python-Markdown, a bar in code doesn't divide cells of a table."""
    return f"`{text}`"


def prose(text: str) -> str:
    """Return a text on one line with all special characters of Markdown escaped, except in backticks."""
    flat = " ".join(text.split())
    parts = re.split(r"(`[^`]*`)", flat)
    return "".join(
        part if part.startswith("`") else re.sub(r"([\\*_\[\]|])", r"\\\1", part.replace("<", "&lt;"))
        for part in parts
    )
