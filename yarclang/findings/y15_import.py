"""Findings of family 15: files of other kinds that are converted to programs, and new projects."""

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1502",
        "header-not-understood",
        "error",
        "the table's header isn't understood",
        "Columns are identified by their names, never by their places: swapped columns would send the arm "
        "to a wrong place. Joints are named j1 j2 ... or by the robot's own names. A pose is x y z with "
        "roll pitch yaw or with qx qy qz qw.",
        "x [mm], y [mm], height",
        "x [mm], y [mm], z [mm], roll [deg], pitch [deg], yaw [deg]",
    ),
    Finding(
        "Y1503",
        "not-taken",
        "warning",
        "a part of the file isn't taken into the program",
        "A program has no place for columns that are neither targets nor times, or for named states of "
        "other joints. Everything that is left out is reported.",
    ),
    Finding(
        "Y1504",
        "table-not-readable",
        "error",
        "the table is empty, or its lines have different numbers of cells",
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
        "Text, an empty cell, NaN or infinity in the place of a coordinate is a gap in the data. Gaps "
        "aren't filled by guessing. Decimal commas are accepted only if semicolons or tabs separate the "
        "cells.",
        "j1 [deg];j2 [deg]\n10;nan",
        "j1 [deg];j2 [deg]\n10;20",
    ),
    Finding(
        "Y1506",
        "import-without-units",
        "error",
        "the unit of a column isn't given",
        "Tables have degrees or radians, millimetres or metres, and the numbers often make sense in both. "
        "Give the unit in the header, or with --units.",
        "j1,j2",
        "j1 [deg],j2 [deg]",
    ),
    Finding(
        "Y1507",
        "import-not-readable",
        "error",
        "the file isn't YAML, JSON or XML",
        "The text breaks the rules of its format. Most likely it was cut off, or its name has the extension "
        "of another format.",
    ),
    Finding(
        "Y1508",
        "import-not-plain-data",
        "error",
        "the file has more than plain data",
        "Only mappings, lists, numbers and texts are accepted. YAML aliases can make a small file grow "
        "beyond any memory, and tags can create arbitrary objects. No trajectory needs them, so both are "
        "refused. Brackets that are nested too deeply are refused, too.",
    ),
    Finding(
        "Y1509",
        "no-trajectory",
        "error",
        "the trajectory is missing or incomplete",
        "A trajectory needs joint_names and points. Each point needs a position for every joint, and a time "
        "later than that of the point before.",
    ),
    Finding(
        "Y1510",
        "import-name",
        "error",
        "a name of the file can't be declared",
        "A name must consist of the letters A to Z, digits and _, and must not begin with a digit. Words of "
        "the language can't be declared, and each name can be declared only once.",
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
        "the waypoints are denser than the controller's segments",
        "The controller runs cubic segments that can't be shorter than a minimum duration. Waypoints that "
        "are denser than these segments only add noise: fewer waypoints give the same path, and a smoother "
        "one.",
    ),
    Finding(
        "Y1513",
        "import-in-motion",
        "error",
        "the trajectory begins or ends in motion",
        "A motion of a program begins and ends at rest. A trajectory whose velocities aren't 0 at its "
        "beginning or end was most likely cut out of a longer one. The arm would have to jump to its first "
        "velocity, or stop abruptly from its last.",
    ),
    Finding(
        "Y1514",
        "import-without-times",
        "error",
        "the file has no times to keep",
        "With the times of the file, the motion would become a timetable: MOVEJ_TIMED, which passes joint "
        "positions at given times. A file without times, or with poses, can't become a timetable.",
    ),
    Finding(
        "Y1515",
        "bag-not-readable",
        "error",
        "the bag can't be read",
        "Bags of ROS are read by the Python package rosbags, which is installed with the extra `bags`. A "
        "bag that wasn't closed has no index; the tools of ROS can repair it.",
        "pip install yarclang",
        "pip install 'yarclang[bags]'",
    ),
    Finding(
        "Y1516",
        "cloud-not-readable",
        "error",
        "the point cloud can't be read",
        "Point clouds are read from PCD files (text, binary or compressed) and PLY files. Points with the "
        "coordinates NaN, where the sensor saw nothing, are left out. A file is refused if it is damaged, "
        "or if its points may be relative to another origin (VIEWPOINT), because an obstacle in the wrong "
        "place protects nobody.",
    ),
    Finding(
        "Y1517",
        "voxels-too-small",
        "error",
        "the cubes are too small for the point cloud",
        "A point cloud is divided by a grid into cubes, and each cube that contains a point becomes an "
        "obstacle. Small cubes follow the points closely, but too many cubes make the collision proof too "
        "slow. Between points that are farther apart than a cube's edge, there are holes.",
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
        "The name becomes the name of a folder and of a program, and must be valid on any system: letters A "
        "to Z, digits, _ and -, and a letter first.",
        "yarc new 2nd/cell",
        "yarc new second_cell",
    ),
)
