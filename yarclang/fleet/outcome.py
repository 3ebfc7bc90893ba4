"""Outcomes of work that has no result."""

from __future__ import annotations

from typing import NamedTuple


class Lost(NamedTuple):
    """Outcome for an item on which no worker could finish the work: all worker processes that tried were
    killed.

    Attributes:
        reason: the reason, as a sentence.
    """

    reason: str


class UnreachableError(Exception):
    """Raised if a scheduler can't be used; the message has the reason and the remedy."""
