"""Check the shapes of a URDF's links, so that the collision check sees all of them.

Pinocchio drops a shape that it can't read and continues. The arm could then collide with this link without
any warning. Each such shape is therefore an error here.
"""

from __future__ import annotations

import hashlib
from pathlib import Path
from urllib.parse import unquote, urlparse

from yarclang.consulted import is_file
from yarclang.files import LARGEST_MESH, read_whole
from yarclang.robot.urdf import Urdf, turned
from yarclang.robot.urdf_xml import Element

_SIZES = {
    "box": (("size", 3),),
    "sphere": (("radius", 1),),
    "cylinder": (("radius", 1), ("length", 1)),
    "capsule": (("radius", 1), ("length", 1)),
}
_MOST_SHAPES = 1000
"""The largest number of collision shapes of a file. Each shape takes some ms every time the robot is read,
and every pair of shapes has to be checked for collisions.
"""
_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


def check_shapes(urdf: Urdf, folder: Path) -> dict[str, list[str]]:
    """Check all shapes, masses and materials of a URDF.

    Args:
        urdf: the URDF, which collects the findings.
        folder: the folder of the URDF; mesh names are relative to it.

    Returns:
        The collision shapes of each link, as texts that are equal for equal shapes.
    """
    shapes: dict[str, list[str]] = {}
    if urdf.root is None or urdf.root.tag != "robot":
        return shapes
    links = urdf.root.all("link")
    bodies = [body for link in links for body in link.all("collision")]
    if len(bodies) > _MOST_SHAPES:
        message = f"The URDF has {len(bodies):,} collision shapes, more than {_MOST_SHAPES:,}."
        remedy = "Use few shapes for each link, or one mesh, whose convex hull is checked."
        urdf.say("Y1341", message, remedy, bodies[_MOST_SHAPES])
        return shapes
    for link in links:
        descriptions: list[str] = []
        for tag in ("visual", "collision"):
            for body in link.all(tag):
                shape = _check_body(urdf, link, body, folder)
                if tag == "collision":
                    descriptions.append(shape)
        _check_inertial(urdf, link)
        shapes[link.attributes.get("name", "")] = descriptions
    _check_materials(urdf, urdf.root)
    return shapes


def mesh_path(filename: str, folder: Path) -> Path | None:
    """Return the file that a mesh name refers to, or None if there is none."""
    return next((path for path in mesh_places(filename, folder) if is_file(path)), None)


def mesh_places(filename: str, folder: Path) -> list[Path]:
    """Return the paths that a mesh name may refer to, in the order of preference.

    A plain name is relative to the URDF's folder. A `package://` name is searched for in the URDF's folder
    and in the folders above, as Pinocchio does if these are its package folders.
    """
    url = urlparse(filename)
    if url.scheme == "file":
        return [Path(unquote(url.path))]
    if url.scheme == "package":
        rest = f"{url.netloc}{url.path}".lstrip("/")  # some write package:///name/file
        return [above / rest for above in (folder, *folder.parents)]
    return [folder / filename]


def _check_body(urdf: Urdf, link: Element, body: Element, folder: Path) -> str:
    """Check a <visual> or <collision> element, and return its shape as a text."""
    urdf.once(body, ("origin", "geometry", "material"))
    origin, geometry = body.first("origin"), body.first("geometry")
    place = (urdf.numbers(origin, "xyz", 3, (0.0, 0.0, 0.0)), turned(urdf, origin))
    for material in body.all("material")[:1]:
        if "name" not in material.attributes:  # an empty name, as CAD exports write it, does no harm
            urdf.say("Y1342", "<material> has no name.", 'Write <material name="...">.', material)
        _check_color(urdf, material)
    subject = f"A <{body.tag}> of link {link.attributes.get('name', '')}"
    kinds = ", ".join((*_SIZES, "mesh"))
    if geometry is None:
        remedy = f"Add <geometry> with one of {kinds}, or remove the <{body.tag}>."
        urdf.say("Y1356", f"{subject} has no <geometry>.", remedy, body)
        return ""
    if not geometry.children:
        remedy = f"Put one of {kinds} into it, or remove the <{body.tag}>."
        urdf.say("Y1356", f"{subject} has an empty <geometry>.", remedy, geometry)
        return ""
    for extra in geometry.children[1:]:
        message = f"{subject} has more than one shape, and readers of URDF take only the first."
        urdf.say("Y1361", message, f"Put <{extra.tag}> into a <{body.tag}> of its own.", extra)
    shape = geometry.children[0]
    if shape.tag == "mesh":
        # a missing visual mesh does no harm, a missing collision mesh does
        return (
            f"mesh {_check_mesh(urdf, subject, shape, folder if body.tag == 'collision' else None)} at "
            f"{place}"
        )
    if shape.tag not in _SIZES:
        message = f"{subject} has the shape <{shape.tag}>, which URDF doesn't know."
        urdf.say("Y1356", message, f"Use one of {kinds}.", shape)
        return ""
    version = urdf.root.attributes.get("version", "1.0") if urdf.root else "1.0"
    if shape.tag == "capsule" and version == "1.0":
        message = (
            f"{subject} is a <capsule>, which a URDF of version 1.0 doesn't have: the link would lose it."
        )
        urdf.say("Y1358", message, 'Write <robot name="..." version="1.1">.', shape)
    sizes = [_positive(urdf, subject, shape, key, count) for key, count in _SIZES[shape.tag]]
    return f"{shape.tag} {sizes} at {place}"


def _positive(urdf: Urdf, place: str, shape: Element, key: str, count: int) -> tuple[float, ...] | None:
    """Return the dimensions [m] of a shape, and report dimensions that aren't positive."""
    sizes = urdf.numbers(shape, key, count)
    if sizes is not None and min(sizes) <= 0.0:
        message = (
            f"{place} has the {key} {' '.join(f'{size:g}' for size in sizes)}, but each size must be above 0."
        )
        urdf.say("Y1346", message, "Give sizes in m.", shape, key)
    return sizes


def _check_mesh(urdf: Urdf, place: str, mesh: Element, folder: Path | None) -> str:
    """Check a mesh, and return a text of its scale and the SHA-256 of its file. If no folder is given, the
    file isn't looked for.
    """
    scale = urdf.numbers(mesh, "scale", 3, (1.0, 1.0, 1.0))
    if scale is not None and 0.0 in scale:
        message = f"{place} has a mesh with the scale 0, which makes it flat."
        urdf.say("Y1346", message, "Give three factors other than 0.", mesh, "scale")
    name = mesh.attributes.get("filename", "")
    if not name:
        urdf.say("Y1342", f"{place} has a <mesh> without a filename.", 'Write <mesh filename="..."/>.', mesh)
        return ""
    if folder is None:
        return ""
    try:
        path = mesh_path(name, folder)
        content = read_whole(path, LARGEST_MESH) if path else b""
    except (OSError, ValueError):
        path, content = None, b""
    if not content:
        message = f"{place} has the mesh {name[:80]}, which {'is empty' if path else 'is not there'}."
        remedy = "Put the file there; names are relative to the folder of the URDF."
        urdf.say("Y1357", message, remedy, mesh, "filename")
    return f"{scale} {hashlib.sha256(content).hexdigest()}"


def _check_inertial(urdf: Urdf, link: Element) -> None:
    """Check the mass and the inertia of a link. Pinocchio drops them silently if they are wrong."""
    urdf.once(link, ("inertial",))
    inertial = link.first("inertial")
    if inertial is None:
        return
    urdf.once(inertial, ("origin", "mass", "inertia"))
    origin = inertial.first("origin")
    urdf.numbers(origin, "xyz", 3, (0.0, 0.0, 0.0))
    turned(urdf, origin)
    for tag, keys in (("mass", ("value",)), ("inertia", _INERTIA)):
        part = inertial.first(tag)
        if part is None:
            message = f"The <inertial> of link {link.attributes.get('name', '')} has no <{tag}>."
            urdf.say("Y1342", message, "Give it <mass> and <inertia>, or remove it.", inertial)
            return
        values = [urdf.numbers(part, key, 1) for key in keys]
        if tag == "mass" and values[0] is not None and values[0][0] < 0.0:
            urdf.say("Y1346", f"The mass is {values[0][0]:g} kg.", "Give a mass of 0 or more.", part, "value")


def _check_materials(urdf: Urdf, root: Element) -> None:
    """Check the <material> elements of the whole URDF."""
    names: set[str] = set()
    for material in root.all("material"):
        name = material.attributes.get("name", "")
        if not name:
            urdf.say("Y1342", "<material> has no name.", 'Write <material name="...">.', material)
        elif name in names:
            urdf.say(
                "Y1344",
                f"A second material {name[:40]}.",
                "Give one of the two another name.",
                material,
                "name",
            )
        elif material.first("color") is None and material.first("texture") is None:
            message = f"Material {name[:40]} has neither a color nor a texture."
            urdf.say("Y1342", message, 'Add <color rgba="0.5 0.5 0.5 1"/>.', material)
        names.add(name)
        _check_color(urdf, material)


def _check_color(urdf: Urdf, material: Element) -> None:
    color = material.first("color")
    parts = urdf.numbers(color, "rgba", 4)
    if parts is not None and color is not None and not all(0.0 <= part <= 1.0 for part in parts):
        message = f"rgba is {' '.join(f'{part:g}' for part in parts)}, but each part must be from 0 to 1."
        urdf.say("Y1345", message, "Give red, green, blue, and alpha from 0 to 1.", color, "rgba")
