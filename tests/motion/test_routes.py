"""Tests of choosing the configuration of a target: the nearest one, or another one if a later motion needs
it.
"""

import numpy as np
import pytest
from floors import exercises
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import codes, planned

HEAD = "DEFAULT {TCP} [MIN] (mm,deg,s) {B}\nINPUT DOOR M11\nJOINTS NEARER 90 10 -60 0 -40 180\n"
AWAY = "P0010 MOVEJ 120 0 0 0 -30 0\n"
TARGET = "P0020 MOVEJ_RPY 900 0 900 0 0 -90\n"
LINE = "P0030 MOVEL 900 400 900 0 0 -90\n"


def applied(text, fix):
    """Return a text with the edits of a fix, made from the last to the first."""
    lines = text.splitlines(keepends=True)
    for edit in sorted(fix.edits, key=lambda one: (one.span.line, one.span.column), reverse=True):
        line = lines[edit.span.line - 1]
        lines[edit.span.line - 1] = (
            line[: edit.span.column - 1] + edit.text + line[edit.span.end_column - 1 :]
        )
    return "".join(lines)


def ends(plan):
    return np.degrees([motion.curve.points[-1] for motion in plan.motions])


def test_a_target_is_taken_so_that_the_next_line_can_be_done():
    plan, diagnostics = planned(HEAD + AWAY + TARGET + LINE)
    (one,) = diagnostics
    assert (one.severity, one.code, one.span.line) == ("warning", "Y0802", 5)
    assert "J1 -90.0 instead of 90.0 deg" in one.message
    assert "P0030" in one.message
    nearest, _ = planned(HEAD + AWAY + TARGET)
    assert ends(nearest)[1][0] == pytest.approx(90)
    assert ends(plan)[1][0] == pytest.approx(-90)


def test_its_fix_takes_the_finding_away_and_changes_no_motion():
    text = HEAD + AWAY + TARGET + LINE
    plan, (one,) = planned(text)
    fixed, diagnostics = planned(applied(text, one.fix))
    assert codes(diagnostics) == []
    for first, second in zip(plan.motions, fixed.motions, strict=True):
        assert np.array_equal(first.curve.points, second.curve.points)
        assert first.curve.segment == second.curve.segment


def test_where_the_nearest_does_nothing_is_said():
    assert codes(planned(HEAD + AWAY + TARGET)[1]) == []
    assert codes(planned(HEAD + AWAY + TARGET + "P0030 MOVEJ 0 0 0 0 -30 0\n")[1]) == []


def test_near_is_kept_even_where_another_one_would_help():
    _, diagnostics = planned(HEAD + AWAY + TARGET.replace("\n", " NEAR NEARER\n") + LINE)
    assert codes(diagnostics) == ["Y0801"]


def test_nothing_helps_so_the_motion_s_own_error_stays():
    _, diagnostics = planned(HEAD + AWAY + TARGET + "P0030 MOVEL -900 0 900 0 0 -90\n")
    assert codes(diagnostics) == ["Y0801"]
    assert diagnostics[0].span.line == 6


def test_it_reaches_back_over_what_follows_from_it():
    between = "P0021 DMOVE 0 0 20 0 0 0\nP0022 WAIT [1]\nP0023 DMOVE 0 0 -20 0 0 0\n"
    plan, diagnostics = planned(HEAD + AWAY + TARGET + between + LINE)
    assert [(one.code, one.span.line) for one in diagnostics] == [("Y0802", 5)]
    assert ends(plan)[1][0] == pytest.approx(-90)


def test_a_written_position_between_ends_it():
    """A motion after a given joint position begins there, so no earlier choice can be the cause."""
    _, diagnostics = planned(HEAD + AWAY + TARGET + "P0025 MOVEJ NEARER\n" + LINE.replace("400", "500"))
    assert "Y0802" not in codes(diagnostics)


def test_the_last_way_point_of_a_spline_can_be_chosen_too():
    spline = "P0020 MOVEJ_SPLINE 100 0 0 0 -40 0; 90 10 -20 0 -40 20\n"
    with_pose = "P0020 MOVEJ_SPLINE_RPY 700 700 900 0 0 -45; 900 0 900 0 0 -90\n"
    assert "Y0802" not in codes(planned(HEAD + AWAY + spline)[1])
    plan, diagnostics = planned(HEAD + AWAY + with_pose + LINE)
    assert plan is not None
    assert not [one for one in diagnostics if one.is_error]


def test_inside_a_way_of_a_when():
    ways = (
        "WHEN DOOR ON\n" + TARGET + LINE + "P0040 MOVEJ 0 0 0 0 -30 0\nELSE\nP0050 MOVEJ 0 0 0 0 -30 0\nEND\n"
    )
    plan, diagnostics = planned(HEAD + AWAY + ways)
    assert [(one.code, one.span.line) for one in diagnostics] == [("Y0802", 6)]
    assert plan is not None


def test_what_came_before_a_when_is_fixed_behind_it():
    """Both branches of the WHEN begin at the target. A motion after the WHEN doesn't change the target's
    configuration.
    """
    ways = "WHEN DOOR ON\nP0025 WAIT [1]\nEND\n"
    _, diagnostics = planned(HEAD + AWAY + TARGET + ways + LINE)
    assert codes(diagnostics) == ["Y0801"]


def test_a_way_of_a_when_may_choose_what_came_before_it():
    ways = "WHEN DOOR ON\n" + LINE + "P0040 MOVEL 900 0 900 0 0 -90\nEND\n"
    plan, diagnostics = planned(HEAD + AWAY + TARGET + ways)
    assert set(codes(diagnostics)) <= {"Y0802", "Y0702"}
    assert plan is not None


def test_in_a_loop_each_place_is_judged_and_one_finding_told():
    text = HEAD + "REPEAT I 3\n" + AWAY + TARGET + LINE + "END\n"
    plan, diagnostics = planned(text)
    assert plan is not None
    assert {one.code for one in diagnostics} == {"Y0802"}
    turns = ends(plan)[1::3, 0]
    assert turns == pytest.approx([-90] * 3)
    # No fix is offered, because a change of one line would change all passes.
    assert all(one.fix is None for one in diagnostics)


@exercises(planned=0.4)
@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_without_a_reason_it_is_the_nearest_of_all_solutions(tally, seed):
    random = np.random.default_rng(seed)
    place = np.array([0, 1000, 1000]) + random.uniform(-150, 150, 3)
    rpy = random.uniform(-25, 25, 3)
    stands = np.array([0, -10, -40, 0, 50, 0]) + random.uniform(-30, 30, 6)
    text = (
        f"DEFAULT {{TCP}} [MIN] (mm,deg,s) {{B}}\nP0010 MOVEJ {' '.join(f'{q:.3f}' for q in stands)}\n"
        f"P0020 MOVEJ_RPY {' '.join(f'{value:.3f}' for value in [*place, *rpy])}\n"
    )
    plan, diagnostics = planned(text)
    tally.count("planned", plan is not None)
    if plan is None:
        assert "Y0502" in codes(diagnostics) or "Y0501" in codes(diagnostics)
        return
    from yarclang.robot.kinematics.fk import flange_poses
    from yarclang.robot.kinematics.nearest import full_turns, nearest_solutions

    robot = plan.robot
    start, end = plan.motions[1].path.start, plan.motions[1].path.end
    solved = nearest_solutions(robot.chain, robot.limits, flange_poses(robot.chain, end[None])[0], robot.home)
    every = np.concatenate([full_turns(robot.chain, robot.limits, q) for q in solved.q])
    assert np.square(every - start).sum(axis=1).min() >= np.square(end - start).sum() - 1e-6
