"""Check that workpieces and tools stay where they are while the arm takes and leaves them.

The proof describes a workpiece as several bodies of one name: on the ground, on the arm, on the ground again.
Each body states the commands during which it is present. A tool may have several bodies at once. After a
branch, a workpiece has a body at each place where it may be. Each motion is compared with each motion that
may follow it, on any branch of the text. A body must be present in both, or the arm must take or leave it:
the robot is at rest, an output is set, and a body of the next motion has the same place and shape. Where
machines or people bring or remove workpieces, the proof is believed, as for all data of the cell.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from yarclang.verify.arm import Arm, Frame, Vector, beyond, dot, placed
from yarclang.verify.course import PARTING, Moved, Ways
from yarclang.verify.exact import above, fixed, length, need, whole
from yarclang.verify.joints import in_joints
from yarclang.verify.reader import PRINTED

_SAME = above(Fraction(1, 1_000_000))
"""Largest change of a part's place [m] or axes when it is taken or left."""
_CORNER = 4 * _SAME
"""Largest change of a corner's place [m]. The proof rounds each coordinate to 1e-6 m, in both bodies."""
Told = dict[str, Any]
Ends = set[tuple[int, bool]]
"""Indices of the last commands on the branches to a place, each with True if an output was set after it."""


def check_parts(rows: Sequence[Moved], done: Sequence[str], bodies: Sequence[Told], arm: Arm) -> list[str]:
    """Check that all workpieces stay where they are between motions; return what isn't checked.

    Args:
        rows: all commands.
        done: the actions of the controller text.
        bodies: the proof's bodies.
        arm: the arm.
    """
    parts, left = dict[str, list[Told]](), dict[str, None]()
    for body in bodies:
        for period in body.get("during", []):
            first, last = (whole(one, len(rows) - 1) for one in period)
            need(0 <= first <= last, f"{body['name']}: a part that is there from its end to its begin")
        if body.get("point"):
            left |= {f"when {body['name']} is watched: as told here": None} if body.get("during") else {}
        elif "during" in body:
            parts.setdefault(body["name"], []).append(body)
    one_way = not any(deed.startswith("barrier ") and deed.split()[1] in PARTING for deed in done)
    steps = sorted(follow(done))
    for name, found in parts.items():
        periods = sorted({(int(first), int(last)) for body in found for first, last in body["during"]})
        apart = all(other[0] > one[1] for one, other in pairwise(periods))
        need(apart or not one_way, f"{name}: a part that is in two places")
        left |= dict.fromkeys(_handed_over(rows, steps, name, found, arm))
    return list(left)


def follow(done: Sequence[str]) -> set[tuple[int, int, bool]]:
    """Return the pairs of motions that may follow each other, with True if an output is set between both.

    The predecessor of the first motion is -1. A loop may be repeated: its first motions also follow its last
    ones.
    """
    repeated, known = dict[int, Ends](), -1
    while sum(map(len, repeated.values())) > known:
        known = sum(map(len, repeated.values()))
        pairs, loops = set[tuple[int, int, bool]](), list[int]()
        ways = Ways({(-1, False)}, lambda one, other, _: one | other)
        for number, deed in enumerate(done):
            kind, rest = deed.split(" ", 1)
            kind = rest.split()[0] if kind == "barrier" else kind
            if kind == "move":
                pairs |= {(before, int(rest), put) for before, put in ways.at or ()}
                ways.at = {(int(rest), False)}
            elif kind == "put" and ways.at is not None:
                ways.at = {(before, True) for before, _ in ways.at}
            elif kind == "loop":
                loops.append(number)
                ways.at = (ways.at or set()) | repeated.get(number, set())
            again = ways.passes(kind, number)
            if kind == "endloop":
                repeated[loops.pop()] = again or set()
    return pairs


def _handed_over(
    rows: Sequence[Moved], steps: Sequence[tuple[int, int, bool]], name: str, bodies: Sequence[Told], arm: Arm
) -> Iterator[str]:
    """Check that a workpiece or tool stays in place between any two motions; yield what isn't checked.

    A body of the first motion must also be there in the second one, or be where a body of the second one is.
    A body of the second motion must have come from somewhere on one of the ways to it: after a branch, it may
    be that of another way.
    """
    present = dict[int, tuple[int, ...]]()
    for number, body in enumerate(bodies):
        for step in {k for first, last in body["during"] for k in range(int(first), int(last) + 1)}:
            present[step] = (*present.get(step, ()), number)
    on_arm = [body["joint"] > 0 for body in bodies]
    sources, faults = dict[tuple[int, int], list[tuple[int, int]]](), dict[tuple[int, int], str]()
    for before, after, put in steps:
        there, then = present.get(before, ()), present.get(after, ())
        gone, come = (
            [one for one in some if one not in others] for some, others in ((there, then), (then, there))
        )
        for one in then:
            sources.setdefault((after, one), []).append((before, one))
        if not gone and not come:
            continue
        if not there and any(on_arm[one] for one in come):
            yield f"from where the arm has {name}"
        if not then and any(on_arm[one] for one in gone):
            yield f"where the arm leaves {name}"
        what = f"where {name} is between commands {before} and {after}"
        believed = not there or not then or not any(on_arm[one] for one in gone + come)
        if not believed and rows[before].entry.blend is not None:
            yield what
            believed = True
        if believed:
            for one in come:
                sources[after, one].append((-1, -1))
            continue
        need(put or not gone, f"{what}: no output is set there")
        faults |= dict.fromkeys([(after, one) for one in come], f"{what}: no output is set there")
        if not put:
            continue
        links = arm.links(in_joints(rows[before].end, PRINTED, arm.turns), [0] * len(arm.turns))
        for one in gone:
            fault, _ = _nearest(bodies, one, then, links)
            need(not fault, f"{what}: {fault}")
        for one in come:
            fault, near = _nearest(bodies, one, there, links)
            faults[after, one] = f"{what}: {fault}"
            sources[after, one] += [(before, other) for other in near]
    leads = dict[tuple[int, int], list[tuple[int, int]]]()
    for place, found in sources.items() if faults else ():
        for source in found:
            leads.setdefault(source, []).append(place)
    known, reached = {(-1, -1)}, [(-1, -1)]
    while reached:
        more = {place for place in leads.get(reached.pop(), ()) if place not in known}
        known |= more
        reached += more
    for place, fault in faults.items():
        need(place in known, fault)


def _nearest(
    bodies: Sequence[Told], number: int, others: Sequence[int], links: Sequence[Frame]
) -> tuple[str, list[int]]:
    """Return the bodies among `others` that are where body `number` is, or the reason why there are none."""
    off = {other: _apart(bodies[number], bodies[other], links) for other in others}
    known = [far for far in off.values() if far is not None]
    near = [other for other, far in off.items() if far is not None and far <= _SAME]
    if not known:
        return "it has another shape", []
    fault = f"{min(known) / above(1) * 1000:.6g} mm from where it was, or turned"
    return "" if near else fault, near


def _apart(one: Told, other: Told, links: Sequence[Frame]) -> int | None:
    """Return the distance between the places of two bodies [m]; None if the bodies have different shapes.

    Distances of corners count only a quarter, since the proof rounds corners (see `_CORNER`).
    """
    if any(one[size] != other[size] for size in ("core", "disc", "radius")):
        return None
    (here, corners), (there, others) = (_placed(body, links) for body in (one, other))
    if len(corners) != len(others):
        return None
    off = max((_distance(a, b) for a, b in zip(corners, others, strict=True)), default=0) * _SAME // _CORNER
    if corners and not any(one["core"]) and not one["disc"]:  # a mesh is nothing but its corners
        return off
    pairs = zip((here.origin, *here.axes), (there.origin, *there.axes), strict=True)
    return max(off, *(_distance(a, b) for a, b in pairs))


def _placed(body: Told, links: Sequence[Frame]) -> tuple[Frame, list[Vector]]:
    """Return the frame of a body, and its corners, in {B}."""
    frame = beyond(links[int(body["joint"])], placed(body["pose"]))
    rows = list(zip(*frame.axes, strict=True))
    corners = [[fixed(one) for one in corner] for corner in body.get("corners", [])]
    return frame, [
        [dot(row, corner) + o for row, o in zip(rows, frame.origin, strict=True)] for corner in corners
    ]


def _distance(one: Vector, other: Vector) -> int:
    return length(*(a - b for a, b in zip(one, other, strict=True)))
