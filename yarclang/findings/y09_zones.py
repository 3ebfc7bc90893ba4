"""Family 09, second part: zones of a cell. Y0905 said that zones aren't watched; they are."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0906",
        "unknown-part",
        "error",
        "a zone watches something that the robot doesn't have",
        "A zone watches the tool, the elbow, the arm, or links by their names in the URDF; a link without a collision shape has no room that could be watched. "
        "A name that nothing bears would be watched in silence by nobody.",
        'watch = ["tool", "forearm"]     # the URDF calls it link_4',
        'watch = ["tool", "link_4"]',
    ),
    Finding(
        "Y0907",
        "out-of-a-zone",
        "error",
        "the robot would leave a zone that it has to stay in",
        "An allowed zone says where what it watches may be: the tool, the elbow, links. The way that the controller executes is held against it, every instant of it, "
        "with the zone's margin. The message names the part and the zone, when, how far, and where the robot is then.",
        "P0010 MOVEL {TCP} 0 1100 300 0 0 0 [5] (mm,deg,s) {B}     ! the zone FLOOR ends at z = 400",
        "P0010 MOVEL {TCP} 0 1100 420 0 0 0 [5] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0908",
        "into-a-zone",
        "error",
        "the robot would enter a zone that it has to stay out of",
        "A forbidden zone keeps out what it watches: where people walk, where another robot works. Nothing has to be there that could be hit, and nobody hears a crash.",
        "P0010 MOVEJ 60 0 0 0 0 0 [5] (deg,s)      ! the tool swings through WALKWAY",
        "P0010 MOVEJ 20 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0909",
        "outside-the-joint-window",
        "error",
        "joints would leave their window, or enter a forbidden one",
        "A zone with the shape of joints narrows the robot's joint limits in this cell, or keeps it out of a posture.",
        'P0010 MOVEJ 100 0 0 0 0 0 [5] (deg,s)      ! rule = "allowed", joints = { J1 = [-90, 90] }',
        "P0010 MOVEJ 80 0 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0910",
        "wrong-posture-in-a-zone",
        "error",
        "joints would be in the wrong posture inside of a zone",
        "A zone for a posture asks for a joint window as long as a part that it watches is inside: an elbow that has to be up in a press, a wrist that must not turn "
        "over in a door.",
        'P0010 MOVEJ 0 60 20 0 0 0 [5] (deg,s)      ! rule = "posture", joints = { J3 = [-90, 0] }',
        "P0010 MOVEJ 0 60 -20 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0911",
        "too-fast-in-a-zone",
        "error",
        "the controller's text is faster than a slow zone allows",
        "The plan keeps to slow zones: [MIN] and [50%] take as long as they ask for, and a time that is too short is Y0912. This is the certificate's own judgement of the text: "
        "it is never written.",
    ),
    Finding(
        "Y0912",
        "no-time-for-a-zone",
        "error",
        "the time or speed of a motion is too much for a slow zone",
        "In a slow zone nothing that it watches goes faster than its speed. A motion with a time of its own that would, is refused, and the message tells the shortest time that "
        "works; [MIN] and shares of the limits take it by themselves.",
        "P0010 MOVEL {TCP} 0 900 900 0 0 0 [1] (mm,deg,s) {B}     ! 400 mm through a zone of 250 mm/s",
        "P0010 MOVEL {TCP} 0 900 900 0 0 0 [MIN] (mm,deg,s) {B}",
    ),
    Finding(
        "Y0913",
        "impossible-zone",
        "error",
        "nothing can keep to a zone",
        "A zone whose margin is larger than itself, two allowed zones without room in common, an allowed one in a forbidden one, or a window outside of a joint's limits: "
        "each motion would be refused, with a reason that doesn't lie in the motion.",
        '[[zones]]\nname = "INSIDE"\nrule = "allowed"\nshape = "sphere"\nframe = "B"\nradius = 50\nmargin = 80',
        '[[zones]]\nname = "INSIDE"\nrule = "allowed"\nshape = "sphere"\nframe = "B"\nradius = 500\nmargin = 80',
    ),
    Finding(
        "Y0914",
        "home-breaks-a-zone",
        "warning",
        "the robot's HOME breaks a zone",
        "A program without a START line begins in HOME: it would be refused at its first motion. It is told where a cell is checked by itself, for a robot.",
        '[[zones]]\nname = "LOW"\nrule = "forbidden"\nshape = "half-space"\nframe = "B"\nnormal = [0, 0, 1]',
        '[[zones]]\nname = "LOW"\nrule = "forbidden"\nshape = "half-space"\nframe = "B"\nnormal = [0, 0, -1]',
    ),
)
