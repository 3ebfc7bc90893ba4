"""The ROS 1 node as people run it.

There are a master, `yarc serve` with a simulated robot, the node, and a client of actionlib.
"""

import itertools
import math
import signal
import subprocess
import time

import pytest
from ros.ros1.conftest import PYTHON, ROOT, ended

JOINTS = ["J1", "J2", "J3", "J4", "J5", "J6"]
AWAY = [0.4, -0.3, 0.3, 0.2, 0.4, 0.3]
PREEMPTED, SUCCEEDED, ABORTED, REJECTED = 2, 3, 4, 5
SUMS = {
    "control_msgs/FollowJointTrajectoryAction": "bc4f9b743838566551c0390c65f1a248",
    "control_msgs/FollowJointTrajectoryFeedback": "10817c60c2486ef6b33e97dcd87f4474",
    "control_msgs/FollowJointTrajectoryResult": "493383b18409bfb604b4e26c676401d2",
    "control_msgs/JointTolerance": "f544fe9c16cf04547e135dd6063ff5be",
    "industrial_msgs/RobotStatus": "b733cb45a38101840b75c4c0d6093d19",
    "industrial_msgs/DeviceInfo": "373ed7fa0fac92d443be9cd5198e80f0",
    "industrial_msgs/StopMotion": "50b1f38f75f5677e5692f3b3e7e1ea48",
    "industrial_msgs/CmdJointTrajectory": "94fdf82abbbb1071bc31be1a2aea4fcd",
    "industrial_msgs/GetRobotInfo": "5db3230b3e61c85a320b999ffd7f3b3f",
}
"""Checksums of messages in ROS's packages control_msgs 1.5.2 and industrial_msgs 0.7.3."""


def standing(ros):
    """Return the joint positions from the second message from now, which is certainly new."""
    return ros.heard(topic="joint_states", count=2)[-1][1]["position"]


def way(start, end, seconds, count=21, velocities=True):
    """Return the points of a straight joint motion from rest to rest, with a cosine in time."""
    points = []
    for at in range(count):
        share = at / (count - 1)
        rate = math.pi / seconds * math.sin(math.pi * share) / 2.0
        point = {"time": seconds * share}
        point["positions"] = [
            a + (b - a) * (1.0 - math.cos(math.pi * share)) / 2.0 for a, b in zip(start, end, strict=True)
        ]
        if velocities:
            point["velocities"] = [(b - a) * rate for a, b in zip(start, end, strict=True)]
        points.append(point)
    return points


def there_and_back(ros, seconds=3.0):
    """Return the robot's position, an end away from it, and the points of a motion between them."""
    start = standing(ros)
    end = AWAY if max(abs(a - b) for a, b in zip(start, AWAY, strict=True)) > 0.1 else [0.0] * 6
    return start, end, way(start, end, seconds)


def shares(start, end, found):
    """Return for each joint its share of the straight line from start to end."""
    return [(q - a) / (b - a) for a, b, q in zip(start, end, found, strict=True)]


def assert_rests_on_path(ros, start, end):
    """Check that the robot rests between start and end, on the straight line.

    After a stop off the path, the joints would be at different shares.
    """
    ros.until(topic="robot_status", field="in_motion.val", value=0)
    found = shares(start, end, standing(ros))
    assert min(found) > 0.005
    assert max(found) < 0.995
    assert max(found) - min(found) < 2e-3
    again = shares(start, end, standing(ros))
    assert max(abs(a - b) for a, b in zip(found, again, strict=True)) < 1e-4


def test_the_types_are_those_of_the_packages(ros):
    assert ros.sums() == SUMS
    types = ros.types()
    assert types["/joint_trajectory_action/goal"] == "control_msgs/FollowJointTrajectoryActionGoal"
    assert types["/feedback_states"] == "control_msgs/FollowJointTrajectoryFeedback"
    assert types["/robot_status"] == "industrial_msgs/RobotStatus"


def test_a_goal_moves_the_robot(ros):
    start, end, points = there_and_back(ros, 4.0)
    ros.send(name="a", names=JOINTS, points=points)
    outcome = ros.outcome(name="a")
    assert (outcome["status"], outcome["result"]) == (SUCCEEDED, {"error_code": 0, "error_string": ""})
    assert standing(ros) == pytest.approx(end, abs=1e-3)
    fed = outcome["feedback"]
    assert len(fed) > 10
    assert all(one["joint_names"] == JOINTS for one in fed)
    times = [one["desired"]["time_from_start"] for one in fed]
    assert all(a <= b for a, b in itertools.pairwise(times))
    assert times[-1] - times[0] > 2.0
    for one in fed:
        wanted, found, off = (one[part]["positions"] for part in ("desired", "actual", "error"))
        assert off == pytest.approx([a - b for a, b in zip(wanted, found, strict=True)], abs=1e-9)
        assert max(map(abs, off)) < 0.02
        share = (1.0 - math.cos(math.pi * min(1.0, one["desired"]["time_from_start"] / 4.0))) / 2.0
        assert shares(start, end, wanted) == pytest.approx([share] * 6, abs=0.02)


def test_joints_may_come_in_another_order(ros):
    _, end, points = there_and_back(ros)
    for one in points:
        one["positions"].reverse()
        one["velocities"].reverse()
    ros.send(name="reversed", names=JOINTS[::-1], points=points)
    outcome = ros.outcome(name="reversed")
    assert outcome["status"] == SUCCEEDED
    assert outcome["feedback"][-1]["joint_names"] == JOINTS[::-1]
    assert standing(ros) == pytest.approx(end, abs=1e-3)


def test_a_cancelled_goal_rests_on_its_path(ros):
    start, end, points = there_and_back(ros)
    ros.send(name="cancelled", names=JOINTS, points=points)
    ros.fed(name="cancelled", count=8)
    ros.cancel(name="cancelled")
    outcome = ros.outcome(name="cancelled")
    assert outcome["status"] == PREEMPTED
    assert outcome["result"]["error_code"] == 0
    assert_rests_on_path(ros, start, end)


def test_a_new_goal_preempts_one_that_moves(ros):
    start, _, points = there_and_back(ros)
    ros.send(name="first", names=JOINTS, points=points)
    ros.fed(name="first", count=8)
    ros.send(name="second", names=JOINTS, points=[{"positions": start, "time": 4.0}])
    assert ros.outcome(name="first")["status"] == PREEMPTED
    assert ros.outcome(name="second")["status"] == SUCCEEDED
    assert standing(ros) == pytest.approx(start, abs=1e-3)


@pytest.mark.parametrize(
    ("names", "said"),
    [(JOINTS[:5], "J6 missing"), ([*JOINTS[:5], "J7"], "J7 unknown"), ([*JOINTS, "J1"], "J1 doubled")],
)
def test_wrong_names_are_rejected(ros, names, said):
    name = said
    ros.send(name=name, names=names, points=[{"positions": [0.0] * len(names), "time": 1.0}])
    outcome = ros.outcome(name=name)
    assert (outcome["status"], outcome["result"]["error_code"]) == (REJECTED, -2)
    assert said in outcome["result"]["error_string"]


def test_a_goal_with_very_many_names_is_rejected_at_once(ros):
    names = [f"J{at}" for at in range(1, 20_001)]
    began = time.monotonic()
    ros.send(name="names", names=names, points=[{"positions": [0.0] * 20_000, "time": 1.0}])
    outcome = ros.outcome(name="names")
    assert (outcome["status"], outcome["result"]["error_code"]) == (REJECTED, -2)
    assert len(outcome["text"]) < 500
    assert time.monotonic() - began < 5.0


@pytest.mark.parametrize(
    ("points", "stamp", "code"),
    [
        ([], None, -1),
        ([{"positions": [math.nan] * 6, "time": 1.0}], None, -1),
        ([{"positions": [0.0] * 6, "time": 1.0}, {"positions": [0.1] * 6, "time": 1.0}], None, -1),
        ([{"positions": [0.0] * 5, "time": 1.0}], None, -1),
        ([{"positions": [0.0] * 6, "time": 1.0}], -5.0, -3),
    ],
)
def test_goals_that_cannot_be_meant_are_rejected_with_the_reason(ros, points, stamp, code):
    name = f"wrong {points} {stamp}"
    ros.send(name=name, names=JOINTS, points=points, stamp=stamp)
    outcome = ros.outcome(name=name)
    assert (outcome["status"], outcome["result"]["error_code"]) == (REJECTED, code)
    assert outcome["text"] == outcome["result"]["error_string"] != ""


def test_a_goal_that_cannot_be_proved_is_aborted_with_the_finding(ros):
    start = standing(ros)
    ros.send(name="far", names=JOINTS, points=[{"positions": [3.1, 0, 0, 0, 0, 0], "time": 20.0}])
    outcome = ros.outcome(name="far")
    assert (outcome["status"], outcome["result"]["error_code"]) == (ABORTED, -1)
    assert "Y0502" in outcome["result"]["error_string"]
    assert "J1" in outcome["result"]["error_string"]
    assert outcome["feedback"] == []
    assert standing(ros) == pytest.approx(start, abs=1e-6)
    assert ros.until(topic="robot_status", field="error_code", value=502)["in_error"]["val"] == 1


def test_joint_states_come_50_times_a_second_with_velocities(ros):
    _, _, points = there_and_back(ros)
    ros.send(name="watched", names=JOINTS, points=points)
    ros.fed(name="watched", count=5)
    heard = [message for _, message in ros.heard(topic="joint_states", count=25)]
    assert all(one["name"] == JOINTS for one in heard)
    stamps = [one["header"]["stamp"] for one in heard]
    assert all(a < b for a, b in itertools.pairwise(stamps))
    assert 0.25 < stamps[-1] - stamps[0] < 2.0
    assert max(abs(one["velocity"][0]) for one in heard) > 0.02
    assert ros.outcome(name="watched")["status"] == SUCCEEDED


def test_feedback_states_go_on_between_goals(ros):
    heard = [message for _, message in ros.heard(topic="feedback_states", count=5)]
    assert all(one["joint_names"] == JOINTS for one in heard)
    assert heard[-1]["actual"]["positions"] == pytest.approx(standing(ros), abs=1e-4)
    assert heard[-1]["desired"]["positions"] == []


def test_robot_status(ros):
    still = ros.until(topic="robot_status", field="in_motion.val", value=0)
    assert still["e_stopped"]["val"] == -1
    assert (still["mode"]["val"], still["drives_powered"]["val"], still["motion_possible"]["val"]) == (
        2,
        1,
        1,
    )
    _, _, points = there_and_back(ros)
    ros.send(name="status", names=JOINTS, points=points)
    moving = ros.until(topic="robot_status", field="in_motion.val", value=1)
    assert (moving["in_error"]["val"], moving["error_code"]) == (0, 0)
    assert ros.outcome(name="status")["status"] == SUCCEEDED
    ros.until(topic="robot_status", field="in_motion.val", value=0)


def test_joint_path_command(ros):
    _, end, points = there_and_back(ros)
    ros.publish(topic="joint_path_command", names=JOINTS, points=points)
    ros.until(topic="robot_status", field="in_motion.val", value=1)
    ros.until(topic="robot_status", field="in_motion.val", value=0)
    assert standing(ros) == pytest.approx(end, abs=1e-3)


def test_a_path_without_points_is_a_stop(ros):
    start, end, points = there_and_back(ros)
    ros.send(name="path stopped", names=JOINTS, points=points)
    ros.fed(name="path stopped", count=8)
    ros.publish(topic="joint_path_command", names=[], points=[])
    assert ros.outcome(name="path stopped")["status"] == PREEMPTED
    assert_rests_on_path(ros, start, end)


def test_a_refused_path_is_told_by_robot_status_until_the_next_goal(ros, stage):
    ros.publish(topic="joint_path_command", names=JOINTS[:2], points=[{"positions": [0.0] * 2, "time": 1.0}])
    assert ros.until(topic="robot_status", field="error_code", value=-2)["in_error"]["val"] == 1
    assert stage.node.until("joint_path_command was refused: joint names")
    _, _, points = there_and_back(ros)
    assert ros.call(service="joint_path_command", names=JOINTS, points=points)["code"]["val"] == 1
    ros.until(topic="robot_status", field="error_code", value=0)
    ros.until(topic="robot_status", field="in_motion.val", value=1)
    ros.until(topic="robot_status", field="in_motion.val", value=0)
    assert ros.call(service="joint_path_command", names=JOINTS, points=[])["code"]["val"] == -1


def test_hold_and_resume_keep_the_goal(ros):
    start, end, points = there_and_back(ros)
    ros.send(name="held", names=JOINTS, points=points)
    ros.fed(name="held", count=8)
    assert ros.call(service="yarc_driver/hold")["success"]
    time.sleep(0.5)
    found = standing(ros)
    time.sleep(0.3)
    assert standing(ros) == pytest.approx(found, abs=1e-4)
    assert max(shares(start, end, found)) < 0.99
    assert ros.call(service="yarc_driver/resume")["success"]
    assert ros.outcome(name="held")["status"] == SUCCEEDED
    assert standing(ros) == pytest.approx(end, abs=1e-3)


@pytest.mark.parametrize("service", ["yarc_driver/stop", "stop_motion"])
def test_a_stop_ends_the_goal_on_its_path(ros, service):
    start, end, points = there_and_back(ros)
    ros.send(name=service, names=JOINTS, points=points)
    ros.fed(name=service, count=8)
    answer = ros.call(service=service)
    assert answer.get("success", True)
    assert answer.get("code", {"val": 1})["val"] == 1
    outcome = ros.outcome(name=service)
    assert outcome["status"] == ABORTED
    assert outcome["result"]["error_string"]
    assert_rests_on_path(ros, start, end)


def test_the_robot_is_described(ros):
    assert ros.call(service="get_robot_info")["robots"][0]["model"].upper() == "INDUSTRIAL6"
    assert ros.param(name="controller_joint_names") == JOINTS
    urdf = ros.param(name="robot_description")
    assert all(f'name="{joint}"' in urdf for joint in JOINTS)


def test_rviz_is_told_the_scene_and_the_plan_under_way(ros):
    assert ros.last(topic="yarc_driver/scene")["markers"][0]["action"] == 3
    _, _, points = there_and_back(ros)
    ros.send(name="drawn", names=JOINTS, points=points)
    ros.fed(name="drawn", count=5)
    ghost = ros.drawn(topic="yarc_driver/ghost")
    line = next(one for one in ghost if one["type"] == 4)
    assert line["header"]["frame_id"] == "base_link"
    assert len(line["points"]) > 20
    assert ros.outcome(name="drawn")["status"] == SUCCEEDED
    assert ros.drawn(topic="yarc_driver/ghost", there=False) == []


def test_the_override_slows_down(ros, stage):
    _, _, points = there_and_back(ros)
    ros.publish(topic="yarc_driver/override", data=500.0)
    stage.node.until("override 500 %")
    ros.publish(topic="yarc_driver/override", data=20.0)
    ros.send(name="slow", names=JOINTS, points=points)
    first = ros.fed(name="slow", count=10)
    second = ros.fed(name="slow", count=40)
    gone = second["desired"]["time_from_start"] - first["desired"]["time_from_start"]
    passed = second["header"]["stamp"] - first["header"]["stamp"]
    assert gone < 0.4 * 4.0 * passed
    ros.publish(topic="yarc_driver/override", data=100.0)
    assert ros.outcome(name="slow")["status"] == SUCCEEDED


def test_a_master_that_hangs_holds_nothing_up(ros, stage):
    _, end, points = there_and_back(ros)
    stage.master.send_signal(signal.SIGSTOP)
    try:
        time.sleep(1.5)  # during this time, the node sends requests to the stopped master
        ros.send(name="hung", names=JOINTS, points=points)
        assert ros.outcome(name="hung")["status"] == SUCCEEDED
        assert standing(ros) == pytest.approx(end, abs=1e-3)
        began = time.monotonic()
        assert stage.node.end() == 0
        assert time.monotonic() - began < 15.0
    finally:
        stage.master.send_signal(signal.SIGCONT)
        ended(ros.process, signal.SIGKILL)


def test_a_plan_of_moveit_moves_the_robot(ros, stage):
    """The steps are those of docs/ros.md."""
    command = [PYTHON, "examples/send_plan.py", "examples/moveit_plan.yaml"]
    sent = subprocess.run(
        command, cwd=ROOT, env=stage.environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert sent.returncode == 0, sent.stderr
    told = sent.stdout.splitlines()
    assert (told[0], told[-1]) == ("24 points, 2.299 s", "SUCCEEDED (0)")
    assert standing(ros) == pytest.approx(
        [0.698132, 0.261799, 0.087266, -0.349066, 0.785398, 0.523599], abs=1e-3
    )


def test_goals_go_on_without_a_master_and_a_new_one_learns_of_the_node(ros, stage):
    _, end, points = there_and_back(ros)
    ros.send(name="orphan", names=JOINTS, points=points)
    ros.fed(name="orphan", count=5)
    ended(stage.master, signal.SIGKILL)
    assert ros.outcome(name="orphan")["status"] == SUCCEEDED
    assert standing(ros) == pytest.approx(end, abs=1e-3)
    stage.node.until("ROS master .* doesn't answer")
    stage.start_master()
    stage.node.until("the ROS master was started anew")
    # the client is a node, too, and unknown to the new master
    ended(ros.process, signal.SIGKILL)
    anew = stage.ready()
    assert anew.param(name="controller_joint_names") == JOINTS
    anew.send(name="anew", names=JOINTS, points=there_and_back(anew)[2])
    assert anew.outcome(name="anew")["status"] == SUCCEEDED
    assert anew.call(service="get_robot_info")["code"]["val"] == 1


def test_the_robot_of_a_killed_node_rests_on_its_path(ros, stage):
    start, end, points = there_and_back(ros)
    ros.send(name="killed", names=JOINTS, points=points)
    ros.fed(name="killed", count=8)
    ended(stage.node.process, signal.SIGKILL)
    limit = time.monotonic() + 20.0
    while "stopped on its path" not in (told := stage.status()):
        assert time.monotonic() < limit, told
    assert "owner" not in told
    assert_rests_on_path(stage.ready(), start, end)


def test_a_node_that_is_ended_lets_the_robot_come_to_rest(ros, stage):
    start, end, points = there_and_back(ros)
    ros.send(name="ended", names=JOINTS, points=points)
    ros.fed(name="ended", count=8)
    assert stage.node.end() == 0
    outcome = ros.outcome(name="ended")
    assert outcome["status"] == ABORTED
    assert "Traceback" not in "".join(stage.node.lines)
    assert_rests_on_path(stage.ready(), start, end)


def test_a_second_node_takes_the_place_of_the_first(ros, stage):
    # on a busy computer a node takes seconds to start, and the robot must still be moving then
    start, end, points = there_and_back(ros, 10.0)
    ros.send(name="replaced", names=JOINTS, points=points)
    ros.fed(name="replaced", count=8)
    first = stage.node
    stage.start_node().until("goals are taken")
    assert first.process.wait(20.0) == 0
    assert_rests_on_path(stage.ready(), start, end)
    time.sleep(1.5)  # the first node must not register again in this time
    assert stage.node.process.poll() is None


def test_a_robot_that_is_served_no_more_aborts_the_goal_and_one_served_anew_is_found(ros, stage):
    _, _, points = there_and_back(ros)
    ros.send(name="gone", names=JOINTS, points=points)
    ros.fed(name="gone", count=5)
    ended(stage.serve.process, signal.SIGKILL)
    outcome = ros.outcome(name="gone")
    assert outcome["status"] == ABORTED
    assert outcome["result"]["error_string"]
    assert ros.until(topic="robot_status", field="motion_possible.val", value=0)["in_error"]["val"] == 1
    ros.send(name="nobody", names=JOINTS, points=points)
    assert ros.outcome(name="nobody")["status"] in (REJECTED, ABORTED)
    stage.start_serve()
    ros.until(topic="robot_status", field="motion_possible.val", value=1)
    ros.send(name="served", names=JOINTS, points=there_and_back(ros)[2])
    assert ros.outcome(name="served")["status"] == SUCCEEDED


def test_a_node_without_a_robot_says_what_to_do_and_waits(ros, stage):
    stage.node.end()
    told = stage.start_node("_robot:=nobody")
    try:
        told.until("there is no one process that owns 'nobody'.*yarc serve")
        assert ros.until(topic="robot_status", field="in_error.val", value=1)["motion_possible"]["val"] == 0
        assert told.end() == 0
    finally:
        ended(told.process)
        ros.delete_param(name="yarc_driver/robot")


def test_another_description_is_left_alone(ros, stage):
    ros.set_param(name="robot_description", value="<robot/>")
    stage.node.end()
    stage.start_node().until("robot_description was set by somebody else")
    assert stage.ready().param(name="robot_description") == "<robot/>"
    stage.node.end()
    stage.start_node("_set_description:=true").until("goals are taken")
    stage.ready()
    ros.last(topic="yarc_driver/scene")
    limit = time.monotonic() + 20.0
    while ros.param(name="robot_description") == "<robot/>":
        assert time.monotonic() < limit
    ros.delete_param(name="yarc_driver/set_description")


def test_a_wrong_parameter_is_one_clear_error(ros, stage):
    stage.node.end()
    told = stage.start_node("_hold_on_cancel:=perhaps")
    try:
        told.until("~hold_on_cancel is 'perhaps': it must be true or false")
        assert told.process.wait(20.0) == 1
        assert "Traceback" not in "".join(told.lines)
    finally:
        ended(told.process)
        ros.delete_param(name="yarc_driver/hold_on_cancel")
