"""Check that each motion follows its path, and that blends between motions stay near the corners of their
paths.

A motion from rest to rest is a chain of one. Each path begins at the programmed goal of the motion before,
also where the robot rests: if it began where the text's numbers lead, a turn of nearly 180 deg could go the
other way round. After a pose, the path of a joint motion begins at joint positions that the proof has chosen
for the pose. The proof names the places of the controller text between which a motion follows its path. A
corner needs no further check if the first path is followed to its end, and the second one from its start on,
without a gap. Otherwise the proof gives the radius of a ball around the corner. In the blend, the frame stays
in the ball within the tolerance, and so do the sections of both paths that are not followed. The frame's
angle from the corner is at most the tolerance plus the rotations in these sections. Between two joint
motions, each joint has a ball (an interval) of its own.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import chain as joined
from itertools import pairwise
from typing import Any

from yarclang.verify.arm import Arm, Frame, Step, Vector, beyond, derivative, dot, in_si, placed
from yarclang.verify.course import Moved
from yarclang.verify.exact import ONE, PI, SLACK, above, fixed, length, need, times, whole
from yarclang.verify.joints import Joints, Pieces, in_joints, through, timetable
from yarclang.verify.paths import (
    SHARE,
    FramePath,
    Frames,
    Motion,
    Piece,
    State,
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
"""Kinds of motions that move a frame along a path. All others move joints."""
_CHOSEN = Fraction(1, 1000)
"""Largest deviation from a corner's pose at the joint positions chosen for this pose [mm and deg]."""
_CORNER = 32
"""Number of pieces into which the section of a path that a blend leaves out is cut."""
_STILL: Vector = [0, 0, 0]
_FASTEST = Fraction(1 << 20)
"""Speed that stands for "no limit", since no robot is as fast [mm/s or deg/s]."""
_OFF = Fraction(1, 1000)
"""Allowed deviation from a programmed speed, or excess over a ceiling, as a fraction of this speed."""
Speed = tuple[int, list[tuple[int, int, int]]]
"""The index of a segment, and two triples of speeds on a piece of it (least, largest, larger of both ends):
those of the frame's origin [m/s], and those of its rotation [rad/s].
"""


@dataclass
class Followed:
    """A motion that was shown to follow its path.

    Attributes:
        motion: the motion.
        told: the proof's description of the motion.
        what: the frame or the joints that follow the path.
        path: the path.
        begin: place in the controller text from which on the path is followed.
        end: place up to which the path is followed.
        shares: range of the path parameter s that is followed.
        speeds: the frame's speeds on each piece of time; empty without a programmed speed or a ceiling.
    """

    motion: Motion
    told: Told
    what: Frames | Joints
    path: FramePath | PoseSpline | Pieces
    begin: Fraction
    end: Fraction
    shares: tuple[int, int]
    speeds: list[Speed] = field(default_factory=list)


def chains_of(rows: Sequence[Moved], steps: Sequence[Told]) -> Iterator[list[Link]]:
    """Yield the chains of blended motions. A motion from rest to rest is a chain of one, even if it has no
    move lines.

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
    need(not chain, "a motion flows into one that has no moves, or that isn't there")


def why_not(chain: Sequence[Link], proofs: dict[str, Any]) -> str:
    """Return the reason why the paths of a chain are not checked; empty if they are."""
    for row, told in chain:
        if told.get("unchecked"):
            return f"the proof says {str(told['unchecked'])!r}"
        if len(chain) > 1 and not row.control:
            return "a motion among them that leads nowhere"
        strange = not {"speed", "ceiling", "blend"}.isdisjoint(told)
        if told["move"] == "timetable" and (strange or len(chain) > 1 or not row.control):
            return "a timetable with a speed, or that a motion flows into, or that leads nowhere"
        if row.control and str(row.entry.step) not in proofs:
            return "its path, of which the proof says nothing"
        if not row.control and told["move"] in FRAMED[1:]:
            return f"its path, {told['move']}, which leads nowhere"
    return ""


def check_chain(
    chain: Sequence[Link], proofs: dict[str, Any], arm: Arm, stood: Told, notes: list[str]
) -> Iterator[str]:
    """Check a chain of blended motions, or a motion from rest to rest; yield the properties that are not
    checked.

    Args:
        chain: the motions, each with its description in the proof.
        proofs: the proof's data about motions, by the motion's step.
        arm: the arm.
        stood: the description of the motion before the chain.
        notes: list to which is added when corners without a ball are passed, and which joint positions are
            chosen for poses.
    """
    found, late = list[Followed](), Fraction(0)
    for row, told in chain:
        title, (position, angle) = row.entry.title, told["tolerance"]
        need(position > 0 and angle > 0, f"{title}: a tolerance that isn't above 0")
        if "duration" in told:
            # The duration may be off by half a step of the controller's resolution for each segment; in a
            # timetable, whose segment times are rounded up, by a whole step. In a chain, half a segment is
            # added: a motion ends between two segments, even if its corner lies within one.
            segments, halves = row.last - row.first, 1 + (told["move"] == "timetable")
            late += segments * row.seconds - told["duration"]
            allowed = Fraction(segments * halves, 2 * STEPS * 1000) + Fraction(1, 10**9)
            allowed += row.seconds / 2 if len(chain) > 1 else 0
            need(abs(late) <= allowed, f"{title}: it takes another time")
        if not row.control:
            _stays(row, told, arm)
            return
        if told["move"] == "timetable":
            _on_time(row, told, proofs[str(row.entry.step)], arm, stood)
            return
        before = found[-1] if found else None
        found.append(_follow(row, told, proofs[str(row.entry.step)], arm, stood, before))
        stood = told
        if isinstance(found[-1].path, Pieces) and any(goal["q"] is None for goal in told["through"]):
            goal = found[-1].path.goal
            each = zip(goal, arm.turns, strict=True)
            said = [Fraction(one * 180, PI) if turns else Fraction(one * 1000, ONE) for one, turns in each]
            notes.append(
                f"{title} ends at the joint positions {' '.join(f'{float(one):.6g}' for one in said)}"
            )
    first, last = found[0], found[-1]
    begins = first.begin == chain[0][0].first and first.shares[0] == 0
    ends = last.end == chain[-1][0].last and last.shares[1] == ONE
    need(begins and ends, f"{title}: not shown to follow its path from its start to its end")
    pairs = [_corner(one, other, proofs[str(one.motion.row.entry.step)]) for one, other in pairwise(found)]
    kept = [False, *pairs, False]
    for one in found[:-1]:
        row, off = one.motion.row, (one.end - one.motion.row.last) * one.motion.row.seconds
        if max(one.told.get("blend", [0])) == 0:
            side = "after" if off > 0 else "before"
            notes.append(
                f"{row.entry.title} passes its corner {abs(float(off)):.3f} s {side} its blend's middle"
            )
    sharp = [None if max(one.told.get("blend", [0])) > 0 else one.end for one in found[:-1]]
    corners = [None, *sharp, None]
    for number, path in enumerate(found):
        besides = [found[k].told if 0 <= k < len(found) else None for k in (number - 1, number + 1)]
        yield from _check_speeds(path, besides, kept[number : number + 2], corners[number : number + 2])


def _stays(row: Moved, told: Told, arm: Arm) -> None:
    """Check that the goal of a motion without move lines is where the robot already is."""
    title, here = row.entry.title, in_joints(row.begin, PRINTED, arm.turns)
    if told["move"] in FRAMED:
        _near(arm, here, told, told["tolerance"], f"{title}: it leads nowhere, and its goal")
        return
    for point in _goals(row, told, {}, arm):
        there = zip(point, here, _per_joint(told["tolerance"], arm), strict=True)
        need(all(abs(a - b) <= allowed for a, b, allowed in there), f"{title}: it doesn't move")


def _on_time(row: Moved, told: Told, proof: Told, arm: Arm, stood: Told) -> None:
    """Check that each joint is at the timetable's position at any time, within the joint's tolerance in
    `within`.

    The motion is cut into pieces, also at the timetable's rows. The segments' total duration differs from the
    timetable's by the rounding of the segment time. The difference is spread evenly over all segments.
    """
    title, motion, rows = row.entry.title, Motion(row, arm), told["rows"]
    stands = _stands(row, stood, proof, arm, in_joints(row.begin, PRINTED, arm.turns))
    table = timetable(stands, rows, arm.turns)
    size = motion.end - motion.begin
    need(
        abs(told["duration"] - rows[-1]["at"]) < Fraction(1, 10**9), f"{title}: its table takes another time"
    )
    limits, most = in_joints(told["within"], 1, arm.turns), _per_joint(told["tolerance"], arm)
    need(
        all(a <= b for a, b in zip(limits, most, strict=True)),
        f"{title}: a joint's part beyond its tolerance",
    )
    if rows[0]["q"] is not None:  # the first row must be where the path begins
        first = zip(in_joints(rows[0]["q"], 1, arm.turns), table.at(0), strict=True)
        _within(
            Joints(motion), limits, [abs(a - b) for a, ((b,), _) in first], f"{title}, from its first row"
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

    The proof may give only a pose for the last goal. The joint positions are then those at the motion's end,
    or in a chain the `goal` of the proof.
    """
    title, flows = row.entry.title, row.entry.blend is not None
    for goal in told["through"]:
        need(goal["q"] is not None or "pose" in goal, f"{title}: a goal that is nowhere")
        of_text = goal["q"] is None and not flows
        if of_text:
            point = in_joints(row.end, PRINTED, arm.turns)
        else:
            point = in_joints(proof["goal"] if goal["q"] is None else goal["q"], 1, arm.turns)
        if "pose" in goal:
            limits = told["tolerance"] if of_text else [_CHOSEN, _CHOSEN]
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


def _follow(row: Moved, told: Told, proof: Told, arm: Arm, stood: Told, before: Followed | None) -> Followed:
    """Check that a motion follows its path.

    Args:
        row: the motion.
        told: the proof's description of the motion.
        proof: the proof's data about the motion.
        arm: the arm.
        stood: the proof's description of the motion before.
        before: the motion before, if it flows into this one.
    """
    title, motion = row.entry.title, Motion(row, arm)
    for name in ("s", "rates"):
        proof[name] = [whole(one) for one in proof[name]]
    begin, end = span_of(motion, proof)
    what: Frames | Joints
    path: FramePath | PoseSpline | Pieces
    if told["move"] in FRAMED:
        tool = placed(told["tool"])
        start = _begins(stood, tool, arm)
        curve = PoseSpline if told["move"] == "spline of poses" else FramePath
        what, path = Frames(arm, tool, motion), curve(start, told, proof)
        limits = [in_si(told["tolerance"][0], 1, False), chord_of(in_si(told["tolerance"][1], 1, True))]
    else:
        what, path = Joints(motion), _of_joints(row, told, proof, arm, stood, before)
        limits = _per_joint(told["tolerance"], arm)
    first, last = (fixed(Fraction(proof["s"][k], SHARE)) for k in (0, -1))
    found = Followed(motion, told, what, path, begin, end, (first, last))
    state, most = what.at(begin), [0] * len(limits)
    if first in (0, ONE):  # without pieces, this is the only check of an end of the path
        off = error(state, path.at(first), fixed(Fraction(proof["rates"][0], SHARE)))
        most = [length(*e) + SLACK for e, _ in off]
    for piece in distances(what, path, pieces_of(motion, proof), state):
        most = [max(pair) for pair in zip(most, piece.off, strict=True)]
    _within(what, limits, most, f"{title}, from its path")
    if "tolerance_of" in told:  # TOL of a joint motion may refer to a frame
        led = Frames(arm, placed(told["tolerance_of"]), motion)
        slides = sum(off for off, turns in zip(most, arm.turns, strict=True) if not turns)
        ways = zip(most, led.reach, arm.turns, strict=True)
        far = slides + sum(times(off, reach + slides) for off, reach, turns in ways if turns)
        _within(led, [in_si(told["tolerance"][0], 1, False)], [far], f"{title}, from its way")
    if not {"speed", "ceiling"}.isdisjoint(told) and "tool" in told:
        moved = what if isinstance(what, Frames) else Frames(arm, placed(told["tool"]), motion)
        found.speeds = list(_speeds(moved, motion, (begin, end), whole(proof.get("speeds", proof["pieces"]))))
    return found


def _goal(told: Told) -> Told:
    """Return the last goal of a motion: the numbers of its pose, of its joint positions, or of both."""
    goals: list[Told] = [told] if told["move"] in FRAMED else told.get("rows") or told["through"]
    return goals[-1]


def _stands(row: Moved, stood: Told, proof: Told, arm: Arm, here: Sequence[int]) -> Vector:
    """Return the joint positions at which the path of a joint motion begins: those of the goal of the motion
    before. If that goal is a pose, the proof has chosen joint positions for it, in the posture of the joint
    positions `here`.
    """
    goal = _goal(stood)
    if goal.get("q") is not None:
        return in_joints(goal["q"], 1, arm.turns)
    start = in_joints(proof["start"], 1, arm.turns)
    what = f"{row.entry.title}: the joints that were chosen for the goal before, where the frame"
    _near(arm, start, goal, [_CHOSEN, _CHOSEN], what)
    apart = (abs(a - b) for a, b, turns in zip(start, here, arm.turns, strict=True) if turns)
    need(max(apart, default=0) < PI // 2, f"{what} is in another posture")
    return start


def _begins(stood: Told, tool: Step, arm: Arm) -> Step:
    """Return the pose of a frame on the flange, `tool`, at the programmed goal of a motion."""
    if "pose" in (goal := _goal(stood)):
        axes, origin = placed(goal["pose"])
        frame = beyond(Frame(origin, axes, _STILL, _STILL), _seen_from(goal, tool))
    else:
        frame = arm.frame(in_joints(goal["q"], 1, arm.turns), [0] * len(arm.turns), tool)
    return frame.axes, frame.origin


def _within(what: Frames | Joints, limits: Sequence[int], off: Sequence[int], where: str) -> None:
    """Refuse a frame, or joints, that may be farther from their path or corner than the limits allow."""
    for number, (limit, one) in enumerate(zip(limits, off, strict=True)):
        if isinstance(what, Joints):
            who = f"joint {number + 1} is {one / ONE:.6g} rad or m"
        else:
            who = "turned too far" if number else f"{one / ONE * 1000:.6g} mm"
        need(one <= limit, f"{where}: {who} away")


def _of_joints(row: Moved, told: Told, proof: Told, arm: Arm, stood: Told, before: Followed | None) -> Pieces:
    """Return the programmed path of a joint motion."""
    if before is not None and isinstance(before.path, Pieces):
        start = before.path.goal
    else:
        here = in_joints(row.begin, PRINTED, arm.turns) if before is None else before.motion.at(before.end)[0]
        start = _stands(row, stood, proof, arm, here)
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
    """Yield the time intervals between places. Their path parameter s stays 0."""
    for begin, end in pairwise(places):
        yield Piece((end - begin) * seconds, (0, 0), (0, 0), (0, 0, 0), int(begin), end)


def _corner(first: Followed, second: Followed, proof: Told) -> bool:
    """Check the blend around the corner between two motions; return True if both paths are followed up to the
    corner.
    """
    row, told, arm = first.motion.row, first.told, first.motion.arm
    title = row.entry.title
    half, ball = (row.entry.blend or 0) // 2, told.get("blend", [0, 0])
    far = half + 1
    inside = row.last - far <= first.end <= second.begin <= row.last + far
    need(inside, f"{title}: its path is left, or the next one joined, away from the corner between both")
    is_kept = first.end == second.begin and first.shares[1] == ONE and second.shares[0] == 0
    if is_kept and not (half and max(ball) > 0):
        return True
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
    # Everything that the map calls a blend is in the ball, also what follows a path.
    begin, end = min(first.end, Fraction(row.last - half)), max(second.begin, Fraction(row.last + half))
    here, where = what.at(begin), f"{title}, from its corner in its blend"
    _within(what, limits, [length(*off) + SLACK for off, _ in error(here, corner.at(0), 0)], where)
    pieces = _still(cut(begin, end, whole(proof.get("corner", proof["pieces"]))), row.seconds)
    for piece in distances(what, corner, pieces, here):
        _within(what, limits, piece.off, where)
    return is_kept


def _seen_from(told: Told, tool: Step) -> Step:
    """Return the pose of a frame on the flange, `tool`, in the frame that the motion `told` moves."""
    axes, origin = placed(told["tool"])
    away = [b - a for a, b in zip(origin, tool[1], strict=True)]
    return [[dot(axis, column) for axis in axes] for column in tool[0]], [dot(axis, away) for axis in axes]


def _left_out(
    left: Followed, share: int, end: int, one: Followed, corner: _Corner, limits: Sequence[int], where: str
) -> int:
    """Check that the section of a path that a blend leaves out is in the corner's ball; return the angle by
    which the frame turns on this section.

    The section is cut into pieces. On each piece, the path is off its chord by at most 1 / 8 of the second
    derivative times the square of the piece's size.

    Args:
        left: the motion whose path is left or joined.
        share: path parameter s at which the path is left or joined.
        end: path parameter s of the corner.
        one: the motion whose frame, or whose joints, have a ball.
        corner: the corner.
        limits: radius of the ball, of the frame or of each joint.
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
    """Return a point in {B}, given its coordinates `offset` in a frame, and the state of this frame."""
    (origin, _), (axes, _) = state
    return [o + dot(axes[k::3], offset) for k, o in enumerate(origin)]


def _speeds(frame: Frames, motion: Motion, span: tuple[Fraction, Fraction], pieces: int) -> Iterator[Speed]:
    """Yield the speeds of a frame on the pieces of a motion's time, also in its blends, and where it follows
    its path outside of its own segments.
    """
    begin, end = min(motion.begin, span[0]), max(motion.end, span[1])
    here = frame.at(begin)
    still = _still(cut(begin, end, pieces), motion.row.seconds)
    for piece in distances(frame, _Corner(here), still, here):
        yield piece.piece.segment, [speeds_on(piece, group) for group in (0, 1)]


def _limit(told: Told | None, name: str, group: int) -> Fraction | None:
    """Return the ceiling or the programmed speed of a motion [mm/s or deg/s]; None without one."""
    if told is None or name not in told or (name == "speed" and told["move"] not in FRAMED):
        return None
    limit: Fraction | None = told[name][group] if name == "speed" else told[name]
    return limit


def _check_speeds(
    path: Followed,
    besides: Sequence[Told | None],
    kept: Sequence[bool],
    corners: Sequence[Fraction | None],
) -> Iterator[str]:
    """Check the speeds of a frame against its ceiling and its programmed speed; yield what isn't checked.

    In a blend with a ball, the larger of both motions' ceilings applies, and the larger of their programmed
    speeds. At a corner without a ball, they apply up to a segment before and after the corner; beyond the
    corner, only those of the other motion apply. Between its ramps, a motion keeps its programmed speed: an
    angular speed if the path only turns the frame.

    Args:
        path: the motion.
        besides: the motions before and after it in the chain; None at an end of the chain.
        kept: for each of them, True if both paths are followed up to the corner between them.
        corners: for each of them, the place of a corner without a ball; None for any other.
    """
    row, told, title = path.motion.row, path.told, path.motion.row.entry.title
    halves = (row.before or 0) // 2, (row.entry.blend or 0) // 2
    blends = row.first + halves[0], row.last - halves[1]
    begin, end = (blend if at is None else at for blend, at in zip(blends, corners, strict=True))
    group = 0 if isinstance(path.path, Pieces) else path.path.group
    limits = [("ceiling", 0), *([] if group is None else [("speed", group)])]
    for name, of in limits:
        own = _limit(told, name, of)
        if own is None or not path.speeds:
            if name in told:
                yield f"{title}: its {name}"
            continue
        around = [own if one is None else _limit(one, name, of) for one in besides]
        for segment, speeds in path.speeds:
            ways = begin - segment, segment + 1 - end  # how far the segment reaches out of the motion
            tops: list[Fraction | None] = [own]
            for top, way, corner in zip(around, ways, corners, strict=True):
                if way > -1:
                    tops = [top] if corner is not None and way > 2 else [*tops, top]
            top = max(_FASTEST if one is None else one for one in tops)
            need(speeds[of][1] <= in_si(top * (1 + _OFF), 1, of == 1), f"{title}: faster than its {name}")
    speed = None if group is None else _limit(told, "speed", group)
    if speed is None or group is None or not path.speeds:
        return
    share = told.get("kept", Fraction(1))
    need(0 < share <= 1, f"{title}: a share of a speed beyond 1")
    slow = in_si(speed * share * (1 - _OFF), 1, group == 1) + 1
    found = [speeds[group] for segment, speeds in path.speeds if begin <= segment < segment + 1 <= end]
    steady = [k for k, (low, _, _) in enumerate(found) if low >= slow]
    if not steady:  # the speed is reached only for an instant, or blends take the whole motion
        need(not found or max(end for _, _, end in found) >= slow, f"{title}: slower than its speed")
        return
    held = [flows and group == 0 and _is_slower(told, one) for flows, one in zip(kept, besides, strict=True)]
    first, last = 0 if held[0] else steady[0], len(found) if held[1] else steady[-1] + 1
    least = min(low for low, _, _ in found[first:last])
    need(least >= slow, f"{title}: slower than its speed between its ramps")


def _is_slower(one: Told, other: Told | None) -> bool:
    """Return True if a motion's programmed speed isn't above that of the motion beside it."""
    own, besides = _limit(one, "speed", 0), _limit(other, "speed", 0)
    if own is None or besides is None or other is None:
        return False
    return bool(own * one.get("kept", 1) <= besides * other.get("kept", 1))
