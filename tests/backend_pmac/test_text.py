"""Tests of the emitted text: forbidden content, the guard of the rotary buffer, segment times, decimals."""

import hashlib
import json
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from programs import compiled

from tests.certify.forging import Forger
from yarclang.backend_pmac.decimals import decimals_for
from yarclang.backend_pmac.emit import segment_time
from yarclang.backend_pmac.guard import watermarks
from yarclang.backend_pmac.move_lines import move_lines
from yarclang.certify.pmac.reader import READER
from yarclang.memory import NO_MEMORY
from yarclang.pipeline.proofs import proof_of
from yarclang.pmac.variables import signal_variable
from yarclang.robot.actuation import counts_per_joint
from yarclang.verify.verdict import verify

PROGRAM = """DEFAULT {TCP} (mm,deg,s) {B}
P0010 MOVEJ 0 -10 -40 0 50 0 [6]
P0020 MOVEJ 10 -10 -40 0 50 0 [2]
P0030 MOVEJ 0 -10 -40 0 50 0 [1.7]
P0040 DMOVEJ 5 0 0 0 0 0 [MIN]
"""


def lines_of(text):
    return [line for line in text.splitlines() if not line.startswith(";")]


@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_the_text_never_runs_anything_and_ends_closed(target):
    made, _ = compiled(PROGRAM, target=target)
    lines = lines_of(made.text)
    assert lines[-1] == "CLOSE"
    assert not [line for line in lines if re.search(r"(^|[^A-Z])[RS]$|&\d+B?\d*R", line)]
    assert max(map(len, lines)) <= 120
    assert made.text.isascii()


def test_the_map_leads_to_the_lines_of_each_command():
    made, _ = compiled(PROGRAM)
    lines = made.text.splitlines()
    seen = []
    for found in re.finditer(r"; command (\d+) (\S+) \S+ (\d+) (\d+) (\d+)", made.text):
        first, last = int(found[4]), int(found[5])
        moves = [line for line in lines[first - 1 : last] if line.startswith("X")]
        seen.append((found[2], int(found[3]), moves[-1]))
    assert [entry[:2] for entry in seen] == [("P0010", 2), ("P0020", 3), ("P0030", 4), ("P0040", 5)]
    assert [re.match(r"X([0-9.]+)", entry[2])[1] for entry in seen] == ["0", "10", "0", "5"]


def test_neighbours_with_one_segment_time_are_one_sequence():
    """The motions of 6, 2 and 1.7 s have one TM and form one sequence: the robot rests between them because
    the end point of each motion stands three times in the text. The motion with [MIN] has another TM.
    """
    made, _ = compiled(PROGRAM)
    text = made.text.split("SPLINE1\n")[1]
    assert len(re.findall(r"^TM", text, re.M)) == 2
    first, second = re.split(r"^TM.*\n", text, flags=re.M)[1:]
    count = [sum(line.startswith("X") for line in part.splitlines()) for part in (first, second)]
    assert count == [120 + 40 + 34 - 2, made.plan.motions[3].curve.segments - 2]


def test_the_guard_is_armed_before_the_first_move_and_disarmed_after_the_last_one():
    made, _ = compiled(PROGRAM)
    lines = lines_of(made.text)
    low, full = (int(next(line for line in lines if line.startswith(name))[4:]) for name in ("I16=", "I17="))
    moves = [number for number, line in enumerate(lines) if re.match(r"X[-0-9]", line)][1:]
    armed, disarmed = lines.index("P8100=1"), lines.index("P8100=P8100&2")
    assert armed + 1 == moves[0]
    assert disarmed - 1 == moves[-1]
    assert lines[disarmed : disarmed + low + 2] == ["P8100=P8100&2"] * (low + 2)
    assert low + 2 < full


def test_a_short_program_is_not_guarded():
    made, _ = compiled("P0010 MOVEJ 0.1 0 0 0 0 0 [0.2] (deg,s)\n")
    assert "P8100" not in made.text


def test_the_rotary_holds_a_second(industrial6):
    for segment in (0.05, 0.02, 0.005):
        marks = watermarks(industrial6, segment)
        assert marks.words >= 480
        assert marks.words / 8 * segment >= 1.0
        assert marks.words / 8 >= 2 * marks.full
        assert marks.low * segment >= industrial6.controller.hold_time / 2 + 0.1
    assert watermarks(industrial6, 0.05).words == 480


@given(st.integers(1, 4096 * 4096 - 1))
def test_segment_times_are_printed_exactly(steps):
    milliseconds = steps / 4096
    text = segment_time(milliseconds)
    assert float(text) == milliseconds
    assert re.fullmatch(r"\d+(\.\d{1,12})?", text)


@pytest.mark.parametrize(("segment", "decimals"), [(0.05, 6), (0.005, 7), (0.002, 8)])
def test_the_decimals_fit_the_segment_time(industrial6, segment, decimals):
    assert decimals_for(industrial6, segment, industrial6.tolerance) == decimals
    # the rounding error is at most a quarter of a count, 0.1 % of the acceleration limit and 1 % of the jerk
    # limit
    counts = np.abs(counts_per_joint(industrial6) * industrial6.axis_units).sum(axis=1).max()
    assert 0.5 * 10**-decimals * counts <= 0.25
    assert 2 * 10**-decimals / segment**2 <= 1e-3 * 240
    assert 4 * 10**-decimals / segment**3 <= 1e-2 * 2000


@pytest.mark.parametrize("tm", [50, 20, 10, 5])
@pytest.mark.parametrize("duration", ["[0.333]", "[1]", "[2.71828]"])
def test_the_duration_is_exact_to_the_controller_s_step(tm, duration):
    made, diagnostics = compiled(f"P0010 MOVEJ 1 0 0 0 0 0 {duration} (deg,s)\n", tm=tm)
    assert not diagnostics
    (motion,) = made.plan.motions
    assert motion.curve.segment <= tm * 1e-3 + 1e-12
    asked = float(duration.strip("[]"))
    assert abs(motion.curve.duration - asked) <= motion.curve.segments / 8192e3 + 1e-12


def test_the_program_buffer_looks_at_every_motor_before_each_start():
    made, _ = compiled(PROGRAM, target="prog", start=np.radians([1, -2, 3, 0, 0, 0]))
    lines = lines_of(made.text)
    loop = lines[lines.index("WHILE(P8101=1)") : lines.index("ENDWHILE")]
    assert sum(line.startswith("IF(ABS(M") for line in loop) == 6
    assert loop[-3:] == ["IF(P8101=1)", "STOP", "ENDIF"]
    # 1 deg of motor 1 is 25,532.8278 counts; the position of motor 3 is J2 + J3
    assert f"IF(ABS(M161-{round(25532.8278 * 3072)})>" in made.text
    assert f"IF(ABS(M361-{round(29308.7083 * 3072)})>" in made.text


def shortest(value, decimals):
    text = f"{value:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if decimals else text


SIZES = st.sampled_from([0.0, 1e-9, 1e-5, 0.05, 1.0, 10.0, 99.999995, 360.0, 4294.0, 5e4, 1e7])


@given(
    st.integers(1, 9),
    st.lists(st.lists(st.tuples(SIZES, st.floats(-1.0, 1.0)), min_size=2, max_size=2), max_size=9),
    st.integers(0, 9),
)
def test_move_lines_have_each_number_as_it_is_printed_alone(decimals, rows, cut):
    values = np.array([[size * share for size, share in row] for row in rows]).reshape(-1, 2)
    values = np.round(values, decimals) + 0.0
    commands = [values[:cut], values[cut:]]
    texts = list(move_lines("XY", decimals, commands))
    lines = [f"X{shortest(x, decimals)}Y{shortest(y, decimals)}\n" for x, y in values.tolist()]
    assert texts == ["".join(lines[:cut]), "".join(lines[cut:])]


FLOWING = """DEFAULT {{TCP}} [4] (mm,deg,s) {{B}}
OUTPUT GLUE {variable} OFF
REPEAT 2
  P0010 MOVEJ 10 0 0 0 30 0 BLEND 2
  P0020 SET GLUE ON
  P0030 MOVEJ 0 0 0 0 30 0{blend}
  P0040 SET GLUE OFF
END
"""


@pytest.mark.parametrize("variable", ["P100", "Q3"])
def test_an_output_that_is_set_at_rest_only_is_told_at_its_line(variable):
    made, found = compiled(FLOWING.format(variable=variable, blend=" BLEND 2"))
    assert made is None
    # P0040 of the last pass has no finding, because the robot rests there
    assert [(one.code, one.span.line, one.place) for one in found if one.is_error] == [
        ("Y1105", 5, "P0020(#0)"),
        ("Y1105", 7, "P0040(#0)"),
    ]
    assert all(f"GLUE is {variable}" in one.message for one in found if one.is_error)
    assert "M-variable" in next(one for one in found if one.is_error).help


def test_an_output_is_set_in_motion_only_where_the_motions_really_flow():
    made, found = compiled(FLOWING.format(variable="M5", blend=""))
    assert not [one for one in found if one.is_error]
    assert len(re.findall(r"^M5==1$", made.text, re.MULTILINE)) == 2
    made, _ = compiled(FLOWING.replace(" BLEND 2", "").format(variable="P100", blend=""))
    assert "P100=1" in lines_of(made.text)
    assert "==" not in "".join(lines_of(made.text))


@pytest.mark.parametrize("count", [64, 65])
def test_a_blend_has_a_largest_number_of_outputs(count):
    """The controller stores them until the blend's middle, and lost all beyond its room in silence."""
    sets = "".join(f"P{100 + k:04d} SET A {('ON', 'OFF')[k % 2]}\n" for k in range(count))
    program = (
        "OUTPUT A M20\nDEFAULT (deg,s)\nP0010 MOVEJ 10 0 0 0 0 0 [5] BLEND 2\n"
        f"{sets}P0900 MOVEJ 10 0 0 0 30 0 [5]\n"
    )
    made, found = compiled(program)
    assert [one.code for one in found if one.is_error] == (["Y1107"] if count > 64 else [])
    if made is None:
        return
    more = Forger.of(made.text)
    more = more.put(more.find("M20==0"), "M20==1")
    robot = made.plan.robot
    faults = list(READER.faults(READER.read(more.text, robot.controller, NO_MEMORY), robot, None))
    assert any("more than 64 outputs" in one.reason for one in faults)
    proof = json.loads(proof_of(made).value)
    proof["text"] = hashlib.sha256(more.text.encode()).hexdigest()
    assert "too many outputs" in verify(more.text.encode(), json.dumps(proof).encode()).refused


def test_a_variable_that_is_taken_names_those_that_are_free():
    found = signal_variable("P1", ("P1", "P2"))
    assert found.is_taken
    assert found.remedy == "P0, P3 to P8099 are free"
    assert signal_variable("M8116", ()).remedy == "M0 to M159, M170 to M259, M270 to M359 and more are free"
    for text in ("P0", "P3", "P8099", "M159", "M170", "M259"):
        assert signal_variable(text, ("P1", "P2")).name == text
