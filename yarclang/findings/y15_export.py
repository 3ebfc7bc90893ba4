"""Findings of family 15: programs and robots that are exported to other tools."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1531",
        "nothing-to-export",
        "error",
        "the program has no motion to export",
        "A trajectory consists of motions. This program has only outputs, waits and stops.",
        "P0010 SET GRIPPER ON",
        "P0010 MOVEJ 10 -10 -20 0 -60 0\nP0020 SET GRIPPER ON",
    ),
    Finding(
        "Y1532",
        "not-in-trajectory",
        "warning",
        "the program has actions that a trajectory can't contain",
        "A JointTrajectory has only joints and times. Outputs, waits, stops and branches happen between the "
        "exported trajectories or during one. The file contains them as comments (YAML), fields (JSON) or "
        "messages (bag). A client that sends only the trajectories skips them: the gripper stays open, the "
        "arm doesn't wait.",
    ),
    Finding(
        "Y1533",
        "bag-not-writable",
        "error",
        "a bag can't be written without the package rosbags",
        "Bags of ROS are written by the Python package rosbags, which is installed with the extra `bags`. "
        "YAML and JSON need no further package.",
        "pip install yarclang",
        "pip install 'yarclang[bags]'",
    ),
    Finding(
        "Y1534",
        "name-not-for-ros",
        "error",
        "a name can't be used in ROS",
        "Names of joints are keys of ROS parameters, and the robot's name is also that of a package and of "
        "topics. Such a name must begin with a letter, and consist of letters, digits and _. ROS 1 refuses "
        "other names when it loads the parameters. ROS 2 splits a name at a dot, so the joint would lose "
        "its limits.",
        '<joint name="arm-joint.1" type="revolute">',
        '<joint name="arm_joint_1" type="revolute">',
    ),
    Finding(
        "Y1535",
        "motor-limit-not-for-moveit",
        "warning",
        "a motor's speed limit depends on several joints, so MoveIt can't respect it",
        "If a motor turns with several joints, it may reach its speed limit before any of these joints "
        "does. MoveIt knows only limits of joints, so it may plan motions that the motor can't follow. "
        "yarclang refuses or slows such motions when they become a program, so they aren't executed as "
        "planned by MoveIt.",
    ),
    Finding(
        "Y1536",
        "not-ours-to-overwrite",
        "error",
        "an export would overwrite files that it hasn't written",
        "yarc-export.json lists the files that an export has written, with their checksums. Other files, "
        "and files that were changed since, are never overwritten.",
    ),
    Finding(
        "Y1537",
        "mesh-left-out",
        "warning",
        "a mesh of the URDF isn't exported",
        "The URDF names a mesh file that is missing or unreadable. If the mesh is only for display, the "
        "collision check doesn't need it, but RViz can't show it.",
    ),
)
