"""Tests of a program's duration: all parts of yarclang report the same value."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from yarclang.certify.read.header import header_of
from yarclang.cli.display import Axes, Display
from yarclang.coordinator.describing import lasting_of, program_described
from yarclang.coordinator.messages.events import PartBegan, ProgressMade, StateChanged
from yarclang.coordinator.programs import load_program
from yarclang.lasting import Lasting, known, schedule_of
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.executed import executed
from yarclang.pipeline.inputs import Options
from yarclang.report.comparison.compared import compare
from yarclang.report.comparison.text import compared_json, totals_text
from yarclang.report.inspection.inspected import inspect_step, study
from yarclang.report.runs.text import time_text
from yarclang.robot.model import Tolerance
from yarclang.runtime.state import State
from yarclang.source import SourceFile
from yarclang.view.of_program import stage_of_program
from yarclang.view.of_text import stage_of_text

EXAMPLE = """\
INPUT DOOR M11
P0010 MOVEJ 10 0 0 0 0 0 [1.5] (deg,s)
P0020 WAIT [5] (s)
P0030 WAIT DOOR ON [20] (s)
WHEN DOOR ON
  P0040 MOVEJ 20 0 0 0 0 0 [2] (deg,s)
  P0050 WAIT [3] (s)
  P0060 MOVEJ 10 0 0 0 0 0 [2] (deg,s)
ELSE
  P0070 HOLD "look"
  P0080 MOVEJ 12 0 0 0 0 0 [1] (deg,s)
  P0090 MOVEJ 10 0 0 0 0 0 [1] (deg,s)
END
P0100 MOVEJ 0 0 0 0 0 0 [1.5] (deg,s)
"""
TAKES = "10.000 to 15.000 s and 1 to 2 waits"


# the value itself


@pytest.mark.parametrize(
    ("lasting", "words"),
    [
        (known(7.953), "7.953 s"),
        (Lasting(140.0, 140.0, 40, 40), "140.000 s and 40 waits"),
        (Lasting(1.0, 1.0, 1, 1), "1.000 s and 1 wait"),
        (Lasting(1.0, 1.0, 0, 1), "1.000 s and 0 to 1 wait"),
        (Lasting(5.0, 7.5, 0, 0), "5.000 to 7.500 s"),
        (Lasting(5.0, 5.0001, 0, 0), "5.000 s"),
    ],
)
def test_words(lasting, words):
    assert lasting.text() == words


def test_other_words_for_times():
    assert Lasting(5.0, 7.5, 0, 2).text(time_text) == "5.0 to 7.5 s and 0 to 2 waits"
    assert Lasting(50.0, 125.0).text(time_text) == "50.0 s to 2 min 05 s"
    assert Lasting(121.0, 125.0).text(time_text) == "2 min 01 s to 2 min 05 s"


def test_ways_begin_at_once_and_what_follows_begins_after_the_longer_one():
    schedule = schedule_of([1.0, "when", 2.0, "wait", "else", 5.0, "end", 1.0])
    assert schedule.lasting == Lasting(4.0, 7.0, 0, 1)
    assert schedule.places == (0.0, 1.0, 1.0, 3.0, 3.0, 3.0, 8.0, 8.0, 9.0)
    assert schedule.clocks == (0.0, 1.0, 1.0, 3.0, 1.0, 1.0, 6.0, 6.0, 7.0)


def test_a_way_without_a_second_one_may_take_no_time():
    assert schedule_of(["when", 2.0, "hold", "end"]).lasting == Lasting(0.0, 2.0, 0, 1)


def test_a_way_that_has_no_end_ends_with_the_program():
    assert schedule_of([1.0, "when", 2.0]).lasting == Lasting(1.0, 3.0)
    assert schedule_of(["else", 1.0, "end"]).lasting == known(1.0)


# all places that report it


@dataclass
class Drawn:
    """The lines of some commands, and their independently computed duration: (least time, most time, fewest
    waits, most waits).
    """

    lines: list[str]
    takes: tuple[float, float, int, int]


def both(one, other):
    return tuple(a + b for a, b in zip(one, other, strict=True))


SIMPLE = st.one_of(
    st.builds(lambda tenths: ("dwell", tenths / 10.0), st.integers(1, 40)),
    st.builds(lambda tenths: ("move", tenths / 20.0), st.integers(20, 60)),
    st.sampled_from([("wait", 0.0), ("hold", 0.0), ("set", 0.0)]),
)
TREES = st.lists(
    st.recursive(
        SIMPLE,
        lambda inner: st.tuples(
            st.just("when"),
            st.lists(inner, min_size=1, max_size=3),
            st.none() | st.lists(inner, min_size=1, max_size=3),
        ),
        max_leaves=8,
    ),
    min_size=1,
    max_size=5,
)


class Writer:
    """Writes a tree as a program whose first joint moves back and forth."""

    def __init__(self):
        self.number = 0
        self.at = 0

    def index(self):
        self.number += 10
        return f"P{self.number:04}"

    def move(self, there, seconds):
        self.at = there
        return [f"{self.index()} MOVEJ {there} 0 0 0 0 0 [{seconds}] (deg,s)"], (seconds, seconds, 0, 0)

    def drawn(self, tree):
        lines, takes = [], (0.0, 0.0, 0, 0)
        for node in tree:
            more, longer = self.node(node)
            lines, takes = lines + more, both(takes, longer)
        return lines, takes

    def node(self, node):
        match node:
            case "move", seconds:
                return self.move((self.at + 1) % 4, seconds)
            case "dwell", seconds:
                return [f"{self.index()} WAIT [{seconds}] (s)"], (seconds, seconds, 0, 0)
            case "wait", _:
                return [f"{self.index()} WAIT DOOR ON [9] (s)"], (0.0, 0.0, 1, 1)
            case "hold", _:
                return [f"{self.index()} HOLD"], (0.0, 0.0, 1, 1)
            case "set", _:
                return [f"{self.index()} SET GLUE ON"], (0.0, 0.0, 0, 0)
            case "when", first, second:
                return self.when(first, second)
        raise AssertionError(node)

    def when(self, first, second):
        stood, lines, takes = self.at, ["WHEN DOOR ON"], []
        for word, way in ((None, first), ("ELSE", second)):
            if way is None:
                takes.append((0.0, 0.0, 0, 0))
                continue
            lines += [word] if word else []
            self.at = stood
            more, longer = self.drawn(way)
            if self.at != stood:
                back, time = self.move(stood, 1.0)
                more, longer = more + back, both(longer, time)
            lines += more
            takes.append(longer)
        one, other = takes
        picked = (
            min(one[0], other[0]),
            max(one[1], other[1]),
            min(one[2], other[2]),
            max(one[3], other[3]),
        )
        return [*lines, "END"], picked


def check_everywhere(text, folder, takes):
    checked = check_text(SourceFile("test.yarc", text), folder, Options(robot="INDUSTRIAL6"))
    compiled = checked.compiled
    assert compiled is not None, [one.message for one in checked.diagnostics if one.is_error]
    lasting, robot = compiled.certificate.lasting, compiled.plan.robot
    least, most, fewest, waits = takes
    # segment times are rounded to steps, so that durations differ a little
    assert (lasting.least, lasting.most) == pytest.approx((least, most), abs=5e-3)
    assert (lasting.fewest, lasting.waits) == (fewest, waits)
    words = lasting.text()

    def same(other):
        assert (other.fewest, other.waits) == (fewest, waits)
        assert (other.least, other.most) == pytest.approx((lasting.least, lasting.most), abs=1e-9)
        assert other.text() == words

    # the plan, and the inspection of its steps
    same(compiled.plan.lasting)
    studied = study(checked)
    for number in range(len(compiled.program.steps)):
        inspected = inspect_step(studied, number)
        same(inspected.total)
        assert inspected.begins <= lasting.most + 1e-9
    # the text: its header, and what it executes
    assert f"; duration {words}" in compiled.text
    assert header_of(compiled.text).header.lasting.text() == words
    does = executed(compiled.text, robot, "test.pmc").value
    same(does.lasting)
    comparison = compare(does, does, Tolerance(1e-5, 1e-5))
    assert f"{words} -> {words} (+0.000 s)" in totals_text(comparison)
    assert compared_json(comparison)["first"]["duration_s"] == pytest.approx(lasting.most)
    # the loaded program, and its description for clients
    loaded = load_program(checked.opened, "test.yarc", compiled=compiled_result(checked)).value
    same(loaded.program.lasting)
    described = program_described(1, loaded)
    same(lasting_of(described.takes))
    same(lasting_of(described.rest_takes))
    assert described.duration_s == pytest.approx(lasting.most)
    ends = [one.ends_s for one in described.commands]
    assert max(ends, default=0.0) <= lasting.most + 1e-9
    for leg in loaded.program.legs:
        if leg.job is not None:
            assert leg.job.clock + leg.job.duration + leg.job.behind == pytest.approx(lasting.most)
    # the stages of the picture
    stage = stage_of_program("test.yarc", compiled.plan, compiled.certificate, ())
    other = stage_of_text(SourceFile("test.pmc", compiled.text), folder, robot).value
    assert f"{words} ·" in stage.subtitle
    assert f"{words} ·" in other.subtitle
    # these durations count all branches, one after the other
    assert stage.duration == pytest.approx(compiled.plan.duration, abs=1e-9)
    assert other.duration == pytest.approx(compiled.plan.duration, abs=1e-9)
    assert loaded.program.duration == pytest.approx(compiled.plan.duration, abs=1e-9)
    if not any(line.startswith("WHEN") for line in text.splitlines()):
        assert compiled.plan.duration == pytest.approx(lasting.most, abs=1e-9)
    begins = [one.begins for one in loaded.program.commands]
    assert begins == pytest.approx(compiled.plan.begins.tolist(), abs=1e-9)
    assert [one.begins for one in other.pieces if one.moves] == pytest.approx(begins, abs=1e-9)
    assert [one.begins for one in stage.pieces if one.moves] == pytest.approx(begins, abs=1e-9)


def compiled_result(checked):
    from yarclang.diagnostics import Result

    return Result(checked.compiled, checked.diagnostics)


def test_the_example(tmp_path):
    check_everywhere(EXAMPLE, tmp_path, (10.0, 15.0, 1, 2))


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=True)
@given(tree=TREES)
def test_every_room_says_the_same_of_any_program(tree, tmp_path_factory):
    lines, takes = Writer().drawn(tree)
    text = "\n".join(["INPUT DOOR M11", "OUTPUT GLUE M1 OFF", *lines, ""])
    check_everywhere(text, tmp_path_factory.getbasetemp(), takes)


def test_every_command_says_the_same(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("test.yarc").write_text(f"ROBOT INDUSTRIAL6\nSTART HOME\n{EXAMPLE}")
    assert f"test.yarc: {TAKES}, certified" in said("yarcc", "test.yarc")
    assert f"; duration {TAKES}, segments of" in Path("test.pmc").read_text()
    assert f"{TAKES} -> {TAKES} (+0.000 s)" in said("diff", "test.yarc", "test.pmc")
    assert f"13.500 to 15.000 s of {TAKES}" in said("inspect", "test.yarc", "P0100")
    assert f"1.500 to 6.500 s of {TAKES}" in said("inspect", "test.yarc", "P0020")
    # P0030 waits, and the time at which it ends is unknown
    assert f"6.500 s of {TAKES}" in said("inspect", "test.yarc", "P0030")
    told = json.loads(said("yarcc", "test.yarc", "--format", "json"))
    takes = {"duration_s": 15.0, "duration_at_least_s": 10.0, "waits": 2, "waits_at_least": 1, "loops": False}
    assert {key: told["files"][0]["certificate"][key] for key in takes} == pytest.approx(takes)
    told = json.loads(said("diff", "test.yarc", "test.pmc", "--format", "json"))
    assert {key: told["first"][key] for key in takes} == pytest.approx(takes)
    told = json.loads(said("inspect", "test.yarc", "P0020", "--format", "json"))
    assert told["command"]["program_takes"] == pytest.approx(takes)
    assert f"test.yarc: {TAKES} drawn to" in said("plot", "test.yarc", "-o", "test.png")


def shown(loaded, compiled):
    """Return the lines of `yarc run` and of the prompt about a program that is executed along one of its
    branches.
    """
    described = program_described(1, loaded)
    said: list[str] = []
    screen = SimpleNamespace(live=False, say=lambda text, below="": said.append(text))
    names = compiled.plan.robot.joint_names
    display = Display(screen, SimpleNamespace(override=100.0), Axes(names), described)
    display.take(StateChanged(time_s=0.0, state=State.MOVE, why=""))
    return display, said


def test_a_run_says_the_same(tmp_path):
    checked = check_text(SourceFile("test.yarc", EXAMPLE), tmp_path, Options(robot="INDUSTRIAL6"))
    loaded = load_program(checked.opened, "test.yarc", compiled=compiled_result(checked)).value
    display, said = shown(loaded, checked.compiled)
    takes = "10.0 to 15.0 s and 1 to 2 waits"
    for title, line, done in (
        ("P0010 MOVEJ", 2, 0.5),
        ("P0040 MOVEJ", 6, 7.0),
        ("P0100 MOVEJ", 14, 14.0),
    ):
        display.take(ProgressMade(time_s=done, done_s=done, left_s=15.0 - done, command=title, line=line))
    assert said[-3:] == [
        f"P0010 MOVEJ  0.0 s to 1.5 s of {takes}",
        f"P0040 MOVEJ  6.5 s to 8.5 s of {takes}",
        f"P0100 MOVEJ  13.5 s to 15.0 s of {takes}",
    ]
    view = display._view
    assert view.line == f"P0100 MOVEJ  14.0 s of {takes}, 1.0 s left"


def test_a_run_of_many_commands_tells_them_seldom(monkeypatch, tmp_path):
    text = "DEFAULT {TCP} [0.5] (deg,s) {B}\n" + "".join(
        f"P{10 * number:04} MOVEJ {number % 2} 0 0 0 0 0\n" for number in range(1, 301)
    )
    checked = check_text(SourceFile("test.yarc", text), tmp_path, Options(robot="INDUSTRIAL6"))
    assert checked.compiled is not None, checked.diagnostics
    loaded = load_program(checked.opened, "test.yarc", compiled=compiled_result(checked)).value
    now = [100.0]
    monkeypatch.setattr("yarclang.cli.display.time", SimpleNamespace(monotonic=lambda: now[0]))
    display, said = shown(loaded, checked.compiled)
    whole = loaded.plan.duration
    display.take(
        PartBegan(
            time_s=0.0,
            name="test.yarc",
            to_the_start=False,
            offset_s=0.0,
            duration_s=whole,
            number=1,
            of=1,
        )
    )
    first = len(said)
    for tick in range(101):
        done = tick / 100 * whole
        now[0] += 0.05
        display.take(ProgressMade(time_s=done, done_s=done, left_s=whole - done, command="x", line=1))
    told = said[first:]
    assert 5 <= len(told) <= 8
    assert told[0].startswith("P0010 MOVEJ")
    assert "P3000 MOVEJ" in told[-1]
    assert sum(int(line.split(", ")[1].split()[0]) for line in told if " commands " in line) >= 296


def test_a_way_out_names_no_command_of_the_program(tmp_path):
    checked = check_text(SourceFile("test.yarc", EXAMPLE), tmp_path, Options(robot="INDUSTRIAL6"))
    loaded = load_program(checked.opened, "test.yarc", compiled=compiled_result(checked)).value
    display, said = shown(loaded, checked.compiled)
    for number, name in enumerate(("back to the start of the motion", "LEAVE"), 1):
        first = len(said)
        display.take(
            PartBegan(
                time_s=20.0,
                name=name,
                to_the_start=False,
                offset_s=0.0,
                duration_s=3.0,
                number=number,
                of=2,
                leads_out=True,
            )
        )
        for done in (0.5, 1.7, 2.9):
            display.take(
                ProgressMade(time_s=20 + done, done_s=done, left_s=3.0 - done, command="LEAVE>P1", line=1)
            )
        assert said[first:] == [name]


def said(*words):
    from yarclang.cli.yarc import main as yarc
    from yarclang.cli.yarcc import main as yarcc

    command = yarcc if words[0] == "yarcc" else yarc
    result = CliRunner().invoke(command, words[1:] if words[0] == "yarcc" else words)
    return result.output


def test_a_header_that_counts_waits_wrong_is_refused(tmp_path):

    (tmp_path / "test.yarc").write_text(f"ROBOT INDUSTRIAL6\nSTART HOME\n{EXAMPLE}")
    checked = check_text(SourceFile("test.yarc", (tmp_path / "test.yarc").read_text()), tmp_path, Options())
    from yarclang.pipeline.stages import proved

    compiled, request = checked.compiled, checked.opened.request
    for wrong in (
        "10.000 to 15.000 s and 2 waits",
        "10.000 to 15.000 s",
        "15.000 s and 1 to 2 waits",
        "10.000 to 14.000 s and 1 to 2 waits",
    ):
        text = re.sub(r"; duration .*?(?=, segments)", f"; duration {wrong}", compiled.text)
        found = proved(text, compiled.plan, request).diagnostics
        assert [one.code for one in found if one.is_error] == ["Y1153"]
        assert f"it takes {TAKES}" in found[0].message
    assert not [one for one in proved(compiled.text, compiled.plan, request).diagnostics if one.is_error]
