"""Random programs whose motions must keep to rules (KEEP: an axis that stays upright, a least height) and may
avoid obstacles (_AVOID).
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from yarclang.campaign.drawing import Drawn, begun, middle_of
from yarclang.independent.arm import Arm, Array
from yarclang.independent.paths import Said
from yarclang.independent.rules import Rule
from yarclang.independent.timetable import numbers

_TIMES = ("[MIN]", "[50%]", "[6]")


def drawn_ruled(arm: Arm, random: np.random.Generator, most: int = 4) -> Drawn:
    """Draw a random program of a few lines and joint motions to poses. Most of them must keep to one or two
    rules: an axis of the tool stays upright, and the tool stays above a height.
    """
    middle = middle_of(arm)
    (point,), turns = arm.poses(middle[None])
    reach = float(np.linalg.norm(point)) / 10.0
    lines, said = begun(arm, middle)
    step = len(said)
    # {UP} is a frame on the tool whose z axis is vertical in the middle position.
    upright = np.round(turns[0].inv().as_euler("xyz", degrees=True), 3)
    lines.append(f"FRAME {{UP}} 0 0 0 {numbers(upright)} {{TCP}}")
    angle = float(random.choice([8.0, 20.0, 40.0]))
    height = round(float(point[2] - random.choice([1.02, 1.3]) * reach), 1)
    rules = (
        Rule("upright", angle, Rotation.from_euler("xyz", upright, degrees=True)),
        Rule("above", height),
    )
    heads = (f"KEEP {{UP}} UPRIGHT {angle:g} (deg)", f"KEEP {{TCP}} ABOVE {height:g} (mm)")
    inside = tuple(int(one) for one in np.flatnonzero(random.random(2) < 0.7))
    count = int(random.integers(2, most + 1))
    outside = int(random.integers(0, count))
    for number in range(count):
        if number == outside:
            lines += [heads[one] for one in inside]
        shift = np.round(point + random.uniform(-1, 1, 3) * reach, 3)
        # The orientation is that of the middle position, turned about the vertical and tilted by less than
        # the rule allows.
        tilt = Rotation.from_rotvec(np.radians(angle) * 0.7 * _direction(random))
        turn = tilt * Rotation.from_euler("z", random.uniform(-40, 40), degrees=True) * turns[0]
        rpy = np.round(turn.as_euler("xyz", degrees=True), 3)
        goal = shift, Rotation.from_euler("xyz", rpy, degrees=True)
        of_joints, avoids = random.random() < 0.35, random.random() < 0.6
        name = f"{'MOVEJ_RPY' if of_joints else 'MOVEL'}{'_AVOID' * avoids}"
        time = str(random.choice(_TIMES))
        kept = tuple(rules[one] for one in inside) if number >= outside else ()
        said[step] = Said(
            "joints" if of_joints else "line", [goal], time=time, avoids=bool(avoids), rules=kept
        )
        lines.append(f"P{(step + 1) * 10:04d} {name} {numbers([*shift, *rpy])} {time}")
        step += 1
    lines += ["END"] * len(inside)
    return Drawn("\n".join(lines) + "\n", said)


def _direction(random: np.random.Generator) -> Array:
    """Return a horizontal vector (3,) no longer than 1."""
    angle, size = random.uniform(0.0, 2.0 * np.pi), random.random()
    return np.asarray(size * np.array([np.cos(angle), np.sin(angle), 0.0]))
