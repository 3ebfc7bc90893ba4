"""SARIF 2.1.0 (OASIS, 27 March 2020), for code scanning by GitHub, GitLab and Azure."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, metadata
from pathlib import PurePath
from typing import Any
from urllib.parse import quote

from yarclang import __version__
from yarclang.cli.formats import path_of
from yarclang.diagnostics import Diagnostic, Fix, Within
from yarclang.findings import Finding
from yarclang.findings.finding import page
from yarclang.lint.registry import everything
from yarclang.report.finding import told_text
from yarclang.source import Span

SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"


def write(files: Sequence[str], found: Sequence[Diagnostic], *, strict: bool = False) -> str:  # noqa: ARG001 (as the other formats)
    """Return one run, with the rules of all reported findings."""
    codes = sorted({one.code for one in found})
    pages = addresses()
    driver: dict[str, Any] = {
        "name": "yarc check",
        "version": __version__,
        "rules": [_rule(everything()[code], pages.get("documentation", "")) for code in codes],
    }
    if "homepage" in pages:
        driver["informationUri"] = pages["homepage"]
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "artifacts": [{"location": {"uri": _uri(file)}} for file in files],
        "results": _results(found, codes),
    }
    return (
        json.dumps({"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2, ensure_ascii=False)
        + "\n"
    )


@cache
def addresses() -> dict[str, str]:
    """Return the project's public addresses by their labels in lower case. They come from the installed
    package; empty if it has none.
    """
    try:
        named = metadata("yarclang").get_all("Project-URL") or []
    except PackageNotFoundError:  # the source tree isn't installed
        return {}
    pairs = (one.partition(",") for one in named)
    return {label.strip().lower(): address.strip() for label, _, address in pairs}


def _rule(finding: Finding, documentation: str) -> dict[str, Any]:
    text = finding.why
    for title, lines in (("For example", finding.example), ("Better", finding.better)):
        if lines:
            text += f"\n\n{title}:\n\n{lines}"
    page_of = {"helpUri": f"{documentation.rstrip('/')}/findings#{finding.anchor}"}
    return (page_of if documentation else {}) | {
        "id": finding.code,
        "name": "".join(part.capitalize() for part in finding.name.split("-")),
        "shortDescription": {"text": f"{finding.title}."},
        "fullDescription": {"text": finding.why},
        "help": {"text": text, "markdown": page(finding)},
        "defaultConfiguration": {"level": finding.severity},
    }


def _results(found: Sequence[Diagnostic], codes: Sequence[str]) -> list[dict[str, Any]]:
    """Return findings as results of SARIF. Each has a fingerprint that doesn't change if its line moves."""
    seen: Counter[str] = Counter()
    results = []
    for one in found:
        result = _result(one, codes.index(one.code))
        line = one.source.line(one.span.line).strip() if one.source and one.span else ""
        what = f"{one.code}\n{path_of(one)}\n{line}"
        seen[what] += 1
        mark = hashlib.sha256(f"{what}\n{seen[what]}".encode()).hexdigest()[:32]
        results.append(result | {"partialFingerprints": {"codeAndLine/v1": mark}})
    return results


def _result(one: Diagnostic, rule: int) -> dict[str, Any]:
    result: dict[str, Any] = {
        "ruleId": one.code,
        "ruleIndex": rule,
        "level": one.severity,
        "message": {"text": told_text(one)},
    }
    if one.source is None:
        return result
    artifact = {"uri": _uri(path_of(one))}
    place: dict[str, Any] = {"artifactLocation": artifact}
    if one.shown_at is not None:
        place["region"] = _region(one.shown_at)
    result["locations"] = [{"physicalLocation": place}]
    if one.fix is not None:
        result["fixes"] = [_fix(one.fix, artifact)]
    if one.within is not None:
        result["relatedLocations"] = [_related(one.within)]
        if one.within.fix is not None:
            result["fixes"] = [_fix(one.within.fix, {"uri": _uri(one.within.source.name)})]
    return result


def _fix(fix: Fix, artifact: dict[str, str]) -> dict[str, Any]:
    replacements = [
        {"deletedRegion": _region(edit.span), "insertedContent": {"text": edit.text}} for edit in fix.edits
    ]
    changes = [{"artifactLocation": artifact, "replacements": replacements}]
    return {"description": {"text": fix.title}, "artifactChanges": changes}


def _related(within: Within) -> dict[str, Any]:
    """Return the place in a module that causes a finding, as a related location of SARIF. An installed module
    has a name instead of a file of this project.
    """
    place: dict[str, Any] = {"id": 1, "message": {"text": within.text}}
    if within.source.is_installed:
        return {**place, "logicalLocations": [{"name": within.source.module, "kind": "module"}]}
    artifact = {"uri": _uri(within.source.name)}
    return {**place, "physicalLocation": {"artifactLocation": artifact, "region": _region(within.span)}}


def _region(span: Span) -> dict[str, int]:
    """Return a span as a region of SARIF. In both, lines and columns count from 1, and the end column is
    after the last character.
    """
    return {
        "startLine": span.line,
        "startColumn": span.column,
        "endLine": span.end_line,
        "endColumn": span.end_column,
    }


def _uri(path: str) -> str:
    """Return a relative path as a URI reference, and an absolute path as a file URI."""
    pure = PurePath(path)
    return pure.as_uri() if pure.is_absolute() else quote(pure.as_posix())
