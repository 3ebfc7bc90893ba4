"""Programs by chance: all motions, profiles, times and blends, on several arms; and a judge of what they compile to.

The judge reads the emitted text with tests/independent.py. Which joint positions were chosen for poses it takes from the plan, and
checks that they are solutions.
"""

import re
from dataclasses import dataclass, replace

import independent
import numpy as np
import random_timetables
from independent_paths import Said, goals_from, off, path
from scipy.spatial.transform import Rotation

PROFILES = ("", "_LSPB", "_POLY5", "_SCURVE", "_TOPP")
TIMES = ("[MIN]", "[MIN]", "[4.7]", "[3]", "[6]", "[5]", "[50%]")
SPEEDS = ("[V 20]", "[V 50]", "[V 80]")
"""None so slow that a motion has thousands of segments, which take long and ask no more."""

BENT = {
    "INDUSTRIAL6": np.array([0, -5, -20, 10, 40, 0]),
    "TIAGO": np.array([100, 20, 0, 0, 0, 0, 0, 0]),
}
"""How far from HOME [deg, mm] arms have room around them: the wrist of one is straight there, the shoulder of the other is beside its column as long as that is low."""

KINDS = (
    "joints",
    "joints_to_pose",
    "joint_delta",
    "joint_spline",
    "line",
    "line",
    "delta",
    "arc",
    "pose_spline",
)


@dataclass
class Program:
    """A program's text, and what each of its motions says, by step."""

    text: str
    said: dict[int, Said]


def drawn(arm, random, most=5):
    """A program of a few motions about the arm's middle."""
    middle = _middle(arm)
    room = np.minimum(arm.upper - middle, middle - arm.lower)
    (point,), turns = arm.poses(middle[None])
    reach = np.linalg.norm(point) / 10.0
    lines, said = _begun(arm, middle)
    step = len(said)
    # way-points as far apart as a joint that turns once and more allows lead nearly all splines of such an arm into itself
    spread = np.where(room > 180.0, 100.0, room)
    can_follow = len(middle) >= 6
    # an arm of many joints soon runs into one of their limits: most of what is drawn would be refused
    near = 0.5 if len(middle) > 7 else 1.0
    reach *= near

    poses = 0

    def written(shift, rpy):
        """The values of a pose: of every third motion under a name that stands for it, of others out of a table."""
        nonlocal poses
        text = _numbers([*shift, *rpy])
        if step % 3 == 2:
            return text
        poses += 1
        if step % 3 == 1:
            lines.append(f"TABLE VALUES{poses} {text}")
            return " ".join(f"$(VALUES{poses}[{number}])" for number in range(6))
        lines.append(f"POSE AT{poses} {text}")
        return f"AT{poses}"

    def pose(size=1.0):
        shift = np.round(point + random.uniform(-1, 1, 3) * reach * size, 3)
        rpy = np.round(turns[0].as_euler("xyz", degrees=True) + random.uniform(-25, 25, 3) * size * near, 3)
        return shift, rpy, (shift, Rotation.from_euler("xyz", rpy, degrees=True))

    for _ in range(random.integers(1, most + 1)):
        kind = str(random.choice(KINDS if can_follow else ("joints", "joint_delta", "joint_spline")))
        profile = str(random.choice(PROFILES))
        time = str(random.choice(TIMES))
        of_frame = kind in ("line", "delta", "arc", "pose_spline")
        if of_frame and profile in ("", "_LSPB", "_SCURVE") and random.random() < 0.25:
            time = str(random.choice(SPEEDS))
        elif time == "[MIN]" and step % 3 == 1:
            time = f"[V<={40 + 30 * (step % 4)}]"
        common = {"profile": profile[1:] or "LSPB", "time": time}
        if kind in ("joints", "joint_delta"):
            size = random.choice([0.05, 0.3, 0.8])
            away = np.round(random.uniform(-1, 1, len(middle)) * room * size, 4)
            if kind == "joints":
                goal = np.round(middle + away, 4)
                words, one = f"MOVEJ{profile} {_numbers(goal)}", Said("joints", [goal], **common)
            else:
                away = np.round(away * 0.2, 4)
                words = f"DMOVEJ{profile} {_numbers(away)}"
                one = Said("joints", [away], relative=True, **common)
        elif kind == "joint_spline":
            goals = [
                np.round(middle + random.uniform(-1, 1, len(middle)) * spread * 0.4, 4)
                for _ in range(random.integers(2, 5))
            ]
            words = f"MOVEJ_SPLINE{profile} {'; '.join(map(_numbers, goals))}"
            one = Said("joint_spline", goals, **common)
        elif kind == "joints_to_pose":
            shift, rpy, goal = pose()
            words = (
                f"MOVEJ{'_RPY' if step % 2 else ''}{profile} {written(shift, rpy)}"
                if step % 3 == 0
                else f"MOVEJ_RPY{profile} {_numbers([*shift, *rpy])}"
            )
            one = Said("joints", [goal], **common)
        elif kind == "line":
            shift, rpy, goal = pose()
            words, one = f"MOVEL{profile} {written(shift, rpy)}", Said("line", [goal], **common)
        elif kind == "delta":
            shift = np.round(random.uniform(-1, 1, 3) * reach * 0.5, 3)
            rpy = np.round(random.uniform(-12, 12, 3) * near, 3)
            words = f"DMOVE{profile} {_numbers([*shift, *rpy])}"
            goal = (shift, Rotation.from_euler("xyz", rpy, degrees=True))
            one = Said("line", [goal], relative=True, **common)
        elif kind == "arc":
            via = pose(0.7)[0]
            shift, rpy, goal = pose(0.7)
            words = f"MOVEC{profile} {_numbers(via)}; {written(shift, rpy)}"
            one = Said("arc", [goal], via=via, **common)
        else:
            through = [pose(0.6) for _ in range(random.integers(2, 5))]
            values = "; ".join(written(shift, rpy) for shift, rpy, _ in through)
            words = f"MOVEL_SPLINE{profile} {values}"
            one = Said("pose_spline", [goal for _, _, goal in through], **common)
        options = ""
        if random.random() < 0.15:
            one.acc = float(random.choice([0.3, 0.6]))
            options += f" ACC {one.acc * 100:g}%"
        if random.random() < 0.55:
            one.blend = float(random.choice([0.3, 1, 3, 8, 20]))
            options += f" BLEND {'<=' * (step % 3 == 0)}{one.blend:g}"
        base = " {TCP}" if kind == "delta" else ""
        lines.append(f"P{(step + 1) * 10:04d} {words} {time}{base}{options}")
        said[step] = one
        step += 1
        if random.random() < 0.15:
            state, index = random.choice(["ON", "OFF"]), f"P{(step + 1) * 10:04d}"
            # which makes three steps, at rest
            is_pulse = step % 4 == 0
            lines.append(f"{index} PULSE LAMP [0.2]" if is_pulse else f"{index} SET LAMP {state}")
            step += 3 if is_pulse else 1
    if random.random() < 0.25:
        # from the middle, wherever the motions before lead to; into a WAIT nothing flows
        lines.append(f"P{(step + 1) * 10:04d} WAIT [0.1]")
        step += 1
        lines.append(f"P{(step + 1) * 10:04d} MOVEJ {_numbers(middle)} [MIN]")
        said[step] = Said("joints", [np.round(middle, 4)])
        table = random_timetables.drawn(
            arm, random, str(random.choice(random_timetables.KINDS)), np.round(middle, 4)
        )
        stretch = float(random.choice([3.0, 4.5]))
        option = f" STRETCH {stretch:g}"
        lines.append(f"P{(step + 2) * 10:04d} MOVEJ_TIMED {table.way()}{option}")
        said[step + 1] = Said("timed", list(table.rows), table=table, stretch=stretch)
    if len(lines) % 3 == 0:  # draws nothing, so that programs of earlier seeds stay what they were
        lines[:0] = ["INPUT CURTAIN M11", "ON CURTAIN OFF HOLD"]
    return Program("\n".join(lines) + "\n", said)


def _begun(arm, middle):
    """The first lines of a program, and what is said there by step."""
    lines = ["OUTPUT LAMP M1 OFF", "DEFAULT {TCP} (mm,deg,s) {B}"]
    if (middle == arm.data["positions"]["HOME"]).all():
        return lines, {}
    return [*lines, f"P0001 MOVEJ {_numbers(middle)} [MIN]"], {0: Said("joints", [np.round(middle, 4)])}


def drawn_chain(arm, random):
    """A program of chains of short pieces: lines, arcs, splines of poses, increments, turns of the tool; with stops, outputs and waits between."""
    middle = _middle(arm)
    (point,), turns = arm.poses(middle[None])
    lines, said = _begun(arm, middle)
    step, turn, begin = len(said), turns[0], point
    # parts of up to 40 motions are tried in several ways, which takes seconds
    is_long = random.random() < 0.7
    count = int(random.integers(43, 52)) if is_long else 3
    stops = {count - 3} if is_long and random.random() < 0.4 else set()
    ball = float(random.choice([0.0, 0.3, 0.3]))
    times = random.choice([*SPEEDS, "[MIN]"], 2)
    plane = Rotation.random(random_state=int(random.integers(2**31))).as_matrix()[:, :2]
    bend = float(random.choice([0.02, 0.1, 0.6])) if ball else 0.01
    turning = float(random.choice([0.0, 0.0, 0.3, 1.0]))
    axis, heading = Rotation.random(random_state=int(random.integers(2**31))).as_matrix()[0], 0.0
    still = int(random.integers(count)) if random.random() < 0.1 else None
    for number in range(count):
        kind = str(random.choice(["line", "arc", "pose_spline", "delta"], p=[0.7, 0.12, 0.08, 0.1]))
        size = (
            0.0
            if number == still
            else float(random.uniform(0.7, 3.0)) * (1.0 if kind in ("line", "delta") else 2.0)
        )
        tilt = turning * np.sign((number // 12) % 2 - 0.5) * size + (2.0 if number == still else 0.0)
        # a single short piece, or one of a few, may be too short for its speed
        common = {
            "time": str(times[number * 2 // count]) if is_long and number < count - 2 else "[MIN]",
            "tol": 0.05,
        }
        goals, before = [], (begin, turn)
        for _ in range(2):
            heading += 0.5 * random.normal(0.0, bend) + 0.5 * bend * np.sin(number / 6.0)
            begin = begin + 0.5 * size * plane @ [np.cos(heading), np.sin(heading)]
            turn = Rotation.from_rotvec(np.radians(0.5 * tilt) * axis) * turn
            rpy = np.round(turn.as_euler("xyz", degrees=True), 4)
            goals.append(
                (np.round(begin, 4), rpy, (np.round(begin, 4), Rotation.from_euler("xyz", rpy, degrees=True)))
            )
        (via, rpy, half), (place, last, goal) = goals
        if number == still or kind == "line":
            words, one = f"MOVEL {_numbers([*place, *last])}", Said("line", [goal], **common)
        elif kind == "arc":
            words, one = (
                f"MOVEC {_numbers(via)}; {_numbers([*place, *last])}",
                Said("arc", [goal], via=via, **common),
            )
        elif kind == "pose_spline":
            words = f"MOVEL_SPLINE {_numbers([*via, *rpy])}; {_numbers([*place, *last])}"
            one = Said("pose_spline", [half, goal], **common)
        else:
            turn = before[1]
            shift = np.round(turn.inv().apply(begin - before[0]), 4)
            begin = before[0] + turn.apply(shift)
            words = f"DMOVE {_numbers([*shift, 0, 0, 0])}"
            one = Said("line", [(shift, Rotation.identity())], relative=True, **common)
        options = " TOL 0.05"
        if number < count - 1 and number not in stops:
            one.blend = ball if is_long else min(ball, 0.25)
            options += f" BLEND {one.blend:g}"
        base = " {TCP}" if one.relative else ""
        lines.append(f"P{(step + 1) * 10:04d} {words} {one.time}{base}{options}")
        said[step] = one
        step += 1
        if number in stops or random.random() < 0.03:
            stands = number in stops and random.random() < 0.5
            lines.append(f"P{(step + 1) * 10:04d} {'WAIT [0.1]' if stands else 'SET LAMP ON'}")
            step += 1
    return Program("\n".join(lines) + "\n", said)


def features(program):
    """Yield for each motion of a program what it is counted as: its kind, law and time, and what is said beside these.

    The last motion has nothing to flow into, so its BLEND isn't counted.
    """
    steps = sorted(program.said)
    for step in steps:
        one = program.said[step]
        to_pose = one.kind == "joints" and isinstance(one.goals[-1], tuple)
        kind = f"{one.kind}{' of a pose' if to_pose else ''}{' by an increment' if one.relative else ''}"
        if one.speed is not None:
            time = "speed"
        elif one.ceiling is not None:
            time = "ceiling"
        elif one.seconds is not None:
            time = "seconds"
        else:
            time = "share" if one.share < 1.0 else "shortest time"
        # behind the last one drawn stands a WAIT where a timetable follows
        flows = step != (steps[-3] if program.said[steps[-1]].kind == "timed" else steps[-1])
        beside = {"ACC": one.acc < 1.0, "BLEND": one.blend is not None and flows}
        if one.kind == "timed":
            yield step, ("motions", kind)
            continue
        yield step, ("motions", kind, one.profile, time, *(name for name, said in beside.items() if said))


def _middle(arm):
    home = np.array(arm.data["positions"]["HOME"], float)
    return home + BENT.get(arm.data["name"], 0.0)


def _numbers(values):
    return " ".join(f"{value:.4f}" for value in values)


def faults(arm, said, text, chosen, told):
    """What an emitted text does otherwise than its program says: sentences, none where all is well.

    Args:
        arm: the arm, independently read.
        said: what each motion says, by step.
        text: the emitted text.
        chosen: for each step the joint positions (k, n) [rad, m] that were chosen for its goals.
        told: the codes of warnings and notes, by step.
    """
    found = []
    stands, executed = independent.read(text)
    overlaps = independent.overlaps(text)
    steps = sorted(said)
    corner, flows_in, ball_before = stands, None, None
    before = None
    for place, step in enumerate(steps):
        one, done = said[step], executed[step]
        following = said[steps[place + 1]] if place + 1 < len(steps) else None
        goals = goals_from(arm, one, corner)
        ends = chosen[step] / arm.si
        # None at rest, 0 where the corner may not be left
        flows_on = overlaps.get(step)
        label = f"step {step} {one.kind}"
        found += [f"{label}: {fault}" for fault in _not_solutions(arm, goals, ends)]
        found += [
            f"{label}: {fault}" for fault in _beyond(arm, one, done, said, steps, place, flows_in, flows_on)
        ]
        q = done.sample()
        for flows, end, where in ((flows_in, corner, 0.0), (flows_on, ends[-1], done.duration)):
            if flows is None:
                if np.abs(done.spline(where, nu=1) * arm.si).max() > 2e-6:
                    found.append(f"{label}: no rest at {where:.3f} s")
                if np.abs(done.spline(where) - end).max() > 3e-5:
                    found.append(f"{label}: not at its place at {where:.3f} s")
        if one.kind == "timed":
            found += [f"{label}: {fault}" for fault in _off_table(arm, one, done, corner)]
            corner, flows_in, ball_before, before = ends[-1], None, None, None
            continue
        way = one, path(arm, one, corner, goals, ends)
        shares = off(arm, one, q, way[1])
        ball = _ball(arm, one, following, ends[-1]) if flows_on and one.blend else None
        in_ball = np.zeros(len(q), bool)
        for inside in (ball_before, ball):
            if inside is not None:
                in_ball |= inside(q) <= 1.0
        shares[in_ball] = 0.0
        beside = np.zeros(len(q), bool)
        if (rows := _beside(flows_in, said[steps[place - 1]])) is not None:
            beside[:rows] = True
            shares[:rows] = np.minimum(shares[:rows], off(arm, before[0], q[:rows], before[1]))
        if (rows := _beside(flows_on, one)) is not None:
            next_goals, next_ends = goals_from(arm, following, ends[-1]), chosen[steps[place + 1]] / arm.si
            next_path = path(arm, following, ends[-1], next_goals, next_ends)
            beside[-rows:] = True
            shares[-rows:] = np.minimum(shares[-rows:], off(arm, following, q[-rows:], next_path))
        if shares.max() > 1.0 + 1e-3:
            found.append(f"{label}: off the path by {shares.max():.4f} of the tolerance")
        if (
            one.seconds is not None
            and "Y0609" not in told.get(step, ())
            and abs(done.duration - one.seconds) > 2.1e-4
        ):
            found.append(f"{label}: takes {done.duration:.6f} s")
        if one.speed is not None:
            reaches = "Y0610" not in told.get(step, ()) and flows_in is None and flows_on is None
            found += [f"{label}: {fault}" for fault in _off_speed(arm, one, done, in_ball | beside, reaches)]
        if one.ceiling is not None:
            fastest = _fastest(arm, done, in_ball | beside)
            if fastest > one.ceiling * 1.002:
                found.append(f"{label}: goes at {fastest:.4f} mm/s and never above {one.ceiling:g}")
        corner, flows_in, ball_before, before = ends[-1], flows_on, ball, way
    return found


def _off_table(arm, one, done, corner):
    """What is otherwise than a timetable says from joint position `corner` on."""
    lasts = one.table.times[-1] * one.stretch
    if not -1e-9 <= done.duration - lasts <= 1e-3:
        yield f"takes {done.duration:.6f} s, not {lasts:.6f} s"
    at = np.linspace(0.0, 1.0, 8 * len(done.control))
    asked = replace(one.table, start=corner).asked(one.stretch)
    off = (np.abs(done.spline(at * done.duration) - asked(at * lasts)) * arm.si).max()
    if off > 1e-4 * (1.0 + 1e-6):
        yield f"off its table by {off * 1e4:.4f} of the tolerance"


def _beside(segments, one):
    """The samples that may be on the path of either motion at a corner that isn't left: it is passed in the overlap, or a segment beside."""
    return None if segments is None or (segments and one.blend) else 8 * (segments // 2 + 1) + 1


def _not_solutions(arm, goals, ends):
    if len(goals) != len(ends):
        ends = ends[-1:]
        goals = goals[-1:]
    for goal, q in zip(goals, ends, strict=True):
        if isinstance(goal, tuple):
            (point,), turns = arm.poses(q[None])
            if np.linalg.norm(point - goal[0]) > 1e-5 or (turns[0].inv() * goal[1]).magnitude() > 1e-7:
                yield "a joint position that doesn't reach its pose"
        elif np.abs(goal - q).max() > 1e-7:
            yield "another joint position than is said"
        if ((q > arm.upper + 1e-6) | (q < arm.lower - 1e-6)).any():
            yield "a joint position out of limits"


def _beyond(arm, one, done, said, steps, place, flows_in, flows_on):
    """Limits that are broken at any sample."""
    beside = [one]
    if flows_in is not None:
        beside.append(said[steps[place - 1]])
    if flows_on is not None:
        beside.append(said[steps[place + 1]])
    share = max(other.share for other in beside)
    ramp = max(other.share * other.acc for other in beside)
    allowed = {"position": 1.0, "velocity": share, "motor": share, "acceleration": ramp, "jerk": ramp}
    if any(other.profile == "TOPP" or other.kind == "timed" for other in beside):
        del allowed["jerk"]
    used = independent.shares(arm, done)
    for kind, most in allowed.items():
        if used[kind] > most * (1.0 + 1e-6) + 1e-9:
            yield f"{kind} at {used[kind]:.6f} of the limit, {most:g} is allowed"


def _ball(arm, one, following, corner):
    """How far joint positions are from a corner, as shares of what BLEND allows there."""
    if one.in_joints and following.in_joints:
        return lambda q: np.abs(q - corner).max(axis=1) / one.blend
    (point,), _ = arm.poses(corner[None])
    return lambda q: np.linalg.norm(arm.poses(q)[0] - point, axis=1) / (one.blend + (one.tol or 0.0))


def _off_speed(arm, one, done, in_ball, reaches):
    """A cruise that isn't at its speed."""
    fastest = _fastest(arm, done, in_ball)
    if fastest > one.speed * 1.002:
        yield f"goes at {fastest:.4f} mm/s"
    if reaches and fastest < one.speed * 0.998:
        yield f"reaches only {fastest:.4f} mm/s"


def _fastest(arm, done, in_ball):
    """The largest speed [mm/s] of {TCP} outside of blends."""
    points, _ = arm.poses(done.sample())
    times = np.linspace(0.0, done.duration, len(points))
    speeds = np.linalg.norm(np.diff(points, axis=0), axis=1) / np.diff(times)
    return speeds[~(in_ball[1:] | in_ball[:-1])].max(initial=0.0)


def told_by_step(diagnostics):
    """The codes of findings by the step of their command: its index tells which."""
    told = {}
    for one in diagnostics:
        index = None if one.span is None else re.match(r"P(\d+) ", one.source.line(one.span.line))
        if index:
            told.setdefault(max(int(index[1]) // 10 - 1, 0), set()).add(one.code)
    return told
