"""The ROS 2 node: MoveIt moves the robot that `yarc serve` owns.

    yarc serve --robot industrial6
    source /opt/ros/jazzy/setup.bash
    /usr/bin/python3 -m yarclang.ros.node.ros2 --ros-args -p robot:=industrial6

Parameters:

    robot            which robot: its name, the name or number of the process that owns it, or the path of its
                     socket; needed if there are several
    action           name of the action: joint_trajectory_controller/follow_joint_trajectory
    hold_on_cancel   hold a cancelled goal at once (true), or finish it (false)
    override         override at the start [%]; 0 to leave it

docs/ros2.md of yarclang describes the topics, services and rules. Written for Python 3.8 and later; it needs
rclpy, control_msgs and ROS's usual messages, and nothing else.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import traceback
from typing import Any, List

from yarclang.client import Refused

NAME = "yarc_driver"

END_TIME = 2.0
"""Longest wait for the executor's remaining work when the node ends [s]."""

_HEARD_WITHIN = 0.1
"""Time between two checks of the main thread for a signal that another thread has received [s]."""


def main(arguments: List[str] | None = None) -> int:
    """Run the node until SIGINT or SIGTERM.

    Args:
        arguments: the program's name, then ROS's (`--ros-args`); None for those of the process.

    Returns:
        The exit status: 0; 1 if the robot or a parameter is refused, or the node has failed; 2 if a package
            is missing.
    """
    given = sys.argv if arguments is None else arguments
    if {"-h", "--help"} & set(given[1:]):
        sys.stdout.write(__doc__ or "")
        return 0
    over = threading.Event()
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, _ender(over))
    try:
        import rclpy
        from rclpy.executors import SingleThreadedExecutor
        from rclpy.signals import SignalHandlerOptions

        from yarclang.ros.node.ros2_shell import Node, said
    except ImportError as missing:
        sys.stderr.write(what_is_missing(missing, os.environ.get("ROS_DISTRO")))
        return 2
    try:
        # rclpy's own handlers would end the context before the robot rests.
        rclpy.init(args=given, signal_handler_options=SignalHandlerOptions.NO)
        node = rclpy.create_node(NAME)
    except Exception as error:  # rcl's exceptions for invalid arguments have no common class
        sys.stderr.write(f"yarc_ros2: ROS refuses the arguments: {error}\n")
        return 1
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    try:
        status = _served(Node(node, executor), executor, over, node.get_logger())
    except (ValueError, Refused) as error:
        node.get_logger().fatal(said(error))
        status = 1
    node.destroy_node()
    rclpy.try_shutdown()
    return status


def _served(shell: Any, executor: Any, over: threading.Event, log: Any) -> int:
    """Serve until `over` is set, bring the robot to rest, and return the exit status."""
    failed = threading.Event()

    def spin() -> None:
        try:
            executor.spin()
        except Exception:
            log.fatal(f"the node has failed, please report this:\n{traceback.format_exc()}")
            failed.set()
        over.set()

    spinning = threading.Thread(target=spin, name="executor", daemon=True)
    spinning.start()
    try:
        if shell.connect(over):
            shell.offer()
            while not over.wait(_HEARD_WITHIN):
                pass
            log.info("the node ends; if it moves the robot, the robot comes to rest on its path")
    finally:
        shell.close(END_TIME)
        executor.shutdown(timeout_sec=END_TIME)
        # A thread that is inside rclpy when Python ends would abort the process.
        spinning.join(END_TIME)
    return int(failed.is_set())


def _ender(over: threading.Event) -> Any:
    def end(_number: int, _frame: Any) -> None:
        # Ignore further signals: launch and a terminal may both send one, and a signal that comes during
        # `set` would wait for its lock forever. The end of the node has time limits of its own.
        for one in (signal.SIGINT, signal.SIGTERM):
            signal.signal(one, signal.SIG_IGN)
        over.set()

    return end


def what_is_missing(error: ImportError, distribution: str | None) -> str:
    """Return a line that names the package that can't be imported, and how to install it.

    Args:
        error: error of the import.
        distribution: name of the ROS distribution, such as `jazzy`; None if no setup.bash of a distribution
            was sourced.
    """
    package = (error.name or "rclpy").partition(".")[0]
    if distribution is None:
        to_do = "source /opt/ros/DISTRIBUTION/setup.bash first, and use the Python that it is for"
    else:
        to_do = (
            f"apt install ros-{distribution}-{package.replace('_', '-')}, and source "
            f"/opt/ros/{distribution}/setup.bash"
        )
    return f"yarc_ros2: {package} can't be imported ({error}): {to_do}\n"


if __name__ == "__main__":
    sys.exit(main())
