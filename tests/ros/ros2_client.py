"""A client of the ROS 2 node, for a Python that has rclpy; it prints a JSON object for each case."""

import contextlib
import json
import threading
import time

import rclpy
from control_msgs.action import FollowJointTrajectory
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectoryPoint

ACTION = "joint_trajectory_controller/follow_joint_trajectory"
LONG = 60.0


def until(happened):
    end = time.monotonic() + LONG
    while not happened():
        assert time.monotonic() < end, "nothing came"
        time.sleep(0.005)


def answer(future):
    until(future.done)
    return future.result()


class Client:
    def __init__(self, node):
        self.node, self.heard, self.urdf = node, [], []
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(JointState, "joint_states", self.heard.append, 10)
        node.create_subscription(String, "robot_description", self.urdf.append, kept)
        self.action = ActionClient(node, FollowJointTrajectory, ACTION)

    def begin(self, case, names, positions, seconds):
        """Send a goal; return what is known of it as a dict, its handle, its pending result, and its
        feedback.
        """
        goal = FollowJointTrajectory.Goal()
        goal.trajectory.joint_names = list(names)
        point = JointTrajectoryPoint(positions=positions)
        point.time_from_start.sec = seconds
        goal.trajectory.points = [point]
        feedback = []
        handle = answer(self.action.send_goal_async(goal, feedback_callback=feedback.append))
        result = handle.get_result_async() if handle.accepted else None
        return {"case": case, "accepted": handle.accepted}, handle, result, feedback

    def end(self, told, _handle, result, feedback):
        """Wait for the end of a goal, and print its result."""
        if result is not None:
            found = answer(result)
            told.update(status=found.status, code=found.result.error_code, text=found.result.error_string)
        print(json.dumps({**told, "feedback": len(feedback)}), flush=True)


def main():
    rclpy.init()
    node = rclpy.create_node("client")
    client = Client(node)
    executor = SingleThreadedExecutor()
    executor.add_node(node)

    def spin():
        with contextlib.suppress(ExternalShutdownException):
            executor.spin()

    spinning = threading.Thread(target=spin)
    spinning.start()
    until(lambda: client.heard and client.urdf)
    assert client.action.wait_for_server(LONG)
    names, start = list(client.heard[-1].name), list(client.heard[-1].position)
    away = [value + 0.2 for value in start]
    print(json.dumps({"case": "heard", "names": names, "urdf": "<robot" in client.urdf[-1].data}), flush=True)
    client.end(*client.begin("there", names[::-1], away[::-1], 2))
    there = list(client.heard[-1].position)
    off = max(abs(a - b) for a, b in zip(there, away))  # noqa: B905  (ROS's Python may be 3.8)
    print(json.dumps({"case": "off", "off": off}), flush=True)
    cancelled = client.begin("cancelled", names, start, 8)
    until(lambda: len(cancelled[3]) > 20)
    answer(cancelled[1].cancel_goal_async())
    client.end(*cancelled)
    old = client.begin("preempted", names, start, 8)
    until(lambda: len(old[3]) > 20)
    new = client.begin("preempting", names, away, 3)
    client.end(*old)
    client.end(*new)
    client.end(*client.begin("wrong names", [f"no {name}" for name in names], start, 2))
    client.end(*client.begin("beyond", names, [99.0 for _ in names], 2))
    held = node.create_client(Trigger, "/yarc_driver/resume")
    assert held.wait_for_service(LONG)
    told = answer(held.call_async(Trigger.Request()))
    print(json.dumps({"case": "resume", "done": told.success, "text": told.message}), flush=True)
    executor.shutdown()
    spinning.join()
    rclpy.try_shutdown()


main()
