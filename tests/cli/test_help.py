"""`yarc --help` and `yarc robot --help` list every command in one section, and align all summaries."""

import re
from importlib import import_module
from pathlib import Path

import pytest
from click.testing import CliRunner

import yarclang.cli.commands
from yarclang.cli.yarc import main as yarc

MOST = 10
"""Largest number of commands in a section that can be taken in at a glance."""

MODULES = {
    path.stem for path in Path(yarclang.cli.commands.__file__).parent.glob("*.py") if path.stem != "__init__"
}


def sections(*words):
    """Return for each section of --help its commands, with the columns where their summaries begin."""
    done = CliRunner().invoke(yarc, [*words, "--help"])
    assert done.exit_code == 0, done.output
    found = {}
    for line in done.output.splitlines():
        if heading := re.fullmatch(r"(\S.*):", line):
            found[heading[1]] = []
        elif command := re.match(r"  ([a-z]+)( +)\S", line):
            found[list(found)[-1]].append((command[1], command.end(2)))
    return {title: rows for title, rows in found.items() if title != "Options" and rows}


@pytest.mark.parametrize(("words", "prefix"), [((), ""), (("robot",), "robot_")])
def test_each_command_stands_in_one_section(words, prefix):
    names = [name for rows in sections(*words).values() for name, _ in rows]
    assert len(names) == len(set(names))
    modules = {each for each in MODULES if hasattr(import_module(f"yarclang.cli.commands.{each}"), "command")}
    expected = {
        each.removeprefix(prefix).rstrip("_")
        for each in modules
        if (each.startswith(prefix) if prefix else "_" not in each.rstrip("_"))
    }
    assert set(names) == expected


def test_sections_are_short_and_in_one_column():
    found = sections()
    assert list(found) == [
        "Programs",
        "Looking at programs",
        "Running",
        "Robots and controllers",
        "Teaching and serving",
        "Import and export",
        "Editors and shells",
        "Proving the compiler",
    ]
    assert all(len(rows) <= MOST for rows in found.values())
    assert len({column for rows in found.values() for _, column in rows}) == 1


def test_the_compiler_is_named():
    shown = " ".join(CliRunner().invoke(yarc, ["--help"]).output.split())
    assert "`yarcc` compiles programs" in shown


def test_a_command_of_any_section_is_suggested():
    done = CliRunner().invoke(yarc, ["repel"])
    assert done.exit_code == 2
    assert "Did you mean repl?" in done.output
