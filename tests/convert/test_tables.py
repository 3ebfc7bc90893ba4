"""Tests of converting tables: headers, units and numbers. Random tables keep their values."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import checked, codes, planned

from tests.convert.conversions import NAMES, commands, converted, numbers, program_of, refused

DEG = "j1 [deg],j2 [deg],j3 [deg],j4 [deg],j5 [deg],j6 [deg]"
POSE = "x [mm],y [mm],z [mm],roll [deg],pitch [deg],yaw [deg]"


def test_joint_positions_become_moves():
    program = program_of(f"{DEG}\n0,0,0,0,0,0\n10,-10,-20.5,0,-60,0\n")
    assert program.splitlines()[0] == "! points.csv: a table of 2 joint positions."
    assert program.splitlines()[-2:] == [
        "P0010 MOVEJ  0   0   0.0 0   0 0",
        "P0020 MOVEJ 10 -10 -20.5 0 -60 0",
    ]


def test_the_robots_names_any_order_and_case():
    program = program_of("J6 (deg),j5 (deg),Joint_4 (deg),q3 (deg),J2 (deg),joint 1 (deg)\n6,5,4,3,2,1\n")
    assert numbers(program).tolist() == [[1, 2, 3, 4, 5, 6]]


@pytest.mark.parametrize(
    "text",
    [
        f"{NAMES}\n1.5,2,3,4,5,6\n",
        "\ufeff".lstrip("\ufeff") + f"{NAMES}\r\n1.5,2,3,4,5,6\r\n",
        f"{NAMES}\n1.5,2,3,4,5,6\n".replace(",", "\t"),
        f"{NAMES}\n".replace(",", ";") + "1,5;2;3;4;5;6\n;;;;;\n",
        f"# {NAMES}\n# a remark\n\n1.5, 2, 3, 4, 5, 6,,\n",
    ],
    ids=["comma", "crlf", "tab", "decimal comma", "remarks"],
)
def test_ways_to_write_a_table(text):
    assert numbers(program_of(text, said="deg")).tolist() == [[1.5, 2, 3, 4, 5, 6]]


def test_units_are_converted():
    header = "x [m],y [cm],z [in],roll [rad],pitch [deg],yaw [rad]"
    program = program_of(f"{header}\n0.1,110,45,0.1,2,0\n")
    assert numbers(program) == pytest.approx(np.array([[100, 1100, 1143, 5.729578, 2, 0]]))


def test_poses_are_reached_straight():
    program = program_of(f"{POSE}\n0,1174.4,1176,0,0,0\n50,1174.4,1176,0,0,0\n")
    assert commands(program) == ["MOVEJ_RPY", "MOVEL"]


def test_quaternions_need_no_unit():
    program = program_of("x,y,z,qx,qy,qz,qw\n0,1174.4,1176,0,0,0,1\n0,1174.4,1200,0,0,0.6,0.8\n", said="mm")
    assert commands(program) == ["MOVEJ_QUAT", "MOVEL_QUAT"]


def test_times_make_one_motion():
    text = f"{NAMES},t [ms]\n0,0,0,0,0,0,0\n10,0,0,0,0,0,900\n20,0,0,0,0,0,4000\n"
    program = program_of(text, said="deg", form="spline")
    assert commands(program) == ["MOVEJ_SPLINE"]
    assert program.endswith("20 0 0 0 0 0 [4]\n")
    assert "START  0 0 0 0 0 0".replace("  ", " ") in program
    # half of the distance takes half of the time
    assert "a point is passed at 2.000 s instead of 0.900 s" in program
    assert commands(program_of(text, said="deg", form="moves")) == ["MOVEJ"] * 3
    assert "[MIN]" in program_of(text, said="deg", time="MIN")


def test_times_are_kept():
    text = f"{NAMES},t [ms]\n0,0,0,0,0,0,500\n10,0,0,0,0,0,1400\n20,0,0,0,0,0,4500\n"
    program = program_of(text, said="deg")
    assert program.splitlines()[-3:] == [
        "P0010 MOVEJ 0 0 0 0 0 0 [50%]",
        "P0020 MOVEJ_TIMED 10 0 0 0 0 0 [0.9];",
        "                  20 0 0 0 0 0 [4]",
    ]


RATES = ",".join(f"j{n}_velocity" for n in range(1, 7))


def test_velocities_are_kept():
    text = (
        f"t,{RATES},{NAMES}\n"
        "0,0,0,0,0,0,0,0,0,0,0,0,0\n"
        "1,3,0,0,0,0,0,5,0,0,0,0,0\n"
        "2,0,0,0,0,0,0,8,0,0,0,0,0\n"
    )
    program = program_of(text, said="deg,s")
    assert program.splitlines()[-2:] == [
        "P0020 MOVEJ_TIMED 5 0 0 0 0 0 [1] VEL 3 0 0 0 0 0;",
        "                  8 0 0 0 0 0 [2] VEL 0 0 0 0 0 0",
    ]
    own = text.replace("_velocity", "_vel [rad/s]")
    assert "VEL 171.887339 0" in program_of(own, said="deg,s")


def test_velocities_of_some_joints_are_told():
    text = f"t [s],{NAMES},j1_vel [deg/s]\n0,0,0,0,0,0,0,0\n1,1,0,0,0,0,0,0\n3,2,0,0,0,0,0,0\n"
    program, found = converted(text, said="deg")
    assert (codes(found), "j1_vel" in found[0].message) == (["Y1503"], True)
    assert "VEL" not in program


@pytest.mark.parametrize(
    ("column", "words"),
    [
        ("[deg]", "deg isn't a unit of angle /s"),
        ("[deg/s^2]", "isn't a unit of angle /s"),
        ("[mm/s]", "isn't a unit"),
    ],
)
def test_units_of_velocities(column, words):
    text = f"t [s],{NAMES},{RATES.replace('j1_velocity', 'j1_velocity ' + column)}\n" + "0," * 12 + "0\n"
    found = refused(text, said="deg")
    assert (found.code, words in found.message) == ("Y1506", True)


def test_poses_have_no_timetable():
    header = "t [s],x [mm],y [mm],z [mm],roll [deg],pitch [deg],yaw [deg]"
    text = f"{header}\n0,900,0,900,180,0,180\n1,900,10,900,180,0,180\n2,900,30,900,180,0,180\n"
    assert "times between aren't kept: MOVEJ_TIMED" in program_of(text)
    assert refused(text, form="timed").code == "Y1514"
    assert refused(f"{NAMES}\n1,2,3,4,5,6\n", said="deg", form="timed").code == "Y1514"


def test_the_told_deviation_is_that_of_the_planned_motion():
    rows = [(0, 0), (1, 4), (5, 9), (6, 30), (9, 31)]
    text = f"{NAMES},t [s]\n" + "".join(f"{q},{-q},0,0,{q / 2},0,{time}\n" for time, q in rows)
    program = program_of(text, said="deg", form="spline")
    told = re.search(r"passed at (\S+) s instead of (\S+) s", program)
    motions = planned(program)[0]
    times = np.linspace(0, 9, 9001)
    at = np.degrees(motions.sample(times)[0][:, 0])
    passed = {time: float(np.interp(q, at, times)) for time, q in rows}
    worst = max(passed, key=lambda time: abs(passed[time] - time))
    assert float(told[2]) == worst
    assert float(told[1]) == pytest.approx(passed[worst], abs=0.03)


def test_names_are_declared_once_and_comments_stay():
    text = f"name,{NAMES},comment\nhome-2,0,0,0,0,0,1,start\n,1,0,0,0,0,0,\nHome 2,0,0,0,0,0,1,and ! back\n"
    lines = program_of(text, said="deg").splitlines()
    assert [line for line in lines if line.startswith("JOINTS")] == ["JOINTS HOME_2 0 0 0 0 0 1"]
    assert lines[-3:] == [
        "P0010 MOVEJ HOME_2  ! start",
        "P0020 MOVEJ 1 0 0 0 0 0",
        "P0030 MOVEJ HOME_2  ! and ! back",
    ]


def test_named_poses_are_frames():
    program = program_of(f"name,{POSE}\npick,0,1174.4,1176,0,0,0\ndrop,90,1174.4,1176,0,0,0\n")
    assert "FRAME {PICK}  0 1174.4 1176 0 0 0" in program
    assert "P0020 MOVEL     0 0 0 0 0 0 {DROP}" in program


def test_columns_that_are_not_taken_are_told():
    program, found = converted(f"{NAMES},force\n0,0,0,0,0,0,7\n", said="deg")
    assert program is not None
    assert codes(found) == ["Y1503"]
    assert "force" in found[0].message


@pytest.mark.parametrize(
    ("text", "code", "words"),
    [
        ("", "Y1504", "empty"),
        ("\n\n", "Y1504", "empty"),
        (f"{NAMES}\n", "Y1504", "no row"),
        (f"{NAMES}\n1,2,3\n1,2,3,4,5,6\n1\n", "Y1504", "3 cells, but the header has 6 (and 1 more line)"),
        (f'{NAMES}\n1,2,"3,4,5,6\n', "Y1504", "can't be read from here on"),
        (f"{NAMES}\n1,2,nan,4,5,6\n", "Y1505", "'nan' in column 'j3'"),
        (f"{NAMES}\n1,2,inf,4,5,6\n1,2,,4,5,6\n", "Y1505", "(and 1 more cell)"),
        (f"{NAMES}\n1,2,1e10,4,5,6\n", "Y1505", "'1e10'"),
        (f"{NAMES}\n1,2,3 mm,4,5,6\n", "Y1505", "'3 mm'"),
        (f"{NAMES}\n1,2,1_0,4,5,6\n", "Y1505", "'1_0'"),
        (f"{NAMES}\n1,2,٣,4,5,6\n", "Y1505", "'٣'"),
        (
            "j1;j2;j3;j4;j5;j6\n1,5;2.5;0;0;0;0\n",
            "Y1505",
            "decimal comma (1,5) and with a decimal point (2.5)",
        ),
        ("1,2,3,4,5,6\n1,2,3,4,5,6\n", "Y1502", "no column was recognised"),
        ("j1,j2,j3,j4,j5\n1,2,3,4,5\n", "Y1502", "column J6 is missing"),
        ("x,y,z\n1,2,3\n", "Y1502", "columns roll, pitch, yaw are missing (recognised: x, y, z)"),
        ("x,y,z,roll,pitch,yaw,qw\n1,2,3,4,5,6,7\n", "Y1502", "given twice"),
        (f"{NAMES},x\n1,2,3,4,5,6,7\n", "Y1502", "joint values and poses"),
        (f"{NAMES},J1\n1,2,3,4,5,6,7\n", "Y1502", "two columns give J1"),
        (f"{NAMES},t [deg]\n1,2,3,4,5,6,7\n", "Y1506", "deg isn't a unit of time"),
        ("j1 [furlong],j2,j3,j4,j5,j6\n1,2,3,4,5,6\n", "Y1506", "furlong isn't a unit of angle"),
        (f"{NAMES},t [s]\n1,2,3,4,5,6,7\n1,2,3,4,5,6,7\n", "Y1509", "isn't later"),
        (f"{NAMES},name\n1,2,3,4,5,6,STOP\n", "Y1510", "word of the language"),
        (f"{NAMES},name\n1,2,3,4,5,6,2nd\n", "Y1510", "doesn't begin with a digit"),
        (f"{NAMES},name\n1,2,3,4,5,6,a\n1,2,3,4,5,0,A\n", "Y1510", "another position in line 2"),
        ("x,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,2\n", "Y1505", "norm 2"),
    ],
)
def test_bad_tables(text, code, words):
    found = refused(text, said="mm,deg")
    assert found.code == code
    assert words in found.message


def test_units_are_never_guessed():
    found = refused(f"{NAMES}\n1,2,3,4,5,6\n")
    assert found.code == "Y1506"
    assert "j1, j2, j3, j4, j5, j6" in found.message
    assert "--units" in found.help


def test_columns_beyond_the_robots_joints_are_unknown():
    assert codes(converted(f"{NAMES},j7\n1,2,3,4,5,6,7\n", said="deg")[1]) == ["Y1503"]


ANGLE = st.floats(-79, 79).map(lambda value: round(value, 9))
ROWS = st.lists(st.tuples(*[ANGLE] * 6), min_size=1, max_size=8)


@settings(max_examples=60)
@given(rows=ROWS, delimiter=st.sampled_from([",", ";", "\t"]), form=st.sampled_from(["moves", "spline"]))
def test_arbitrary_tables_keep_their_values(rows, delimiter, form):
    text = "".join(
        delimiter.join(map(str, row)) + "\n" for row in [[f"j{n} [deg]" for n in range(1, 7)], *rows]
    )
    program = converted(text, form=form)[0]
    assert [one for one in checked(program)[1] if one.is_error] == []
    found = numbers(program)
    kept = [
        row
        for number, row in enumerate(rows)
        if number == 0 or np.abs(np.subtract(row, rows[number - 1])).max() > 1e-6
    ]
    assert found.shape == (len(kept), 6)
    assert np.abs(found - np.array(kept)).max() <= 5.1e-7


@settings(max_examples=100)
@given(text=st.text(alphabet="j123456;,\t \n\"'.-e[]()degmxyz#!", max_size=120))
def test_no_text_makes_it_fall(text):
    program, found = converted(text, said="deg,mm")
    assert (program is None) == any(one.is_error for one in found)
