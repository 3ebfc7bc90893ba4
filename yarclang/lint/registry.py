"""All rules: each file of lint/rules that has a RULE; and the catalogue of all that can be found."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType
from typing import Any

from yarclang.findings import CATALOGUE, Finding
from yarclang.lint import rules as folder
from yarclang.lint.rule import Rule


@cache
def rules() -> tuple[Rule[Any], ...]:
    """The rules in the order of their codes."""
    names = sorted(module.name for module in iter_modules(folder.__path__))
    found: list[Rule[Any]] = [import_module(f"{folder.__name__}.{name}").RULE for name in names]
    return tuple(sorted(found, key=lambda rule: rule.finding.code))


@cache
def everything() -> Mapping[str, Finding]:
    """Every finding by its code: those of the language, and those of the rules."""
    found = {**CATALOGUE, **{rule.finding.code: rule.finding for rule in rules()}}
    return MappingProxyType(dict(sorted(found.items())))


def codes_of(word: str) -> tuple[str, ...]:
    """The codes that a word means: a code (Y0611), the beginning of some (Y06), or a name (slow-motion); none where it is unknown."""
    upper = word.strip().upper()
    if upper.startswith("Y") and upper[1:].isdigit():
        return tuple(code for code in everything() if code.startswith(upper))
    return tuple(code for code, finding in everything().items() if finding.name == word.strip().lower())
