"""Write the text of a new robot.toml: every value with its unit and its origin, and every guess with a
mark.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence

from yarclang.robot.controller import Kind
from yarclang.robot.kinds import DEFAULT, kind_of
from yarclang.robot.new.sketch import EASE, RISE, JointSketch, Said, Sketch

MARK = "guess:"
"""Start of the comment of a value that has to be checked. The user deletes the comment after the check."""

MARKED = re.compile(r"^(?!\s*#)(.*?)\s*#.*?\bguess:\s*(.*)$")
"""Pattern of a line with the mark. Its groups are the text before the comment, and the reason for the guess.
"""

_HEAD = """\
# {name}, made by yarc robot new from {made_from}.
# Units: deg and deg/s, deg/s^2, deg/s^3 for joints that turn, mm for those that slide; mm and deg in frames; encoder
# counts for motors; ms for times.
# A comment with "{mark}" marks a value that came from a rule and not from a fact. Check it on the machine or in its
# manual, then delete the mark; yarc robot check lists what is left.
"""  # noqa: E501


_TOOL = (
    (
        "# What hangs on the flange, with its shapes and its mass, is checked for collisions and torques "
        "once it stands here:"
    ),
    "# [tools.GRIPPER]",
    '# frame = "FLANGE"            # or a frame of this file',
    "# mass = 1.8                  # kg",
    "# center_of_mass = [0, 0, 60] # mm",
    "# [[bodies]]",
    '# tool = "GRIPPER"',
    '# shape = "box"               # or cylinder, capsule (radius, length), sphere (radius), mesh (file)',
    "# xyz = [0, 0, 60]            # mm",
    "# size = [80, 60, 120]        # mm",
)


def robot_toml(sketch: Sketch, home: Said) -> str:
    """Return the whole text of a robot.toml.

    Args:
        sketch: all values except HOME.
        home: the joint position HOME.
    """
    chain, size = sketch.chain, len(sketch.joints)
    unit_rows = ["[" + ", ".join("1" if i == j else "0" for j in range(size)) + "]" for i in range(size)]
    lines = [_HEAD.format(name=sketch.name, made_from=_plain(sketch.made_from), mark=MARK)]
    lines += [
        f"name = {_text(sketch.name)}",
        f"title = {_text(sketch.title)}",
        f"urdf = {_text(sketch.urdf)}",
        (
            f"base = {_text(chain.base)}  # the link that is "
            f"{{B}}{_choice(sketch.base_said, chain.base_choices)}"
        ),
        f"flange = {_text(chain.flange)}  # the link that is {{FLANGE}}"
        + _choice(sketch.tip_said, (*chain.flange_choices, *chain.other_tips)),
    ]
    if chain.ignored:
        lines.append(
            "# Moving joints outside the chain: no motor of this robot moves them, they count as "
            "standing at 0."
        )
        lines.append(f"ignored_joints = [{', '.join(_text(name) for name in chain.ignored)}]")
    lines += ["", "# One table a joint of the URDF, in the order from the base to the flange."]
    for joint in sketch.joints:
        lines += _joint(joint)
    lines += _ramps(sketch.joints)
    lines += [
        "[frames.TCP]",
        'parent = "FLANGE"',
        f"xyz = {_list(sketch.tcp.value[:3])}  # mm{_mark(sketch.tcp)}",
        f"rpy = {_list(sketch.tcp.value[3:])}  # deg, R = Rz(yaw) Ry(pitch) Rx(roll){_mark(sketch.tcp)}",
        "",
        "[positions]",
        f"HOME = {_list(home.value)}  # {_units(sketch)}{_mark(home)}",
        "",
        f"# counts = K J q + a0, with q in {_units(sketch)}.",
        "[actuation]",
        f"K = {_list(sketch.gear.value)}  # counts per {_units(sketch)}{_mark(sketch.gear)}",
        f"J = [{', '.join(unit_rows)}]  # {MARK} no joint is coupled with another",
        f"a0 = {_list([0.0] * size)}  # counts; {MARK} the motors read 0 where all joints are at 0",
        "",
        "[motors]",
        f"numbers = [{', '.join(f'{number:.0f}' for number in sketch.motors.value)}]{_tail(sketch.motors)}",
        f"velocity = {_list(sketch.motor_velocity.value)}  # counts/ms{_mark(sketch.motor_velocity)}",
        "",
        *_kind().lines(size),
        "",
        "# How far the executed path may be from the programmed one.",
        "[tolerance]",
        "position = 0.02  # mm",
        "angle = 0.002    # deg",
        "",
        "# How fast the tool goes at most in jogs and other live motions.",
        "[jog]",
        "speed = 250  # mm/s; ISO 10218-1: reduced speed",
        "",
        *_TOOL,
        "",
    ]
    return "\n".join(lines)


def _kind() -> Kind:
    kind = kind_of(DEFAULT)
    assert kind is not None
    return kind


def collision_table(pairs: Sequence[tuple[tuple[str, str], str]]) -> str:
    """Return the table [collision] for the end of a robot.toml; empty if `pairs` is empty. The table allows
    each of these pairs of bodies to touch, and states the reason.
    """
    if not pairs:
        return ""
    lines = [
        "",
        (
            "# Bodies that may touch each other: pairs that always do, because their shapes are larger than "
            "they are. What may"
        ),
        "# really hit each other mustn't stand here.",
        "[collision]",
        "allowed = [",
        *(f"    [{', '.join(_text(name) for name in pair)}],  # {MARK} they {why}" for pair, why in pairs),
        "]",
        "",
    ]
    return "\n".join(lines)


def guesses(text: str) -> tuple[tuple[int, str, str], ...]:
    """Return the guesses that are marked in a robot.toml and so haven't been checked: for each one the line
    number, the text of the line before its comment, and the reason for the guess.
    """
    found = ((number, MARKED.match(line)) for number, line in enumerate(text.splitlines(), 1))
    return tuple((number, match[1].strip(), match[2].strip()) for number, match in found if match)


def _joint(joint: JointSketch) -> list[str]:
    name = joint.name if re.fullmatch(r"[A-Za-z0-9_-]+", joint.name) else _text(joint.name)
    effort = f"  # {joint.kind}"
    if joint.effort > 0.0:
        unit = "N" if joint.unit == "mm" else "N m"
        effort += f"; effort at most {joint.effort:g} {unit} by the URDF"
    lines = [f"[joints.{name}]{effort}"]
    if joint.position is None:
        lines.append("# no position limits: the joint is continuous")
    else:
        lines.append(f"position = {_list(joint.position.value)}{_tail(joint.position)}")
    for key, choice in (
        ("velocity", joint.velocity),
        ("acceleration", joint.acceleration),
        ("jerk", joint.jerk),
    ):
        if choice is not None:
            lines.append(f"{key} = {_number(choice.value[0])}{_tail(choice)}")
    return [*lines, ""]


def _ramps(joints: Sequence[JointSketch]) -> list[str]:
    """Return the lines of the table [ramps], which gives the limits of acceleration and jerk for joints
    without such limits; empty if all joints have both limits.
    """
    lines = []
    if any(joint.acceleration is None for joint in joints):
        lines.append(
            f"rise = {RISE * 1e3:g}  # ms from rest to the velocity limit; {MARK} one rule for all joints"
        )
    if any(joint.jerk is None for joint in joints):
        lines.append(
            f"ease = {EASE * 1e3:g}  # ms up to the acceleration limit; {MARK} one rule for all joints"
        )
    if not lines:
        return []
    why = "# Accelerations and jerks of all joints; a joint's own table may give its own."
    return [why, "[ramps]", *lines, ""]


def _tail(choice: Said) -> str:
    """Return the comment after a value of robot.toml: the reason for a guess, or the URDF as origin; empty
    for a value that the user gave.
    """
    if choice.origin == "guess":
        return f"  # {MARK} {choice.note}"
    return f"  # {choice.note}, from the URDF" if choice.origin == "urdf" else ""


def _mark(choice: Said) -> str:
    """Return the addition to a comment that marks the value as a guess; empty for a value that isn't a
    guess.
    """
    return f"; {MARK} {choice.note}" if choice.origin == "guess" else ""


def _choice(is_chosen: bool, others: Sequence[str]) -> str:
    if is_chosen:
        return ""
    shown = ", ".join(others[:6]) + (", ..." if len(others) > 6 else "")
    return f"; {MARK} it could be {_plain(shown)}"


def _units(sketch: Sketch) -> str:
    units = [joint.unit for joint in sketch.joints]
    return units[0] if len(set(units)) == 1 else f"deg (mm for {_slides(sketch)})"


def _slides(sketch: Sketch) -> str:
    return ", ".join(joint.name for joint in sketch.joints if joint.unit == "mm")


def _list(values: Sequence[float]) -> str:
    return f"[{', '.join(_number(value) for value in values)}]"


def _number(value: float) -> str:
    text = f"{value:.10g}"
    return text if "e" not in text else f"{value:.6f}"


def _text(value: str) -> str:
    """Return a text as a TOML string. JSON's escapes are used, since they are valid in TOML, except for the
    control character DEL.
    """
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def _plain(value: str) -> str:
    """Return a text that can be part of a comment: blanks replace line breaks and unprintable characters."""
    return "".join(character if character.isprintable() else " " for character in value)
