"""Find circular dependencies between named items, such as frames."""

from __future__ import annotations

from collections.abc import Iterator, Mapping


def circles(parents: Mapping[str, str]) -> Iterator[list[str]]:
    """Yield each circle of dependencies once, as a list of names. `parents` has the parent of each name."""
    seen: set[str] = set()
    for start in parents:
        path: list[str] = []
        here = start
        while here in parents and here not in seen and here not in path:
            path.append(here)
            here = parents[here]
        if here in path:
            yield path[path.index(here) :]
        seen.update(path)
