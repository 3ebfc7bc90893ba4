"""Tests of converting ROS trajectories and named states to programs."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes

from tests.convert.conversions import (
    commands,
    converted,
    made_of,
    numbers,
    program_of,
    refused,
    timetables,
)

JOINTS = ["J1", "J2", "J3", "J4", "J5", "J6"]
EXTRA = [*JOINTS, "finger"]


def message(points, names=JOINTS, ros=2):
    """Return a JointTrajectory as plain data; `points` are (time [s], positions [rad])."""
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
    assert commands(program) == ["MOVEJ", "MOVEJ_TIMED"]
    assert program.endswith("[4]\n")


def test_two_points_are_a_straight_motion():
    program = program_of(json.dumps(message(turned(0, 10))), "arm.json")
    assert program.splitlines()[-2:] == ["P0010 MOVEJ 0 0 0 0 0 0 [50%]", "P0020 MOVEJ 10 0 0 0 0 0 [2]"]


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
    assert commands(program) == ["MOVEJ", "MOVEJ_TIMED"]


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
    assert [line[line.index("[") :] for line in lines] == ["[50%]", "[1.5]", "[2]", "[50%]", "[2.5]"]


def test_other_names_of_the_joints():
    names = [f"shoulder_{letter}" for letter in "abcdef"]
    text = json.dumps(message(turned(0, 10), names))
    assert refused(text, "arm.json").code == "Y1511"
    assert commands(program_of(text, "arm.json", joints=tuple(names))) == ["MOVEJ", "MOVEJ"]
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
        (with_point(positions=[1, 2]), "Y1509", "point 2 has 2 positions, but there are 6 joints"),
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
        (BOMB, "Y1508", "is an alias of another part"),
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


RATE = st.tuples(*[st.floats(-2, 2)] * 6)


@settings(max_examples=50)
@given(
    steps=TIMES,
    data=st.data(),
    order=st.permutations(range(6)),
    rates=st.integers(0, 2),
    begins=st.booleans(),
    is_long=st.booleans(),
)
def test_arbitrary_trajectories_keep_their_rows_and_times(steps, data, order, rates, begins, is_long):
    times = np.cumsum([0 if begins else 7, *steps]) / 1000
    if is_long:
        times = np.concatenate((times, times[-1] + np.arange(1, 31) / 8))
    drawn = [
        [data.draw(POINT if rate == 0 else RATE) for _ in steps] + [(0,) * 6] for rate in range(1 + rates)
    ]
    values = [np.resize(some, (len(times), 6)) for some in drawn]
    values[0][-1] = 0.5
    for some in values[1:2]:
        some[-1] = 0.0
        some[0] = 0.0 if begins else some[0]
    names = [JOINTS[joint] for joint in order]
    text = message(zip(times, values[0][:, order].tolist(), strict=True), names)
    for word, some in zip(("velocities", "accelerations"), values[1:], strict=False):
        for point, row in zip(text["points"], some[:, order].tolist(), strict=True):
            point[word] = row
    made, found = made_of(json.dumps(text), "arm.json", beside="arm")
    assert [one for one in found if one.is_error] == []
    tables = timetables(made)
    if not tables:  # a motion with one segment, or none
        assert begins
        assert commands(made.text)[-1] in {"MOVEJ", "WAIT"}
        assert made.text.endswith(f"[{times[-1]:.6f}".rstrip("0").rstrip(".") + "]\n")
        return
    ((at, *rows),) = tables
    is_file = bool(made.files)
    assert is_file == (len(times) - begins > 20 or bool(begins and rates == 2 and values[2][0].any()))
    first = int(begins and not is_file)
    assert at == pytest.approx(times[first:], abs=1e-12)
    for order_, (asked, kept) in enumerate(zip((*values, None, None), rows, strict=False)):
        if asked is None:
            assert kept is None
            continue
        assert np.abs(kept - asked[first:]).max() <= (1e-15 if is_file else 1e-8) * (
            1 + np.abs(asked).max()
        ), order_


def in_motion(**points):
    """Return a trajectory of three points with velocities, some of which `points` replaces."""
    data = message(turned(0, 10, 20))
    for number, point in enumerate(data["points"]):
        point["velocities"] = [0.1 * (number == 1), 0, 0, 0, 0, 0]
    for number, velocity in points.items():
        data["points"][int(number[1:])]["velocities"][0] = velocity
    return data


def test_velocities_are_kept():
    program = program_of(json.dumps(in_motion()), "arm.json")
    assert program.splitlines()[-2:] == [
        "P0020 MOVEJ_TIMED 10 0 0 0 0 0 [2] VEL 5.729578 0 0 0 0 0;",
        "                  20 0 0 0 0 0 [4] VEL 0.000000 0 0 0 0 0",
    ]
    assert "cubic polynomial" in program


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ({"p0": 0.5}, "it begins in motion: J1 moves at 28.6479 deg/s at 0 s"),
        ({"p2": -0.5}, "it ends in motion: J1 moves at -28.6479 deg/s at 4 s"),
    ],
)
def test_motion_at_an_end(points, words):
    found = refused(json.dumps(in_motion(**points)), "arm.json")
    assert (found.code, found.message) == ("Y1513", words)
    assert commands(program_of(json.dumps(in_motion(**points)), "arm.json", form="spline")) == [
        "MOVEJ_SPLINE"
    ]


def test_noise_at_rest_is_said():
    program = program_of(json.dumps(in_motion(p0=1e-6, p2=2e-6)), "arm.json")
    assert "Velocities up to 0.00011 deg per s at rest are taken as 0." in program
    ((_, _, velocities, _),) = timetables(made_of(json.dumps(in_motion(p0=1e-6, p2=2e-6)), "arm.json")[0])
    assert not velocities[-1].any()


def test_velocities_of_some_points_are_left_out():
    data = in_motion()
    data["points"][1]["velocities"] = []
    program = program_of(json.dumps(data), "arm.json")
    assert "Velocities of only 2 of 3 points are given, and left out." in program
    assert "VEL" not in program


@pytest.mark.parametrize(
    ("velocities", "code", "words"),
    [
        ([0.0] * 5, "Y1509", "point 2 has 5 velocities, but there are 6 joints"),
        ([0, 0, float("nan"), 0, 0, 0], "Y1505", "point 2: the velocity of J3 is 'nan'"),
    ],
)
def test_bad_velocities(velocities, code, words):
    data = in_motion()
    data["points"][1]["velocities"] = velocities
    found = refused(json.dumps(data), "arm.json")
    assert (found.code, words in found.message) == (code, True)


def test_an_acceleration_at_the_start_needs_a_file():
    data = in_motion()
    for point in data["points"]:
        point["accelerations"] = [0.2, 0, 0, 0, 0, 0]
    made, _ = made_of(json.dumps(data), "arm.json", beside="arm")
    assert commands(made.text) == ["MOVEJ", "MOVEJ_TIMED"]
    assert made.text.endswith('MOVEJ_TIMED "arm_path.csv"\n')
    ((times, _, _, accelerations),) = timetables(made)
    assert (times.tolist(), accelerations[:, 0].tolist()) == ([0, 2, 4], [0.2] * 3)
    program = program_of(json.dumps(data), "arm.json")  # as if no file could be written beside the program
    assert "accelerations aren't 0 at the start, and are left out: the path differs by up to" in program
    assert "ACC" not in program


def test_several_long_trajectories_have_a_file_each():
    points = [(0.1 * n, [0.01 * n, 0, 0, 0, 0, 0]) for n in range(40)]
    back = [(0.1 * n, [0.39 - 0.01 * n, 0, 0, 0, 0, 0]) for n in range(40)]
    text = json.dumps(message(points)) + "---" + json.dumps(message(back))
    made, found = made_of(text, "arm.json", beside="arm")
    assert codes(found) == []
    assert commands(made.text) == ["MOVEJ", "MOVEJ_TIMED", "MOVEJ_TIMED"]
    assert [name for name, _ in made.files] == ["arm_path1.csv", "arm_path2.csv"]
    assert [len(times) for times, *_ in timetables(made)] == [40, 40]


def test_a_trajectory_begins_where_the_robot_stands():
    points = [(0.5, [0.1, 0, 0, 0, 0, 0]), (1.5, [0.2, 0, 0, 0, 0, 0])]
    assert commands(program_of(json.dumps(message(points)), "arm.json")) == ["MOVEJ_TIMED"]


def test_standing_still_is_waiting():
    program = program_of(json.dumps(message(turned(5, 5, 5))), "arm.json")
    assert program.splitlines()[-2:] == ["P0010 MOVEJ 5 0 0 0 0 0 [50%]", "P0020 WAIT [4]"]


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
        (srdf(state("2nd")), "Y1510", "doesn't begin with a digit"),
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
