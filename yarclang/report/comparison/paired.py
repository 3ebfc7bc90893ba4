"""Pair the commands of two programs. First, commands with the same effect are paired, in their order. Then
the commands between them are paired by the similarity of their ends, places (index in loops and calls) and
names.

An inserted command counts as new, wherever it is. Equal commands are paired even if their indices differ.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from difflib import SequenceMatcher

import numpy as np

from yarclang.pipeline.executed import Act
from yarclang.progress import go_on

Pair = tuple[Act | None, Act | None]

_FINE = 1e-3
"""Grid to which the ends of motions are rounded [rad or m]. Motions with equal rounded ends are paired."""

_MOST_CELLS = 200_000
"""Largest product of the sizes of two groups of commands for which the cheapest pairs are searched. Larger
groups are paired by place.
"""

_ALONE = 0.7
_OTHER_PLACE = 0.3
_OTHER_NAME = 0.15
_OTHER_END = 0.8
_FAR = 0.5
"""Distance between the ends of two motions [rad or m] at which the cost of pairing them reaches `_OTHER_END`.
For smaller distances, the cost is proportional to the distance.
"""


def pairs_of(first: Sequence[Act], second: Sequence[Act]) -> list[Pair]:
    """Pair the commands of two programs, in order; a command without a partner is paired with None."""
    return _aligned(first, second, [_key(one) for one in first], [_key(one) for one in second], _closest)


def _key(act: Act) -> Hashable:
    """Return a value that is equal for commands that are paired: for commands that do the same thing, or for
    motions whose rounded ends are equal.
    """
    if act.curve is None:
        return act.kind, act.what
    return act.kind, tuple(np.round(act.curve.points[-1] / _FINE).astype(int).tolist())


def _aligned(
    first: Sequence[Act],
    second: Sequence[Act],
    keys: Sequence[Hashable],
    others: Sequence[Hashable],
    rest: Callable[[Sequence[Act], Sequence[Act]], list[Pair]],
) -> list[Pair]:
    """Pair commands with equal keys; `rest` is the function that pairs the commands between them."""
    pairs: list[Pair] = []
    for tag, i, j, k, m in SequenceMatcher(None, keys, others, autojunk=False).get_opcodes():
        if tag == "equal":
            pairs += zip(first[i:j], second[k:m], strict=True)
        else:
            pairs += rest(first[i:j], second[k:m])
    return pairs


def _apart(first: Sequence[Act], second: Sequence[Act]) -> list[Pair]:
    return [*((one, None) for one in first), *((None, one) for one in second)]


def _closest(first: Sequence[Act], second: Sequence[Act]) -> list[Pair]:
    """Pair commands so that the order of both programs is kept and the total cost is as small as possible. A
    command without a partner also has a cost.
    """
    n, m = len(first), len(second)
    if n * m == 0:
        return _apart(first, second)
    if n * m > _MOST_CELLS:
        return _aligned(
            first,
            second,
            [(candidate.kind, candidate.place, candidate.name) for candidate in first],
            [(candidate.kind, candidate.place, candidate.name) for candidate in second],
            _apart,
        )
    cost = np.full((n + 1, m + 1), np.inf)
    cost[:, m] = np.arange(n, -1, -1) * _ALONE
    cost[n, :] = np.arange(m, -1, -1) * _ALONE
    pair: list[list[float]] = []
    for candidate in first:
        go_on()
        pair.append([_cost(candidate, other) for other in second])
    for i in range(n - 1, -1, -1):
        go_on()
        for k in range(m - 1, -1, -1):
            cost[i, k] = min(pair[i][k] + cost[i + 1, k + 1], _ALONE + min(cost[i + 1, k], cost[i, k + 1]))
    pairs: list[Pair] = []
    i = k = 0
    while i < n and k < m:
        if cost[i, k] == pair[i][k] + cost[i + 1, k + 1]:
            pairs.append((first[i], second[k]))
            i, k = i + 1, k + 1
        elif cost[i, k] == _ALONE + cost[i + 1, k]:
            pairs.append((first[i], None))
            i += 1
        else:
            pairs.append((None, second[k]))
            k += 1
    return [*pairs, *_apart(first[i:], second[k:])]


def _cost(act: Act, other: Act) -> float:
    """Return the dissimilarity of two commands; infinite if they can't be paired."""
    if act.kind != other.kind:
        return np.inf
    cost = _OTHER_PLACE * (act.place != other.place) + _OTHER_NAME * (act.name != other.name)
    if act.curve is None or other.curve is None:
        return cost + 0.5 * _OTHER_END * (act.what != other.what)
    off = float(np.abs(act.curve.points[-1] - other.curve.points[-1]).max())
    return cost + _OTHER_END * min(1.0, off / _FAR)
