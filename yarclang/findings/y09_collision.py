"""Findings of family 09: collision and workspace."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0901",
        "collision",
        "error",
        "the robot would hit something",
        "On the path that the controller executes, a link, a tool or a carried part enters an obstacle of "
        "the cell. The message names both bodies, when, how deep, and where the robot is then. The whole "
        "path was checked, not samples of it: no obstacle is too thin to be found.",
        "P0010 MOVEJ 40 0 0 0 0 0 [5] (deg,s)      ! a POST stands at 30 deg",
        "P0010 MOVEJ 0 60 0 0 0 0 [5] (deg,s)      ! the arm drawn back\n"
        "P0020 MOVEJ 40 60 0 0 0 0 [5] (deg,s)",
        sort="meeting",
    ),
    Finding(
        "Y0902",
        "self-collision",
        "error",
        "the robot would hit itself",
        "Two links, or a link and a tool, overlap on the path. Links that are joined by a joint may touch. "
        "Some other pairs always overlap, but only because their collision shapes are larger than the real "
        "links; list such pairs under [collision] of robot.toml.",
        "P0010 MOVEJ 0 0 -160 0 0 0 [20] (deg,s)",
        "P0010 MOVEJ 0 0 -80 0 0 0 [20] (deg,s)",
        sort="meeting",
    ),
    Finding(
        "Y0903",
        "within-the-margin",
        "error",
        "the robot comes nearer to something than its margin allows",
        "No bodies touch. But an obstacle's margin in cell.toml is the distance that all other bodies must "
        "keep from it. The margin covers inaccuracies of the cell and the robot's following error.",
        '[[obstacles]]\nname = "BENCH"\nmargin = 10     ! the robot comes within 4 mm',
        sort="meeting",
    ),
    Finding(
        "Y0904",
        "unreadable-mesh",
        "error",
        "a mesh can't be read",
        "Without its shape, the robot would pass through a body, so an unreadable mesh stops the compiler. "
        "A mesh is unreadable if its file is cut off, if it has no triangles, if a corner isn't finite, or "
        "if a face has missing corners or all its corners on one line.",
        'shape = "mesh"\nfile = "press.stl"     # an empty file, or none of STL, OBJ, DAE, PLY',
    ),
    Finding(
        "Y0930",
        "too-near-to-prove",
        "error",
        "the robot passes too near to a body for a proof",
        "The proof divides a motion into pieces so short that in each piece the robot moves less than its "
        "distance from the other body. If the two pass each other within 0.2 mm of the margin, and one of "
        "them is a hollow mesh, this would take too long: the proof is given up, and nothing is written. No "
        "contact was found.",
        "[[obstacles]]\n"
        'name = "PRESS"\n'
        'shape = "mesh"\n'
        'file = "press.stl"     # the robot passes it at its margin and 0.1 mm',
        sort="meeting",
    ),
    Finding(
        "Y0931",
        "body-of-no-tool",
        "error",
        "a body in robot.toml belongs to a tool that isn't declared",
        "A body under [[bodies]] is one of the shapes of a tool. Each tool needs a table [tools.NAME], "
        "which gives its place and its mass. A body of an undeclared tool would be left out, and the tool "
        "would pass through obstacles.",
        '[[bodies]]\ntool = "GRIPER"\nshape = "box"\nsize = [60, 40, 120]',
        '[tools.GRIPPER]\n\n[[bodies]]\ntool = "GRIPPER"\nshape = "box"\nsize = [60, 40, 120]',
    ),
    Finding(
        "Y0932",
        "impossible-inertia",
        "error",
        "the inertia of a tool is physically impossible",
        "The principal moments of inertia of a body are never negative, and none exceeds the sum of the two "
        "others. If these values break this rule, their digits, order or unit (kg m^2) are wrong, and all "
        "computed torques would be wrong too.",
        "[tools.GRIPPER]\nmass = 2.0\ninertia = [0.010, 0.001, 0.001, 0, 0, 0]",
        "[tools.GRIPPER]\nmass = 2.0\ninertia = [0.010, 0.009, 0.002, 0, 0, 0]",
    ),
    Finding(
        "Y0935",
        "allowed-self-collision",
        "warning",
        "the robot hits itself, and ALLOW permits the contact",
        "Two links, or a link and a tool, come too near to each other on a motion, and the program or the "
        "cell allows these two to touch. ALLOW is meant for contact with parts and with the cell: a robot "
        "that hits itself is damaged even if the contact is allowed. If only the shapes are too large, "
        "allow the pair in robot.toml, for all programs.",
        "P0010 MOVEJ 0 -20 -94 0 0 0 [9] (deg,s) ALLOW LINK_2 LINK_5     ! they meet",
        "P0010 MOVEJ 0 -20 -84 0 0 0 [9] (deg,s)",
    ),
    Finding(
        "Y0960",
        "open-mesh-in-pieces",
        "error",
        "a mesh that is to be divided into pieces isn't closed",
        "pieces = N divides a mesh into convex pieces that contain it. The inside of a mesh is known only "
        "if its triangles enclose a volume: each edge must belong to two triangles, or to another even "
        "number. Mesh tools can close holes (in MeshLab: Close Holes). Without pieces, or with pieces = 1, "
        "the mesh needn't be closed: its triangles or its convex hull are used.",
        'shape = "mesh"\nfile = "shell.stl"     # a shell with a hole\npieces = 8',
        'shape = "mesh"\nfile = "shell.stl"\npieces = 1             # its hull',
    ),
    Finding(
        "Y0961",
        "incomplete-pieces",
        "error",
        "the pieces of a mesh don't contain it",
        "`pieces` divides the space around a mesh into boxes, and puts a convex piece around the part of "
        "the mesh in each box. The certificate checks this by a method of its own. Here, either a piece "
        "leaves out a point of the mesh, or the boxes have a gap between them. The division has an error, "
        "and nothing is written. Report it, with the mesh.",
    ),
    Finding(
        "Y0962",
        "heights-not-readable",
        "error",
        "the height field can't be read",
        "Height fields are read from two kinds of files. An NPY file of numpy has a two-dimensional array "
        "of integers or floating-point numbers. A CSV file has no header, one row in each line, and the "
        "same number of values in each row, separated by commas, semicolons, tabs or blanks. An empty value "
        "or nan marks a place without a measurement.",
        "x,y,z                   # a header, and points instead of rows of heights\n0,0,12.5\n10,0,12.9",
        "12.5,12.9,13.0          # the heights at y = 0\n12.4,12.8,12.9",
    ),
    Finding(
        "Y0963",
        "heights-too-many",
        "error",
        "the mesh of the height field would have too many triangles",
        "A height field becomes a closed mesh with four triangles for each square of four heights. More "
        "than 2,000,000 triangles make the collision proof slow. With --every N, N by N squares are merged "
        "into one. Its corners get the greatest height around them, so that nothing is cut off.",
        "yarc import ground.npy --units m --spacing 1",
        "yarc import ground.npy --units m --spacing 1 --every 3",
    ),
)
