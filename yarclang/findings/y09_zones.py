"""Family 09, second part: zones of a cell. Y0905 reported that zones weren't watched, and is no longer
used.
"""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0906",
        "unknown-part",
        "error",
        "a zone watches a link that the robot doesn't have, or that has no shape",
        "A zone watches the tool, the elbow, the arm, or links by their names in the URDF. A link without a "
        "collision shape can't be watched. If a misspelled name were accepted, the link would not be "
        "watched.",
        'watch = ["tool", "forearm"]     # the URDF calls it link_4',
        'watch = ["tool", "link_4"]',
    ),
    Finding(
        "Y0907",
        "out-of-a-zone",
        "error",
        "the robot would leave a zone that it has to stay in",
        "The bodies that an allowed zone watches (tool, elbow, links) have to stay in it. The path that the "
        "controller executes is checked at every instant, with the zone's margin. The message names the "
        "body and the zone, when it leaves, how far, and where the robot is then.",
        "P0010 MOVEL {TCP} 0 1100 300 0 0 0 [5] (mm,deg,s) {B}     ! the zone FLOOR ends at z = 400",
        "P0010 MOVEL {TCP} 0 1100 420 0 0 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0955",
        "not-upright",
        "error",
        "the tool would tilt more than KEEP allows",
        "Inside of a KEEP ... UPRIGHT, the z axis of the frame must stay within the angle on the whole "
        "path, not only at the ends of motions. The path that the controller executes is checked at every "
        "instant. The message says how far the frame tilts, when, and where the robot is then.",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} UPRIGHT 20 (deg)\n  P0010 MOVEJ 0 0 0 0 30 0\nEND",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} UPRIGHT 40 (deg)\n  P0010 MOVEJ 0 0 0 0 30 0\nEND",
    ),
    Finding(
        "Y0956",
        "too-low",
        "error",
        "the robot would come nearer to a plane than KEEP allows",
        "Inside of a KEEP ... ABOVE, the origin of the frame must stay above the plane on the whole path, "
        "by at least the given distance.",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} ABOVE 1930 (mm)\n  P0010 MOVEJ 0 0 20 0 0 0\nEND",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} ABOVE 500 (mm)\n  P0010 MOVEJ 0 0 20 0 0 0\nEND",
    ),
    Finding(
        "Y0957",
        "out-of-sight",
        "error",
        "a point would leave the cone of a KEEP",
        "Inside of a KEEP ... FACING, the origin of a fixed frame must stay in the cone around the z axis "
        "of the carried frame. Inside of a KEEP ... SEEN, the origin of the carried frame must stay in the "
        "cone of a fixed frame. The rule holds on the whole path that the controller executes, and is "
        "checked at every instant. The message says how far the point is off the axis, when, and where the "
        "robot is then. Bodies between the two frames are ignored.",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} SEEN 10 (deg)\n  P0010 MOVEJ 0 0 0 0 30 0\nEND",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\nKEEP {TCP} SEEN 60 (deg)\n  P0010 MOVEJ 0 0 0 0 30 0\nEND",
    ),
    Finding(
        "Y0958",
        "out-of-range-of-sight",
        "error",
        "the two frames of a KEEP would come too near to each other, or too far apart",
        "A KEEP ... FACING or SEEN may give, after its angle, the smallest and the largest distance between "
        "the two frames' origins. Both limits must be kept on the whole path.",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "KEEP {TCP} SEEN 90 200 1000 (deg,mm)\n"
        "  P0010 MOVEJ 0 0 0 0 30 0\n"
        "END",
        "DEFAULT {TCP} [50%] (mm,deg,s) {B}\n"
        "KEEP {TCP} SEEN 90 200 3000 (deg,mm)\n"
        "  P0010 MOVEJ 0 0 0 0 30 0\n"
        "END",
    ),
    Finding(
        "Y0908",
        "into-a-zone",
        "error",
        "the robot would enter a zone that it has to stay out of",
        "The bodies that a forbidden zone watches have to stay out of it: a walkway, the space of another "
        "robot. The zone counts even if nothing stands in it.",
        "P0010 MOVEJ 60 0 0 0 0 0 [5] (deg,s)      ! the tool swings through WALKWAY",
        "P0010 MOVEJ 20 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0909",
        "outside-the-joint-window",
        "error",
        "joints would leave their window, or enter a forbidden one",
        'A zone with shape = "joints" narrows the robot\'s joint limits in this cell, or forbids a posture.',
        'P0010 MOVEJ 100 0 0 0 0 0 [5] (deg,s)      ! rule = "allowed", joints = { J1 = [-90, 90] }',
        "P0010 MOVEJ 80 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0910",
        "wrong-posture-in-a-zone",
        "error",
        "joints would be in the wrong posture inside of a zone",
        "A posture zone requires a joint window while a watched body is inside of the zone. For example, "
        "the elbow must be up inside of a press, or the wrist must not turn over inside of a door.",
        'P0010 MOVEJ 0 60 20 0 0 0 [5] (deg,s)      ! rule = "posture", joints = { J3 = [-90, 0] }',
        "P0010 MOVEJ 0 60 -20 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0911",
        "too-fast-in-a-zone",
        "error",
        "the controller's text is faster than a slow zone allows",
        "The planner respects slow zones: it makes the times of [MIN] and [50%] longer, and reports a fixed "
        "time that is too short as Y0912. The certificate checks the speeds again in the controller's text, "
        "and found one that is too high. The text isn't written.",
    ),
    Finding(
        "Y0912",
        "no-time-for-a-zone",
        "error",
        "a motion is too fast for a slow zone",
        "In a slow zone no watched body may exceed the zone's speed. A motion with a fixed time or speed "
        "that would exceed it is refused, and the message names the shortest time that works. Motions with "
        "[MIN] or a percentage such as [50%] are slowed automatically.",
        "P0010 MOVEL {TCP} 0 900 900 0 0 0 [1] (mm,deg,s) {B}     ! 400 mm through a zone of 250 mm/s",
        "P0010 MOVEL {TCP} 0 900 900 0 0 0 [MIN] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0913",
        "impossible-zone",
        "error",
        "no motion can respect a zone",
        "Every motion would be refused, for one of these reasons: the margin of a zone is larger than the "
        "zone, two allowed zones don't overlap, an allowed zone lies inside of a forbidden one, or a joint "
        "window is outside of the joint's limits.",
        "[[zones]]\n"
        'name = "INSIDE"\n'
        'rule = "allowed"\n'
        'shape = "sphere"\n'
        'frame = "B"\n'
        "radius = 50\n"
        "margin = 80",
        "[[zones]]\n"
        'name = "INSIDE"\n'
        'rule = "allowed"\n'
        'shape = "sphere"\n'
        'frame = "B"\n'
        "radius = 500\n"
        "margin = 80",
    ),
    Finding(
        "Y0914",
        "home-breaks-a-zone",
        "warning",
        "the robot's HOME breaks a zone",
        "A program without a START line begins in HOME, so its first motion would be refused. This is "
        "reported when a cell.toml is checked without a program, for a given robot.",
        '[[zones]]\nname = "LOW"\nrule = "forbidden"\nshape = "half-space"\nframe = "B"\nnormal = [0, 0, 1]',
        '[[zones]]\nname = "LOW"\nrule = "forbidden"\nshape = "half-space"\nframe = "B"\nnormal = [0, 0, -1]',
    ),
)
