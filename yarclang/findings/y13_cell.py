"""Family 13, third part: a cell.toml, which describes the robot's surroundings. Findings that it shares with
a robot.toml are in y13_robot.py.
"""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y1370",
        "two-orientations",
        "error",
        "an entry has two orientations",
        "Roll, pitch and yaw (rpy) and a quaternion (quat) are two forms of one orientation. If both were "
        "accepted, one of them would be ignored.",
        "rpy = [0, 0, 90]\nquat = [0, 0, 0.7071, 0.7071]",
        "rpy = [0, 0, 90]",
    ),
    Finding(
        "Y1371",
        "moving-zone",
        "error",
        "a zone is attached to a frame that the robot carries",
        "A zone is a fixed region of the cell. Declare a body that the robot carries under [[obstacles]], "
        "with the frame FLANGE.",
        "[[zones]]\n"
        'name = "BENCH"\n'
        'rule = "forbidden"\n'
        'shape = "box"\n'
        'frame = "FLANGE"\n'
        "size = [600, 400, 300]",
        '[[zones]]\nname = "BENCH"\nrule = "forbidden"\nshape = "box"\nframe = "B"\nsize = [600, 400, 300]',
    ),
    Finding(
        "Y1372",
        "no-such-joint",
        "error",
        "the robot has no such joint",
        "A joint window names joints of the program's robot. Without the joint, the window would have no "
        "effect.",
        "joints = { A1 = [-90, 90] }",
        "joints = { J1 = [-90, 90] }",
    ),
    Finding(
        "Y1373",
        "two-cells",
        "error",
        "different cells are named for one robot",
        "A robot is in one cell: with two cells, it would avoid the obstacles of only one of them. A CELL "
        "line, --cell and `cell` in yarc.toml each name the cell; if several of them are given, all must "
        "name the same file. A module with a CELL line can be used only by programs with the same cell.",
        'CELL "left.toml"\nUSE CLAMP      ! whose file has CELL "right.toml"',
        'CELL "left.toml"\nUSE CLAMP      ! whose file has CELL "left.toml"',
    ),
    Finding(
        "Y1374",
        "wrong-place-of-gripper",
        "error",
        "a gripper isn't attached to the robot, or a machine that removes parts is attached to it",
        "An output with `grips` closes and opens a gripper. The gripper carries parts along, so its frame "
        "must be attached to {FLANGE}. An output with `removes` starts a machine that takes parts away. Its "
        "frame must be fixed in the cell.",
        '[outputs.GRIP]\nvariable = "M1"\ngrips = "FEEDER"      # whose parent is B',
        '[outputs.GRIP]\nvariable = "M1"\ngrips = "GRIPPER"     # whose parent is FLANGE',
    ),
    Finding(
        "Y1375",
        "sensor-of-nothing",
        "error",
        "a sensor names an input or a gripper that the cell doesn't have",
        "Each sensor sets one of the cell's inputs. A vacuum sensor also names the output of the gripper "
        "that it watches.",
        '[inputs]\nPART_READY = "M11"\n\n[[sensors]]\ninput = "PART_REDY"\nkind = "vacuum"\ngripper = "GRIP"',
        "[inputs]\n"
        'PART_READY = "M11"\n'
        "\n"
        "[[sensors]]\n"
        'input = "PART_READY"\n'
        'kind = "vacuum"\n'
        'gripper = "GRIP"',
    ),
    Finding(
        "Y1376",
        "zone-too-thin",
        "error",
        "a zone is so thin that a motion could cross it undetected",
        "The proof has a tolerance of 0.01 mm at a zone's border, so a point could cross a very thin zone "
        "unnoticed. A forbidden, slow or posture zone, together with its margins on both sides, must be at "
        "least 0.1 mm thick. A joint window must be at least 0.0001 rad or m wide.",
        "[[zones]]\n"
        'name = "CURTAIN"\n'
        'rule = "forbidden"\n'
        'shape = "box"\n'
        'frame = "B"\n'
        "size = [2000, 0.01, 2000]",
        "[[zones]]\n"
        'name = "CURTAIN"\n'
        'rule = "forbidden"\n'
        'shape = "box"\n'
        'frame = "B"\n'
        "size = [2000, 10, 2000]",
    ),
    Finding(
        "Y1378",
        "tool-changer",
        "error",
        "tools of a cell and its tool changer are inconsistent",
        "A tool under [[tools]] must be a tool of robot.toml that has bodies and isn't mounted there: the "
        "cell gives its place, and the program puts it on the flange. One output locks the changer "
        "(`locks_at`). This output must not have a safe value that unlocks the changer, because the tool "
        "would drop at each stop. At most one tool may be on the flange when a program starts (`on = "
        "true`). An output of a gripper may name one of these tools (`tool`), and `frames` must name frames "
        "on the flange.",
        '[outputs.LOCK]\nvariable = "M1"\nlocks_at = "ON"\nsafe = "OFF"',
        '[outputs.LOCK]\nvariable = "M1"\nlocks_at = "ON"',
    ),
    Finding(
        "Y1377",
        "allow-of-no-body",
        "error",
        "[[allow]] names a body that doesn't exist",
        "An entry under [[allow]] needs the names of two bodies. These can be links and mounted tools of "
        "the robot that have shapes, and obstacles and parts of the cell.toml. An entry with any other name "
        "would have no effect.",
        '[[allow]]\nbodies = ["GRIPER", "BOX"]\nleads_to = "STACK"',
        '[[allow]]\nbodies = ["GRIPPER", "BOX"]\nleads_to = "STACK"',
    ),
    Finding(
        "Y1379",
        "allow-nowhere",
        "error",
        "[[allow]] doesn't say on which motions",
        "An entry under [[allow]] applies to the motions to a frame of the file (leads_to), to the motions "
        "away from it (leaves), or to both. It can't apply to all motions: if two bodies overlap "
        "everywhere, correct their shapes instead.",
        '[[allow]]\nbodies = ["GRIPPER", "BOX"]',
        '[[allow]]\nbodies = ["GRIPPER", "BOX"]\nleads_to = "STACK"\nleaves = "STACK"',
    ),
)
