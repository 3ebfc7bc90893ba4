"""Tests of motions that flow into each other: where the path is left, the duration of each motion, and the
limits in blends.

These tests sample densely; tests/test_random_programs.py does the same with random programs and the emitted
text.
"""

from itertools import pairwise

import numpy as np
import pytest
from programs import codes, compiled, planned

from yarclang.motion.chains import chain as chains
from yarclang.motion.framespeed import frame_speeds
from yarclang.robot.actuation import counts_per_joint
from yarclang.robot.kinematics.fk import tool_poses

HEAD = "DEFAULT {TCP} [2] (mm,deg,s) {B}\nOUTPUT GLUE M1 OFF\nP0001 MOVEJ_RPY 0 1174.4 1176 0 0 0 [MIN]\n"
FRAMES = """P0010 MOVEL 150 1174.4 1176 0 0 0 BLEND 20
P0020 MOVEL 150 1174.4 1326 0 0 10 BLEND 20
P0030 MOVEL 0 1174.4 1326 0 0 0
"""
JOINTS = """P0010 MOVEJ 0 0 0 0 30 0 [3] BLEND 4
P0020 MOVEJ 20 0 0 0 30 0 [3] BLEND 4
P0030 MOVEJ_SPLINE 20 0 15 0 30 0; 20 10 15 0 10 10 [4] BLEND 3
P0040 MOVEJ 0 0 0 0 -10 0 [3]
"""
MIXED = """P0010 MOVEL 150 1174.4 1176 0 0 0 BLEND 15
P0020 MOVEJ 0 0 0 0 -30 0 [4] BLEND 15
P0030 MOVEL 0 1174.4 1326 0 0 0 [4]
"""
ARCS = """P0010 MOVEC 60 1134.4 1176; 120 1174.4 1176 0 0 10 BLEND 10
P0020 MOVEL_SPLINE 160 1174.4 1226 0 0 10; 120 1174.4 1276 0 0 0 [3] BLEND 10
P0030 MOVEL 0 1174.4 1276 0 0 0
"""
CHAINS = {"frames": FRAMES, "joints": JOINTS, "mixed": MIXED, "arcs": ARCS}


def chain(lines):
    plan, diagnostics = planned(HEAD + lines)
    assert [one for one in diagnostics if one.is_error] == []
    return plan, codes(diagnostics)


def dense(plan, number):
    curve = plan.motions[number].curve
    return curve.sample(np.linspace(0, curve.duration, 25 * curve.segments + 1))


def corner_distance(plan, number, q):
    """Return the distances of joint positions from the end of a motion, in the unit of its BLEND."""
    steps = plan.program.steps
    motion, step = plan.motions[number], steps[plan.motions[number].step]
    following = steps[plan.motions[number + 1].step]
    of_joints = all(type(one).__name__ in ("JointMove", "SplineMove") for one in (step, following))
    if of_joints:
        return np.abs(q - motion.path.end).max(axis=1) / step.blend.angle
    tcp = plan.robot.flange_from_frame["TCP"]
    both = tool_poses(plan.robot.chain, np.concatenate((motion.path.end[None], q)), tcp)[:, :3, 3]
    return np.linalg.norm(both[1:] - both[0], axis=1) / step.blend.length


def off_path(path, q):
    """Return the distances of joint positions from a path [mm or deg], by the nearest of many points."""
    s = np.linspace(0, 1, 4001)
    if hasattr(path, "frame"):
        tcp = path.flange_from_moving
        places = path.frame.poses(s)[:, :3, 3] * 1e3
        points = tool_poses(path.chain, q, tcp)[:, :3, 3] * 1e3
    else:
        places, points = np.degrees(path.joints(s)), np.degrees(q)
    nearest = np.array([np.linalg.norm(places - point, axis=1).min() for point in points])
    # The nearest point may be between two samples.
    return nearest - np.linalg.norm(np.diff(places, axis=0), axis=1).max()


@pytest.mark.parametrize("name", CHAINS)
def test_the_path_is_left_only_inside_the_ball(name):
    plan, found = chain(CHAINS[name])
    assert set(found) <= {"Y0505", "Y0702"}
    assert all(motion.flows for motion in plan.motions[1:-1])
    for number in range(1, len(plan.motions)):
        q = dense(plan, number)[0][::5]
        outside = np.ones(len(q), bool)
        if number > 1:
            outside &= corner_distance(plan, number - 1, q) > 1
        if number + 1 < len(plan.motions):
            outside &= corner_distance(plan, number, q) > 1
        assert outside.any()
        assert off_path(plan.motions[number].path, q[outside]).max() < 0.02


@pytest.mark.parametrize("name", CHAINS)
def test_times_count_from_middle_to_middle(name):
    plan, _ = chain(CHAINS[name])
    for motion in plan.motions[1:]:
        wanted = plan.program.steps[motion.step].timing.duration
        assert motion.curve.duration == pytest.approx(wanted, abs=2e-4)
        assert motion.curve.segment == plan.motions[1].curve.segment


@pytest.mark.parametrize("name", CHAINS)
def test_limits_hold_and_nothing_jumps(name, industrial6):
    plan, _ = chain(CHAINS[name])
    limits = industrial6.limits
    for number in range(1, len(plan.motions)):
        q, v, a = dense(plan, number)
        curve = plan.motions[number].curve
        assert ((q >= limits.lower) & (q <= limits.upper)).all()
        assert (np.abs(v) <= limits.velocity).all()
        assert (np.abs(a) <= limits.acceleration).all()
        assert (np.abs(np.diff(curve.points, 3, axis=0)) <= limits.jerk * curve.segment**3).all()
        assert (np.abs(v @ counts_per_joint(industrial6).T) <= industrial6.actuation.velocity).all()
    for one, other in pairwise(plan.motions[1:]):
        ends = [one.curve.sample(np.array([one.curve.duration])), other.curve.sample(np.zeros(1))]
        for before, behind in zip(*ends, strict=True):
            assert behind == pytest.approx(before, abs=1e-8)
        assert np.abs(ends[0][1]).max() > 1e-3  # the robot doesn't stop at the corner


def test_between_two_lines_the_frame_stays_in_their_plane():
    plan, _ = chain(FRAMES)
    tcp = plan.robot.flange_from_frame["TCP"]
    for number in (1, 2):
        places = tool_poses(plan.robot.chain, dense(plan, number)[0], tcp)[:, :3, 3]
        assert places[:, 1] == pytest.approx(1.1744, abs=2e-5)


def speeds_along_a_line_with_corners():
    """Return the frame's speeds [mm/s] in the middle two of four lines in one direction."""
    lines = "".join(f"P{10 * k:04d} MOVEL {50 * k} 1174.4 1176 0 0 0 [V 80] BLEND 15\n" for k in range(1, 5))
    plan, found = chain(lines)
    assert found == ["Y1010"]
    tcp = plan.robot.flange_from_frame["TCP"]
    speeds = []
    for number in (2, 3):
        places = tool_poses(plan.robot.chain, dense(plan, number)[0], tcp)[:, :3, 3]
        step = plan.motions[number].curve.duration / (len(places) - 1)
        speeds.append(np.linalg.norm(np.diff(places, axis=0), axis=1) / step * 1e3)
    return np.concatenate(speeds)


def test_lines_in_one_direction_are_passed_at_about_one_speed():
    speed = speeds_along_a_line_with_corners()
    assert speed.max() <= 80.01
    assert speed.min() > 0.97 * 80


def test_lines_in_one_direction_are_passed_at_just_one_speed():
    assert speeds_along_a_line_with_corners().min() > 0.995 * 80


def test_blending_is_quicker_than_stopping():
    free = FRAMES.replace("[2]", "[MIN]")
    head = HEAD.replace("[2]", "[MIN]")
    through = planned(head + free)[0].duration
    stopping = planned(head + free.replace(" BLEND 20", ""))[0].duration
    assert through < stopping - 0.03


def test_times_without_a_common_part_are_rounded_where_they_meet_and_told():
    plan, found = chain(
        "P0010 MOVEL 50 1174.4 1176 0 0 0 [0.99991] BLEND 10\n"
        "P0020 MOVEL 50 1174.4 1226 0 0 0 [1.00007] BLEND 10\n"
        "P0030 MOVEL 0 1174.4 1226 0 0 0 [1.00013]\n"
    )
    assert found == ["Y0609"]
    lasts = [motion.curve.duration for motion in plan.motions[1:]]
    segment = plan.motions[1].curve.segment
    assert lasts == pytest.approx([0.99991, 1.00007, 1.00013], abs=segment)
    assert sum(lasts) == pytest.approx(3.00011, abs=segment / 2 + 1e-3)


def test_times_with_a_common_part_are_exact():
    plan, found = chain(
        "P0010 MOVEL 150 1174.4 1176 0 0 0 [1.2] BLEND 10\nP0020 MOVEL 150 1174.4 1326 0 0 0 [2.8] BLEND 10\n"
        "P0030 MOVEL 0 1174.4 1326 0 0 0 [3.6]\n"
    )
    assert found == []
    assert [motion.curve.duration for motion in plan.motions[1:]] == pytest.approx([1.2, 2.8, 3.6], abs=1e-4)


TANGENT = """P0010 MOVEL 100 1174.4 1176 0 0 0 BLEND 0
P0020 MOVEC 170.711 1174.4 1205.289; 200 1174.4 1276 0 0 0 BLEND 0
P0030 MOVEL 200 1174.4 1376 0 0 0
"""


def test_blend_0_leaves_the_path_nowhere():
    plan, found = chain(TANGENT)
    assert found == []
    assert all(motion.flows for motion in plan.motions[1:-1])
    for number in (1, 2, 3):
        q = dense(plan, number)[0][::5]
        beside = [off_path(plan.motions[k].path, q) for k in range(max(1, number - 1), min(4, number + 2))]
        assert np.min(beside, axis=0).max() < 0.02


@pytest.mark.parametrize(
    ("first", "second", "code"),
    [
        ("MOVEL 100 1174.4 1176 0 0 0", "MOVEL 200 1174.4 1176.09 0 0 0", []),
        ("MOVEL 100 1174.4 1176 0 0 0", "MOVEL 200 1174.4 1176.2 0 0 0", ["Y0607"]),
        ("MOVEL 100 1174.4 1176 0 0 10", "MOVEL 200 1174.4 1176 0 0 20", []),
        ("MOVEL 100 1174.4 1176 0 0 10", "MOVEL 200 1174.4 1176 0 0 10", ["Y0607"]),
        ("MOVEL 100 1174.4 1176 0 0 0", "MOVEL 0 1174.4 1176 0 0 0", ["Y0607"]),
    ],
)
def test_what_is_tangent(first, second, code):
    _, diagnostics = planned(f"{HEAD}P0010 {first} BLEND 0\nP0020 {second}\n")
    assert codes(diagnostics) == code


def test_outputs_don_t_break_a_blend_and_are_set_in_its_middle():
    lines = FRAMES.replace("P0020", "P0015 SET GLUE ON\nP0016 SET GLUE OFF\nP0017 SET GLUE ON\nP0020")
    plan, found = chain(lines)
    plain, _ = chain(FRAMES)
    assert found == []
    for one, other in zip(plan.motions, plain.motions, strict=True):
        assert np.array_equal(one.curve.points, other.curve.points)
    made, diagnostics = compiled(HEAD + lines)
    assert codes(diagnostics) == []
    assert "M1==1" in made.text


@pytest.mark.parametrize("between", ["WAIT [1]", "HOLD", "WAIT DOOR ON [5]"])
def test_what_the_robot_stands_for_ends_a_chain(between):
    plan, diagnostics = planned(
        HEAD.replace("OUTPUT", "INPUT DOOR M11\nOUTPUT") + FRAMES.replace("P0020", f"P0015 {between}\nP0020")
    )
    assert codes(diagnostics) == ["Y1010"]
    assert [motion.flows for motion in plan.motions] == [False, False, True, False]
    _, v, _ = plan.motions[1].curve.sample(np.array([plan.motions[1].curve.duration]))
    assert v == pytest.approx(np.zeros((1, 6)), abs=1e-9)


@pytest.mark.parametrize("options", ["[50%]", "[MIN] ACC 30%"])
def test_shares_of_the_limits_hold_in_overlaps_too(options, industrial6):
    lines = "".join(line.replace(" BLEND", f" {options} BLEND") + "\n" for line in FRAMES.splitlines()[:2])
    plan, _ = chain(
        lines + f"P0030 MOVEL 0 1174.4 1326 0 0 0 {options}\n".replace("[MIN] ACC 30%", "[MIN] ACC 30%")
    )
    assert any(motion.flows for motion in plan.motions)
    share, ramp = (0.5, 0.5) if "%]" in options else (1.0, 0.3)
    for number in (1, 2, 3):
        _, v, a = dense(plan, number)
        assert (np.abs(v) <= share * industrial6.limits.velocity).all()
        assert (np.abs(a) <= ramp * industrial6.limits.acceleration).all()


def test_a_long_chain_flows_all_the_way():
    lines = "".join(
        f"P{10 * k:04d} MOVEL {100 * (k % 2)} 1174.4 {1176 + 5 * k} 0 0 0 BLEND 2\n" for k in range(1, 16)
    )
    plan, found = chain(lines)
    assert found == ["Y1010"]
    assert sum(motion.flows for motion in plan.motions) == 14
    assert plan.duration - plan.motions[0].curve.duration == pytest.approx(30, abs=1e-2)


def test_the_same_program_gives_the_same_curves():
    one, other = (chain(MIXED)[0] for _ in range(2))
    for first, second in zip(one.motions, other.motions, strict=True):
        assert np.array_equal(first.curve.points, second.curve.points)


ZIGZAG = (
    "P0010 MOVEL 20 1174.4 1176 0 0 0 {0} BLEND 4\n"
    "P0020 MOVEL 20 1194.4 1176 0 0 0 {0} BLEND 4\n"
    "P0030 MOVEL 50 1194.4 1176 0 0 0 {0}\n"
)
TURNS = ZIGZAG.replace("MOVEL 20 1194.4 1176", "MOVEC 30 1184.4 1176; 20 1194.4 1176")
JOINT_TURNS = (
    "P0010 MOVEJ 0 0 0 0 30 0 [MIN] BLEND 4\n"
    "P0020 MOVEJ 20 0 0 0 30 0 [MIN] BLEND 4\n"
    "P0030 MOVEJ 20 9 0 0 0 0 [MIN]\n"
)


@pytest.mark.parametrize(
    "lines",
    [
        ZIGZAG.format("[MIN]"),
        ZIGZAG.format("[V 100]"),
        ZIGZAG.format("[V 8]"),
        ZIGZAG.format("[50%]"),
        TURNS.format("[V 60]"),
        TURNS.format("[MIN]"),
        JOINT_TURNS,
        FRAMES.replace("BLEND 20", "[MIN] BLEND 20", 1),
    ],
)
def test_what_is_given_up_would_not_be_taken(lines, monkeypatch):
    made, _ = chain(lines)
    monkeypatch.setattr(chains, "_quickest", lambda found: np.inf)
    at_length, _ = chain(lines)
    assert [one.flows for one in made.motions] == [one.flows for one in at_length.motions]
    assert sum(one.curve.duration for one in made.motions) == pytest.approx(
        sum(one.curve.duration for one in at_length.motions), rel=1e-9
    )


@pytest.mark.parametrize("speeds", [(20, 50), (50, 20), (20, 20.0001), (5, 60), (10, 40, 15)])
def test_a_speed_changes_where_one_line_goes_on_as_the_next(speeds):
    lines = [
        f"P{10 * number:04d} MOVEL {50 * number} 1174.4 1176 0 0 0 [V {speed}] BLEND 0"
        for number, speed in enumerate(speeds, 1)
    ]
    lines[-1] = lines[-1].removesuffix("BLEND 0")
    _, found = compiled(HEAD + "\n".join(lines) + "\n")
    assert [one for one in found if one.is_error] == []
    assert "Y0610" not in codes(found)
    plan, _ = chain("\n".join(lines) + "\n")
    assert all(one.flows for one in plan.motions[1:-1])
    # Before a corner, no motion is faster than its programmed speed.
    tcp = plan.robot.flange_from_frame["TCP"]
    for number, speed in enumerate(speeds, 1):
        q = dense(plan, number)[0]
        curve = plan.motions[number].curve
        places = tool_poses(plan.robot.chain, q, tcp)[:, 0, 3] * 1e3
        rates = np.diff(places) / (curve.duration / (len(q) - 1))
        inside = (places[:-1] >= 50 * (number - 1) + 0.01) & (places[1:] <= 50 * number - 0.01)
        assert rates[inside].max() == pytest.approx(speed, rel=2e-3)


LINES_IN_A_LINE = """P0020 MOVEL -37.7272 1261.8414 1557.8784 16.4477 -8.1157 4.0371 [MIN] TOL 0.05 BLEND 0
P0030 MOVEL -38.3332 1261.9510 1558.7356 16.4477 -8.1157 4.0371 [MIN] TOL 0.05 BLEND 0
P0040 MOVEL -39.6513 1262.1959 1560.6193 16.4477 -8.1157 4.0371 [MIN] TOL 0.05
"""


@pytest.mark.parametrize("lines", [*CHAINS.values(), LINES_IN_A_LINE])
def test_a_stop_in_a_chain_has_three_equal_points(lines):
    """At a stop, the last three control points of a motion are equal and at its path's end. The correction of
    an overlap also changes the points around the overlap, but must not change these points.
    """
    head = "DEFAULT {TCP} [2] (mm,deg,s) {B}\nP0001 MOVEJ 0 -5 -20 10 40 0 [MIN]\n"
    begin = head if lines is LINES_IN_A_LINE else HEAD
    made, found = compiled(begin + lines)
    assert [one for one in found if one.is_error] == []
    motions = made.plan.motions
    assert motions[0].overlap is None
    assert motions[-1].overlap is None
    for one, other in pairwise(motions):
        np.testing.assert_array_equal(one.curve.points[-3:], other.curve.points[:3])
    for motion in motions:
        if motion.overlap is None:
            end = np.tile(motion.curve.points[-1], (3, 1))
            np.testing.assert_array_equal(motion.curve.points[-3:], end)
            np.testing.assert_allclose(end[0], motion.path.end, atol=1e-15)
    if lines is LINES_IN_A_LINE:
        assert [motion.overlap is None for motion in motions] == [True, True, False, True]


SPEED_FOR_AN_INSTANT = """DEFAULT {TCP} (mm,deg,s) {B}
POSE AT1 -24.3190 870.5900 553.1920 -112.7710 -19.3630 -13.1460
POSE AT2 -40.2490 830.4970 574.6690 -99.8780 -3.1040 -3.1750
POSE AT3 -14.1990 880.6800 529.1080 -95.3590 -2.7010 -1.8920
POSE AT4 14.5210 932.3520 617.0160 -82.0550 -9.8170 -12.0920
P0010 MOVEJ AT1 [4.7] BLEND <=8
P0020 MOVEL_SPLINE_SCURVE AT2; AT3; AT4 [V 20]
"""


def test_a_speed_that_is_had_only_for_an_instant_is_the_one_of_the_curve():
    """Without a cruise, the law reaches its largest speed at the end of the blend, 0.1 % below the speed that
    its ramps allow.
    """
    made, found = compiled(SPEED_FOR_AN_INSTANT, "TRACKED_MANIPULATOR")
    assert [one for one in found if one.is_error] == []
    motion = made.plan.motions[1]
    assert made.plan.motions[0].overlap
    assert 0.5 < motion.kept < 0.6
    q, rates, _ = motion.curve.sample(np.linspace(0, motion.curve.duration, 8 * motion.curve.segments + 1))
    assert frame_speeds(motion.path, q, rates).max() == pytest.approx(0.02 * motion.kept, rel=4e-4)


def test_the_robot_stops_only_where_the_motions_cannot_flow():
    text = (
        "DEFAULT [3] (deg,s)\nP0010 MOVEJ 10 0 0 0 0 0 BLEND 2\nP0020 MOVEJ 20 0 10 0 0 0 BLEND 2\n"
        "P0030 MOVEJ 20 0 30 0 0 0 [0.81] BLEND 2\nP0040 MOVEJ 40 0 30 0 0 0 [0.81] BLEND 2\n"
        "P0050 MOVEJ 50 0 40 0 0 0 BLEND 2\nP0060 MOVEJ 60 0 40 0 0 0\n"
    )
    plan, found = planned(text)
    stops = [one.span.line for one in found if one.code == "Y0608"]
    assert 5 in stops
    assert not {2, 6} & set(stops)
    assert compiled(text)[0] is not None
    assert len(plan.motions) == 6


@pytest.mark.parametrize(
    ("second", "helps"),
    [("P0030 MOVEL 50 1100 950 0 0 0", True), ("P0030 MOVEJ HOME", False)],
)
def test_a_tolerance_is_proposed_only_where_it_allows_a_corner(second, helps):
    text = (
        "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1100 900 0 0 0\n"
        f"P0020 MOVEL 50 1100 900 0 0 0 BLEND 0\n{second}\n"
    )
    (one,) = [one for one in planned(text)[1] if one.code == "Y0607"]
    assert ("TOL 0.05" in one.help) is helps
    tolerant = planned(text.replace("BLEND 0", "TOL 0.05 BLEND 0"))[1]
    assert ("Y0607" not in codes(tolerant)) is helps
