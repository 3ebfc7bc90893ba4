"""Tests that the record of the main ratios, the table in RESULTS.md and the warnings agree; they measure
nothing.
"""

import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[1] / "benchmarks"


@pytest.fixture
def ratios(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    yield __import__("ratios")
    for name in ("ratios", "measure"):
        sys.modules.pop(name, None)


def test_the_table_is_that_of_the_record(ratios):
    results = ratios.RESULTS.read_text(encoding="utf-8")
    measured, recorded = ratios.read_record()
    assert ratios.with_table(results, measured, recorded) == results
    assert ratios.table(measured, recorded) in results
    assert ratios.RECORD.read_text(encoding="utf-8") == ratios.record_text(measured, recorded)


def test_a_ratio_warns_beyond_its_goal_and_where_it_is_worse_than_recorded(ratios):
    small = ratios.Ratio("start", "a start", 1.8, False, 1.4)
    assert [small.warning(found) for found in (1.0, 1.5, 1.6)] == ["", "", ""]
    assert small.warning(1.79) == "a start: 1.79, 1.4 was recorded last"
    assert small.warning(1.81) == "a start: 1.81, the goal is at most 1.8"
    large = ratios.Ratio("peer", "a peer", 3.0, True, 4.0)
    assert [large.warning(found) for found in (5.0, 3.5)] == ["", ""]
    assert large.warning(3.1) == "a peer: 3.1, 4 was recorded last"
    assert large.warning(2.9) == "a peer: 2.9, the goal is at least 3"


def test_measured_ratios_are_printed_recorded_and_warned_of(ratios, monkeypatch, tmp_path, capsys):
    _, recorded = ratios.read_record()
    found = {one.name: one.goal for one in recorded} | {"help": 99.0}
    monkeypatch.setattr(ratios, "WORSE", 1e9)
    for name in ("startup", "planning", "editing", "stages", "collisions", "cost"):
        monkeypatch.setattr(ratios, name, lambda _, name=name: found if name == "startup" else {})
    for name in ("RECORD", "RESULTS"):
        copy = tmp_path / getattr(ratios, name).name
        copy.write_text(getattr(ratios, name).read_text(encoding="utf-8"))
        monkeypatch.setattr(ratios, name, copy)
    monkeypatch.setattr(sys, "argv", ["ratios.py", "--record", "a machine"])
    ratios.main()
    warnings = [line for line in capsys.readouterr().out.splitlines() if line.startswith("warning: ")]
    assert len(warnings) == 1
    assert "99, the goal is at most 1.5" in warnings[0]
    measured, again = ratios.read_record()
    assert measured.endswith(", a machine")
    assert {one.name: one.last for one in again} == found
    assert "| 99 | at most 1.5 |" in ratios.RESULTS.read_text(encoding="utf-8")
    found.pop("cost")
    with pytest.raises(AssertionError, match="other ratios"):
        ratios.main()
