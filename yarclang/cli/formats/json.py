"""Findings in our own JSON format, which docs/findings.md describes."""

from __future__ import annotations

import json
from collections.abc import Sequence

from yarclang.diagnostics import Diagnostic
from yarclang.report.finding import finding_json


def write(files: Sequence[str], found: Sequence[Diagnostic], *, strict: bool = False) -> str:  # noqa: ARG001 (as the other formats)
    """Return the findings with all of their data."""
    content = {"version": 1, "diagnostics": [finding_json(one) for one in found]}
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"
