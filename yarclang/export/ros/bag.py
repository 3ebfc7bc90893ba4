"""Write trajectories as a bag of ROS 1."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from yarclang.export.ros.exported import Exported
from yarclang.export.ros.writing import SECOND, between_json, facts
from yarclang.progress import go_on

TOPIC = "/joint_path_command"
"""Topic to which ROS-Industrial's drivers listen."""
ABOUT, BETWEEN = "/yarc/about", "/yarc/between"


def write_bag(path: Path, made: Exported) -> None:
    """Write trajectories as a bag of ROS 1.

    The topic `TOPIC` has the trajectories. Their time stamps assume that waits between the trajectories take
    no time. The topics `ABOUT` (origin and proof of the trajectories) and `BETWEEN` (events between them)
    have JSON texts.

    Args:
        path: a file that doesn't exist yet.
        made: the trajectories.

    Raises:
        ImportError: if the package rosbags isn't installed.
        OSError: if the file can't be written.
    """
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS1_NOETIC)
    types = store.types
    time_type, header_type = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
    trajectory_type = types["trajectory_msgs/msg/JointTrajectory"]
    point_type, duration_type = (
        types["trajectory_msgs/msg/JointTrajectoryPoint"],
        types["builtin_interfaces/msg/Duration"],
    )
    string_type = types["std_msgs/msg/String"]
    none = np.zeros(0)
    with Writer(path) as writer:
        on = {
            topic: writer.add_connection(topic, kind.__msgtype__, typestore=store)
            for topic, kind in ((ABOUT, string_type), (BETWEEN, string_type), (TOPIC, trajectory_type))
        }

        def put(topic: str, stamp: int, message: object) -> None:
            connection = on[topic]
            writer.write(connection, stamp, store.serialize_ros1(message, connection.msgtype))

        def say(topic: str, stamp: int, what: object) -> None:
            put(topic, stamp, string_type(data=json.dumps(what)))

        say(ABOUT, _stamp(0.0) // 2, facts(made))
        end = _stamp(0.0)
        for at in range(made.size):
            go_on()
            start, points, before = _stamp(made.starts[at]), made.trajectory(at), made.before(at)
            for stamp, one in enumerate(before, min(end, start - len(before))):
                say(BETWEEN, stamp, between_json(one))
            rows = zip(points.x, points.v, points.a, points.time.tolist(), strict=True)
            message = trajectory_type(
                header=header_type(seq=at, stamp=time_type(sec=0, nanosec=0), frame_id=""),
                joint_names=list(made.robot.joint_names),
                points=[
                    point_type(
                        positions=x,
                        velocities=v,
                        accelerations=a,
                        effort=none,
                        time_from_start=duration_type(sec=time // SECOND, nanosec=time % SECOND),
                    )
                    for x, v, a, time in rows
                ],
            )
            put(TOPIC, start, message)
            for one in made.during(at):
                say(BETWEEN, start + round((one.time or 0.0) * SECOND), between_json(one))
            end = start + int(points.time[-1])
        for stamp, one in enumerate(made.before(made.size), end):
            say(BETWEEN, stamp, between_json(one))


def _stamp(time: float) -> int:
    """Return the time stamp [ns] in the bag for `time` [s] after the start of the program.

    The start has the time stamp 1 s, because the time stamp 0 means "not known" in ROS.
    """
    return SECOND + round(time * SECOND)
