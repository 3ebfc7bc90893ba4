"""Tests of ALLOW, and of [[allow]] in a cell: two bodies may touch during a motion, while all other pairs are
proved.
"""

from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from handling import carrying
from handling.carrying import made
from hypothesis import given, settings
from hypothesis import strategies as st
from programs import compiled

from tests.certify.forging import Forger
from tests.floors import exercises
from yarclang.certify.certifying import certify
from yarclang.collision.scene import allowed_name, scene_of
from yarclang.diagnostics import Result
from yarclang.handling.parts import first_parts
from yarclang.handling.surroundings import surroundings
from yarclang.memory import Recent
from yarclang.pipeline.cells import cell_loader
from yarclang.pipeline.proofs import proof_of
from yarclang.pipeline.replanning import replanned
from yarclang.pipeline.stages import Request
from yarclang.robot.description import load_robot
from yarclang.verify.verdict import verify

OVER = "P0010 MOVEJ_RPY 0 0 120 0 0 0 {FEEDER}\n"
DOWN = "P0020 MOVEL_RPY 0 0 {depth} 0 0 0 [2] {{FEEDER}}{more}\n"
UP = "P0030 MOVEL_RPY 0 0 120 0 0 0 [2] {{FEEDER}}{more}\n"
INTO_TRACK = -35
"""Height of the gripper [mm] at which its fingers are 5 mm deep in the track."""
LEADS = '[[allow]]\nbodies = ["fingers", "TRACK"]\nleads_to = "FEEDER"\n'
LEAVES = '[[allow]]\nbodies = ["TRACK", "FINGERS"]\nleaves = "FEEDER"\n'


def down(depth=INTO_TRACK, more="", up=""):
    return OVER + DOWN.format(depth=depth, more=more) + UP.format(more=up)


@pytest.fixture
def run(tmp_path):
    """Return a function that compiles a program in the cell, with the box at {PUT}."""
    robot = load_robot("INDUSTRIAL6").value

    def one(program, more="", head=carrying.HEAD, **request):
        text = carrying.CELL.format(**carrying.GIVEN)
        text = text.replace('shape = "box"\nframe = "FEEDER"\nsize', 'shape = "box"\nframe = "PUT"\nsize')
        (tmp_path / "cell.toml").write_text(text + more)
        return Result(*compiled(head + program, load_cell=cell_loader(tmp_path, robot), **request))

    return one


def codes(found):
    return [one.code for one in found.diagnostics if one.severity != "note"]


def pairs_of(found):
    """Return the pairs that aren't checked, by the index of the command."""
    return {
        one.index: [(may.first, may.second, may.giver, may.needed) for may in one.may_touch]
        for one in found.value.certificate.commands
        if one.may_touch
    }


def test_bodies_may_touch_where_the_line_says_so(run):
    allow = " ALLOW FINGERS TRACK"
    assert codes(run(down())) == ["Y0901", "Y0901"]
    # on the way up the two bodies still touch, which the line of this ALLOW doesn't cover
    assert codes(run(down(more=allow))) == ["Y0901"]
    found = run(down(more=allow, up=" ALLOW track fingers"))
    assert codes(found) == []
    assert pairs_of(found) == {
        "P0020": [("FINGERS", "TRACK", "line 5", True)],
        "P0030": [("FINGERS", "TRACK", "line 6", True)],
    }
    assert "2 pairs of bodies may touch, unchecked" in found.value.text
    assert "; allow 1 FINGERS TRACK\n; allow 2 FINGERS TRACK\n" in found.value.text


def test_every_other_pair_is_still_proved(run):
    """The wrist enters the track as well, which is still refused.

    The certificate has the distance of all other pairs.
    """
    found = run(down(-35, " ALLOW FINGERS TRACK", " ALLOW FINGERS TRACK"))
    clearance = {one.index: one.clearance for one in found.value.certificate.commands}
    assert clearance["P0020"].distance > 0.0
    deep = run(down(-260, " ALLOW FINGERS TRACK", " ALLOW FINGERS TRACK"))
    assert codes(deep) == ["Y0901", "Y0901"]
    assert all(
        "TRACK" in one.message and "FINGERS penetrates" not in one.message
        for one in deep.diagnostics
        if one.is_error
    )


def test_a_frame_of_the_cell_allows_it(run):
    # the upward motion is allowed, too, because it leads to a pose in {FEEDER}
    assert codes(run(down(), LEADS)) == []
    away = OVER + DOWN.format(depth=INTO_TRACK, more="") + "P0030 MOVEJ READY\n"
    assert codes(run(away, LEADS)) == ["Y0901"]
    both = run(away, LEADS + LEAVES)
    assert codes(both) == []
    text = LEADS + LEAVES
    line = (len(both.value.plan.program.cell.source.text.splitlines()) - len(text.splitlines())) + 1
    assert pairs_of(both) == {
        "P0010": [("FINGERS", "TRACK", f"line {line} of the cell.toml", False)],
        "P0020": [("FINGERS", "TRACK", f"line {line} of the cell.toml", True)],
        "P0030": [("FINGERS", "TRACK", f"line {line + 3} of the cell.toml", True)],
    }


@pytest.mark.parametrize(
    "program",
    [
        # the same pose in another frame
        "P0010 MOVEJ_RPY 300 850 770 0 0 0 {B}\nP0020 MOVEL_RPY 300 850 615 0 0 0 [2] {B}\n",
        # a frame of the program in the same place
        "FRAME {MINE} 300 850 650 0 0 0 (mm,deg) {B}\n" + down().replace("{FEEDER}", "{MINE}"),
    ],
)
def test_another_frame_allows_nothing(run, program):
    assert "Y0901" in codes(run(program, LEADS))


def test_a_frame_that_is_handed_over_counts(run):
    program = "SUB GO {F}\nP0005 MOVEL_RPY 0 0 -35 0 0 0 [2] {F}\nEND\n" + OVER + "P0030 CALL GO {FEEDER}\n"
    assert codes(run(program)) == ["Y0901"]
    assert codes(run(program, LEADS)) == []


def test_what_is_left_must_be_left_on_all_ways(run):
    """One branch of a WHEN doesn't come from the frame, so after the WHEN nothing may touch."""
    ways = OVER + "WHEN GOOD ON\n" + DOWN.format(depth=120, more="") + "ELSE\nP0025 MOVEJ READY\n"
    ways += "P0026 MOVEJ_RPY 300 850 770 0 0 0 {B}\nEND\nP0040 MOVEL_RPY 300 850 615 0 0 0 [2] {B}\n"
    assert codes(run(ways, LEAVES)).count("Y0901") == 1
    one_way = OVER + "P0040 MOVEL_RPY 300 850 615 0 0 0 [2] {B}\n"
    assert codes(run(one_way, LEAVES)) == []


def test_a_child_of_the_frame_counts(run):
    more = '[frames.CORNER]\nparent = "FEEDER"\nxyz = [10, 0, 0]\n'
    program = OVER + "P0020 MOVEL_RPY -10 0 -35 0 0 0 [2] {CORNER}\n"
    assert codes(run(program, more)) == ["Y0901"]
    assert codes(run(program, more + LEADS)) == []


@pytest.mark.parametrize(
    ("allow", "code", "told"),
    [
        (" ALLOW FINGRS TRACK", "Y0217", "did you mean FINGERS?"),
        (" ALLOW FINGERS", "Y0412", "two bodies"),
        (" ALLOW", "Y0412", "two bodies"),
        (" ALLOW 5", "Y0412", "two bodies"),
        (" ALLOW FINGERS TRACK ALLOW TRACK FINGERS", "Y0412", "twice"),
        (" ALLOW TRACK TRACK", "Y0412", "can't touch itself"),
        (" ALLOW BOX BOX", "Y0412", "can't touch itself"),
        (" ALLOW FINGERS TRACK TABLE", "Y0101", "TABLE"),
    ],
)
def test_what_is_refused(run, allow, code, told):
    found = [one for one in run(OVER + DOWN.format(depth=0, more=allow)).diagnostics if one.is_error]
    assert [one.code for one in found] == [code]
    assert told in f"{found[0].message} {found[0].help}"


@pytest.mark.parametrize(
    ("entry", "code", "told"),
    [
        ('bodies = ["FINGRS", "TRACK"]\nleads_to = "FEEDER"', "Y1377", "FINGERS"),
        ('bodies = ["FINGERS", "TRACK"]', "Y1379", "leads_to"),
        ('bodies = ["FINGERS", "TRACK"]\nleads_to = "B"', "Y1379", "every robot"),
        ('bodies = ["FINGERS", "TRACK"]\nleaves = "FEDER"', "Y1329", "FEEDER"),
        ('bodies = ["FINGERS"]\nleads_to = "FEEDER"', "Y1308", "two bodies"),
        ('bodies = ["TRACK", "track"]\nleads_to = "FEEDER"', "Y1308", "can't touch itself"),
        ('leads_to = "FEEDER"', "Y1304", "bodies"),
    ],
)
def test_what_is_refused_in_the_cell(run, entry, code, told):
    found = [one for one in run(down(120), f"[[allow]]\n{entry}\n").diagnostics if one.is_error]
    assert [one.code for one in found] == [code]
    assert told in f"{found[0].message} {found[0].help}"


def test_a_robot_that_hits_itself_is_told():
    """A collision of the robot with itself is reported without a cell, and allowed pairs are listed."""
    value, found = compiled("P0010 MOVEJ 0 -20 -94 0 0 0 [9] (deg,s) ALLOW LINK_2 LINK_5\n")
    assert [(one.code, one.is_error) for one in found] == [("Y0935", False)]
    assert "the robot hits itself" in found[0].message
    assert [may.pair for one in value.certificate.commands for may in one.may_touch] == ["LINK_2 and LINK_5"]


FORGED = {
    "another body": ("; allow 1 FINGERS TRACK", "; allow 1 FINGERS TABLE"),
    "one more": ("; allow 1 FINGERS TRACK", "; allow 1 FINGERS TABLE\n; allow 1 FINGERS TRACK"),
    "another command": ("; allow 1 FINGERS TRACK", "; allow 0 FINGERS TRACK"),
    "none": ("; allow 2 FINGERS TRACK\n", ""),
    "twice": ("; allow 2 FINGERS TRACK", "; allow 2 FINGERS TRACK\n; allow 2 FINGERS TRACK"),
    "out of order": ("; allow 2 FINGERS TRACK", "; allow 2 TRACK FINGERS"),
    "an escape": ("; allow 2 FINGERS TRACK", "; allow 2 FINGERS %54RACK"),
    "no command": ("; allow 2 FINGERS TRACK", "; allow 7 FINGERS TRACK"),
    "a third": ("; allow 2 FINGERS TRACK", "; allow 2 FINGERS TRACK TABLE"),
}


@pytest.mark.parametrize("how", FORGED)
def test_a_forged_map_is_refused(run, how):
    found = run(down(more=" ALLOW FINGERS TRACK", up=" ALLOW FINGERS TRACK")).value
    was, becomes = FORGED[how]
    assert was in found.text
    forger = Forger.of(found.text)
    place = forger.find("; allow .*", 1 if "2" in was else 0)
    forger = forger.drop(place)
    lines = becomes.rstrip("\n").split("\n") if becomes else ()
    forger = forger.put(place, *lines)
    plan = found.plan
    told = certify(forger.text, plan.program, plan.robot, plan.robot.tolerance).diagnostics
    assert any(one.is_error for one in told)
    same = certify(found.text, plan.program, plan.robot, plan.robot.tolerance).diagnostics
    assert not any(one.is_error for one in same)


def test_a_text_is_no_proof_of_a_program_without_its_allowances(run):
    """The motions are the same, but a text with allowed pairs isn't one of a program without them."""
    free, bound = run(down(120, " ALLOW FINGERS TRACK")).value, run(down(120)).value
    for text, other in ((free.text, bound), (bound.text, free)):
        plan = other.plan
        told = certify(text, plan.program, plan.robot, plan.robot.tolerance).diagnostics
        assert any(one.is_error and "FINGERS and TRACK" in one.message for one in told)


def test_parts_of_a_kind_may_touch_each_other(tmp_path):
    """Parts are named by their kind, which stands for all parts of this kind."""
    found = made(tmp_path, OVER.replace("\n", " ALLOW BOX BOX ALLOW BOX TABLE\n"), count=2)
    assert [one.code for one in found.diagnostics if one.is_error] == []
    cell = next(iter(found.value.plan.program.steps)).allowed
    assert [(one.first, one.second) for one in cell] == [("BOX", "BOX"), ("BOX", "TABLE")]


def test_the_small_checker_lists_what_it_does_not_check(run):
    found = run(down(more=" ALLOW FINGERS TRACK", up=" ALLOW FINGERS TRACK")).value
    verdict = verify(found.text.encode(), proof_of(found).value.encode())
    assert verdict.refused == ""
    assert [one for one in verdict.unchecked if "FINGERS" in one] == []
    assert verdict.exempt == [
        "FINGERS and TRACK during commands 1, 2 of the map: the program lets them touch"
    ]


@cache
def around():
    """Return a robot, and its cell with obstacles and parts."""
    with TemporaryDirectory() as folder:
        found = made(Path(folder), "P0010 MOVEJ READY\n", count=2)
    return found.value.plan.robot, found.value.plan.program.cell


@exercises(dropped=0.3)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_exactly_the_allowed_pairs_are_left_out(tally, data):
    """For any allowed pairs, the checked and the unchecked pairs together are all pairs, each once."""
    robot, cell = around()
    parts = first_parts(cell)
    whole = scene_of(robot, surroundings(cell, parts)).value
    named = sorted(
        {
            allowed_name(whole.bodies, pair)
            for pair in zip(whole.pairs.first.tolist(), whole.pairs.second.tolist(), strict=True)
        }
    )
    chosen = frozenset(data.draw(st.sets(st.sampled_from(named), max_size=6)))
    scene = scene_of(robot, surroundings(cell, parts, (), chosen)).value

    def rows(pairs):
        if pairs is None:
            return []
        return list(zip(pairs.first.tolist(), pairs.second.tolist(), pairs.margin.tolist(), strict=True))

    assert sorted(rows(scene.pairs) + rows(scene.allowed)) == sorted(rows(whole.pairs))
    assert {allowed_name(scene.bodies, pair[:2]) for pair in rows(scene.allowed)} == chosen
    assert not {allowed_name(scene.bodies, pair[:2]) for pair in rows(scene.pairs)} & chosen
    tally.count("dropped", bool(chosen))


@pytest.mark.parametrize("up", [" ALLOW FINGERS TRACK", ""])
@pytest.mark.parametrize("leaves", [LEAVES, ""])
def test_what_follows_a_search_may_touch_where_its_line_says_so(run, up, leaves):
    """The motion after a search is planned from the place where the search ended.

    Here the fingers are in the track at that place.
    """
    program = OVER + DOWN.format(depth=INTO_TRACK, more=" UNTIL GOOD ALLOW FINGERS TRACK")
    program += UP.format(more=up).replace("{FEEDER}", "{B}").replace("0 0 120 0 0 0", "300 850 770 0 0 0")
    found = run(program, leaves)
    assert bool(up or leaves) == (
        found.value is not None and not any(one.is_error for one in found.diagnostics)
    )
    if found.value is None or not (up or leaves):
        return
    plan = found.value.plan
    rests = plan.motions[1].curve.points[-1]
    answer = replanned(plan, 1, rests, Request(plan.robot))
    assert answer.jobs, answer
    assert "; allow 0 FINGERS TRACK\n" in answer.jobs[0].text


def test_in_a_corner_each_line_counts_for_its_half(run):
    """If only one of the lines at a blended corner may touch, the other half of the corner is refused."""
    corner = OVER + "P0020 MOVEL_RPY 0 0 -45 0 0 0 [4] {FEEDER} BLEND 5%s\n"
    corner += "P0030 MOVEL_RPY 60 0 -45 0 0 0 [4] {FEEDER}%s\nP0040 MOVEJ READY\n"
    allow = " ALLOW FINGERS TRACK"
    assert "Y0901" in codes(run(corner % (allow, "")))
    assert "Y0901" in codes(run(corner % ("", allow)))


def test_in_a_loop_it_holds_in_every_pass(run):
    program = OVER + "LOOP\n" + DOWN.format(depth=INTO_TRACK, more=" ALLOW FINGERS TRACK")
    program += UP.format(more=" ALLOW FINGERS TRACK") + "UNTIL GOOD ON\n"
    assert codes(run(program)) == []
    # only the first pass comes from the frame
    left = OVER + (
        "LOOP\n"
        "P0020 MOVEL_RPY 300 850 615 0 0 0 [2] {B}\n"
        "P0030 MOVEJ_RPY 300 850 770 0 0 0 {B}\n"
        "UNTIL GOOD ON\n"
    )
    assert "Y0901" in codes(run(left, LEAVES))


def test_what_was_proved_before_is_proved_for_these_pairs_alone(tmp_path):
    """A proof that an editor remembers for a motion with ALLOW isn't used for the motion without it.

    If lines move, their findings are reported at the new lines.
    """
    (tmp_path / "cell.toml").write_text(
        carrying.CELL.format(**carrying.GIVEN).replace('"FEEDER"\nsize', '"PUT"\nsize')
    )
    load, memory = cell_loader(tmp_path, load_robot("INDUSTRIAL6").value), Recent(1000)

    def look(program):
        return Result(*compiled(carrying.HEAD + program, load_cell=load, memory=memory))

    allow = " ALLOW FINGERS TRACK"
    for _ in range(2):
        assert codes(look(down(more=allow, up=allow))) == []
        assert codes(look(down(up=allow))) == ["Y0901"]
    moved = look("! a line more\n" + down(more=allow, up=allow))
    assert [one.giver for row in moved.value.certificate.commands for one in row.may_touch] == [
        "line 6",
        "line 7",
    ]
    again = look(down(more=allow, up=allow))
    assert [one.giver for row in again.value.certificate.commands for one in row.may_touch] == [
        "line 5",
        "line 6",
    ]


def test_all_pairs_may_touch():
    """If all pairs may touch, none is checked, and all are listed."""
    scene = scene_of(load_robot("INDUSTRIAL6").value, None).value
    pairs = sorted(
        {
            allowed_name(scene.bodies, pair)
            for pair in zip(scene.pairs.first.tolist(), scene.pairs.second.tolist(), strict=True)
        }
    )
    allow = " ".join(f"ALLOW {first} {second}" for first, second in pairs)
    value, found = compiled(f"P0010 MOVEJ 10 0 0 0 0 0 [5] (deg,s) {allow}\n")
    assert not any(one.is_error for one in found), found
    (row,) = value.certificate.commands
    assert [(may.first, may.second) for may in row.may_touch] == pairs
    assert row.own_clearance is None
    assert not any(may.needed for may in row.may_touch)
