"""Tests of analysing an edited program: the result equals that of a new analysis, to the last bit."""

import gc
import os
import shutil
import weakref

import numpy as np
import pytest
from floors import exercises
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from yarclang.memory import Recent, recall
from yarclang.pipeline.checking import check_text
from yarclang.pipeline.incremental import Analyst
from yarclang.pipeline.inputs import Options
from yarclang.robot.library import stdlib_folder
from yarclang.source import SourceFile

OPENING = (
    "ROBOT INDUSTRIAL6",
    "USE SHIFTS",
    'CELL "cell.toml"',
    "OUTPUT LAMP M1 OFF",
    "INPUT DOOR M11",
    "DEFAULT {TCP} [50%] (mm,deg,s) {B}",
    "FRAME {TABLE} 0 1100 1100 0 0 0",
    "JOINTS PARK 0 -10 -40 0 50 0",
    "LET STEP = 20 (mm)",
    "SUB DRILL DEPTH (mm)",
    "  P0005 DMOVE 0 0 $DEPTH 0 0 0",
    "  P0006 DMOVE 0 0 $(-DEPTH) 0 0 0",
    "END",
    "P0007 MOVEJ 0 -6.2 -46.5 0 52.7 0 [MIN]",
)
CELL = """units = "mm,deg,s"
[[obstacles]]
name = "POST"
shape = "box"
frame = "B"
xyz = [900, -700, 0]
size = [100, 100, {height}]
[[zones]]
name = "SLOW"
rule = "slow"
speed = 150
shape = "half-space"
frame = "B"
normal = [0, 0, 1]
xyz = [0, 0, 1150]
"""
MODULE = "SUB AWAY D (mm)\n  P0010 DMOVE {TCP} 0 0 $D 0 0 0 [1] (mm,deg,s) {B}\nEND\n"

number = st.integers(-30, 30)
time = st.sampled_from(["", "", "[2]", "[3.3]", "[MIN]"])
profile = st.sampled_from(["", "_LSPB", "_POLY5", "_SCURVE"])
blend = st.sampled_from(["", "", "BLEND 3"])
commands = st.one_of(
    st.builds(
        "MOVEJ{} {} -6 {} 0 52 {} {} {}".format, profile, number, st.integers(-60, -30), number, time, blend
    ),
    st.builds(
        "MOVEJ_RPY{} {} 1150 {} 0 0 0 {} {}".format, profile, number, st.integers(1100, 1200), time, blend
    ),
    st.builds("MOVEL{} {} {} {} 0 0 0 {} {{TABLE}}{}".format, profile, number, number, number, time, blend),
    st.builds("MOVEC {0} 1160 1150 0 0 0; {1} 1130 1170 0 0 0 {2}".format, number, number, time),
    st.builds("MOVEL_SPLINE {0} 1150 1150 0 0 0; {1} 1130 1170 0 0 0 {2}".format, number, number, time),
    st.builds("MOVEJ_SPLINE PARK; {} 0 -40 0 50 0 {}".format, number, time),
    st.builds("DMOVE 0 0 {} 0 0 {} {{TCP}} {}".format, number, number, blend),
    st.builds("DMOVEJ {} 0 0 0 0 0".format, number),
    st.builds("CALL DRILL {}".format, number),
    st.builds("CALL SHIFTS.AWAY {}".format, number),
    st.sampled_from(["SET LAMP ON", "WAIT [1]", "HOLD", "MOVEJ PARK", "MOVEL 0 1200 1100 0 0 0 [V 50]"]),
)
blocks = st.one_of(
    st.builds("REPEAT I {}\n  P0700 DMOVE 0 $(I*STEP/10) 3 0 0 0\nEND".format, st.integers(0, 3)),
    st.just("WHEN DOOR ON\n  P0710 HOLD\nELSE\n  P0720 WAIT [1]\nEND"),
    st.builds("IF STEP > {}\n  P0730 MOVEJ PARK\nEND".format, number),
    st.just("! a remark"),
    st.builds("LET STEP = {} (mm)".format, number),
    st.builds("FRAME {{TABLE}} 0 {} 1100 0 0 0".format, st.integers(1080, 1120)),
    st.just("DEFAULT {TCP} [40%] (mm,deg,s) {B}"),
)
wrong = st.sampled_from(
    [
        "MOVEJ NOWHERE",
        "MOVEL 1 2 3",
        "MOVEL 5000 0 0 0 0 0",
        "MOVEJ PARK [0.05]",
        "MOVEJ PARK BLEND 400",
        "MOVEJ (",
        "STOP",
        "WAIT [2",
    ]
)
lines = st.integers(0, 40).flatmap(
    lambda chance: wrong if chance == 7 else blocks if chance > 34 else commands
)
edits = st.tuples(
    st.sampled_from(["put", "put", "insert", "take", "swap", "default", "frame"]), st.integers(0, 40), lines
)


def text_of(body, opening):
    """Return a program whose commands have indices in ascending order."""
    rows = list(opening)
    for place, line in enumerate(body, 1):
        is_command = line[:1].isalpha() and line.split()[0] not in (
            "REPEAT",
            "WHEN",
            "IF",
            "LET",
            "FRAME",
            "DEFAULT",
            "P0",
        )
        rows.append(f"P{place * 10:04} {line}" if is_command else line)
    return "\n".join([*rows, ""])


def edited(body, opening, edit):
    """Return the body and the opening lines of a program after one edit."""
    kind, place, line = edit
    body, opening = list(body), list(opening)
    place %= max(1, len(body))
    match kind:
        case "put" if body:
            body[place] = line
        case "take" if body:
            del body[place]
        case "swap" if body:
            body[place], body[0] = body[0], body[place]
        case "default":
            opening[5] = "DEFAULT {TCP} [45%] (mm,deg,s) {B}"
        case "frame":
            opening[6] = f"FRAME {{TABLE}} 0 {1090 + place} 1100 0 0 0"
        case _:
            body.insert(place, line)
    return body, opening


def assert_same(analysis, checked):
    """Check that an analysis that uses remembered results equals one from scratch."""
    assert analysis.diagnostics == checked.diagnostics
    assert (analysis.plan is None) == (checked.plan is None)
    if checked.plan is not None:
        assert len(analysis.plan.motions) == len(checked.plan.motions)
        for one, other in zip(analysis.plan.motions, checked.plan.motions, strict=True):
            assert one.step == other.step
            assert one.curve.segment == other.curve.segment
            assert np.array_equal(one.curve.points, other.curve.points)
            assert np.array_equal(one.law, other.law)
    assert (analysis.certificate is None) == (checked.compiled is None)
    if checked.compiled is not None:
        for one, other in zip(
            analysis.certificate.commands, checked.compiled.certificate.commands, strict=True
        ):
            assert repr(one) == repr(other)
        assert analysis.checked.compiled.text == checked.compiled.text


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Return a folder with a module and a cell."""
    folder = tmp_path_factory.mktemp("edited")
    (folder / "shifts.yarc").write_text(MODULE)
    (folder / "cell.toml").write_text(CELL.format(height=500))
    return folder


# the programs are the same each time; YARCLANG_RANDOM_EDITS=1000 draws that many others, for a night
@exercises(planned=0.3, certified=0.2, remembered=0.2)
@settings(
    max_examples=int(os.environ.get("YARCLANG_RANDOM_EDITS", "8")),
    derandomize="YARCLANG_RANDOM_EDITS" not in os.environ,
    deadline=None,
    suppress_health_check=list(HealthCheck),
)
@given(body=st.lists(lines, min_size=1, max_size=5), sequence=st.lists(edits, min_size=1, max_size=4))
def test_after_any_edits_it_is_as_if_looked_at_afresh(tally, folder, body, sequence):
    analyst, opening, before = Analyst(), OPENING, ()
    for edit in [None, *sequence]:
        if edit is not None:
            body, opening = edited(body, opening, edit)
        source = SourceFile(str(folder / "a.yarc"), text_of(body, opening))
        quick = analyst.analyse(source, folder, quick=True)
        assert quick.diagnostics == check_text(source, folder, Options(), plans=False).diagnostics
        afresh = check_text(source, folder, Options())
        assert_same(analyst.analyse(source, folder, begun=quick.checked), afresh)
        analysis = analyst.analyse(source, folder)
        assert_same(analysis, afresh)
        tally.count("planned", afresh.plan is not None)
        tally.count("certified", afresh.compiled is not None)
        curves = [motion.curve for motion in analysis.plan.motions] if analysis.plan is not None else []
        if edit is not None:
            tally.count("remembered", any(one is other for one in curves for other in before))
        before = curves


PROGRAM = "\n".join(
    [*OPENING, "P0010 MOVEL 0 1150 1150 0 0 0", "P0020 CALL SHIFTS.AWAY 20", "P0030 MOVEJ PARK", ""]
)


def test_what_a_program_uses_may_change(folder, tmp_path):
    """A module, a cell and a robot are read again if their files have changed, and only then."""
    shutil.copytree(stdlib_folder() / "robots" / "industrial6", tmp_path / "arm")
    (tmp_path / "shifts.yarc").write_text(MODULE)
    (tmp_path / "cell.toml").write_text(CELL.format(height=500))
    source = SourceFile(str(tmp_path / "a.yarc"), PROGRAM.replace("ROBOT INDUSTRIAL6\n", ""))
    options = Options(robot=str(tmp_path / "arm"))
    analyst = Analyst(options)
    first = analyst.analyse(source, tmp_path)
    again = analyst.analyse(source, tmp_path)
    assert again.checked.opened.request.robot is first.checked.opened.request.robot
    assert again.program.cell is first.program.cell
    assert all(
        one.curve is other.curve for one, other in zip(first.plan.motions, again.plan.motions, strict=True)
    )
    changes = {
        "shifts.yarc": (MODULE, MODULE.replace("[1]", "[2]")),
        "cell.toml": (CELL.format(height=500), CELL.format(height=4100)),
        "arm/robot.toml": ("jerk", "jerk "),
    }
    for name, (old, new) in changes.items():
        path = tmp_path / name
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new))
        os.utime(path, ns=(1, 1))
        assert_same(analyst.analyse(source, tmp_path), check_text(source, tmp_path, options))


def test_work_that_nobody_waits_for_is_given_up(folder):
    """A cancelled analysis keeps the results that it had until then."""
    analyst, asked = Analyst(), []

    def after_some():
        asked.append(None)
        return len(asked) > 4

    source = SourceFile(str(folder / "a.yarc"), PROGRAM)
    assert analyst.analyse(source, folder, cancelled=after_some) is None
    assert len(asked) == 5
    assert len(analyst.memory) > 0
    whole = analyst.analyse(source, folder, cancelled=lambda: False)
    assert whole.diagnostics == check_text(source, folder, Options()).diagnostics
    number = whole.steps_by_line[PROGRAM.split("\n").index("P0030 MOVEJ PARK") + 1]
    assert [whole.program.steps[one].origin.index for one in number] == ["P0030"]
    assert whole.motions[number[0]].step == whole.proofs[number[0]].step == number[0]


def test_an_edit_costs_the_motion_and_the_one_behind_it(folder):
    """An edit of one line changes only its own curve and the next one: the joint positions at a line's end
    don't depend on rounding at its start.
    """
    head = "ROBOT INDUSTRIAL6\nDEFAULT {TCP} [50%] (mm,deg,s) {B}\nP0001 MOVEJ 0 -10 -20 0 -60 0\n"
    lines = [f"P{n:04} MOVEL {n % 10 * 20} 1000 {1050 + n % 7 * 10} -90 0 {n % 3}" for n in range(2, 40)]
    analyst, before = Analyst(), None
    for edited_line in (None, *range(5, 35, 4)):
        if edited_line is not None:
            lines[edited_line] = lines[edited_line][:-1] + str((int(lines[edited_line][-1]) + 1) % 3)
        source = SourceFile(str(folder / "lines.yarc"), head + "\n".join(lines))
        motions = analyst.analyse(source, folder).plan.motions
        if before is not None:
            others = [
                k
                for k, (one, other) in enumerate(zip(motions, before, strict=True))
                if one.curve is not other.curve
            ]
            # motion 0 is P0001, so that lines[k] is motion k + 1
            assert others == [edited_line + 1, edited_line + 2]
        before = motions


def test_the_memory_is_bounded():
    """The entry that wasn't used for longest is dropped first."""
    memory = Recent(3)
    for key in (1, 2, 3, 1, 4):
        recall(memory, key, lambda key=key: key)
    assert [memory.get(key) for key in (1, 2, 3, 4)] == [1, None, 3, 4]
    assert len(memory) == 3


def test_edits_leave_no_texts_behind(folder):
    """No remembered result keeps an earlier text of the program alive."""
    analyst, gone = Analyst(), []
    for edit in range(6):
        source = SourceFile(str(folder / "a.yarc"), f"{PROGRAM}! version {edit}\n")
        gone.append(weakref.ref(source))
        analyst.analyse(source, folder)
    del source
    gc.collect()
    assert [one() for one in gone] == [None] * 6


def test_what_is_known_before_the_proof(tmp_path):
    """The findings of planning are reported once, before the proof. A program with errors isn't proved, and
    reports nothing early.
    """
    program = (
        "DEFAULT {TCP} [5] (mm,deg,s) {B}\nP0010 MOVEJ 0 10 0 0 -30 0 [5000]\nP0020 MOVEJ 0 20 0 0 -30 0\n"
    )
    for text, times in ((program, 1), (program + "P0030 MOVEJ 0 500 0 0 0 0\n", 0), (program + "X\n", 0)):
        analyst, told = Analyst(Options(robot="INDUSTRIAL6")), []
        source = SourceFile("a.yarc", text)
        quick = analyst.analyse(source, tmp_path, quick=True)
        whole = analyst.analyse(source, tmp_path, begun=quick.checked, early=told.append)
        assert len(told) == times
        for early in told:
            assert early.compiled is None
            assert early.plan is not None
            assert "Y0611" in {one.code for one in early.diagnostics}
            assert set(early.diagnostics) <= set(whole.checked.diagnostics)
