"""Random tests that no collision is missed: thousands of small arms in cells, along random motions, are
compared with fine samples of Pinocchio's own geometry.

2,000 cases take about half a minute of one core; with YARCLANG_RANDOM_CELLS=50000 in the environment, that
many are drawn, for a night. A failure is reported with the arguments with which `hunted` reproduces it. Tests
with real programs check that the proof is about the curve that a program's text executes.
"""

import os
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, compiled

from tests.collision.dense import Dense
from tests.collision.small_arms import ARMS, Watched, arm, tool_of
from tests.collision.test_proof import cell_of, drawn, motion, mount, some_shape
from yarclang.cell.model import Obstacle
from yarclang.collision.proof import RESOLUTION, clearances
from yarclang.collision.scene import scene_of
from yarclang.diagnostics import Result
from yarclang.robot.description import load_robot
from yarclang.shapes import Box

COUNT = int(os.environ.get("YARCLANG_RANDOM_CELLS", "2000"))
PARTS = 8
"""Number of tests into which the cases are divided, so that they can run in parallel."""
SAMPLES, CLOSER = 120, 30
"""Number of instants of a motion that are sampled, and number of further ones around the nearest of them."""


def a_motion(random, size, kind):
    """Return two commands of a program as one course, and the segment at which the second one begins."""
    ends = random.uniform(-2.0, 2.0, (3, size))
    parts = []
    for begin, end in pairwise(ends):
        count = int(random.integers(3, 25))
        law = np.linspace(0, 1, count)[:, None]
        law = law * law * (3 - 2 * law) if kind == 1 else law
        way = begin + law * (end - begin)
        if kind == 2:
            way = way + 0.3 * np.sin(3 * np.pi * law) * random.normal(size=size)
        parts.append(np.concatenate([way[:1], way[:1], way, way[-1:], way[-1:]]))
    whole = motion(np.concatenate(parts)[2:-2], float(random.uniform(0.3, 4)))
    return whole, len(whole.x) // 2


def a_cell(random, count, thin):
    """Return a cell with obstacles within the arm's reach."""
    bodies = []
    for at in range(count):
        shape = some_shape(random, 0.3)
        if thin:
            shape = Box(random.permutation([random.choice([1e-5, 1e-3]), *random.uniform(0.05, 0.6, 2)]))
        place = mount(random.uniform([-0.9, -0.9, -0.5], [0.9, 0.9, 1.3]), random.uniform(-3, 3, 3))
        bodies.append(Obstacle(f"O{at}", shape, place, float(random.choice([0.0, 0.0, 0.02]))))
    return cell_of(*bodies)


def hunted(tally, which, seed, kind, count, thin, tooled):
    """Compare the proof of one random case with samples. Count pairs of bodies that meet, and pairs that stay
    apart.
    """
    random = np.random.default_rng(seed)
    one = arm(which)
    tools = (tool_of(random),) if tooled else ()
    robot, cell = replace(one.robot, tools=tools, written=None), a_cell(random, count, thin)
    scene = scene_of(robot, cell).value
    course, half = a_motion(random, robot.size, kind)
    spans = np.array([[0, half], [half, len(course.x)]])
    watched = Watched(one, cell, tools)
    assert len(scene.pairs.first) == len(watched.pairs)
    tally.count("watched", len(scene.pairs.first) > 0)
    if not len(scene.pairs.first):
        return
    found = clearances(scene, course, spans)
    for row, (first, last) in enumerate(spans):
        begin, end = course.begins[[first, last]]
        times = np.linspace(begin, end, SAMPLES)
        apart = watched.distances(course.at(times))
        worst = times[np.argmin((apart - watched.wanted).min(axis=1))]
        step = 1.5 * (end - begin) / SAMPLES
        close = np.clip(np.linspace(worst - step, worst + step, CLOSER), begin, end)
        apart = np.concatenate([apart, watched.distances(course.at(close))])
        near = {frozenset(scene.names(one.pair)) for one in found.meetings if one.motion == row}
        least = apart.min(axis=0)
        missed = [
            name
            for pair, name in enumerate(watched.called)
            if least[pair] < watched.wanted[pair] and name not in near
        ]
        assert not missed
        free = np.array([name not in near for name in watched.called])
        tally.count("free", free.all())
        tally.count("meets", (least < watched.wanted).any())
        for of_cell in (0, 1):
            chosen = least[free & (watched.of_cell == of_cell)]
            assert not len(chosen) or chosen.min() >= found.least[row, of_cell] - 1e-6
    for one in found.meetings:
        assert one.distance < scene.pairs.margin[one.pair] + RESOLUTION


@pytest.mark.parametrize("part", range(PARTS))
@exercises(watched=0.5, free=0.3, meets=0.05)
@settings(max_examples=max(1, COUNT // PARTS), deadline=None)
@given(
    which=st.integers(0, ARMS - 1),
    seed=st.integers(0, 2**32 - 1),
    kind=st.integers(0, 2),
    count=st.integers(0, 4),
    thin=st.booleans(),
    tooled=st.booleans(),
)
def test_no_collision_is_missed(tally, part, which, seed, kind, count, thin, tooled):
    hunted(tally, which, seed, kind, count, thin, tooled)


@exercises(compiled=0.1, refused=0.1)
@settings(max_examples=max(30, COUNT // 50), deadline=None)
@given(seed=st.integers(0, 2**32 - 1), home=st.booleans())
def test_no_program_is_let_through(tally, seed, home):
    """A real program that compiles in a cell stays free of it, and at least as far away as the certificate
    says. The planned curve is sampled.
    """
    random = np.random.default_rng(seed)
    robot = load_robot("INDUSTRIAL6").value
    cell = drawn(random, count=4)
    goals = random.uniform(-1, 1, (2, 6)) * [120, 50, 60, 90, 90, 90]
    lines = [
        f"P{at}0 MOVEJ {' '.join(f'{value:.2f}' for value in goal)} [{random.uniform(6, 9):.2f}]"
        for at, goal in enumerate(goals, 1)
    ]
    lines += ["P90 MOVEJ HOME [9]"] * home
    text = 'CELL "cell.toml"\nDEFAULT {TCP} (mm,deg,s) {B}\n' + "\n".join(lines)
    value, said = compiled(text, load_cell=lambda *_: Result(cell))
    assert set(codes(said)) <= {"Y0901", "Y0902", "Y0903"}
    tally.count("compiled", value is not None)
    tally.count("refused", value is None)
    if value is None:
        assert said
        return
    dense = Dense(robot, cell)
    for planned, proved in zip(value.plan.motions, value.certificate.commands, strict=True):
        curve = planned.curve
        apart = dense.distances(curve.sample(np.linspace(0, curve.duration, 150))[0])
        assert (apart >= [dense.wanted(pair) for pair in range(len(dense.pairs))]).all()
        of_cell = np.array(
            [any(name.startswith("O") for name in dense.names(pair)) for pair in range(len(dense.pairs))]
        )
        for clearance, chosen in ((proved.clearance, of_cell), (proved.own_clearance, ~of_cell)):
            assert apart[:, chosen].min() >= clearance.distance - 1e-6
