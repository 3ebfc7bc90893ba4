"""Family 13: what a robot's URDF describes: its chain of joints, and the shapes of its links."""

from __future__ import annotations

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1347",
        "unknown-link",
        "error",
        "there is no link of this name",
        "Joints of the URDF, and `base` and `flange` of robot.toml, must name links of the URDF. Upper and "
        "lower case matter.",
        '<child link="Link_2"/>',
        '<child link="link_2"/>',
    ),
    Finding(
        "Y1348",
        "two-parents",
        "error",
        "a link is the child of two joints",
        "An arm is a tree: each link is moved by only one joint.",
    ),
    Finding(
        "Y1349",
        "two-roots",
        "error",
        "the URDF has several roots",
        "A link without a joint above it is a root. With two roots, it isn't known where the second one is.",
    ),
    Finding(
        "Y1350",
        "joint-circle",
        "error",
        "joints form a circle",
        "No link of the circle is connected to the base, so the place of its links isn't known.",
    ),
    Finding(
        "Y1351",
        "bad-joint-type",
        "error",
        "an arm can't have a joint of this type",
        "A joint of the chain is revolute, continuous or prismatic, with one axis and its own motor, or "
        "it is fixed. A joint that mimics another one has no position of its own.",
        '<joint name="J1" type="Revolute">',
        '<joint name="J1" type="revolute">',
    ),
    Finding(
        "Y1352",
        "zero-axis",
        "error",
        "the axis of a joint has no direction",
        "An axis of length 0 has no direction; Pinocchio accepts it without an error.",
        '<axis xyz="0 0 0"/>',
        '<axis xyz="0 0 1"/>',
    ),
    Finding(
        "Y1353",
        "no-chain",
        "error",
        "no chain of moving joints connects base and flange",
        "The robot is the chain of joints from the link `base` to the link `flange`. In the URDF's tree, "
        "the base must be an ancestor of the flange.",
        'base = "flange"\nflange = "base_link"',
        'base = "base_link"\nflange = "flange"',
    ),
    Finding(
        "Y1354",
        "stray-joint",
        "error",
        "a moving joint isn't in the chain",
        "No motor of this robot moves this joint, so its position isn't known, and the collision check "
        "would be wrong.",
        'flange = "tool0"',
        'flange = "tool0"\nignored_joints = ["finger"]',
    ),
    Finding(
        "Y1355",
        "narrower-in-urdf",
        "warning",
        "the URDF's limit is narrower than robot.toml's",
        "The limits of robot.toml are used. If the limits of the URDF are the real ones, the arm would "
        "run into its end stops.",
    ),
    Finding(
        "Y1356",
        "unknown-shape",
        "error",
        "a body has no readable shape",
        "Without a readable shape, the collision check would silently ignore the body.",
        '<geometry><cone radius="0.1"/></geometry>',
        '<geometry><cylinder radius="0.1" length="0.2"/></geometry>',
    ),
    Finding(
        "Y1357",
        "missing-mesh",
        "error",
        "the file of a mesh isn't there",
        "Mesh names are relative to the folder of the URDF. A name with package:// is searched in this "
        "folder and in the folders above. `yarc robot new` also searches ROS packages (--package-path, "
        "ROS_PACKAGE_PATH, AMENT_PREFIX_PATH) and the folders of --meshes. With --allow-missing-meshes, the "
        "mesh is left out.",
    ),
    Finding(
        "Y1358",
        "capsule-version",
        "error",
        "a capsule needs URDF 1.1",
        "In a URDF of version 1.0, which is the default, readers drop a <capsule> silently: the "
        "link would have no shape.",
        '<robot name="arm">',
        '<robot name="arm" version="1.1">',
    ),
    Finding(
        "Y1359",
        "no-collision-shape",
        "warning",
        "a moving link has no collision shape",
        "The collision check ignores the link, which may pass through any body. `yarc robot new` and "
        "`yarc robot check` report this; commands that work on programs don't repeat it.",
    ),
    Finding(
        "Y1365",
        "limbs-left-out",
        "error",
        "the chain leaves out joints that have motors",
        "The chain that was found leaves out a limb as long as an arm. If another chain is the right one, "
        "name the link at its end with --tip.",
        "yarc robot new two_arms.urdf --yes",
        "yarc robot new two_arms.urdf --yes --tip left_tool0",
    ),
    Finding(
        "Y1362",
        "not-ignorable",
        "error",
        "a joint can't be ignored",
        "ignored_joints must name moving joints of the URDF that aren't between the base and the flange, "
        "such as the fingers of a gripper. No motor of this robot moves these joints, and their position is "
        "taken as 0.",
        'ignored_joints = ["fingr"]',
        'ignored_joints = ["finger"]',
    ),
)
