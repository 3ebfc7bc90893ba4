"""Read a URDF with the lines of its elements, and check its tree of links and joints.

Pinocchio builds a model from a URDF. For a bad file it reports only that the file is bad. It doesn't report
some mistakes at all: an axis without xyz becomes the zero vector, and a second origin is ignored. All such
mistakes are therefore found here first.
"""

from __future__ import annotations

import bisect
import math
import re
from collections.abc import Callable, Iterator
from typing import Any

from yarclang.frozen import frozen
from yarclang.robot.urdf_xml import Element, UrdfText, parse_xml
from yarclang.source import SourceFile
from yarclang.toml.file import did_you_mean

MOVING = ("revolute", "continuous", "prismatic")
"""The types of moving joints that an arm's chain can have."""
UNARMED = ("planar", "floating")
"""Joint types that an arm's chain can't have; elsewhere in the file they are allowed."""

_NAME = re.compile(r"[A-Za-z0-9_.\-]+")
_ROOT = "universe"
"""Name of the joint that Pinocchio adds above the root. Pinocchio would mistake a joint of this name in the
file for the added joint, and would give it the wrong limits and place.
"""
MOST_LINKS = 1000
"""The largest number of links in a file, and the largest number of joints."""


@frozen
class Joint:
    """A joint of the URDF: `xyz` [m] and `rpy` [rad] are its origin in the parent link, `axis` has length
    1.
    """

    name: str
    kind: str
    parent: str
    child: str
    xyz: tuple[float, ...]
    rpy: tuple[float, ...]
    axis: tuple[float, ...]
    lower: float | None
    upper: float | None
    velocity: float | None
    element: Element


class Urdf(UrdfText):
    """A URDF with its links and joints by name."""

    def __init__(self, source: SourceFile) -> None:
        super().__init__(source)
        self.links: dict[str, Element] = {}
        self.joints: dict[str, Joint] = {}
        self.sound = False
        """True if links and joints form one tree, so that it can be traversed."""


def read_urdf(source: SourceFile) -> Urdf:
    """Read the links and joints of a URDF, and report all findings about its tree. Shapes are checked in
    urdf_shapes.py.
    """
    urdf = Urdf(source)
    parse_xml(urdf)
    if urdf.root is not None and not urdf.findings:
        _read_header(urdf, urdf.root)
        if not _is_small(urdf, urdf.root):
            return urdf
        sound = _read_links(urdf, urdf.root)
        sound = _read_joints(urdf, urdf.root) and sound
        urdf.sound = sound and _check_tree(urdf)
    return urdf


def _read_header(urdf: Urdf, root: Element) -> None:
    if root.tag != "robot":
        urdf.say("Y1341", f"The file is a <{root.tag}>, not a <robot>.", "Name a URDF file.", root)
        return
    if not root.attributes.get("name"):
        urdf.say("Y1342", "<robot> has no name.", 'Write <robot name="..." version="1.1">.', root)
    version = root.attributes.get("version", "1.0")
    if version not in ("1.0", "1.1", "1.2"):
        message = f'The URDF\'s version is "{version}", but must be 1.0, 1.1 or 1.2.'
        urdf.say("Y1341", message, 'Write version="1.1".', root, "version")


def _is_small(urdf: Urdf, root: Element) -> bool:
    """Return True if the URDF has few enough links and joints to be read. Otherwise report that it has too
    many, and nothing else.
    """
    for tag in ("link", "joint"):
        elements = root.all(tag)
        if len(elements) > MOST_LINKS:
            message = f"The URDF has {len(elements):,} {tag}s, more than {MOST_LINKS:,}."
            remedy = "Keep only the links of the arm and of the bodies on it."
            urdf.say("Y1341", message, remedy, elements[MOST_LINKS])
            return False
    return True


def _read_links(urdf: Urdf, root: Element) -> bool:
    links = root.all("link")
    if not links and root.tag == "robot":
        urdf.say(
            "Y1342",
            "<robot> has no <link>.",
            "A robot needs a link for its base and one for each joint.",
            root,
        )
    return _register(urdf, links, urdf.links, lambda link: link)


def _read_joints(urdf: Urdf, root: Element) -> bool:
    return _register(urdf, root.all("joint"), urdf.joints, lambda joint: _read_joint(urdf, joint))


def _register(
    urdf: Urdf, elements: list[Element], names: dict[str, Any], read: Callable[[Element], object | None]
) -> bool:
    """Register XML elements of a URDF by their names.

    Args:
        urdf: the URDF, which collects the findings.
        elements: the elements.
        names: dictionary that receives the result of `read` for each name.
        read: function that reads an element, and returns None if the element can't be read.

    Returns:
        False if an element has no name, a wrong name or the name of an earlier element, or can't be read.
    """
    sound = True
    first: dict[str, Element] = {}
    for element in elements:
        name = element.attributes.get("name", "")
        item = read(element)
        if not name:
            urdf.say("Y1342", f"<{element.tag}> has no name.", f'Write <{element.tag} name="...">.', element)
        elif not _NAME.fullmatch(name):
            message = f"The name \"{name[:40]}\" has letters that a robot's names can't have."
            urdf.say("Y1343", message, "Use ASCII letters, digits, and . _ - only.", element, "name")
        elif name == _ROOT and element.tag == "joint":
            message = f"A joint has the name {_ROOT}, which readers of URDF use for the joint above the root."
            urdf.say("Y1343", message, "Give the joint another name.", element, "name")
        elif name in first:
            line = bisect.bisect_right(urdf.starts, first[name].start)
            message = f"A second {element.tag} {name}; the first is in line {line}."
            urdf.say("Y1344", message, "Give one of the two another name.", element, "name")
        elif item is not None:
            first[name], names[name] = element, item
            continue
        else:
            first[name] = element
        sound = False
    return sound


def _read_joint(urdf: Urdf, joint: Element) -> Joint | None:
    """Return a joint with its numbers; None, with findings, if the joint's element has mistakes."""
    name, kind = joint.attributes.get("name", ""), joint.attributes.get("type", "")
    urdf.once(joint, ("parent", "child", "origin", "axis", "limit", "mimic", "dynamics"))
    before = len(urdf.findings)
    ends = [_link_of(urdf, joint, tag) for tag in ("parent", "child")]
    if not kind:
        urdf.say("Y1342", f"Joint {name} has no type.", 'Write type="revolute".', joint)
    elif kind not in (*MOVING, *UNARMED, "fixed"):
        message = f'Joint {name} has the type "{kind[:40]}", which URDF doesn\'t know.'
        urdf.say("Y1351", message, "Use revolute, continuous, prismatic or fixed.", joint, "type")
    origin, axis, limit = joint.first("origin"), joint.first("axis"), joint.first("limit")
    xyz = urdf.numbers(origin, "xyz", 3, (0.0, 0.0, 0.0))
    rpy = turned(urdf, origin)
    direction = urdf.numbers(axis, "xyz", 3, None if axis else (1.0, 0.0, 0.0))
    length = math.hypot(*direction) if direction else 1.0
    if length < 1e-6 and kind in MOVING and axis is not None:
        message = f"The axis of joint {name} has the length {length:g}, so it has no direction."
        urdf.say("Y1352", message, 'Write for example <axis xyz="0 0 1"/>.', axis, "xyz")
    if limit is None and kind in ("revolute", "prismatic"):
        remedy = "Add <limit lower upper velocity effort>; a joint without end stops is continuous."
        urdf.say("Y1342", f"Joint {name} is {kind} and has no <limit>.", remedy, joint)
    lower = _limit(urdf, limit, "lower", required=False)
    upper = _limit(urdf, limit, "upper", required=False)
    if limit is not None and lower is not None and upper is not None and lower > upper:
        message = f"The lower limit of joint {name}, {lower:g}, is above the upper one, {upper:g}."
        urdf.say("Y1316", message, "Swap the two.", limit, "lower")
    velocity = _limit(urdf, limit, "velocity", required=True)
    _limit(urdf, limit, "effort", required=True)
    _check_mimic(urdf, name, joint.first("mimic"))
    for tag, needed in _ATTRIBUTES.items():
        extra = joint.first(tag)
        if extra is not None:
            _check_attributes(urdf, extra, needed)
    if len(urdf.findings) > before or not (ends[0] and ends[1] and xyz and rpy and direction):
        return None
    unit = tuple(part / length for part in direction) if length else direction  # a fixed joint needs no axis
    return Joint(name, kind, ends[0], ends[1], xyz, rpy, unit, lower, upper, velocity, joint)


_ATTRIBUTES = {
    "safety_controller": (("k_velocity",), ("soft_lower_limit", "soft_upper_limit", "k_position")),
    "dynamics": ((), ("damping", "friction")),
    "calibration": ((), ("rising", "falling", "reference_position")),
}
"""Elements of a joint that have no effect here, with their required and optional attributes. Pinocchio
rejects a URDF in which they are wrong.
"""


def _check_attributes(urdf: Urdf, place: Element, keys: tuple[tuple[str, ...], tuple[str, ...]]) -> None:
    needed, optional = keys
    if not needed and not any(key in place.attributes for key in optional):
        remedy = f"Write {' or '.join(optional)}, or remove the element."
        urdf.say("Y1342", f"<{place.tag}> is empty.", remedy, place)
    for key in (*needed, *optional):
        value = urdf.numbers(place, key, 1, None if key in needed else (0.0,))
        if value is not None and value[0] < 0.0 and key in ("damping", "friction"):
            message = f"The {key} of a joint is {value[0]:g}, but must not be negative."
            urdf.say("Y1346", message, "Give a positive value.", place, key)


def _check_mimic(urdf: Urdf, name: str, mimic: Element | None) -> None:
    if mimic is None:
        return
    if not mimic.attributes.get("joint"):
        remedy = 'Write <mimic joint="..."/> with the joint that it follows.'
        urdf.say("Y1342", f"<mimic> of joint {name} has no joint.", remedy, mimic)
    urdf.numbers(mimic, "multiplier", 1, (1.0,))
    urdf.numbers(mimic, "offset", 1, (0.0,))


def turned(urdf: Urdf, origin: Element | None) -> tuple[float, ...] | None:
    """Return roll, pitch and yaw [rad] of an <origin>. An <origin> with a quaternion, as newer URDFs have it,
    is rejected with a finding.
    """
    if origin is not None and "quat_xyzw" in origin.attributes:
        message = "The origin is turned by quat_xyzw, which older readers of URDF ignore."
        urdf.say("Y1341", message, "Write the same rotation as rpy.", origin, "quat_xyzw")
        return None
    return urdf.numbers(origin, "rpy", 3, (0.0, 0.0, 0.0))


def _limit(urdf: Urdf, limit: Element | None, key: str, *, required: bool) -> float | None:
    if limit is None or (key not in limit.attributes and not required):
        return None
    value = urdf.numbers(limit, key, 1)
    if value is not None and value[0] < 0.0 and key in ("velocity", "effort"):
        message = f"The {key} of a joint is {value[0]:g}, but must not be negative."
        urdf.say("Y1346", message, f"Give the largest {key}, without a sign.", limit, key)
    return value[0] if value else None


def _link_of(urdf: Urdf, joint: Element, tag: str) -> str:
    name, end = joint.attributes.get("name", ""), joint.first(tag)
    if end is None:
        remedy = f'Add <{tag} link="..."/> with the name of the link.'
        urdf.say("Y1342", f"Joint {name} has no <{tag}>.", remedy, joint)
    elif not end.attributes.get("link"):
        urdf.say("Y1342", f"<{tag}> of joint {name} has no link.", f'Write <{tag} link="..."/>.', end)
    else:
        return end.attributes["link"]
    return ""


def _check_tree(urdf: Urdf) -> bool:
    """Return True if the joints connect all links to one tree. Otherwise report why they don't."""
    before = len(urdf.findings)
    for joint in urdf.joints.values():
        for tag, link in (("parent", joint.parent), ("child", joint.child)):
            end = joint.element.first(tag)
            if link not in urdf.links and end is not None:
                message = (
                    f"The {tag} of joint {joint.name} is the link {link[:40]}, which the URDF doesn't have."
                )
                remedy, subject = did_you_mean(link, urdf.links)
                urdf.say("Y1347", message, remedy, end, "link", subject)
    if len(urdf.findings) > before:
        return False
    above: dict[str, Joint] = {}
    for joint in urdf.joints.values():
        if joint.child in above:
            message = (
                f"Link {joint.child} is the child of two joints, {above[joint.child].name} and {joint.name}."
            )
            remedy = "An arm is a tree: let one of the joints move another link."
            urdf.say("Y1348", message, remedy, joint.element.first("child") or joint.element, "link")
        above.setdefault(joint.child, joint)
    if len(urdf.findings) > before:
        return False
    for loop in _loops(above):
        names = ", ".join(joint.name for joint in loop)
        remedy = "Attach the first of them to the base."
        urdf.say("Y1350", f"The joints {names} form a circle.", remedy, loop[0].element)
    roots = [link for link in urdf.links if link not in above]
    for root in roots[1:]:
        message = f"Links {roots[0]} and {root} are both roots, children of no joint: there must be one root."
        urdf.say("Y1349", message, f"Add a joint whose child is {root}.", urdf.links[root], "name")
    return len(urdf.findings) == before


def _loops(above: dict[str, Joint]) -> Iterator[list[Joint]]:
    """Yield each closed loop of joints once."""
    passed: set[str] = set()
    for link in above:
        path: dict[str, Joint] = {}
        at = link
        while at in above and at not in passed and at not in path:
            path[at] = above[at]
            at = above[at].parent
        if at in path:
            chain = list(path.values())
            start = list(path).index(at)
            yield sorted(chain[start:], key=lambda joint: joint.element.start)
        passed.update(path)
