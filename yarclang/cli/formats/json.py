"""JSON of our own: docs/findings.md describes it."""

from __future__ import annotations

import json
from collections.abc import Sequence

from yarclang.diagnostics import Diagnostic
from yarclang.report.finding import finding_json


def write(files: Sequence[str], found: Sequence[Diagnostic], *, strict: bool = False) -> str:  # noqa: ARG001 (as the other formats)
    """The findings with all that is known of them."""
    content = {"version": 1, "diagnostics": [finding_json(one) for one in found]}
    return json.dumps(content, indent=2, ensure_ascii=False) + "\n"
