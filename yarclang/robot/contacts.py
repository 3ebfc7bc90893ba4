"""Collect the pairs of links that may touch each other: pairs that robot.toml allows, and pairs that an
SRDF disables.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from yarclang.diagnostics import Diagnostic
from yarclang.robot.urdf import Urdf
from yarclang.robot.urdf_xml import Element, UrdfText, parse_xml
from yarclang.toml.file import TomlFile, did_you_mean
from yarclang.toml.reading import read_text

if TYPE_CHECKING:
    from yarclang.robot.schema import RobotTable

Pair = tuple[str, str]


def allowed_pairs(file: TomlFile, folder: Path, table: RobotTable, urdf: Urdf) -> frozenset[Pair]:
    """Return the pairs of links and tools that may touch each other, each pair in alphabetical order.

    Args:
        file: the robot.toml, which collects findings about unknown names.
        folder: the folder of the robot.toml.
        table: its tables.
        urdf: the robot's URDF.
    """
    pairs: set[Pair] = set()
    tools = {name.upper() for name in table.tools}
    for at, said in enumerate(table.collision.allowed):
        names = [name.upper() if name not in urdf.links and name.upper() in tools else name for name in said]
        place = ("collision", "allowed", at)
        if len(names) != 2 or names[0] == names[1]:
            message = f"allowed has {len(names)} names in a pair, {', '.join(names)[:60]}."
            file.say("Y1309", place, message, 'Write two links, ["link_2", "link_4"].')
            continue
        lost = [name for name in names if name not in urdf.links and name not in tools]
        for name in lost:
            message = f"allowed names the link {name[:40]}, which the URDF doesn't have."
            file.say("Y1347", place, message, *did_you_mean(name, [*urdf.links, *tools]))
        if not lost:
            pairs.add(_ordered(*names))
    if table.collision.srdf is not None:
        pairs.update(_of_srdf(file, folder, table.collision.srdf, urdf))
    return frozenset(pairs)


def check_pieces(file: TomlFile, table: RobotTable, urdf: Urdf) -> None:
    """Check the links whose meshes robot.toml divides into convex pieces: the URDF must have these links, and
    they must have meshes.

    Args:
        file: the robot.toml, which collects the findings.
        table: its tables.
        urdf: the robot's URDF.
    """
    for name in table.collision.pieces:
        place = ("collision", "pieces", name)
        if name not in urdf.links:
            message = f"pieces names the link {name[:40]}, which the URDF doesn't have."
            remedy = (
                f"{did_you_mean(name, urdf.links)[0]} The pieces of a tool's mesh are given under [[bodies]]."
            )
            file.say("Y1347", place, message, remedy, at_key=True)
            continue
        geometries = [body.first("geometry") for body in urdf.links[name].all("collision")]
        if not any(one is not None and one.children[0].tag == "mesh" for one in geometries):
            message = f"The link {name[:40]} has no collision mesh that could be divided into pieces."
            file.say(
                "Y1308",
                place,
                message,
                "Remove the entry: only meshes can be divided into pieces.",
                at_key=True,
            )


def _of_srdf(file: TomlFile, folder: Path, name: str, urdf: Urdf) -> Iterable[Pair]:
    """Yield the pairs of links that an SRDF disables. Report link names that the URDF doesn't have, because
    other readers of SRDF files ignore them silently.
    """
    source = read_text(folder / name, "")
    if isinstance(source, Diagnostic):
        if source.source is not None:
            file.findings.append(source)
        else:
            remedy = "Give the SRDF file's path relative to the folder of this robot.toml."
            file.say("Y1302", ("collision", "srdf"), source.message, remedy)
        return
    text = UrdfText(source)
    parse_xml(text)
    root = text.root
    for element in root.all("disable_collisions") if root else ():
        links = [_link(text, element, key, urdf) for key in ("link1", "link2")]
        if all(links):
            yield _ordered(*links)
    file.findings += text.findings


def _link(text: UrdfText, element: Element, key: str, urdf: Urdf) -> str:
    """Return the link that an attribute names. The result is empty, with a finding, if the attribute is
    missing or the link is unknown.
    """
    name = element.attributes.get(key, "")
    if not name:
        text.say(
            "Y1342", f"<{element.tag}> has no {key}.", f'Write {key}="..." with a link\'s name.', element
        )
    elif name not in urdf.links:
        message = f"{key} is {name[:40]}, a link that the URDF doesn't have."
        remedy, subject = did_you_mean(name, urdf.links)
        text.say("Y1347", message, remedy, element, key, subject)
        return ""
    return name


def _ordered(*names: str) -> Pair:
    first, second = sorted(names)
    return first, second
