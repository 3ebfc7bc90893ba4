"""Check the motors and the controller of a robot.toml (the paper's eq. 5, TSRM 269)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from yarclang.robot.kinds import kind_of
from yarclang.robot.model import Array
from yarclang.toml.file import TomlFile, right_length
from yarclang.toml.places import Path

if TYPE_CHECKING:
    from yarclang.robot.draft import RobotDraft


WORST_CONDITION = 1e6


def check_drives(file: TomlFile, draft: RobotDraft, size: int) -> None:
    """Report all findings about [actuation], [motors] and [controller] of a robot with `size` joints."""
    _check_actuation(file, draft, size)
    _check_controller(file, draft, size)


def _check_actuation(file: TomlFile, draft: RobotDraft, size: int) -> None:
    actuation = draft.table.actuation
    if actuation is None:
        return
    gear, coupling = actuation.K, actuation.J
    if gear is not None and right_length(file, ("actuation", "K"), gear, size, "value", "joint"):
        for at, value in enumerate(gear):
            if abs(value) < 1e-6:
                message = f"K[{at + 1}] is {value:g} counts per axis unit, so motor {at + 1} would not move."
                remedy = "Give the counts of one deg (or mm); a minus sign reverses the direction."
                file.say("Y1319", ("actuation", "K", at), message, remedy)
    if actuation.a0 is not None:
        right_length(file, ("actuation", "a0"), actuation.a0, size, "value", "joint")
    if coupling is None or not right_length(file, ("actuation", "J"), coupling, size, "row", "joint"):
        return
    rows = [
        right_length(file, ("actuation", "J", at), row, size, "value", "joint")
        for at, row in enumerate(coupling)
    ]
    if all(rows):
        _check_coupling(file, draft, np.array(coupling, dtype=np.float64).reshape(size, size))


def _check_coupling(file: TomlFile, draft: RobotDraft, coupling: Array) -> None:
    """Check that the coupling matrix J can be inverted, and that the controller can couple the axes that J
    couples.
    """
    controller = draft.table.controller
    axes = controller.axes if controller else None
    kind = kind_of(controller.kind) if controller else None
    groups = _groups(coupling)
    uneven = [(motors, joints) for motors, joints in groups if len(motors) != len(joints)]
    for motors, joints in uneven[:1]:  # one uneven group implies another: report only the first
        message = (
            f"J couples {_count(len(motors), 'motor')} (number {_listed(motors)}) "
            f"with {_count(len(joints), 'joint')} (number {_listed(joints)})."
        )
        if not motors or not joints:
            message = f"{'Column' if joints else 'Row'} {_listed(joints or motors)} of J has only zeros."
        path: Path = ("actuation", "J", motors[0]) if motors else ("actuation", "J")
        file.say("Y1325", path, message, "Give coupled joints as many motors as joints.")
    condition = float(np.linalg.cond(coupling)) if len(coupling) and not uneven else 1.0
    if not condition < WORST_CONDITION:
        message = f"J can't be inverted: its condition number is {condition:.3g}, and must be below 1e6."
        file.say("Y1320", ("actuation", "J"), message, "Make its rows linearly independent.")
    for motors, joints in groups:
        if kind is None or axes is None or len(axes) != len(coupling) or len(joints) < 2 or uneven:
            continue
        letters = [axes[joint] for joint in joints]
        if remedy := kind.not_coupled(letters):
            row = next(row for row in motors if np.count_nonzero(coupling[row]) > 1)
            message = (
                f"Motors {_listed(motors)} couple the axes {', '.join(letters)}, which the controller can't."
            )
            file.say("Y1324", ("actuation", "J", row), message, remedy)


def _groups(
    coupling: Array,
) -> list[tuple[list[int], list[int]]]:
    """Return the groups of motors and joints that nonzero entries of J connect with each other: for each
    group, the numbers of its motors (rows of J) and of its joints (columns of J).
    """
    todo = [("row", at) for at in range(len(coupling))] + [("column", at) for at in range(len(coupling))]
    groups: list[tuple[list[int], list[int]]] = []
    grouped: set[tuple[str, int]] = set()
    for start in todo:
        if start in grouped:
            continue
        group, front = {start}, [start]
        while front:
            kind, at = front.pop()
            line = coupling[at] if kind == "row" else coupling[:, at]
            other = "column" if kind == "row" else "row"
            new = {(other, int(index)) for index in np.flatnonzero(line)} - group
            group |= new
            front += new
        grouped |= group
        motors = sorted(at for kind, at in group if kind == "row")
        groups.append((motors, sorted(at for kind, at in group if kind == "column")))
    return groups


def _check_controller(file: TomlFile, draft: RobotDraft, size: int) -> None:
    motors, controller = draft.table.motors, draft.table.controller
    if motors is not None:
        if motors.numbers is not None:
            path: Path = ("motors", "numbers")
            right_length(file, path, motors.numbers, size, "number", "joint")
            check_twice(file, "Y1323", path, "Motor", [str(number) for number in motors.numbers])
        if motors.velocity is not None:
            right_length(file, ("motors", "velocity"), motors.velocity, size, "value", "joint")
    if controller is None:
        return
    known = kind_of(controller.kind)
    if known is not None:
        known.check(file, controller, size)


def check_twice(file: TomlFile, code: str, path: Path, kind: str, names: Sequence[str]) -> None:
    """Report names that occur twice in a list.

    Args:
        file: the robot.toml, which collects the findings.
        code: the code of the finding.
        path: the keys that lead to the list in the file.
        kind: word for the named things, for the message.
        names: one name for each joint.
    """
    first: dict[str, int] = {}
    for at, name in enumerate(names):
        if name in first:
            message = f"{kind} {name[:20]} belongs to joint {first[name] + 1} and to joint {at + 1}."
            file.say(code, (*path, at), message, "Give each joint its own.")
        first.setdefault(name, at)


def _count(number: int, kind: str) -> str:
    return f"{number} {kind}{'s' * (number != 1)}"


def _listed(indices: Iterable[int]) -> str:
    return ", ".join(str(index + 1) for index in indices)
