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
        "A JointTrajectory has only joints and times. Outputs, waits, stops and choices lie between the "
        "trajectories of a file, or beside one, and are written there as comments (YAML), fields (JSON) or "
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
        "Joints are keys of parameters, and the robot's name is that of a package and of topics: both "
        "begin with a letter, and have letters, digits and _ only. ROS 1 refuses other names when it loads "
        "the parameters; ROS 2 splits a name at a point, so that the joint would lose its limits.",
        '<joint name="arm-joint.1" type="revolute">',
        '<joint name="arm_joint_1" type="revolute">',
    ),
    Finding(
        "Y1535",
        "motor-limit-not-for-moveit",
        "warning",
        "a motor's speed limit depends on several joints, so MoveIt can't respect it",
        "A motor that turns with several joints may reach its limit before each of these joints does. "
        "MoveIt knows only limits of joints, so it may plan motions that the motor can't follow. "
        "yarclang refuses or slows these motions when they become a program, so no unsafe motion runs.",
    ),
    Finding(
        "Y1536",
        "not-ours-to-overwrite",
        "error",
        "an export would overwrite files that it hasn't written",
        "A list of checksums (yarc-export.json) has the files that an export has written. Other files, and "
        "files changed since, are never overwritten.",
    ),
    Finding(
        "Y1537",
        "mesh-left-out",
        "warning",
        "a mesh of the URDF isn't exported",
        "The URDF names a file that is missing or unreadable. A mesh that is only for display isn't "
        "needed for the collision check, but RViz can't show it.",
    ),
)
