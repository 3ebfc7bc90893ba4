"""Check that each motion follows its path, and that blends between motions stay near the corners of their
paths.

A motion from rest to rest is a chain of one. In a chain of blended motions, each begins at the programmed
goal of the motion before. It follows its path from one place of the controller text to another; the proof
names both. If the next motion continues exactly there, at the end of the first path and the start of the
second, the corner needs no further check. Otherwise the corner has a ball; the proof gives its radius and
both tolerances. Until the next path is joined, the frame stays in the ball, and so do the sections of both
paths that are not followed. The frame is turned away from the corner by at most the turns of these sections.
Between two joint motions, each joint has a ball (an interval) of its own.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import chain as joined
from itertools import pairwise
from typing import Any

from yarclang.verify.arm import Arm, Frame, Step, Vector, beyond, derivative, dot, in_si, placed
from yarclang.verify.course import Moved
from yarclang.verify.exact import ONE, SLACK, above, fixed, length, need, times, whole
from yarclang.verify.joints import Joints, Pieces, in_joints, through, timetable
from yarclang.verify.paths import (
    SHARE,
    FramePath,
    Frames,
    Motion,
    Piece,
    State,
    check_speeds,
    chord_of,
    cut,
    distances,
    error,
    pieces_of,
    span_of,
    speeds_on,
)
from yarclang.verify.poses import PoseSpline
from yarclang.verify.reader import PRINTED, STEPS

Told = dict[str, Any]
Link = tuple[Moved, Told]
FRAMED = ("line", "arc", "spline of poses")
"""Motions along the path of a frame; the others are those of joints."""
_CHOSEN = Fraction(1, 1000)
"""Largest distance between a corner's pose and the joints that were chosen for it [mm or deg]."""
_CORNER = 32
"""Pieces of the part of a path beside a corner that isn't followed."""
_STILL: Vector = [0, 0, 0]


@dataclass
class Followed:
    """A motion that was shown to follow its path.

    Attributes:
        motion: the motion.
        told: the proof's description of the motion.
        what: what follows the path, a frame or the joints.
        path: the path.
        begin: place in the controller text from which on the path is followed.
        end: place up to which the path is followed.
        shares: range of the path parameter s that is followed.
        speeds: for a frame, least and largest speed on each piece of the motion's time.
        segments: segment of each of these pieces.
    """

    motion: Motion
    told: Told
    what: Frames | Joints
    path: FramePath | PoseSpline | Pieces
    begin: Fraction
    end: Fraction
    shares: tuple[int, int]
    speeds: list[tuple[int, int]] = field(default_factory=list)
    segments: list[int] = field(default_factory=list)


def chains_of(rows: Sequence[Moved], steps: Sequence[Told]) -> Iterator[list[Link]]:
    """Yield the motions from rest to rest, including those without a path, each as a chain of one, and the
    chains of blended motions.

    A motion without move lines between the motions of a chain belongs to the chain.
    """
    chain = list[Link]()
    for row, told in zip(rows, steps, strict=True):
        if "move" not in told:
            continue
        chain.append((row, told))
        if row.entry.blend is None and (row.control or len(chain) == 1):
            yield chain
            chain = []


def why_not(chain: Sequence[Link], proofs: dict[str, Any]) -> str:
    """Return the reason why the paths of a chain are not checked; empty if they are."""
    for row, told in chain:
        if told.get("unchecked"):
            return str(told["unchecked"])
        if len(chain) > 1 and not row.control:
            return "a motion among them that leads nowhere"
        strange = not {"speed", "ceiling", "blend"}.isdisjoint(told)
        if told["move"] == "timetable" and (strange or len(chain) > 1 or not row.control):
            return "a timetable with a speed, or that a motion flows into, or that leads nowhere"
        if row.control and str(row.entry.step) not in proofs:
            return "its path, of which the proof says nothing"
        if not row.control and told["move"] in FRAMED[1:]:
            return f"its path, {told['move']}, which leads nowhere"
    for (_, one), (_, other) in pairwise(chain):
        changes = {one["move"], other["move"]} <= set(FRAMED) and one["tool"] != other["tool"]
        if changes and not {"speed", "ceiling"}.isdisjoint({*one, *other}):
            return "another frame goes on, with a speed or a ceiling"
    return ""


def check_chain(chain: Sequence[Link], proofs: dict[str, Any], arm: Arm) -> Iterator[str]:
    """Check a chain of blended motions, or a motion from rest to rest; yield the properties that are not
    checked.
    """
    found, late = list[Followed](), Fraction(0)
    for row, told in chain:
        title, (position, angle) = row.entry.title, told["tolerance"]
        need(position > 0 and angle > 0, f"{title}: a tolerance that isn't above 0")
        if "duration" in told:
            # The controller's resolution may change each segment by half a step, and each segment of a
            # timetable, whose times are rounded up, by a whole step. The corners of a chain are between
            # segments, so a motion of a chain may be longer or shorter. What leads nowhere has none.
            segments, halves = row.last - row.first, 1 + (told["move"] == "timetable")
            late += segments * row.seconds - told["duration"]
            allowed = Fraction(segments * halves, 2 * STEPS * 1000) + Fraction(1, 10**9)
            allowed += row.seconds / 2 if len(chain) > 1 else 0
            need(abs(late) <= allowed, f"{title}: it takes another time")
        if not row.control:
            _stays(row, told, arm)
            return
        if told["move"] == "timetable":
            _on_time(row, told, proofs[str(row.entry.step)], arm)
            return
        found.append(_follow(row, told, proofs[str(row.entry.step)], arm, found[-1] if found else None))
    first, last = found[0], found[-1]
    begins = first.begin == chain[0][0].first and first.shares[0] == 0
    ends = last.end == chain[-1][0].last and last.shares[1] == ONE
    need(begins and ends, f"{title}: not shown to follow its path from its start to its end")
    balls = [_corner(one, other, proofs[str(one.motion.row.entry.step)]) for one, other in pairwise(found)]
    yield from _speeds(chain, found, balls, proofs)


def _stays(row: Moved, told: Told, arm: Arm) -> None:
    """Check that the goal of a motion without move lines is where the robot already is."""
    title, here = row.entry.title, in_joints(row.begin, PRINTED, arm.turns)
    if told["move"] in FRAMED:
        _near(arm, here, told, told["tolerance"], f"{title}: it leads nowhere, and its goal")
        return
    for point in _goals(row, told, {}, arm):
        there = zip(point, here, _per_joint(told["tolerance"], arm), strict=True)
        need(all(abs(a - b) <= allowed for a, b, allowed in there), f"{title}: it doesn't move")


def _on_time(row: Moved, told: Told, proof: Told, arm: Arm) -> None:
    """Check that each joint is where a timetable has it at the same time, within the joint's entry of
    `within`.

    The motion is cut into pieces, also at the timetable's rows. The segments of the controller text take the
    timetable's duration except for the rounding of TM, which is spread evenly over them.
    """
    title, motion, rows = row.entry.title, Motion(row, arm), told["rows"]
    table, size = (
        timetable(in_joints(row.begin, PRINTED, arm.turns), rows, arm.turns),
        motion.end - motion.begin,
    )
    need(
        abs(told["duration"] - rows[-1]["at"]) < Fraction(1, 10**9), f"{title}: its table takes another time"
    )
    limits, most = in_joints(told["within"], 1, arm.turns), _per_joint(told["tolerance"], arm)
    need(
        all(a <= b for a, b in zip(limits, most, strict=True)),
        f"{title}: a joint's part beyond its tolerance",
    )
    if rows[0]["q"] is not None:  # where the table begins, the robot stands
        stands = zip(in_joints(rows[0]["q"], 1, arm.turns), table.at(0), strict=True)
        _within(
            Joints(motion), limits, [abs(a - b) for a, ((b,), _) in stands], f"{title}, from its first row"
        )
    at_rows = [motion.begin + size * Fraction(edge, ONE) for edge in table.edges]
    places = sorted({*cut(motion.begin, motion.end, whole(proof["pieces"])), *at_rows})
    rate = above(1 / (size * row.seconds))
    what, pieces = Joints(motion), list[Piece]()
    for begin, end in pairwise(places):
        s = fixed((begin - motion.begin) / size), fixed((end - motion.begin) / size)
        pieces.append(Piece((end - begin) * row.seconds, s, (rate, rate), (rate, 0, 0), int(begin), end))
    for piece in distances(what, table, pieces, what.at(motion.begin)):
        _within(what, limits, piece.off, f"{title}, from its timetable")


def _per_joint(limits: Sequence[Fraction], arm: Arm) -> list[int]:
    """Return for each joint its tolerance, from a length [mm] and an angle [deg]."""
    return [in_si(limits[1] if turns else limits[0], 1, turns) for turns in arm.turns]


def _goals(row: Moved, told: Told, proof: Told, arm: Arm) -> Iterator[Vector]:
    """Yield the goals of a joint motion as joint positions. If they were chosen for a programmed pose, check
    that they reach this pose.

    For the last goal, the proof may give only a pose. The joint positions are then those where the motion
    ends; in a chain, the proof gives them.
    """
    title, flows = row.entry.title, row.entry.blend is not None
    for goal in told["through"]:
        need(goal["q"] is not None or "pose" in goal, f"{title}: a goal that is nowhere")
        if goal["q"] is not None:
            point = in_joints(goal["q"], 1, arm.turns)
        else:
            point = (
                in_joints(proof["goal"], 1, arm.turns) if flows else in_joints(row.end, PRINTED, arm.turns)
            )
        if "pose" in goal:
            limits = [_CHOSEN, _CHOSEN] if flows else told["tolerance"]
            _near(arm, point, goal, limits, f"{title}: the joints that were chosen for a pose, which")
        yield point


def _near(arm: Arm, q: Sequence[int], told: Told, limits: Sequence[Fraction], what: str) -> None:
    """Refuse joint positions at which a frame is not at its pose, within a length [mm] and an angle [deg]."""
    columns, origin = placed(told["pose"])
    frame = arm.frame(q, [0] * len(q), placed(told["tool"]))
    off = length(*(a - b for a, b in zip(frame.origin, origin, strict=True)))
    pairs = zip(joined(*frame.axes), joined(*columns), strict=True)
    near = off + SLACK <= in_si(limits[0], 1, False)
    near = near and length(*(a - b for a, b in pairs)) + SLACK <= chord_of(in_si(limits[1], 1, True))
    need(near, f"{what} is {off / ONE * 1000:.6g} mm away, or turned too far")


def _follow(row: Moved, told: Told, proof: Told, arm: Arm, before: Followed | None) -> Followed:
    """Check that a motion follows its path, which begins at the goal of the motion before, or where the robot
    is at rest.
    """
    title, motion = row.entry.title, Motion(row, arm)
    for name in ("s", "rates"):
        proof[name] = [whole(one) for one in proof[name]]
    begin, end = span_of(motion, proof)
    what: Frames | Joints
    path: FramePath | PoseSpline | Pieces
    if told["move"] in FRAMED:
        tool, still = placed(told["tool"]), [0] * len(arm.turns)
        if before is None:
            frame = arm.frame(in_joints(row.begin, PRINTED, arm.turns), still, tool)
        elif isinstance(before.path, Pieces):
            frame = arm.frame(before.path.goal, still, tool)
        else:
            axes, origin = before.path.goal
            frame = beyond(Frame(origin, axes, _STILL, _STILL), _seen_from(before.told, tool))
        start = frame.axes, frame.origin
        curve = PoseSpline if told["move"] == "spline of poses" else FramePath
        what, path = Frames(arm, tool, motion), curve(start, told, proof)
        limits = [in_si(told["tolerance"][0], 1, False), chord_of(in_si(told["tolerance"][1], 1, True))]
    else:
        what, path = Joints(motion), _of_joints(row, told, proof, arm, before)
        limits = _per_joint(told["tolerance"], arm)
    first, last = (fixed(Fraction(proof["s"][k], SHARE)) for k in (0, -1))
    found = Followed(motion, told, what, path, begin, end, (first, last))
    state, most = what.at(begin), [0] * len(limits)
    if first in (0, ONE):  # an end of the path; if the proof has this place alone, no piece shows it
        off = error(state, path.at(first), fixed(Fraction(proof["rates"][0], SHARE)))
        most = [length(*e) + SLACK for e, _ in off]
    for piece in distances(what, path, pieces_of(motion, proof), state):
        most = [max(pair) for pair in zip(most, piece.off, strict=True)]
        if isinstance(what, Frames):
            found.speeds.append(speeds_on(piece))
            found.segments.append(piece.piece.segment)
    _within(what, limits, most, f"{title}, from its path")
    if "tolerance_of" in told:  # a frame of which TOL is, while joints move
        led = Frames(arm, placed(told["tolerance_of"]), motion)
        slides = sum(off for off, turns in zip(most, arm.turns, strict=True) if not turns)
        ways = zip(most, led.reach, arm.turns, strict=True)
        far = slides + sum(times(off, reach + slides) for off, reach, turns in ways if turns)
        _within(led, [in_si(told["tolerance"][0], 1, False)], [far], f"{title}, from its way")
    return found


def _within(what: Frames | Joints, limits: Sequence[int], off: Sequence[int], where: str) -> None:
    """Refuse a frame, or joints, that may be farther from their path or corner than the limits allow."""
    for number, (limit, one) in enumerate(zip(limits, off, strict=True)):
        if isinstance(what, Joints):
            who = f"joint {number + 1} is {one / ONE:.6g} rad or m"
        else:
            who = "turned too far" if number else f"{one / ONE * 1000:.6g} mm"
        need(one <= limit, f"{where}: {who} away")


def _of_joints(row: Moved, told: Told, proof: Told, arm: Arm, before: Followed | None) -> Pieces:
    """Return the programmed path of a joint motion.

    After a Cartesian motion, the path begins at joint positions that the proof has chosen for the frame's
    goal.
    """
    if before is None:
        start = in_joints(row.begin, PRINTED, arm.turns)
    elif isinstance(before.path, FramePath | PoseSpline):
        start = in_joints(proof["start"], 1, arm.turns)
        what = f"{row.entry.title}: the joints that were chosen for the corner before, where the frame"
        _near(arm, start, before.told, [_CHOSEN, _CHOSEN], what)
    else:
        start = before.path.goal
    points = [start, *_goals(row, told, proof, arm)]
    need(told["move"] == "spline" or len(points) == 2, f"{row.entry.title}: a straight way has one goal")
    return through(points)


class _Corner:
    """A fixed place (the corner between two paths), in the form of a path."""

    def __init__(self, state: State) -> None:
        self._state = [(at, [0] * len(at)) for at, _ in state]

    def at(self, _: int) -> State:
        """Return the place."""
        return self._state

    def bends(self, _: tuple[int, int]) -> Sequence[Sequence[int]]:
        """Return the derivatives, which are 0."""
        return [(0, 0, 0, 0)] * len(self._state)


def _still(places: Sequence[Fraction], seconds: Fraction) -> Iterator[Piece]:
    """Yield the pieces of time between places, with a path parameter s that stays 0."""
    for begin, end in pairwise(places):
        yield Piece((end - begin) * seconds, (0, 0), (0, 0), (0, 0, 0), int(begin), end)


def _corner(first: Followed, second: Followed, proof: Told) -> list[tuple[int, int]]:
    """Check the blend around the corner between two motions; return bounds of the frame's speed while neither
    path is followed.
    """
    row, told, arm = first.motion.row, first.told, first.motion.arm
    title = row.entry.title
    far = Fraction(row.entry.blend or 0, 2) + 1
    inside = row.last - far <= first.end <= second.begin <= row.last + far
    need(inside, f"{title}: its path is left, or the next one joined, away from the corner between both")
    if first.end == second.begin and first.shares[1] == ONE and second.shares[0] == 0:
        return []
    ball = told.get("blend", [0, 0])
    need(min(ball) >= 0 and max(ball) > 0, f"{title}: a corner without a ball is left")
    limits = _per_joint([a + b for a, b in zip(ball, told["tolerance"], strict=True)], arm)
    one, share = (second, 0) if isinstance(first.what, Joints) else (first, ONE)
    corner = _Corner(one.path.at(share))
    if isinstance(one.what, Frames):
        limits = [in_si(ball[0] + told["tolerance"][0], 1, False), in_si(told["tolerance"][1], 1, True)]
    where = f"{title}, from its corner where a path is left"
    turned = [
        _left_out(left, share, end, one, corner, limits, where)
        for left, share, end in ((first, first.shares[1], ONE), (second, second.shares[0], 0))
    ]
    if isinstance(one.what, Frames):
        limits[1] = chord_of(limits[1] + sum(turned))
    what = Frames(arm, one.what.tool, first.motion) if isinstance(one.what, Frames) else first.what
    pieces = _still(cut(first.end, second.begin, whole(proof["corner"])), row.seconds)
    speeds = []
    for piece in distances(what, corner, pieces, what.at(first.end)):
        _within(what, limits, piece.off, f"{title}, from its corner in its blend")
        if isinstance(what, Frames):
            speeds.append(speeds_on(piece))
    return speeds


def _seen_from(told: Told, tool: Step) -> Step:
    """Return a frame on the flange as the frame of a motion sees it."""
    axes, origin = placed(told["tool"])
    away = [b - a for a, b in zip(origin, tool[1], strict=True)]
    return [[dot(axis, column) for axis in axes] for column in tool[0]], [dot(axis, away) for axis in axes]


def _left_out(
    left: Followed, share: int, end: int, one: Followed, corner: _Corner, limits: Sequence[int], where: str
) -> int:
    """Check that the section of a path that a blend leaves out is in the corner's ball; return how far the
    path turns there.

    The section is cut into pieces. On each, a point of the path is off the straight line between the ends by
    at most the square of the piece's size, times 1 / 8 of the second derivative.

    Args:
        left: the motion along this path.
        share: path parameter s at which the path is left or joined.
        end: path parameter s of the corner.
        one: the motion whose frame, or whose joints, have a ball.
        corner: the corner.
        limits: the ball.
        where: the place, for a message.
    """
    arm, size, turned = left.motion.arm, abs(end - share) // _CORNER + 1, 0
    ends = [share + (end - share) * k // _CORNER for k in range(_CORNER + 1)]
    states = [left.path.at(s) for s in ends]
    parts = [left.path.bends((min(pair), max(pair))) for pair in pairwise(ends)]
    bends = [max(bend[0] for bend in group) for group in zip(*parts, strict=True)]
    if isinstance(left.path, FramePath | PoseSpline) and isinstance(one.what, Frames):
        chords = (zip(a[1][0], b[1][0], strict=True) for a, b in pairwise(states))
        turned = sum(length(*(b - a for a, b in chord)) for chord in chords) * 7071 // 10000
        _, offset = _seen_from(left.told, one.what.tool)
        states = [[(_moved(state, offset), [])] for state in states]
        bends = [bends[0] + times(bends[1], length(*offset))]
    elif isinstance(one.what, Frames):
        fast = [
            max(abs(slope) for _, (slope,) in joint) + times(bend, size)
            for joint, bend in zip(zip(*states, strict=True), bends, strict=True)
        ]
        most = [max(abs(q) for (q,), _ in joint) for joint in zip(*states, strict=True)]
        slides = [a + times(b, size) for a, b in zip(most, fast, strict=True)]
        reach = arm.reaches(len(fast), arm.to_flange(one.what.tool[1]), slides)
        for joint in range(len(fast)):
            ways = (abs(b[joint][0][0] - a[joint][0][0]) for a, b in pairwise(states))
            turned += sum(ways) if arm.turns[joint] else 0
        bends = [derivative(2, arm.turns, reach, fast, bends, bends)[0]]
        places = ([q for (q,), _ in state] for state in states)
        states = [[(arm.frame(q, [0] * len(q), one.what.tool).origin, [])] for q in places]
    off = []
    for group, bend in enumerate(bends):
        meant, _ = corner.at(0)[group]
        far = max(length(*(a - b for a, b in zip(state[group][0], meant, strict=True))) for state in states)
        off.append(far + times(bend, size, size) // 8 + SLACK)
    _within(one.what, limits[: len(off)], off, where)
    return turned


def _moved(state: State, offset: Vector) -> Vector:
    """Return the place of a point that is given in a frame."""
    (origin, _), (axes, _) = state
    return [o + dot(axes[k::3], offset) for k, o in enumerate(origin)]


def _speeds(
    chain: Sequence[Link], found: Sequence[Followed], balls: Sequence[list[tuple[int, int]]], proofs: Told
) -> Iterator[str]:
    """Check the speeds of a chain against the programmed speeds and ceilings; yield what isn't checked. In a
    blend, the larger limit of its two motions applies.
    """
    around = [_larger(one, other) for (_, one), (_, other) in pairwise(chain)]
    for number, ((row, told), path) in enumerate(zip(chain, found, strict=True)):
        begin, end = row.first + Fraction(row.before or 0, 2), row.last - Fraction(row.entry.blend or 0, 2)
        if told["move"] not in FRAMED:
            yield from _speed_of_joints(path, proofs[str(row.entry.step)], len(chain) == 1)
            continue
        own = []
        for segment, speed in zip(path.segments, path.speeds, strict=True):
            if begin <= segment < end:
                own.append(speed)
            else:
                check_speeds(around[number - (segment < begin)], [speed], f"{row.entry.title}, in a blend")
        if own:
            before = number > 0 and not balls[number - 1] and _is_slower(told, chain[number - 1][1])
            behind = number < len(balls) and not balls[number] and _is_slower(told, chain[number + 1][1])
            slow = check_speeds(told, own, row.entry.title, (before, behind))
        else:
            slow = "its speed, since blends take all of it" if "speed" in told or "ceiling" in told else ""
        if slow:
            yield f"{row.entry.title}: {slow}"
    for (row, _), limit, speeds in zip(chain, around, balls, strict=False):
        if speeds:
            check_speeds(limit, speeds, f"{row.entry.title}, in a blend")


def _speed_of_joints(path: Followed, proof: Told, alone: bool) -> Iterator[str]:
    """Check the speed ceiling of a frame during a joint motion from rest to rest; yield what isn't
    checked.
    """
    told, title = path.told, path.motion.row.entry.title
    if "speed" in told:
        yield f"{title}: its speed"
    if "ceiling" in told and not (alone and "tool" in told):
        yield f"{title}: its ceiling, and that of its corners"
    elif "ceiling" in told:
        frame = Frames(path.motion.arm, placed(told["tool"]), path.motion)
        here = frame.at(path.begin)
        pieces = distances(frame, _Corner(here), pieces_of(path.motion, proof), here)
        check_speeds({"ceiling": told["ceiling"]}, [speeds_on(piece) for piece in pieces], title)


def _is_slower(one: Told, other: Told) -> bool:
    """Return True if a motion has a programmed speed that the motion beside it reaches as well."""
    own, besides = _speed(one), _speed(other)
    if own is None or besides is None:
        return False
    return bool(own * one.get("kept", 1) <= besides * other.get("kept", 1))


def _speed(told: Told) -> Fraction | None:
    """Return the programmed speed of a frame's origin; None for motions without one."""
    return told["speed"][0] if told["move"] in FRAMED and "speed" in told else None


def _larger(one: Told, other: Told) -> dict[str, Fraction]:
    """Return the speed ceiling in a blend of two motions [mm/s]: the larger speed or ceiling, if both have
    one.
    """
    own, besides = _speed(one), _speed(other)
    tops = [] if own is None or besides is None else [max(own, besides)]
    if "ceiling" in one and "ceiling" in other and {one["move"], other["move"]} <= set(FRAMED):
        tops.append(max(one["ceiling"], other["ceiling"]))
    return {"ceiling": min(tops)} if tops else {}
