"""Tests of the frames that are drawn, and of those that are shown at first."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from view.stages import EXAMPLES, stage_of

from yarclang.view.stage import Axes
from yarclang.view.switches import GROUPS, Switches
from yarclang.view.triads import names_of, triads_of


def axes(name, place, joint=0, *, matters=True):
    pose = np.eye(4)
    pose[:3, 3] = place
    return Axes(name, joint, pose, False, matters)


PLACES = st.tuples(*[st.sampled_from([0.0, 0.3, 1.0])] * 3)


@given(
    st.lists(
        st.builds(
            lambda name, place, joint, matters: axes(name, place, joint, matters=matters),
            st.sampled_from(["B", "CELL", "TCP", "PALLET"]),
            PLACES,
            st.sampled_from([0, 6]),
            st.booleans(),
        ),
        max_size=20,
    )
)
def test_each_place_has_one_triad_and_each_name_is_written_once(given_axes):
    triads, names = triads_of(given_axes), names_of(given_axes, 0.1)
    places = [(one.joint, one.base_from_frame.tobytes()) for one in triads]
    assert len(set(places)) == len(places)
    assert set(places) == {(one.joint, one.base_from_frame.tobytes()) for one in given_axes}
    for triad, place in zip(triads, places, strict=True):
        there = [one for one in given_axes if (one.joint, one.base_from_frame.tobytes()) == place]
        assert triad.matters == any(one.matters for one in there)
    text = " ".join(one.text for one in names)
    for name in ("B", "CELL", "TCP", "PALLET"):
        assert text.count(f"{{{name}}}") == any(one.name == name for one in given_axes)
    # each frame that is shown at first has a label
    seen = " ".join(one.text for one in names if one.matters)
    assert all(f"{{{one.name}}}" in seen for one in given_axes if one.matters)


def test_coinciding_frames_have_one_name():
    (name,) = names_of([axes("B", (0, 0, 0)), axes("CELL", (0, 0, 0))], 0.1)
    assert name.text == "{B} {CELL}"


def test_the_frame_of_a_loop_is_written_once_and_the_rest_can_be_switched_on():
    stage = stage_of((EXAMPLES / "06_palletising.yarc").read_text())
    names = names_of(stage.axes, 0.1)
    assert [one.text for one in names if "{CELL}" in one.text and one.matters] != []
    assert " ".join(one.text for one in names).count("{CELL}") == 1
    assert "{CELL} 1 of 24" in " ".join(one.text for one in names)
    assert {one.name for one in stage.axes if one.matters} == {"B", "GRIPPER", "CELL", "CORNER", "CONVEYOR"}
    assert not any(one.name == "FLANGE" and one.matters for one in stage.axes)


@given(st.lists(st.tuples(st.sampled_from([*GROUPS]), st.booleans()), max_size=30))
def test_a_node_is_visible_if_none_of_its_groups_is_off(presses):
    switches = Switches()
    groups = [("zone",), ("zone", "names"), ("other_axes", "names"), ("axes",)]
    nodes = [SimpleNamespace(visible=True) for _ in groups]
    for node, each in zip(nodes, groups, strict=True):
        switches.add(node, *each)
    off = {"other_axes", "shape"}
    for name, is_shown in presses:
        switches.switch(name, is_shown)
        (off.discard if is_shown else off.add)(name)
        assert switches.hidden == off
        assert [node.visible for node in nodes] == [off.isdisjoint(each) for each in groups]


@pytest.mark.parametrize("has_planned", [False, True])
def test_switches_of_a_run_say_which_robot_they_hide(has_planned):
    switches = Switches()
    for name in ("robot", "way", *(("planned", "planned_way") if has_planned else ())):
        switches.add(SimpleNamespace(visible=True), name)
    words = ["actual robot", "planned robot", "actual path", "planned path"]
    assert [*switches.groups.values()] == (words if has_planned else ["robot", "path"])
