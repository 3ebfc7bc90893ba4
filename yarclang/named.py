"""Extensible sets of items with unique names: commands, profiles, findings, rules, robots."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeVar

T = TypeVar("T")


class NamedTwice(ValueError):  # noqa: N818 - the name reads as in the sentence "a finding is named twice"
    """Two items of an extensible set have the same name, so that the second would silently replace the
    first.
    """


def by_name(kind: str, found: Iterable[tuple[str, str, T]]) -> dict[str, T]:
    """Return the items of an extensible set by name, in the given order.

    Args:
        kind: noun for an item, for the message.
        found: name, place (module or folder) and value of each item.

    Raises:
        NamedTwice: two items have the same name.
    """
    places: dict[str, str] = {}
    things: dict[str, T] = {}
    for name, place, thing in found:
        if name in things:
            raise NamedTwice(f"the {kind} {name} stands twice: in {places[name]} and in {place}")
        places[name], things[name] = place, thing
    return things
