"""Family 09: collision and workspace."""

from yarclang.findings.finding import Finding

FINDINGS = (
    Finding(
        "Y0901",
        "collision",
        "error",
        "the robot would hit something",
        "On the way that the controller executes, a link, or what the robot carries, enters an obstacle of the cell. The message names both bodies, when, "
        "how deep, and where the robot is then. The whole way was proved, not samples of it: nothing is too thin to be seen.",
        "P0010 MOVEJ 40 0 0 0 0 0 [5] (deg,s)      ! a POST stands at 30 deg",
        "P0010 MOVEJ 0 60 0 0 0 0 [5] (deg,s)      ! the arm drawn back\nP0020 MOVEJ 40 60 0 0 0 0 [5] (deg,s)",
    ),
    Finding(
        "Y0902",
        "self-collision",
        "error",
        "the robot would hit itself",
        "Two links, or a link and a tool, enter each other on the way. Links that are joined by a joint may touch; other pairs that always touch, because their "
        "shapes are larger than the links, are listed under [collision] of robot.toml.",
        "P0010 MOVEJ 0 0 -160 0 0 0 [20] (deg,s)",
        "P0010 MOVEJ 0 0 -80 0 0 0 [20] (deg,s)",
    ),
    Finding(
        "Y0903",
        "within-the-margin",
        "error",
        "the robot comes nearer to something than its margin allows",
        "Nothing touches, but an obstacle's margin in the cell.toml says how far everything else has to stay away: what isn't built as it is drawn, "
        "and how far the robot lags behind its program, are in it.",
        '[[obstacles]]\nname = "BENCH"\nmargin = 10     ! the robot comes within 4 mm',
    ),
    Finding(
        "Y0904",
        "unreadable-mesh",
        "error",
        "a mesh can't be read",
        "A body without its shape would be passed through in silence, so that a mesh which can't be read, or has no triangles, stops the compiler.",
        'shape = "mesh"\nfile = "press.stl"     # an empty file, or none of STL, OBJ, DAE, PLY',
    ),
    Finding(
        "Y0905",
        "zones-not-watched",
        "warning",
        "the zones of a cell aren't watched",
        "Zones say where the robot may be, and how fast. They are read and checked in form, and no motion is held against them yet: whoever wrote "
        "them has to know that they don't protect anything.",
        '[[zones]]\nname = "FLOOR"\nrule = "allowed"',
    ),
    Finding(
        "Y0930",
        "too-near-to-prove",
        "error",
        "the robot passes so near that nothing can be proved",
        "The proof that a motion is free divides it until what is left can't reach from one body to the other. Where they pass within a fifth of a millimetre of the margin, and one of "
        "them is a hollow mesh, that would take seconds: it ends there, and what isn't proved isn't written. Nothing was seen to touch.",
        '[[obstacles]]\nname = "PRESS"\nshape = "mesh"\nfile = "press.stl"     # the robot passes it at its margin and 0.1 mm',
    ),
)
