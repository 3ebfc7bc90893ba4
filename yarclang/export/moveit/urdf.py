"""Write the URDF of a robot for ROS. The text has version 1.0 of the format, additional links, and the names
that the meshes have in a ROS package.

The additional links are those of the frames and mounted tools of robot.toml.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from xml.sax.saxutils import quoteattr

import numpy as np

from yarclang.diagnostics import Diagnostic, Result
from yarclang.export.moveit.bodies import Bodies
from yarclang.export.numbers import number
from yarclang.files import LARGEST_MESH, read_whole
from yarclang.robot.link_shapes import placed_at, shape_of
from yarclang.robot.model import Array, Robot, Tool
from yarclang.robot.urdf import Urdf
from yarclang.robot.urdf_shapes import mesh_path
from yarclang.robot.urdf_xml import Element
from yarclang.shapes import Box, Capsule, Cylinder, Mesh, Shape, Sphere
from yarclang.transforms import roll_pitch_yaw

Edit = tuple[int, int, str]
"""A change of a text: start and end of the replaced part, and the new text."""

FOLDER = "urdf"
_PLAIN = re.compile(r"[A-Za-z0-9_.\-/]+", re.ASCII)
_GREY = '<material name="yarclang_grey"><color rgba="0.8 0.82 0.85 1"/></material>'
"""Material of added bodies. It is needed because RViz draws bodies without a material in red."""
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_ENCODING = re.compile(r"""^(\s*<\?xml[^>]*?\sencoding\s*=\s*)(["']).*?\2""", re.DOTALL)
_FILENAME = re.compile(r"""(\sfilename\s*=\s*)(["'])(.*?)\2""", re.DOTALL)


def exported_urdf(
    robot: Robot, urdf: Urdf, package: str, ends: tuple[str, str], bodies: Bodies
) -> Result[dict[str, bytes]]:
    """Return the files of a robot's URDF and of its meshes, by their paths in a ROS package, with a finding
    for each mesh that can't be read.

    Args:
        robot: the robot.
        urdf: its URDF.
        package: name of the package.
        ends: the links {B} and {FLANGE}.
        bodies: additional links on the flange.
    """
    meshes = PackageMeshes(robot, package)
    text = urdf_text(urdf, ends[1], bodies, meshes)
    name = f"{FOLDER}/{robot.name.lower()}.urdf"
    files = {name: text.encode(), **meshes.files}
    return Result(files, tuple(meshes.findings))


def urdf_text(
    urdf: Urdf, flange: str, bodies: Bodies, meshes: MeshNames, axes: frozenset[str] | None = None
) -> str:
    """Return the text of a URDF that all versions of ROS read.

    Args:
        urdf: a sound URDF.
        flange: the link {FLANGE}.
        bodies: additional links on the flange.
        meshes: object that gives each mesh its new name, and collects findings about missing meshes.
        axes: names of the robot's own moving joints, for a text that is only drawn. All other joints are then
            fixed at zero, and links without visual shapes get their collision shapes as visual shapes. None
            to keep joints and links as they are.
    """
    text, root = urdf.text, urdf.root
    assert root is not None  # a sound URDF has a root
    edits = [_version(text, root)]
    if axes is not None:
        others = (joint for name, joint in urdf.joints.items() if name not in axes)
        edits += [_fixed(text, joint.element) for joint in others]
        edits += [_seen(urdf, link, meshes) for link in urdf.links.values() if not link.all("visual")]
    for link in urdf.links.values():
        for body in (*link.all("visual"), *link.all("collision")):
            edits += _body(urdf, body, meshes)
    for start, end, new in sorted(edits, reverse=True):
        text = f"{text[:start]}{new}{text[end:]}"
    added = "".join(f"{line}\n" for line in _added(flange, bodies, meshes))
    end = _COMMENT.sub(lambda found: " " * len(found[0]), text).rindex("</")
    text = f"{text[:end]}{added}{text[end:]}"
    # The text is written in UTF-8, so its declaration must name this encoding.
    return _ENCODING.sub(r'\1"UTF-8"', text, count=1)


def _fixed(text: str, joint: Element) -> Edit:
    tag = text[joint.start : joint.end]
    return joint.start, joint.end, re.sub(r"""(\stype\s*=\s*)(["']).*?\2""", r'\1"fixed"', tag, count=1)


def _version(text: str, root: Element) -> Edit:
    """Return the edit that changes the root element's version to 1.0, which all versions of ROS read. The
    edit doesn't replace the elements that only later versions have.
    """
    tag = text[root.start : root.end]
    return root.start, root.end, re.sub(r"""(\sversion\s*=\s*)(["']).*?\2""", r'\1"1.0"', tag)


def _seen(urdf: Urdf, link: Element, meshes: MeshNames) -> Edit:
    """Return the edit that adds the collision shapes of a link as visual shapes."""
    lines = []
    for body in link.all("collision"):
        geometry = body.first("geometry")
        shape = geometry.children[0] if geometry is not None and geometry.children else None
        if shape is None:
            continue
        placed = placed_at(urdf, body.first("origin"))
        folder = (meshes.robot.folder / meshes.robot.urdf).parent
        for simple, pose in _simple(shape_of(urdf, shape, folder), placed):
            made = _geometry(simple, meshes)
            if made is not None:
                lines.append(f"\n    <visual>{_origin(pose)}<geometry>{made}</geometry>{_GREY}</visual>")
    return link.end, link.end, "".join(lines)


def _body(urdf: Urdf, body: Element, meshes: MeshNames) -> Iterator[Edit]:
    """Yield the edits of a <visual> or <collision> element.

    The name of a mesh is replaced. A capsule becomes three bodies, because version 1.0 of the format has no
    capsules.
    """
    geometry = body.first("geometry")
    shape = geometry.children[0] if geometry is not None and geometry.children else None
    if shape is None:
        return
    if shape.tag == "mesh":
        url = meshes.url(shape.attributes.get("filename", ""))
        if url is not None:
            tag = urdf.text[shape.start : shape.end]
            new = _FILENAME.sub(lambda found: f"{found[1]}{quoteattr(url)}", tag, count=1)
            yield shape.start, shape.end, new
    elif shape.tag == "capsule":
        masked = _COMMENT.sub(lambda found: " " * len(found[0]), urdf.text[body.start :])
        ending = re.search(rf"</{body.tag}\s*>", masked)
        assert ending is not None  # an element with a child has an end tag
        capsule = Capsule(float(shape.attributes["radius"]), float(shape.attributes["length"]))
        material = _material(body.first("material"))
        placed = placed_at(urdf, body.first("origin"))
        new = "\n    ".join(
            f"<{body.tag}>{_origin(pose)}<geometry>{_geometry(simple, meshes)}</geometry>{material}</{body.tag}>"  # noqa: E501
            for simple, pose in _simple(capsule, placed)
        )
        # the whole element is replaced
        yield body.start, body.start + ending.end(), new


def _material(material: Element | None) -> str:
    if material is None:
        return ""
    name = quoteattr(material.attributes.get("name", ""))
    colour = material.first("color")
    if colour is None:
        return f"<material name={name}/>"
    return f"<material name={name}><color rgba={quoteattr(colour.attributes.get('rgba', ''))}/></material>"


class MeshNames(ABC):
    """Translator from the mesh names in a robot's URDF to the names in the exported URDF.

    Args:
        robot: the robot whose URDF uses the meshes.

    Attributes:
        robot: the robot.
        findings: findings about missing meshes.
    """

    def __init__(self, robot: Robot) -> None:
        self.findings: list[Diagnostic] = []
        self.robot = robot

    def url(self, filename: str) -> str | None:
        """Return the new name of a mesh that the URDF calls `filename`; None, with a finding, if its file
        doesn't exist.
        """
        path = mesh_path(filename, (self.robot.folder / self.robot.urdf).parent)
        if path is None:
            self._lost(filename, "there is no such file")
            return None
        return self.url_of(path)

    @abstractmethod
    def url_of(self, path: Path) -> str | None:
        """Return the new name of a mesh file; None, with a finding, if it can't be used."""

    def _lost(self, name: str, reason: str) -> None:
        message = f"the mesh {name[:100]!r} isn't exported: {reason}"
        self.findings.append(
            Diagnostic("Y1537", message, help="put it where the URDF names it, or take it out of the URDF")
        )


class FileMeshes(MeshNames):
    """Translator that names meshes by the URIs of their files, for programs on the same computer."""

    def url_of(self, path: Path) -> str | None:
        """Return the URI of a mesh file."""
        if not path.is_file():
            self._lost(path.name, "there is no such file")
            return None
        return path.resolve().as_uri()


class PackageMeshes(MeshNames):
    """Translator that names meshes by paths in a ROS package, and collects their files.

    Attributes:
        files: contents of the files, by their paths in the package.
    """

    def __init__(self, robot: Robot, package: str) -> None:
        super().__init__(robot)
        self.files: dict[str, bytes] = {}
        self._package = package
        self._places: dict[Path, str] = {}

    def url_of(self, path: Path) -> str | None:
        """Return the package URL of a mesh file; None, with a finding, if the file can't be read."""
        path = path.resolve()
        if path not in self._places:
            place = self._place(path)
            try:
                self.files[place] = read_whole(path, LARGEST_MESH)
            except OSError as error:
                self._lost(path.name, error.strerror or str(error))
                return None
            self._places[path] = place
        return f"package://{self._package}/{self._places[path]}"

    def _place(self, path: Path) -> str:
        """Return a path in the package for a mesh file. The path differs from the paths of all other files.
        If the mesh file is in the robot's folder, its path there is kept, provided that it has only plain
        characters.
        """
        folder = self.robot.folder.resolve()
        stem = re.sub(r"[^A-Za-z0-9_]", "_", path.stem, flags=re.ASCII) or "mesh"
        place = f"{FOLDER}/meshes/{stem}{path.suffix}"
        if path.is_relative_to(folder):
            inside = str(PurePosixPath(path.relative_to(folder)))
            if _PLAIN.fullmatch(inside) and not inside.endswith(".urdf"):
                place = f"{FOLDER}/{inside}"
        free, number_ = place, 2
        while free in self.files:
            free, number_ = f"{place.removesuffix(path.suffix)}_{number_}{path.suffix}", number_ + 1
        return free


def _added(flange: str, bodies: Bodies, meshes: MeshNames) -> Iterator[str]:
    """Yield the lines of the URDF for the additional links on the flange."""
    for link, pose in bodies.frames.items():
        yield f"  <link name={quoteattr(link)}/>"
        yield from _joint(link, flange, pose)
    for link, tool in bodies.tools.items():
        yield f"  <link name={quoteattr(link)}>"
        yield from _shapes(tool, meshes)
        yield "  </link>"
        yield from _joint(link, flange, np.eye(4))


def _joint(link: str, flange: str, pose: Array) -> Iterator[str]:
    yield f'  <joint name={quoteattr(f"{link}_joint")} type="fixed">'
    yield f"    <parent link={quoteattr(flange)}/>"
    yield f"    <child link={quoteattr(link)}/>"
    yield f"    {_origin(pose)}"
    yield "  </joint>"


def _shapes(tool: Tool, meshes: MeshNames) -> Iterator[str]:
    for placed in tool.shapes:
        for shape, pose in _simple(placed.shape, placed.flange_from_shape):
            geometry = _geometry(shape, meshes)
            if geometry is not None:
                for tag in ("visual", "collision"):
                    yield f"    <{tag}>{_origin(pose)}<geometry>{geometry}</geometry></{tag}>"


def _simple(shape: Shape, pose: Array) -> Iterator[tuple[Shape, Array]]:
    """Yield the simple shapes that replace a shape, each with its pose: a capsule becomes a cylinder and two
    spheres, any other shape stays.
    """
    if not isinstance(shape, Capsule):
        yield shape, pose
        return
    yield Cylinder(shape.radius, shape.length), pose
    for side in (-0.5, 0.5):
        end = pose.copy()
        end[:3, 3] += side * shape.length * pose[:3, 2]
        yield Sphere(shape.radius), end


def _geometry(shape: Shape, meshes: MeshNames) -> str | None:
    match shape:
        case Box(size=size):
            return f'<box size="{_row(size)}"/>'
        case Sphere(radius=radius):
            return f'<sphere radius="{number(radius)}"/>'
        case Cylinder(radius=radius, length=length):
            return f'<cylinder radius="{number(radius)}" length="{number(length)}"/>'
        case Mesh(path=path, unit=unit, scale=scale):
            url = meshes.url_of(path)
            return url and f'<mesh filename={quoteattr(url)} scale="{_row(unit * np.array(scale))}"/>'
    raise AssertionError(f"a {type(shape).__name__} was made simple before")


def _origin(pose: Array) -> str:
    return f'<origin xyz="{_row(pose[:3, 3])}" rpy="{_row(roll_pitch_yaw(pose[:3, :3]))}"/>'


def _row(values: Array) -> str:
    return " ".join(number(value) for value in np.round(values, 12) + 0.0)
