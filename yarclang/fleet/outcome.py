"""Outcomes of work other than its results."""

from __future__ import annotations

from typing import NamedTuple


class Lost(NamedTuple):
    """Outcome of an item whose work killed its workers.

    Attributes:
        reason: what happened, as a sentence.
    """

    reason: str


class UnreachableError(Exception):
    """A scheduler that can't be used: the message says why, and what to do."""
