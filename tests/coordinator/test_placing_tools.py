"""Tests of what users declare about tools of a tool changer: each tool is on the flange or in its place, and
at most one is on the flange.
"""

import numpy as np
import pytest

from tests.handling.changing import CELL, robot
from yarclang.coordinator.kept_parts import Known
from yarclang.coordinator.placing import as_filed, gone, put
from yarclang.handling.present import present_of
from yarclang.pipeline.cells import cell_loader
from yarclang.runtime.actions import Trouble


@pytest.fixture
def known(tmp_path):
    (tmp_path / "cell.toml").write_text(CELL)
    cell = cell_loader(tmp_path, robot())("cell.toml", None).value
    return Known(cell, present_of(cell))


def place_of(known, name):
    return next(one.rack.place.transform for one in known.cell.parts if one.body.name == name)


def poses(known):
    return {one.name: (one.gripper, one.pose) for one in known.present.parts.items}


def test_a_tool_is_put_on_the_flange_and_back_exactly(known):
    on = put(known, robot(), "GRIPPER", np.eye(4), "M1")
    assert on.present.parts.tools == ("GRIPPER",)
    assert "M1" in on.present.parts.closed
    near = place_of(known, "GRIPPER").copy()
    near[0, 3] += 3e-4
    back = put(on, robot(), "GRIPPER", near, None)
    assert poses(back) == poses(known)
    assert poses(as_filed(on, "GRIPPER")) == poses(known)
    assert "GRIPPER" not in poses(gone(known, "GRIPPER"))


@pytest.mark.parametrize(
    ("name", "gripper", "off", "words"),
    [
        ("GRIPPER", None, 6e-4, "be only in its place"),
        ("GRIPPER", "M2", 0.0, "be only in its place"),
        ("SUCTION", "M1", 0.0, "the gripper holds GRIPPER"),
        ("BLOCK", "M1", 0.0, "holds only tools, not parts"),
        ("BLOCK", "M3", 0.0, "belongs to SUCTION"),
    ],
)
def test_what_can_not_be_is_refused(known, name, gripper, off, words):
    on = put(known, robot(), "GRIPPER", np.eye(4), "M1")
    if name == "BLOCK" and gripper == "M1":
        on = known
    pose = place_of(known, "GRIPPER").copy()
    pose[0, 3] += off
    with pytest.raises(Trouble, match=words):
        put(on, robot(), name, pose, gripper)


def test_two_tools_never_hang_on_the_flange(tmp_path):
    (tmp_path / "cell.toml").write_text(CELL.replace("xyz = [150, 0, 0]", "xyz = [150, 0, 0]\non = true"))
    cell = cell_loader(tmp_path, robot())("cell.toml", None).value
    known = Known(cell, present_of(cell))
    away = put(known, robot(), "SUCTION", place_of(known, "SUCTION"), None)
    on = put(away, robot(), "GRIPPER", np.eye(4), "M1")
    with pytest.raises(Trouble, match="both"):
        as_filed(on, "SUCTION")
