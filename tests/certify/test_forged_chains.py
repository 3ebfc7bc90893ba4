"""Tests of chains as one path that are forged: a text, or the program beside it, is changed. Nothing is
accepted that violates a tolerance, a ball, a limit, a speed or the order.

The motion of a changed text is determined by tests/independent.py, which shares no code with the judge. The
judge may refuse more texts: for example a wrong map, or a correct path that can't be proved.
"""

import re
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from floors import exercises
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from programs import checked, compiled, robot_of
from scipy.interpolate import CubicSpline

from tests.certify.certify_bench import (
    FLANGE_FROM_TCP,
    Job,
    grid_law,
    industrial6,
    inverse,
    inverted,
    knots,
    origin,
)
from tests.certify.certify_chains import Chain, Leg, of_poses
from tests.certify.certify_paths import moved
from tests.certify.forging import Forger
from tests.certify.test_certify_blends import Q0, START, TIMING, codes, judge, line
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.pmac.read import read
from yarclang.independent.arm import Arm
from yarclang.independent.reading import overlaps, shares
from yarclang.independent.reading import read as read_anew
from yarclang.pipeline.stages import claims_of
from yarclang.robot.kinematics.fk import tool_poses

COUNT, ROBOT = 14, "INDUSTRIAL6"
KINDS = {"sharp": (25.0, 0.3, 50.0), "gentle": (15.0, 0.3, 20.0), "passed": (1.0, 0.0, 50.0)}
"""Angles of the corners [deg], radius of the ball [mm] and speed [mm/s]. In `sharp` the robot slows down, in
`gentle` it keeps the speed in blends, in `passed` it keeps the speed without a blend.
"""
TOLERANCE = 0.05
SET_BEHIND = 7


def said(turn, ball, speed):
    """Return the content of a program of lines: the waypoints, and the ball and speed of each motion."""
    headings = np.radians(turn) * np.where(np.arange(COUNT) % 2, 1.0, -1.0)
    steps = 3.0 * np.stack((np.cos(headings), np.sin(headings), 0.0 * headings), axis=1)
    begin = np.array([[40.0, 1000.0, 1000.0]])
    points = np.vstack([begin, begin + np.cumsum(steps, axis=0)]).round(4)
    return {"points": points, "balls": [ball] * (COUNT - 1) + [None], "speeds": [speed] * COUNT,
        "set": SET_BEHIND, "tol": [TOLERANCE] * COUNT}  # fmt: skip


def written(say):
    lines = ["OUTPUT GLUE M1 OFF", "DEFAULT {TCP} (mm,deg,s) {B}"]
    begin, *goals = ["{:.4f} {:.4f} {:.4f} 0 0 0".format(*point) for point in say["points"]]
    lines.append(f"P0001 MOVEJ_RPY {begin} [5]")
    for k, goal in enumerate(goals):
        ball = say["balls"][k]
        flows = "" if ball is None else f" BLEND {ball:.6g}"
        speed = f"[V {say['speeds'][k]:.9g}]"
        lines.append(f"P{10 * k + 10:04d} MOVEL {goal} {speed} TOL {say['tol'][k]:.6g}{flows}")
        if k == say["set"]:
            lines.append("P0995 SET GLUE ON" if say.get("waits") is None else "P0995 WAIT [0.1]")
    return "\n".join(lines) + "\n"


@cache
def planned(kind):
    say = said(*KINDS[kind])
    made, found = compiled(written(say))
    assert made is not None, found
    assert all(motion.flows for motion in made.plan.motions[1:-1])
    return say, made.text, made.plan.program, claims_of(made.plan)


def judged(text, program, claims):
    robot = robot_of(ROBOT)
    return certify(text, program, robot, robot.tolerance, claims)


def refused(text, program, claims):
    result = judged(text, program, claims)
    return result.value is None or any(one.is_error for one in result.diagnostics)


@cache
def arm():
    return Arm.in_folder(robot_of(ROBOT).folder)


def broken(text, say, claims):
    """Return sentences about violations of the program by a text, found by sampling."""
    found = []
    _, commands = read_anew(text)
    flowing = overlaps(text)
    points, steps = say["points"], [step for step in sorted(commands) if step]
    for place, step in enumerate(steps):
        done, tol, speed = commands[step], say["tol"][place], say["speeds"][place]
        found += [
            f"{place} {name} {share}" for name, share in shares(arm(), done).items() if share > 1 + 1e-6
        ]
        p, turns = arm().poses(done.sample())
        own = slice(max(place - 1, 0), place + 2)
        a, b = points[:-1][own], points[1:][own]
        along = np.clip(np.einsum("nki,ki->nk", p[:, None] - a, b - a) / ((b - a) ** 2).sum(axis=1), 0.0, 1.0)
        off = np.linalg.norm(p[:, None] - a - along[..., None] * (b - a), axis=2).min(axis=1)
        near = np.zeros(len(p), bool)
        for corner in (place - 1, place):
            if corner >= 0 and flowing.get(steps[corner]) and say["balls"][corner]:
                near |= (
                    np.linalg.norm(p - points[corner + 1], axis=1)
                    <= say["balls"][corner] + say["tol"][corner]
                )
        if (far := off[~near].max(initial=0.0)) > tol * 1.001 + 1e-6:
            found.append(f"{place} off by {far}")
        # In these programs, the frame must not turn.
        if (turned := turns.magnitude()).max() > np.radians(max(0.002, tol) * 1.05):
            found.append(f"{place} turned by {turned.max()}")
        if say["balls"][place] is None or not flowing.get(step):
            missed = np.linalg.norm(
                np.vstack([p, arm().poses(commands[steps[min(place + 1, COUNT - 1)]].sample())[0]])
                - points[place + 1],
                axis=1,
            )
            if missed.min() > tol + 0.5 * np.linalg.norm(np.diff(p, axis=0), axis=1).max():
                found.append(f"{place} misses its end by {missed.min()}")
        went = np.linalg.norm(np.diff(p, axis=0), axis=1) / (done.segment / 8)
        if went.max() > speed * 1.003:
            found.append(f"{place} at {went.max()}")
        lead, trail = (
            flowing.get(one, 0) // 2 * 8 * bool(ball)
            for one, ball in (
                (steps[place - 1], place and say["balls"][place - 1]),
                (step, say["balls"][place]),
            )
        )
        least = speed * min(claims.kept.get(step, 1.0), claims.least.get(step, 1.0))
        inner = went[lead : len(went) - trail]
        (fast,) = np.nonzero(inner >= least * 0.9985)
        if len(inner) and not len(fast) and inner.max() < 0.99 * least:
            found.append(f"{place} only at {inner.max()}")
        if len(fast) and (slowest := inner[fast[0] : fast[-1] + 1].min()) < 0.995 * least:
            found.append(f"{place} slows down to {slowest}")
    last = commands[steps[-1]]
    if np.abs(last.spline(last.duration, nu=1) * arm().si).max() > 2e-6:
        found.append("no rest at the end")
    return found


# changes of a text


def rows(text):
    """Return the places of the chain's move lines, except those at its ends."""
    begin = [k for k, one in enumerate(text.lines) if one.startswith("TM")][1]
    return np.array([k for k in text.moves() if k > begin])[4:-4]


def numbers(text, places):
    return np.array([[float(one) for one in re.findall(r"[A-Z](-?[0-9.]+)", text.lines[k])] for k in places])


def with_numbers(text, places, values):
    lines = list(text.lines)
    for k, row in zip(places, values, strict=True):
        lines[k] = "".join(f"{axis}{value:.9f}" for axis, value in zip("XYZABC", row, strict=True))
    return Forger(tuple(lines))


def bump(text, random):
    """Move some points by 0.1 um to 1 mm, or turn them."""
    places = rows(text)
    values, at = numbers(text, places), random.integers(len(places))
    by = np.exp(-0.5 * ((np.arange(len(places)) - at) / random.uniform(0.5, 4.0)) ** 2)
    (jacobian,) = jacobians(values[at : at + 1])
    direction = random.normal(size=6) * ([1, 1, 1, 0, 0, 0] if random.random() < 0.7 else [0, 0, 0, 1, 1, 1])
    direction *= 10.0 ** random.uniform(-4, 0) / np.linalg.norm(direction) / np.array([1, 1, 1, 50, 50, 50])
    return with_numbers(text, places, values + np.outer(by, np.linalg.solve(jacobian, direction)))


def jacobians(values):
    """Return how far {TCP} moves [mm] and turns [deg] for each degree of the joints, as (k, 6, 6), by
    differences.
    """
    found = []
    for q in values:
        p, turns = arm().poses(np.vstack([q, q + 1e-4 * np.eye(6)]))
        turned = np.degrees((turns[1:] * turns[0].inv()).as_rotvec())
        found.append(np.hstack([p[1:] - p[0], turned]).T / 1e-4)
    return found


def digit(text, random):
    """Change one digit of a number."""
    place = int(random.choice(rows(text)))
    old = text.lines[place]
    at = int(random.choice([k for k, one in enumerate(old) if one.isdigit()]))
    new = f"{old[:at]}{(int(old[at]) + random.integers(1, 10)) % 10}{old[at + 1 :]}"
    return Forger((*text.lines[:place], new, *text.lines[place + 1 :]))


def less(text, random):
    return text.drop(int(random.choice(rows(text))))


def more(text, random):
    place = int(random.choice(rows(text)))
    return text.put(place, text.lines[place])


def exchanged(text, random):
    places = rows(text)
    at = random.integers(len(places) - 1)
    values = numbers(text, places)
    values[[at, at + 1]] = values[[at + 1, at]]
    return with_numbers(text, places, values)


def other_time(text, random):
    """Change the segment time of the chain."""
    place = [k for k, one in enumerate(text.lines) if one.startswith("TM")][1]
    time = float(text.lines[place][2:]) * random.choice([0.5, 0.8, 0.9, 0.99, 1.001, 1.01, 1.1, 1.25, 2.0])
    return Forger((*text.lines[:place], f"TM{round(time * 8) / 8:g}", *text.lines[place + 1 :]))


def warped(text, random):
    """Follow the same path with another law: slower, then faster."""
    places = rows(text)
    values, k = numbers(text, places), np.arange(len(places))
    at, width = random.uniform(0.2, 0.8) * len(k), random.uniform(1.0, 12.0)
    size = random.choice([-1, 1]) * 10.0 ** random.uniform(-3, 0)
    when = np.clip(k + size * width * np.exp(-0.5 * ((k - at) / width) ** 2), 0, k[-1])
    return with_numbers(text, places, CubicSpline(k, values)(when))


def slower(text, random):
    """Insert lines into one motion, on the same path."""
    places = rows(text)
    values, k = numbers(text, places), np.arange(len(places))
    at, count = int(random.uniform(0.2, 0.8) * len(k)), int(random.integers(1, 6))
    where = text.put(int(places[at]), *[text.lines[places[at]]] * count)
    grown = np.arange(len(k) + count)
    width = random.uniform(1.0, 4.0) * count
    when = grown - count / (1.0 + np.exp(-(grown - at) / width * 4.0))
    when = (when - when[0]) * k[-1] / (when[-1] - when[0])
    return with_numbers(where, rows(where), CubicSpline(k, values)(when))


def other_blend(text, random):
    """Change the number of a blend's segments in the map."""
    step = int(random.integers(1, COUNT - 2))
    return text.change(rf"(; command {step} .*) blend \d+", rf"\1 blend {random.choice([0, 2, 4, 6, 8, 12])}")


def other_seam(text, random):
    """Assign some lines of one motion to the next one in the map, or the other way round."""
    step, by = int(random.integers(1, 7)), int(random.choice([-4, -3, -2, -1, 1, 2, 3, 4]))
    form = r"(; command {} \S+ \S+ \S+) (\d+) (\d+)(.*)"
    one, other = (text.find(form.format(k)) for k in (step, step + 1))
    a, b = (
        re.fullmatch(form.format(step), text.lines[one]),
        re.fullmatch(form.format(step + 1), text.lines[other]),
    )
    lines = list(text.lines)
    lines[one] = f"{a[1]} {a[2]} {int(a[3]) + by}{a[4]}"
    lines[other] = f"{b[1]} {int(b[2]) + by} {b[3]}{b[4]}"
    return Forger(tuple(lines))


TEXTS = (bump, bump, bump, digit, less, more, exchanged, other_time, warped, warped, slower, other_blend,
    other_seam)  # fmt: skip

# changes of the program


def moved_corner(say, random):
    points = say["points"].copy()
    points[random.integers(1, COUNT)] += random.normal(size=3) * 10.0 ** random.uniform(-3, 0)
    return {**say, "points": points.round(4)}


def other_order(say, random):
    points, at = say["points"].copy(), random.integers(1, COUNT - 1)
    points[[at, at + 1]] = points[[at + 1, at]]
    return {**say, "points": points}


def other_speed(say, random):
    speeds, at = list(say["speeds"]), random.integers(COUNT)
    speeds[at] *= random.choice([0.5, 0.9, 0.99, 0.998, 1.002, 1.01, 1.1, 2.0])
    return {**say, "speeds": speeds}


def smaller_ball(say, random):
    balls, at = list(say["balls"]), random.integers(COUNT - 1)
    balls[at] *= random.choice([0.0, 0.1, 0.5, 0.8])
    return {**say, "balls": balls}


def no_ball(say, random):
    balls, at = list(say["balls"]), random.integers(COUNT - 1)
    balls[at] = None
    return {**say, "balls": balls}


def narrower(say, random):
    tol, at = list(say["tol"]), random.integers(COUNT)
    tol[at] = float(random.choice([0.001, 0.005, 0.01, 0.02, 0.04]))
    return {**say, "tol": tol}


def other_set(say, random):
    return {**say, "set": int(random.choice([k for k in range(COUNT) if k != SET_BEHIND]))}


def a_wait(say, random):
    return {**say, "waits": True}


PROGRAMS = (moved_corner, moved_corner, other_order, other_speed, smaller_ball, no_ball, narrower, other_set,
    a_wait)  # fmt: skip
OTHERWISE = (no_ball, other_set, a_wait)
"""Changes that samples of the motion don't show: a missing stop, and an output that is set elsewhere. They
must always be refused.
"""


def resealed(text):
    """Return the text with its duration updated in the header."""
    content = read(text.text, robot_of(ROBOT).controller)
    if not hasattr(content, "schedule"):
        return text
    takes = content.schedule.lasting.text()
    place = text.find("; duration .*")
    return Forger(
        (
            *text.lines[:place],
            re.sub(r"duration [0-9.]+ s", f"duration {takes}", text.lines[place]),
            *text.lines[place + 1 :],
        )
    )


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_planned_is_accepted_and_breaks_nothing(kind):
    say, text, program, claims = planned(kind)
    assert not refused(text, program, claims)
    assert broken(text, say, claims) == []
    # A change that is too small to violate anything is accepted.
    forger = Forger.of(text)
    places = rows(forger)
    values = numbers(forger, places)
    assert not refused(with_numbers(forger, places, values + 1e-8).text, program, claims)
    assert not refused(forger.change("; made with (.*)", r"; made with \1 and care").text, program, claims)


@exercises(refused=0.5, accepted=0.1)
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.sampled_from(sorted(KINDS)), st.sampled_from(TEXTS), st.integers(0, 2**32 - 1))
def test_a_changed_text_that_is_accepted_breaks_nothing(tally, kind, change, seed):
    say, text, program, claims = planned(kind)
    try:
        forged = resealed(change(Forger.of(text), np.random.default_rng(seed))).text
    except AssertionError:  # the change has no effect
        return
    is_refused = refused(forged, program, claims)
    tally.count("refused", is_refused)
    tally.count("accepted", not is_refused)
    assert is_refused or broken(forged, say, claims) == []


@exercises(refused=0.4, accepted=0.05)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.sampled_from(sorted(KINDS)), st.sampled_from(PROGRAMS), st.integers(0, 2**32 - 1))
def test_a_text_that_is_accepted_for_another_program_breaks_nothing_of_it(tally, kind, change, seed):
    say, text, meant, claims = planned(kind)
    other = change(say, np.random.default_rng(seed))
    program, found = checked(written(other))
    assert program is not None, found
    is_refused = refused(text, replace(program, start=meant.start), claims)
    tally.count("refused", is_refused)
    tally.count("accepted", not is_refused)
    assert is_refused or (change not in OTHERWISE and broken(text, other, claims) == [])


# claims


def test_a_wrong_claim_of_a_speed_proves_nothing():
    """A share of the speed that is claimed too high isn't accepted. If it is claimed much too low, the proved
    share is reported.
    """
    _, text, program, claims = planned("sharp")
    step = min(claims.least, key=claims.least.get)

    def told(share):
        found = judged(text, program, replace(claims, least={**claims.least, step: share})).diagnostics
        return [one.code for one in found if one.is_error]

    least = claims.least[step]
    assert [told(least * by) for by in (0.9, 1.0)] == [[], []]
    assert told(1.0) == ["Y1167"]
    found = judged(text, program, replace(claims, least={**claims.least, step: 0.1 * least}))
    assert not [one for one in found.diagnostics if one.is_error]
    (row,) = [one for one in found.value.commands if one.step == step]
    assert row.tool_speed.least >= 0.95 * least * row.tool_speed.programmed / (0.1 * least)
    # Claims that are no valid shares are refused.
    assert [told(share) for share in (0.0, -1.0, np.nan, np.inf)] == [["Y1167"]] * 4
    _, text, program, claims = planned("passed")
    found = judged(text, program, replace(claims, kept={8: 0.5})).diagnostics
    assert [one.code for one in found if one.is_error] == ["Y1167"]


def test_a_slowdown_is_reported_however_it_is_claimed():
    _, text, program, claims = planned("sharp")
    (told,) = [one for one in judged(text, program, claims).diagnostics if one.code == "Y0610"]
    share = 100.0 * min(claims.least.values())
    said = float(re.search(r"slows down to ([0-9.]+) % of it", told.message)[1])
    assert share * 0.999 < said < 1.1 * share
    none = judged(text, program, replace(claims, least={})).diagnostics
    assert {one.code for one in none} == {"Y1167"}


# cases that don't occur in planned chains


def straight_run(overlaps, seams, count=80, way=(0.2, 0.04, 0.0)):
    """Return a straight line with one law, cut at some knots, and the poses at the cuts."""
    s, way = knots(grid_law(count)), np.array(way)
    poses = np.tile(START, (count + 1, 1, 1))
    poses[:, :3, 3] += np.outer(s, way)
    lines = inverted(inverse(industrial6(), poses, Q0))
    control = np.vstack([np.tile(Q0, (3, 1)), lines, np.tile(lines[-1], (2, 1))])
    knot = (control[:-2] + 4.0 * control[1:-1] + control[2:]) / 6.0
    at = tool_poses(industrial6().chain, knot[list(seams)], FLANGE_FROM_TCP)
    at[:, :3, :3] = START[:3, :3]
    ends = [0, *seams, count]
    return (
        Chain(control, list(pairwise(ends)), list(overlaps)),
        at,
        moved(START, way, np.zeros(3)),
    )


@pytest.mark.parametrize("ball", [0.0, 0.06])
def test_a_path_is_followed_or_in_a_ball_if_blends_take_all_of_it(ball):
    """The first corner of a motion isn't left, although it may have a ball, and the blend at its second
    corner takes the whole motion. The first half of the motion is in no other ball, so it must be on the path
    or in the ball of this blend.
    """
    chain, (a, b, c), d = straight_run((20, 0, 20), (30, 40, 50))
    radius, way = hir.Reading(0.06, None), np.array([0.98, 0.2, 0.0])

    def beside(along, up):
        return moved(b, along * way + np.array([0, 0, up]), np.zeros(3))

    # First far away and back, then back and forth inside of the ball.
    for far, found in ((0.15, ["Y1166"]), (0.03, [])):
        goals = [beside(0, far), *(beside(0.005 * (k % 2), 0.012 * (k % 3)) for k in range(40)), c]
        curve = hir.PoseSplineMove(
            origin(2, "MOVEL_SPLINE"), tuple(hir.PoseGoal(goal, FLANGE_FROM_TCP) for goal in goals), "LSPB",
                TIMING, blend=radius
        )  # fmt: skip
        legs = [
            line(0, START, a, 0, radius),
            line(1, a, b, 0, hir.Reading(ball, 0.0)),
            Leg(curve, None, 0),
            line(3, c, d, 0),
        ]
        result = judge(industrial6(), Q0, chain.jobs(legs))
        assert codes(result) == found
    assert result.value.commands[2].blended.position < 0.061


def test_a_speed_that_is_held_to_an_end_is_no_peak():
    """Motions that flow on without a blend, each of which has its speed only for an instant."""
    per, count = 24, 4
    k = np.arange(per * count + 1)
    for dip, asked, found in ((0.3, 0.0499, ["Y1167"] * count), (1.0, 0.05, [])):
        speed = dip + (1.0 - dip) * 0.5 * (1.0 - np.cos(2.0 * np.pi * k / per))
        ramp = np.minimum(k, k[-1] - k) / (per / 2.0)
        speed = np.where(ramp < 1.0, np.sin(0.5 * np.pi * np.minimum(ramp, 1.0)) ** 2, speed)
        x = np.r_[0.0, np.cumsum(0.5 * (speed[1:] + speed[:-1]))] * 0.05 * 0.05
        way = np.array([0.98, 0.2, 0.0]) / np.linalg.norm([0.98, 0.2, 0.0])
        poses = np.tile(START, (len(k), 1, 1))
        poses[:, :3, 3] += np.outer(x, way)
        lines = inverted(inverse(industrial6(), poses, Q0))
        control = np.vstack([np.tile(Q0, (3, 1)), lines, np.tile(lines[-1], (2, 1))])
        ends = [START, *poses[per::per]]
        legs = [
            line(n, ends[n], ends[n + 1], 0, hir.Reading(0.0, 0.0) if n < count - 1 else None)
            for n in range(count)
        ]
        for leg in legs:
            leg.motion = replace(leg.motion, timing=hir.Timing(None, speed=hir.Reading(asked, None)))
        chain = Chain(control, [(n * per, (n + 1) * per) for n in range(count)], [0] * (count - 1))
        assert codes(judge(industrial6(), Q0, chain.jobs(legs))) == found


def test_a_motion_without_a_way_isnt_flown_over():
    """A motion without a path ends at rest, wherever it is in the program. It must not have a BLEND."""
    a, b = (
        moved(START, np.array([0.1, 0.02, 0.0]), np.zeros(3)),
        moved(START, np.array([0.1, 0.1, 0.04]), np.zeros(3)),
    )
    legs = [line(0, START, a, 40, hir.Reading(0.042, None)), line(2, a, b, 40)]
    one, other = of_poses(legs, (16,), Q0).jobs(legs)
    for blend in (None, hir.Reading(0.0, 0.0), hir.Reading(0.042, None)):
        still = Job(line(1, a, a, 0, blend).motion, None)
        assert codes(judge(industrial6(), Q0, [one, still, other])) == ["Y1153"]


@pytest.mark.parametrize(
    ("off", "found"), [(0, []), (1, []), (3, ["Y1159", "Y1159"]), (8, ["Y1159", "Y1159"])]
)
def test_an_output_of_a_chain_is_set_at_its_corner(off, found):
    """In the map, the seam at which an output is set is at most one segment from the corner."""
    chain, (corner,), end = straight_run((0,), (33,))
    chain.spans[:] = [(0, 33 + off), (33 + off, 80)]
    legs = [line(0, START, corner, 0, hir.Reading(0.0, 0.0)), line(2, corner, end, 0)]
    glue = hir.SetOutput(origin(1, "SET"), hir.Signal("GLUE", "M1"), 1.0)
    assert codes(judge(industrial6(), Q0, chain.jobs(legs, [(0, glue, "M1==1")]))) == found
