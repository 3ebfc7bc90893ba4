"""The certificate as a table in the terminal."""

import contextlib
import fcntl
import math
import os
import pty
import re
import struct
import subprocess
import sys
import termios

import pytest
from click.testing import CliRunner
from conftest import EXAMPLES
from hypothesis import given
from hypothesis import strategies as st

import yarclang
from yarclang.cli.commands.status import _columns
from yarclang.cli.table import certificate_table, nearest_table
from yarclang.cli.yarc import main
from yarclang.cli.yarcc import main as yarcc
from yarclang.report.nearest import nearest_places
from yarclang.robot.library import stdlib_folder


def test_a_jerk_that_isnt_judged_stands_in_parentheses():
    made = yarclang.compile(
        "P0010 MOVEJ_TOPP 0 0 0 0 -30 0 [MIN] (deg,s)\nP0020 MOVEJ_SCURVE 0 0 0 0 -40 0 [MIN] (deg,s)\n",
        robot="INDUSTRIAL6",
    ).value
    assert made is not None
    _, _, first, second = certificate_table(made.certificate).split("\n")
    jerk = made.certificate.commands[0].jerk
    assert f"  ({jerk.name} {math.ceil(jerk.share * 100)}%)  " in first
    assert "(" not in second


CELL = """\
units = "mm,deg,s"
[[zones]]
name = "ROOM"
rule = "allowed"
shape = "half-space"
frame = "B"
xyz = [0, 0, 1063]
normal = [0, 0, 1]
watch = ["tcp"]
"""
PROGRAM = """\
ROBOT INDUSTRIAL6
CELL "cell.toml"
DEFAULT {TCP} [MIN] (mm,deg,s) {B}
P0010 MOVEJ -20 10 -40 0 -30 0
P0020 MOVEJ HOME
"""


def test_zones_have_a_column_with_what_is_nearest_and_when(tmp_path):
    (tmp_path / "cell.toml").write_text(CELL)
    made = yarclang.compile(PROGRAM, folder=tmp_path).value
    head, _, first, second = certificate_table(made.certificate).split("\n")
    assert head.endswith("zones mm")
    near = made.certificate.commands[0].zone_clearance
    told = re.search(r"  ([0-9.]+) \{TCP\}, ROOM at ([0-9.]+) s$", first)
    assert float(told[1]) * 1e-3 <= near.distance < float(told[1]) * 1e-3 + 1e-4
    assert float(told[2]) == pytest.approx(near.at, abs=1e-3)
    assert second.count("ROOM") == 1
    assert "at_s" in near.to_json()


def test_without_zones_there_is_no_such_column():
    made = yarclang.compile("P0010 MOVEJ 0 0 0 0 -30 0 [MIN] (deg,s)\n", robot="INDUSTRIAL6").value
    assert "zones" not in certificate_table(made.certificate)


def test_inspect_tells_distances_too(tmp_path):
    (tmp_path / "cell.toml").write_text(CELL)
    (tmp_path / "p.yarc").write_text(PROGRAM)
    told = CliRunner().invoke(main, ["inspect", str(tmp_path / "p.yarc"), "P0010"]).stdout
    assert re.search(
        r"distance from zones' borders: at least [0-9.]+ mm \(\{TCP\}, ROOM\), nearest at [0-9.]+ s\n", told
    )


LONG = """\
ROBOT INDUSTRIAL6
CELL "cell.toml"
DEFAULT {TCP} [50%] (mm,deg,s) {B}
SUB SWING A
  P0010 MOVEJ $A 10 -40 0 -30 0
  P0020 MOVEJ HOME
END
REPEAT I 4
  P0030 CALL SWING $(I*5+5)
  P0040 DMOVEJ $(I*2+1) 0 0 0 0 0
END
P0050 CALL SWING 35
P0060 MOVEJ 0 0 0 0 -30 0
"""
"""A program of four source lines that has 15 commands."""


@pytest.fixture(scope="module")
def long(tmp_path_factory):
    folder = tmp_path_factory.mktemp("long")
    (folder / "cell.toml").write_text(CELL.replace("xyz = [0, 0, 1063]", "xyz = [0, 0, 1040]\nmargin = 5"))
    made = yarclang.compile(LONG, folder=folder)
    assert made.value is not None, made.diagnostics
    return made.value


def test_lines_that_are_carried_out_often_are_one_row_with_the_worst_of_all_times(long):
    told = certificate_table(long.certificate, full=False)
    head, _, *rows, note = told.split("\n")
    assert [row.split()[:3] if row.startswith("P") else row.split()[:4] for row in rows] == [
        ["line", "5", "MOVEJ", "5"],
        ["line", "6", "MOVEJ", "5"],
        ["P0040", "DMOVEJ", "4"],
        ["P0060", "MOVEJ", "1"],
    ]
    assert "times" in head
    swings = [one for one in long.certificate.commands if one.source_line == 5]
    assert f"{max(one.duration for one in swings):.3f}" in rows[0]
    fastest = max((one.velocity for one in swings), key=lambda load: load.share)
    assert f"{fastest.name} {fastest.share * 100:.0f}%" in rows[0]
    assert note.startswith("4 lines of the source, executed 15 times: ")
    assert note.endswith("--full shows all.")


def test_full_shows_every_command(long):
    rows = certificate_table(long.certificate, full=True, width=60).split("\n")[2:]
    assert [row.split()[0] for row in rows] == [one.index for one in long.certificate.commands]


@given(width=st.integers(40, 240))
def test_no_line_is_wider_than_the_terminal_and_all_commands_are_counted(long, width):
    told = certificate_table(long.certificate, full=False, width=width)
    near = nearest_table(long.certificate, long.plan.robot, long.program.cell, width)
    assert max(map(len, (*told.split("\n"), *near.split("\n")))) <= width
    rows = told.split("\n")[2:6]
    at = told.index("times") + len("times")
    assert sum(int(row[:at].split()[-1]) for row in rows) == len(long.certificate.commands)
    named = re.search(r"No room for ([^.]*(?:\.(?! --full)[^.]*)*)\. --full", " ".join(told.split("\n")[6:]))
    everything = certificate_table(long.certificate, full=False).split("\n")[0]
    shown = told.split("\n")[0]
    for name in ("time s", "TM ms", "position", "velocity", "accel.", "jerk", "hold", "path mm", "zones mm"):
        assert name in everything
        assert (name in shown) != (named is not None and name in named[1].split(", "))


def test_the_nearest_places_come_first_with_figure_and_share(long):
    places = nearest_places(long.certificate, long.plan.robot, long.program.cell)
    assert len(places) == 10
    assert [one.rank for one in places] == sorted((one.rank for one in places), reverse=True)
    for what, kind in (("speed", "velocity"), ("acceleration", "acceleration"), ("position", "position")):
        first = next(one for one in places if one.what == what)
        assert first.share == long.certificate.worst(kind).share
    border = next(one for one in places if one.what == "zone border")
    least = min(one.zone_clearance.distance for one in long.certificate.commands)
    assert border.share == pytest.approx(0.005 / least)
    assert border.figure.endswith("({TCP}, ROOM), margin 5 mm")
    speed = next(one for one in places if one.what == "speed")
    name = speed.command.velocity.name
    limit = long.plan.robot.limits.velocity[long.plan.robot.joint_names.index(name)] * 57.29577951308232
    told, allowed = re.fullmatch(rf"{name} (\S+) of (\S+) deg/s", speed.figure).groups()
    assert allowed == f"{limit:.4g}"
    assert speed.share * limit <= float(told) < speed.share * limit + 0.01
    lines = {(one.command.module, one.command.source_line, one.what) for one in places}
    assert len(lines) == 10


def test_a_module_is_called_by_its_name():
    source = (EXAMPLES / "06_palletising.yarc").read_text()
    made = yarclang.compile(source, folder=EXAMPLES).value
    told = certificate_table(made.certificate, full=False)
    assert re.findall(r"^APPROACH line \d+", told, re.MULTILINE)
    assert "site-packages" not in told
    assert len(told.split("\n")) == 8
    near = nearest_table(made.certificate, made.plan.robot, None)
    assert re.search(
        r"P0030\(LAYER=\d,ROW=\d,COLUMN=\d\), APPROACH line \d+: (MOVEL|DMOVE|MOVEJ_RPY)$", near, re.MULTILINE
    )
    rows = made.certificate.to_json()["commands"]
    assert len(rows) == 145
    assert {one.get("module") for one in rows} == {None, "APPROACH"}


def test_a_short_program_shows_each_command_and_nothing_more():
    text = "DEFAULT (deg,s)\nREPEAT I 3\nP0010 MOVEJ 0 0 0 0 -30 $(I*3) [MIN]\nEND\n"
    made = yarclang.compile(text, robot="INDUSTRIAL6").value
    assert certificate_table(made.certificate, full=False) == certificate_table(made.certificate)
    assert nearest_table(made.certificate, made.plan.robot, None) == ""


@pytest.fixture(scope="module")
def wordy(tmp_path_factory):
    """Compile the same program for a robot with long joint names."""
    folder = tmp_path_factory.mktemp("wordy")
    for file in (stdlib_folder() / "robots" / "industrial6").iterdir():
        text = file.read_text()
        (folder / file.name).write_text(re.sub(r"\bJ([1-6])\b", r"shoulder_lift_\1_joint", text))
    (folder / "cell.toml").write_text(CELL.replace("xyz = [0, 0, 1063]", "xyz = [0, 0, 1040]\nmargin = 60"))
    made = yarclang.compile(LONG.replace("ROBOT INDUSTRIAL6\n", ""), robot=str(folder), folder=folder)
    assert made.value is not None, made.diagnostics
    return made.value


def narrow(made, width):
    return certificate_table(
        made.certificate, full=False, width=width, robot=made.plan.robot, cell=made.program.cell
    )


def test_long_names_of_joints_are_numbers_where_there_is_no_room(wordy):
    told = narrow(wordy, 80)
    assert max(map(len, told.split("\n"))) <= 80
    head, _, *rows = told.split("\n")
    for name in ("velocity", "accel.", "zones mm"):
        assert name in head
    assert re.search(r" J[1-6] [0-9]+%", rows[0])
    legend = " ".join(rows[4:]).partition("4 lines of the source")[0]
    used = set(re.findall(r"(J[1-6]) [0-9]+%", told))
    assert dict(re.findall(r"(J[1-6]) (\w+)", legend)) == {
        number: f"shoulder_lift_{number[1]}_joint" for number in used
    }
    assert "shoulder_lift_3_joint 50%" in narrow(wordy, 400)


@pytest.mark.parametrize("width", [60, 80, 100])
def test_the_column_of_the_worst_share_stays(wordy, width):
    robot, cell = wordy.plan.robot, wordy.program.cell
    worst = next(one for one in nearest_places(wordy.certificate, robot, cell) if one.is_judged)
    assert worst.what == "zone border"
    assert "zones mm" in narrow(wordy, width).split("\n")[0]


def test_motions_with_a_part_are_marked():
    source = (EXAMPLES / "05_pick_and_place.yarc").read_text()
    made = yarclang.compile(source, folder=EXAMPLES).value
    rows = certificate_table(made.certificate).split("\n")[2:]
    for row, command in zip(rows, made.certificate.commands, strict=False):
        assert (f"{command.name} *" in row) == bool(command.carries)
    assert any(command.carries for command in made.certificate.commands)
    assert rows[-1] == "* marks commands during which the robot carries a part."


def test_a_pipe_gets_the_same_whatever_the_terminal_is(tmp_path):
    told = [
        CliRunner()
        .invoke(
            yarcc,
            [str(EXAMPLES / "06_palletising.yarc"), "--out-dir", str(tmp_path)],
            env={"COLUMNS": columns},
        )
        .stdout
        for columns in ("60", "200")
    ]
    assert told[0] == told[1]
    assert "hold" in told[0]


@pytest.mark.parametrize("columns", [60, 80, 120])
def test_a_terminal_gets_no_line_that_it_would_break(tmp_path, columns):
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
    (tmp_path / "cell.toml").write_text(CELL.replace("1063", "1040"))
    (tmp_path / "long.yarc").write_text(LONG)
    environment = {key: value for key, value in os.environ.items() if key != "COLUMNS"}
    code = "from yarclang.cli.yarcc import main; main()"
    command = [sys.executable, "-c", code, "long.yarc"]
    done = subprocess.Popen(command, stdout=theirs, stderr=subprocess.DEVNULL, cwd=tmp_path, env=environment)
    os.close(theirs)
    told = b""
    with contextlib.suppress(OSError):  # the end of a terminal
        while piece := os.read(ours, 65536):
            told += piece
    os.close(ours)
    assert done.wait() == 0
    lines = told.decode().split("\r\n")
    assert max(map(len, lines)) <= columns
    assert sum(line.startswith(("line 5 ", "line 6 ", "P0040 ", "P0060 ")) for line in lines) == 4


def test_the_columns_of_a_status_fit_its_longest_title():
    text = _columns([("state", "move"), ("joint_a_of_the_gantry", "1.000 mm")])
    assert text == "state                 move\njoint_a_of_the_gantry 1.000 mm"


def test_a_long_chain_is_one_row():
    lines = ["DEFAULT {TCP} [V 40] (mm,deg,s) {B}", "P0001 MOVEJ_RPY 40 1000 1000 0 0 0 [3]"]
    for number in range(1, 60):
        flows = " BLEND 0.3" if number < 59 else ""
        place = f"{40 + 2 * number} {1000 + 0.01 * number**2:.4f} 1000 0 0 0"
        lines.append(f"P{10 * number:04d} MOVEL {place}{flows}")
    lines.append("P0600 MOVEJ_RPY 40 1000 1000 0 0 0 [5]")
    made = yarclang.compile("\n".join(lines) + "\n", robot="INDUSTRIAL6").value
    rows = certificate_table(made.certificate, full=False).split("\n")
    assert [row.split()[:3] for row in rows[2:5]] == [
        ["P0001", "MOVEJ_RPY", "1"],
        ["P0010", "to", "P0590"],
        ["P0600", "MOVEJ_RPY", "1"],
    ]
    chain = rows[3].split()
    assert chain[3:5] == ["MOVEL", "59"]
    whole = sum(one.duration for one in made.certificate.commands[1:-1])
    assert float(chain[5]) == pytest.approx(whole, abs=1e-3)
    assert "3 lines of the source, or chains of more than 40, executed 61 times" in rows[-1]
    assert len(certificate_table(made.certificate, full=True).split("\n")) == 2 + 61
