"""Check that parts stay where they are while grippers take and leave them.

The proof tells a part as bodies of one name: on the ground, on the arm, on the ground again, each with the
commands during which it is there. Where the arm takes or leaves the part, the robot stands, an output is set,
and the part has the same place and shape before and after: only the arm has moved it. That a part is brought
or taken away by others is told, as all of the cell is.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from yarclang.verify.arm import Arm, beyond, placed
from yarclang.verify.course import Moved
from yarclang.verify.exact import above, length, need, whole
from yarclang.verify.joints import in_joints
from yarclang.verify.reader import PRINTED

_SAME = above(Fraction(1, 1_000_000))
"""Largest change of a part's place [m] or axes when it is taken or left."""
Told = dict[str, Any]


def check_parts(rows: Sequence[Moved], done: Sequence[str], bodies: Sequence[Told], arm: Arm) -> list[str]:
    """Check all parts; return what isn't checked.

    Args:
        rows: all commands.
        done: the actions of the text, without ways that part.
        bodies: the proof's bodies.
        arm: the arm.
    """
    periods: dict[str, list[tuple[int, int, Told]]] = {}
    left = []
    for body in bodies:
        for first, last in body.get("during", []):
            if body.get("point"):
                left.append(f"when {body['name']} is watched: as told here")
            else:
                one = (whole(first, len(rows) - 1), whole(last, len(rows) - 1), body)
                periods.setdefault(body["name"], []).append(one)
    moving = [row.entry.step for row in rows if row.control]
    for name, found in periods.items():
        found.sort(key=lambda one: one[:2])
        together = Counter(one[:2] for one in found).values()
        if len(set(together)) == 1 and min(together) > 1:  # a tool has several bodies, which go together
            left.append(f"where {name} is, of which several bodies are told")
            continue
        ends = [at for first, last, _ in found for at in (first, last)]
        need(ends[0] >= 0 and ends == sorted(ends), f"{name}: a part that is in two places")
        need(all(b[0] > a[1] for a, b in pairwise(found)), f"{name}: a part that is in two places")
        if found[0][2]["joint"] > 0:
            left.append(f"from where the arm has {name}")
        if found[-1][2]["joint"] > 0 and found[-1][1] < moving[-1]:
            left.append(f"where the arm leaves {name}")
        left += _handed_over(rows, done, name, found, arm)
    return list(dict.fromkeys(left))


def _handed_over(
    rows: Sequence[Moved], done: Sequence[str], name: str, found: Sequence[tuple[int, int, Told]], arm: Arm
) -> Iterator[str]:
    """Check each change of a part from one body to the next; yield what isn't checked."""
    for (_, last, one), (first, _, other) in pairwise(found):
        if one["joint"] == other["joint"] == 0:
            continue
        before, after = rows[last], rows[first]
        what = f"where {name} is between commands {last} and {first}"
        stands = before.control and after.control and before.entry.blend is None
        if not stands or any(row.control for row in rows[last + 1 : first]):
            yield what
            continue
        actions = done[done.index(f"move {last}") : done.index(f"move {first}")]
        need(any(action.startswith("put ") for action in actions), f"{what}: no output is set there")
        if one.get("corners") or other.get("corners"):
            yield f"{what}, of which a mesh is told"
            continue
        shapes = [[body[size] for size in ("core", "disc", "radius")] for body in (one, other)]
        need(shapes[0] == shapes[1], f"{what}: it has another shape")
        links = arm.links(in_joints(before.end, PRINTED, arm.turns), [0] * len(arm.turns))
        here, there = (beyond(links[int(body["joint"])], placed(body["pose"])) for body in (one, other))
        pairs = zip((here.origin, *here.axes), (there.origin, *there.axes), strict=True)
        off = max(length(*(a - b for a, b in zip(*pair, strict=True))) for pair in pairs)
        need(off <= _SAME, f"{what}: {off / above(1) * 1000:.6g} mm from where it was, or turned")
