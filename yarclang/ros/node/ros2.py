"""The node for ROS 2: the driver's goals, joints and status as an rclpy action server, topics and services.

    ros2 run yarc_driver yarc_ros2 --ros-args -p robot:=industrial6

One executor with one thread takes all that comes; none of its callbacks waits. A goal's coroutine waits for a future that the driver's thread sets, and what may take
time (an order to `yarc serve`, drawing the scene) is done in threads of its own. Written for Python 3.8 and later and for Humble, Jazzy and Kilted.
"""

from __future__ import annotations

import concurrent.futures
import functools
import os
import signal
import sys
import threading
import time
import traceback
from typing import Any, Callable, Dict, List, Optional, Tuple

from yarclang.client import Gone, Refused
from yarclang.ros.node import ros2_messages as messages
from yarclang.ros.node.action import Feedback
from yarclang.ros.node.driver import Driver, JointState, Status
from yarclang.ros.node.trajectory import INVALID_GOAL, INVALID_JOINTS, Goal, Result, fault_of

_MISSING: Optional[ImportError] = None
try:
    import rclpy
    from control_msgs.action import FollowJointTrajectory
    from rclpy.action import ActionServer, CancelResponse, GoalResponse
    from rclpy.callback_groups import ReentrantCallbackGroup
    from rclpy.exceptions import NameValidationException, ParameterException
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.parameter import Parameter
    from rclpy.qos import DurabilityPolicy, QoSProfile
    from rclpy.signals import SignalHandlerOptions
    from rclpy.task import Future
    from sensor_msgs.msg import JointState as JointStateMessage
    from std_msgs.msg import Float64, String
    from std_srvs.srv import Trigger
except ImportError as _error:
    _MISSING = _error

ACTION = "joint_trajectory_controller/follow_joint_trajectory"
"""Name of the action, as MoveIt's configuration of `yarc export --moveit` has it."""

END_TIME = 1.0
"""Longest wait, after the driver has ended all goals, until their results are sent [s]."""

_AFAR = (Gone, Refused, TimeoutError)
"""What an order may end with."""

_Answer = Tuple[bool, str]


class Shell:
    """The ROS side of the driver: see `yarclang.ros.node.driver.Shell`.

    Args:
        node: rclpy's node.
        executor: carries its callbacks out.
    """

    def __init__(self, node: Any, executor: Any) -> None:
        self._node = node
        self._executor = executor
        self._log = node.get_logger()
        self._goals: Dict[str, _Goal] = {}
        self._lock = threading.Lock()
        self._changed = threading.Event()
        self._closed = False
        kept = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._joint_states = node.create_publisher(JointStateMessage, "joint_states", 10)
        self._description = node.create_publisher(String, "robot_description", kept)
        self._diagnostics = _optional(
            self._log, "diagnostic_msgs", lambda: _Diagnostics(node), "/diagnostics isn't published"
        )
        self.name = ""
        node.declare_parameter("robot_description", "")
        asked = node.declare_parameter("robot", "").value
        hold = node.declare_parameter("hold_on_cancel", True).value
        self.action_name = node.declare_parameter("action_name", ACTION).value
        client = f"ROS 2 {node.get_fully_qualified_name()}"
        self.driver = Driver(asked or None, self, name=client, hold_on_cancel=bool(hold))
        self._orders = concurrent.futures.ThreadPoolExecutor(4, thread_name_prefix="orders")
        self._drawing = threading.Thread(target=self._draw, name="drawing", daemon=True)

    def start(self) -> None:
        """Connect, and take goals and orders from now on; raises as `Driver.start`."""
        self.driver.start()
        self._drawing.start()
        self._changed.set()
        node, apart = self._node, ReentrantCallbackGroup()
        self._server = ActionServer(
            node,
            FollowJointTrajectory,
            self.action_name,
            self._execute,
            goal_callback=self._asked,
            handle_accepted_callback=self._begun,
            cancel_callback=self._cancelled,
            callback_group=apart,
        )
        for name in ("hold", "resume", "stop"):
            carried = functools.partial(self._trigger, getattr(self.driver, name))
            node.create_service(Trigger, f"~/{name}", carried, callback_group=apart)
        node.create_subscription(Float64, "~/override", self._override, 10, callback_group=apart)

    def close(self) -> None:
        """Bring the robot to rest on its path, end all goals, and publish no more."""
        self.driver.close()
        for goal_id in list(self._goals):
            self.ended(goal_id, "aborted", Result(INVALID_GOAL, "the node has ended"))
        self._orders.shutdown(wait=False)

    def is_idle(self) -> bool:
        """Return True if no goal waits for its result to be sent."""
        return not self._goals

    def silence(self) -> None:
        """Publish no more: the node is about to be destroyed."""
        self._closed = True
        self._changed.set()

    # the action

    def _asked(self, request: Any) -> Any:
        """Accept or reject a goal by its form: rclpy tells its id only after that, so that the driver gets it in `_begun`."""
        others = messages.multi_dof_joints(request)
        if others:
            why: Optional[Result] = Result(INVALID_JOINTS, f"the robot has no multi-DOF joint {others[0]!r}")
        else:
            why = fault_of(self._goal_of(request), self.driver.joints)
        if why is None:
            return GoalResponse.ACCEPT
        self._log.error(f"goal rejected ({why.error_code}): {why.error_string}")
        return GoalResponse.REJECT

    def _begun(self, handle: Any) -> None:
        goal_id = _id_of(handle)
        goal = _Goal(handle, Future(executor=self._executor))
        with self._lock:
            self._goals[goal_id] = goal
        handle.execute()
        refused = self.driver.goal(goal_id, self._goal_of(handle.request))
        if refused is not None:
            self.ended(goal_id, "aborted", refused)

    def _goal_of(self, request: Any) -> Goal:
        return messages.goal_of(request, self._node.get_clock().now().to_msg())

    def _cancelled(self, handle: Any) -> Any:
        self.driver.cancel(_id_of(handle))
        return CancelResponse.ACCEPT

    async def _execute(self, handle: Any) -> Any:
        goal_id = _id_of(handle)
        outcome, result = await self._goals[goal_id].ending
        if outcome == "succeeded":
            handle.succeed()
        elif outcome == "canceled" and handle.is_cancel_requested:
            handle.canceled()
        else:  # rcl lets a goal end canceled only at a client's request: what the server ends is aborted
            handle.abort()
        with self._lock:
            del self._goals[goal_id]
        said = f": {result.error_string}" if result.error_string else ""
        text = f"goal {goal_id[:8]} {outcome} ({result.error_code}){said}"
        if outcome == "aborted":
            self._log.error(text)
        else:
            self._log.info(text)
        return messages.result_message(FollowJointTrajectory.Result, result)

    # what the driver says

    def accepted(self, goal_id: str) -> None:
        """Log that planning begins."""
        self._log.info(f"goal {goal_id[:8]} is planned")

    def feedback(self, goal_id: str, feedback: Feedback) -> None:
        """Publish how a goal goes on."""
        goal = self._goals.get(goal_id)
        if goal is not None and not self._closed:
            goal.handle.publish_feedback(
                messages.feedback_message(FollowJointTrajectory.Feedback, feedback, self._now())
            )

    def ended(self, goal_id: str, outcome: str, result: Result) -> None:
        """End a goal; of two ends the first counts."""
        goal = self._goals.get(goal_id)
        if goal is not None and not goal.ending.done():
            goal.ending.set_result((outcome, result))
            self._executor.wake()  # rclpy looks at waiting coroutines only when something wakes it

    def joint_state(self, state: JointState) -> None:
        """Publish where the joints are."""
        if not self._closed:
            self._joint_states.publish(messages.joint_state_message(JointStateMessage, state, self._now()))

    def status(self, status: Status) -> None:
        """Publish how the robot is."""
        if self._diagnostics is not None and not self._closed:
            self._diagnostics.publish(self.name or "robot", status, self._now())

    def changed(self) -> None:
        """Have robot, scene and plan published anew."""
        self._changed.set()

    def say(self, level: str, text: str) -> None:
        """Log a line."""
        # each level has a line of its own: rclpy knows a logger's call by its place, and its level must not change
        if level == "error":
            self._log.error(text)
        elif level == "warn":
            self._log.warning(text)
        else:
            self._log.info(text)

    def _now(self) -> Any:
        return self._node.get_clock().now().to_msg()

    # orders

    async def _trigger(self, order: Callable[[], _Answer], _request: Any, response: Any) -> Any:
        response.success, response.message = await self._apart(order)
        return response

    def _apart(self, order: Callable[[], _Answer]) -> Any:
        """Carry an order out in a thread; return rclpy's future of its answer."""
        future = Future(executor=self._executor)

        def carried_out() -> None:
            try:
                answer = order()
            except _AFAR as error:
                answer = False, _said(error)
            future.set_result(answer)
            self._executor.wake()

        self._orders.submit(carried_out)
        return future

    def _override(self, message: Any) -> None:
        """Change the pace; a topic has no answer, so that a refusal is a line of the log."""
        percent = float(message.data)

        def order() -> _Answer:
            well, text = self.driver.override(percent)
            self.say("info" if well else "error", f"override {percent:g} %: {text}")
            return well, text

        self._apart(order)

    # the picture

    def _draw(self) -> None:
        while self._changed.wait() and not self._closed:
            self._changed.clear()
            try:
                self._describe(self.driver.model())
            except _AFAR as error:
                self.say("warn", f"robot_description isn't up to date: {_said(error)}")

    def _describe(self, model: Dict[str, Any]) -> None:
        self.name = str(model["name"])
        text = str(model["urdf"])
        if text != self._node.get_parameter("robot_description").value:
            self._node.set_parameters([Parameter("robot_description", value=text)])
            self._description.publish(String(data=text))


class _Goal:
    """A goal that was accepted: rclpy's handle, and the future of (outcome, result)."""

    def __init__(self, handle: Any, ending: Any) -> None:
        self.handle = handle
        self.ending = ending


class _Diagnostics:
    """Publisher of diagnostics: industrial_msgs/RobotStatus has no release for ROS 2."""

    def __init__(self, node: Any) -> None:
        from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue

        self._kinds = DiagnosticArray, DiagnosticStatus, KeyValue
        self._publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)

    def publish(self, name: str, status: Status, stamp: Any) -> None:
        self._publisher.publish(messages.diagnostics_message(*self._kinds, name, status, stamp))


def _optional(log: Any, package: str, made: Callable[[], Any], else_: str) -> Any:
    """Return what needs a package of messages; None, and a warning, if it isn't installed."""
    try:
        return made()
    except ImportError:
        log.warning(f"{package} isn't installed: {else_}")
        return None


def _id_of(handle: Any) -> str:
    return bytes(handle.goal_id.uuid).hex()


def main(arguments: Optional[List[str]] = None) -> int:
    """Run the node until SIGINT or SIGTERM.

    Args:
        arguments: with the program's name first, and ROS's (`--ros-args`); None: those of the process.

    Returns:
        The exit status: 0; 1 if the robot can't be reached or the node has failed; 2 if a package is missing or a parameter can't be.
    """
    if _MISSING is not None:
        sys.stderr.write(_what_is_missing(_MISSING))
        return 2
    over, signalled = threading.Event(), threading.Event()

    def end(*_: Any) -> None:
        signalled.set()
        over.set()
        for one in (signal.SIGINT, signal.SIGTERM):  # a second signal ends the process at once
            signal.signal(one, signal.SIG_DFL)

    rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, end)
    executor = SingleThreadedExecutor()
    node = rclpy.create_node("yarc")
    executor.add_node(node)
    status = _served(node, executor, over)
    executor.shutdown(timeout_sec=END_TIME)
    node.destroy_node()
    rclpy.try_shutdown()
    return status if status or signalled.is_set() else 1


def _served(node: Any, executor: Any, over: threading.Event) -> int:
    """Serve until `over` is set, bring the robot to rest, and return the exit status."""
    log = node.get_logger()
    try:
        shell = Shell(node, executor)
    except ParameterException as error:
        log.fatal(str(error))
        return 2
    try:
        shell.start()
    except _AFAR as error:
        log.fatal(f"{_said(error)}; start `yarc serve` first, or name the robot: --ros-args -p robot:=NAME")
        return 1
    except NameValidationException as error:
        log.fatal(f"the parameter action_name can't be {shell.action_name!r}: {error}")
        shell.close()
        return 2
    spinning = threading.Thread(target=_spin, args=(executor, over, log), name="executor", daemon=True)
    spinning.start()
    over.wait()
    log.info("the node ends; a robot that it moves comes to rest on its path")
    shell.close()
    until = time.monotonic() + END_TIME
    while not shell.is_idle() and time.monotonic() < until:
        spinning.join(0.02)
    shell.silence()
    return 0


def _spin(executor: Any, over: threading.Event, log: Any) -> None:
    try:
        executor.spin()
    except ExternalShutdownException:
        pass
    except Exception:
        log.fatal(f"the node has failed, please report this:\n{traceback.format_exc()}")
    finally:
        over.set()


def _said(error: Exception) -> str:
    """Return what an order ended with, and what to do about it."""
    help_ = getattr(error, "help", "")
    return f"{error} ({help_})" if help_ else str(error)


def _what_is_missing(error: ImportError) -> str:
    distribution = os.environ.get("ROS_DISTRO", "DISTRIBUTION")
    package = (error.name or "rclpy").partition(".")[0]
    if package == "rclpy":
        to_do = f"source /opt/ros/{distribution}/setup.bash first"
    else:
        to_do = f"apt install ros-{distribution}-{package.replace('_', '-')}"
    return f"yarc_ros2: {package} can't be imported ({error}): {to_do}\n"


if __name__ == "__main__":
    sys.exit(main())
