"""Who has changed a file, as far as the audit trail knows."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from yarclang.pendant.accounts.people import Deed

PREFIX = "file "
"""With which the deeds begin that change files."""


@dataclass(slots=True)
class Authors:
    """Those who changed a file, the last one first; the hash that it had afterwards, empty if it was deleted, None if nobody did."""

    users: dict[str, None] = field(default_factory=dict)
    sha256: str | None = None


def authors_of(deeds: Iterable[Deed]) -> dict[str, Authors]:
    """Return who changed which files.

    Args:
        deeds: entries of the audit trail, the newest first. One that was refused has an entry before, which doesn't count.
    """
    found: dict[str, Authors] = {}
    refused: Counter[tuple[str, str, str]] = Counter()
    for deed in deeds:
        key = (deed.user, deed.action, deed.detail)
        if deed.outcome != "done":
            refused[key] += 1
        elif refused[key]:
            refused[key] -= 1
        else:
            for file, sha256 in _changed(deed):
                authors = found.setdefault(file, Authors())
                if authors.sha256 is None:
                    authors.sha256 = sha256
                authors.users[deed.user] = None
    return found


def _changed(deed: Deed) -> Iterable[tuple[str, str]]:
    """Yield the paths that a deed has changed, and the hashes of what is there since; "?" if it isn't known."""
    try:
        detail = json.loads(deed.detail)
        file = str(detail["file"])
    except (ValueError, KeyError, TypeError):
        return
    if deed.action == f"{PREFIX}delete":
        yield file, ""
        return
    yield file, str(detail.get("sha256", "?"))
    if deed.action == f"{PREFIX}rename" and "from" in detail:
        yield str(detail["from"]), ""
