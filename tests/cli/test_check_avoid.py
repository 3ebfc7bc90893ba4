"""`yarc check --fix` on motions that collide, and on motions around obstacles.

A colliding motion is repaired. The path around an obstacle is written down only on request.
"""

import pytest
from click.testing import CliRunner
from conftest import EXAMPLES

from yarclang.cli.yarc import main


@pytest.fixture
def straight(tmp_path):
    """Write example 12 with straight motions instead of _AVOID."""
    (tmp_path / "12_machine_cell.toml").write_text((EXAMPLES / "12_machine_cell.toml").read_text())
    path = tmp_path / "straight.yarc"
    path.write_text((EXAMPLES / "12_machine_cell.yarc").read_text().replace("_AVOID", ""))
    return path


def check(*arguments):
    return CliRunner().invoke(main, ["check", *map(str, arguments)])


def test_straight_it_is_refused_and_fixes_lead_round(straight):
    done = check(straight)
    assert done.exit_code == 1
    assert "Y0901" in done.output
    assert " penetrates GAUGE by " in done.output
    done = check(straight, "--fix")
    assert done.exit_code == 0
    lines = straight.read_text().splitlines()
    assert [line.split()[1] for line in lines if "_AVOID" in line] == ["MOVEJ_RPY_AVOID"]
    assert "MOVEJ_SPLINE" not in straight.read_text()
    done = check(straight, "--fix", "--select", "Y0920")
    assert done.exit_code == 0
    text = straight.read_text()
    assert "_AVOID" not in text
    assert "JOINTS P0060_VIA1 " in text
    assert "P0060 MOVEJ_SPLINE_RPY P0060_VIA1; 0 0 120 0 0 0 {MACHINE}" in text
    assert "Y0920" not in check(straight).output
