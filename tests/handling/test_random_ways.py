"""Tests of random programs with WHENs around a gripper's SETs: no branch of a certified text has a collision.

Regular expressions read the text, scipy's splines execute it, and Pinocchio moves the flange. coal compares
the box with the boxes of the cell, and with the feeder's next box from the time at which it can come.
"""

from itertools import product

import numpy as np
from floors import exercises
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tests.handling.carrying import made
from tests.handling.test_random_carrying import PRESSED, TOUCHING, WALL, box, gap
from yarclang.independent.arm import Arm
from yarclang.independent.reading import read
from yarclang.robot.library import stdlib_folder

OVER, AT = "MOVEL 0 0 120 0 0 0 [1] {FEEDER}", "MOVEL 0 0 0 0 0 0 [1] {FEEDER}"
LOW = "MOVEL 0 0 15 0 0 0 [0.5] {FEEDER}"
TAKE, DROP, LOOK = "SET GRIP ON", "SET GRIP OFF", 'HOLD "look"'
BETWEEN = {
    "wait": ["WAIT [0.3]"],
    "hold": ["WHEN GOOD OFF", LOOK, "WAIT GOOD ON [1]", "END"],
    "either": ["WHEN GOOD OFF", LOOK, "ELSE", "WAIT [0.1]", "END"],
    "within": ["WHEN GOOD OFF", "WHEN GOOD OFF", LOOK, "END", "END"],
    "regrip": ["WHEN GOOD OFF", DROP, "WAIT [0.2]", TAKE, "END"],
    "retry": ["WHEN GOOD OFF", DROP, OVER, LOOK, AT, TAKE, "END"],
    "low": [LOW],
    "goes": ["WHEN GOOD OFF", OVER, "MOVEJ READY", "MOVEJ_RPY 0 0 120 0 0 0 {FEEDER}", AT, "END"],
    "drops": ["WHEN GOOD OFF", DROP, "END"],
}
PUT_OVER, PUT_AT = "MOVEL 0 0 120 0 0 0 [1.2] {PUT}", "MOVEL 0 0 0 0 0 0 [1.2] {PUT}"
PLACED = {"x": -250, "y": 900, "z": 700}


def ways(lines):
    """Yield the numbers of the executed lines, for each combination of branches."""
    count = sum(line.startswith("WHEN") for line in lines)
    for chosen in product((True, False), repeat=count):
        left, found, passing = list(chosen), [], [True]
        for number, line in enumerate(lines):
            if line.startswith("WHEN"):
                passing.append(left.pop(0))
            elif line == "ELSE":
                passing[-1] = not passing[-1]
            elif line == "END":
                passing.pop()
            elif all(passing):
                found.append(number)
        yield found


def without_starts(text):
    """Return the text without the RAPIDs at the beginning of its legs, which don't move the robot."""
    lines = text.split("\n")
    begins = [at for at, line in enumerate(lines) if line == "RAPID"]
    for at in begins[1:]:
        lines[at : at + 3] = [""] * 3
    return "\n".join(lines)


@exercises(certified=0.2, refused=0.1)
@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    before=st.sampled_from(["", "wait", "hold"]),
    between=st.lists(st.sampled_from(sorted(BETWEEN)), min_size=1, max_size=2),
    behind=st.sampled_from(["", "hold", "either"]),
    count=st.integers(1, 2),
    size=st.integers(40, 150),
    wall=st.tuples(st.integers(-150, 250), st.integers(750, 1100), st.integers(500, 1000)),
    edges=st.tuples(st.integers(5, 80), st.integers(5, 200), st.integers(5, 200)),
)
def test_every_way_that_is_certified_is_clear(
    tmp_path_factory, tally, before, between, behind, count, size, wall, edges
):
    lines = ["MOVEJ_RPY 0 0 120 0 0 0 {FEEDER}", AT, *BETWEEN.get(before, ()), TAKE]
    lines += [line for one in between for line in BETWEEN[one]]
    lines += [OVER, "MOVEJ_RPY 0 0 120 0 0 0 {PUT}", PUT_AT, DROP, *BETWEEN.get(behind, ()), PUT_OVER]
    lines += ["MOVEJ READY"]
    plain = ("WHEN", "ELSE", "END")
    text = "\n".join(
        line if line.startswith(plain) else f"P{10 * at + 10:04d} {line}" for at, line in enumerate(lines)
    )
    found = made(
        tmp_path_factory.mktemp("ways"), text, WALL.format(*wall, *edges), count=count, size=size, **PLACED
    )
    tally.count("certified", found.value is not None)
    tally.count("refused", found.value is None)
    if found.value is None:
        return
    arm = Arm.in_folder(stdlib_folder() / "robots" / "industrial6")
    _, commands = read(without_starts(found.value.text))
    motions = [at for at, line in enumerate(lines) if line.startswith("MOVE")]
    sampled = dict(zip(motions, (commands[step].sample(0)[::4] for step in sorted(commands)), strict=True))
    ends = {at: commands[step].sample(0)[-1:] for at, step in zip(motions, sorted(commands), strict=True)}
    turn = Rotation.from_euler("z", 30, degrees=True).as_matrix()
    feeder, x, y, z = np.array([300.0, 850.0, 650.0]), *PLACED.values()
    still = {
        "TRACK": box((300, 200, 200), feeder - np.array([0.0, 0.0, 130.0])),
        "TABLE": box((300, 300, 200), [x, y, z - 130], turn),
        "WALL": box(edges, wall),
    }
    away = np.linalg.norm([size, 60, 60])
    for way in ways(lines):
        point, at = feeder, Rotation.identity()
        held, next_is_there, here = None, False, None
        for place, number in enumerate(way):
            line = lines[number]
            if line == TAKE and held is None:
                (tip,), turns = arm.poses(here)
                near = np.linalg.norm(point - tip) < 40.0
                held = (turns[0].inv().apply(point - tip), turns[0].inv() * at) if near else None
            elif line == DROP:
                held = None
            if not line.startswith("MOVE"):
                continue
            here = ends[number]
            if held is None:
                continue
            points, turns = arm.poses(np.vstack([sampled[number], here]))
            poses = [
                (tip + each.apply(held[0]), each * held[1]) for tip, each in zip(points, turns, strict=True)
            ]
            shapes = [box((size, 60, 60), there, each.as_matrix()) for there, each in poses]
            # before and after a SET, the box may touch the bodies that it touches at the SET
            since = [lines[one] for one in way[:place]]
            last = max(at for at, one in enumerate(since) if one == TAKE)
            leads_out = not any(one.startswith("MOVE") for one in since[last:])
            rest = [lines[one] for one in way[place + 1 :]]
            sets = next((at for at, one in enumerate(rest) if one.startswith("SET")), len(rest))
            leads_in = not any(one.startswith("MOVE") for one in rest[:sets])
            lies_at = (shapes[:1] if leads_out else []) + (shapes[-1:] if leads_in else [])
            for name, other in still.items():
                touches = any(gap(shape, other) < TOUCHING for shape in lies_at)
                least = min(gap(shape, other) for shape in shapes)
                assert least > (-PRESSED - 1.0 if touches else 0.0), (way, number, name)
            for shape, (there, _) in zip(shapes, poses, strict=True):
                next_is_there |= count > 1 and bool(np.linalg.norm(there - feeder) > away)
                assert not next_is_there or gap(shape, box((size, 60, 60), feeder)) > 0.0, (way, number)
            point, at = poses[-1]
