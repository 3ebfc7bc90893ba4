"""Writes the TextMate grammar and the snippets of editors/vscode, and Vim's syntax file, from the words of
the language: `python editors/grammar.py`.

The tests compare the files with what this makes, so that a new command, profile or unit is never missing.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from yarclang.assist.vocabulary import DECLARED, action_entries
from yarclang.commands.registry import commands
from yarclang.highlight.words import words

VSCODE = Path(__file__).parent / "vscode"
GRAMMAR = VSCODE / "syntaxes" / "yarc.tmLanguage.json"
SNIPPETS = VSCODE / "snippets" / "yarc.json"
VIM = Path(__file__).parent / "neovim" / "syntax" / "yarc.vim"

_BEFORE, _BEHIND = r"(?<![A-Za-z0-9_.$])", r"(?![A-Za-z0-9_.])"
_NOT_IN_CODE = r"[^\t -~]|[#&':?@\\^`{|}~]"
"""What is no part of any word or sign, but in comments and texts."""

_NUMBER = r"(?:[0-9]+(?:\.(?!\.)[0-9]*)?|(?<!\.)\.[0-9]+)(?:[eE][+-]?[0-9]+)?(?![A-Za-z_])"


def grammar() -> dict[str, Any]:
    """The TextMate grammar: a line's own words first, then what may stand anywhere.

    Themes colour its scopes as they colour the kinds that the language server gives words, so that nothing
    changes its colour when the server has started.
    """
    known = words()
    units = _any(known.units)
    anywhere = [
        _rule("comment.line.exclamation", "!.*$"),
        _rule("string.quoted.double", '"[^"]*(?:"|$)'),
        {
            "match": rf"(?i)(?<!\$)\((?:\s*{units}\s*)(?:,\s*{units}\s*)*\)",
            "captures": {"0": {"patterns": [_rule("support.type.unit", rf"(?i){_BEFORE}{units}{_BEHIND}")]}},
        },
        _rule("entity.name.namespace.frame", r'\{[^{}!"]*\}'),
        _rule("variable.other", r"\$[A-Za-z_][A-Za-z0-9_.]*"),
        {
            "match": rf"(?i){_BEFORE}({_any(known.commands)})((?:_{_any(known.suffixes)})*){_BEHIND}",
            "captures": {"1": _named("support.function"), "2": _named("support.function.suffix")},
        },
        _rule("support.function.builtin", rf"(?i){_BEFORE}{_any(known.functions)}(?=\s*\()"),
        _rule("keyword.control.option", rf"(?i){_BEFORE}{_any(known.options)}{_BEHIND}"),
        _rule("keyword.control.operator.word", rf"(?i){_BEFORE}{_any(known.operators)}{_BEHIND}"),
        _rule("constant.language", rf"(?i){_BEFORE}{_any((*known.constants, 'MIN', 'V'))}{_BEHIND}"),
        _rule("constant.numeric", rf"(?:(?<![A-Za-z0-9_.])|(?<=\.\.)){_NUMBER}"),
        _rule("keyword.operator", r"\.\.|<>|<=|>=|\*\*|[-+*/%=<>]"),
        _rule("invalid.illegal", rf"{_NOT_IN_CODE}|\$(?!\()"),
    ]
    first = [
        {"match": r"(?i)^\s*(P[0-9]+)(?![A-Za-z0-9_.])", "captures": {"1": _named("entity.name.label")}},
        {
            "match": rf"(?i)^\s*({_any(known.blocks)}){_BEHIND}",
            "captures": {"1": _named("keyword.control")},
        },
        {
            "match": rf"(?i)^\s*({_any(known.declarations)}){_BEHIND}",
            "captures": {"1": _named("keyword.control.declaration")},
        },
    ]
    return {
        "name": "YARC",
        "scopeName": "source.yarc",
        "fileTypes": ["yarc"],
        "patterns": [*first, *anywhere],
    }


def snippets() -> dict[str, Any]:
    """A snippet for each command and declaration: its first example, with the numbers and names to fill
    in.
    """
    made: dict[str, Any] = {}
    for spec in commands().values():
        made[spec.name] = _snippet(spec.name, spec.examples[0].splitlines()[0], spec.summary)
    for word, entry in {**action_entries(), **DECLARED}.items():
        if not entry.example or word in {"END", "ELSE"}:
            continue
        line = f"P0010 {entry.example}" if word in action_entries() else entry.example
        made[word] = _snippet(word, line, entry.summary)
        if word in words().blocks:
            made[word]["body"] += ["  $0", "END"]
    return made


def vim_syntax() -> str:
    """The syntax file of Vim and Neovim. A later rule goes before an earlier one where both match."""
    known = words()
    behind = r"%([A-Za-z0-9_.])@!"
    commands_ = rf"{_any_in_vim(known.commands)}%(_{_any_in_vim(known.suffixes)})*{behind}"
    units = rf"\s*{_any_in_vim(known.units)}\s*"
    lines = [
        '" Made by editors/grammar.py.',
        "if exists('b:current_syntax')",
        "  finish",
        "endif",
        "syntax case ignore",
        f"syntax keyword yarcOption {' '.join(known.options)}",
        f"syntax keyword yarcOperator {' '.join(known.operators)}",
        f"syntax keyword yarcFunction {' '.join(known.functions)}",
        f"syntax keyword yarcConstant {' '.join((*known.constants, 'V'))}",
        r"syntax match yarcNumber /\v<\d+%(\.\d*)?%(e[+-]?\d+)?>/",
        r"syntax match yarcVariable /\v\$[A-Za-z_][A-Za-z0-9_.]*/",
        rf"syntax match yarcUnit /\v\$@<!\({units}%(,{units})*\)/",
        rf"syntax match yarcCommand /\v%([A-Za-z0-9_.$])@<!{commands_}/",
        r"syntax match yarcIndex /\v^\s*P\d+>/",
        rf"syntax match yarcBlock /\v^\s*{_any_in_vim(known.blocks)}{behind}/",
        rf"syntax match yarcDeclaration /\v^\s*{_any_in_vim(known.declarations)}{behind}/",
        r"syntax match yarcForeign /[^\t -~]/",
        r"""syntax match yarcFrame /{[^{}!"]*}/""",
        r"""syntax match yarcString /"[^"]*"\=/""",
        "syntax match yarcComment /!.*$/ contains=@Spell",
        *(
            f"highlight default link yarc{kind} {group}"
            for kind, group in {
                "Block": "Conditional",
                "Command": "Function",
                "Comment": "Comment",
                "Constant": "Constant",
                "Declaration": "StorageClass",
                "Foreign": "Error",
                "Frame": "Identifier",
                "Function": "Function",
                "Index": "Label",
                "Number": "Number",
                "Operator": "Operator",
                "Option": "Keyword",
                "String": "String",
                "Unit": "Type",
                "Variable": "Identifier",
            }.items()
        ),
        "let b:current_syntax = 'yarc'",
    ]
    return "\n".join(lines) + "\n"


def text_of(content: dict[str, Any]) -> str:
    """As it stands in the file."""
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"


def main() -> None:
    """Write all files."""
    for path, content in ((GRAMMAR, grammar()), (SNIPPETS, snippets())):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text_of(content), encoding="utf-8")
    VIM.parent.mkdir(parents=True, exist_ok=True)
    VIM.write_text(vim_syntax(), encoding="utf-8")


def _any(names: tuple[str, ...]) -> str:
    return f"(?:{'|'.join(names)})"


def _any_in_vim(names: tuple[str, ...]) -> str:
    return f"%({'|'.join(names)})"


def _named(scope: str) -> dict[str, str]:
    return {"name": f"{scope}.yarc"}


def _rule(scope: str, match: str) -> dict[str, str]:
    return {"name": f"{scope}.yarc", "match": match}


def _snippet(word: str, line: str, summary: str) -> dict[str, Any]:
    """Numbers of a line become places to type in."""
    count = 0

    def hole(match: re.Match[str]) -> str:
        nonlocal count
        count += 1
        return f"${{{count}:{match[0]}}}"

    code = line.partition("!")[0].rstrip().replace("$", r"\$")
    body = re.sub(r"(?<![A-Za-z0-9_.])-?\d+(?:\.\d+)?(?![A-Za-z0-9_.])", hole, code)
    body = re.sub(r"\{(?!\d+:)([A-Z_]+)\}", lambda match: "{" + match[1] + r"\}", body)
    return {"prefix": [word], "body": [body], "description": summary}


if __name__ == "__main__":
    main()
