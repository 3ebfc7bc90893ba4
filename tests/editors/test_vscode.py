"""Tests of the extension for Visual Studio Code: its grammar agrees with the Pygments lexer, and the package
can be built.
"""

import json
import random
import runpy
import subprocess
import zipfile

import pytest
from conftest import EXAMPLES, HERE
from pygments.token import Comment, Error, Keyword, Name, Number, Operator, Punctuation, String, Text

from yarclang.commands.registry import commands
from yarclang.highlight.lexer import YarcLexer

VSCODE = HERE.parent / "editors" / "vscode"
MADE = runpy.run_path(str(VSCODE.parent / "grammar.py"))
PROGRAMS = sorted(EXAMPLES.glob("*.yarc"))
SCOPES = {
    Error: "invalid.illegal",
    Comment.Single: "comment.line.exclamation",
    Keyword: "keyword.control",
    Keyword.Constant: "constant.language",
    Keyword.Declaration: "keyword.control.declaration",
    Keyword.Pseudo: "keyword.control.option",
    Keyword.Type: "support.type.unit",
    Name: "source",
    Name.Builtin: "support.function.builtin",
    Name.Decorator: "support.function.suffix",
    Name.Function: "support.function",
    Name.Label: "entity.name.label",
    Name.Namespace: "entity.name.namespace.frame",
    Name.Variable: "variable.other",
    Number: "constant.numeric",
    Operator: "keyword.operator",
    Operator.Word: "keyword.control.operator.word",
    Punctuation: "source",
    String.Double: "string.quoted.double",
}
"""Scope names of the grammar for the token types of the lexer."""


@pytest.mark.parametrize(("path", "make"), [("GRAMMAR", "grammar"), ("SNIPPETS", "snippets")])
def test_files_have_the_words_of_today(path, make, rewrite_golden):
    text = MADE["text_of"](MADE[make]())
    if rewrite_golden:
        MADE[path].write_text(text, encoding="utf-8")
    assert MADE[path].read_text(encoding="utf-8") == text


def test_every_command_has_a_snippet():
    assert set(commands()) <= set(MADE["snippets"]())


def test_no_address_is_recorded():
    lock = (VSCODE / "package-lock.json").read_text()
    assert '"resolved"' not in lock
    assert "registry" not in lock


def compare(paths, vscode, tool):
    """Check that the grammar and the lexer give the same tokens for each line of the files."""
    run = subprocess.run(
        [tool("node"), "test/tokens.js", *map(str, paths)],
        cwd=vscode,
        capture_output=True,
        text=True,
        check=True,
    )
    for path, lines in zip(paths, json.loads(run.stdout), strict=True):
        for number, (line, pieces) in enumerate(zip(path.read_text().split("\n"), lines, strict=True), 1):
            by_grammar = ["source"] * len(line)
            for start, end, scope in pieces:
                by_grammar[start:end] = [scope] * (end - start)
            for start, kind, piece in YarcLexer().get_tokens_unprocessed(line):
                if kind is not Text.Whitespace:
                    found = {by_grammar[start + at] for at, one in enumerate(piece) if one not in " \t"}
                    assert found == {SCOPES[kind]}, f"{path.name}:{number}: {piece!r} in {line!r}"


def test_both_lexers_say_the_same(vscode, tool):
    compare(PROGRAMS, vscode, tool)


SIGNS = [
    *"!\"{}[]()$;,%=<>*-+/#?'@\\^|~:&",
    "{TCP}",
    "{!",
    '"a',
    " 12 ",
    " TCP ",
    "$A ",
    "$(",
    " ",
    "\u00a0",
    "\u2003",
    "\u2028",
    "ä",
    "\u2212",
    "\x0b",
]


def test_both_lexers_part_broken_lines_alike(vscode, tool, tmp_path):
    """Both lexers agree on what is a comment, a string, a frame or an error, even in broken lines."""
    draw = random.Random(7)
    lines = ["".join(draw.choices(SIGNS, k=draw.randint(1, 8))) for _ in range(3_000)]
    (tmp_path / "a.yarc").write_text("\n".join(["DEFAULT {!TCP} [5] (mm,deg,s) {B}", *lines]))
    compare([tmp_path / "a.yarc"], vscode, tool)


def test_its_own_tests_pass(vscode, tool):
    run = subprocess.run([tool("npm"), "test"], cwd=vscode, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr


def test_a_vsix_is_made(vscode, tool):
    run = subprocess.run(
        [tool("npm"), "run", "package"], cwd=vscode, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr
    with zipfile.ZipFile(vscode / "yarc.vsix") as package:
        names = set(package.namelist())
        manifest = json.loads(package.read("extension/package.json"))
        bundle = package.read("extension/out/extension.js").decode()
    contributes = manifest["contributes"]
    # the language server offers the snippets; here they would appear twice
    assert "snippets" not in contributes
    paths = ["snippets/yarc.json", *(one["path"] for one in contributes["grammars"])]
    paths += [one["configuration"] for one in contributes["languages"]] + [manifest["main"]]
    paths += [manifest["icon"], "README.md", "CHANGELOG.md"]
    paths += [step["media"]["markdown"] for walk in contributes["walkthroughs"] for step in walk["steps"]]
    # the package has the names of its two pages in lower case
    there = {one.lower() for one in names}
    assert {f"extension/{one.removeprefix('./')}".lower() for one in paths} <= there
    known = {one["command"] for one in contributes["commands"]}
    for walk in contributes["walkthroughs"]:
        for step in walk["steps"]:
            assert {one.removeprefix("onCommand:") for one in step.get("completionEvents", ())} <= known
    assert not any("node_modules" in name for name in names)
    for one in contributes["commands"]:
        assert one["command"] in bundle
