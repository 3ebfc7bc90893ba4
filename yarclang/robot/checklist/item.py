"""A point of the checklist."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from yarclang.frozen import frozen

Verdict = Literal["ok", "note", "to do"]


@frozen
class Item:
    """One point: `subject` is what was looked at, `found` one sentence with figures, `remedy` what to do.

    A `note` is fine as it is but worth knowing; `to do` isn't.
    """

    subject: str
    verdict: Verdict
    found: str
    remedy: str = ""


def listed(names: Sequence[str], most: int = 6) -> str:
    """Names with commas, the last of a long list left out."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
