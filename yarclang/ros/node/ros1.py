"""The ROS 1 node: MoveIt moves the robot that `yarc serve` owns.

    yarc serve --robot industrial6
    /usr/bin/python3 -m yarclang.ros.node.ros1

Private parameters, as `_robot:=industrial6` on the command line or in a launch file:

    ~robot            which robot: its name, the name or number of the process that owns it, or the path of
                      its socket; needed if there are several
    ~action           name of the action: joint_trajectory_action
    ~hold_on_cancel   hold a cancelled goal at once (true), or finish it (false)
    ~override         override at the start [%]
    ~set_description  replace a different robot_description (default: false)

docs/ros.md of yarclang describes the topics, services and rules. Written for Python 3.8 and later; it needs
rospy, actionlib and ROS's usual messages, and nothing else.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from typing import Any

from yarclang.client import Refused
from yarclang.ros.node.master import Master

NAME = "yarc_driver"
_MISSING = (
    "{missing}: the ROS 1 node needs rospy. Source ROS's setup.bash first, or on Debian: apt install "
    "python3-rospy python3-actionlib python3-sensor-msgs python3-trajectory-msgs "
    "python3-visualization-msgs python3-std-srvs; and run it with the system's own Python, which has "
    "them: /usr/bin/python3\n"
)
_NO_MASTER = (
    "there is no ROS master at {address}: start roscore, or set ROS_MASTER_URI to where it is. Waiting "
    "for it\n"
)


def main() -> int:
    """Run the node until it is ended; return the exit status."""
    if {"-h", "--help"} & set(sys.argv[1:]):
        sys.stdout.write(__doc__ or "")
        return 0
    try:
        import rosgraph
        import rospy

        from yarclang.ros.node.ros1_shell import Node, said, settings
    except ImportError as missing:
        sys.stderr.write(_MISSING.format(missing=missing))
        return 1
    over = threading.Event()
    try:
        _wait_for(Master(rosgraph.get_master_uri(), NAME), over)
        rospy.init_node(NAME, disable_signals=True)
    except KeyboardInterrupt:  # before the node has started
        return 0
    for one in (signal.SIGINT, signal.SIGTERM):
        signal.signal(one, _ender(over))
    try:
        node = Node(settings())
        if node.connect(over):
            node.offer()
            while not over.wait(0.2) and not rospy.is_shutdown():
                pass
        if not node.close():
            os._exit(0)  # a normal exit would wait for rospy
    except (ValueError, Refused) as error:
        rospy.logfatal("%s", said(error))
        return 1
    return 0


def _wait_for(master: Master, over: threading.Event) -> None:
    """Wait until there is a master. rospy would also wait, but without a message."""
    told = False
    while not master.answers():
        if not told:
            sys.stderr.write(_NO_MASTER.format(address=master.address))
        told = True
        over.wait(1.0)


def _ender(over: threading.Event) -> Any:
    def end(_number: int, _frame: Any) -> None:
        over.set()
        for one in (signal.SIGINT, signal.SIGTERM):  # a second signal ends the process at once
            signal.signal(one, signal.SIG_DFL)

    return end


if __name__ == "__main__":
    sys.exit(main())
