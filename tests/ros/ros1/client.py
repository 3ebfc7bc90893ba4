"""A client of the ROS 1 node, for a Python that has rospy.

It reads JSON lines `{"do": ..., ...}`, and answers each by a line with `answer` or `error`. Goals are sent by
actionlib's client. A topic is recorded from the first order about it on.
"""

import json
import sys
import threading
import time

import actionlib
import genpy
import rospy
from rosgraph import Master
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64
from std_srvs.srv import Trigger
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint
from visualization_msgs.msg import MarkerArray

from yarclang.ros.node.interfaces import interfaces

KINDS = interfaces()
TOPICS = {
    "joint_states": JointState,
    "feedback_states": KINDS.feedback,
    "robot_status": KINDS.status,
    "yarc_driver/scene": MarkerArray,
    "yarc_driver/ghost": MarkerArray,
}
SERVICES = {
    "yarc_driver/hold": Trigger,
    "yarc_driver/resume": Trigger,
    "yarc_driver/stop": Trigger,
    "stop_motion": KINDS.stop_motion,
    "joint_path_command": KINDS.path_command,
    "get_robot_info": KINDS.robot_info,
}
WITHIN = 30.0


def plain(value):
    """Return a message as JSON values."""
    if isinstance(value, (genpy.Time, genpy.Duration)):
        return value.to_sec()
    if isinstance(value, genpy.Message):
        return {name: plain(getattr(value, name)) for name in value.__slots__}
    if isinstance(value, (list, tuple)):
        return [plain(one) for one in value]
    return value


def trajectory(names, points, stamp=None):
    made = JointTrajectory(joint_names=names)
    if stamp is not None:
        made.header.stamp = rospy.Time.now() + rospy.Duration.from_sec(stamp)
    for point in points:
        made.points.append(
            JointTrajectoryPoint(
                positions=point["positions"],
                velocities=point.get("velocities", []),
                accelerations=point.get("accelerations", []),
                time_from_start=rospy.Duration.from_sec(point["time"]),
            )
        )
    return made


class Client:
    def __init__(self):
        self.news = threading.Condition()
        self.goals, self.topics, self.publishers = {}, {}, {}
        self.action = actionlib.ActionClient("joint_trajectory_action", KINDS.action)

    def ready(self, within=WITHIN):
        """Return True if the action server is connected in time."""
        return self.action.wait_for_server(rospy.Duration.from_sec(within))

    def send(self, name, names, points, stamp=None, path=(), goal=(), goal_time=0.0):
        kind = type(KINDS.action().action_goal.goal)
        made = kind(trajectory=trajectory(names, points, stamp))
        made.goal_time_tolerance = rospy.Duration.from_sec(goal_time)
        made.path_tolerance = [KINDS.tolerance(name=joint, position=width) for joint, width in path]
        made.goal_tolerance = [KINDS.tolerance(name=joint, position=width) for joint, width in goal]
        record = self.goals[name] = {"states": [], "feedback": []}

        def moved(handle):
            with self.news:
                record["states"].append(handle.get_comm_state())
                self.news.notify_all()

        def fed(_handle, feedback):
            with self.news:
                record["feedback"].append(plain(feedback))
                self.news.notify_all()

        record["handle"] = self.action.send_goal(made, moved, fed)

    def cancel(self, name):
        self.goals[name]["handle"].cancel()

    def cancel_all(self):
        self.action.cancel_all_goals()

    def fed(self, name, count, within=WITHIN):
        """Wait until a goal has got `count` feedbacks, and return the last one."""
        record = self.goals[name]
        self.wait(lambda: len(record["feedback"]) >= count, within)
        return record["feedback"][-1]

    def outcome(self, name, within=WITHIN):
        record = self.goals[name]
        handle = record["handle"]
        self.wait(lambda: handle.get_comm_state() == actionlib.CommState.DONE, within)
        return {
            "status": handle.get_goal_status(),
            "text": handle.get_goal_status_text(),
            "result": plain(handle.get_result()),
            "feedback": record["feedback"],
            "states": record["states"],
        }

    def wait(self, true, within):
        with self.news:
            if not self.news.wait_for(true, within):
                raise TimeoutError(f"not within {within:g} s")

    def record(self, topic):
        if topic in self.topics:
            return self.topics[topic]
        kept = self.topics[topic] = []

        def take(message):
            with self.news:
                kept.append((time.monotonic(), plain(message)))
                del kept[:-500]
                self.news.notify_all()

        rospy.Subscriber(topic, TOPICS[topic], take)
        return kept

    def heard(self, topic, count=1, within=WITHIN):
        """Return the next `count` messages of a topic, each with its time of arrival."""
        kept = self.record(topic)
        with self.news:
            before = kept[-1][0] if kept else 0.0

        def fresh():
            return [one for one in kept if one[0] > before]

        self.wait(lambda: len(fresh()) >= count, within)
        with self.news:
            return fresh()[:count]

    def last(self, topic, within=WITHIN):
        """Return the last message of a topic, which may be a latched one."""
        kept = self.record(topic)
        self.wait(lambda: kept, within)
        return kept[-1][1]

    def until(self, topic, field, value, within=WITHIN):
        """Wait for a message with a value in a field, such as `in_motion.val`, and return it."""
        kept = self.record(topic)

        def fits(message):
            for name in field.split("."):
                message = message[name]
            return message == value

        self.wait(lambda: kept and fits(kept[-1][1]), within)
        return kept[-1][1]

    def drawn(self, topic, there=True, within=WITHIN):
        """Return the markers of a topic, once there are some, or none if `there` is False.

        The first marker, which deletes the earlier ones, is left out.
        """
        kept = self.record(topic)
        self.wait(lambda: kept and (len(kept[-1][1]["markers"]) > 1) == there, within)
        return kept[-1][1]["markers"][1:]

    def publish(self, topic, **fields):
        kind = {"joint_path_command": JointTrajectory, "yarc_driver/override": Float64}[topic]
        made = trajectory(**fields) if kind is JointTrajectory else kind(**fields)
        if topic not in self.publishers:
            self.publishers[topic] = rospy.Publisher(topic, kind, queue_size=1)
        publisher, end = self.publishers[topic], time.monotonic() + WITHIN
        while not publisher.get_num_connections() and time.monotonic() < end:
            time.sleep(0.02)
        publisher.publish(made)

    def call(self, service, **fields):
        rospy.wait_for_service(service, 10.0)
        if "points" in fields:
            fields = {"trajectory": trajectory(**fields)}
        return plain(rospy.ServiceProxy(service, SERVICES[service])(**fields))

    def param(self, name):
        return rospy.get_param(name, None)

    def set_param(self, name, value):
        rospy.set_param(name, value)

    def delete_param(self, name):
        if rospy.has_param(name):
            rospy.delete_param(name)

    def types(self):
        """Return the type of each topic that the master knows."""
        return dict(Master("/client").getTopicTypes())

    def sums(self):
        return {kind._type: kind._md5sum for kind in KINDS}


def main():
    rospy.init_node("client", anonymous=True, disable_signals=True)
    client = Client()
    print(json.dumps({"answer": "ready"}), flush=True)
    for line in sys.stdin:
        order = json.loads(line)
        try:
            answer = {"answer": getattr(client, order.pop("do"))(**order)}
        except Exception as error:
            answer = {"error": f"{type(error).__name__}: {error}"}
        print(json.dumps(answer), flush=True)
    rospy.signal_shutdown("the test has ended")


main()
