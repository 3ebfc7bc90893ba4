"""The rclpy side of the driver: action, topics, services and parameters of the ROS 2 node.

One executor with one thread runs all callbacks, and no callback blocks. A goal's coroutine awaits a future
that the driver's thread sets. Orders to `yarc serve`, and the requests for new drawings after changes, run in
threads of their own.

Written for Python 3.8 and later, and for Humble, Jazzy and Kilted.
"""

from __future__ import annotations

import concurrent.futures
import functools
import threading
import time
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, Sequence, Tuple

from control_msgs.action import FollowJointTrajectory
from rcl_interfaces.msg import ParameterDescriptor
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.exceptions import NameValidationException
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from sensor_msgs.msg import JointState as JointStateMessage
from std_msgs.msg import Float64, String
from std_srvs.srv import Trigger

from yarclang.client import Gone, Refused
from yarclang.ros.node import ros2_messages as messages
from yarclang.ros.node.action import ABORTED, CANCELED, INVALID_GOAL, SUCCEEDED, Feedback, Result
from yarclang.ros.node.driver import Driver, JointState, Status
from yarclang.ros.node.kinematics import Kinematics
from yarclang.ros.node.markers import Marker, fill, ghost_markers, scene_markers
from yarclang.ros.node.trajectory import INVALID_JOINTS, Goal

ACTION = "joint_trajectory_controller/follow_joint_trajectory"
"""Default name of the action, which is that of ros2_control's trajectory controller. The files of
`yarc export --moveit` contain it as well.
"""

_KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
"""Quality of service for topics that are published only after changes: late subscribers get the last
message.
"""

_LAST_WORDS = 0.2
"""Time for the last messages to reach their receivers before the node is destroyed [s]."""

_UNHEARD = Status(-1, -1, -1, 0, -1, 1, 0, "no robot is connected")

_FAILED = (Gone, Refused, TimeoutError)
"""Exceptions that are raised if an order to the robot isn't carried out."""

_TRIED_EACH = 1.0
"""Time between two attempts to find a robot that isn't served [s]."""

_Answer = Tuple[bool, str]


@dataclass
class _UnderWay:
    """An accepted goal.

    Attributes:
        handle: rclpy's handle of the goal.
        ending: future that gets the goal's outcome and result.
    """

    handle: Any
    ending: Any


class Node:
    """The ROS 2 node: the `Shell` through which the driver publishes.

    Args:
        node: node of rclpy.
        executor: executor that runs the node's callbacks in one thread.

    Raises:
        ValueError: a parameter has a value of the wrong type.
    """

    def __init__(self, node: Any, executor: Any) -> None:
        self._node, self._executor, self._log = node, executor, node.get_logger()
        self._robot = _text("robot", self._parameter("robot", ""))
        self._action = _text("action", self._parameter("action", ACTION))
        self._hold_on_cancel = _truth("hold_on_cancel", self._parameter("hold_on_cancel", True))
        self._pace = _percent("override", self._parameter("override", 0.0))
        node.declare_parameter("robot_description", "")
        self._driver: Driver | None = None
        self._goals: Dict[str, _UnderWay] = {}
        self._name = self._robot
        self._changed, self._closing, self._closed = (threading.Event() for _ in range(3))
        self._orders = concurrent.futures.ThreadPoolExecutor(4, thread_name_prefix="orders")
        self._joint_states = node.create_publisher(JointStateMessage, "joint_states", 10)
        self._description = node.create_publisher(String, "robot_description", _KEPT)
        self._diagnostics = self._optional(_Diagnostics, "diagnostic_msgs", "/diagnostics")
        self._markers = self._optional(_Markers, "visualization_msgs", "~/scene and ~/ghost")
        self._model: Dict[str, Any] = {}
        self._kinematics: Kinematics | None = None

    def _parameter(self, name: str, default: Any) -> Any:
        return self._node.declare_parameter(name, default, ParameterDescriptor(dynamic_typing=True)).value

    def _optional(self, made: Callable[[Any], Any], package: str, what: str) -> Any:
        """Return an object that needs a message package; None, with a warning, if the package isn't
        installed.
        """
        try:
            return made(self._node)
        except ImportError:
            self._log.warning(f"{package} isn't installed: {what} isn't published")
            return None

    # life

    def connect(self, over: threading.Event) -> bool:
        """Connect to the robot as soon as it is served. Return False if the node is ended first (`over` is
        set).

        Raises:
            yarclang.client.Refused: the connection was denied, and would be denied again.
        """
        reported = ""
        self.status(_UNHEARD)
        client = f"ROS 2 {self._node.get_fully_qualified_name()}"
        while not over.is_set():
            driver = Driver(self._robot or None, self, name=client, hold_on_cancel=self._hold_on_cancel)
            try:
                driver.start()
            except (Gone, TimeoutError) as error:
                if str(error) != reported:
                    to_do = (
                        "Serve the robot as the same user and with the same XDG_RUNTIME_DIR, or name it "
                        "with -p robot:=NAME; the node tries again each second"
                    )
                    self.say("error", f"{error}. {to_do}")
                reported = str(error)
                over.wait(_TRIED_EACH)
            else:
                self._driver = driver
                return True
        return False

    def offer(self) -> None:
        """Begin to accept goals and orders, after `connect`.

        Raises:
            ValueError: the name of the action is invalid.
        """
        driver, node, apart = self._connected(), self._node, ReentrantCallbackGroup()
        if self._pace:
            self._override(Float64(data=self._pace))
        try:
            server = ActionServer(
                node,
                FollowJointTrajectory,
                self._action,
                self._execute,
                goal_callback=self._judge,
                handle_accepted_callback=self._begin,
                cancel_callback=self._cancel,
                callback_group=apart,
            )
        except (NameValidationException, ValueError) as error:
            raise ValueError(
                f"the parameter action is {self._action!r}, no name for an action: {error}"
            ) from None
        del server  # the node keeps a reference to it
        for name, order in (("hold", driver.hold), ("resume", driver.resume), ("stop", driver.stop)):
            node.create_service(
                Trigger, f"~/{name}", functools.partial(self._trigger, order), callback_group=apart
            )
        node.create_subscription(Float64, "~/override", self._override, 10, callback_group=apart)
        self._changed.set()
        threading.Thread(target=self._attend, name="attending", daemon=True).start()
        names = ", ".join(driver.joint_names)
        self.say("info", f"goals are taken on {self._action}, for joints {names}")

    def close(self, patience: float) -> None:
        """End the node. If a goal of this node moves the robot, the robot comes to rest on its path; all
        goals are ended.

        Args:
            patience: longest wait until the results are sent [s].
        """
        self._closing.set()
        self._changed.set()
        if self._driver is not None:
            self._driver.close()
        for goal_id in list(self._goals):
            self.ended(goal_id, ABORTED, Result(INVALID_GOAL, "the node was ended"))
        until = time.monotonic() + patience
        while self._goals and time.monotonic() < until:
            time.sleep(0.01)
        time.sleep(_LAST_WORDS)
        self._closed.set()
        self._orders.shutdown(wait=False)

    def _connected(self) -> Driver:
        assert self._driver is not None
        return self._driver

    # called by the driver

    def accepted(self, goal_id: str) -> None:
        """Log that a goal is being planned, or will be planned when the robot rests."""
        self._log.info(f"goal {goal_id} is accepted")

    def feedback(self, goal_id: str, feedback: Feedback) -> None:
        """Publish the progress of a goal."""
        goal = self._goals.get(goal_id)
        if goal is not None and not self._closed.is_set():
            kind = FollowJointTrajectory.Feedback
            goal.handle.publish_feedback(messages.feedback_message(kind, feedback, self._now()))

    def ended(self, goal_id: str, outcome: str, result: Result) -> None:
        """End a goal. If it is ended twice, only the first time counts."""
        goal = self._goals.get(goal_id)
        if goal is not None and not goal.ending.done():
            goal.ending.set_result((outcome, result))
            self._executor.wake()  # waiting coroutines are resumed only when the executor is woken

    def joint_state(self, state: JointState) -> None:
        """Publish the joints' state."""
        if not self._closed.is_set():
            self._joint_states.publish(messages.joint_state_message(JointStateMessage, state, self._now()))

    def status(self, status: Status) -> None:
        """Publish the robot's status."""
        if self._diagnostics is not None and not self._closed.is_set():
            self._diagnostics.publish(self._name or "robot", status, self._now())

    def changed(self) -> None:
        """Handle a change of the robot, its cell or its planned motion."""
        self._changed.set()

    def say(self, level: str, text: str) -> None:
        """Print a line for the user, on the terminal and on rosout."""
        # There is one call for each level: a logger identifies a call by its source line, whose level must
        # not change.
        if level == "error":
            self._log.error(text)
        elif level == "warn":
            self._log.warning(text)
        else:
            self._log.info(text)

    def _now(self) -> Any:
        return self._node.get_clock().now().to_msg()

    # the action

    def _judge(self, request: Any) -> Any:
        """Accept or reject a goal. The goal isn't passed to the driver here, because its id isn't known yet:
        rclpy gives the id only to `_begin`, which passes the goal to the driver.
        """
        others = messages.multi_dof_joints(request)
        if others:
            why: Result | None = Result(
                INVALID_JOINTS, f"the robot has no multi-DOF joint {others[0][:64]!r}"
            )
        else:
            why = self._connected().check(self._goal_of(request))
        if why is None:
            return GoalResponse.ACCEPT
        # In ROS 2, a rejection has no text, so the reason is logged.
        self.say("error", f"a goal was rejected ({why.error_code}): {why.error_string}")
        return GoalResponse.REJECT

    def _begin(self, handle: Any) -> None:
        goal_id = _id_of(handle)
        self._goals[goal_id] = _UnderWay(handle, Future(executor=self._executor))
        handle.execute()
        refused = self._connected().goal(goal_id, self._goal_of(handle.request))
        if refused is not None:
            self.say("error", f"goal {goal_id}: {refused.error_string}")
            self.ended(goal_id, ABORTED, refused)

    def _goal_of(self, request: Any) -> Goal:
        return messages.goal_of(request, self._now())

    def _cancel(self, handle: Any) -> Any:
        self._connected().cancel(_id_of(handle))
        return CancelResponse.ACCEPT

    async def _execute(self, handle: Any) -> Any:
        """Wait for the end of a goal, then report its outcome to its client."""
        goal_id = _id_of(handle)
        outcome, result = await self._goals[goal_id].ending
        if outcome == CANCELED and not handle.is_cancel_requested:
            # In ROS 2, only goals whose cancellation was requested can end as canceled, and an error_code of
            # 0 would mean success.
            outcome = ABORTED
            result = replace(result, error_code=result.error_code or INVALID_GOAL)
        if outcome == SUCCEEDED:
            handle.succeed()
        elif outcome == CANCELED:
            handle.canceled()
        else:
            handle.abort()
        del self._goals[goal_id]
        note = f" ({result.error_string})" if result.error_string else ""
        self.say("info", f"goal {goal_id} has ended: {outcome}{note}")
        return messages.result_message(FollowJointTrajectory.Result, result)

    # orders

    async def _trigger(self, order: Callable[[], _Answer], _request: Any, response: Any) -> Any:
        response.success, response.message = await self._apart(order)
        return response

    def _override(self, message: Any) -> None:
        """Set the override. A refusal is logged, because a topic has no reply."""
        percent = float(message.data)

        def order() -> _Answer:
            done, text = self._connected().override(percent)
            if not done:
                self.say("error", f"override {percent:g} %: {text}")
            return done, text

        self._apart(order)

    def _apart(self, order: Callable[[], _Answer]) -> Any:
        """Give an order in a thread. Return rclpy's future of the reply."""
        future = Future(executor=self._executor)

        def carried_out() -> None:
            try:
                answer = order()
            except _FAILED as error:
                answer = False, said(error)
            future.set_result(answer)
            self._executor.wake()

        self._orders.submit(carried_out)
        return future

    # drawings

    def _attend(self) -> None:
        """Ask the driver for new drawings after changes. This runs in a thread of its own, because the driver
        may be slow.
        """
        reported: Dict[str, str] = {}
        works = {"robot_description": self._describe, "scene": self._draw_scene, "ghost": self._draw_ghost}
        while self._changed.wait() and not self._closing.is_set():
            self._changed.clear()
            for topic, work in works.items():
                try:
                    work()
                    reported.pop(topic, None)
                except Gone:  # the driver reports it, and also when the robot is served again
                    break
                except (Refused, TimeoutError, ValueError) as error:
                    if reported.get(topic) != said(error):
                        self.say("warn", f"{topic} isn't up to date: {said(error)}")
                    reported[topic] = said(error)

    def _describe(self) -> None:
        model = self._connected().model()
        text = str(model["urdf"])
        if text != self._model.get("urdf"):
            self._kinematics = None
            self._node.set_parameters([Parameter("robot_description", value=text)])
            self._description.publish(String(data=text))
        self._model, self._name = model, str(model["name"])

    def _draw_scene(self) -> None:
        if self._markers is not None:
            self._markers.draw_scene(scene_markers(self._connected().scene()))

    def _draw_ghost(self) -> None:
        if self._markers is None or not self._model:
            return
        if self._kinematics is None:
            self._kinematics = Kinematics(str(self._model["urdf"]), str(self._model["base"]))
        driver = self._connected()
        course = [positions for _, positions in driver.ghost()]
        tool = str(self._model["tool"])
        self._markers.draw_ghost(ghost_markers(self._kinematics, tool, driver.joint_names, course))


class _Diagnostics:
    """Publisher of the robot's status as diagnostics. ROS 1 has industrial_msgs/RobotStatus for this, but
    there is no release of industrial_msgs for ROS 2.
    """

    def __init__(self, node: Any) -> None:
        from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

        self._kinds = DiagnosticArray, DiagnosticStatus, KeyValue
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)

    def publish(self, name: str, status: Status, stamp: Any) -> None:
        self._publisher.publish(messages.diagnostics_message(*self._kinds, name, status, stamp))


def said(error: Exception) -> str:
    """Return the reason for which an order was refused, and the remedy."""
    to_do = getattr(error, "help", "")
    return f"{error} ({to_do})" if to_do else str(error)


class _Markers:
    """Publisher of the drawings for RViz: the cell around the robot, and the planned motion. Unchanged
    drawings are not published again.
    """

    def __init__(self, node: Any) -> None:
        from geometry_msgs.msg import Point
        from visualization_msgs.msg import Marker as MarkerMessage
        from visualization_msgs.msg import MarkerArray

        self._kinds = MarkerArray, MarkerMessage, Point
        self._scene = node.create_publisher(MarkerArray, "~/scene", _KEPT)
        self._ghost = node.create_publisher(MarkerArray, "~/ghost", _KEPT)
        self._drawn: Dict[Any, Sequence[Marker]] = {}

    def draw_scene(self, markers: Sequence[Marker]) -> None:
        self._draw(self._scene, markers)

    def draw_ghost(self, markers: Sequence[Marker]) -> None:
        self._draw(self._ghost, markers)

    def _draw(self, publisher: Any, markers: Sequence[Marker]) -> None:
        if self._drawn.get(publisher) != markers:
            array, kind, point = self._kinds
            publisher.publish(array(markers=[fill(kind(), one, point) for one in markers]))
            self._drawn[publisher] = markers


def _id_of(handle: Any) -> str:
    return bytes(handle.goal_id.uuid).hex()


def _text(name: str, value: Any) -> str:
    """Return the value of the parameter `name` as text. An integer stands for the number of a process."""
    if isinstance(value, bool) or not isinstance(value, (str, int)):
        raise ValueError(f"the parameter {name} is {value!r}: it must be a text")
    return str(value)


def _truth(name: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"the parameter {name} is {value!r}: it must be true or false")
    return value


def _percent(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"the parameter {name} is {value!r}: it must be a number of percent, as 50")
    return float(value)
