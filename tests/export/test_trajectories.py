"""Tests of exported trajectories: they stay within the tolerance of the executed path, which scipy's splines
compute from the controller text.
"""

import io
import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, robot_of

from tests.export.trajectories import both_texts, driven, executed, made_of, read_json, read_yaml
from yarclang.campaign.drawing import drawn
from yarclang.cli.yarc import main
from yarclang.convert.convert import convert
from yarclang.convert.course import Wishes as ImportWishes
from yarclang.convert.documents import read_json as read_json_values
from yarclang.convert.documents import read_yaml as read_yaml_values
from yarclang.convert.trajectory import content_of_documents
from yarclang.diagnostics import Collector
from yarclang.independent.arm import Arm
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile

HEAD = "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nOUTPUT GRIPPER M1\nINPUT PART M11\n"
BEGIN = "P0010 MOVEJ 0 -10 -20 0 -60 0\n"


def motion(draw):
    joints = draw(st.tuples(*[st.integers(-25, 25)] * 6))
    q = np.array([0, -10, -20, 0, -60, 0]) + joints
    profile = draw(st.sampled_from(["", "_POLY5", "_SCURVE", "_LSPB"]))
    time = draw(st.sampled_from(["[50%]", "[MIN]", "[4.7]", "[90%]"]))
    blend = draw(st.sampled_from(["", "", " BLEND 3"]))
    return f"MOVEJ{profile} {' '.join(map(str, q))} {time}{blend}"


@st.composite
def programs(draw):
    """Draw a program's text, and the steps of the motions of each stretch."""
    lines, stretches, here = [], [], []
    flows = False
    for number in range(draw(st.integers(1, 6))):
        what = "motion" if number == 0 or flows else draw(st.sampled_from(["motion"] * 3 + ["set", "wait"]))
        if what == "motion":
            line = motion(draw)
            here.append(len(lines))
            flows = "BLEND" in line
        else:
            line = "SET GRIPPER ON" if what == "set" else "WAIT [0.25]"
            if here:
                stretches.append(here)
            here = []
        lines.append(line)
    if flows:
        lines[-1] = lines[-1].partition(" BLEND")[0]
    if here:
        stretches.append(here)
    text = HEAD + "".join(f"P{number + 1:04d} {line}\n" for number, line in enumerate(lines))
    return text, stretches


@settings(max_examples=20, deadline=None)
@given(programs(), st.sampled_from([1e-3, 1e-4, 1e-6]), st.booleans())
def test_every_driver_stays_within_the_tolerance(drawn, tolerance, straight):
    text, stretches = drawn
    program, made, found = made_of(text, tolerance=tolerance, straight=straight)
    steps = {step.origin.label: number for number, step in enumerate(program.program.steps)}
    ways = executed(
        program.text,
        np.radians(np.ones(6)),
        [[steps[f"P{number + 1:04d}"] for number in few] for few in stretches],
    )
    assert made.size == len(stretches)
    assert codes(found) == ["Y1532"] * ("SET" in text or "WAIT" in text)
    of_yaml, of_json = both_texts(made)
    trajectories = read_yaml(of_yaml)
    for one, other in zip(trajectories, read_json(of_json), strict=True):
        for first, second in zip(one, other, strict=True):
            np.testing.assert_array_equal(first, second)
    kinds = ["cubic", "quintic"] + ["linear"] * straight
    assert set(made.proved) == set(kinds)
    worst = dict.fromkeys(kinds, 0.0)
    for trajectory, (times, places, duration) in zip(trajectories, ways, strict=True):
        stamps, x, v, a = trajectory
        assert stamps[0] == 0
        assert (np.diff(stamps) > 0).all()
        assert 0 <= stamps[-1] * 1e-9 - duration + 1e-11 < 1.01e-9
        np.testing.assert_allclose(x[[0, -1]], places[[0, -1]], atol=6e-11)
        assert not v[[0, -1]].any()
        assert not a[[0, -1]].any()
        for kind in kinds:
            worst[kind] = max(worst[kind], np.abs(driven(kind, trajectory, times) - places).max())
    for kind, off in worst.items():
        assert off <= made.proved[kind].max() * (1 + 1e-6) + 1e-13
        assert made.proved[kind].max() <= tolerance


@pytest.mark.parametrize("seed", [7, 19])
def test_all_kinds_of_motions_at_the_smallest_tolerance(seed, industrial6):
    """With seed 7, the tolerance was once exceeded by 0.05 %, because the hulls were cut at other places than
    in the choice of waypoints.
    """
    text = drawn(Arm.in_folder(industrial6.folder), np.random.default_rng(seed), most=4).text
    _, made, _ = made_of(text, tolerance=1e-6, straight=True)
    assert len(made.points.time) > 100
    assert 0.99e-6 < made.worst <= 1e-6


def test_the_proved_bound_is_near_to_what_happens():
    """The proved bound is at least 95 % of the real deviation; a looser one would cost waypoints."""
    text = HEAD + BEGIN + "P0020 DMOVE 50 60 -20 0 0 0 [6]\nP0030 MOVEJ_POLY5 5 -10 -20 0 -60 0 [4]\n"
    program, made, _ = made_of(text, straight=True)
    ((times, places, _),) = executed(program.text, np.radians(np.ones(6)), [[0, 1, 2]])
    (trajectory,) = read_yaml(both_texts(made)[0])
    for kind, bound in made.proved.items():
        off = np.abs(driven(kind, trajectory, times) - places).max()
        assert 0.95 * bound.max() <= off <= bound.max()


LONGEST = 60
"""Most candidates for the next waypoint that `fewest` tries."""


def fewest(made_points, fits):
    """Return the number of waypoints if each is as far as possible from the one before."""
    at, count = 0, 1
    last = len(made_points.time) - 1
    while at < last:
        ends = np.arange(at + 1, min(at + LONGEST, last) + 1)
        sound = fits(np.full(len(ends), at), ends)
        at = int(ends[np.flatnonzero(sound)[-1]])
        assert not sound[-1] or at == last
        count += 1
    return count


@pytest.mark.parametrize("straight", [False, True])
def test_nearly_as_few_as_the_longest_steps_would_need(straight):
    from yarclang.export.ros.course import course_of
    from yarclang.export.ros.sampling import _candidates, _Fits, sampled
    from yarclang.pipeline.line_map import map_lines

    text = HEAD + BEGIN + "P0020 DMOVE_POLY5 150 100 -90 0 0 0 [6]\nP0030 MOVEJ 20 -30 10 5 -50 9 [8]\n"
    program, made, _ = made_of(text, straight=straight)
    path = course_of(program.certificate.text, map_lines(program.text), program.plan.robot, {}).path
    kinds = made.wishes.kinds
    candidates = _candidates(path, 1e-4, straight)
    least = fewest(candidates, _Fits(candidates, 1e-4, kinds))
    chosen = sampled(path, 1e-4, kinds)
    assert len(candidates.time) > 3 * least
    assert least <= len(chosen.time) <= 1.25 * least + 1


def test_the_proof_sees_other_way_points():
    from dataclasses import replace

    from yarclang.export.ros.course import course_of
    from yarclang.export.ros.proof import deviation
    from yarclang.pipeline.line_map import map_lines

    text = HEAD + BEGIN + "P0015 SET GRIPPER ON\nP0020 DMOVE 50 60 -20 0 0 0 [6]\n"
    program, made, _ = made_of(text)
    path = course_of(program.certificate.text, map_lines(program.text), program.plan.robot, {}).path
    points = made.points
    for number in range(len(points.time)):
        moved = points.x.copy()
        moved[number, number % 6] += 3e-4
        for kind in ("linear", "cubic", "quintic"):
            assert deviation(path, replace(points, x=moved), kind).max() > 1.9e-4
    late = points.time.copy()
    late[points.stretch == 1] += np.linspace(0, 2e7, (points.stretch == 1).sum()).astype(np.int64)
    assert deviation(path, replace(points, time=late), "cubic").max() > 1e-4


def between(made):
    return [one for number in sorted(made.placed) for one in made.placed[number]]


def test_what_lies_between_is_said_and_stands_in_both_files():
    text = (
        HEAD
        + "P0010 SET GRIPPER OFF\nP0020 MOVEJ 0 -10 -20 0 -60 0\nP0030 WAIT PART ON [20]\nP0040 HOLD look\n"
        + "P0050 MOVEJ 5 -10 -20 0 -60 0\nP0060 WAIT [0.5]\nP0070 SET GRIPPER ON\n"
    )
    text = text.replace("HOLD look", 'HOLD "look"')
    _, made, found = made_of(text)
    assert [one.kind for one in between(made)] == ["set", "wait", "hold", "dwell", "set"]
    assert [one.before for one in between(made)] == [0, 1, 1, 2, 2]
    assert codes(found) == ["Y1532"]
    assert "2 outputs, 1 wait, 1 hold, 1 stop for a time" in found[0].message
    of_yaml, of_json = both_texts(made)
    for said in (
        "P0010 SET: set M1 (GRIPPER) to 0",
        "wait for PART (M11=1), at most 20 s",
        "wait for the operator: look",
    ):
        assert "# before it: " in of_yaml
        assert said in of_yaml
    assert of_yaml.rstrip().endswith("# after it: P0070 SET: set M1 (GRIPPER) to 1")
    whole = json.loads(of_json)
    assert [one["kind"] for one in whole["trajectories"][1]["before"]] == ["wait", "hold"]
    assert [one["what"] for one in whole["after"]] == ["stand still for 0.5 s", "set M1 (GRIPPER) to 1"]


def test_outputs_in_motion_have_their_times():
    text = (
        HEAD
        + BEGIN
        + "P0020 DMOVE 90 0 0 0 0 0 [3] BLEND 20\nP0030 SET GRIPPER ON\nP0040 DMOVE 0 90 0 0 0 0 [3]\n"
    )
    program, made, found = made_of(text)
    (put,) = between(made)
    assert (made.size, put.kind, put.before) == (1, "set", 0)
    first, second = (one.curve.duration for one in program.plan.motions[:2])
    # the output is set in the middle of the blend
    assert put.time == pytest.approx(first + second, abs=2 * program.plan.motions[1].curve.segment)
    of_yaml, of_json = both_texts(made)
    assert f"# during it, {put.time:.6f} s after its start: P0030 SET: set M1 (GRIPPER) to 1" in of_yaml
    assert json.loads(of_json)["trajectories"][0]["during"][0]["time_s"] == pytest.approx(put.time)
    assert codes(found) == ["Y1532"]


def test_ways_of_a_when_begin_where_the_robot_stands():
    text = (
        HEAD + BEGIN + "WHEN PART ON\nP0030 MOVEJ 9 -10 -20 0 -60 0\nP0040 MOVEJ 0 -10 -20 0 -60 0\n"
        "ELSE\nP0060 DMOVEJ 0 0 0 0 5 0\nP0065 DMOVEJ 0 0 0 0 -5 0\nEND\nP0080 MOVEJ 1 -10 -20 0 -60 0\n"
    )
    _, made, _ = made_of(text)
    assert [one.kind for one in between(made)] == ["when", "else", "end"]
    places = [read_yaml(both_texts(made)[0])[number][1] for number in range(4)]
    for number in (1, 2, 3):
        np.testing.assert_allclose(places[number][0], places[0][-1], atol=2e-10)


def test_a_program_without_a_motion_is_refused():
    _, made, found = made_of(HEAD + "P0010 SET GRIPPER ON\n")
    assert made is None
    assert codes(found) == ["Y1531"]


@pytest.mark.parametrize("version", [1, 2])
def test_the_importer_takes_both_files(version):
    text = (
        HEAD
        + BEGIN
        + "P0020 SET GRIPPER ON\nP0030 DMOVE 50 60 0 0 0 0 [6]\nP0040 MOVEJ 5 -10 -20 0 -60 0 [4]\n"
    )
    _, made, _ = made_of(text)
    robot = robot_of("INDUSTRIAL6")
    for name, said, read in zip(
        ("a.yaml", "a.json"), both_texts(made, version), (read_yaml_values, read_json_values), strict=True
    ):
        source = SourceFile(name, said)
        findings = Collector(source)
        content = content_of_documents(read(source, findings), robot, ImportWishes(), findings)
        assert findings.found == []
        assert len(content.courses) == made.size == 2
        for number, course in enumerate(content.courses):
            points = made.trajectory(number)
            np.testing.assert_allclose(course.times, points.time * 1e-9, atol=1e-12)
            np.testing.assert_allclose(np.radians(course.values), points.x, atol=1e-12)
        program = convert(source, robot, ImportWishes())
        assert program.value is not None


def test_version_1_reads_back_as_version_2():
    _, made, _ = made_of(HEAD + BEGIN + "P0020 MOVEJ 5 -10 -20 0 -60 0 [4]\n")
    for one, other in ((read_yaml, 0), (read_json, 1)):
        first, second = (one(both_texts(made, version)[other], version)[0] for version in (1, 2))
        for these, those in zip(first, second, strict=True):
            np.testing.assert_array_equal(these, those)


def test_sliding_joints_are_in_metres(tmp_path):
    scara = Path(__file__).parents[2] / "examples" / "scara.urdf"
    made = CliRunner().invoke(main, ["robot", "new", str(scara), "-y", "-o", str(tmp_path / "arm")])
    assert made.exit_code == 0
    robot = load_robot(str(tmp_path / "arm")).value
    (slide,) = np.flatnonzero(robot.chain.is_prismatic)
    away = np.where(robot.chain.is_prismatic, 20.0, 10.0)
    program, made, _ = made_of(
        f"DMOVEJ {' '.join(map(str, away))} [MIN] (mm,deg,s)\n".join(["P0010 ", ""]), robot
    )
    ((times, places, duration),) = executed(program.text, robot.axis_units, [[0]])
    (trajectory,) = read_yaml(both_texts(made)[0])
    assert np.abs(driven("cubic", trajectory, times) - places).max() <= 1e-4
    moved = trajectory[1][-1] - trajectory[1][0]
    assert moved[slide] == pytest.approx(0.02, abs=1e-6)
    assert trajectory[0][-1] * 1e-9 == pytest.approx(duration)
    units = json.loads(both_texts(made)[1])["units"]
    assert units == ["m" if number == slide else "rad" for number in range(robot.size)]


def test_the_same_program_gives_the_same_bytes():
    text = HEAD + BEGIN + "P0020 MOVEJ 5 -10 -20 0 -60 0 [4]\n"
    first, second = (both_texts(made_of(text)[1]) for _ in range(2))
    assert first == second


def test_a_name_with_a_line_end_makes_no_line():
    from dataclasses import replace

    _, made, _ = made_of(HEAD + BEGIN)
    odd = replace(made, program="a\n- b: [\u2028.yarc")
    said = both_texts(odd)
    assert len(list(yaml.safe_load_all(io.StringIO(said[0])))) == 1
    assert json.loads(said[1])["program"] == "a\n- b: [\u2028.yarc"


def test_a_bag_says_the_same(tmp_path):
    pytest.importorskip("rosbags")
    from rosbags.highlevel import AnyReader

    from yarclang.export.ros.bag import write_bag

    text = HEAD + BEGIN + "P0020 SET GRIPPER ON\nP0030 DMOVE 50 60 0 0 0 0 [6]\nP0040 SET GRIPPER OFF\n"
    _, made, _ = made_of(text)
    write_bag(tmp_path / "a.bag", made)
    write_bag(tmp_path / "b.bag", made)
    assert (tmp_path / "a.bag").read_bytes() == (tmp_path / "b.bag").read_bytes()
    found = []
    with AnyReader([tmp_path / "a.bag"]) as reader:
        for connection, time, raw in reader.messages():
            found.append((connection.topic, time, reader.deserialize(raw, connection.msgtype)))
    assert [topic for topic, _, _ in found] == [
        "/yarc/about",
        "/joint_path_command",
        "/yarc/between",
        "/joint_path_command",
        "/yarc/between",
    ]
    paths = [(time, message) for topic, time, message in found if topic == "/joint_path_command"]
    for number, (time, message) in enumerate(paths):
        points = made.trajectory(number)
        assert time == 10**9 + round(made.starts[number] * 1e9)
        assert tuple(message.joint_names) == made.robot.joint_names
        for name, wanted in (("positions", points.x), ("velocities", points.v), ("accelerations", points.a)):
            np.testing.assert_array_equal([getattr(one, name) for one in message.points], wanted)
        stamps = [one.time_from_start.sec * 10**9 + one.time_from_start.nanosec for one in message.points]
        np.testing.assert_array_equal(stamps, points.time)
    said = [json.loads(message.data) for topic, _, message in found if topic != "/joint_path_command"]
    assert said[0]["program_sha256"] == made.fingerprint
    assert [one["what"] for one in said[1:]] == ["set M1 (GRIPPER) to 1", "set M1 (GRIPPER) to 0"]


@pytest.mark.parametrize(
    ("line", "word"),
    [('SAY "half way"', "1 message"), ('ABORT "no part"', "1 ABORT")],
)
def test_every_kind_of_event_is_counted(line, word):
    text = HEAD + f"P0010 MOVEJ 10 0 0 0 0 0 [1]\nP0020 {line}\nP0030 MOVEJ 0 0 0 0 0 0 [1]\n"
    _, _, found = made_of(text)
    assert [each.message.split(" can't")[0] for each in found if each.code == "Y1532"] == [word]
