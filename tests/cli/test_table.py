"""The certificate as a table."""

import re

import pytest
from click.testing import CliRunner

import yarclang
from yarclang.cli.table import certificate_table
from yarclang.cli.yarc import main


def test_a_jerk_that_isnt_judged_stands_in_parentheses():
    made = yarclang.compile(
        "P0010 MOVEJ_TOPP 0 0 0 0 -30 0 [MIN] (deg,s)\nP0020 MOVEJ_SCURVE 0 0 0 0 -40 0 [MIN] (deg,s)\n",
        robot="INDUSTRIAL6",
    ).value
    assert made is not None
    _, _, first, second = certificate_table(made.certificate).split("\n")
    jerk = made.certificate.commands[0].jerk
    assert f"  ({jerk.name} {jerk.share * 100:.0f}%)  " in first
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
