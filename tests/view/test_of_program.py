"""Tests of the stage of a program: bodies, frames, path, commands, and findings at their places."""

import numpy as np
import pytest
from view.stages import CRASH, EXAMPLES, stage_of

from yarclang.pipeline.inputs import Options
from yarclang.report.clearance import SEEN, near, touching
from yarclang.robot.kinematics.fk import tool_poses
from yarclang.source import SourceFile
from yarclang.view.opening import opened, program_stage
from yarclang.view.show import ramps_of, values_of
from yarclang.view.stage import moved_by


def test_the_path_is_that_of_the_frame():
    stage = stage_of(CRASH)
    way = stage.way
    assert stage.frame == "GRIPPER"
    assert len(way.times) == len(way.points) == len(way.speed)
    q, _ = stage.track.at(way.times)
    assert way.points == pytest.approx(
        tool_poses(stage.robot.chain, q, stage.flange_from_frame)[:, :3, 3], abs=1e-9
    )
    # each part of the path begins and ends at rest, where its command begins and ends
    for at, piece in enumerate(way.piece.tolist()):
        rows = slice(way.breaks[at], way.breaks[at + 1])
        assert way.times[rows][[0, -1]] == pytest.approx(
            [stage.pieces[piece].begins, stage.pieces[piece].ends]
        )
        assert way.speed[rows][[0, -1]] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_the_speed_is_the_way_over_time():
    way = stage_of(CRASH).way
    rows = slice(way.breaks[1], way.breaks[2])
    gone = np.linalg.norm(np.diff(way.points[rows], axis=0), axis=1).sum()
    speeds, times = way.speed[rows], way.times[rows]
    assert float(np.sum((speeds[1:] + speeds[:-1]) / 2.0 * np.diff(times))) == pytest.approx(gone, rel=1e-3)


def test_commands_stand_in_order_with_their_figures():
    pieces = stage_of(CRASH).pieces
    assert [piece.label for piece in pieces] == ["P0010", "P0020", "P0030", "P0040", "P0050"]
    assert [piece.moves for piece in pieces] == [True, True, True, False, True]
    assert pieces[3].begins == pieces[2].ends
    assert pieces[3].ends == pieces[4].begins == pieces[3].begins + 1.0
    assert dict(pieces[3].facts) == {"stands for": "1 s"}
    assert dict(pieces[1].facts)["duration"] == "2.000 s"
    assert pieces[1].line == 7


def test_which_command_is_it():
    stage = stage_of(CRASH)
    first, second, third, wait, last = stage.pieces
    assert stage.piece_at(0.0) == 0
    assert stage.piece_at((second.begins + second.ends) / 2.0) == 1
    assert stage.piece_at(wait.begins) == 2  # where two commands meet, the one that moves is selected
    assert stage.piece_at((wait.begins + wait.ends) / 2.0) == 3
    assert stage.piece_at(wait.ends) == 4
    assert stage.piece_at(last.ends) == 4
    assert stage.piece_at(-1.0) == -1
    assert first.begins < third.begins


def test_a_collision_stands_where_it_is_worst():
    stage = stage_of(CRASH)
    mark = next(one for one in stage.marks if one.code == "Y0901")
    piece = stage.pieces[mark.piece]
    assert piece.label == "P0030"
    # the clearance is smallest at the end, because the motion goes straight down
    assert mark.time == pytest.approx(piece.ends)
    assert mark.place == pytest.approx(
        stage.way.points[np.argmin(np.abs(stage.way.times - mark.time))], abs=1e-6
    )
    q = stage.track.at(np.array([mark.time]))[0][0]
    assert touching(stage.scene, q) == {"FINGERS", "BENCH"}
    assert touching(stage.scene, stage.robot.home) == frozenset()


def test_bodies_frames_and_zones_are_there():
    stage = stage_of(CRASH)
    assert {(item.name, item.kind) for item in stage.items} >= {
        ("BENCH", "obstacle"),
        ("FINGERS", "tool"),
        ("FLOOR", "zone"),
        ("AT_FIXTURE", "zone"),
    }
    # each link of the URDF is moved by the joints between it and the base
    assert {item.name for item in stage.items if item.kind == "robot"} >= {
        one.link for one in stage.robot.shapes
    }
    joints = {item.name: item.joint for item in stage.items}
    assert (joints["base_link"], joints["link_3"], joints["FINGERS"]) == (0, 3, 6)
    names = {one.name: one for one in stage.axes}
    assert {"B", "FLANGE", "TCP", "FIXTURE", "LEFT", "RIGHT", "GRIPPER", "PART"} <= set(names)
    assert names["PART"].base_from_frame[:3, 3] == pytest.approx([0.0, 0.62, 0.66])
    assert (names["PART"].joint, names["GRIPPER"].joint) == (0, 6)


def test_what_joints_move_is_where_the_kinematics_has_it():
    stage = stage_of(CRASH)
    q = np.array([0.3, -0.4, 0.5, 1.0, -0.7, 2.0])
    placed = moved_by(stage.robot.chain, q)[-1] @ stage.robot.chain.base_from_flange
    assert placed == pytest.approx(tool_poses(stage.robot.chain, q[None], np.eye(4))[0], abs=1e-12)


def test_the_samples_of_clearance_agree_with_the_certificate():
    text = CRASH.replace("-260", "-100")
    stage = stage_of(text)
    assert not any(mark.severity == "error" for mark in stage.marks)
    for at, number in enumerate(stage.way.piece.tolist()):
        piece = stage.pieces[number]
        told = dict(piece.facts)["clearance to the cell"]
        proved = float(told.split()[2])
        rows = slice(stage.way.breaks[at], stage.way.breaks[at + 1])
        found = near(stage.scene, stage.track.at(stage.way.times[rows])[0])
        cell = found.apart[stage.scene.pairs.of_cell[found.pair] & (found.pair >= 0)]
        # the drawn clearance is never below the proved one
        assert cell.min(initial=SEEN) * 1e3 >= proved - 0.1


def test_a_program_with_errors_is_shown_as_far_as_it_is_planned():
    stage = stage_of(CRASH.replace("-200 0 -260", "-200 4000 -260"))
    unplanned = [piece.label for piece in stage.pieces if not piece.planned]
    assert unplanned[0] == "P0030"
    assert stage.pieces[1].planned
    mark = next(one for one in stage.marks if one.severity == "error")
    assert (mark.code, stage.pieces[mark.piece].label) == ("Y0501", "P0030")
    # the mark is at the place where the motion would begin
    assert mark.place == pytest.approx(stage.way.points[stage.way.breaks[2] - 1], abs=1e-6)
    assert "can't be planned" in stage.notes[0]


def test_a_program_in_which_nothing_can_be_planned():
    stage = stage_of("P0010 MOVEL {TCP} 0 9000 0 0 0 0 [2] (mm,deg,s) {B}\n", "INDUSTRIAL6")
    assert stage.duration == 0.0
    assert len(stage.way.points) == 1
    assert ramps_of(stage) == {}
    assert [mark.severity for mark in stage.marks] == ["error"]
    assert stage.marks[0].place is not None


def test_a_command_that_is_not_understood_has_no_place():
    stage = stage_of(
        "P0010 MOVEJ 400 0 0 0 0 0 [2] (deg,s)\nP0020 MOVEJ 40 0 0 0 0 0 [2] (deg,s)\n", "INDUSTRIAL6"
    )
    assert [(mark.code, mark.place) for mark in stage.marks] == [("Y0502", None)]
    assert [piece.label for piece in stage.pieces] == ["P0020"]


def test_the_path_by_clearance():
    stage = stage_of(CRASH)
    values = values_of(stage, "clearance")
    assert values.shape == stage.way.times.shape
    # overlaps would be negative; they have no colour of their own, and are shown as 0
    assert values.min() == 0.0
    assert 10.0 < values[0] <= SEEN * 1e3


@pytest.mark.parametrize("name", sorted(path.name for path in EXAMPLES.glob("*.yarc")))
def test_every_example_can_be_seen(name):
    robot = None if "ROBOT" in (EXAMPLES / name).read_text() else "INDUSTRIAL6"
    made = opened(str(EXAMPLES / name), Options(robot=robot), None)
    assert made.value is not None, made.diagnostics
    stage = made.value
    assert stage.items
    assert stage.pieces
    assert np.isfinite(stage.way.points).all()
    assert all(0.0 <= piece.begins <= piece.ends <= stage.duration + 1e-9 for piece in stage.pieces)


def test_without_a_robot_there_is_nothing_to_show():
    made = program_stage(SourceFile("made.yarc", "P0010 MOVEJ 0\n"), EXAMPLES.parent / "docs", Options())
    assert made.value is None
    assert [one.code for one in made.diagnostics] == ["Y1391"]


def test_collisions_are_shown_beside_errors_of_planning():
    """Errors of planning don't hide collisions, and don't change their places."""
    whole = next(one for one in stage_of(CRASH).marks if one.code == "Y0901")
    far = "P0035 MOVEL 9000 0 0 0 0 0\n"
    stage = stage_of(CRASH.replace("P0040", f"{far}P0040"))
    errors = [one for one in stage.marks if one.severity == "error"]
    assert [(one.code, stage.pieces[one.piece].label) for one in errors] == [
        ("Y0901", "P0030"),
        ("Y0501", "P0035"),
    ]
    shown = errors[0]
    assert (shown.text, shown.time) == (whole.text, whole.time)
    assert np.allclose(shown.place, whole.place)


def test_a_gap_in_the_plan_is_no_motion():
    """After a motion that can't be planned, the robot is shown at its goal.

    The unplanned motion itself has no collisions.
    """
    text = CRASH.replace("P0030 MOVEL -200 0 -260", "P0030 MOVEL 9000 0 -260").replace(
        "P0050 MOVEL -200 0 150 0 0 0 [5] {PART}", "P0050 MOVEJ READY\nP0060 MOVEJ 170 0 0 0 0 0 [20] (deg,s)"
    )
    stage = stage_of(text)
    assert [one.code for one in stage.marks if one.severity == "error"] == ["Y0501"]


def test_a_broken_zone_is_shown_beside_errors_of_planning(tmp_path):
    (tmp_path / "cell.toml").write_text(
        'units = "mm,deg,s"\n[[zones]]\nname = "WALL"\nrule = "forbidden"\nshape = "half-space"\n'
        'frame = "B"\n'
        "xyz = [700, 0, 0]\nnormal = [1, 0, 0]\n"
    )
    text = (
        'ROBOT INDUSTRIAL6\nCELL "cell.toml"\nDEFAULT {TCP} [MIN] (mm,deg,s) {B}\n'
        "P0010 MOVEJ -90 0 0 0 0 0\nP0020 MOVEL 9000 0 0 0 0 0\n"
    )
    result = program_stage(SourceFile("made.yarc", text), tmp_path, Options())
    assert [one.code for one in result.diagnostics] == ["Y0908", "Y0501"]
    assert [one.code for one in result.value.marks] == ["Y0908", "Y0501"]


def test_a_finding_in_a_module_stands_at_the_module_s_motion():
    stage = stage_of(
        "ROBOT INDUSTRIAL6\n"
        "USE PICKPLACE\n"
        "OUTPUT GRIP M1\n"
        "FRAME {BOX} 300 900 1000 0 0 0 (mm,deg) {B}\n"
        "P0010 MOVEJ 5 0 0 0 -30 0 [MIN] (deg,s)\n"
        "P0020 CALL PICKPLACE.PICK {TCP} {BOX} 100 (mm) GRIP 0.02 (s)\n"
    )
    marks = [one for one in stage.marks if one.code == "Y0601"]
    assert len(marks) == 2
    labels = [stage.pieces[one.piece].label for one in marks]
    assert labels == ["P0020>P0010>P0030", "P0020>P0040>P0040"]


def test_a_long_program_lists_its_worst_places_and_errors_first():
    text = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [60%] (mm,deg,s) {B}\nFRAME {NOBODY} 0 0 0 0 0 0 {B}\n"
    motions = "".join(f"P{n:04} MOVEJ {n % 7 * 3} 0 0 0 0 0\n" for n in range(10, 80))
    stage = stage_of(text + motions)
    assert not stage_of(CRASH).worst
    assert 1 <= len(stage.worst) <= 10
    first = stage.worst[0]
    assert stage.pieces[first.piece].label in first.text
    shares = [int(one.text.partition(" %")[0]) for one in stage.worst if " % " in one.text]
    assert shares == sorted(shares, reverse=True)
    # reading the facts of a command twice gives the same
    facts = stage.pieces[first.piece].facts
    assert list(facts) == list(facts) != []
    assert all(stage.piece_at((one.begins + one.ends) / 2.0) == n for n, one in enumerate(stage.pieces))
    wrong = stage_of(text + motions + "P0090 MOVEL 9000 0 0 0 0 0\n")
    assert [mark.severity for mark in wrong.marks] == sorted(
        (mark.severity for mark in wrong.marks), key=["error", "warning", "note"].index
    )
    assert {mark.severity for mark in wrong.marks} >= {"error", "note"}
    error = wrong.marks[0]
    assert wrong.pieces[error.piece].label == "P0090"
    # the mark is at the place where the motion would begin
    assert error.place == pytest.approx(wrong.way.points[-1], abs=1e-6)
