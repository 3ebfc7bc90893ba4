"""Findings of family 13: a robot's URDF, the text and its elements."""

from __future__ import annotations

from yarclang.findings.finding import Finding

FINDINGS: tuple[Finding, ...] = (
    Finding(
        "Y1340",
        "not-xml",
        "error",
        "the URDF isn't XML",
        "The text breaks a rule of XML, so that no part of the file can be used.",
        '<link name="a">',
        '<link name="a"/>',
    ),
    Finding(
        "Y1341",
        "not-urdf",
        "error",
        "the file isn't a usable URDF",
        "One of these is wrong: the root isn't <robot>, the version isn't 1.0 to 1.2, the file still "
        "contains xacro or a DOCTYPE, or it has far too many elements.",
        '<robot name="arm" version="2.0">',
        '<robot name="arm" version="1.1">',
    ),
    Finding(
        "Y1342",
        "missing-part",
        "error",
        "an element lacks a part",
        "Without this part, readers of URDF refuse the file, or take a default that moves the arm wrongly "
        "(for example for an <axis> without xyz).",
        "<axis/>",
        '<axis xyz="0 0 1"/>',
    ),
    Finding(
        "Y1343",
        "urdf-name",
        "error",
        "the name of a link or joint can't be used",
        "The names of links and joints become keys of robot.toml and words of messages. ASCII letters, "
        "digits, and . _ - are safe everywhere. No joint may be named universe, because Pinocchio gives "
        "this name to a joint of its own above the root.",
        '<joint name="axis 1" type="revolute">',
        '<joint name="axis_1" type="revolute">',
    ),
    Finding(
        "Y1344",
        "urdf-name-twice",
        "error",
        "two links, joints or materials have one name",
        "Links and joints are found by name, so one of the two would be lost.",
    ),
    Finding(
        "Y1345",
        "bad-number",
        "error",
        "a number of the URDF can't be read",
        "Numbers must be finite. In lists, they are separated by blanks, not by commas or tabs.",
        '<origin xyz="0, 0.2, 0.449"/>',
        '<origin xyz="0 0.2 0.449"/>',
    ),
    Finding(
        "Y1346",
        "bad-size",
        "error",
        "a size isn't above zero, or a mass or speed is negative",
        "A shape without extent collides with nothing. A negative mass, speed, effort or friction has no "
        "meaning.",
        '<sphere radius="0"/>',
        '<sphere radius="0.1"/>',
    ),
    Finding(
        "Y1360",
        "pinocchio-refuses",
        "error",
        "Pinocchio can't read the URDF",
        "yarclang's own checks found no error, but Pinocchio, the library that builds the model, refuses "
        "the file. The message has its reason.",
    ),
    Finding(
        "Y1361",
        "element-twice",
        "error",
        "an element is given twice",
        "Readers of URDF take the first of two and ignore the second.",
        '<origin xyz="0 0 1"/>\n<origin xyz="0 0 2"/>',
        '<origin xyz="0 0 1"/>',
    ),
)
