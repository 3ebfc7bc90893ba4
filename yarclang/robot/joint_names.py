"""Names of joints: the names in the URDF, and the short names J1, J2 and so on in the robot's order."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

_NUMBERED = re.compile(r"J[0-9]+", re.IGNORECASE)


def has_short_names(names: Sequence[str]) -> bool:
    """Return True if the joints may be called J1, J2 and so on, in their order.

    They may not if a joint's own name is of this form: in an arm with joints J0 to J5, J1 would be ambiguous.
    """
    return not any(_NUMBERED.fullmatch(name) for name in names)


def numbers_by_name(names: Sequence[str]) -> Mapping[str, int]:
    """Return the number of each joint, from 0, under each of its names in upper case."""
    found = (
        {f"J{number}": number - 1 for number in range(1, len(names) + 1)} if has_short_names(names) else {}
    )
    return found | {name.upper(): number for number, name in enumerate(names)}


def joint_number(names: Sequence[str], name: str) -> int | None:
    """Return the number of the joint with this name, from 0, or None if no joint has it. Case is ignored.

    Args:
        names: the robot's joint names.
        name: the joint's name in the URDF, or its short name, such as J2.
    """
    return numbers_by_name(names).get(name.upper())


def joint_labels(names: Sequence[str]) -> tuple[str, ...]:
    """Return the joints' names for people, such as `J2 shoulder_lift_joint`. They are the URDF's names alone
    if the robot has no short names.
    """
    if not has_short_names(names):
        return tuple(names)
    return tuple(f"J{number} {name}" for number, name in enumerate(names, 1))


def short_labels(names: Sequence[str]) -> tuple[str, ...]:
    """Return the shortest unambiguous names of the joints: J1, J2 and so on, or else their names in the
    URDF.
    """
    return tuple(f"J{number + 1}" for number in range(len(names))) if has_short_names(names) else tuple(names)


def listed_joints(names: Sequence[str]) -> str:
    """Return the list of all joints for a message about an unknown joint:
    `J1 (shoulder_pan_joint), J2 (...)`.
    """
    if not has_short_names(names):
        return ", ".join(names)
    return ", ".join(f"J{number} ({name})" for number, name in enumerate(names, 1))
