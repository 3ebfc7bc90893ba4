"""A package of ROS as bytes."""

from __future__ import annotations

from yarclang.frozen import frozen


@frozen(eq=False)
class Package:
    """The package `name`: `files` by their paths in it, and which of them are programs."""

    name: str
    files: dict[str, bytes]
    programs: frozenset[str] = frozenset()
