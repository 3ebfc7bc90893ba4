"""Tests of tools that a program changes, in the picture: all bodies of each tool are shown, in the rack and
on the flange.
"""

from tests.view.stages import EXAMPLES, stage_of
from yarclang.view import colours


def test_all_bodies_of_a_changed_tool_are_drawn_where_it_is():
    stage = stage_of((EXAMPLES / "29_tool_changer.yarc").read_text())
    items = [one for one in stage.items if one.name == "GRIPPER"]
    assert {one.colour for one in items} == {colours.TOOL}
    # the bodies are in the rack, on the flange, and in the rack again
    assert sorted((one.begins, one.joint) for one in items)[::3] == sorted(
        {(one.begins, one.joint) for one in items}
    )
    times = sorted({one.begins for one in items})
    assert [len([one for one in items if one.begins == time]) for time in times] == [3, 3, 3]
