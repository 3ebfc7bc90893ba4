"""Run all items of the checklist in order."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from yarclang.diagnostics import Diagnostic
from yarclang.frozen import frozen
from yarclang.robot.bare_links import bare_links
from yarclang.robot.checklist.drives import drive_items
from yarclang.robot.checklist.geometry import geometry_items
from yarclang.robot.checklist.item import Item
from yarclang.robot.checklist.limits import limit_items
from yarclang.robot.checklist.masses import mass_items
from yarclang.robot.checks import MOST_JOINTS
from yarclang.robot.description import load_robot
from yarclang.robot.library import find_robot
from yarclang.robot.model import Robot
from yarclang.robot.new.writing import guesses
from yarclang.toml.reading import read_text


@frozen(eq=False)
class Checklist:
    """The items of a robot's checklist, and the robot itself, or None if its files can't be read."""

    robot: Robot | None
    items: tuple[Item, ...]

    @property
    def to_do(self) -> int:
        """The number of items that have to be corrected."""
        return sum(item.verdict == "to do" for item in self.items)


def check_robot(name_or_path: str, *further: Callable[[Robot], Iterator[Item]]) -> Checklist:
    """Run the whole checklist for a robot.

    Args:
        name_or_path: the name of a robot of the library, or the path of a robot.toml or of a folder that
            contains one.
        further: functions that yield more items, such as those about collisions. They come from packages
            that import this one.
    """
    loaded = load_robot(name_or_path)
    items = [_finding(finding) for finding in loaded.diagnostics]
    robot = loaded.value
    if robot is None:
        return Checklist(None, tuple(items))
    items += [_finding(finding) for finding in bare_links(robot)]
    items.insert(0, Item("files", "ok", f"robot.toml and {robot.urdf} are read"))
    items.append(_chain(robot))
    items += limit_items(robot)
    items += geometry_items(robot)
    items += drive_items(robot)
    items += mass_items(robot)
    for points in further:
        items += points(robot)
    items += _guesses(name_or_path)
    return Checklist(robot, tuple(items))


def _finding(finding: Diagnostic) -> Item:
    place = f" ({finding.source.name}:{finding.span.line})" if finding.source and finding.span else ""
    message = finding.clause
    return Item(
        finding.code, "to do" if finding.is_error else "note", f"{message}{place}", finding.help.rstrip(".")
    )


def _chain(robot: Robot) -> Item:
    kinds = [kind for kind in ("revolute", "continuous", "prismatic") if kind in robot.joint_kinds]
    counts = ", ".join(f"{robot.joint_kinds.count(kind)} {kind}" for kind in kinds)
    found = f"{robot.size} of 1 to {MOST_JOINTS} joints ({counts}): {', '.join(robot.joint_names)}"
    return Item("chain", "ok", found)


def _guesses(name_or_path: str) -> list[Item]:
    path, _ = find_robot(name_or_path)
    source = read_text(path, "") if path is not None else None
    if source is None or isinstance(source, Diagnostic):
        return []
    unchecked = guesses(source.text)
    if not unchecked:
        return [Item("guesses", "ok", "no value is marked as a guess")]
    remedy = "look it up or measure it, correct it, and delete the mark"
    return [
        Item("guess", "to do", f"line {number}: {value[:60].rstrip()}: {what}", remedy)
        for number, value, what in unchecked
    ]
