"""Tests of dragging: a dragged frame gives the line that declares it at its new place; also tests of the
curves beside the picture.
"""

import dataclasses
import re
import socket
import tomllib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from view.stages import CRASH, EXAMPLES, stage_of

from yarclang.diagnostics import has_errors
from yarclang.hir import Gap
from yarclang.pipeline.inputs import Options, open_source
from yarclang.pipeline.stages import check_program
from yarclang.source import SourceFile
from yarclang.transforms import quaternions, rpy_rotation
from yarclang.view.curves import curves_html, curves_of, instant_html, key_html
from yarclang.view.door import Door, opened
from yarclang.view.dragging import Draggable
from yarclang.view.panel import Order
from yarclang.view.show import _Showing

TWO = """\
ROBOT INDUSTRIAL6
FRAME {TABLE} 0 1.0744 0.9 0 0 0 (m,rad) {B}
DEFAULT {TCP} [50%] (m,rad,s) {TABLE}
FRAME {PICK} 0.06 0.04 0.1 0 0 0.1 {TABLE}
FRAME {TORCH} 0 0 0.05 0 0 0 {FLANGE}
P0020 MOVEJ_RPY 0 0 0.15 0 0 0 {PICK}
P0030 MOVEJ_RPY {TORCH} 0 0 0.15 0 0 0 {TABLE}
"""

LOOP = """\
ROBOT INDUSTRIAL6
DEFAULT {TCP} [50%] (mm,deg,s) {B}
FOR I = 0 TO 1
  FRAME {HOLE} $(I*60) 1074.4 1100 0 0 0
  P0020 MOVEJ_RPY 0 0 $(10*I) 0 0 0 {HOLE}
END
"""


def frame_of(stage, name) -> Draggable:
    (found,) = (one for one in stage.draggable if one.name == name)
    return found


def turned(rpy):
    return np.roll(quaternions(rpy_rotation(np.asarray(rpy, dtype=float))), 1)


def links_of(text):
    """Return the pose of each named frame in its parent, and the parent's name."""
    opened_ = open_source(SourceFile("made.yarc", text), EXAMPLES, Options())
    assert opened_.value is not None, opened_.diagnostics
    checked = check_program(opened_.value.module, opened_.value.request)
    assert checked.value is not None, checked.diagnostics
    assert not has_errors(checked.diagnostics), checked.diagnostics
    found = {}
    for step in checked.value.steps:
        if not isinstance(step, Gap):
            for link in (step.origin.moving, step.origin.base):
                here = link
                while here is not None and here.parent is not None:
                    found[here.name] = (here.parent_from_frame, here.parent.name)
                    here = here.parent
    return found


def test_which_frames_can_be_dragged():
    stage = stage_of(TWO)
    found = {one.name: one for one in stage.draggable}
    assert set(found) == {"PICK", "TABLE", "TORCH", "NEW"}
    assert (found["PICK"].parent, found["PICK"].joint, found["PICK"].line) == ("TABLE", 0, 4)
    assert (found["TORCH"].parent, found["TORCH"].joint) == ("FLANGE", 6)
    assert found["NEW"].parent == "B"
    axes = {one.name: one for one in stage.axes}
    for name in ("PICK", "TABLE", "TORCH"):
        assert found[name].base_from_frame == pytest.approx(axes[name].base_from_frame)


def test_a_frame_of_a_loop_has_no_single_line():
    assert [one.name for one in stage_of(LOOP).draggable] == ["NEW"]


def test_a_new_frame_takes_a_name_of_its_own():
    text = TWO.replace("{PICK}", "{NEW}").replace("P0030", "! NEW2\nP0030")
    assert [one.name for one in stage_of(text).draggable if not one.source] == ["NEW3"]


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(["PICK", "TABLE", "TORCH"]),
    st.tuples(*3 * [st.floats(-3.0, 3.0)]),
    st.tuples(*3 * [st.floats(-3.1, 3.1)]),
)
def test_the_line_is_valid_and_puts_the_frame_there(name, position, rpy):
    """The line is valid in a program with other units and another base, and declares the frame at the dragged
    pose.
    """
    one = frame_of(stage_of(TWO), name)
    wxyz = turned(rpy)
    wanted = one.moved_to(np.array(position), wxyz)
    line = one.declaration(wanted)
    text = re.sub(rf"^FRAME {{{name}}}.*$", line, TWO, flags=re.M)
    assert text != TWO
    found, parent = links_of(text)[name]
    assert parent == one.parent
    assert found[:3, 3] == pytest.approx(wanted[:3, 3], abs=1.1e-7)
    assert found[:3, :3] == pytest.approx(wanted[:3, :3], abs=1e-6)
    wanted_at = one.base_from_parent @ found
    assert wanted_at[:3, 3] == pytest.approx(np.array(position), abs=2e-6)
    assert wanted_at[:3, :3] == pytest.approx(rpy_rotation(np.array(rpy)), abs=1e-6)


def test_a_frame_of_the_cell_gives_its_table():
    one = frame_of(stage_of(CRASH), "FIXTURE")
    assert one.in_cell
    pose = one.parent_from_frame.copy()
    pose[:3, 3] += [0.001, -0.0025, 0.0]
    table = tomllib.loads(one.declaration(pose))["frames"]["FIXTURE"]
    assert table["parent"] == "B"
    assert table["units"] == "mm,deg"
    assert table["xyz"] == pytest.approx([1.0, 617.5, 560.0])
    assert table["rpy"] == pytest.approx([0.0, 0.0, 0.0])


def test_orders_show_the_line_and_move_the_handles():
    stage = stage_of(CRASH)
    names = [one.name for one in stage.draggable]
    part = names.index("PART")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with opened(Door("127.0.0.1", port)) as server:
        showing = _Showing(server, stage)
        showing._carry_out(Order("drag", part))
        assert showing._panel._line.value == "FRAME {PART} 0 0 100 0 0 0 (mm,deg) {FIXTURE}"
        place = stage.draggable[part].base_from_frame
        showing._carry_out(Order("dragged", place[:3, 3] + [0.01, 0.0, 0.0], turned([0.0, 0.0, np.pi / 2])))
        assert showing._panel._line.value == "FRAME {PART} 10 0 100 0 0 90 (mm,deg) {FIXTURE}"
        showing._carry_out(Order("drag", -1))
        assert showing._panel._line.value == ""
        # a message from handles that were removed meanwhile changes nothing
        showing._carry_out(Order("dragged", place[:3, 3], turned([0.0, 0.0, 0.0])))
        assert showing._panel._line.value == ""
        showing._carry_out(Order("drag", len(names) - 1))
        assert showing._panel._line.value.startswith("FRAME {NEW} ")
        assert showing._panel._line.value.endswith(" (mm,deg) {B}")


def test_curves_are_those_of_the_motion():
    stage = stage_of(CRASH)
    joints, speeds, frame = curves_of(stage)
    times = np.linspace(0.0, stage.duration, len(joints.values))
    q, v = stage.track.at(times)
    limits = stage.robot.limits
    assert joints.values == pytest.approx(
        100.0 * ((q - limits.lower) / (limits.upper - limits.lower) * 2.0 - 1.0), abs=1e-9
    )
    assert speeds.values == pytest.approx(100.0 * v / limits.velocity)
    assert frame.values.max() == pytest.approx(frame.high)
    text = curves_html((joints, speeds, frame))
    assert text.count("<polyline") == 13
    assert text.count("<svg") == text.count("</svg>") == 3
    assert all(name in key_html((joints, speeds, frame)) for name in stage.robot.joint_names)
    heights = [float(one) for one in re.findall(r",(-?[\d.]+)[ \"]", text)]
    assert min(heights) >= -0.01
    assert max(heights) <= 70.01


def test_the_marker_is_where_the_time_is():
    for share in (0.0, 0.25, 1.0):
        assert f"--yarc-instant: {100.0 * share:.3f}%" in instant_html(share)
    assert curves_html(curves_of(stage_of(CRASH))).count("var(--yarc-instant") == 1


def test_without_time_there_are_no_curves():
    stage = stage_of("ROBOT INDUSTRIAL6\nP0010 STOP\n")
    assert curves_of(stage) == ()
    assert key_html(()) == ""


def test_curves_of_names_with_markup():
    stage = stage_of(CRASH)
    robot = dataclasses.replace(stage.robot, joint_names=("<b>", *stage.robot.joint_names[1:]))
    text = curves_html(curves_of(dataclasses.replace(stage, robot=robot, frame="<i>")))
    assert "<b>" not in text
    assert "<i>" not in text
