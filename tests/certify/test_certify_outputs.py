"""Tests of outputs that are set in the middle of a blend. Anywhere else during a motion, they are refused."""

from dataclasses import replace

import pytest

from tests.certify.certify_bench import Job, emit, industrial6, origin, program
from tests.certify.test_certify_blends import Q0, codes, joint_chain, judge
from yarclang import hir
from yarclang.certify import certify
from yarclang.certify.certifying import certify_text
from yarclang.certify.pmac.read import read
from yarclang.certify.read.text import ControllerText, Unreadable
from yarclang.robot.model import Tolerance

GLUE, LAMP = hir.Signal("GLUE", "M1"), hir.Signal("LAMP", "M2")


def with_sets(at=0, lines=("M1==1",), sets=((GLUE, 1.0),), behind=0):
    """Return the chain of joint motions with SETs after its first command. `lines` are before move line `at`
    of the second command.
    """
    _, jobs = joint_chain()
    steps = [
        Job(hir.SetOutput(origin(behind + 1 + k, "SET"), signal, value), None)
        for k, (signal, value) in enumerate(sets)
    ]
    made = [*jobs[: behind + 1], *steps, *jobs[behind + 1 :]]
    place = behind + 1 + len(steps)
    if at < 0:
        place, at = behind, at + len(jobs[behind].points)
    made[place] = replace(made[place], puts=lines, put_at=at)
    return [
        replace(job, motion=replace(job.motion, origin=origin(k, job.motion.origin.name)))
        for k, job in enumerate(made)
    ]


def test_read():
    text = read(emit(industrial6(), Q0, with_sets()), industrial6().controller)
    assert isinstance(text, ControllerText)
    (put,) = text.runs[0].puts
    assert (put.variable, put.value, put.synchronous) == ("M1", 1.0, True)
    assert put.line + 1 == text.entries[2].first
    assert [entry.blend for entry in text.entries] == [12, None, 8, None]


@pytest.mark.parametrize("at", [-3, -2, -1, 0, 1, 2, 3])
def test_in_the_middle(at):
    result = judge(industrial6(), Q0, with_sets(at))
    if abs(at) <= 1:
        assert codes(result) == []
    else:
        assert set(codes(result)) == {"Y1165"}
        side = "after" if at > 0 else "before"
        assert f"{abs(at)} segments {side} the middle of the blend" in result.diagnostics[0].message
    # A SET at a wrong place is also refused without the program.
    source = program(Q0, with_sets()).source
    found = certify_text(emit(industrial6(), Q0, with_sets(at)), industrial6(), source)
    assert codes(found) == (["Y1193"] if abs(at) <= 1 else ["Y1165"])


def test_more_than_one():
    both = ((GLUE, 1.0), (LAMP, 0.0))
    assert codes(judge(industrial6(), Q0, with_sets(0, ("M1==1", "M2==0"), both))) == []
    for lines in (
        ("M2==0", "M1==1"),
        ("M1==1",),
        ("M1==1", "M2==1"),
        ("M1==1", "M2==0", "M1==0"),
    ):
        assert codes(judge(industrial6(), Q0, with_sets(0, lines, both))) == ["Y1165"]
    # A SET of a variable that isn't an output of the program is refused.
    other = codes(judge(industrial6(), Q0, with_sets(0, ("M3==1", "M2==0"), both)))
    assert other == ["Y1191", "Y1165"]
    # Setting the output at the other blend is accepted if the program does so.
    moved = with_sets(0, ("M1==1",), ((GLUE, 1.0),), behind=1)
    assert codes(judge(industrial6(), Q0, moved)) == []
    text = emit(industrial6(), Q0, moved)
    steps = [job.motion for job in with_sets()]
    steps = [replace(step, origin=job.motion.origin) for step, job in zip(steps, moved, strict=True)]
    swapped = [steps[0], steps[2], steps[1], steps[3]]
    swapped = [replace(s, origin=job.motion.origin) for s, job in zip(swapped, moved, strict=True)]
    assert (
        codes(
            certify(
                text,
                replace(program(Q0, moved), steps=tuple(swapped)),
                industrial6(),
                Tolerance(),
            )
        )
        == []
    )
    # A text without the program's SET is refused.
    assert codes(judge(industrial6(), Q0, with_sets(0, ()))) == ["Y1165"]


def test_where_nothing_is_blended():
    _, jobs = joint_chain()
    made = [*jobs]
    made[1] = replace(jobs[1], puts=("M1==1",), put_at=20)
    assert set(codes(judge(industrial6(), Q0, made))) == {"Y1165", "Y1191"}


@pytest.mark.parametrize(
    "line", ["M1==1\nM2=0", "M1=1", "M1==", "M1==1 ", "P1==1", "M1==1X", "M1==1e3", "m1==1", "M12345==1"]
)
def test_other_lines_are_refused(line):
    text = emit(industrial6(), Q0, with_sets()).replace("M1==1", line)
    assert isinstance(read(text, industrial6().controller), Unreadable)
