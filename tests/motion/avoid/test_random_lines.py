"""Tests of MOVEL_AVOID in random cells. What is found is clear of all bodies and on straight legs, by samples
with other geometry. If nothing is found, the finding has one of the codes for this case.
"""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, compiled

from tests.floors import exercises
from tests.motion.avoid.cells import ROBOT, box, loading
from tests.motion.avoid.test_way import worst
from yarclang.hir import LineMove
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.transforms import roll_pitch_yaw
from yarclang.units import DEG, MM

REASONS = {"Y0501", "Y0502", "Y0921", "Y0922", "Y0923"}
"""Codes of findings that may refuse a line around obstacles. A collision of a leg isn't among them."""


def problem(seed):
    """Return a program with one MOVEL_AVOID, and boxes, the first of which is halfway on the line."""
    draw = np.random.default_rng(seed)
    limits = ROBOT.limits
    for _ in range(8):  # in most programs, the arm is clear of the boxes at both ends
        start = np.radians([0, 15, -30, 0, -40, 0] + draw.uniform(-1, 1, 6) * [60, 25, 25, 30, 30, 60])
        start = np.round(start / DEG, 3) * DEG
        goal = np.clip(start + draw.uniform(-0.6, 0.6, 6), limits.lower + 0.02, limits.upper - 0.02)
        poses = flange_poses(ROBOT.chain, np.stack([start, goal]))
        ends = poses[:, :3, 3]
        boxes = [
            box(f"B{number}", ends.mean(axis=0) + draw.uniform(-0.3, 0.3, 3) * (number > 0),
                draw.uniform(0.03, 0.15, 3), 0.002)
            for number in range(draw.integers(1, 4))
        ]  # fmt: skip
        if draw.random() < 0.25 or worst(np.stack([start, goal]), *boxes) > 0.0:
            break
    values = [*(ends[1] / MM), *(roll_pitch_yaw(poses[1, :3, :3]) / DEG)]
    text = (
        f'CELL "cell.toml"\nJOINTS HERE {" ".join(f"{one:.3f}" for one in start / DEG)} (deg)\nSTART HERE\n'
        f"P0010 MOVEL_AVOID {{FLANGE}} {' '.join(f'{one:.4f}' for one in values)} [MIN] (mm,deg) {{B}}"
    )
    return text, boxes


@exercises(found=0.5, round=0.2)
@settings(max_examples=8)
@given(seed=st.integers(0, 2**31))
def test_what_is_found_is_straight_and_free(tally, seed):
    text, boxes = problem(seed)
    value, found = compiled(text, load_cell=loading(*boxes))
    tally.count("found", value is not None)
    tally.count("round", value is not None and len(value.plan.motions) > 1)
    if value is None:
        assert {one.code for one in found if one.is_error} <= REASONS, codes(found)
        return
    begin = flange_poses(ROBOT.chain, value.plan.program.start[None])[0, :3, 3]
    for motion in value.plan.motions:
        step = value.plan.program.steps[motion.step]
        assert isinstance(step, LineMove)
        q = motion.curve.sample(np.linspace(0.0, motion.curve.duration, 60))[0]
        assert worst(q, *boxes) > 0.0
        end = step.goal.base_from_moving[:3, 3]
        places = flange_poses(ROBOT.chain, q)[:, :3, 3]
        along = np.clip(
            (places - begin) @ (end - begin) / max((end - begin) @ (end - begin), 1e-12), 0.0, 1.0
        )
        off = places - begin - along[:, None] * (end - begin)
        assert np.linalg.norm(off, axis=1).max() < ROBOT.tolerance.position
        begin = end
