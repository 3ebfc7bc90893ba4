"""ROS trajectories and named states to programs."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import checked, codes

from tests.convert.conversions import commands, converted, numbers, program_of, refused

JOINTS = ["J1", "J2", "J3", "J4", "J5", "J6"]
EXTRA = [*JOINTS, "finger"]


def message(points, names=JOINTS, ros=2):
    """A JointTrajectory as plain data; `points` are (time [s], positions [rad])."""
    whole, part = ("sec", "nanosec") if ros == 2 else ("secs", "nsecs")
    return {
        "header": {"frame_id": ""},
        "joint_names": names,
        "points": [
            {
                "positions": list(q),
                "velocities": [],
                "time_from_start": {whole: int(time), part: round((time - int(time)) * 1e9)},
            }
            for time, q in points
        ],
    }


def turned(*angles):
    return [(2.0 * number, [np.radians(angle), 0, 0, 0, 0, 0]) for number, angle in enumerate(angles)]


@pytest.mark.parametrize("ros", [1, 2])
def test_both_releases_and_the_joints_order(ros):
    points = [(0, [6, 5, 4, 3, 2, 1]), (2.5, [0, 0, 0, 0, 0, 0]), (4, [0, 0, 0, 0, 0, 1])]
    points = [(time, np.radians(q).tolist()) for time, q in points]
    program = program_of(json.dumps(message(points, JOINTS[::-1], ros)), "arm.json")
    assert numbers(program) == pytest.approx(
        np.array([[1, 2, 3, 4, 5, 6], [0, 0, 0, 0, 0, 0], [1, 0, 0, 0, 0, 0]]), abs=1e-6
    )
    assert commands(program) == ["MOVEJ_SPLINE"]
    assert program.endswith("[4]\n")


def test_two_points_are_a_straight_motion():
    program = program_of(json.dumps(message(turned(0, 10))), "arm.json")
    assert program.splitlines()[-1] == "P0010 MOVEJ 10 0 0 0 0 0 [2]"
    assert "START  0 0 0 0 0 0".replace("  ", " ") in program


def test_one_point_is_reached_in_its_time():
    program = program_of(json.dumps(message([(3, [0.5, 0, 0, 0, 0, 0])])), "arm.json")
    assert program.splitlines()[-1] == "P0010 MOVEJ 28.647890 0 0 0 0 0 [3]".replace("890", "89")


def test_points_without_times_are_stops():
    program = program_of(json.dumps(message([(0, q) for _, q in turned(0, 10, 20)])), "arm.json")
    assert commands(program) == ["MOVEJ"] * 3
    assert "have no times" in program


@pytest.mark.parametrize(
    "wrap",
    [
        lambda one: {
            "joint_trajectory": one,
            "multi_dof_joint_trajectory": {"joint_names": [], "points": []},
        },
        lambda one: {"model_id": "x", "trajectory": [{"joint_trajectory": one}], "trajectory_start": {}},
        lambda one: {"goal": {"trajectory": one}},
    ],
    ids=["RobotTrajectory", "DisplayTrajectory", "goal"],
)
def test_inside_of_other_messages(wrap):
    program = program_of(json.dumps(wrap(message(turned(0, 5, 10)))), "arm.json")
    assert commands(program) == ["MOVEJ_SPLINE"]


def test_motions_of_other_kinds_are_not_lost():
    wrapped = {"multi_dof_joint_trajectory": {"joint_names": ["base"], "points": [{"transforms": []}]}}
    assert refused(json.dumps(wrapped), "arm.json").code == "Y1511"


STREAM = """\
joint_names: [J1, J2, J3, J4, J5, J6]
points:
- positions: [0, 0, 0, 0, 0, 0]
  time_from_start: {sec: 0, nanosec: 0}
- positions: [.1, 0, 0, 0, 0, 0]
  time_from_start:
    sec: 1
    nanosec: 500000000
---
joint_names: ['J1', "J2", J3, J4, J5, J6]
points:
- {positions: [1.0e-1, 0, 0, 0, 0, 0], time_from_start: {secs: 0, nsecs: 0}}
- {positions: [0, 0, 0, 0, 0, 0], time_from_start: {secs: 2, nsecs: 0}}
---
joint_names: [J1, J2, J3, J4, J5, J6]
points:
- {positions: [0, 0.1, 0, 0, 0, 0], time_from_start: 0}
- {positions: [0, 0.2, 0, 0, 0, 0], time_from_start: 2.5}
---
"""


@pytest.mark.parametrize("name", ["stream.yaml", "<stdin>"])
def test_a_stream_goes_on_where_it_stands(name):
    lines = [line for line in program_of(STREAM, name).splitlines() if line[:1] == "P"]
    assert [line[line.index("[") :] for line in lines] == ["[1.5]", "[2]", "[50%]", "[2.5]"]


def test_other_names_of_the_joints():
    names = [f"shoulder_{letter}" for letter in "abcdef"]
    text = json.dumps(message(turned(0, 10), names))
    assert refused(text, "arm.json").code == "Y1511"
    assert commands(program_of(text, "arm.json", joints=tuple(names))) == ["MOVEJ"]
    found = refused(text, "arm.json", joints=tuple(names[:4]))
    assert found.code == "Y1511"
    assert "4 joints" in found.message


def with_point(**point):
    data = message(turned(0, 10, 20))
    data["points"][1] |= point
    return json.dumps(data)


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("{}", "Y1509", "no JointTrajectory"),
        ("{", "Y1507", "not JSON"),
        ("[" * 100_000, "Y1508", "too deep"),
        ("1" * 5000, "Y1507", "digits"),
        (json.dumps(message([])), "Y1509", "no points"),
        (json.dumps({"joint_names": JOINTS, "points": [7]}), "Y1509", "isn't a message"),
        (json.dumps(message(turned(0, 1), EXTRA)), "Y1511", "unknown finger"),
        (json.dumps(message(turned(0, 1), JOINTS[1:])), "Y1511", "missing J1"),
        (json.dumps(message(turned(0, 1), [*JOINTS, "J1"])), "Y1511", "twice J1"),
        (with_point(positions=[1, 2]), "Y1509", "point 2 has 2 positions, there are 6 joints"),
        (with_point(positions=[0.0, "...", 0]), "Y1509", "cut off"),
        (with_point(positions=[0, 0, float("nan"), 0, 0, 0]), "Y1505", "position of J3 is 'nan'"),
        (with_point(positions=[0, 0, "x", 0, 0, 0]), "Y1505", "'x'"),
        (with_point(positions=[0, 0, True, 0, 0, 0]), "Y1505", "'True'"),
        (with_point(positions=[0, 0, 10**400, 0, 0, 0]), "Y1505", "J3"),
        (with_point(time_from_start={"sec": 9}), "Y1509", "isn't later"),
        (with_point(time_from_start={"sec": "soon"}), "Y1509", "can't be read"),
        (with_point(time_from_start=-1), "Y1509", "can't be read"),
    ],
)
def test_bad_json(text, code, words):
    found = refused(text, "arm.json")
    assert found.code == code
    assert words in found.message


BOMB = "a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n"


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        (BOMB, "Y1508", "repeats another part"),
        ("a: !!python/object/apply:os.system [ls]\n", "Y1508", "tag"),
        ("[" * 200 + "]" * 200, "Y1508", "nested"),
        ("[" * 100_000, "Y1508", "nested"),
        ("a: [1, 2\n", "Y1507", "not YAML"),
        ("a: b: c\n", "Y1507", "not YAML"),
        ("\t- x\n", "Y1507", "not YAML"),
        ("just a text\n", "Y1509", "no JointTrajectory"),
        ("? [a, b]\n: 3\n", "Y1509", "no JointTrajectory"),
    ],
)
def test_bad_yaml(text, code, words):
    found = refused(text, "arm.yaml")
    assert found.code == code
    assert words in found.message


TIMES = st.lists(st.integers(1, 5_000), min_size=1, max_size=7)
POINT = st.tuples(*[st.floats(-1.3, 1.3)] * 6)


@settings(max_examples=50)
@given(steps=TIMES, data=st.data(), order=st.permutations(range(6)))
def test_arbitrary_trajectories_keep_their_positions_and_time(steps, data, order):
    points = [data.draw(POINT) for _ in range(len(steps) + 1)]
    times = np.concatenate(([0], np.cumsum(steps))) / 1000
    shuffled = [(time, [q[joint] for joint in order]) for time, q in zip(times, points, strict=True)]
    text = json.dumps(message(shuffled, [JOINTS[joint] for joint in order]))
    program, found = converted(text, "arm.json")
    assert [one for one in found if one.is_error] == []
    assert [one for one in checked(program)[1] if one.is_error] == []
    degrees = np.degrees(points)
    kept = [0, *(n for n in range(1, len(points)) if np.abs(degrees[n] - degrees[n - 1]).max() > 1e-6)]
    rows = numbers(program)
    if len(kept) > 1:
        assert np.abs(rows - degrees[kept]).max() <= 5.1e-7
        total = float(program.rpartition("[")[2].rstrip("]\n"))
        assert total == pytest.approx(times[kept[-1]], abs=1e-6)


def srdf(states):
    return f'<?xml version="1.0"?>\n<robot name="arm">\n<group name="arm"/>\n{states}</robot>\n'


def state(name, joints=JOINTS, value="0.5"):
    inner = "".join(f'<joint name="{joint}" value="{value}"/>' for joint in joints)
    return f'<group_state name="{name}" group="arm">{inner}</group_state>\n'


def test_named_states_are_declared():
    program = program_of(srdf(state("ready pose") + state("home", value="0")), "arm.srdf")
    lines = [line for line in program.splitlines() if line.startswith("JOINTS")]
    assert [line.split()[1] for line in lines] == ["READY_POSE", "HOME"]
    assert [float(word) for word in lines[0].split()[2:]] == pytest.approx([28.64789] * 6)


def test_states_of_other_groups_are_told():
    program, found = converted(srdf(state("home") + state("open", ["finger"])), "arm.srdf")
    assert "OPEN" not in program
    assert codes(found) == ["Y1503"]
    assert found[0].span.line == 5


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("<robot", "Y1507", "not XML"),
        ('<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot>&x;</robot>', "Y1507", "an SRDF"),
        ("<robot/>", "Y1509", "no group_state"),
        (srdf(state("a", JOINTS[:5])), "Y1511", "missing J6"),
        (srdf(state("a", EXTRA)), "Y1511", "unknown finger"),
        (srdf(state("a", value="nan")), "Y1505", "'nan'"),
        (srdf(state("a", value="")), "Y1505", "''"),
        (srdf(state("2nd")), "Y1510", "no digit first"),
        (srdf(state("move") + state("MOVEJ")), "Y1510", "word of the language"),
        (srdf(state("a") + state("A")), "Y1510", "in line 4"),
    ],
)
def test_bad_srdf(text, code, words):
    found = refused(text, "arm.srdf")
    assert found.code == code
    assert words in found.message


def test_only_states_of_others():
    program, found = converted(srdf(state("open", ["finger"])), "arm.srdf")
    assert program is None
    assert codes(found) == ["Y1503", "Y1511"]
