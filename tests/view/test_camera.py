"""Tests of the first position of the camera."""

from dataclasses import replace

import numpy as np
import pytest
from view.stages import CRASH, stage_of

from yarclang.report.solids import solid_of
from yarclang.shapes import Box
from yarclang.view.camera import first_view, hidden, shown_box
from yarclang.view.stage import Item

EYE = np.array([0.0, 0.0, 5.0])
TRIANGLE = np.array([[[-1.0, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]]])


@pytest.mark.parametrize(
    ("point", "wanted"), [([0, 0, 0], 1), ([0, 0, 2], 0), ([3, 3, 0], 0), ([0, 0, 9], 0), ([0, 0, 1], 0)]
)
def test_what_a_triangle_hides(point, wanted):
    assert hidden(EYE, np.array([point], dtype=float), TRIANGLE) == wanted
    assert hidden(EYE, np.array([point], dtype=float), TRIANGLE[:, ::-1]) == wanted


def test_nothing_hides_nothing():
    assert hidden(EYE, np.zeros((3, 3)), TRIANGLE[:0]) == 0


def test_it_looks_past_a_wall():
    stage = stage_of(CRASH)
    eye, middle = first_view(stage)
    assert eye[2] > middle[2]
    wall = Item("WALL", "obstacle", 0, np.eye(4), solid_of(Box(np.array([0.05, 3.0, 3.0]))), (0, 0, 0), 1.0)
    # put a body in the direction from which the camera looked before
    towards = (eye - middle)[:2] / np.linalg.norm((eye - middle)[:2])
    pose = np.eye(4)
    pose[:2, 0], pose[:2, 1] = towards, [-towards[1], towards[0]]
    pose[:3, 3] = middle
    pose[:2, 3] += towards
    walled = replace(stage, items=(*stage.items, replace(wall, base_from_item=pose)))
    other, same = first_view(walled)
    assert same == pytest.approx(middle)
    assert float((other - middle)[:2] @ towards) < 0.5 * float((eye - middle)[:2] @ towards)
    assert shown_box(walled, whole=True)[1].max() > shown_box(walled, whole=False)[1].max()
