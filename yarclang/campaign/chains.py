"""Random programs with a chain of short motions. They are the longest random programs."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from yarclang.campaign.drawing import SPEEDS, Drawn, begun, middle_of
from yarclang.independent.arm import Arm
from yarclang.independent.paths import Said
from yarclang.independent.timetable import numbers


def drawn_chain(arm: Arm, random: np.random.Generator) -> Drawn:
    """Draw a random program with a chain of short motions: lines, arcs, splines of poses, increments and
    turns of the tool, with stops, outputs and waits between them.
    """
    middle = middle_of(arm)
    (point,), turns = arm.poses(middle[None])
    lines, said = begun(arm, middle)
    step, turn, begin = len(said), turns[0], point
    # A chain has either more than 40 motions or few: the compiler tries several ways to plan parts of up to
    # 40 motions, which takes seconds.
    is_long = random.random() < 0.7
    count = int(random.integers(43, 52)) if is_long else 3
    stops = {count - 3} if is_long and random.random() < 0.4 else set()
    ball = float(random.choice([0.0, 0.3, 0.3]))
    times = random.choice([*SPEEDS, "[MIN]"], 2)
    plane = Rotation.random(random_state=int(random.integers(2**31))).as_matrix()[:, :2]
    bend = float(random.choice([0.02, 0.1, 0.6])) if ball else 0.01
    turning = float(random.choice([0.0, 0.0, 0.3, 1.0]))
    axis, heading = Rotation.random(random_state=int(random.integers(2**31))).as_matrix()[0], 0.0
    still = int(random.integers(count)) if random.random() < 0.1 else None
    for number in range(count):
        kind = str(random.choice(["line", "arc", "pose_spline", "delta"], p=[0.7, 0.12, 0.08, 0.1]))
        size = (
            0.0
            if number == still
            else float(random.uniform(0.7, 3.0)) * (1.0 if kind in ("line", "delta") else 2.0)
        )
        tilt = turning * np.sign((number // 12) % 2 - 0.5) * size + (2.0 if number == still else 0.0)
        # Only the first motions of long chains get a speed: a few short motions may be too short to reach it.
        common: dict[str, Any] = {
            "time": str(times[number * 2 // count]) if is_long and number < count - 2 else "[MIN]",
            "tol": 0.05,
        }
        goals, before = [], (begin, turn)
        for _ in range(2):
            heading += 0.5 * random.normal(0.0, bend) + 0.5 * bend * np.sin(number / 6.0)
            begin = begin + 0.5 * size * plane @ [np.cos(heading), np.sin(heading)]
            turn = Rotation.from_rotvec(np.radians(0.5 * tilt) * axis) * turn
            rpy = np.round(turn.as_euler("xyz", degrees=True), 4)
            goals.append(
                (np.round(begin, 4), rpy, (np.round(begin, 4), Rotation.from_euler("xyz", rpy, degrees=True)))
            )
        (via, rpy, half), (place, last, goal) = goals
        if number == still or kind == "line":
            words, one = f"MOVEL {numbers([*place, *last])}", Said("line", [goal], **common)
        elif kind == "arc":
            words, one = (
                f"MOVEC {numbers(via)}; {numbers([*place, *last])}",
                Said("arc", [goal], via=via, **common),
            )
        elif kind == "pose_spline":
            words = f"MOVEL_SPLINE {numbers([*via, *rpy])}; {numbers([*place, *last])}"
            one = Said("pose_spline", [half, goal], **common)
        else:
            turn = before[1]
            shift = np.round(turn.inv().apply(begin - before[0]), 4)
            begin = before[0] + turn.apply(shift)
            words = f"DMOVE {numbers([*shift, 0, 0, 0])}"
            one = Said("line", [(shift, Rotation.identity())], relative=True, **common)
        options = " TOL 0.05"
        if number < count - 1 and number not in stops:
            one.blend = ball if is_long else min(ball, 0.25)
            options += f" BLEND {one.blend:g}"
        base = " {TCP}" if one.relative else ""
        lines.append(f"P{(step + 1) * 10:04d} {words} {one.time}{base}{options}")
        said[step] = one
        step += 1
        if number in stops or random.random() < 0.03:
            stands = number in stops and random.random() < 0.5
            lines.append(f"P{(step + 1) * 10:04d} {'WAIT [0.1]' if stands else 'SET LAMP ON'}")
            step += 1
    return Drawn("\n".join(lines) + "\n", said)
