"""The ROS 2 node beside `yarc serve`, used by an rclpy client.

The test needs a Python with rclpy and control_msgs: YARCLANG_ROS2_PYTHON, or the one of a sourced setup.bash.
"""

import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from ros.process import yarc

ROOT = Path(__file__).resolve().parents[2]
SUCCEEDED, CANCELED, ABORTED = 4, 5, 6
"""States of action_msgs/GoalStatus."""


@pytest.fixture(scope="module")
def python():
    """Return the path of a Python that has ROS 2."""
    for candidate in (os.environ.get("YARCLANG_ROS2_PYTHON"), "/usr/bin/python3", sys.executable):
        if candidate and Path(candidate).exists():
            asked = subprocess.run(
                [candidate, "-c", "import rclpy, control_msgs.action"], capture_output=True, check=False
            )
            if asked.returncode == 0:
                return candidate
    return pytest.skip("no Python here has rclpy and control_msgs")


@pytest.fixture(scope="module")
def told(python):
    """Return the output of a client by its cases, and the exit status of the node."""
    with (
        tempfile.TemporaryDirectory(prefix="ros2-") as name,
        yarc("serve", "--robot", "industrial6", folder=name) as served,
    ):
        served.until("is served")
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]),
            "XDG_RUNTIME_DIR": name,
            "ROS_LOG_DIR": name,
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
            "ROS_LOCALHOST_ONLY": "1",
            "ROS_DOMAIN_ID": str(os.getpid() % 100),
        }
        log = Path(name, "node.txt")
        with log.open("w", encoding="utf-8") as output:
            node = subprocess.Popen(
                [python, "-m", "yarclang.ros.node.ros2"],
                env=environment,
                stdout=output,
                stderr=output,
                cwd=name,
            )
            try:
                client = subprocess.run(
                    [python, str(Path(__file__).with_name("ros2_client.py"))],
                    env=environment,
                    capture_output=True,
                    text=True,
                    timeout=240,
                    check=False,
                )
                node.send_signal(signal.SIGINT)
                status = node.wait(60)
            finally:
                node.kill()
                node.wait()
        assert client.returncode == 0, client.stderr + log.read_text(encoding="utf-8")
        cases = {one["case"]: one for one in map(json.loads, client.stdout.splitlines())}
        yield {**cases, "status": status}


def test_joints_and_description_are_heard(told):
    assert told["heard"]["names"] == ["J1", "J2", "J3", "J4", "J5", "J6"]
    assert told["heard"]["urdf"]


def test_a_goal_with_joints_in_another_order_gets_there(told):
    assert (told["there"]["status"], told["there"]["code"]) == (SUCCEEDED, 0)
    assert told["there"]["feedback"] > 20
    assert told["off"]["off"] < 1e-4


def test_a_cancelled_goal_ends_cancelled_and_a_preempted_one_aborted(told):
    assert told["cancelled"]["status"] == CANCELED
    assert (told["preempted"]["status"], told["preempted"]["code"]) == (ABORTED, -1)
    assert "preempted" in told["preempted"]["text"]
    assert told["preempting"]["status"] == SUCCEEDED


def test_a_goal_of_wrong_shape_is_rejected_and_one_beyond_limits_aborted_with_the_finding(told):
    assert not told["wrong names"]["accepted"]
    assert (told["beyond"]["status"], told["beyond"]["code"]) == (ABORTED, -1)
    assert "Y0502" in told["beyond"]["text"]


def test_services_answer_and_the_node_ends_well(told):
    assert not told["resume"]["done"]
    assert told["resume"]["text"]
    assert told["status"] == 0
