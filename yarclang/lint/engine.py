"""Run the lint rules on the results of those stages of the compiler that could run."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any

from yarclang.diagnostics import Diagnostic, grouped
from yarclang.lint.registry import rules
from yarclang.lint.rule import Remark, Rule, Surroundings
from yarclang.progress import each, go_on
from yarclang.source import SourceFile

Remarks = Mapping[Rule[Any], tuple[Remark, ...]]
"""The remarks of each rule."""


def lint(
    products: Iterable[object],
    surroundings: Surroundings,
    found: Collection[Diagnostic],
    silent: Collection[str] = (),
) -> tuple[Diagnostic, ...]:
    """Check a program by all lint rules, and return their findings.

    Args:
        products: the available results of the compiler's stages, of the types that rules read.
        surroundings: context for every rule.
        found: findings of the stages. Rules skip commands with errors, unless they explain errors.
        silent: codes of rules that are not run.
    """
    return findings_of(remarks(products, surroundings, silent), surroundings, found)


def remarks(products: Iterable[object], surroundings: Surroundings, silent: Collection[str]) -> Remarks:
    """Run the lint rules that read these results of the compiler's stages, and return their remarks. The
    arguments are those of `lint`.
    """
    by_type = {type(product): product for product in products}
    said: dict[Rule[Any], tuple[Remark, ...]] = {}
    for rule in rules():
        if rule.reads in by_type and rule.finding.code not in silent:
            go_on()
            said[rule] = tuple(each(rule.look(by_type[rule.reads], surroundings)))
    return said


def findings_of(
    said: Remarks, surroundings: Surroundings, found: Collection[Diagnostic]
) -> tuple[Diagnostic, ...]:
    """Convert the remarks of lint rules to findings.

    Args:
        said: the remarks.
        surroundings: context for every rule.
        found: findings of the compiler's stages; remarks on commands with errors are dropped, unless they
            explain errors.
    """
    failed = {
        (one.source.name if one.source else "", line)
        for one in each(found)
        if one.is_error and one.span is not None
        for line in range(one.span.line, one.span.end_line + 1)
    }
    own = surroundings.module.source
    diagnostics: list[Diagnostic] = []
    for rule in rules():
        for one in each(said.get(rule, ())):
            source = one.source or own
            if source.name != own.name:
                continue  # findings of a module are reported when the module itself is checked
            if not rule.explains_errors and (source.name, one.span.line) in failed:
                continue
            diagnostics.append(_finding(rule, one, source))
    return grouped(diagnostics)


def _finding(rule: Rule[Any], one: Remark, source: SourceFile) -> Diagnostic:
    finding = rule.finding
    return Diagnostic(
        finding.code, one.message, source, one.span, one.help, one.fix, one.place, finding.severity
    )
