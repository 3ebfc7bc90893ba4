"""Message classes of FollowJointTrajectory and of ROS-Industrial for ROS 1, for systems without the packages
control_msgs and industrial_msgs.

ROS 1 identifies a type by its name and the md5 sum of its fields. Both depend only on field names and types,
so nodes with these classes can talk to nodes that were built with the packages. Debian has ROS 1 without the
packages. Noetic's own repository has both packages; on systems with them, the packages' classes are used.

Written for Python 3.8 and later.
"""

from __future__ import annotations

import hashlib
import importlib
from typing import Any, Dict, NamedTuple

_ACTION = "control_msgs/FollowJointTrajectoryAction"
_RULE = "\n" + "=" * 80 + "\n"
"""Separator between a message's text and the texts of the messages that it contains, in the format of
genpy.
"""

_TEXTS = {
    "std_msgs/Header": "uint32 seq\ntime stamp\nstring frame_id",
    "actionlib_msgs/GoalID": "time stamp\nstring id",
    "actionlib_msgs/GoalStatus": "GoalID goal_id\n"
    "uint8 status\n"
    "uint8 PENDING=0\n"
    "uint8 ACTIVE=1\n"
    "uint8 PREEMPTED=2\n"
    "uint8 SUCCEEDED=3\n"
    "uint8 ABORTED=4\n"
    "uint8 REJECTED=5\n"
    "uint8 PREEMPTING=6\n"
    "uint8 RECALLING=7\n"
    "uint8 RECALLED=8\n"
    "uint8 LOST=9\n"
    "string text",
    "trajectory_msgs/JointTrajectoryPoint": "float64[] positions\n"
    "float64[] velocities\n"
    "float64[] accelerations\n"
    "float64[] effort\n"
    "duration time_from_start",
    "trajectory_msgs/JointTrajectory": "Header header\nstring[] joint_names\nJointTrajectoryPoint[] points",
    "control_msgs/JointTolerance": "string name\nfloat64 position\nfloat64 velocity\nfloat64 acceleration",
    "control_msgs/FollowJointTrajectoryGoal": "trajectory_msgs/JointTrajectory trajectory\n"
    "JointTolerance[] path_tolerance\n"
    "JointTolerance[] goal_tolerance\n"
    "duration goal_time_tolerance",
    "control_msgs/FollowJointTrajectoryResult": "int32 error_code\n"
    "int32 SUCCESSFUL=0\n"
    "int32 INVALID_GOAL=-1\n"
    "int32 INVALID_JOINTS=-2\n"
    "int32 OLD_HEADER_TIMESTAMP=-3\n"
    "int32 PATH_TOLERANCE_VIOLATED=-4\n"
    "int32 GOAL_TOLERANCE_VIOLATED=-5\n"
    "string error_string",
    "control_msgs/FollowJointTrajectoryFeedback": "Header header\n"
    "string[] joint_names\n"
    "trajectory_msgs/JointTrajectoryPoint desired\n"
    "trajectory_msgs/JointTrajectoryPoint actual\n"
    "trajectory_msgs/JointTrajectoryPoint error",
    "control_msgs/FollowJointTrajectoryActionGoal": (
        "Header header\nactionlib_msgs/GoalID goal_id\nFollowJointTrajectoryGoal goal"
    ),
    "control_msgs/FollowJointTrajectoryActionResult": (
        "Header header\nactionlib_msgs/GoalStatus status\nFollowJointTrajectoryResult result"
    ),
    "control_msgs/FollowJointTrajectoryActionFeedback": (
        "Header header\nactionlib_msgs/GoalStatus status\nFollowJointTrajectoryFeedback feedback"
    ),
    "control_msgs/FollowJointTrajectoryAction": "FollowJointTrajectoryActionGoal action_goal\n"
    "FollowJointTrajectoryActionResult action_result\n"
    "FollowJointTrajectoryActionFeedback action_feedback",
    "industrial_msgs/TriState": "int8 val\n"
    "int8 UNKNOWN=-1\n"
    "int8 TRUE=1\n"
    "int8 ON=1\n"
    "int8 ENABLED=1\n"
    "int8 HIGH=1\n"
    "int8 CLOSED=1\n"
    "int8 FALSE=0\n"
    "int8 OFF=0\n"
    "int8 DISABLED=0\n"
    "int8 LOW=0\n"
    "int8 OPEN=0",
    "industrial_msgs/RobotMode": "int8 val\nint8 UNKNOWN=-1\nint8 MANUAL=1\nint8 AUTO=2",
    "industrial_msgs/RobotStatus": "Header header\nindustrial_msgs/RobotMode mode\nindustrial_msgs/TriState "
    "e_stopped\nindustrial_msgs/TriState drives_powered\n"
    "industrial_msgs/TriState motion_possible\nindustrial_msgs/TriState "
    "in_motion\nindustrial_msgs/TriState in_error\nint32 error_code",
    "industrial_msgs/ServiceReturnCode": "int8 val\nint8 SUCCESS=1\nint8 FAILURE=-1",
    "industrial_msgs/DeviceInfo": (
        "string model\nstring serial_number\nstring hw_version\nstring sw_version\nstring address"
    ),
    "industrial_msgs/StopMotionRequest": "",
    "industrial_msgs/StopMotionResponse": "industrial_msgs/ServiceReturnCode code",
    "industrial_msgs/CmdJointTrajectoryRequest": "trajectory_msgs/JointTrajectory trajectory",
    "industrial_msgs/CmdJointTrajectoryResponse": "industrial_msgs/ServiceReturnCode code",
    "industrial_msgs/GetRobotInfoRequest": "",
    "industrial_msgs/GetRobotInfoResponse": "industrial_msgs/DeviceInfo controller\n"
    "industrial_msgs/DeviceInfo[] robots\n"
    "industrial_msgs/ServiceReturnCode code",
}
"""Field names, types and constants of each message, which determine the md5 sums."""


class Interfaces(NamedTuple):
    """Classes of messages and services. Each has genpy's `_type` and `_md5sum`, and no static type."""

    action: Any
    """control_msgs/FollowJointTrajectoryAction."""
    feedback: Any
    """control_msgs/FollowJointTrajectoryFeedback."""
    result: Any
    """control_msgs/FollowJointTrajectoryResult."""
    tolerance: Any
    """control_msgs/JointTolerance."""
    status: Any
    """industrial_msgs/RobotStatus."""
    device: Any
    """industrial_msgs/DeviceInfo."""
    stop_motion: Any
    """industrial_msgs/StopMotion."""
    path_command: Any
    """industrial_msgs/CmdJointTrajectory."""
    robot_info: Any
    """industrial_msgs/GetRobotInfo."""


def interfaces() -> Interfaces:
    """Return the message classes of the installed packages; without the packages, classes with the same
    names and md5 sums.
    """
    found = [
        _installed("control_msgs.msg"),
        _installed("industrial_msgs.msg"),
        _installed("industrial_msgs.srv"),
    ]
    made: Any = _Made() if None in found else None
    control, messages, services = (made if one is None else one for one in found)
    return Interfaces(
        control.FollowJointTrajectoryAction,
        control.FollowJointTrajectoryFeedback,
        control.FollowJointTrajectoryResult,
        control.JointTolerance,
        messages.RobotStatus,
        messages.DeviceInfo,
        services.StopMotion,
        services.CmdJointTrajectory,
        services.GetRobotInfo,
    )


def _installed(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError:
        return None


class _Made:
    """The classes made from `_TEXTS`. Each is an attribute, named like the class but without its package."""

    def __init__(self) -> None:
        dynamic = importlib.import_module("genpy.dynamic")
        rest = [f"MSG: {name}\n{text}" for name, text in _TEXTS.items() if name != _ACTION]
        classes: Dict[str, Any] = dynamic.generate_dynamic(_ACTION, _RULE.join([_TEXTS[_ACTION], *rest]))
        sums = _md5_texts()
        for name, made in classes.items():
            setattr(self, name.split("/")[1], made)
        for request in (name for name in _TEXTS if name.endswith("Request")):
            name = request[: -len("Request")]
            setattr(self, name.split("/")[1], _service(name, classes, sums))

    def __getattr__(self, name: str) -> Any:
        raise AttributeError(f"{name} is not among the interfaces that the ROS 1 node makes by itself")


def _md5_texts() -> Dict[str, str]:
    """Return for each message, by its name, the text from which its md5 sum is computed."""
    genmsg = importlib.import_module("genmsg")
    loader, tools = importlib.import_module("genmsg.msg_loader"), importlib.import_module("genmsg.gentools")
    context = genmsg.MsgContext.create_default()
    read = {name: loader.load_msg_from_string(context, text, name) for name, text in _TEXTS.items()}
    for name, one in read.items():
        context.register(name, one)
    return {name: tools.compute_md5_text(context, one) for name, one in read.items()}


def _service(name: str, classes: Dict[str, Any], sums: Dict[str, str]) -> Any:
    """Return the class of a service. Its md5 sum is computed from the text of the request, followed by the
    text of the response.
    """
    text = sums[f"{name}Request"] + sums[f"{name}Response"]
    content = {
        "_type": name,
        "_md5sum": hashlib.md5(text.encode()).hexdigest(),
        "_request_class": classes[f"{name}Request"],
        "_response_class": classes[f"{name}Response"],
    }
    return type(name.split("/")[1], (), content)
