"""Define an item of the checklist."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from yarclang.frozen import frozen

Verdict = Literal["ok", "note", "to do"]


@frozen
class Item:
    """One item of the checklist.

    Attributes:
        subject: what was checked.
        verdict: `ok`; `note` for an observation that is acceptable but worth knowing; or `to do` for a
            problem that has to be corrected.
        found: the observation, one sentence with figures.
        remedy: what to do.
    """

    subject: str
    verdict: Verdict
    found: str
    remedy: str = ""


def listed(names: Sequence[str], most: int = 6) -> str:
    """Return at most `most` names, separated by commas, and the number of the remaining names."""
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "")
