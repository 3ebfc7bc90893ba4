"""Tests that each example compiles to exactly the bytes and the plan in tests/golden; --rewrite-golden writes
them again.
"""

import functools
import re
from pathlib import Path

import numpy as np
import pytest
from conftest import EXAMPLES, HERE

from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import compile_module

GOLDEN = HERE / "golden"
WITHOUT_ROBOT = ("01_listing4", "09_fixture_cell")
PROGRAMS = sorted(EXAMPLES.glob("*.yarc"))


def make(path, target="rotary"):
    robot = "INDUSTRIAL6" if path.stem in WITHOUT_ROBOT else None
    opened = open_program(str(path), Options(robot=robot, target=target))
    compiled = compile_module(opened.value.module, opened.value.request)
    assert not [one for one in (*opened.diagnostics, *compiled.diagnostics) if one.is_error]
    # versions of libraries are replaced: apart from the header, the text doesn't depend on them
    text = re.sub(r"; made with .*", "; made with ...", compiled.value.text)
    return re.sub(r"; yarcc \S+:", "; yarcc ...:", text), compiled.value


first = functools.cache(make)
"""The result of the first compilation of a program, which two tests need."""


def summary(compiled):
    """Return a readable summary of a plan: the segments, the end and the peaks of each motion."""
    lines = []
    robot = compiled.plan.robot
    for motion, proved in zip(compiled.plan.motions, compiled.certificate.commands, strict=True):
        origin = compiled.program.steps[motion.step].origin
        end = np.round(motion.curve.points[-1] / robot.axis_units, 4) + 0.0
        lines.append(
            f"{origin.index} {origin.name}: {motion.curve.segments} segments of "
            f"{motion.curve.segment * 1e3:.6g} ms, to {' '.join(f'{value:g}' for value in end)}; velocity "
            f"{proved.velocity.share * 100:.1f} % ({proved.velocity.name}), acceleration "
            f"{proved.acceleration.share * 100:.1f} %, jerk {proved.jerk.share * 100:.1f} %"
        )
    return "\n".join(lines) + "\n"


def compare(path, content, rewrite):
    if rewrite:
        path.parent.mkdir(exist_ok=True)
        path.write_text(content)
    # Two examples are planned at a margin at which processors with and without AVX-512 round differently.
    # Each kind of processor has its own file, `out.pmc` and `out.avx2.pmc`.
    accepted = [
        path.read_text(),
        *(one.read_text() for one in path.parent.glob(f"{path.stem}.avx2{path.suffix}")),
    ]
    assert content in accepted, f"{path.name} differs; --rewrite-golden writes it anew"


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_example(program, rewrite_golden):
    text, compiled = first(program)
    compare(GOLDEN / program.stem / "out.pmc", text, rewrite_golden)
    compare(GOLDEN / program.stem / "plan.txt", summary(compiled), rewrite_golden)


def test_listing4_as_a_program_buffer(rewrite_golden):
    text, _ = make(EXAMPLES / "01_listing4.yarc", "prog")
    compare(GOLDEN / "01_listing4" / "out.prog.pmc", text, rewrite_golden)


@pytest.mark.parametrize("program", PROGRAMS, ids=lambda path: path.stem)
def test_the_same_input_gives_the_same_bytes(program):
    assert first(program)[0] == make(program)[0]


def test_there_is_no_golden_without_its_example():
    assert {folder.name for folder in GOLDEN.iterdir()} == {program.stem for program in PROGRAMS}


def test_layout_and_comments_do_not_change_the_hash(tmp_path):
    text = (EXAMPLES / "02_lines_and_deltas.yarc").read_text()
    other = re.sub(r"!.*", "", text).replace(" ", "   ").lower()
    (tmp_path / "02_lines_and_deltas.yarc").write_text(other)
    first, _ = make(EXAMPLES / "02_lines_and_deltas.yarc")
    second, _ = make(Path(tmp_path / "02_lines_and_deltas.yarc"))
    assert re.search(r"; program (\w+)", first)[1] == re.search(r"; program (\w+)", second)[1]
    assert first.split("CLOSE ALL")[1] == second.split("CLOSE ALL")[1]
