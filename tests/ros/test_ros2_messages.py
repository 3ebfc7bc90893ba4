"""ROS 2 messages to and from the driver's values, with namespaces instead of rosidl's classes.

Also the node on a computer without ROS 2.
"""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from yarclang.ros.node import ros2, ros2_messages
from yarclang.ros.node.action import Feedback
from yarclang.ros.node.driver import JointState, Status
from yarclang.ros.node.trajectory import Goal, Moment, Point, Result, Tolerance

NOW = SimpleNamespace(sec=100, nanosec=900_000_000)
STATUS = Status(2, -1, 1, 1, 0, 0, 0, "")


def time(seconds: int = 0, nanoseconds: int = 0) -> SimpleNamespace:
    return SimpleNamespace(sec=seconds, nanosec=nanoseconds)


def empty(kind: str) -> Any:
    """Return a stand-in for a message's class, whose constructor accepts only the message's fields."""

    def point() -> SimpleNamespace:
        return SimpleNamespace(
            positions=[], velocities=[], accelerations=[], effort=[], time_from_start=time()
        )

    def header() -> SimpleNamespace:
        return SimpleNamespace(stamp=time(), frame_id="")

    fields: dict[str, Any] = {
        "result": {"error_code": 0, "error_string": ""},
        "feedback": {
            "joint_names": [],
            "header": header(),
            "desired": point(),
            "actual": point(),
            "error": point(),
        },
        "joint state": {"header": header(), "name": [], "position": [], "velocity": [], "effort": []},
        "array": {"header": header(), "status": []},
        "entry": {"level": b"\x00", "name": "", "message": "", "hardware_id": "", "values": []},
        "pair": {"key": "", "value": ""},
    }[kind]

    def made(**given: Any) -> SimpleNamespace:
        assert set(given) <= set(fields)
        return SimpleNamespace(**{**fields, **given})

    return made


def goal(**changed: Any) -> SimpleNamespace:
    points = [
        SimpleNamespace(
            positions=[0.0, 0.1], velocities=[], accelerations=[], effort=[], time_from_start=time()
        ),
        SimpleNamespace(
            positions=[0.5, 0.2],
            velocities=[0.0, 0.0],
            accelerations=[1.0, 2.0],
            effort=[],
            time_from_start=time(1, 500_000_000),
        ),
    ]
    header = SimpleNamespace(stamp=changed.pop("stamp", time()), frame_id="")
    return SimpleNamespace(
        trajectory=SimpleNamespace(header=header, joint_names=["J2", "J1"], points=points),
        path_tolerance=[SimpleNamespace(name="J1", position=0.01, velocity=-1.0, acceleration=0.0)],
        goal_tolerance=[],
        goal_time_tolerance=time(0, 250_000_000),
        **changed,
    )


def test_a_goal_is_read_as_it_is() -> None:
    points = (Point((0.0, 0.1), 0.0), Point((0.5, 0.2), 1.5, (0.0, 0.0), (1.0, 2.0)))
    tolerances = (Tolerance("J1", 0.01, -1.0, 0.0),)
    assert ros2_messages.goal_of(goal(), NOW) == Goal(("J2", "J1"), points, 0.0, tolerances, (), 0.25)


@pytest.mark.parametrize(
    ("stamp", "starts_in"), [(time(), 0.0), (time(102, 400_000_000), 1.5), (time(99, 0), -1.9)]
)
def test_a_stamp_is_a_time_from_now_and_none_is_at_once(stamp: SimpleNamespace, starts_in: float) -> None:
    assert ros2_messages.goal_of(goal(stamp=stamp), NOW).starts_in == pytest.approx(starts_in, abs=1e-12)


def test_fields_that_only_some_distributions_have_are_read_if_they_are_there() -> None:
    assert ros2_messages.multi_dof_joints(goal()) == ()
    assert ros2_messages.multi_dof_joints(goal(multi_dof_trajectory=SimpleNamespace(joint_names=[]))) == ()
    floating = goal(multi_dof_trajectory=SimpleNamespace(joint_names=["base"]), component_path_tolerance=[])
    assert ros2_messages.multi_dof_joints(floating) == ("base",)
    assert ros2_messages.goal_of(floating, NOW) == ros2_messages.goal_of(goal(), NOW)


@pytest.mark.parametrize(
    ("seconds", "said"),
    [
        (0.0, (0, 0)),
        (1.25, (1, 250_000_000)),
        (0.9999999999, (1, 0)),
        (-0.5, (-1, 500_000_000)),
        (1e300, (2**31 - 1, 0)),
        (-math.inf, (1 - 2**31, 0)),
        (math.nan, (0, 0)),
    ],
)
def test_any_time_becomes_a_duration_that_can_be_said(seconds: float, said: tuple[int, int]) -> None:
    message = time()
    ros2_messages.fill_duration(message, seconds)
    assert (message.sec, message.nanosec) == said
    assert -(2**31) <= message.sec < 2**31
    assert 0 <= message.nanosec < 10**9


@pytest.mark.parametrize("seconds", [0.0, 1e-9, 0.02, 59.999999999, -3.25, 86400.5])
def test_a_duration_comes_back_as_it_was(seconds: float) -> None:
    message = time()
    ros2_messages.fill_duration(message, seconds)
    assert ros2_messages.seconds_of(message) == pytest.approx(seconds, abs=1e-9)


def test_feedback_has_names_stamp_and_three_points() -> None:
    desired = Moment((0.5, 0.25), (1.0, 2.0), (3.0, 4.0), 1.5)
    actual = Moment((0.25, 0.25), (0.5, 2.0), (), 1.5)
    error = Moment((0.25, 0.0), (0.5, 0.0), (), 1.5)
    message = ros2_messages.feedback_message(
        empty("feedback"), Feedback(("J1", "J2"), desired, actual, error), NOW
    )
    assert (message.joint_names, message.header.stamp) == (["J1", "J2"], NOW)
    for point, moment in ((message.desired, desired), (message.actual, actual), (message.error, error)):
        assert tuple(point.positions) == moment.positions
        assert tuple(point.velocities) == moment.velocities
        assert tuple(point.accelerations) == moment.accelerations
        assert (point.time_from_start.sec, point.time_from_start.nanosec) == (1, 500_000_000)


def test_results_and_joint_states_keep_their_values() -> None:
    result = ros2_messages.result_message(empty("result"), Result(-4, "J1 is off its path"))
    assert (result.error_code, result.error_string) == (-4, "J1 is off its path")
    state = JointState(("J1", "J2"), (0.1, 0.2), (0.3, 0.4))
    message = ros2_messages.joint_state_message(empty("joint state"), state, NOW)
    assert (message.name, message.position, message.velocity) == (["J1", "J2"], [0.1, 0.2], [0.3, 0.4])
    assert (message.effort, message.header.stamp) == ([], NOW)


@pytest.mark.parametrize(
    ("status", "level", "said"),
    [
        (STATUS, ros2_messages.OK, "ready"),
        (Status(2, -1, 1, 0, 1, 0, 0, "a goal moves it"), ros2_messages.OK, "a goal moves it"),
        (Status(1, -1, 1, 0, 0, 0, 1611, "owned by yarc run"), ros2_messages.WARN, "owned by yarc run"),
        (Status(-1, -1, -1, 0, -1, 1, 0, "nobody serves it"), ros2_messages.ERROR, "nobody serves it"),
    ],
)
def test_diagnostics_have_the_status_as_level_reason_and_values(
    status: Status, level: bytes, said: str
) -> None:
    kinds = empty("array"), empty("entry"), empty("pair")
    message = ros2_messages.diagnostics_message(*kinds, "industrial6", status, NOW)
    (entry,) = message.status
    assert message.header.stamp == NOW
    assert (entry.level, entry.message) == (level, said)
    assert (entry.name, entry.hardware_id) == ("yarc: industrial6", "industrial6")
    values = {one.key: one.value for one in entry.values}
    names = ("mode", "e_stopped", "drives_powered", "motion_possible", "in_motion", "in_error", "error_code")
    assert tuple(values) == names
    assert values["error_code"] == str(status.error_code)
    assert values["e_stopped"] == "unknown"
    assert values["mode"] == {2: "automatic", 1: "manual", -1: "unknown"}[status.mode]


def test_what_is_missing_is_named_with_what_to_do() -> None:
    without = ros2.what_is_missing(ImportError("No module named 'rclpy'", name="rclpy"), None)
    assert "rclpy can't be imported" in without
    assert "source /opt/ros/" in without
    inside = ros2.what_is_missing(ImportError("no", name="control_msgs.action"), "jazzy")
    assert "apt install ros-jazzy-control-msgs" in inside
    assert inside.count("\n") == 1
