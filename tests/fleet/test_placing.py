"""Tests of finding the best place of a frame: in three made-up cells, it is found within 5 mm."""

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from yarclang.cli.yarc import main as yarc

FOLDER = Path("stdlib/robots/industrial6")


def place(folder, *arguments):
    result = CliRunner().invoke(yarc, ["place", *arguments, "--robot", "INDUSTRIAL6", "--format", "json"])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


LINES = (
    "P0010 MOVEJ_RPY 0 0 0 0 0 0 [MIN] {SLOT}\n"
    "P0020 MOVEL 0 60 0 0 0 0 [V 100] {SLOT}\n"
    "P0030 MOVEL 0 0 0 0 0 0 [V 100] {SLOT}\n"
)
WALLS = """units = "mm,deg"
[frames.SLOT]
parent = "B"
xyz = [-60, 1174.4, 1000]
[[obstacles]]
name = "LEFT"
shape = "box"
size = [20, 400, 600]
frame = "B"
xyz = [-140, 1300, 1000]
[[obstacles]]
name = "RIGHT"
shape = "box"
size = [20, 400, 600]
frame = "B"
xyz = [100, 1300, 1000]
"""
CELLS = {
    # the largest clearance is in the middle between two walls, at an X of about 30 mm
    "slot": (WALLS, LINES, "X", 0, 80, "clearance"),
    # the time is shortest at a Y of about -180 mm, away from both ends of the range
    "reach": (
        WALLS.replace("xyz = [100, 1300, 1000]", "xyz = [330, 1300, 1000]").replace("-140", "-330"),
        LINES.replace("MOVEL 0 60", "MOVEL 0 900"),
        "Y",
        -200,
        -20,
        "time",
    ),
    # the largest clearance is at an X of about 60 mm, away from both ends of the range
    "near": (
        WALLS,
        (
            "P0010 MOVEJ_RPY -60 1174.4 1000 0 0 0 [MIN]\n"
            "P0020 MOVEL 120 0 0 0 0 0 [V 20] {SLOT}\n"
            "P0030 MOVEL 0 0 40 0 0 0 [V 20] {SLOT}\n"
        ),
        "X",
        0,
        100,
        "clearance",
    ),
}


@pytest.mark.parametrize("name", CELLS)
def test_a_known_best_is_found_within_5_mm(tmp_path, name):
    """The best place of a scan every 4 mm, which doesn't use the search, is the expected one."""
    from yarclang.fleet.placing import Range, find_task, judged
    from yarclang.pipeline.inputs import Options
    from yarclang.source import SourceFile

    cell, lines, axis, least, most, aim = CELLS[name]
    (tmp_path / "cell.toml").write_text(cell)
    text = f'CELL "cell.toml"\nDEFAULT {{TCP}} (mm,deg,s) {{B}}\n{lines}'
    program = tmp_path / "way.yarc"
    program.write_text(text)
    task = find_task(
        SourceFile(str(program), text),
        tmp_path,
        Options(robot="INDUSTRIAL6"),
        "SLOT",
        (Range(axis, least, most),),
        aim,
    )
    scanned = [judged((float(shift),), task) for shift in np.arange(least, most + 0.1, 4.0)]
    possible = [one for one in scanned if one.is_possible]
    assert possible
    worth = (lambda one: one.seconds) if aim == "time" else (lambda one: -one.clearance)
    known = [one.shift[0] for one in possible if worth(one) <= min(map(worth, possible)) + 1e-9]
    assert len(known) < 0.5 * len(scanned), "this cell has no best place"
    best = place(tmp_path, str(program), "SLOT", "--within", f"{axis}={least}:{most}", "--for", aim)["best"]
    assert min(abs(best["shift"][axis] - one) for one in known) <= 5.0, (name, best, known[:5], len(possible))


def test_the_answer_is_a_patch_and_is_written_when_asked(tmp_path):
    program = tmp_path / "way.yarc"
    program.write_text(
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        "FRAME {STOP} 0 1074.4 1000 0 0 0     ! the fixture\n"
        "P0010 MOVEJ_RPY -300 1174.4 1000 0 0 0 [MIN]\n"
        "P0020 MOVEL 0 0 0 0 0 0 [V 200] {STOP}\n"
        "P0030 MOVEL 300 1174.4 1000 0 0 0 [V 200]\n"
    )
    arguments = ["place", str(program), "stop", "--within", "Y=-200:200", "--robot", "INDUSTRIAL6"]
    before = program.read_text()
    shown = CliRunner().invoke(yarc, arguments)
    assert shown.exit_code == 0, shown.output
    assert "-FRAME {STOP} 0 1074.4 1000" in shown.stdout
    assert program.read_text() == before
    assert CliRunner().invoke(yarc, [*arguments, "--apply"]).exit_code == 0
    after = program.read_text()
    assert "! the fixture" in after
    changed = [line for line, old in zip(after.splitlines(), before.splitlines(), strict=True) if line != old]
    assert len(changed) == 1
    assert 1074.4 < float(changed[0].split()[3]) <= 1274.4
    assert CliRunner().invoke(yarc, ["check", str(program), "--robot", "INDUSTRIAL6"]).exit_code == 0


def test_a_map_says_why_not(tmp_path):
    program = tmp_path / "way.yarc"
    program.write_text(
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        "FRAME {FAR} 0 9000 900 0 0 0\n"
        "P0010 MOVEJ_RPY 0 0 0 0 0 0 [MIN] {FAR}\n"
    )
    result = CliRunner().invoke(
        yarc, ["place", str(program), "FAR", "--robot", "INDUSTRIAL6", "--most", "60"]
    )
    assert result.exit_code == 1
    assert "P0010: " in result.stdout
    assert "no candidate compiles" in result.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["NOWHERE"], "declares {NOWHERE}"),
        (["STPO"], "help: they declare {STOP}"),
        (["TCP"], "{TCP}"),
        (["STOP", "--within", "Q=1:2"], "X=-300:300"),
        (["STOP", "--within", "X=2:1"], "must not exceed the second"),
        (["STOP", "--within", "X=1:2", "--within", "x=1:2"], "twice"),
        (["STOP", "--grid", "50"], "more than --most"),
    ],
)
def test_what_cannot_be_placed_is_said(tmp_path, arguments, words):
    program = tmp_path / "way.yarc"
    program.write_text(
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        "FRAME {STOP} 0 1074.4 1000 0 0 0\n"
        "P0010 MOVEJ_RPY 0 0 0 0 0 0 [MIN] {STOP}\n"
    )
    result = CliRunner().invoke(yarc, ["place", str(program), *arguments, "--robot", "INDUSTRIAL6"])
    assert result.exit_code in (1, 2)
    assert words in result.output
    assert "Traceback" not in result.output


@pytest.mark.parametrize("seed", range(3))
def test_a_shift_moves_the_frame_by_what_it_says(tmp_path, seed):
    from yarclang.fleet.placing import Range, find_task, moved
    from yarclang.pipeline.inputs import Options
    from yarclang.source import SourceFile
    from yarclang.teaching.edits import Program
    from yarclang.teaching.holding import around
    from yarclang.transforms import rpy_rotation

    random = np.random.default_rng(seed)
    text = (
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        "FRAME {TABLE} 100 900 800 10 20 30\n"
        "FRAME {PART} 50 60 70 -30 5 15 {TABLE}\n"
        "P0010 MOVEJ_RPY 0 0 0 0 0 0 [MIN] {PART}\n"
    )
    source = SourceFile(str(tmp_path / "way.yarc"), text)
    axes = ("X", "Y", "Z", "RX", "RY", "RZ")
    box = tuple(Range(axis, -50.0, 50.0) for axis in axes)
    options = Options(robot="INDUSTRIAL6")
    task = find_task(source, tmp_path, options, "part", box, "time")
    shift = tuple(random.uniform(-50, 50, 6).round(2))
    program, _ = moved(task, shift)
    from yarclang.robot.description import load_robot

    robot = load_robot("INDUSTRIAL6").value
    before, after = (around(Program(one), tmp_path, robot) for one in (source, program))
    table = before.scope.frame("TABLE").transform
    old, new = (np.linalg.inv(table) @ one.scope.frame("PART").transform for one in (before, after))
    assert new[:3, 3] - old[:3, 3] == pytest.approx(np.array(shift[:3]) * 1e-3, abs=2e-6)
    turn = rpy_rotation(np.radians(shift[3:]))
    assert new[:3, :3] == pytest.approx(turn @ old[:3, :3], abs=2e-5)  # the patch is rounded to 0.0001 deg
