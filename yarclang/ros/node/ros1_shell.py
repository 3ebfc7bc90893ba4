"""The rospy side of the driver: action, topics, services and parameters of the ROS 1 node.

Messages of the driver go through a queue and are published by one thread, so the driver never waits for ROS.
actionlib holds its lock while it passes a goal to this module; since the driver doesn't need this lock, the
two never wait for each other. Log lines for the user are written by another thread, because rospy calls the
master for each line. So positions and results are still published if the master hangs.

Written for Python 3.8 and later.
"""

from __future__ import annotations

import contextlib
import itertools
import queue
import sys
import threading
import time
from dataclasses import dataclass, replace
from typing import Any, Callable, Dict, Sequence, Tuple

import rosgraph
import rospy
from actionlib import ActionServer
from geometry_msgs.msg import Point
from rospy.impl import registration
from sensor_msgs.msg import JointState as JointStateMessage
from std_msgs.msg import Float64
from std_srvs.srv import Trigger, TriggerResponse
from trajectory_msgs.msg import JointTrajectory
from visualization_msgs.msg import Marker as MarkerMessage
from visualization_msgs.msg import MarkerArray

from yarclang.client import Gone, Refused
from yarclang.ros.node.action import INVALID_GOAL, Feedback, Result
from yarclang.ros.node.driver import Driver, JointState, Status
from yarclang.ros.node.interfaces import interfaces
from yarclang.ros.node.kinematics import Kinematics
from yarclang.ros.node.markers import Marker, fill, ghost_markers, scene_markers
from yarclang.ros.node.master import LOST, Master, Registered
from yarclang.ros.node.messages import (
    feedback_message,
    goal_of,
    joint_state_message,
    path_of,
    result_message,
    standing_message,
    status_message,
)
from yarclang.ros.node.trajectory import Goal

ACTION = "joint_trajectory_action"
"""Default name of the action, which is that of ROS-Industrial's drivers. The files of `yarc export --moveit`
contain it as well.
"""

_BACKLOG = 500
"""Largest number of messages that wait for ROS. Further positions and feedback are dropped; ends of goals are
never dropped.
"""

_ASKED_EACH = 1.0
"""Time between two requests to the master for this node's registration [s]."""

_LAST_WORDS = 0.3
"""Time for the last messages to reach their subscribers before the node closes its connections [s]."""

_UNREGISTERS = 2.0
"""Longest wait until rospy has unregistered from the master [s]. rospy itself has no time limit."""

_UNHEARD = Status(-1, -1, -1, 0, -1, 1, 0, "no robot is connected")

_FAILED = (Gone, Refused, TimeoutError)
"""Exceptions that are raised if an order to the robot isn't carried out."""


@dataclass(frozen=True)
class Settings:
    """Private parameters of the node. See `yarclang.ros.node.ros1`.

    Attributes:
        robot: name of the robot or of its process; None for the only one.
        action: name of the action.
        hold_on_cancel: True to hold a cancelled goal at once.
        override: override at the start [%]; None to leave it unchanged.
        set_description: True to replace a robot_description that differs.
    """

    robot: str | None
    action: str
    hold_on_cancel: bool
    override: float | None
    set_description: bool


def settings() -> Settings:
    """Return the settings from the parameter server.

    Raises:
        ValueError: a parameter has a value of the wrong type.
    """
    robot = rospy.get_param("~robot", "")
    return Settings(
        str(robot) or None,
        str(rospy.get_param("~action", ACTION)),
        _truth("hold_on_cancel", True),
        _percent(rospy.get_param("~override", None)),
        _truth("set_description", False),
    )


def _truth(name: str, default: bool) -> bool:
    value = rospy.get_param(f"~{name}", default)
    if not isinstance(value, bool):
        raise ValueError(f"~{name} is {value!r}: it must be true or false")
    return value


def _percent(value: Any) -> float | None:
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ValueError(f"~override is {value!r}: it must be a number of percent, as 50")
    return float(value)


class Node:
    """The node: a `Shell` of the driver.

    Args:
        chosen: its settings.
    """

    def __init__(self, chosen: Settings) -> None:
        self._settings = chosen
        self._kinds = interfaces()
        self._driver: Driver | None = None
        self._handles: Dict[str, Any] = {}
        self._numbers = itertools.count(1)
        self._moving: str | None = None
        self._refused = 0
        self._status = _UNHEARD
        self._model: Dict[str, Any] = {}
        self._kinematics: Kinematics | None = None
        self._drawn: Dict[Any, Sequence[Marker]] = {}
        self._told: Dict[str, str] = {}
        self._server: ActionServer | None = None
        self._closing = threading.Event()
        self._changed = threading.Event()
        self._work: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._joint_states = rospy.Publisher("joint_states", JointStateMessage, queue_size=10)
        self._feedback_states = rospy.Publisher("feedback_states", self._kinds.feedback, queue_size=10)
        self._robot_status = rospy.Publisher("robot_status", self._kinds.status, queue_size=10, latch=True)
        self._scene = rospy.Publisher("~scene", MarkerArray, queue_size=1, latch=True)
        self._ghost = rospy.Publisher("~ghost", MarkerArray, queue_size=1, latch=True)
        self._master = Master(rosgraph.get_master_uri(), rospy.get_name())
        self._lines: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()
        self._publishing, self._talking = _worker(self._work), _worker(self._lines)
        self._attending = threading.Thread(target=self._attend, daemon=True)

    # life

    def connect(self, ended: threading.Event) -> bool:
        """Connect to the robot as soon as it is served. Return False if the node is ended first.

        Raises:
            yarclang.client.Refused: the connection was denied, and would be denied again.
        """
        reported = ""
        self.status(_UNHEARD)
        while not ended.is_set() and not rospy.is_shutdown():
            driver = Driver(
                self._settings.robot,
                self,
                name=rospy.get_name(),
                hold_on_cancel=self._settings.hold_on_cancel,
            )
            try:
                driver.start()
            except (Gone, TimeoutError) as error:
                reason = (
                    f"{error}. It must be served by the same user, with the same XDG_RUNTIME_DIR; if "
                    f"there are several, name it with _robot:=NAME. The node tries again each second"
                )
                if reason != reported:
                    self.say("error", reason)
                reported = reason
                ended.wait(1.0)
            else:
                self._driver = driver
                return True
        return False

    def offer(self) -> None:
        """Begin to accept goals, paths and orders, after `connect`."""
        driver = self._connected()
        if self._settings.override is not None:
            self._override(self._settings.override)
        self._server = ActionServer(
            self._settings.action, self._kinds.action, self._goal, self._cancel, auto_start=False
        )
        self._server.start()
        rospy.Subscriber("joint_path_command", JointTrajectory, self._path, queue_size=10)
        rospy.Subscriber("~override", Float64, lambda message: self._override(message.data), queue_size=10)
        for name, order in (("hold", driver.hold), ("resume", driver.resume), ("stop", driver.stop)):
            rospy.Service(f"~{name}", Trigger, _trigger(order))
        rospy.Service("stop_motion", self._kinds.stop_motion, self._stop_motion)
        rospy.Service("joint_path_command", self._kinds.path_command, self._path_command)
        rospy.Service("get_robot_info", self._kinds.robot_info, self._robot_info)
        self._changed.set()
        self._attending.start()
        names = ", ".join(driver.joint_names)
        self.say(
            "info", f"goals are taken on {rospy.resolve_name(self._settings.action)}, for joints {names}"
        )

    def close(self) -> bool:
        """End the node. If a goal of this node moves the robot, the robot comes to rest on its path; all
        goals are ended. Return False if rospy still waits for a master that hangs.
        """
        self._closing.set()
        self._changed.set()
        if self._driver is not None:
            self._driver.close()
        for goal_id in list(self._handles):
            self.ended(goal_id, "aborted", Result(INVALID_GOAL, "the node was ended"))
        for work in (self._work, self._lines):
            work.put(None)
        self._publishing.join(5.0)
        time.sleep(_LAST_WORDS)
        shutting = threading.Thread(target=rospy.signal_shutdown, args=("the node was ended",), daemon=True)
        shutting.start()
        shutting.join(_UNREGISTERS)
        self._talking.join(_LAST_WORDS)
        return not (self._talking.is_alive() or shutting.is_alive())

    # called by the driver

    def accepted(self, goal_id: str) -> None:
        """Mark a goal as accepted when planning begins."""
        self._work.put(lambda: self._begin(goal_id))

    def feedback(self, goal_id: str, feedback: Feedback) -> None:
        """Publish the progress of a goal, as feedback of the action and on feedback_states."""
        stamp = rospy.Time.now()
        self._stream(lambda: self._feed(goal_id, feedback_message(self._kinds.feedback, feedback, stamp)))

    def ended(self, goal_id: str, outcome: str, result: Result) -> None:
        """End a goal with the outcome "succeeded", "aborted" or "canceled"."""
        self._work.put(lambda: self._end(goal_id, outcome, result))

    def joint_state(self, state: JointState) -> None:
        """Publish the joints' state on joint_states and, between goals, on feedback_states."""
        stamp = rospy.Time.now()
        self._stream(lambda: self._stand(state, stamp))

    def status(self, status: Status) -> None:
        """Publish the robot's status, on robot_status."""
        self._work.put(lambda: self._tell(status))

    def changed(self) -> None:
        """Handle a change of the robot, its cell or its planned motion."""
        self._changed.set()

    def say(self, level: str, text: str) -> None:
        """Print a line for the user, on the terminal and on rosout."""
        log = {"info": rospy.loginfo, "warn": rospy.logwarn}.get(level, rospy.logerr)

        def tell() -> None:
            # rospy calls the master for each line. If another node of the same name has replaced this one,
            # a call after this node's end would shut down the other node.
            if rospy.is_shutdown():
                sys.stderr.write(f"{text}\n")
            else:
                log("%s", text)

        self._lines.put(tell)

    # publishing, all in one thread

    def _stream(self, work: Callable[[], None]) -> None:
        if self._work.qsize() < _BACKLOG:
            self._work.put(work)

    def _begin(self, goal_id: str) -> None:
        self._moving = goal_id
        self._forgive()

    def _feed(self, goal_id: str, message: Any) -> None:
        self._feedback_states.publish(message)
        handle = self._handles.get(goal_id)
        if handle is not None:
            handle.publish_feedback(message)

    def _end(self, goal_id: str, outcome: str, result: Result) -> None:
        if self._moving == goal_id:
            self._moving = None
        handle = self._handles.pop(goal_id, None)
        if handle is not None:
            end = {"succeeded": handle.set_succeeded, "canceled": handle.set_canceled}
            end.get(outcome, handle.set_aborted)(
                result_message(self._kinds.result, result), result.error_string
            )

    def _stand(self, state: JointState, stamp: Any) -> None:
        self._joint_states.publish(joint_state_message(JointStateMessage, state, stamp))
        if self._moving is None:
            self._feedback_states.publish(standing_message(self._kinds.feedback, state, stamp))

    def _tell(self, status: Status) -> None:
        self._status = status
        if self._refused:
            status = replace(status, in_error=1, error_code=self._refused)
        self._robot_status.publish(status_message(self._kinds.status, status, rospy.Time.now()))

    # goals

    def _connected(self) -> Driver:
        assert self._driver is not None
        return self._driver

    def _goal(self, handle: Any) -> None:
        """Accept or reject a goal of the action. actionlib holds its lock during this call."""
        goal_id = handle.get_goal_id().id
        self._handles[goal_id] = handle
        refused = self._connected().goal(goal_id, goal_of(handle.get_goal(), rospy.Time.now()))
        if refused is None:
            handle.set_accepted()
        else:
            del self._handles[goal_id]
            self.say("error", f"a goal was rejected: {refused.error_string}")
            handle.set_rejected(result_message(self._kinds.result, refused), refused.error_string)

    def _cancel(self, handle: Any) -> None:
        self._connected().cancel(handle.get_goal_id().id)

    def _path(self, trajectory: Any) -> None:
        """Accept a trajectory from the topic joint_path_command. A trajectory without points is a stop, as in
        the drivers of ROS-Industrial.
        """
        if trajectory.points:
            self._take(path_of(trajectory, rospy.Time.now()))
        else:
            self._connected().cancel(None)

    def _take(self, path: Goal) -> bool:
        name = f"path {next(self._numbers)} of joint_path_command"
        refused = self._connected().goal(name, path)
        if refused is not None:
            self.say("error", f"{name} was refused: {refused.error_string}")
            self._work.put(lambda: self._blame(refused.error_code))
        return refused is None

    def _blame(self, code: int) -> None:
        """Show in robot_status that a trajectory from a topic was refused, because a topic has no reply. The
        error is shown until the next goal.
        """
        self._refused = code
        self._tell(self._status)

    def _forgive(self) -> None:
        if self._refused:
            self._refused = 0
            self._tell(self._status)

    # services and topics

    def _override(self, percent: float) -> None:
        done, text = self._connected().override(percent)
        if not done:
            self.say("error", f"override {percent:g} %: {text}")

    def _stop_motion(self, _request: Any) -> Any:
        done, _ = self._connected().stop()
        return self._answer(self._kinds.stop_motion, done)

    def _path_command(self, request: Any) -> Any:
        return self._answer(
            self._kinds.path_command, self._take(path_of(request.trajectory, rospy.Time.now()))
        )

    def _robot_info(self, _request: Any) -> Any:
        try:
            model = self._connected().model()
        except _FAILED:
            return self._answer(self._kinds.robot_info, False)
        answer = self._answer(self._kinds.robot_info, True)
        answer.controller = self._kinds.device(model=model.get("controller", ""))
        answer.robots = [self._kinds.device(model=model["name"])]
        return answer

    @staticmethod
    def _answer(service: Any, done: bool) -> Any:
        answer = service._response_class()
        answer.code.val = answer.code.SUCCESS if done else answer.code.FAILURE
        return answer

    # the master, parameters, and drawings of RViz

    def _attend(self) -> None:
        """Check regularly that the master knows this node, and ask the driver for new drawings after changes.
        This runs in a thread of its own, because both calls may be slow.
        """
        while not self._closing.is_set():
            has_changed = self._changed.wait(_ASKED_EACH)
            self._changed.clear()
            if self._closing.is_set():
                return
            try:
                if not self._master.knows_node():
                    self._master.register(rospy.get_node_uri(), _registered())
                    self.say("info", "the ROS master was started anew: this node is registered there again")
                    has_changed = True
                self._tell_once("master", "")
                if has_changed:
                    self._follow()
            except LOST:
                text = (
                    f"the ROS master at {self._master.address} doesn't answer: goals under way go on, "
                    f"new clients can't find this node. It registers again when there is one"
                )
                self._tell_once("master", text)

    def _follow(self) -> None:
        """Publish the robot's description and the drawings of its cell and its planned motion once more."""
        works = {"robot_description": self._describe, "scene": self._draw_scene, "ghost": self._draw_ghost}
        for what, work in works.items():
            try:
                work()
                self._tell_once(what, "")
            except (*_FAILED, ValueError) as error:
                self._tell_once(what, f"{what} isn't up to date: {said(error)}")
            except rospy.ROSException:  # rospy is being shut down
                return

    def _tell_once(self, what: str, text: str) -> None:
        """Warn of a problem only once, when it begins."""
        if text and self._told.get(what) != text:
            self.say("warn", text)
        self._told[what] = text

    def _describe(self) -> None:
        """Set robot_description and controller_joint_names, unless another node has set them."""
        driver = self._connected()
        model = driver.model()
        urdf = str(model["urdf"])
        if urdf != self._model.get("urdf"):
            self._kinematics = None
        before, self._model = self._model.get("urdf"), model
        rospy.set_param("controller_joint_names", list(driver.joint_names))
        there = rospy.get_param("robot_description", None)
        if there in (None, before) or self._settings.set_description:
            rospy.set_param("robot_description", urdf)
        elif there != urdf:
            text = (
                "robot_description was set by somebody else, to another text than that of the robot, "
                "and is left so; _set_description:=true replaces it"
            )
            self._tell_once("description", text)

    def _draw_scene(self) -> None:
        self._draw(self._scene, scene_markers(self._connected().scene()))

    def _draw_ghost(self) -> None:
        if not self._model:
            return
        if self._kinematics is None:
            self._kinematics = Kinematics(str(self._model["urdf"]), str(self._model["base"]))
        driver = self._connected()
        course = [positions for _, positions in driver.ghost()]
        tool = str(self._model["tool"])
        self._draw(self._ghost, ghost_markers(self._kinematics, tool, driver.joint_names, course))

    def _draw(self, publisher: Any, markers: Sequence[Marker]) -> None:
        """Publish markers, unless they are unchanged."""
        if self._drawn.get(publisher) != markers:
            publisher.publish(MarkerArray(markers=[fill(MarkerMessage(), one, Point) for one in markers]))
            self._drawn[publisher] = markers


def said(error: Exception) -> str:
    """Return the reason for which an order was refused, and the remedy."""
    to_do = getattr(error, "help", "")
    return f"{error} ({to_do})" if to_do else str(error)


def _worker(work: queue.SimpleQueue[Callable[[], None] | None]) -> threading.Thread:
    """Return a thread that runs the functions of a queue until it gets None."""

    def carry_out() -> None:
        for one in iter(work.get, None):
            with contextlib.suppress(rospy.ROSException):  # rospy is being shut down
                one()

    thread = threading.Thread(target=carry_out, daemon=True)
    thread.start()
    return thread


def _registered() -> Registered:
    topics, services = registration.get_topic_manager(), registration.get_service_manager()
    return Registered(topics.get_publications(), topics.get_subscriptions(), services.get_services())


def _trigger(order: Callable[[], Tuple[bool, str]]) -> Callable[[Any], Any]:
    """Return a handler for a service. The handler gives an order and returns the reply."""

    def handle(_request: Any) -> Any:
        done, text = order()
        return TriggerResponse(success=done, message=text)

    return handle
