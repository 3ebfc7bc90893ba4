"""Tests of tools that a program changes: the tool on the flange with its mass, bodies and frames, and the
places where it may be changed.
"""

from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from floors import exercises
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from programs import codes

from tests.certify.forging import Forger
from tests.handling.changing import IN, OUT, OVER, errors, made, put, robot, take, text_of, written
from tests.robot.heavy_chains import heavy
from yarclang.cell.tools import weight_of
from yarclang.certify.bodies.handled import tools_again
from yarclang.certify.certifying import certify
from yarclang.handling.racks import apart, is_in_place
from yarclang.handling.surroundings import load_cases
from yarclang.handling.walk import followed, handling_of
from yarclang.hir import Motion, SetOutput
from yarclang.pipeline.cells import cell_loader
from yarclang.report.carried import carried_in_plan
from yarclang.robot.dynamics import torques
from yarclang.robot.model import Tool, ToolShape
from yarclang.shapes import Sphere


def tools_of(plan):
    """Return the tools on the flange during each motion, by the label of its command."""
    carried = carried_in_plan(plan)
    return {
        plan.program.steps[one.step].origin.label: one.parts.tools for one in carried.states if one.is_motion
    }


def test_a_tool_is_on_from_its_change_to_the_next(tmp_path):
    result = made(tmp_path, take("GRIPPER"), put("GRIPPER"), take("SUCTION"))
    assert errors(result) == []
    on = list(tools_of(result.value.plan).values())
    assert on == [(), (), ("GRIPPER",), ("GRIPPER",), ("GRIPPER",), (), (), (), ("SUCTION",)]


def test_tool_sets_the_lock_as_set_does(tmp_path):
    tool = made(tmp_path, take("GRIPPER"), put("GRIPPER"))
    plain = text_of(take("GRIPPER"), put("GRIPPER"))
    plain = plain.replace("TOOL GRIPPER", "SET LOCK ON").replace("TOOL NONE", "SET LOCK OFF")
    same = made(tmp_path, plain)
    kinds = [
        [(one.output.variable, one.value) for one in each.value.program.steps if isinstance(one, SetOutput)]
        for each in (tool, same)
    ]
    assert kinds[0] == kinds[1] == [("M1", 1.0), ("M1", 0.0)]


def test_all_bodies_of_a_tool_are_where_it_is(tmp_path):
    plan = made(tmp_path, take("GRIPPER"), OVER % "S", plan=True).value
    carried = carried_in_plan(plan)
    for state in carried.states:
        cell = carried.cell_of(state)
        bodies = [one for one in cell.obstacles if one.name == "GRIPPER"]
        assert [one.mount.on_flange for one in bodies] == [bool(state.parts.tools)] * 3
        (tool,) = (one for one in robot().tools if one.name == "GRIPPER")
        base = np.eye(4) if state.parts.tools else place("GRIPPER", plan)
        for body, shape in zip(bodies, tool.shapes, strict=True):
            assert body.mount.transform == pytest.approx(base @ shape.flange_from_shape, abs=1e-12)
        assert [one.mass for one in bodies] == [3.2, None, None]


def place(name, plan):
    return next(one.rack.place.transform for one in plan.program.cell.parts if one.body.name == name)


def test_a_tool_in_the_rack_is_an_obstacle_and_so_is_one_on_the_flange(tmp_path):
    through = ["MOVEJ_RPY 0 -60 0 0 0 0 {G}", "MOVEL 0 -60 0 0 0 0 [4] {S}"]
    assert errors(made(tmp_path, through)) == []
    with_gripper = made(tmp_path, take("GRIPPER"), through)
    assert {"Y0901"} <= set(codes(errors(with_gripper)))
    lower = ["MOVEJ_RPY 0 -60 0 0 0 0 {G}", "MOVEL 0 20 0 0 0 0 [4] {G}"]
    assert "Y0901" in codes(errors(made(tmp_path, lower)))


@pytest.mark.parametrize(
    ("parts", "code", "words"),
    [
        ([OVER % "G", "TOOL GRIPPER"], "Y0951", "200 mm"),
        ([OVER % "S", IN % "S", "TOOL GRIPPER", OUT % "S"], "Y0951", "SUCTION is on the flange"),
        ([take("GRIPPER"), OVER % "S", "TOOL SUCTION"], "Y0951", "GRIPPER is on the flange"),
        ([OVER % "G", "SET LOCK ON", IN % "G", "TOOL GRIPPER"], "Y0951", "already locked"),
        ([OVER % "G", "MOVEL 0 -0.6 0 0 0 0 [2] {G}", "TOOL GRIPPER"], "Y0951", "0.6 mm and"),
        ([OVER % "G", "MOVEL 0 0 0 0 0.6 0 [2] {G}", "TOOL GRIPPER"], "Y0951", "0.6 deg from"),
        ([take("GRIPPER"), OVER % "G", "TOOL NONE"], "Y0952", "200 mm"),
        ([take("GRIPPER"), "MOVEJ {FINGERS} READY", "MOVEL {CUP} 0 -10 0 0 0 0 {RACK}"], "Y0954", "GRIPPER"),
        (["MOVEJ_RPY {FINGERS} 0 0 150 0 0 0 {BLOCK}"], "Y0954", "no tool"),
        (["SET GRIP ON"], "Y0954", "belongs to GRIPPER"),
    ],
)
def test_a_tool_that_is_changed_wrongly_is_told(tmp_path, parts, code, words):
    found = [one for one in made(tmp_path, parts).diagnostics if one.code == code]
    assert found, codes(made(tmp_path, parts).diagnostics)
    assert any(words in one.message for one in found)


def test_within_its_reach_the_changer_takes_a_tool_exactly(tmp_path):
    near = [OVER % "G", "MOVEL 0 -0.4 0 0 0 0 [2] {G}", "TOOL GRIPPER", OUT % "G", put("GRIPPER")]
    result = made(tmp_path, near)
    assert errors(result) == []
    carried = carried_in_plan(result.value.plan)
    first, last = carried.states[0].parts, carried.states[-1].parts
    assert first.items == last.items


def test_a_tool_may_not_be_put_back_with_a_part(tmp_path):
    grip = [
        "MOVEJ_RPY {FINGERS} 0 0 150 0 0 0 {BLOCK}",
        "MOVEL {FINGERS} 0 0 0 0 0 0 [2] {BLOCK}",
        "SET GRIP ON",
    ]
    grip += ["MOVEL {FINGERS} 0 0 150 0 0 0 [2] {BLOCK}"]
    found = errors(made(tmp_path, take("GRIPPER"), grip, put("GRIPPER")))
    assert any(one.code == "Y0952" and "holds BLOCK" in one.message for one in found)


def test_the_fingers_of_a_tool_may_touch_what_they_take(tmp_path):
    """The fingers may overlap the block that they press, but only while they approach or leave it."""
    fingers = {'frame = "BLOCK"\nsize = [60, 60, 60]': 'frame = "BLOCK"\nsize = [70, 60, 60]'}
    way = ["MOVEJ_RPY {FINGERS} 0 0 150 0 0 0 {BLOCK}", "MOVEL {FINGERS} 0 0 0 0 0 0 [2] {BLOCK}"]
    grip = [*way, "SET GRIP ON", "MOVEL {FINGERS} 0 0 150 0 0 0 [2] {BLOCK}"]
    drop = [
        "MOVEL {FINGERS} 0 0 0 0 0 0 [2] {BLOCK}",
        "SET GRIP OFF",
        "MOVEL {FINGERS} 0 0 150 0 0 0 [2] {BLOCK}",
    ]
    assert errors(made(tmp_path, take("GRIPPER"), grip, drop, changes=fingers)) == []
    assert "Y0901" in codes(errors(made(tmp_path, take("GRIPPER"), way, changes=fingers)))


def test_ways_that_meet_with_different_tools_are_told_with_both(tmp_path):
    result = made(
        tmp_path, "MOVEJ READY", "WHEN GOOD ON", take("GRIPPER"), "MOVEJ READY", "END", "MOVEJ READY"
    )
    (found,) = [one for one in errors(result) if one.code == "Y0953"]
    assert "different tools on the flange: no tool and GRIPPER" in found.message
    assert "WHEN in line" in found.message


def test_each_way_may_change_its_own_tool_and_put_it_back(tmp_path):
    ways = ["WHEN GOOD ON", take("GRIPPER"), put("GRIPPER"), "MOVEJ READY", "ELSE"]
    ways += [take("SUCTION"), put("SUCTION"), "MOVEJ READY", "END", "MOVEJ READY"]
    assert errors(made(tmp_path, ways)) == []


def test_a_pass_of_a_loop_ends_with_the_tool_of_its_beginning(tmp_path):
    loop = ["MOVEJ READY", "LOOP", take("GRIPPER"), "MOVEJ READY", "UNTIL GOOD ON"]
    assert "Y0948" in codes(errors(made(tmp_path, loop)))
    back = [
        "MOVEJ READY",
        "LOOP",
        take("GRIPPER"),
        put("GRIPPER"),
        "MOVEJ READY",
        "UNTIL GOOD ON",
        put("GRIPPER"),
    ]
    assert "Y0948" not in codes(errors(made(tmp_path, back)))


def test_a_lock_takes_no_computed_value(tmp_path):
    computed = ["REGISTER N 0..1", "MOVEJ READY", "SET LOCK = N"]
    assert "Y0949" in codes(errors(made(tmp_path, computed)))


def test_a_tool_is_changed_at_rest(tmp_path):
    flows = [OVER % "G", "MOVEL 0 0 0 0 0 0 [2] {G} BLEND 1", "TOOL GRIPPER", OUT % "G"]
    assert "Y0944" in codes(errors(made(tmp_path, flows)))


def test_a_program_may_begin_with_a_tool(tmp_path):
    on = {"xyz = [-150, 0, 0]": "xyz = [-150, 0, 0]\non = true"}
    result = made(tmp_path, put("GRIPPER"), changes=on)
    assert errors(result) == []
    assert list(tools_of(result.value.plan).values()) == [("GRIPPER",), ("GRIPPER",), ()]
    assert "Y0951" in codes(errors(made(tmp_path, take("SUCTION"), changes=on)))


ZONE = (
    "\n"
    "[[zones]]\n"
    'name = "ROOM"\n'
    'rule = "allowed"\n'
    'shape = "box"\n'
    'frame = "B"\n'
    "xyz = [0, 0, 1000]\n"
    "size = [4000, 4000, 2000]\n"
)


def test_a_zone_that_watches_the_tool_wants_one_that_is_there(tmp_path):
    watched = {'[[obstacles]]\nname = "RACK_POST"': f'{ZONE}[[obstacles]]\nname = "RACK_POST"'}
    assert "Y0954" in codes(errors(made(tmp_path, "MOVEJ {CUP} READY", changes=watched)))
    assert errors(made(tmp_path, "MOVEJ {FLANGE} READY", changes=watched)) == []
    assert errors(made(tmp_path, "MOVEJ {CUP} READY")) == []


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ('name = "SUCTION"', 'name = "WELDER"', "Y1378"),
        ('name = "SUCTION"', 'name = "GRIPPER"', "Y1311"),
        ('locks_at = "ON"', "", "Y1378"),
        ('locks_at = "ON"', 'locks_at = "ON"\nsafe = "OFF"', "Y1378"),
        ('locks_at = "ON"', 'locks_at = "ON"\nreach = 0', "Y1308"),
        ('locks_at = "ON"', 'locks_at = "ON"\nreach = 50', "Y1308"),
        ('locks_at = "ON"', 'locks_at = "ON"\ngrips = "FLANGE"', "Y1305"),
        ('tool = "SUCTION"', 'tool = "SUCKER"', "Y1378"),
        ('grips = "CUP"', 'grips = "NOWHERE"', "Y1329"),
        ("xyz = [150, 0, 0]", 'xyz = [150, 0, 0]\nframes = ["RACK"]', "Y1378"),
        ('frame = "RACK"\nxyz = [150', 'frame = "FLANGE"\nxyz = [150', "Y1374"),
        ('variable = "M3"', 'variable = "M3"\nlocks_at = 1', "Y1305"),
        ("[outputs.SUCK]", '[outputs.OTHER]\nvariable = "M9"\nlocks_at = 1\n[outputs.SUCK]', "Y1378"),
    ],
)
def test_a_rack_that_is_wrong_is_told_at_its_line(tmp_path, old, new, code):
    written(tmp_path, {old: new})
    loaded = cell_loader(tmp_path, robot())("cell.toml", None)
    found = [one for one in loaded.diagnostics if one.is_error]
    assert code in codes(found)
    assert all(one.span is not None for one in found)


def test_two_tools_on_the_flange_at_the_start_are_told(tmp_path):
    both = {
        "xyz = [-150, 0, 0]": "xyz = [-150, 0, 0]\non = true",
        "xyz = [150, 0, 0]": "xyz = [150, 0, 0]\non = true",
    }
    written(tmp_path, both)
    assert "Y1378" in codes(cell_loader(tmp_path, robot())("cell.toml", None).diagnostics)


@pytest.mark.parametrize("change", ["mounted", "without bodies"])
def test_a_tool_of_the_rack_is_not_mounted_and_has_bodies(tmp_path, change):
    arm = robot()
    first, second = arm.tools
    other = replace(second, mounted=True) if change == "mounted" else replace(second, shapes=())
    written(tmp_path, {})
    loaded = cell_loader(tmp_path, replace(arm, tools=(first, other)))("cell.toml", None)
    assert "Y1378" in codes(loaded.diagnostics)


# the judge


PAIR = (take("GRIPPER"), put("GRIPPER"), take("SUCTION"), "MOVEJ READY")


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """Return a certified program that changes tools, and its text."""
    folder = tmp_path_factory.mktemp("tools")
    result = made(folder, *PAIR)
    assert errors(result) == []
    return result.value


@pytest.mark.parametrize(
    "forge",
    [
        lambda text: text.change("M1=1", "M1=0"),
        lambda text: text.change("M1=0", "M1=1"),
        lambda text: text.change("M1=1", "M2=1"),
        lambda text: text.drop(text.find("M1=1")),
        lambda text: text.drop(text.find("M1=0")),
        lambda text: text.put(text.find("M1=0"), "M1=1"),
        lambda text: text.put(text.moves()[3], "M1=0"),
        lambda text: text.change("; command 2 P0030 TOOL (.*)", r"; command 2 P0030 SET \1"),
    ],
)
def test_a_text_whose_tool_lines_were_forged_is_refused(done, forge):
    forged = forge(Forger.of(done.text))
    program = done.plan.program
    found = certify(forged.text, program, robot(), robot().tolerance)
    assert [one for one in found.diagnostics if one.is_error]


def test_the_judge_refuses_a_tool_that_its_files_do_not_have(done):
    """The planner may use a wrong mass, place or body of a tool: the judge reads the files itself, and
    refuses the text.
    """
    program = done.plan.program
    cell = program.cell
    assert certify(done.text, program, robot(), robot().tolerance).value is not None
    at = next(k for k, one in enumerate(cell.parts) if one.rack is not None)
    part = cell.parts[at]
    shift = np.eye(4)
    shift[0, 3] = 1e-3
    moved = replace(part.rack.place, transform=shift @ part.rack.place.transform)
    wrong = [
        replace(part, body=replace(part.body, mass=1.0)),
        replace(part, body=replace(part.body, weight=replace(part.body.weight, center=np.ones(3)))),
        replace(part, body=replace(part.body, weight=replace(part.body.weight, inertia=np.eye(3)))),
        replace(part, rack=replace(part.rack, place=moved)),
        replace(part, rack=replace(part.rack, more=part.rack.more[1:])),
        replace(part, rack=replace(part.rack, flange_from_body=shift)),
        replace(part, body=replace(part.body, mount=replace(part.body.mount, transform=shift))),
    ]
    for other in wrong:
        parts = (*cell.parts[:at], other, *cell.parts[at + 1 :])
        changed = replace(program, cell=replace(cell, parts=parts))
        found = certify(done.text, changed, robot(), robot().tolerance)
        assert [one for one in found.diagnostics if one.code in ("Y1161", "Y1194")], found.diagnostics


# random programs


BLOCKS = {
    "take G": take("GRIPPER"),
    "put G": put("GRIPPER"),
    "take S": take("SUCTION"),
    "put S": put("SUCTION"),
    "ready": ["MOVEJ READY"],
}


class Wrong(Exception):
    """The program changes tools in a way that must be refused."""


def after(block, on):
    """Return the tool on the flange after a block, computed by the test."""
    word, _, name = block.partition(" ")
    tool = {"G": "GRIPPER", "S": "SUCTION"}.get(name)
    if word == "take":
        if on not in ("", tool):
            raise Wrong
        return tool
    if word == "put":
        if on not in ("", tool):
            raise Wrong
        return ""
    return on


def walked(blocks, on):
    """Return the tool after blocks. A list of two blocks is a WHEN, and both branches are followed."""
    for one in blocks:
        if isinstance(one, str):
            on = after(one, on)
        else:
            ends = {walked(way, on) for way in one}
            if len(ends) > 1:
                raise Wrong
            (on,) = ends
    return on


def written_out(blocks):
    for one in blocks:
        if isinstance(one, str):
            yield from BLOCKS[one]
        else:
            yield "WHEN GOOD ON"
            yield from written_out(one[0])
            yield "ELSE"
            yield from written_out(one[1])
            yield "END"


WAYS = st.lists(st.sampled_from(sorted(BLOCKS)), max_size=3).map(lambda blocks: [*blocks, "ready"])
RANDOM = st.lists(st.one_of(st.sampled_from(sorted(BLOCKS)), st.tuples(WAYS, WAYS)), min_size=1, max_size=4)


@exercises(consistent=0.15, refused=0.2, parted=0.3)
@settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(RANDOM)
def test_random_changes_are_refused_only_where_a_way_changes_wrongly(tally, tmp_path, blocks):
    blocks = ["ready", *blocks, "ready"]
    result = made(tmp_path, list(written_out(blocks)))
    found = {one.code for one in errors(result)} & {"Y0951", "Y0952", "Y0953", "Y0954", "Y1194"}
    try:
        walked(blocks, "")
        is_right = True
    except Wrong:
        is_right = False
    tally.count("consistent", is_right)
    tally.count("refused", not is_right)
    tally.count("parted", any(not isinstance(one, str) for one in blocks))
    if is_right:
        assert not found
        again_is_the_same(result)
    else:
        assert errors(result)


def again_is_the_same(result):
    """Check that the judge derives the tools that planner and proofs have used."""
    if result.value is None:
        return
    plan = result.value.plan
    ends = {
        motion.step: motion.curve.sample(np.array([motion.curve.duration]))[0][0] for motion in plan.motions
    }
    handling = handling_of(robot(), plan.program.cell, plan.program.steps)
    found = followed(handling, plan.program.start, ends)
    own = tools_again(handling, plan.program.start, ends)
    assert own == {step: "".join(parts.tools) for step, parts in found.before.items()}
    assert all(isinstance(plan.program.steps[step], Motion) for step in own)


# masses and poses


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.1, 20.0))
def test_torques_with_a_tool_of_the_rack_are_pinocchios(seed, mass):
    arm, random = heavy(seed, 6), np.random.default_rng(seed)
    placed, off = (pin.SE3.Random() for _ in range(2))
    center, spread = random.uniform(-0.2, 0.2, 3), np.diag(random.uniform(0.01, 0.02, 3))
    shapes = tuple(ToolShape(np.array(one.homogeneous), Sphere(0.05)) for one in (placed, off))
    tool = Tool("T", False, mass, center, spread, shapes)
    body = replace_body(tool)
    bare = Robot(arm)
    (loaded,) = load_cases(bare, Cellar((body,)))
    q, v, a = random.uniform(-1, 1, (3, 4, 6)) * np.array([3.0, 4.0, 20.0])[:, None, None]
    frame = arm.model.frames[arm.model.getFrameId("flange", pin.FrameType.BODY)]
    arm.model.appendBodyToJoint(frame.parentJoint, pin.Inertia(mass, center, spread), frame.placement)
    theirs = arm.rnea(q, v, a)
    assert torques(arm.chain, loaded, q, v, a) == pytest.approx(theirs, abs=1e-9 * np.abs(theirs).max())


class Robot:
    def __init__(self, arm):
        self.chain, self.dynamics = arm.chain, arm.dynamics


class Cellar:
    def __init__(self, obstacles):
        self.obstacles = obstacles


def replace_body(tool):
    from yarclang.cell.model import Mount, Obstacle

    first = tool.shapes[0]
    return Obstacle(
        tool.name,
        first.shape,
        Mount(first.flange_from_shape, True),
        0.0,
        tool.mass,
        is_part=True,
        of_tool=True,
        weight=weight_of(tool),
    )


@given(st.floats(0.0, 2e-3), st.floats(0.0, 0.02))
def test_what_is_in_place_is_within_reach_and_angle(distance, turn):
    from yarclang.cell.model import Mount, RackTool

    rack = RackTool(Mount(np.array(pin.SE3.Random().homogeneous), False), np.eye(4), (), (), "M1", (), 5e-4)
    random = np.random.default_rng(0)
    way, axis = random.normal(size=(2, 3))
    off = pin.SE3(pin.exp3(axis / np.linalg.norm(axis) * turn), way / np.linalg.norm(way) * distance)
    flange = rack.place.transform @ off.homogeneous
    assert apart(rack, flange) == pytest.approx((distance, turn), abs=1e-9)
    if abs(distance - 5e-4) > 1e-8 and abs(turn - np.deg2rad(0.5)) > 1e-8:
        assert is_in_place(rack, flange) == (distance < 5e-4 and turn < np.deg2rad(0.5))


@pytest.mark.parametrize("line", ["OUTPUT MINE M1 OFF", "OUTPUT MINE M1..M4 2"])
def test_no_stop_unlocks_the_changer(tmp_path, line):
    """The output of the lock may have a second name with a safe value, which must not unlock the tool."""
    found = errors(made(tmp_path, line, take("GRIPPER")))
    assert any(one.code == "Y0952" and "so that the tool falls" in one.message for one in found), codes(found)
    kept = line.replace("OFF", "ON").replace(" 2", " 3")
    assert "Y0952" not in codes(errors(made(tmp_path, kept, take("GRIPPER"))))


def test_a_cell_is_checked_without_its_robot(tmp_path):
    from yarclang.cell.description import Names, load_cell

    written(tmp_path, {})
    assert not load_cell(tmp_path / "cell.toml", Names(lambda _: False)).diagnostics
