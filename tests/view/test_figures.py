"""Tests of the texts and curves beside the picture."""

from dataclasses import replace

import numpy as np
import pytest
from view.stages import CRASH, stage_of

from yarclang.report.clearance import near
from yarclang.view import colours
from yarclang.view.figures import (
    instant_html,
    key_html,
    legend_html,
    mark_html,
    near_text,
    notes_html,
    piece_html,
)


def test_the_figures_of_an_instant():
    stage = stage_of(CRASH)
    when = stage.pieces[2].ends
    q = stage.track.at(np.array([when]))[0]
    nearest = near_text(stage.scene, near(stage.scene, q))
    assert nearest == "-30.0 mm (FINGERS, BENCH)"
    text = instant_html(stage, when, nearest)
    assert "-200.0 620.0 300.0 mm, 0.0 0.0 0.0 deg" in text
    assert "0.0 mm/s" in text
    assert nearest in text
    assert "{GRIPPER} in {B}" in text


def test_nothing_near():
    stage = stage_of(CRASH)
    home = near(stage.scene, stage.robot.home[None])
    assert near_text(stage.scene, home) == "58.0 mm (FINGERS, link_5)"
    assert near_text(stage.scene, replace(home, pair=np.array([-1]))) == "over 200 mm"
    assert near_text(None, home) == "over 200 mm"


def test_commands_and_findings():
    stage = stage_of(CRASH)
    assert "P0030 MOVEL" in piece_html(stage.pieces[2])
    assert "line 8" in piece_html(stage.pieces[2])
    mark = next(one for one in stage.marks if one.code == "Y0901")
    assert "error Y0901" in mark_html(mark)
    assert "FINGERS penetrates BENCH by 30 mm" in mark_html(mark)
    assert "bodies that touch" in key_html(stage)
    assert "INDUSTRIAL6" in notes_html(stage)


def test_names_are_text_and_not_markup():
    from dataclasses import replace

    stage = replace(stage_of(CRASH), title="<img src=x>.yarc")
    assert "<img" not in notes_html(stage)
    piece = replace(stage.pieces[0], facts=(("holds", "<script>alert(1)</script>"),))
    assert "<script" not in piece_html(piece)


def test_the_legend_has_a_unit_and_its_ends():
    text = legend_html("clearance", 200.0, "mm", "clearance", is_capped=True)
    assert "≥ 200 mm" in text
    assert ">100<" in text


@pytest.mark.parametrize(
    ("value", "wanted"), [(0.0, 1.0), (0.7, 1.0), (1.0, 1.0), (212.0, 500.0), (501.0, 1000.0)]
)
def test_scales_end_at_round_numbers(value, wanted):
    assert colours.round_up(value) == pytest.approx(wanted)


def test_colours_run_from_end_to_end():
    shades = colours.coloured(np.array([-1.0, 0.0, 250.0, 500.0, 900.0]), 500.0, "speed")
    assert shades[0].tolist() == shades[1].tolist() == list(colours.RAMPS["speed"][0])
    assert shades[2].tolist() == list(colours.RAMPS["speed"][2])
    assert shades[4].tolist() == list(colours.RAMPS["speed"][-1])
    assert colours.linear(np.array([[0, 128, 255]], dtype=np.uint8)).tolist() == [[0, 55, 255]]
