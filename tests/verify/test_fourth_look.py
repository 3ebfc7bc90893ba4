"""Forgeries that a fourth look at the checker has found: all are refused, or told apart."""

import hashlib
import json
import re
import time
from collections import deque
from fractions import Fraction
from itertools import product
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import EXAMPLES
from programs import checked, compiled

import yarclang
from tests.certify.forging import Forger
from tests.verify.proof_forging import made, table
from tests.verify.test_third_look import straight, verdict
from yarclang.certify.certifying import certify
from yarclang.certify.claims import Claims
from yarclang.certify.pmac.reader import READER
from yarclang.memory import NO_MEMORY
from yarclang.pipeline.proofs import proof_of
from yarclang.pipeline.stages import claims_of
from yarclang.robot.description import load_robot
from yarclang.verify.arm import Arm
from yarclang.verify.chains import _goals, _stays
from yarclang.verify.course import Ways, _sequence
from yarclang.verify.exact import ONE, PI, RefusedError, sine_and_cosine
from yarclang.verify.parts import check_parts
from yarclang.verify.paths import turn
from yarclang.verify.reader import PRINTED, Entry, read
from yarclang.verify.verdict import ALWAYS_UNCHECKED, Verdict, _list_allowed, verify

SEARCH = (EXAMPLES / "25_stack_height.yarc").read_text()


@pytest.mark.parametrize(
    ("line", "forged"),
    [("; watch M11=0 ", "; watch P8100=0 "), ("; search 2 M12=1 ", "; search 2 M161=1 ")],
)
def test_watches_and_searches_read_inputs_only(line, forged):
    """A variable of the guard or of a motor is no input, even if text and proof agree on it."""
    text, proof = made(SEARCH)
    assert line in text
    text, proof = text.replace(line, forged), json.loads(proof.replace(line, forged))
    proof["text"] = hashlib.sha256(text.encode()).hexdigest()
    found = verify(text.encode(), json.dumps(proof).encode())
    assert "is a variable of the guard or of motors" in found.refused


def test_a_motion_of_the_proof_has_known_fields_only():
    text, _ = made(straight("2", "2"))
    proof = table(straight("2", "2"))
    next(iter(proof["motions"].values()))["more"] = [1, 2, 3]
    assert "more" in verdict(text, proof).refused


@pytest.mark.parametrize(("said", "side"), [(("2", "5"), "after"), (("2", "1.2"), "before")])
def test_when_a_corner_without_a_ball_is_passed_is_told(said, side):
    """The blend's middle is the end of a motion's time. The corner is passed before or after it."""
    text, _ = made(straight(*said))
    told = verdict(text, table(straight(*said))).told
    assert any("P0020 MOVEL 3 passes its corner" in one and f"s {side} its" in one for one in told)


def test_a_text_keeps_the_robots_longest_segment_time():
    """Many tolerances are one segment: with long ones, a motion would have no ceiling at all."""
    text, _ = made("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n")
    slower = re.sub("(?m)^TM.*$", "TM200", text)
    proof = table("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\n")
    assert "longest" in verdict(slower, proof).refused
    robot = load_robot("INDUSTRIAL6").value
    faults = list(READER.faults(READER.read(slower, robot.controller, NO_MEMORY), robot, None))
    assert any(one.code == "Y1152" and "longest" in one.reason for one in faults)


OFF = "P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)\nP0020 MOVEJ 20 0 0 0 0 0 [2] (deg,s)\n"
ROBOT = load_robot("INDUSTRIAL6").value


def judged_as(program, other):
    """Return the findings about the text of the program `other` if it is said to be that of `program`."""
    honest, _ = compiled(program)
    source, _ = checked(program)
    text = re.sub(
        r"(?m)^; program .*$", re.search(r"(?m)^; program .*$", honest.text)[0], compiled(other)[0].text
    )
    text = Forger.of(text).text
    return text, certify(text, source, ROBOT, ROBOT.tolerance, claims_of(honest.plan)).diagnostics


def turned(begin, end):
    return (
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        f"P0010 MOVEJ_RPY 200 1000 900 0 {begin} 0 [5]\nP0020 MOVEL 200 1000 900 0 {end} 0 [30]\n"
    )


def test_a_path_begins_at_the_programmed_goal():
    """From elsewhere within the tolerance, the turn goes the other way round, which is 360 deg of a joint."""
    assert [one.code for one in judged_as(turned(0, 179.999), turned(0, 179.999))[1]] == []
    text, found = judged_as(turned(0, 179.999), turned(-0.0015, 179.999))
    assert [one.code for one in found] == ["Y1159"]
    assert "P0020" in found[0].message
    assert "P0020 MOVEL 3, from its path" in verdict(text, table(turned(0, 179.999))).refused


@pytest.mark.parametrize(
    ("line", "other"),
    [
        ("DMOVEJ 1 0 0 0 0 0 [2] (deg,s)", "DMOVEJ 0.9985 0 0 0 0 0 [2] (deg,s)"),
        ("DMOVE 0 10 0 0 0 0 [2]", "DMOVE 0 10.015 0 0 0 0 [2]"),
    ],
)
def test_errors_of_relative_motions_do_not_add_up(line, other):
    """Each motion alone would be within its tolerance."""
    program = (
        "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 200 1000 900 0 20 0 [5]\n"
        "P0020 X\nP0030 DMOVEJ 0 1 0 0 0 0 [2] (deg,s)\nP0040 X\n"
    )
    _, found = judged_as(program.replace("X", line), program.replace("X", line))
    assert [one.code for one in found] == []
    _, found = judged_as(program.replace("X", line), program.replace("X", other))
    assert ("Y1160", "P0040") in {(one.code, one.message[:5]) for one in found}
    assert "P0020" not in {one.message[:5] for one in found}


@pytest.mark.parametrize("end", ["179.9", "179.999", "179.9999"])
def test_a_turn_of_nearly_half_a_turn_has_a_proof(end):
    assert proof_of(compiled(turned(0, end))[0]).value


def test_a_turn_without_a_certain_direction_is_refused():
    """The planner refuses half a turn to 1e-6 rad, and the checker to 5e-7 rad."""
    angle = PI - (ONE >> 22)
    sine, cosine = sine_and_cosine(angle)
    start = [[ONE, 0, 0], [0, ONE, 0], [0, 0, ONE]]
    goal = [[cosine, sine, 0], [-sine, cosine, 0], [0, 0, ONE]]
    with pytest.raises(RefusedError, match="direction isn't certain"):
        turn(start, goal, [0, 0, ONE], angle)


def test_a_jerk_without_a_limit_beside_a_motion_is_told():
    program = (
        "DEFAULT [MIN] (deg,s)\nP0010 MOVEJ_TOPP 20 0 0 0 0 0 BLEND 0\nP0020 MOVEJ_SCURVE 40 0 0 0 0 0\n"
    )
    text, _ = made(program)
    exempt = verdict(text, table(program)).exempt
    assert any("P0020 MOVEJ_SCURVE 3: the jerk in its first" in one for one in exempt)


def test_joint_positions_that_were_chosen_for_a_pose_are_told():
    """A pose can be reached in several postures, and with a whole turn more of a joint."""
    program = "DEFAULT {TCP} [3] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 150 1100 1176 0 5 0 [5]\n"
    text, _ = made(program)
    told = verdict(text, table(program)).told
    (line,) = (one for one in told if "P0010 MOVEJ_RPY 2 ends at the joint positions" in one)
    last = next(one for one in reversed(text.split("\n")) if one.startswith("X"))
    printed = [float(one) for one in re.findall("[A-Z](-?[0-9.]+)", last)]
    assert [float(one) for one in line.split("positions ")[1].split()] == pytest.approx(printed, abs=1e-3)


def test_outputs_of_a_sequence_take_linear_work():
    """Each output is read once, however many commands follow (it was once for each of them)."""
    text, _ = made("P0010 MOVEJ 1 0 0 0 0 0 [1] (deg,s)\n")
    item = next(one for one in read(text, list("XYZABC"), list(range(1, 7)), 1).course if one.kind == "run")
    count = 3000
    entries = [Entry(k, "P M 1", k + 1, k + 1, 0 if k < count - 1 else None, False) for k in range(count)]
    item.points, item.lines = [item.points[0]] * count, [*range(1, count), 20 * count]
    item.puts = [(line, "M20=1") for line in range(count, 10 * count)]
    ways = Ways((item.points[0],), lambda one, *_: one)
    started = time.process_time()
    with pytest.raises(RefusedError):
        _sequence(0, item, ways, deque(entries), [], [], -1)
    assert time.process_time() - started < 20.0  # about 0.1 s; with a list for each command, minutes


CELL = (EXAMPLES / "05_pick_and_place.toml").read_text()
PERHAPS = """ROBOT INDUSTRIAL6
CELL "cell.toml"
USE PICKPLACE
DEFAULT {GRIPPER} [50%] (mm,deg,s) {B}
START READY
P0010 MOVEJ_RPY 0 0 120 0 0 0 {FEEDER}
WHEN PART_READY ON
  P0020 CALL PICKPLACE.PICK {GRIPPER} {FEEDER} 120 GRIP 1
ELSE
  P0030 SET PRESS_LOADED OFF
END
P0040 MOVEJ READY
P0050 CALL PICKPLACE.PLACE {GRIPPER} {PRESS} 120 GRIP 1.2
P0060 MOVEJ READY
"""


def in_cell(folder, program, cell):
    """Return the text and the proof (a dict) of a program beside a cell.toml."""
    (folder / "cell.toml").write_text(cell)
    opened = yarclang.compile(program, folder=str(folder))
    assert opened.value is not None, [one.message for one in opened.diagnostics if one.is_error]
    proof = proof_of(opened.value)
    assert proof.value is not None, proof.diagnostics
    return opened.value.text, json.loads(proof.value)


def test_a_part_that_may_have_been_taken_is_followed(tmp_path):
    """After a WHEN, the part may be on the arm or where it was. On the arm it is where it was taken."""
    text, proof = in_cell(tmp_path, PERHAPS, CELL)
    found = verify(text.encode(), json.dumps(proof).encode())
    assert (found.refused, found.unchecked) == ("", list(ALWAYS_UNCHECKED))
    for body in proof["cell"]["bodies"]:
        if body["name"] == "BLANK 1" and body["joint"]:
            body["pose"][3] += 0.002
    found = verify(text.encode(), json.dumps(proof).encode())
    assert "where BLANK 1 is between commands" in found.refused


def test_a_body_in_a_loop_is_no_source_of_itself():
    """A body on the arm that no way brings there is refused, also if it is there in all passes of a loop."""
    body = {"name": "PART", "pose": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0], "core": [0.01] * 3}
    body = json.loads(json.dumps(body | {"disc": 0, "radius": 0, "margin": 0}), parse_float=Fraction)
    body["pose"] = [Fraction(one) for one in body["pose"]]
    ground = body | {"joint": Fraction(0), "during": [[Fraction(0), Fraction(2)]]}
    on_arm = body | {"joint": Fraction(6), "during": [[Fraction(1), Fraction(2)]]}
    rows = [SimpleNamespace(entry=SimpleNamespace(blend=None), end=(0,) * 6) for _ in range(3)]
    arm = Arm(json.loads(made(OFF)[1], parse_float=Fraction, parse_int=Fraction)["robot"])
    deeds = ["move 0", "barrier loop 1 - - -", "move 1", "move 2", "barrier endloop 2 - - -"]
    with pytest.raises(RefusedError, match="no output is set there"):
        check_parts(rows, deeds, [ground, on_arm], arm)


@pytest.mark.parametrize("turn", [0, 100])
def test_a_mesh_that_is_taken_at_an_angle_is_the_same_mesh(tmp_path, turn):
    corners = list(product((-30, 30), repeat=3))
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in sides for face in ((a, c, b), (a, d, c))]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (tmp_path / "box.obj").write_text("\n".join([*lines, ""]))
    box = 'shape = "box"\nframe = "FEEDER"\nsize = [60, 60, 60]'
    mesh = 'shape = "mesh"\nfile = "box.obj"\nunits = "mm"\nframe = "FEEDER"'
    place = "xyz = [300, 850, 650]\n"
    assert box in CELL
    assert place in CELL
    cell = CELL.replace(box, mesh).replace(place, f"{place}rpy = [0, 0, {turn}]\n")
    program = (EXAMPLES / "05_pick_and_place.yarc").read_text().replace("05_pick_and_place.toml", "cell.toml")
    text, proof = in_cell(tmp_path, program, cell)
    found = verify(text.encode(), json.dumps(proof).encode())
    assert found.refused == ""
    assert any(re.search('corners "8 of SHA-256 [0-9a-f]{64}"', one) for one in found.told)


def test_a_large_floor_has_a_proof_and_a_larger_one_a_reason(tmp_path):
    program = 'ROBOT INDUSTRIAL6\nCELL "cell.toml"\nP0010 MOVEJ 20 0 0 0 20 0 [3] (deg,s)\n'
    floor = (
        'units = "mm,deg,s"\n[[obstacles]]\nname = "FLOOR"\nshape = "box"\nframe = "B"\n'
        "xyz = [0, 0, -600]\nsize = [SIZE, SIZE, 100]\n"
    )
    in_cell(tmp_path, program, floor.replace("SIZE", "100000"))
    (tmp_path / "cell.toml").write_text(floor.replace("SIZE", "5000000"))
    (finding,) = proof_of(yarclang.compile(program, folder=str(tmp_path)).value).diagnostics
    assert "FLOOR is larger than 1024 m" in finding.message


def test_a_body_that_is_allowed_to_touch_may_be_absent():
    found, rows = Verdict(), [SimpleNamespace(entry=SimpleNamespace(step=1), control=[1])]
    _list_allowed(["; allow 1 GHOST TABLE"], [{"name": "TABLE"}], rows, found)
    (said,) = found.exempt
    assert said.endswith("the program lets them touch, but not both are bodies of the proof")


def arm_of(program=OFF):
    return Arm(json.loads(made(program)[1], parse_float=Fraction, parse_int=Fraction)["robot"])


def standing(degrees):
    """Return a motion without moves at joint positions [deg], as the checker has read it."""
    here = tuple(round(Fraction(one) * PRINTED) for one in degrees)
    entry = SimpleNamespace(title="P0010 MOVEJ 1", blend=None)
    return SimpleNamespace(entry=entry, begin=here, end=here)


@pytest.mark.parametrize(("off", "refused"), [("0.003", True), ("0.001", False)])
def test_a_motion_without_moves_is_at_its_goal(off, refused):
    goal = {"q": [Fraction(10), *[Fraction(0)] * 5]}
    told = {"move": "joint", "through": [goal], "tolerance": [Fraction("0.02"), Fraction("0.002")]}
    row = standing([10 + Fraction(off), 0, 0, 0, 0, 0])
    if not refused:
        _stays(row, told, arm_of())
        return
    with pytest.raises(RefusedError, match="doesn't move"):
        _stays(row, told, arm_of())


@pytest.mark.parametrize(("off", "refused"), [("0.0005", True), ("0", False)])
def test_joints_that_are_told_for_a_pose_are_at_it(off, refused):
    """A motion with TOL 20 may end 20 mm from its pose. Joint positions that the proof gives are at it."""
    program = "DEFAULT {TCP} [3] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 150 1100 1176 0 5 0 [5]\n"
    text, proof = made(program)
    steps = json.loads(proof, parse_float=Fraction, parse_int=Fraction)["program"]["steps"]
    (goal,) = steps[0]["through"]
    goal["pose"][3] += Fraction(off)
    told = {"move": "joint", "through": [goal], "tolerance": [Fraction(20), Fraction(20)]}
    last = next(one for one in reversed(text.split("\n")) if one.startswith("X"))
    degrees = re.findall("[A-Z](-?[0-9.]+)", last)
    assert len(list(_goals(standing(degrees), told, {}, arm_of()))) == 1
    goal["q"] = [Fraction(one) for one in degrees]
    if refused:
        with pytest.raises(RefusedError, match="mm away"):
            list(_goals(standing(degrees), told, {}, arm_of()))
    else:
        assert len(list(_goals(standing(degrees), told, {}, arm_of()))) == 1


TABLE = "P0010 MOVEJ_TIMED 4 0 0 0 0 0 [1]; 10 0 0 0 0 0 [3] (deg,s)\n"


def test_a_timetable_ends_at_its_last_row():
    text, _ = made(TABLE)
    forged = re.sub("(?m)^X10Y", "X10.01Y", text)
    assert forged != text
    assert "from its timetable" in verdict(forged, table(TABLE)).refused
    robot = load_robot("INDUSTRIAL6").value
    program, _ = checked(TABLE)
    judged = certify(Forger.of(forged).text, program, robot, robot.tolerance, Claims(any_jerk=frozenset({0})))
    assert any(one.code == "Y1160" for one in judged.diagnostics)


POSE = "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 150 1000 1000 0 30 0 [30]\n"


def test_a_motion_to_a_pose_ends_in_the_programs_posture():
    """The pose is reached with the wrist turned over, too."""
    honest, _ = compiled(POSE)
    end = np.rad2deg(honest.plan.motions[-1].curve.points[-1])
    over = end + np.array([0, 0, 0, -180.0, -2 * end[4], 180.0])
    joints = " ".join(f"{one:.9f}" for one in over)
    other, _ = compiled(f"DEFAULT (deg,s)\nP0010 MOVEJ {joints} [30]\n")
    program = re.search(r"(?m)^; program .*$", honest.text)[0]
    text = re.sub(r"(?m)^; program .*$", program, other.text).replace("P0010 MOVEJ 2", "P0010 MOVEJ_RPY 2")
    source, _ = checked(POSE)
    robot = load_robot("INDUSTRIAL6").value
    for one, faults in ((honest.text, []), (Forger.of(text).text, ["Y1160"])):
        judged = certify(one, source, robot, robot.tolerance, claims_of(honest.plan))
        assert [found.code for found in judged.diagnostics if found.is_error] == faults
