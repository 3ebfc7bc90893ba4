"""Registry of all lint rules, the RULE of each file in lint/rules, and the catalogue of all findings."""

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
from yarclang.named import by_name


@cache
def rules() -> tuple[Rule[Any], ...]:
    """Return the lint rules in the order of their codes."""
    return tuple(rule for _, rule in _placed())


def _placed() -> list[tuple[str, Rule[Any]]]:
    """Return the rules with the names of their modules, in the order of their codes."""
    modules = [f"{folder.__name__}.{module.name}" for module in iter_modules(folder.__path__)]
    found: list[tuple[str, Rule[Any]]] = [(name, import_module(name).RULE) for name in sorted(modules)]
    return sorted(found, key=lambda one: one[1].finding.code)


@cache
def everything() -> Mapping[str, Finding]:
    """Return the findings of the language and of the rules by their codes.

    Raises:
        NamedTwice: two findings share a code or a name.
    """
    placed = [("yarclang.findings", finding) for finding in CATALOGUE.values()]
    placed += [(place, rule.finding) for place, rule in _placed()]
    by_name("finding", ((finding.name, place, finding) for place, finding in placed))
    found = by_name("finding", ((finding.code, place, finding) for place, finding in placed))
    return MappingProxyType(dict(sorted(found.items())))


def codes_of(word: str) -> tuple[str, ...]:
    """Return the codes of the findings that a word selects: a code (Y0611), the beginning of codes (Y06), or
    a name (slow-motion). Empty for an unknown word.
    """
    upper = word.strip().upper()
    if upper.startswith("Y") and upper[1:].isdigit():
        return tuple(code for code in everything() if code.startswith(upper))
    code = _by_name().get(word.strip().lower())
    return (code,) if code is not None else ()


@cache
def _by_name() -> Mapping[str, str]:
    """Return the code of each finding by its name."""
    return {finding.name: code for code, finding in everything().items()}
