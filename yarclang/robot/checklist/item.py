"""Define an item of the checklist."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from yarclang.frozen import frozen

Verdict = Literal["ok", "note", "to do"]


@frozen
class Item:
    """One item of the checklist: `subject` is what was checked, `found` is one sentence with figures, and
    `remedy` says what to do.

    The verdict `note` is acceptable but worth knowing; `to do` has to be corrected.
    """

    subject: str
    verdict: Verdict
    found: str
    remedy: str = ""


def listed(names: Sequence[str], most: int = 6) -> str:
    """Return names separated by commas; only the first `most` are listed, the others are counted."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
