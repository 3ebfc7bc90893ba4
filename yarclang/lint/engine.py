"""Asks the rules: each of them, about what it reads, as far as that is there."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from typing import Any

from yarclang.diagnostics import Diagnostic, grouped
from yarclang.lint.registry import rules
from yarclang.lint.rule import Rule, Surroundings


def lint(
    products: Iterable[object],
    surroundings: Surroundings,
    found: Collection[Diagnostic],
    silent: Collection[str] = (),
) -> tuple[Diagnostic, ...]:
    """What the rules say of a program.

    Args:
        products: the stages' results that there are, of the types that rules read.
        surroundings: what every rule may know.
        found: what the stages have found already; rules don't speak of commands that have errors.
        silent: codes of the rules that needn't be asked.
    """
    by_type = {type(product): product for product in products}
    asked = [rule for rule in rules() if rule.reads in by_type and rule.finding.code not in silent]
    failed = {
        (one.source.name if one.source else "", line)
        for one in found
        if one.is_error and one.span is not None
        for line in range(one.span.line, one.span.end_line + 1)
    }
    said: list[Diagnostic] = []
    for rule in asked:
        said += _remarks(rule, by_type[rule.reads], surroundings, failed)
    return grouped(said)


def _remarks(
    rule: Rule[Any], product: object, surroundings: Surroundings, failed: Collection[tuple[str, int]]
) -> Iterator[Diagnostic]:
    own = surroundings.module.source
    for one in rule.look(product, surroundings):
        source = one.source or own
        if source.name != own.name:
            continue  # each file is spoken of when it is checked itself
        if not rule.explains_errors and (source.name, one.span.line) in failed:
            continue
        yield Diagnostic(
            rule.finding.code,
            one.message,
            source,
            one.span,
            one.help,
            one.fix,
            one.place,
            rule.finding.severity,
        )
