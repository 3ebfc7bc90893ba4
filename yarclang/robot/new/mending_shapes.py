"""Mend shapes and colours that no reader of URDFs accepts, in the URDF of a user. No collision shape becomes
smaller.
"""

from __future__ import annotations

from yarclang.robot.new.edits import Edits
from yarclang.robot.new.numbers import numbers
from yarclang.robot.urdf_xml import Element

THIN = 1e-3
"""Length that replaces a dimension of 0 of a collision shape [m]. The shape becomes larger, never smaller."""

_SIZES = {
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "sphere": ("radius",),
}


def mend_shapes(edits: Edits, root: Element) -> None:
    """Remove visual shapes that show nothing and collision shapes whose dimensions are all 0. Give other flat
    collision shapes a thickness. If the URDF has capsules, set its version number to that of the first
    version of the format with capsules.
    """
    bodies = [body for link in root.all("link") for body in (*link.all("visual"), *link.all("collision"))]
    removed = thick = broken = capsules = 0
    for body in bodies:
        shape = next((one for geometry in body.all("geometry")[:1] for one in geometry.children[:1]), None)
        drawn = body.tag == "visual"
        if shape is None or shape.tag not in _SIZES:
            broken += drawn and _shows_nothing(shape) and edits.remove(body)
            continue
        capsules += shape.tag == "capsule"
        sizes = {key: tuple(numbers(shape.attributes.get(key, ""))) for key in _SIZES[shape.tag]}
        values = [value for one in sizes.values() for value in one]
        if not all(sizes.values()) or min(values) != 0.0:
            continue
        if drawn or max(values) == 0.0:
            removed += edits.remove(body)
            continue
        for key, one in sizes.items():
            edits.put(shape, key, " ".join(f"{max(size, THIN):.12g}" for size in one))
        thick += 1
    edits.count(removed, "shapes without a size are left out")
    edits.count(broken, "visuals without a shape are left out")
    edits.count(thick, f"collision shapes with a side of 0 are {THIN * 1e3:g} mm thick there")
    if capsules and root.attributes.get("version", "1.0") == "1.0":
        edits.put(root, "version", "1.1")
        edits.notes.append(
            f"{capsules} capsules are kept by giving the copy version 1.1: readers ignore them in a URDF "
            "of version 1.0"
        )


def _shows_nothing(shape: Element | None) -> bool:
    if shape is None:
        return True
    if shape.tag != "mesh":
        return False
    return not shape.attributes.get("filename") or 0.0 in numbers(shape.attributes.get("scale", ""))


def mend_materials(edits: Edits, root: Element) -> None:
    """Remove <material> elements that no reader of URDFs accepts. Convert colours whose components range from
    0 to 255 to components from 0 to 1. These changes affect only pictures.
    """
    removed = bright = 0
    known: set[str] = set()
    for material in root.all("material"):
        name = material.attributes.get("name", "")
        removed += (name in known or not name) and edits.remove(material)
        known.add(name)
    visuals = [body for link in root.all("link") for body in (*link.all("visual"), *link.all("collision"))]
    for body in visuals:
        for number, material in enumerate(body.all("material")):
            useless = number > 0 or "name" not in material.attributes
            removed += useless and edits.remove(material)
    for material in (*root.all("material"), *(one for body in visuals for one in body.all("material"))):
        color = material.first("color")
        parts = tuple(numbers(color.attributes.get("rgba", ""))) if color is not None else ()
        if color is not None and len(parts) == 4 and min(parts) >= 0.0 and 1.0 < max(parts) <= 255.0:
            alpha = parts[3] if parts[3] <= 1.0 else parts[3] / 255.0
            edits.put(
                color,
                "rgba",
                " ".join(f"{part:.4g}" for part in (*(one / 255.0 for one in parts[:3]), alpha)),
            )
            bright += 1
    edits.count(removed, "materials that are repeated or have no name are left out")
    edits.count(bright, "colours from 0 to 255 are converted to 0 to 1")
