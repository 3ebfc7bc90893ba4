"""Tests of random programs: each that compiles respects all limits and the tolerance, as an independent
reader of the text finds.

Usually, 400 programs and 20 chains are drawn, which takes about three minutes of one core.
YARCLANG_RANDOM_PROGRAMS=10000 in the environment draws that many, for a night:
`YARCLANG_RANDOM_PROGRAMS=10000 pytest -n auto tests/test_random_programs.py`. A fault is reported with its
program and its seed.

A planner that refuses every program would break no limit. So the first block of programs of each arm, which
every run draws, must reach `FLOORS`: the least shares of each kind of motion, law, time and option that must
be planned and certified. One block is one test, so that the floors hold in any worker.
"""

import os

import numpy as np
import pytest
from floors import Tally, exercises
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from programs import compiled, planned, robot_of
from scipy.spatial.transform import Rotation

from tests.robot.made_arms import DATA, REAL, made
from yarclang.backend_pmac.emit import emit
from yarclang.backend_pmac.lower import lower
from yarclang.campaign.chains import drawn_chain
from yarclang.campaign.drawing import drawn, features
from yarclang.campaign.judging import told_by_step
from yarclang.diagnostics import Diagnostic, Result
from yarclang.independent.arm import Arm
from yarclang.independent.judging import judge as judged_anew
from yarclang.independent.reading import off_joint_line, off_line, off_spline, overlaps, read, shares
from yarclang.motion.leading import ahead, frame_motions
from yarclang.motion.paths.arc import NoArc
from yarclang.pipeline import stages
from yarclang.pipeline.stages import Request, certified
from yarclang.robot.description import load_robot
from yarclang.source import Span

COUNT = int(os.environ.get("YARCLANG_RANDOM_PROGRAMS", "400"))
"""Number of programs for all arms together."""

EASY = 1000
"""Programs of seeds below this one have few motions."""

BLOCK = 40
"""Number of programs in one test: enough for each feature to occur in a block, and few enough for tests to
run in parallel.
"""

FLOORS = dict.fromkeys(
    [
        "joints", "joints of a pose", "joints by an increment", "joint_spline", "line",
            "line by an increment", "arc",
        "pose_spline", "timed", "LSPB", "POLY5", "SCURVE", "TOPP", "shortest time", "seconds", "share",
            "speed", "ceiling", "ACC", "BLEND", "SET", "ON",
    ],
    0.2,
) | {"programs": 0.4, "motions": 0.35, "corners passed in motion": 0.2}  # fmt: skip
"""The least share of an arm's first block that must be planned and certified, by feature."""

CHAINS = max(4, COUNT // 100)
"""Number of chains, the longest programs, for each arm."""

CHAIN_FLOORS = {"chains": 0.4, "long chains": 0.4, "corners of chains": 0.7, "chains with outputs": 0.3}
"""Least shares of an arm's chains that must be planned and certified, and of their corners that must be
passed without a stop.
"""

ROBOTS = ("INDUSTRIAL6", "TRACKED_MANIPULATOR")
ARMS = {name: Arm.in_folder(load_robot(name).value.folder) for name in ROBOTS}

share = st.floats(-1, 1, allow_nan=False).map(lambda value: round(value, 3))
six = st.lists(share, min_size=6, max_size=6)
times = st.sampled_from(["[MIN]", "[2]", "[4.7]", "[0.9]", "[12]"])
profiles = st.sampled_from(["", "_LSPB", "_POLY5"])
commands = st.one_of(
    st.tuples(st.just("joint"), six, profiles, times),
    st.tuples(st.just("delta_joint"), six, profiles, times),
    st.tuples(st.just("line"), six, profiles, times),
    st.tuples(st.just("delta"), six, profiles, times),
    st.tuples(st.just("spline"), st.lists(six, min_size=2, max_size=4), profiles, times),
)


def program(robot, entries):
    """Return the text of a program near the robot's home, and the meaning of each command."""
    arm = ARMS[robot]
    home = np.array(arm.data["positions"]["HOME"], float)
    middle = home + np.array([0, -5, -20, 10, 40, 0]) * (robot == "INDUSTRIAL6")
    reach = np.minimum(arm.upper - middle, middle - arm.lower)
    (point,), (rotation,) = arm.poses(middle[None])
    lines = ["DEFAULT {TCP} (mm,deg,s) {B}", f"P0001 MOVEJ {_numbers(middle)} [MIN]"]
    meaning = [("joint", middle)]
    for number, (kind, values, profile, time) in enumerate(entries, 2):
        if kind == "joint":
            goal = np.round(middle + np.array(values) * reach * 0.6, 4)
            lines.append(f"P{number:04d} MOVEJ{profile} {_numbers(goal)} {time}")
            meaning.append(("joint", goal))
        elif kind == "delta_joint":
            goal = np.round(np.array(values) * 10, 4)
            lines.append(f"P{number:04d} DMOVEJ{profile} {_numbers(goal)} {time}")
            meaning.append(("delta_joint", goal))
        elif kind == "line":
            shift = np.round(point + np.array(values[:3]) * 120, 3)
            rpy = np.round(rotation.as_euler("xyz", degrees=True) + np.array(values[3:]) * 25, 3)
            lines.append(f"P{number:04d} MOVEL{profile} {_numbers([*shift, *rpy])} {time}")
            meaning.append(("line", shift, rpy))
        elif kind == "delta":
            shift, rpy = np.round(np.array(values[:3]) * 60, 3), np.round(np.array(values[3:]) * 15, 3)
            lines.append(f"P{number:04d} DMOVE{profile} {_numbers([*shift, *rpy])} {time} {{TCP}}")
            meaning.append(("delta", shift, rpy))
        else:
            goals = [np.round(middle + np.array(one) * reach * 0.4, 4) for one in values]
            lines.append(f"P{number:04d} MOVEJ_SPLINE{profile} {'; '.join(map(_numbers, goals))} {time}")
            meaning.append(("spline", goals))
    return "\n".join(lines) + "\n", meaning


def _numbers(values):
    return " ".join(f"{value:.4f}" for value in values)


def judge(robot, text, meaning):
    """Check that an emitted text respects limits and tolerance and does what the program says."""
    arm = ARMS[robot]
    _, executed = read(text)
    for step, said in enumerate(meaning):
        done = executed[step]
        used = shares(arm, done)
        assert max(used.values()) <= 1 + 1e-6, (step, said[0], used)
        for end in (0.0, done.duration):
            assert np.abs(done.spline(end, nu=1)).max() < 1e-4
        if said[0] == "joint":
            assert off_joint_line(done, said[1]) <= 0.002
        elif said[0] == "delta_joint":
            assert off_joint_line(done, done.control[0] + said[1]) <= 0.002
        elif said[0] == "spline":
            assert off_spline(done, said[1]) <= 0.002
        else:
            point, rotation = _goal(arm, done, said)
            distance, angle = off_line(arm, done, point, rotation)
            assert distance <= 0.02
            assert angle <= 0.002


def _goal(arm, done, said):
    if said[0] == "line":
        return said[1], Rotation.from_euler("xyz", said[2], degrees=True)
    (start,), rotations = arm.poses(done.control[:1])
    turn = rotations[0]
    return start + turn.apply(said[1]), turn * Rotation.from_euler("xyz", said[2], degrees=True)


REAL_ARMS = ("ur5", "talos-7", "tiago-8")


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    """Return a function that returns the robot of a name, and its independent model."""
    made_here = tmp_path_factory.mktemp("arms")
    known = {}

    def find(name):
        if name not in known:
            where = name
            if name in REAL_ARMS:
                file, arguments, _ = REAL[name]
                if not (DATA / file).exists():
                    pytest.skip("example-robot-data isn't installed")
                made(DATA / file, made_here / name, *arguments)
                where = str(made_here / name)
            robot = robot_of(where)
            known[name] = robot, Arm.in_folder(robot.folder)
        return known[name]

    return find


def held(robot, arm, program, seed):
    """Check the plan of a program by independent code. Return True if it was planned and certified, and the
    steps whose corners are passed without a stop.

    The planner may refuse a program, but its plans must pass this check and get a certificate.
    """
    plan, diagnostics = planned(program.text, robot)
    if plan is None:
        assert any(one.is_error for one in diagnostics)
        return False, {}
    request = Request(robot)
    judged = certified(plan, request)
    refused = [one.message for one in judged.diagnostics if one.is_error and one.code.startswith("Y11")]
    text = emit(lower(plan, request.target or "rotary", request.robot.tolerance)).text(())
    chosen = {motion.step: motion.waypoints for motion in plan.motions}
    told = told_by_step((*diagnostics, *judged.diagnostics))
    found = judged_anew(arm, program.said, text, chosen, told).faults
    assert (found, refused) == ((), []), f"seed {seed}:\n{program.text}"
    assert judged.value is not None or any(one.is_error for one in judged.diagnostics)
    return judged.value is not None, overlaps(text)


def tallied(robot, arm, seeds, looked_at=held):
    """Draw the programs of some seeds, check each, and count which are planned."""
    tally = Tally()
    for seed in seeds:
        program = drawn(arm, np.random.default_rng(seed), most=3 if seed < EASY else 6)
        well, flowing = looked_at(robot, arm, program, seed)
        tally.count("programs", well)
        if " SET LAMP " in program.text:
            tally.count("SET", well)
        if "ON CURTAIN" in program.text:
            tally.count("ON", well)
        for step, names in features(program):
            for name in names:
                tally.count(name, well)
            if "BLEND" in names:
                tally.count("corners passed in motion", well and step in flowing)
    return tally


@pytest.mark.parametrize("block", range(max(1, COUNT // (5 * BLOCK))))
@pytest.mark.parametrize("name", [*ROBOTS, *REAL_ARMS])
def test_what_is_planned_keeps_limits_paths_and_times_and_is_certified(name, block, folder):
    robot, arm = folder(name)
    tally = tallied(robot, arm, range(block * BLOCK, (block + 1) * BLOCK))
    assert tally.below(FLOORS if block == 0 else {"programs": 0.2}) == []


@pytest.mark.parametrize("name", [*ROBOTS, *REAL_ARMS])
def test_chains_of_short_pieces_are_one_path_and_keep_limits_paths_and_speeds(name, folder):
    robot, arm = folder(name)
    tally = Tally()
    for seed in range(CHAINS):
        program = drawn_chain(arm, np.random.default_rng(seed))
        well, flowing = held(robot, arm, program, seed)
        tally.count("chains", well)
        if len(program.said) > 40:
            tally.count("long chains", well)
        if " SET LAMP " in program.text:
            tally.count("chains with outputs", well)
        for step, one in program.said.items():
            if well and one.blend is not None:
                tally.count("corners of chains", step in flowing)
    assert tally.below(CHAIN_FLOORS) == []


def test_a_planner_that_refuses_everything_is_found(monkeypatch, folder):
    def refuse(program, request):
        return Result(None, (Diagnostic("Y0601", "refused", program.source, Span.on_line(1, 1, 2)),))

    monkeypatch.setattr(stages, "plan_program", refuse)
    tally = tallied(*folder("TRACKED_MANIPULATOR"), range(BLOCK))
    assert {one.partition(":")[0] for one in tally.below(FLOORS)} == set(FLOORS)


def test_a_planner_that_refuses_one_kind_of_motion_is_found(monkeypatch, folder):
    """If the planner refuses all arcs but plans all else, only the floor of arcs fails.

    Programs without arcs are counted as planned, as other tests show that they are.
    """
    for module in (frame_motions, ahead):
        monkeypatch.setattr(module, "arc_through", lambda *_: NoArc("straight"))

    def held_if_arc(robot, arm, program, seed):
        if any(one.kind == "arc" for one in program.said.values()):
            return held(robot, arm, program, seed)
        return True, dict.fromkeys(program.said, 2)

    tally = tallied(*folder("TRACKED_MANIPULATOR"), range(BLOCK), held_if_arc)
    assert [one.partition(":")[0] for one in tally.below(FLOORS)] == ["arc"]


@pytest.mark.parametrize("robot", ROBOTS)
@exercises(named=0.2)
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(entry=commands)
def test_the_shortest_time_that_an_error_names_works(tally, robot, entry):
    text, _ = program(robot, [(*entry[:3], "[0.3]")])
    _, diagnostics = compiled(text, robot)
    tally.count("named", any(one.code == "Y0601" and one.fix is not None for one in diagnostics))
    for one in diagnostics:
        if one.code == "Y0601" and one.fix is not None:
            (edit,) = one.fix.edits
            lines = text.splitlines()
            line = lines[edit.span.line - 1]
            lines[edit.span.line - 1] = (
                line[: edit.span.column - 1] + edit.text + line[edit.span.end_column - 1 :]
            )
            _, again = compiled("\n".join(lines), robot)
            assert not [two.code for two in again if two.is_error]


@pytest.mark.parametrize("time", ["[MIN]", "[12]"])
@pytest.mark.parametrize("there", [68, 50, 20])
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_spline_that_turns_back_on_itself_is_proved(robot, there, time):
    """One joint moves out and back: near the point of return, a position doesn't determine the distance along
    the path.
    """
    home = ARMS[robot].data["positions"]["HOME"][1:]
    others = _numbers(home)
    text = (
        f"DEFAULT (deg,s)\nP0010 MOVEJ 25.5 {others} [MIN]\n"
        f"P0020 MOVEJ_SPLINE {there} {others}; 0 {others} {time}\n"
    )
    made, diagnostics = compiled(text, robot)
    assert not [one for one in diagnostics if one.is_error], diagnostics
    goals = [np.array([there, *home], float), np.array([0, *home], float)]
    judge(robot, made.text, [("joint", np.array([25.5, *home])), ("spline", goals)])


SEVEN_JOINTS = """DEFAULT {TCP} (mm,deg,s) {B}
P0010 DMOVE 20 0 0 0 0 0 [2] BLEND 2
P0020 DMOVEJ 5 0 0 0 0 5 0 [2]
"""


def test_a_blend_from_a_frame_to_joints_on_seven_joints(folder):
    _, diagnostics = compiled(SEVEN_JOINTS, folder("talos-7")[0])
    assert [one.code for one in diagnostics if one.is_error] == []


def test_a_slow_cruise_beside_a_blend():
    text = """DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEL -40 876 654 -95 2 -24 [V 5] BLEND 20
P0020 MOVEL -78 871 521 -102 13 -11 [MIN]
"""
    _, diagnostics = compiled(text, "TRACKED_MANIPULATOR")
    assert [one.code for one in diagnostics if one.is_error] == []
