"""Findings of family 15: files of other kinds that are converted to programs, and new projects."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1502",
        "header-not-understood",
        "error",
        "the table's header isn't understood",
        "Columns are known by their names, never by their places: swapped columns would send the arm to a "
        "wrong place. Joints are j1 j2 ... or the robot's own names; a pose is x y z with roll pitch yaw "
        "or qx qy qz qw.",
        "x [mm], y [mm], height",
        "x [mm], y [mm], z [mm], roll [deg], pitch [deg], yaw [deg]",
    ),
    Finding(
        "Y1503",
        "not-taken",
        "warning",
        "a part of the file isn't taken into the program",
        "Columns that are neither targets nor times, and named states of other joints, have no place in a "
        "program. Everything that is left out is reported.",
    ),
    Finding(
        "Y1504",
        "table-not-readable",
        "error",
        "the table is empty or its lines don't fit together",
        "Every line has one cell for each column of the header. With a missing cell, the values "
        "after it would belong to the wrong joints.",
        "j1 [deg],j2 [deg]\n10",
        "j1 [deg],j2 [deg]\n10,20",
    ),
    Finding(
        "Y1505",
        "import-not-a-number",
        "error",
        "a value of the file isn't a finite number",
        "Text, an empty cell, NaN or infinity in the place of a coordinate is a gap in the data, and gaps "
        "aren't filled by guessing. A decimal comma is read if semicolons or tabs divide the cells.",
        "j1 [deg];j2 [deg]\n10;nan",
        "j1 [deg];j2 [deg]\n10;20",
    ),
    Finding(
        "Y1506",
        "import-without-units",
        "error",
        "the unit of a column isn't given",
        "Tables have degrees or radians, millimetres or metres, and the numbers often make sense in both. "
        "The header gives the unit, or --units does.",
        "j1,j2",
        "j1 [deg],j2 [deg]",
    ),
    Finding(
        "Y1507",
        "import-not-readable",
        "error",
        "the file isn't YAML, JSON or XML",
        "The text breaks the rules of its own kind: most likely it was cut off, or is another kind of file "
        "than its name says.",
    ),
    Finding(
        "Y1508",
        "import-not-plain-data",
        "error",
        "the file has more than plain data",
        "Aliases can make a small file grow beyond any memory, and tags create objects of programs. No "
        "trajectory needs them, so both are refused.",
    ),
    Finding(
        "Y1509",
        "no-trajectory",
        "error",
        "the trajectory is missing or incomplete",
        "A trajectory has joint_names and points, each with a position for every joint and a time later "
        "than the one before.",
    ),
    Finding(
        "Y1510",
        "import-name",
        "error",
        "a name of the file can't be declared",
        "Names have letters A to Z, digits and _, and no digit first; words of the language can't be "
        "declared, and each name is declared once.",
    ),
    Finding(
        "Y1511",
        "other-joints",
        "error",
        "the file's joints aren't those of the robot",
        "Joints are matched by their names, in any order. A file with a missing or an additional joint is "
        "for another arm.",
    ),
    Finding(
        "Y1512",
        "too-dense",
        "warning",
        "the way-points are denser than the controller's segments",
        "The controller runs cubic pieces that have a shortest duration. Denser way-points only add "
        "noise: fewer of them give the same path, and a smoother one.",
    ),
    Finding(
        "Y1513",
        "import-in-motion",
        "error",
        "the trajectory begins or ends in motion",
        "A motion of a program begins and ends at rest. A trajectory whose velocities aren't 0 at its "
        "beginning or at its end was cut out of a longer one; the arm would have to jump to that velocity.",
    ),
    Finding(
        "Y1514",
        "import-without-times",
        "error",
        "the file has no times to keep",
        "MOVEJ_TIMED passes joint positions at given times. A file without times, or with poses, can't "
        "become such a timetable.",
    ),
    Finding(
        "Y1515",
        "bag-not-readable",
        "error",
        "the bag can't be read",
        "Bags of ROS are read by the Python package rosbags, which is installed with the extra `bags`. A "
        "bag that wasn't closed has no index, and can be repaired with the tools of ROS.",
        "pip install yarclang",
        "pip install 'yarclang[bags]'",
    ),
    Finding(
        "Y1516",
        "cloud-not-readable",
        "error",
        "the point cloud can't be read",
        "Point clouds are read from PCD files (text, binary or compressed) and PLY files. Points that "
        "aren't numbers (the sensor saw nothing) are left out. A file that is damaged, or whose points may "
        "have another origin (VIEWPOINT), is refused: an obstacle in the wrong place protects nobody.",
    ),
    Finding(
        "Y1517",
        "voxels-too-small",
        "error",
        "the cubes are too small for the point cloud",
        "A point cloud becomes the cubes of a grid that contain a point. Small cubes follow the points "
        "closely, but too many of them make the collision proof too slow. Between points that are "
        "farther apart than a cube's edge there are holes.",
        "yarc import hall.pcd --units m --voxel 0.1",
        "yarc import hall.pcd --units m --voxel 50",
    ),
    Finding(
        "Y1521",
        "folder-in-use",
        "error",
        "the new project's folder isn't empty",
        "A new project would mix with the files that are there, or overwrite them.",
    ),
    Finding(
        "Y1522",
        "project-name",
        "error",
        "the new project's name can't be used",
        "The name becomes that of a folder and of a program, on any system: letters A to Z, digits, _ and "
        "-, a letter first.",
        "yarc new 2nd/cell",
        "yarc new second_cell",
    ),
)
