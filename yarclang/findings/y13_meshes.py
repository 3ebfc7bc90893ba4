"""Findings of family 13: the meshes in a new robot's folder."""

from __future__ import annotations

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1363",
        "not-a-mesh",
        "error",
        "a file that the URDF calls a mesh isn't one",
        "Collision meshes are copied into the robot's folder, which people pass on. A URDF from elsewhere "
        "could name any file of this computer; so the whole content must be that of an STL, OBJ, DAE or "
        "PLY file, as its name ends, of at most 100 MB. Corners must be finite numbers, and the faces of "
        "an OBJ file must use its corners.",
        '<mesh filename="/etc/passwd"/>',
        '<mesh filename="meshes/link1.stl"/>',
    ),
    Finding(
        "Y1364",
        "mesh-elsewhere",
        "error",
        "a mesh isn't in the URDF's package",
        "Meshes are copied from the URDF's folder, from the one above if it is called urdf or alike, from "
        "its ROS package and from other ROS packages that package:// names, wherever links lead. A file "
        "elsewhere may be somebody's that isn't to be passed on: --meshes FOLDER says that it is.",
        '<mesh filename="../../../other/part.stl"/>',
        '<mesh filename="meshes/part.stl"/>',
    ),
    Finding(
        "Y1366",
        "link-without-mesh",
        "warning",
        "the robot was made without a collision mesh that its URDF names",
        "--allow-missing-meshes was given. The collision check lets these links pass through any body, "
        "unless a link has other shapes.",
    ),
)
