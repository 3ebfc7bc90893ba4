"""Tests of commands that are remembered from an earlier text: they mean what their present place says."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from yarclang.hir import Gap, Motion
from yarclang.identity import key_of
from yarclang.memory import Recent
from yarclang.pipeline.stages import Request, check_program
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

ROBOT = load_robot("INDUSTRIAL6").value

LINES = (
    "DEFAULT {TCP} [5] (mm,deg,s) {B}",
    "DEFAULT {TCP} [7] (cm,deg,s) {A}",
    "FRAME {A} 0 900 500 0 0 0 (mm,deg) {B}",
    "FRAME {A} 0 900 501 0 0 0 (mm,deg) {B}",
    "FRAME {C} 0 0 50 0 0 0 (mm,deg) {FLANGE}",
    "FRAME {C} 0 0 5 0 0 90 (mm,deg) {A}",
    "LET X = 30",
    "LET X = -30",
    "JOINTS PARK 0 -10 -40 0 50 0 (deg)",
    "JOINTS PARK 0 -20 -40 0 $X 0 (deg)",
    "IF 1 < 2",
    "ELSE",
    "END",
    "FUNC F(A) = A + X",
    "FUNC F(A) = A*X",
    "P0042 MOVEJ $(F(2)) 0 0 0 0 0 [V<=$(F(200))] (mm,deg,s) BLEND <=$(F(1))",
    "P0010 MOVEL 0 100 500 0 $X 0 [5] (mm,deg,s) {A}",
    "P0020 MOVEL {C} 0 100 500 0 0 0",
    "P0030 MOVEJ PARK",
    "POSE SPOT 0 100 500 0 $X 0 (mm,deg) {A}",
    "POSE SPOT 0 100 500 0 0 0 (mm,deg) {A}",
    "POSE SPOT 0 100 500 0 0 0 (mm,deg) {B}",
    "P0022 MOVEL SPOT",
    "P0024 MOVEJ SPOT [9] (s)",
    "JOINTS HOME 0 -20 -40 0 0 0 (deg)",
    "P0032 MOVEJ HOME",
    "P0034 MOVEJ HOME [9] (s)",
    "P0040 MOVEJ $X 0 0 0 0 0 [MIN] (deg)",
    "P0050 MOVEJ_RPY 0 1174.4 1176 0 0 0 {B} NEAR PARK",
)
PROGRAMS = st.lists(st.sampled_from(LINES), min_size=3, max_size=12).map("\n".join)


def checked(text, memory):
    module = parse(SourceFile("edited.yarc", text)).value
    request = Request(ROBOT) if memory is None else Request(ROBOT, memory=memory)
    return check_program(module, request)


def said(result):
    """Return the steps with their values, places and frames, and the findings."""

    def frames(link):
        return None if link is None else (link.name, link.parent_from_frame.tobytes(), frames(link.parent))

    steps = []
    for step in result.value.steps:
        if isinstance(step, Gap):
            steps.append(None)
            continue
        origin = step.origin
        links = [frames(link) for link in (origin.moving, origin.tool, origin.base)]
        steps.append((key_of(step) if isinstance(step, Motion) else step, origin, links))
    return steps, result.diagnostics


@settings(max_examples=60)
@given(st.lists(PROGRAMS, min_size=2, max_size=4))
def test_a_program_after_others_is_what_it_is_by_itself(texts):
    memory = Recent(1000)
    for text in (*texts, texts[0]):
        assert said(checked(text, memory)) == said(checked(text, None))


def in_blocks(one, other):
    block = (
        "IF 1 < 2\n"
        "FRAME {{A}} 0 900 {} 0 0 0 (mm,deg) {{B}}\n"
        "P{:04} MOVEL 0 100 500 0 0 0 [5] (mm,deg,s) {{A}}\n"
        "END"
    )
    return "\n".join(["DEFAULT {TCP}", block.format(one, 10), block.format(other, 20)])


@pytest.mark.parametrize("values", [(1, 2), (2, 1), (2, 2)])
def test_a_name_means_something_else_in_each_block(values):
    memory = Recent(1000)
    checked(in_blocks(1, 2), memory)
    checked(in_blocks(3, 3), memory)
    hits = memory.hits
    result = checked(in_blocks(*values), memory)
    assert said(result) == said(checked(in_blocks(*values), None))
    heights = [step.goal.base_from_moving[2, 3] for step in result.value.steps]
    assert heights == pytest.approx([0.5 + value / 1000 for value in values])
    assert memory.hits > hits


def test_a_name_of_the_robot_is_hidden_from_its_declaration_on():
    one, hidden, other = (
        "P0010 MOVEJ HOME [5] (s)",
        "JOINTS HOME 0 -20 -40 0 0 0 (deg)",
        "P0020 MOVEJ HOME [9] (s)",
    )
    memory = Recent(1000)
    checked(f"{one}\n{other}", memory)
    result = checked(f"{one}\n{hidden}\n{other}", memory)
    first, second = (step.goal.q for step in result.value.steps)
    assert first.tobytes() != second.tobytes()
    assert said(result) == said(checked(f"{one}\n{hidden}\n{other}", None))


def test_unchanged_commands_are_recalled_wherever_they_stand():
    memory = Recent(1000)
    commands = [f"P{number:04} MOVEJ {number} 0 0 0 0 0 [5] (deg,s)" for number in range(1, 50)]
    checked("\n".join(commands), memory)
    made = memory.misses
    moved = checked("\n".join(["! a title", *commands]), memory)
    assert memory.misses == made
    assert [step.origin.span.line for step in moved.value.steps] == list(range(2, 51))


def test_a_motion_to_a_named_pose_is_recalled_with_the_frame_of_the_pose():
    head = "DEFAULT {TCP} [5] (mm,deg,s) {B}\nFRAME {A} 0 900 500 0 0 0"
    memory = Recent(1000)
    text = f"{head}\nPOSE P1 0 100 500 0 0 0 {{A}}\nP0010 MOVEL P1"
    checked(text, memory)
    made = memory.misses
    again = checked(f"! a title\n{text}", memory)
    assert memory.misses == made
    assert again.value.steps[0].origin.base.name == "A"
    for old, new in (
        ("0 100 500", "0 101 500"),
        ("{A}\nP0010", "{B}\nP0010"),
        ("FRAME {A} 0 900", "FRAME {A} 0 901"),
    ):
        other = text.replace(old, new)
        assert other != text
        assert said(checked(other, memory)) == said(checked(other, None))
