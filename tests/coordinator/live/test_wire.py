"""Tests of the lines by which another process steers the robot: each is read, or denied with a reason. No
line raises an exception.
"""

import json

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.coordinator.live.serving import MOST_LINE, token_in
from yarclang.coordinator.live.steered import Reader
from yarclang.coordinator.live.steering import JointVelocity, Master, Twist
from yarclang.coordinator.messages.lines import read_order
from yarclang.coordinator.messages.replies import Denied
from yarclang.coordinator.messages.wants import Finish, Want
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.runtime.actions import Trouble
from yarclang.transforms import roll_pitch_yaw

ROBOT = load_robot("INDUSTRIAL6").value
TOOL = ROBOT.flange_from_frame["TCP"]
START = np.array([0.0, 10.0, 10.0, 0.0, 40.0, 0.0])


def reader():
    return Reader(ROBOT, TOOL, START * ROBOT.axis_units)


def read(content, now=0.0, at=None):
    return read_line(json.dumps(content).encode(), now, at)


def read_line(line, now=0.0, at=None):
    """Return the meaning of a line: a target, Finish, or Denied."""
    want = read_order(line, MOST_LINE).what
    if not isinstance(want, Want) or isinstance(want, Finish):
        return want
    try:
        return (at or reader()).read(want, now)
    except Trouble as trouble:
        return Denied(error=trouble.what)


def test_each_kind_is_read():
    units = ROBOT.axis_units
    found = read({"joints": [1, 2, 3, 4, 5, 6], "rate": [1, 0, 0, 0, 0, 0]})
    assert isinstance(found, Master)
    assert found.q / units == pytest.approx([1, 2, 3, 4, 5, 6])
    assert found.rate[0] / units[0] == pytest.approx(1.0)
    found = read({"velocity": {"j3": -5}})
    assert isinstance(found, JointVelocity)
    assert found.velocity / units == pytest.approx([0, 0, -5, 0, 0, 0])
    found = read({"twist": [0, 0, 50, 0, 0, 10], "axes": "tool"})
    assert isinstance(found, Twist)
    assert (found.linear[2], found.angular[2], found.axes) == pytest.approx((0.05, np.deg2rad(10), "tool"))
    assert isinstance(read({"finish": True}), Finish)


def test_a_pose_is_the_joints_next_to_the_last():
    there = np.add(START, [1, -1, 1, 2, -2, 1])
    pose = tool_poses(ROBOT.chain, (there * ROBOT.axis_units)[None], TOOL)[0]
    values = [*(pose[:3, 3] * 1e3), *np.rad2deg(roll_pitch_yaw(pose[:3, :3]))]
    found = read({"pose": [float(value) for value in values]})
    assert isinstance(found, Master)
    assert found.q / ROBOT.axis_units == pytest.approx(there, abs=1e-6)


def test_a_velocity_is_estimated_of_what_a_master_has_said():
    at, rate = reader(), 10.0
    for number in range(40):
        now = 0.02 * number
        found = read({"joints": [rate * now, 10, 10, 0, 40, 0]}, now, at)
    assert found.rate[0] / ROBOT.axis_units[0] == pytest.approx(rate, rel=1e-3)
    found = read({"joints": [rate * now, 10, 10, 0, 40, 0]}, now + 5.0, at)
    assert not found.rate.any()


@pytest.mark.parametrize(
    ("content", "why"),
    [
        ({"joints": [1, 2, 3]}, "6 finite numbers"),
        ({"joints": [1, 2, 3, 4, 5, "6"]}, "finite numbers, one per joint"),
        ({"joints": [1, 2, 3, 4, 5, True]}, "finite numbers, one per joint"),
        ({"joints": [500, 2, 3, 4, 5, 6]}, "J1 would exceed its limits"),
        ({"joints": [1, 2, 3, 4, 5, 6], "rate": 3}, "finite numbers, one per joint"),
        ({"joints": [1, 2, 3, 4, 5, 6], "speed": 3}, 'joints has no field "speed"'),
        ({"pose": [9000, 0, 0, 0, 0, 0]}, "out of reach by"),
        ({"pose": [0, 900, 1400, 180, 0, 0]}, "too far from the one before"),
        ({"pose": [0, 900, 1400]}, "six finite numbers"),
        ({"velocity": {"J9": 1}}, "'J9' isn't a joint"),
        ({"velocity": {}}, "velocity is an object"),
        ({"velocity": {"J1": 1, "j1": -5}}, "a joint is named twice"),
        ({"velocity": {"J1": 1e308}}, "finite numbers"),
        ({"pose": [1e300, 0, 0, 0, 0, 0]}, "six finite numbers"),
        ({"twist": [0, 0, 1, 0, 0, 0], "axes": "world"}, '"base" or "tool"'),
        ({"finish": False}, "finish is true"),
        ({}, "joints, pose"),
        ({"joints": [], "pose": []}, "not 2"),
    ],
)
def test_what_is_wrong_is_denied(content, why):
    found = read(content)
    assert isinstance(found, Denied)
    assert why in found.error
    assert not read_order(json.dumps(content).encode()).ends


NO_OBJECTS = [
    (b"[1]\n", "isn't a JSON object"),
    (b"3\n", "isn't a JSON object"),
    (b"null\n", "isn't a JSON object"),
    (b"\n", "isn't JSON"),
    (b'{"velocity": {"J1": 10}\n', "isn't JSON"),
    (b"{'velocity': 1}\n", "isn't JSON"),
    (b"\x16\x03\x01\x02\x00\x01\n", "isn't JSON"),
    (b"\xff\xfe\x00\n", "isn't JSON"),
    (b"[" * 9000 + b"\n", "isn't JSON"),
    (b"1" * 9000 + b"\n", "isn't JSON"),
    (b"x" * (MOST_LINE + 1), "longer than 16 KiB"),
    (b"POST /steer HTTP/1.1\r\n", "a web page can't steer a robot"),
    (b"GET http://127.0.0.1:5050/ HTTP/1.0\r\n", "a web page can't steer a robot"),
    (b"OPTIONS * HTTP/1.1\n", "a web page can't steer a robot"),
    (b"PRI * HTTP/2.0\r\n", "a web page can't steer a robot"),
]


@pytest.mark.parametrize(("line", "why"), NO_OBJECTS)
def test_what_is_no_object_ends_the_connection(line, why):
    assert read_order(line, MOST_LINE).ends
    for found in (read_order(line, MOST_LINE).what, token_in(line)):
        assert isinstance(found, Denied)
        assert why in found.error


def test_a_token_is_read():
    assert token_in(b'{"token": "abc"}\n') == "abc"
    assert token_in(b'{"token": "\\ud800"}\n') == "\ud800"
    for content in (
        {},
        {"token": 3},
        {"token": None},
        {"token": "a", "velocity": {"J1": 1}},
        {"velocity": {"J1": 1}},
    ):
        found = token_in(json.dumps(content).encode())
        assert isinstance(found, Denied)
        assert 'the first line must be {"token": "..."}' in found.error


SIX = st.lists(st.floats(-30.0, 30.0), min_size=6, max_size=6) | st.lists(
    st.floats() | st.integers(), min_size=6, max_size=6
)
NEAR = st.one_of(
    st.fixed_dictionaries({"joints": SIX}, optional={"rate": SIX}),
    st.fixed_dictionaries({"pose": SIX}),
    st.fixed_dictionaries(
        {"velocity": st.dictionaries(st.sampled_from(["J1", "j3", "J6"]), st.floats(-30.0, 30.0))}
    ),
    st.fixed_dictionaries({"velocity": st.dictionaries(st.sampled_from(["J1", "J7"]), st.floats())}),
    st.fixed_dictionaries({"twist": SIX}, optional={"axes": st.sampled_from(["base", "tool", "world"])}),
    st.fixed_dictionaries({"finish": st.booleans()}),
)
"""Messages of a master, with numbers of any size."""


@exercises(master=0.01, velocity=0.01, twist=0.01, finish=0.0, denied=0.2)
@pytest.mark.filterwarnings("error::RuntimeWarning")
@settings(max_examples=400, deadline=None)
@given(
    st.one_of(
        NEAR.map(lambda one: json.dumps(one).encode()),
        NEAR.map(lambda one: json.dumps(one).encode()),
        st.binary(max_size=60),
        st.recursive(
            st.none() | st.booleans() | st.floats() | st.text(max_size=5),
            lambda inner: (
                st.lists(inner, max_size=7)
                | st.dictionaries(
                    st.sampled_from(["joints", "pose", "velocity", "twist", "finish", "axes", "rate", "J1"]),
                    inner,
                    max_size=3,
                )
            ),
            max_leaves=12,
        ).map(lambda one: json.dumps(one).encode()),
    )
)
def test_nothing_is_raised(tally, line):
    assert isinstance(token_in(line), str | Denied)
    found = read_line(line)
    kinds = {"master": Master, "velocity": JointVelocity, "twist": Twist, "finish": Finish, "denied": Denied}
    for name, kind in kinds.items():
        tally.count(name, isinstance(found, kind))
    match found:
        case Master():
            assert np.isfinite(found.q).all()
            assert np.isfinite(found.rate).all()
        case JointVelocity():
            assert np.isfinite(found.velocity).all()
        case Twist():
            assert np.isfinite([found.linear, found.angular]).all()
        case _:
            assert isinstance(found, Denied | Finish)
