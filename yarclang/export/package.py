"""A ROS package as bytes."""

from __future__ import annotations

from yarclang.frozen import frozen


@frozen(eq=False)
class Package:
    """A ROS package in memory.

    Attributes:
        name: its name.
        files: contents of its files, by their paths.
        programs: paths of the files that are executable.
    """

    name: str
    files: dict[str, bytes]
    programs: frozenset[str] = frozenset()
