"""Users who have changed a file, according to the audit trail."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field

from yarclang.pendant.accounts.people import Deed

PREFIX = "file "
"""Prefix of the names of actions that change files."""


@dataclass(slots=True)
class Authors:
    """Users who changed a file at the pendant.

    Attributes:
        users: names of the users who changed the file, the most recent one first.
        sha256: SHA-256 of the file after the last of these changes; empty if the file was deleted, None if
            nobody changed the file.
    """

    users: dict[str, None] = field(default_factory=dict)
    sha256: str | None = None


def authors_of(deeds: Iterable[Deed]) -> dict[str, Authors]:
    """Return the authors of each file, by the file's path in the project.

    Args:
        deeds: entries of the audit trail, newest first. A refused action has two entries, its own and that of
            the refusal. Both are ignored.
    """
    by_file: dict[str, Authors] = {}
    refused: Counter[tuple[str, str, str]] = Counter()
    for deed in deeds:
        key = (deed.user, deed.action, deed.detail)
        if deed.outcome != "done":
            refused[key] += 1
        elif refused[key]:
            refused[key] -= 1
        else:
            for file, sha256 in _changed(deed):
                authors = by_file.setdefault(file, Authors())
                if authors.sha256 is None:
                    authors.sha256 = sha256
                authors.users[deed.user] = None
    return by_file


def _changed(deed: Deed) -> Iterable[tuple[str, str]]:
    """Yield the paths that an action has changed, each with the SHA-256 of the new content. The hash is empty
    if the file was removed or moved, and "?" if it is unknown.
    """
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
