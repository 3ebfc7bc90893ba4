"""Family 15: programs and robots that are exported to other tools."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1531",
        "nothing-to-export",
        "error",
        "the program has no motion to export",
        "A trajectory is a motion. Outputs, waits and stops alone make none.",
        "P0010 SET GRIPPER ON",
        "P0010 MOVEJ 10 -10 -20 0 -60 0\nP0020 SET GRIPPER ON",
    ),
    Finding(
        "Y1532",
        "not-in-trajectory",
        "warning",
        "the program does things that a trajectory can't say",
        "A JointTrajectory has joints and times, and nothing else. Outputs, waits, stops and choices lie between the trajectories of a file, or beside one, and are "
        "written there as comments (YAML), fields (JSON) or messages (bag). Whoever sends only the trajectories leaves them out: the gripper stays open, the arm doesn't wait.",
    ),
    Finding(
        "Y1533",
        "bag-not-writable",
        "error",
        "a bag can't be written without the package rosbags",
        "Bags of ROS are written by the Python package rosbags, which is installed with the extra `bags`. YAML and JSON need nothing more.",
        "pip install yarclang",
        "pip install 'yarclang[bags]'",
    ),
    Finding(
        "Y1534",
        "name-not-for-ros",
        "error",
        "a name can't be used in ROS",
        "Joints are keys of parameters, and the robot's name is that of a package and of topics: both begin with a letter, and have letters, digits and _ only. ROS 1 refuses other names when the "
        "parameters are loaded, and in ROS 2 a point divides a name in two, so that its limits would be those of no joint.",
        '<joint name="arm-joint.1" type="revolute">',
        '<joint name="arm_joint_1" type="revolute">',
    ),
    Finding(
        "Y1535",
        "motor-limit-not-for-moveit",
        "warning",
        "a motor's speed limit is none of one joint, so MoveIt can't keep it",
        "A motor that turns with several joints may reach its limit before each of these joints does. MoveIt knows limits of joints alone, so it may plan motions that the motor can't follow. They are refused, or made slower, where they "
        "become a program; nothing unsafe runs.",
    ),
    Finding(
        "Y1536",
        "not-ours-to-overwrite",
        "error",
        "the files that an export would write are there, and aren't its own",
        "An export knows by a list of checksums (yarc-export.json) which files it has written. Others, and those that were changed since, are somebody's work.",
    ),
    Finding(
        "Y1537",
        "mesh-left-out",
        "warning",
        "a mesh of the URDF isn't exported",
        "The URDF names a file that isn't there, or can't be read. The robot is checked without it if only its picture needs it, but RViz can't show it.",
    ),
)
