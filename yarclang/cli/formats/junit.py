"""Write findings as JUnit XML: each file is a test suite, and each finding a test case. Findings that aren't
failures become output.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from xml.sax.saxutils import escape, quoteattr

from yarclang.cli.formats import path_of
from yarclang.diagnostics import Diagnostic

_NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def write(files: Sequence[str], found: Sequence[Diagnostic], *, strict: bool = False) -> str:
    """Return findings as JUnit XML: one test suite for each checked file, followed by the suites for findings
    in other files and for findings without a file.
    """
    by_file: dict[str, list[Diagnostic]] = {("<stdin>" if file == "-" else file): [] for file in files}
    for one in found:
        by_file.setdefault(path_of(one) or "yarc check", []).append(one)
    suites = [_suite(file, said, strict) for file, said in by_file.items()]
    failures = sum(_fails(one, strict) for one in found)
    tests = sum(max(1, len(said)) for said in by_file.values())
    head = f'<testsuites name="yarc check" tests="{tests}" failures="{failures}" errors="0" time="0">'
    return "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', head, *suites, "</testsuites>", ""])


def _suite(file: str, found: list[Diagnostic], strict: bool) -> str:
    failures = sum(_fails(one, strict) for one in found)
    head = (
        f'  <testsuite name={_attribute(file)} tests="{max(1, len(found))}" failures="{failures}" '
        'errors="0" skipped="0" time="0">'
    )
    cases = [_case(file, one, strict) for one in found]
    if not found:
        cases = [f'    <testcase classname={_attribute(file)} name="no problems found" time="0"/>']
    return "\n".join([head, *cases, "  </testsuite>"])


def _case(file: str, one: Diagnostic, strict: bool) -> str:
    place = f"{one.span.line}:{one.span.column} " if one.span else ""
    name = _attribute(f"{place}{one.code}")
    within = f"\n{one.within.text}" if one.within is not None else ""
    help_ = f"\nhelp: {one.help}" if one.help else ""
    text = f"{one.severity} {one.code}: {one.message}{within}{help_}"
    body = f"      <system-out>{_text(text)}</system-out>"
    if _fails(one, strict):
        body = (
            f"      <failure type={_attribute(one.code)} "
            f"message={_attribute(one.message)}>{_text(text)}</failure>"
        )
    return f'    <testcase classname={_attribute(file)} name={name} time="0">\n{body}\n    </testcase>'


def _fails(one: Diagnostic, strict: bool) -> bool:
    return one.is_error or (strict and one.severity == "warning")


def _text(text: str) -> str:
    return escape(_NOT_XML.sub("�", text))


def _attribute(text: str) -> str:
    return quoteattr(_NOT_XML.sub("�", text))
