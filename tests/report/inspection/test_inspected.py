"""The information about one command."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import source

from yarclang.pipeline.checking import check_text
from yarclang.pipeline.inputs import Options
from yarclang.pipeline.places import labels_of, matching
from yarclang.report.inspection.as_json import inspected_json
from yarclang.report.inspection.inspected import inspect_step, study
from yarclang.report.inspection.text import sections_of
from yarclang.report.pose_text import pose_values
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.semantics.values.poses import rpy_rotation
from yarclang.source import SourceFile
from yarclang.units import DEG

ROBOT = load_robot("INDUSTRIAL6").value
HEAD = """DEFAULT {TCP} [MIN] (mm,deg,s) {B}
FRAME {TABLE} 0 900 700 0 0 0 {B}
FRAME {PART} 0 200 300 0 0 10 {TABLE}
FRAME {TORCH} 0 50 0 10 0 0 (mm,deg) {TCP}
"""


def inspected(text, place):
    studied = study(check_text(source(HEAD + text), Path(), Options(robot="INDUSTRIAL6")))
    return inspect_step(studied, matching(labels_of(studied.program), place)[0])


def words(found, **options):
    return "\n".join(f"{one.title}\n" + "\n".join(one.lines) for one in sections_of(found, **options))


def test_a_timetable_with_what_is_between_its_rows():
    found = inspected(
        "P0010 MOVEJ_TIMED 5 0 0 0 20 0 [1] VEL 0 0 0 0 3 0; 0 0 0 0 10 0 [2] VEL 0 0 0 0 0 0 STRETCH 2\n"
        "P0020 MOVEJ_TIMED 0 0 0 0 90 0 [1]\nP0030 MOVEL 0 1174.4 1176 0 0 0\n",
        "P0010",
    )
    text = words(found)
    assert "timetable: 2 rows with velocities, from 1 to 2 s, all times multiplied by 2" in text
    assert "the cubic polynomial in time with the velocities of both rows" in text
    assert "asked for [4 s]" in text
    assert "no shorter time is possible" not in text
    told = inspected_json(found)
    assert told["timetable"] == {
        "file": None,
        "rows": 2,
        "first_s": 1.0,
        "last_s": 2.0,
        "between": "cubic",
        "stretch": 2.0,
    }
    assert told["profile"] is None


def test_a_pose_with_its_frames_solutions_time_proof_and_lines():
    found = inspected("P0010 MOVEJ_RPY {TORCH} 100 0 0 0 0 0 {PART}\nP0020 MOVEJ 0 0 0 0 0 0\n", "P0010")
    text = words(found)
    assert "{TORCH}" in text.splitlines()[4]
    for name, line in (("TORCH", 4), ("PART", 3), ("TABLE", 2)):
        assert f"{{{name}}}" in text
        assert f"(test.yarc:{line})" in text
    assert "{TORCH} at 100.000 0.000 0.000 mm, 0.0000 0.0000 0.0000 deg in {PART}" in text
    chosen = [one for one in found.waypoints[0].solutions if one.verdict == "chosen"]
    assert len(chosen) == 1
    assert "CHOSEN: nearest" in text
    assert "limited by the" in text
    assert "path within" in text
    stretch = next(one for one in found.stretches if one.what == "a move")
    assert f"lines {stretch.first} to {stretch.last}: moves" in text
    assert len(words(found, all_lines=True).splitlines()) > stretch.last - stretch.first
    json.dumps(inspected_json(found), allow_nan=False)


def test_every_solution_reaches_the_pose_and_is_judged():
    found = inspected("P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0\n", "P0010")
    waypoint = found.waypoints[0]
    flange = waypoint.pose @ np.linalg.inv(waypoint.flange_from_moving)
    q = np.array([one.q for one in waypoint.solutions])
    assert np.abs(flange_poses(ROBOT.chain, q) - flange).max() < 1e-7
    inside = ((q >= ROBOT.limits.lower - 1e-8) & (q <= ROBOT.limits.upper + 1e-8)).all(axis=1)
    assert [one.verdict != "out of limits" for one in waypoint.solutions] == inside.tolist()
    within = [one.distance for one in waypoint.solutions if one.verdict != "out of limits"]
    assert within == sorted(within)
    for one in waypoint.solutions:
        assert one.distance == pytest.approx(np.square(one.q - found.start).sum())
        if one.verdict == "out of limits":
            beyond = np.maximum(one.q - ROBOT.limits.upper, 0) + np.minimum(one.q - ROBOT.limits.lower, 0)
            assert np.allclose(one.excess, beyond)


def test_the_shortest_time_works_and_a_shorter_one_does_not():
    found = inspected("P0010 MOVEJ 30 0 0 0 0 0 [3]\n", "P0010")
    shortest = found.pace.shortest
    assert not found.pace.is_shortest
    works = inspected(f"P0010 MOVEJ 30 0 0 0 0 0 [{shortest}]\n", "P0010")
    assert works.certificate is not None
    fails = inspected(f"P0010 MOVEJ 30 0 0 0 0 0 [{shortest * 0.9}]\n", "P0010")
    assert [one.code for one in fails.findings] == ["Y0601"]
    assert fails.pace.shortest == shortest
    assert "isn't possible; the values below are for the shortest time" in words(fails)
    assert "no shorter time is possible" in words(fails)
    assert "the shortest possible time is " in words(found)


def test_the_limit_agrees_with_the_certificate():
    found = inspected("P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0\n", "P0010")
    shares = {one.kind: one.share for one in found.pace.limits}
    for kind in ("velocity", "acceleration", "jerk"):
        assert shares[kind] == pytest.approx(getattr(found.certificate, kind).share, abs=0.02)


def test_what_a_profile_has_no_limit_of_limits_nothing():
    found = inspected("P0010 MOVEJ_TOPP 60 0 0 0 0 0\n", "P0010")
    assert found.certificate.jerk.share > 1.0
    assert {one.kind for one in found.pace.limits} == {"velocity", "acceleration", "motor speed"}
    assert "limited by the jerk" not in words(found)


# errors elsewhere


def test_errors_elsewhere_leave_what_does_not_depend_on_them():
    text = "P0010 MOVEJ 0 0\nP0020 MOVEJ 0 -10 -20 0 -60 0\nP0030 DMOVE 0 0 20 0 0 0 {B}\n"
    found = inspected(text, "P0030")
    assert found.start == pytest.approx(np.array([0, -10, -20, 0, -60, 0]) * DEG)
    assert found.motion is not None
    assert found.certificate is None
    assert found.findings == ()
    hidden = inspected("P0010 MOVEJ 0 0\nP0030 MOVEJ_RPY 0 1174.4 1176 0 0 0\n", "P0030")
    assert hidden.start is None
    text = words(hidden)
    assert "the position of the robot isn't known, because of errors before this command" in text
    assert "the distance is measured from HOME, because the start isn't known" in text
    json.dumps(inspected_json(hidden), allow_nan=False)


def test_a_pose_out_of_reach_says_by_how_much():
    found = inspected("P0010 MOVEJ_RPY 0 2800 700 0 0 0\n", "P0010")
    assert "out of reach by" in words(found)
    assert [one.code for one in found.findings] == ["Y0501"]
    assert inspected_json(found)["targets"][0]["out_of_reach_mm"] > 100


def test_a_solution_from_which_the_next_line_fails_is_told():
    """From the nearest solution, the rotation of the next command moves J6 beyond its limit. One full turn
    lower, it is possible.
    """
    head = "P0005 MOVEJ 0 0 0 0 20 350\nP0010 MOVEJ_RPY 0 1150 1000 20 0 0\n"
    found = inspected(head + "P0020 DMOVE 0 0 0 0 -30 0 [9] {TCP}\n", "P0010")
    solutions = found.waypoints[0].solutions
    by_turn = {round(one.q[5] / DEG): one for one in solutions if one.q[3] == 0.0}
    assert by_turn[360].reason.startswith("P0020 DMOVE fails from here")
    assert "(Y0801)" in by_turn[360].reason
    assert any("the following motions are possible" in one.reason for one in solutions)


def test_the_way_into_the_second_way_of_a_when():
    text = (
        "INPUT DOOR M11\n"
        "P0005 MOVEJ 5 0 0 0 0 0\n"
        "WHEN DOOR ON\n"
        "P0010 MOVEJ 20 0 0 0 0 0\n"
        "P0020 MOVEJ 0 0 0 0 0 0\n"
        "ELSE\n"
        "P0030 MOVEJ 30 0 0 0 0 0 [0.01]\n"
        "P0040 MOVEJ 0 0 0 0 0 0\n"
        "END\n"
    )
    found = inspected(text, "P0030")
    assert found.start[0] == pytest.approx(5 * DEG)


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("WAIT [2]", "waits for 2 s"),
        ("WAIT DOOR ON [5]", "DOOR (M11) is ON, at most 5 s"),
        ("SET GLUE ON", "GLUE (M1) becomes ON"),
        ('HOLD "look"', "the operator continues: look"),
    ],
)
def test_what_moves_nothing(line, told):
    found = inspected(f"INPUT DOOR M11\nOUTPUT GLUE M1\nP0010 MOVEJ 9 0 0 0 0 0\nP0020 {line}\n", "P0020")
    text = words(found)
    assert told in text
    assert found.start[0] == pytest.approx(9 * DEG)
    assert found.stretches


@settings(max_examples=60, deadline=None)
@given(st.tuples(*[st.floats(-3.1, 3.1)] * 3))
def test_roll_pitch_yaw_come_back(angles):
    pose = np.eye(4)
    pose[:3, :3] = rpy_rotation(np.array(angles))
    again = rpy_rotation(pose_values(pose)[3:] * DEG)
    assert np.abs(again - pose[:3, :3]).max() < 1e-9
    assert np.isfinite(pose_values(pose)).all()


@pytest.mark.parametrize("pitch", [90.0, -90.0])
def test_roll_pitch_yaw_straight_up_and_down(pitch):
    pose = np.eye(4)
    pose[:3, :3] = rpy_rotation(np.array([20.0, pitch, 50.0]) * DEG)
    assert np.abs(rpy_rotation(pose_values(pose)[3:] * DEG) - pose[:3, :3]).max() < 1e-9


BLENDED = """OUTPUT GLUE M1
P0010 MOVEJ 9 0 0 0 0 0 [1] (deg,s) BLEND 2
P0020 SET GLUE ON
P0030 MOVEJ 9 9 0 0 0 0 [1] (deg,s)
P0040 SET GLUE OFF
P0050 MOVEJ 0 0 0 0 0 0 [1] (deg,s)
"""


def test_a_motion_says_what_it_flows_into():
    first, second, third = (inspected(BLENDED, place) for place in ("P0010", "P0030", "P0050"))
    assert first.flows.before is None
    assert first.flows.behind == second.flows.before
    corner = first.flows.behind
    assert corner.middle == pytest.approx(1.0)
    assert corner.begins < corner.middle < corner.ends
    assert corner.ends - corner.middle == pytest.approx(corner.middle - corner.begins)
    assert "continues into P0030 MOVEJ without a stop: " in words(first)
    assert "continues from P0010 MOVEJ without a stop: " in words(second)
    assert "flows" not in words(third)
    found = inspected_json(second)["flows"]
    assert (found["before"]["from"], found["before"]["into"], found["behind"]) == ("P0010", "P0030", None)
    json.dumps(found)


def test_an_output_says_whether_the_robot_moves():
    inside, behind = (inspected(BLENDED, place) for place in ("P0020", "P0040"))
    assert "in motion, half way from P0010 MOVEJ to P0030 MOVEJ, GLUE (M1) becomes ON" in words(inside)
    assert "at rest, GLUE (M1) becomes OFF" in words(behind)
    assert "stands at" in words(behind)
    assert "stands at" not in words(inside)


def test_parts_that_are_carried_taken_and_put_down():
    examples = Path(__file__).resolve().parents[3] / "examples"
    text = (examples / "05_pick_and_place.yarc").read_text()
    studied = study(check_text(SourceFile("05_pick_and_place.yarc", text), examples, Options()))
    places = ("P0020(#1)>P0020", "P0020(#1)>P0040>P0040", "P0030(#1)>P0060", "P0040(#1)", "P0050(#1)")
    steps = [inspect_step(studied, matching(labels_of(studied.program), place)[0]) for place in places]
    takes, carries, puts, removes, empty = map(words, steps)
    assert "it takes BLANK 2" in takes
    assert "the robot carries BLANK 2" in carries
    assert "it puts down BLANK 2" in puts
    assert "it removes BLANK 2" in removes
    assert "BLANK 2" not in empty.split("certificate")[0]
    told = [inspected_json(one) for one in steps]
    assert [one["carries"] for one in told] == [[], ["BLANK 2"], [], [], []]
    assert [one["parts"] for one in told] == [
        {"takes": ["BLANK 2"]},
        {},
        {"puts_down": ["BLANK 2"]},
        {"removes": ["BLANK 2"]},
        {},
    ]
