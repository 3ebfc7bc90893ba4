"""Check motions that flow into each other: lines and arcs of one frame, with a corner between neighbours.

A motion of a chain begins at the programmed goal of the motion before. It follows its path from one place of
the text to another, which the proof names, in the same way as a motion from rest to rest. If the next motion
continues exactly there, at the end of the first path and the start of the second, the corner needs no further
check. Otherwise the corner has a ball; the proof gives its radius and both tolerances. Until the next path is
joined, the frame stays in the ball, and so do the parts of both paths that are not followed. The frame is
turned away from the corner by at most the turns of these parts.
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import Any

from yarclang.verify.arm import Arm, cross, in_si
from yarclang.verify.course import Moved
from yarclang.verify.exact import BITS, ONE, PI, SLACK, above, fixed, length, need, times, whole
from yarclang.verify.paths import (
    Followed,
    Motion,
    check_speeds,
    chord_of,
    cut,
    farthest,
    frame_path,
    reach_of,
    speeds_on,
)
from yarclang.verify.reader import STEPS

Told = dict[str, Any]
Link = tuple[Moved, Told]
_FASTER = 1 + Fraction(1, 1000)


def chains_of(rows: Sequence[Moved], steps: Sequence[Told]) -> Iterator[list[Link]]:
    """Yield the chains of motions that flow into each other, including motions without moves between them."""
    chain = list[Link]()
    for row, told in zip(rows, steps, strict=True):
        if "move" not in told or not (chain or row.entry.blend is not None):
            continue
        chain.append((row, told))
        if row.control and row.entry.blend is None:
            yield chain
            chain = []


def why_not(chain: Sequence[Link], proofs: dict[str, Any]) -> str:
    """Return the reason why a chain is not checked; empty if it is."""
    for row, told in chain:
        if told["move"] not in ("line", "arc") or told.get("unchecked") or not row.control:
            return str(told.get("unchecked") or "joints, or another path than lines and arcs")
        if told["tool"] != chain[0][1]["tool"]:
            return "another frame goes on"
        if str(row.entry.step) not in proofs:
            return "the proof says nothing of it"
    return ""


def check_chain(chain: Sequence[Link], proofs: dict[str, Any], arm: Arm) -> Iterator[str]:
    """Check a chain; yield the parts that are not checked."""
    found, late, start = list[Followed](), Fraction(0), None
    for row, told in chain:
        title, proof = row.entry.title, proofs[str(row.entry.step)]
        segments, tolerance = row.last - row.first, told["tolerance"]
        if "duration" in told:  # its corners are between segments, so it may be longer or shorter
            late += segments * row.seconds - told["duration"]
            allowed = Fraction(segments, 2 * STEPS * 1000) + row.seconds / 2 + Fraction(1, 10**9)
            need(abs(late) <= allowed, f"{title}: it takes another time")
        need(min(tolerance) > 0, f"{title}: a tolerance that isn't above 0")
        for name in ("s", "rates"):
            proof[name] = [whole(one) for one in proof[name]]
        path = frame_path(Motion(row, arm), told, proof, start)
        need(
            path.most <= in_si(tolerance[0], 1, False),
            f"{title}: within {path.most / ONE * 1000:.6g} mm, no less",
        )
        need(path.chord <= chord_of(in_si(tolerance[1], 1, True)), f"{title}: turned too far from its path")
        found.append(path)
        start = path.goal
    first, last = found[0], found[-1]
    begins = first.begin == chain[0][0].first and first.shares[0] == 0
    need(
        begins and last.end == chain[-1][0].last and last.shares[1] == ONE,
        "a chain isn't followed to its ends",
    )
    balls = [
        _corner(one, other, told, proofs[str(row.entry.step)])
        for (one, other), (row, told) in zip(pairwise(found), chain[:-1], strict=True)
    ]
    yield from _speeds(chain, found, balls)


def _corner(first: Followed, second: Followed, told: Told, proof: dict[str, Any]) -> list[tuple[int, int]]:
    """Check the corner after a motion; return bounds of the frame's speed between both paths."""
    row, title = first.motion.row, first.motion.row.entry.title
    far = Fraction(row.entry.blend or 0, 2) + 1
    inside = row.last - far <= first.end <= second.begin <= row.last + far
    need(inside, f"{title}: its path is left, or the next one joined, away from the corner between both")
    if first.end == second.begin and first.shares[1] == ONE and second.shares[0] == 0:
        return []
    need(told.get("blend", 0) > 0, f"{title}: a corner without a ball is left")
    ball = in_si(told["blend"] + told["tolerance"][0], 1, False)
    turned = in_si(told["tolerance"][1], 1, True)
    columns, origin = first.goal
    # The parts of both paths that are not followed: an arc of at most half a turn is farthest at its end.
    for path, share, corner in ((first, first.shares[1], ONE), (second, second.shares[0], 0)):
        missing = abs(corner - share)
        need(missing * path.sweep >> BITS <= PI, f"{title}: more than half a turn isn't followed")
        off = length(*(a - b for a, b in zip(path.place(share)[0], origin, strict=True))) + SLACK
        need(off <= ball, f"{title}: a path is left {off / ONE * 1000:.6g} mm from the corner")
        turned += missing * path.turn.angle >> BITS
    motion, tool, speeds = first.motion, first.tool, list[tuple[int, int]]()
    reach, places = reach_of(motion, tool), cut(first.end, second.begin, whole(proof["corner"]))
    here = motion.arm.frame(*motion.at(first.end), tool)
    for begin, end in pairwise(places):
        then = motion.arm.frame(*motion.at(end), tool)
        d = above((end - begin) * row.seconds)
        rest = times(d, d, d, d)
        # On each piece: largest Bezier point of the difference from the corner, plus the Hermite remainder.
        bends = motion.arm.bends(reach, *motion.bounds(int(begin)))
        ends, chords = list[list[int]](), list[list[int]]()
        for frame in (here, then):
            ends += [[a - b for a, b in zip(frame.origin, origin, strict=True)], frame.rate]
            apart, rate = list[int](), list[int]()
            for column, meant in zip(frame.axes, columns, strict=True):
                apart += [a - b for a, b in zip(column, meant, strict=True)]
                rate += cross(frame.spin, column)
            chords += [apart, rate]
        most = farthest(ends[0], ends[1], ends[2], ends[3], d) + times(rest, bends[0]) // 384 + 1
        need(most <= ball, f"{title}: the frame is {most / ONE * 1000:.6g} mm from the corner in its blend")
        chord = farthest(chords[0], chords[1], chords[2], chords[3], d) + times(rest, bends[1]) // 384 + 1
        need(chord <= chord_of(turned), f"{title}: the frame is turned too far from the corner in its blend")
        speeds.append(speeds_on(here, then, d, bends[0]))
        here = then
    return speeds


def _speeds(
    chain: Sequence[Link], found: Sequence[Followed], balls: Sequence[list[tuple[int, int]]]
) -> Iterator[str]:
    """Check speeds and ceilings. In the segments of a blend, the larger one of its two motions applies."""
    around = [_larger(one, other) for (_, one), (_, other) in pairwise(chain)]
    for number, ((row, told), path) in enumerate(zip(chain, found, strict=True)):
        begin, end = row.first + Fraction(row.before or 0, 2), row.last - Fraction(row.entry.blend or 0, 2)
        pairs = list(zip(path.segments, path.speeds, strict=True))
        for limit, near in (
            (around[number - 1] if number else {}, [speed for segment, speed in pairs if segment < begin]),
            (
                around[number] if number < len(around) else {},
                [speed for segment, speed in pairs if segment >= end],
            ),
        ):
            _hold(limit, near, row.entry.title)
        own = [speed for segment, speed in pairs if begin <= segment < end]
        if own:
            before = number > 0 and not balls[number - 1] and _is_slower(told, chain[number - 1][1])
            behind = number < len(balls) and not balls[number] and _is_slower(told, chain[number + 1][1])
            slow = check_speeds(told, own, row.entry.title, (before, behind))
        else:
            slow = "its speed, since blends take all of it" if "speed" in told or "ceiling" in told else ""
        if slow:
            yield f"{row.entry.title}: {slow}"
    for (row, _), limit, speeds in zip(chain, around, balls, strict=False):
        _hold(limit, speeds, row.entry.title)


def _is_slower(one: Told, other: Told) -> bool:
    """Return True if a motion has a speed, and the motion beside it keeps at least this speed."""
    own, besides = (told.get("speed", [None])[0] for told in (one, other))
    if own is None or besides is None:
        return False
    return bool(own * one.get("kept", 1) <= besides * other.get("kept", 1))


def _larger(one: Told, other: Told) -> dict[str, Fraction]:
    """Return the larger speed and ceiling of two motions [mm/s], if both have one."""
    found = {}
    if "ceiling" in one and "ceiling" in other:
        found["ceiling"] = max(one["ceiling"], other["ceiling"])
    if one.get("speed", [None])[0] is not None and other.get("speed", [None])[0] is not None:
        found["speed"] = max(one["speed"][0], other["speed"][0])
    return found


def _hold(limit: dict[str, Fraction], speeds: Sequence[tuple[int, int]], title: str) -> None:
    most = max((high for _, high in speeds), default=0)
    for name, top in limit.items():
        need(most <= fixed(top / 1000 * _FASTER), f"{title}: faster than its {name} in a blend")
