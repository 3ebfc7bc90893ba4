"""Family 15: files of other kinds that become programs, and new projects."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1502",
        "header-not-understood",
        "error",
        "the table's header isn't understood",
        "Columns are known by their names, never by their places: two columns that change places unnoticed would send the arm "
        "somewhere else. Joints are j1 j2 ... or the robot's own names; a pose is x y z with roll pitch yaw or qx qy qz qw.",
        "x [mm], y [mm], height",
        "x [mm], y [mm], z [mm], roll [deg], pitch [deg], yaw [deg]",
    ),
    Finding(
        "Y1503",
        "not-taken",
        "warning",
        "a part of the file isn't taken into the program",
        "Columns that are neither targets nor times, and named states of other joints, have no place in a program. What is left "
        "out is told, so that nobody believes it is there.",
    ),
    Finding(
        "Y1504",
        "table-not-readable",
        "error",
        "the table is empty or its lines don't fit together",
        "Every line has one cell for each column of the header. Where cells are missing, nobody knows which, and the values "
        "behind them would belong to other joints.",
        "j1 [deg],j2 [deg]\n10",
        "j1 [deg],j2 [deg]\n10,20",
    ),
    Finding(
        "Y1505",
        "import-not-a-number",
        "error",
        "a value of the file is no finite number",
        "Text, an empty cell, NaN or infinity in the place of a coordinate is a gap in the data, and no gap is filled with a guess. "
        "A decimal comma is read where semicolons or tabs divide the cells.",
        "j1 [deg];j2 [deg]\n10;nan",
        "j1 [deg];j2 [deg]\n10;20",
    ),
    Finding(
        "Y1506",
        "import-without-units",
        "error",
        "it isn't said in which units a column is",
        "Tables have degrees or radians, millimetres or metres, and the numbers often make sense in both. The header says it, "
        "or --units does.",
        "j1,j2",
        "j1 [deg],j2 [deg]",
    ),
    Finding(
        "Y1507",
        "import-not-readable",
        "error",
        "the file isn't YAML, JSON or XML",
        "The text breaks the rules of its own kind: most likely it was cut off, or is another kind of file than its name says.",
    ),
    Finding(
        "Y1508",
        "import-not-plain-data",
        "error",
        "the file has more than plain data",
        "Aliases repeat parts of a file and can make a small one grow beyond any memory; tags ask for objects of programs. No "
        "trajectory needs them, so they are refused.",
    ),
    Finding(
        "Y1509",
        "no-trajectory",
        "error",
        "the trajectory isn't there, or isn't whole",
        "A trajectory has joint_names and points, each with a position for every joint and a time later than the one before.",
    ),
    Finding(
        "Y1510",
        "import-name",
        "error",
        "a name of the file can't be declared",
        "Names have letters A to Z, digits and _, and no digit first; words of the language can't be declared, and one name is "
        "one place.",
    ),
    Finding(
        "Y1511",
        "other-joints",
        "error",
        "the file's joints aren't those of the robot",
        "Joints are matched by their names, in whatever order they stand. With one too few or too many, the file is for another "
        "arm, and its values would mean other motions.",
    ),
    Finding(
        "Y1512",
        "too-dense",
        "warning",
        "the way-points are denser than the controller's segments",
        "The controller runs cubic pieces that have a shortest duration. Way-points that follow each other quicker add only their "
        "noise: fewer of them give the same way, and smoother.",
    ),
    Finding(
        "Y1513",
        "import-in-motion",
        "error",
        "the trajectory begins or ends in motion",
        "A motion of a program begins and ends at rest. A trajectory whose velocities aren't 0 at its beginning or at its end was cut out of a longer one, and the arm can't stand where it moves.",
    ),
    Finding(
        "Y1514",
        "import-without-times",
        "error",
        "there are no times that could be kept",
        "MOVEJ_TIMED passes joint positions at their times. A file without times, and one of poses, gives no such timetable.",
    ),
    Finding(
        "Y1515",
        "bag-not-readable",
        "error",
        "the bag can't be read",
        "Bags of ROS are read by the Python package rosbags, which is installed with the extra `bags`. A bag that wasn't closed has no index, and can be repaired with the tools of ROS.",
        "pip install yarclang",
        "pip install 'yarclang[bags]'",
    ),
    Finding(
        "Y1516",
        "cloud-not-readable",
        "error",
        "the point cloud can't be read",
        "Point clouds are read from PCD files (text, binary or compressed) and PLY files. Points that are no numbers, where a sensor has seen nothing, are left out; a file that is damaged, or whose points "
        "may count from elsewhere (VIEWPOINT), isn't guessed at: an obstacle in the wrong place protects nobody.",
    ),
    Finding(
        "Y1517",
        "voxels-too-small",
        "error",
        "the cubes are too small for the point cloud",
        "A point cloud becomes the cubes of a grid that have a point inside. Small cubes follow it closely, but there are more of them than a proof of collisions can look at in reasonable time; "
        "and between points that are farther apart than an edge there are holes.",
        "yarc import hall.pcd --units m --voxel 0.1",
        "yarc import hall.pcd --units m --voxel 50",
    ),
    Finding(
        "Y1521",
        "folder-in-use",
        "error",
        "the new project's folder has something in it",
        "A new project would mix with the files that are there, or overwrite them.",
    ),
    Finding(
        "Y1522",
        "project-name",
        "error",
        "the new project's name can't be used",
        "The name becomes that of a folder and of a program, on any system: letters A to Z, digits, _ and -, a letter first.",
        "yarc new 2nd/cell",
        "yarc new second_cell",
    ),
)
