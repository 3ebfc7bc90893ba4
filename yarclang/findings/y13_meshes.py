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
        "could name any file of this computer. So a mesh file may have at most 100 MB, and its whole "
        "content must be in the format that its ending states: STL, OBJ, DAE or PLY. All vertices must be "
        "finite numbers, and the faces of an OBJ file must use its vertices.",
        '<mesh filename="/etc/passwd"/>',
        '<mesh filename="meshes/link1.stl"/>',
    ),
    Finding(
        "Y1364",
        "mesh-elsewhere",
        "error",
        "a mesh isn't in the URDF's package",
        "Meshes are copied from the URDF's folder (and from the folder above it, if the URDF's folder is "
        "one of the usual subfolders, such as urdf), from its ROS package, and from other ROS packages that "
        "package:// names. Symbolic links are resolved before this check. A file in any other place may be "
        "private: --meshes FOLDER allows a further folder.",
        '<mesh filename="../../../other/part.stl"/>',
        '<mesh filename="meshes/part.stl"/>',
    ),
    Finding(
        "Y1366",
        "link-without-mesh",
        "warning",
        "the robot was made without a collision mesh that its URDF names",
        "A mesh is missing, and --allow-missing-meshes was given. The collision check lets a link without "
        "its mesh pass through any body, unless the link has other shapes.",
    ),
)
