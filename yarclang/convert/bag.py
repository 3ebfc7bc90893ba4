"""Read trajectories from bags of ROS 1 (`.bag`) and ROS 2 (a folder, `.db3`, `.mcap`), with the package
rosbags.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from yarclang.diagnostics import Collector

if TYPE_CHECKING:
    from rosbags.highlevel import AnyReader

ENDINGS = frozenset([".bag", ".db3", ".mcap"])
"""Suffixes of bags."""

_METADATA = "metadata.yaml"
_WITH_TRAJECTORIES = (
    "trajectory_msgs/msg/JointTrajectory",
    "moveit_msgs/msg/RobotTrajectory",
    "moveit_msgs/msg/DisplayTrajectory",
    "control_msgs/msg/FollowJointTrajectoryActionGoal",
    "control_msgs/msg/JointTrajectoryActionGoal",
    "control_msgs/msg/FollowJointTrajectoryGoal",
    "moveit_msgs/msg/ExecuteTrajectoryActionGoal",
)
"""Types of messages that contain trajectories."""
_STATES = "sensor_msgs/msg/JointState"
_MOST_MESSAGES = 2_000_000
_LISTED = 8
_SECOND = 1_000_000_000
"""Number of nanoseconds in a second."""


def is_bag(path: Path) -> bool:
    """Return True if a path has the suffix of a bag, or is the folder of a bag."""
    return path.suffix.lower() in ENDINGS or (path / _METADATA).is_file()


def read_bag(path: Path, topic: str | None, findings: Collector) -> list[Any] | None:
    """Read the messages of a bag that contain trajectories, as plain data, in the order of their recording.

    Args:
        path: the bag.
        topic: the only topic to read; None for all topics with trajectories.
        findings: collects findings.

    Returns:
        The messages; None, with a finding, if the bag can't be read or has no trajectory.
    """
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ModuleNotFoundError as error:
        message = f"reading bags needs the package rosbags, which isn't installed ({error})"
        help_ = (
            "pip install 'yarclang[bags]'; or print the trajectory: ros2 topic echo --full-length TOPIC "
            "> path.yaml"
        )
        findings.add("Y1515", message, None, help_)
        return None
    place = path.parent if path.suffix.lower() in {".db3", ".mcap"} and _is_part(path) else path
    if not place.exists():
        findings.add("Y0107", f"{path} can't be read: no such file or directory", None, "check the path")
        return None
    try:
        with AnyReader([place], default_typestore=get_typestore(Stores.LATEST)) as reader:
            return _documents(reader, topic, findings)
    except Exception as error:  # for a damaged bag, the package raises errors of any kind
        reason = str(error).splitlines()[0][:200] if str(error) else type(error).__name__
        message = f"{path.name} can't be read as a bag: {reason}"
        findings.add(
            "Y1515",
            message,
            None,
            "repair or convert it with the tools of ROS; or check which file was given",
        )
        return None


def _is_part(path: Path) -> bool:
    """Return True if a file belongs to a bag that is a folder."""
    return (path.parent / _METADATA).is_file()


def _documents(reader: AnyReader, topic: str | None, findings: Collector) -> list[Any] | None:
    found = {one.topic: one.msgtype for one in reader.connections}
    listed = ", ".join(f"{name} ({kind})" for name, kind in sorted(found.items())[:_LISTED])
    more = f" and {len(found) - _LISTED} more" if len(found) > _LISTED else ""
    if topic is not None and topic not in found:
        message = f"the bag has no topic {topic}"
        findings.add("Y1515", message, None, f"it has {listed or 'none'}{more}")
        return None
    wanted = [
        one
        for one in reader.connections
        if (one.topic == topic if topic is not None else one.msgtype in _WITH_TRAJECTORIES)
    ]
    states = {one.msgtype for one in wanted} == {_STATES}
    if not wanted:
        message = "the bag has no message with a trajectory"
        help_ = f"it has {listed or 'no topic'}{more}; --topic NAME takes a recording of joint states"
        findings.add("Y1515", message, None, help_)
        return None
    messages: list[tuple[int, Any]] = []
    for connection, stamp, raw in reader.messages(connections=wanted):
        if len(messages) == _MOST_MESSAGES:
            message = f"the topic has more than {_MOST_MESSAGES:,} messages"
            findings.add(
                "Y1515", message, None, "cut the bag to the needed topics: ros2 bag convert, rosbag filter"
            )
            return None
        messages.append((stamp, reader.deserialize(raw, connection.msgtype)))
    if states:
        return _recording(messages, findings)
    return [plain(message) for _, message in messages]


def _recording(messages: list[tuple[int, Any]], findings: Collector) -> list[Any] | None:
    """Return recorded joint states as one trajectory; None, with a finding, if the states have different
    joints. The times of the trajectory are those in the message headers, counted from the first message.
    """
    names = [list(one.name) for _, one in messages]
    if any(one != names[0] for one in names):
        message = "the joint states don't all have the same joints in the same order"
        findings.add("Y1515", message, None, "record the joint states of the arm alone")
        return None
    stamps = np.array([_nanoseconds(one, stamp) for stamp, one in messages], dtype=np.int64)
    later = np.concatenate(([True], np.diff(stamps) > 0))  # a state that was sent twice counts once
    has_rates = all(len(one.velocity) == len(one.position) for _, one in messages)
    points = [
        {
            "positions": one.position.tolist(),
            "velocities": one.velocity.tolist() if has_rates else [],
            "time_from_start": dict(zip(("sec", "nanosec"), divmod(int(since), _SECOND), strict=True)),
        }
        for (_, one), since, is_later in zip(messages, stamps - stamps[0], later, strict=True)
        if is_later
    ]
    return [{"joint_names": names[0], "points": points}]


def _nanoseconds(message: Any, received: int) -> int:
    """Return the time in a message's header [ns]; the time of its recording if the header has no time."""
    stamp = message.header.stamp
    sent = int(stamp.sec) * _SECOND + int(stamp.nanosec)
    return sent or received


def plain(message: Any) -> Any:
    """Return a ROS message as plain data: mappings, lists, numbers and texts."""
    if is_dataclass(message) and not isinstance(message, type):
        return dict(_entries(message))
    if isinstance(message, np.ndarray):
        return message.tolist()
    if isinstance(message, (list, tuple)):
        return [plain(one) for one in message]
    if isinstance(message, Mapping):
        return {str(key): plain(value) for key, value in message.items()}
    return message


def _entries(message: Any) -> Iterator[tuple[str, Any]]:
    for one in fields(message):
        if not one.name.startswith("__"):
            yield one.name, plain(getattr(message, one.name))
