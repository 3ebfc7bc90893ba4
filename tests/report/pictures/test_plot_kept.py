"""Rows of the plot for the rules of KEEP."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from yarclang.certify.bodies.sights import seen_at
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import plan_module
from yarclang.report.kept import held_rules, measured
from yarclang.report.pictures.kept import MOST_ROWS, kept_rows_of
from yarclang.report.pictures.plot import _figure, draw
from yarclang.robot.kinematics.fk import tool_poses

HEAD = """\
ROBOT INDUSTRIAL6
FRAME {TABLE} 0 500 200 0 20 0 (mm,deg) {B}
DEFAULT {TCP} [50%] (mm,deg,s) {B}
P0010 MOVEJ_RPY -450 850 800 0 0 0
"""

ALL = (
    HEAD
    + """\
KEEP {TCP} UPRIGHT 40 (deg) {TABLE}
  KEEP {TCP} ABOVE -50 (mm) {TABLE}
    P0020 MOVEJ_RPY -300 850 900 0 0 0
  END
END
P0030 MOVEJ_RPY -300 850 1000 0 30 0
KEEP {TCP} UPRIGHT 40 (deg) {TABLE}
  P0040 MOVEJ_RPY -300 850 900 0 0 0
  P0050 WAIT [1]
  KEEP {TCP} SEEN 85 100 2000 (deg,mm) {TABLE}
    P0060 MOVEL -200 850 900 0 0 0 [10]
  END
END
"""
)

CELL = """\
units = "mm,deg,s"

[[keep]]
frame = "TCP"
rule = "above"
distance = 100
"""


def plan_of(folder: Path, text: str, cell: str = "") -> MotionPlan:
    """Return the plan of a program, with a cell if one is given."""
    (folder / "program.yarc").write_text(text)
    (folder / "cell.toml").write_text(cell)
    opened = open_program(
        str(folder / "program.yarc"), Options(cell=str(folder / "cell.toml") if cell else None)
    )
    assert opened.value is not None, opened.diagnostics
    planned = plan_module(opened.value.module, opened.value.request)
    assert planned.value is not None, planned.diagnostics
    return planned.value


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> MotionPlan:
    return plan_of(tmp_path_factory.mktemp("kept"), ALL, CELL)


def test_rules_hold_from_their_first_motion_to_their_last(made: MotionPlan) -> None:
    above_b, upright, above, seen = held_rules(made)
    begins, ends = made.begins, made.ends
    assert [one.keep.words for one in (above_b, upright, above, seen)] == [
        "{TCP} ABOVE 100 (mm) {B}",
        "{TCP} UPRIGHT 40 (deg) {TABLE}",
        "{TCP} ABOVE -50 (mm) {TABLE}",
        "{TCP} SEEN 85 100 2000 (deg,mm) {TABLE}",
    ]
    assert (above_b.begins, above_b.ends) == (begins[:1], ends[-1:])
    assert upright.begins == pytest.approx([begins[1], begins[3]])
    # one stretch, which includes the WAIT between two motions
    assert upright.ends == pytest.approx([ends[1], ends[4]])
    assert (above.begins, above.ends) == (begins[1:2], ends[1:2])
    assert (seen.begins, seen.ends) == (begins[4:5], ends[4:5])


def test_the_rows_are_the_angles_and_distances_of_the_sampled_poses(made: MotionPlan) -> None:
    rows = kept_rows_of(made)
    assert [row.title.rpartition(": ")[2] for row in rows] == [
        "distance [mm]",
        "angle [deg]",
        "distance [mm]",
        "angle [deg]",
        "distance [mm]",
    ]
    limits = [(row.quantity.least, row.quantity.most) for row in rows]
    wanted = [(100.0, None), (None, 40.0), (-50.0, None), (None, 85.0), (100.0, 2000.0)]
    for found, one in zip(limits, wanted, strict=True):
        assert found == pytest.approx(one)
    robot, table = made.robot, np.array([0.0, 0.5, 0.2])
    axis = np.array([np.sin(np.radians(20.0)), 0.0, np.cos(np.radians(20.0))])
    (sight,) = (one.keep.region for one in held_rules(made) if one.keep.kind == "SEEN")
    for number, row in enumerate(rows):
        q = made.sample(row.times)[0]
        tcp = tool_poses(robot.chain, q, robot.flange_from_frame["TCP"])
        match number:
            case 0:
                found = tcp[:, 2, 3] * 1e3
            case 1:
                found = np.degrees(np.arccos(np.clip(tcp[:, :3, 2] @ axis, -1.0, 1.0)))
            case 2:
                found = (tcp[:, :3, 3] - table) @ axis * 1e3
            case _:
                # computed with the judge's own kinematics
                both = np.array([seen_at(robot.chain, sight, one) for one in q])
                found = np.degrees(both[:, 0]) if number == 3 else both[:, 1] * 1e3
        np.testing.assert_allclose(row.quantity.values, found, atol=1e-5)


def test_the_values_at_the_goals_are_those_of_the_text(made: MotionPlan) -> None:
    rows = kept_rows_of(made)
    # {TABLE} is rotated by 20 deg about y, and the tool is upright
    assert rows[1].quantity.values[-1] == pytest.approx(20.0, abs=1e-4)
    turn = np.radians(20.0)
    above = -300.0 * np.sin(turn) + (900.0 - 200.0) * np.cos(turn)
    assert rows[2].quantity.values[-1] == pytest.approx(above, abs=1e-3)
    assert rows[4].quantity.values[-1] == pytest.approx(np.sqrt(200.0**2 + 350.0**2 + 700.0**2), abs=1e-3)


def test_a_curve_has_no_samples_while_its_rule_doesn_t_hold(made: MotionPlan) -> None:
    row = kept_rows_of(made)[1]
    inside = (row.begins[:, None] <= row.times + 1e-12) & (row.times <= row.ends[:, None] + 1e-12)
    assert inside.any(axis=0).all()
    assert row.times[row.breaks] == pytest.approx(row.begins)


def test_a_broken_rule_is_drawn_beyond_its_limit(made: MotionPlan) -> None:
    """The rows contain measured values, which aren't cut off at the limit."""
    (upright,) = (one.keep for one in held_rules(made) if one.keep.kind == "UPRIGHT")
    (angle,) = measured(upright, made.robot.chain, made.robot.home[None] + 0.9)
    assert angle.values[0] > angle.most


@pytest.mark.parametrize("count", [1, MOST_ROWS, MOST_ROWS + 3])
def test_rows_are_limited_in_number(tmp_path: Path, count: int) -> None:
    rules = [f"KEEP {{TCP}} UPRIGHT {90 - number} (deg)" for number in range(count)]
    text = "\n".join((HEAD, *rules, "P0020 MOVEJ_RPY -300 850 900 0 0 0", *("END" for _ in rules), ""))
    figure = _figure(plan_of(tmp_path, text))
    titles = [one.get_title(loc="left") for one in figure.axes]
    assert sum(one.startswith("KEEP") for one in titles) == min(count, MOST_ROWS)
    notes = [one.get_title(loc="center") for one in figure.axes]
    assert ("3 more aren't drawn" in notes) == (count == MOST_ROWS + 3)


def test_without_a_rule_or_a_motion_there_is_no_row(tmp_path: Path) -> None:
    assert kept_rows_of(plan_of(tmp_path, HEAD)) == ()
    assert kept_rows_of(plan_of(tmp_path, "ROBOT INDUSTRIAL6\nP0010 WAIT [1] (s)\n", CELL)) == ()


def test_the_limits_are_drawn_only_while_the_rule_holds(made: MotionPlan) -> None:
    (axes,) = (one for one in _figure(made).axes if "UPRIGHT" in one.get_title(loc="left"))
    lines = [path.vertices for one in axes.collections for path in one.get_paths()]
    assert np.array([line[:, 1] for line in lines]) == pytest.approx(40.0)
    assert np.array([line[:, 0] for line in lines]) == pytest.approx(
        np.column_stack([made.begins[[1, 3]], made.ends[[1, 4]]])
    )
    assert draw(made, "png") == draw(made, "png")
