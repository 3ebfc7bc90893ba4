"""Tests of a cell's parts in the picture: each is shown at its place, for as long as it exists."""

import json
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from floors import exercises
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from report.runs.made_up_runs import whole
from view.stages import EXAMPLES

import yarclang
from yarclang.handling.walk import handling_of
from yarclang.hir import Motion, When
from yarclang.pipeline.executed import executed
from yarclang.pipeline.inputs import Options
from yarclang.pipeline.jobs import job_of_compiled
from yarclang.report.carried import begins_in_text, carried_in_plan, end_of
from yarclang.report.clearance import touching
from yarclang.report.comparison.compared import compare
from yarclang.report.comparison.text import compared_json, compared_lines
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics.fk import flange_poses
from yarclang.source import SourceFile
from yarclang.view.figures import key_html
from yarclang.view.of_run import stage_of_run
from yarclang.view.of_text import stage_of_text
from yarclang.view.opening import program_stage
from yarclang.view.show import values_of
from yarclang.view.stage import moved_by
from yarclang.view.switches import Parts, Switches

HEAD = """ROBOT INDUSTRIAL6
USE PICKPLACE
CELL "05_pick_and_place.toml"
DEFAULT {GRIPPER} [50%] (mm,deg,s) {B}
START READY
"""
PICK = "CALL PICKPLACE.PICK {GRIPPER} {FEEDER} 120 GRIP 1"
PLACE = "CALL PICKPLACE.PLACE {GRIPPER} {PRESS} 120 GRIP 1.2"
PUT_BACK = "CALL PICKPLACE.PLACE {GRIPPER} {FEEDER} 120 GRIP 1"
CHOICE = f"""{HEAD}P0010 {PICK}
WHEN PART_READY ON
  P0030 {PLACE}
  P0035 MOVEJ READY
ELSE
  P0040 MOVEJ READY
END
P0060 MOVEJ 20 -10 -20 0 -60 0
"""
"""A program after whose WHEN the first blank is in the press or in the gripper."""
ROBOT = load_robot("INDUSTRIAL6").value


@cache
def compiled_of(text):
    made = yarclang.compile(text, name="made.yarc", folder=EXAMPLES)
    assert made.value is not None, made.diagnostics
    return made.value


@cache
def shown(text):
    result = program_stage(SourceFile("made.yarc", text), EXAMPLES, Options())
    assert result.value is not None, result.diagnostics
    return result.value


def example(name):
    return (EXAMPLES / f"{name}.yarc").read_text()


def at(stage, time):
    """Return the items of the parts that are shown at a time."""
    return [item for item in stage.items if item.kind == "part" and item.begins <= time < item.ends]


def placed(stage, item, time):
    """Return the pose of a body in {B} at a time (4, 4)."""
    q = stage.track.at(np.array([time]))[0][0]
    return moved_by(stage.robot.chain, q)[item.joint] @ item.base_from_item


def piece(stage, word, fact=None):
    return next(
        one for one in stage.pieces if word in one.title and (fact is None or fact in dict(one.facts))
    )


def test_a_part_goes_with_the_flange_from_the_set_until_it_is_put_down():
    stage = shown(example("05_pick_and_place"))
    taken, put, removed = (
        next(one for one in stage.pieces if dict(one.facts).get(verb) == "BLANK 1")
        for verb in ("takes", "puts down", "removes")
    )
    cell = stage.cell
    feeder = cell.frames["FEEDER"].mount.transform
    press = cell.frames["PRESS"].mount.transform

    def first(time):
        return [item for item in at(stage, time) if item.name == "BLANK 1"]

    (lies,) = first(taken.begins - 1e-6)
    assert lies.base_from_item == pytest.approx(feeder)
    (held,) = first(taken.begins)
    assert held.joint == stage.robot.size
    assert placed(stage, held, taken.begins)[:3, 3] == pytest.approx(feeder[:3, 3], abs=1e-6)
    middle = (taken.begins + put.begins) / 2.0
    assert first(middle) == [held]
    assert np.linalg.norm(placed(stage, held, middle)[:3, 3] - feeder[:3, 3]) > 0.1
    (down,) = first(put.begins)
    assert down.joint == 0
    assert down.base_from_item[:3, 3] == pytest.approx(press[:3, 3], abs=1e-6)
    assert first(removed.begins) == []
    # the next blank appears when the gripper has left
    names = {item.name for item in at(stage, taken.begins + 0.5)}
    assert names == {"BLANK 1"}
    assert {item.name for item in at(stage, middle)} == {"BLANK 1", "BLANK 2"}


def test_distances_are_those_of_the_parts_where_they_are():
    stage = shown(example("05_pick_and_place"))
    for one in stage.pieces:
        if not one.moves:
            continue
        facts = dict(one.facts)
        scene = stage.scene_at((one.begins + one.ends) / 2.0)
        carried = {body.name for body in scene.bodies if body.is_part and not body.of_cell}
        assert carried == set(filter(None, [facts.get("carries")]))
        for share in (0.0, 0.3, 0.6, 0.999):
            time = one.begins + share * (one.ends - one.begins)
            assert touching(stage.scene_at(time), stage.track.at(np.array([time]))[0][0]) == frozenset()
    assert values_of(stage, "clearance").min() >= 0.0
    assert "parts" in key_html(stage)


def test_what_is_said_is_what_was_proved():
    compiled = compiled_of(example("05_pick_and_place"))
    carried = carried_in_plan(compiled.plan)
    assert {one.step: one.carries for one in compiled.certificate.commands} == dict(carried.names)
    rows = compiled.certificate.to_json()["commands"]
    assert [tuple(row["carries"]) for row in rows] == [one.carries for one in compiled.certificate.commands]


def test_a_supply_fills_the_pallet():
    stage = shown(example("06_palletising"))
    assert [item.name for item in at(stage, 0.0)] == ["BOX 1"]
    end = at(stage, stage.duration)
    assert sorted(item.name for item in end) == sorted(f"BOX {number}" for number in range(1, 25))
    assert len({tuple(item.base_from_item[:3, 3].round(3)) for item in end}) == 24
    # the names of many parts in one place would cover the picture
    assert not any(item.is_named for item in end)


def test_after_a_when_a_part_is_half_transparent_at_each_place():
    stage = shown(CHOICE)
    label = next(one for one in stage.pieces if one.label == "P0060")
    items = [item for item in at(stage, (label.begins + label.ends) / 2.0) if item.name == "BLANK 1"]
    assert sorted(item.joint for item in items) == [0, 6]
    assert all(item.opacity < 0.9 for item in items)
    other = next(one for one in stage.pieces if one.label == "P0040")
    (held,) = [item for item in at(stage, (other.begins + other.ends) / 2.0) if item.name == "BLANK 1"]
    assert (held.joint, held.opacity) == (6, 1.0)


def test_a_controller_text_has_the_parts_of_its_program(tmp_path):
    text = example("05_pick_and_place")
    compiled = yarclang.compile(text, name="05_pick_and_place.yarc", folder=EXAMPLES).value
    stage = stage_of_text(SourceFile("a.pmc", compiled.text), EXAMPLES, ROBOT).value
    plan = shown(text)
    parts, planned = ([item for item in one.items if item.kind == "part"] for one in (stage, plan))
    assert [item.name for item in parts] == [item.name for item in planned]
    for one, other in zip(parts, planned, strict=True):
        assert (one.begins, one.ends) == pytest.approx((other.begins, other.ends), abs=1e-6)
        assert one.base_from_item == pytest.approx(other.base_from_item, abs=1e-5)
    facts = [fact for one in stage.pieces for fact in one.facts]
    assert ("takes", "BLANK 1") in facts
    assert ("carries", "BLANK 3") in facts
    # without the program, the picture of a text has no parts
    cell = str(EXAMPLES / "05_pick_and_place.toml")
    alone = stage_of_text(SourceFile("a.pmc", compiled.text), tmp_path, ROBOT, cell).value
    assert not any(item.kind == "part" for item in alone.items)
    assert any("parts aren't shown" in note for note in alone.notes)


def recorded(tmp_path, text, **execution):
    (tmp_path / "05_pick_and_place.toml").write_text((EXAMPLES / "05_pick_and_place.toml").read_text())
    (tmp_path / "made.yarc").write_text(text)
    compiled = compiled_of(text)
    job = job_of_compiled(compiled, "made.yarc")
    path, seen = whole(tmp_path / "a.mcap", job, compiled.plan, **execution)
    return compiled, stage_of_run(str(path), None).value, seen


def test_a_run_shows_the_parts_when_they_were_moved(tmp_path):
    """The run takes twice the planned time, and shows each part at the time when it was moved."""
    text = f"{HEAD}P0010 {PICK}\nP0020 {PLACE}\n"
    compiled, stage, _ = recorded(
        tmp_path, text, rate=lambda t: np.full_like(t, 0.5), length=2.0 * compiled_of(text).plan.duration
    )
    plan = shown(text)
    assert not any("parts" in note for note in stage.notes)
    for one, other in zip(
        [item for item in stage.items if item.name == "BLANK 1"],
        [item for item in plan.items if item.name == "BLANK 1"],
        strict=True,
    ):
        assert one.base_from_item == pytest.approx(other.base_from_item, abs=1e-5)
        for mine, planned in ((one.begins, other.begins), (one.ends, other.ends)):
            if np.isfinite(planned):
                assert mine - 0.1 == pytest.approx(2.0 * planned, abs=0.25)
    assert ("carries", "BLANK 1") in [fact for one in stage.pieces for fact in one.facts]
    assert compiled.plan.duration < stage.duration


@pytest.mark.parametrize("takes_first", [True, False])
def test_a_run_shows_the_way_of_a_when_that_was_taken(tmp_path, takes_first):
    plan = compiled_of(CHOICE).plan
    when = next(number for number, one in enumerate(plan.program.steps) if isinstance(one, When))
    places = plan.schedule.places
    pieces = {one.label: one for one in shown(CHOICE).pieces}
    middle = pieces["P0040"].begins
    left_out = (middle, pieces["P0060"].begins) if takes_first else (places[when], middle)
    length = plan.duration - (left_out[1] - left_out[0])
    _, stage, _ = recorded(tmp_path, CHOICE, left_out=left_out, length=length)
    items = [item for item in at(stage, stage.duration) if item.name == "BLANK 1"]
    assert [(item.joint, item.opacity) for item in items] == [(0 if takes_first else 6, 1.0)]


def test_diff_tells_what_is_carried():
    def does(text):
        made = compiled_of(text)
        carried = {one.step: one.carries for one in made.certificate.commands}
        return executed(made.text, ROBOT, "made.yarc", carried)

    first = does(f"{HEAD}P0010 {PICK}\nP0020 {PLACE}\n").value
    second = does(f"{HEAD}P0015 {PICK}\nP0020 {PLACE}\n").value
    assert compare(first, second, ROBOT.tolerance).equal
    empty = replace(
        second, acts=tuple(replace(act, carries=() if act.curve else None) for act in second.acts)
    )
    comparison = compare(first, empty, ROBOT.tolerance)
    assert not comparison.equal
    lines = [line for sign, line in compared_lines(comparison) if sign == "~"]
    assert len(lines) == sum(bool(act.carries) for act in first.acts)
    assert all("carries BLANK 1 -> nothing" in line for line in lines)
    rows = compared_json(comparison)["commands"]
    assert {tuple(row["first"]["carries"]) for row in rows if row["other_parts"]} == {("BLANK 1",)}
    json.dumps(rows, allow_nan=False)
    # without its program, a text doesn't show which parts are carried
    bare = replace(second, acts=tuple(replace(act, carries=None) for act in second.acts))
    assert compare(first, bare, ROBOT.tolerance).equal


class Node:
    def __init__(self):
        self.visible, self.changes = False, 0

    def __setattr__(self, name, value):
        object.__setattr__(self, name, value)
        if name == "visible" and hasattr(self, "changes"):
            self.changes += 1


def test_nodes_hear_of_changes_only_and_stay_hidden_with_their_group():
    stage = shown(example("05_pick_and_place"))
    items = [item for item in stage.items if item.kind == "part"]
    switches = Switches()
    parts, nodes = Parts(switches), [Node() for _ in items]
    for item, node in zip(items, nodes, strict=True):
        parts.give(item, node, "part")
    for time in np.linspace(0.0, stage.duration, 400):
        parts.move_to(time)
        assert [node.visible for node in nodes] == [item in at(stage, time) for item in items]
    assert max(node.changes for node in nodes) <= 2
    switches.switch("part", False)
    parts.look()
    parts.move_to(1.0)
    assert not any(node.visible for node in nodes)
    switches.switch("part", True)
    parts.look()
    assert [node.visible for node in nodes] == [item in at(stage, 1.0) for item in items]


def walked(text):
    """Return the times of each motion, and the parts during it as the handling code has them."""
    plan = compiled_of(text).plan
    handling = handling_of(plan.robot, plan.program.cell, plan.program.steps)
    stand, q, ways = handling.first(), plan.program.start, []
    motions = {one.step: one for one in plan.motions}
    for number, step in enumerate(plan.program.steps):
        if isinstance(step, Motion):
            stand = handling.before_motion(stand, number)
            places = plan.schedule.places
            yield places[number], places[number + 1], stand.parts
            q = end_of(motions[number].curve)
            continue
        name = type(step).__name__
        if name == "When":
            ways.append(q)
        elif name == "Else":
            q = ways[-1]
        elif name == "EndWhen":
            ways.pop()
        stand, _ = handling.passed(stand, number, q)


DEEDS = ("pick", "place", "back", "when place", "go")


@cache
def random_program(deeds):
    lines, holds, placed_ = [], False, False
    for deed in deeds:
        label = f"P{10 * (len(lines) + 1):04}"
        if deed == "go":
            lines.append(f"{label} MOVEJ READY")
        elif deed == "pick" and not holds:
            lines.append(f"{label} {PICK}")
            holds = True
        elif deed == "place" and holds and not placed_:
            lines.append(f"{label} {PLACE}")
            holds, placed_ = False, True
        elif deed == "back" and holds:
            lines.append(f"{label} {PUT_BACK}")
            holds = False
        elif deed == "when place" and holds and not placed_:
            ready = f"{label[:-1]}2 MOVEJ READY"
            lines += ["WHEN PART_READY ON", f"{label[:-1]}1 {PLACE}", ready]
            lines += ["ELSE", f"{label[:-1]}3 MOVEJ READY", "END"]
            break  # the next command could collide with a part that may be there
    lines.append(f"P{10 * (len(lines) + 1):04} MOVEJ READY")
    return HEAD + "\n".join(lines) + "\n"


@exercises(held=0.2, unsure=0.05)
@settings(max_examples=25, deadline=None)
@given(deeds=st.lists(st.sampled_from(DEEDS), max_size=4).map(tuple), share=st.floats(0.01, 0.99))
def test_each_part_is_shown_where_handling_has_it(tally, deeds, share):
    """At any time, each part is shown once; after a WHEN, it is shown at all places where it may be."""
    text = random_program(("pick", *deeds))
    made = yarclang.compile(text, name="made.yarc", folder=EXAMPLES)
    assume(made.value is not None)
    stage = shown(text)
    unsure = held = False
    for begins, ends, parts in walked(text):
        time = begins + share * (ends - begins)
        items = at(stage, time)
        assert sorted(item.name for item in items) == sorted(one.name for one in parts.items)
        flange = flange_poses(stage.robot.chain, stage.track.at(np.array([time]))[0])[0]
        left = list(items)
        for one in parts.items:
            wanted = flange @ one.transform if one.gripper is not None else one.transform
            found = next(
                item
                for item in left
                if item.name == one.name
                and (item.joint > 0) == (one.gripper is not None)
                and np.allclose(placed(stage, item, time), wanted, atol=1e-9)
            )
            assert (found.opacity >= 1.0) == one.is_sure
            left.remove(found)
            unsure |= not one.is_sure
            held |= one.gripper is not None
        assert left == []
    tally.count("held", held)
    tally.count("unsure", unsure)


def test_the_times_of_a_text_are_those_of_its_plan():
    compiled = compiled_of(CHOICE)
    steps = len(compiled.program.steps)
    begins = begins_in_text(executed(compiled.text, ROBOT, "made.yarc").value, steps)
    assert begins == pytest.approx(compiled.plan.schedule.places[:steps], abs=1e-9)
