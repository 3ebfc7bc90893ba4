"""Tests of certificates of planned texts: their figures are compared with an independent reading, and
slightly changed texts are refused.
"""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import BSpline
from scipy.spatial.transform import Rotation

import yarclang
from yarclang.certify import certify
from yarclang.independent.arm import Arm
from yarclang.pipeline.stages import claims_of

PROGRAM = """
DEFAULT {TCP} [2] (mm,deg,s) {B}
OUTPUT GLUE M1 OFF
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [MIN] BLEND 15
P0020 MOVEL 150 1174.4 1176 0 0 0 BLEND 20
P0030 SET GLUE ON
P0040 MOVEC 200 1174.4 1226; 150 1174.4 1276 0 0 10 BLEND 15
P0050 MOVEL_SPLINE 100 1150 1276 0 10 0; 50 1174.4 1300 0 0 0; 0 1200 1250 10 0 0 BLEND 10
P0070 MOVEJ 0 0 0 0 -30 0 [5] BLEND 5
P0080 MOVEJ_SPLINE 10 0 0 0 -30 0; 20 5 0 0 0 0 [4] BLEND 3
P0090 MOVEJ 0 0 0 0 0 0
"""
CORNERS = {
    1: ((150, 1174.4, 1176), (0, 0, 0)),
    3: ((150, 1174.4, 1276), (0, 0, 10)),
    4: ((0, 1200, 1250), (10, 0, 0)),
}


@cache
def compiled():
    result = yarclang.compile(PROGRAM, robot="INDUSTRIAL6")
    assert result.value is not None, result.diagnostics
    return result.value


def judged(text):
    made = compiled()
    planned = made.plan
    return certify(text, made.program, planned.robot, planned.robot.tolerance, claims_of(planned))


def codes(result):
    return [finding.code for finding in result.diagnostics]


def read(text):
    """Return the control points [deg] of the last sequence, its segment time [s], and the segments and the
    blend of each step.
    """
    lines = text.split("\n")
    entries = [re.match(r"; command (\d+) \S+ \S+ \d+ (\d+) (\d+)(?: blend (\d+))?$", line) for line in lines]
    entries = [[int(x) if x else None for x in entry.groups()] for entry in entries if entry]
    moves = {k: line for k, line in enumerate(lines, 1) if re.match(r"X[-0-9]", line)}
    (tm,) = {float(line[2:]) for line in lines if re.match(r"TM\d", line)}
    rapid, *order = sorted(moves)
    points = np.array(
        [[float(x) for x in re.findall(r"[A-Z](-?[0-9.]+)", moves[k])] for k in [rapid, *order]]
    )
    f = np.vstack([points[:1]] * 3 + [points[1:]] + [points[-1:]] * 2)
    place = {line: k for k, line in enumerate(order)}
    spans = {
        step: (place[first], place[last] + 1 + (2 if last == order[-1] else 0), blend)
        for step, first, last, blend in entries
        if first
    }
    return f, tm * 1e-3, spans


def sampled(f, h, first, last, per_segment=12):
    spline = BSpline(np.arange(-3, len(f) + 1) * h, f, 3)
    return spline(np.linspace(first, last, (last - first) * per_segment + 1) * h)


def test_figures_of_the_blends():
    made = compiled()
    f, h, spans = read(made.text)
    arm = Arm.in_folder(made.plan.robot.folder)
    assert all(blend for *_, blend in list(spans.values())[:-1])
    commands = {command.step: command for command in made.certificate.commands}
    for step, (corner, rpy) in CORNERS.items():
        _, end, w = spans[step]
        points, rotations = arm.poses(sampled(f, h, end - w // 2, end + w // 2))
        truth = np.linalg.norm(points - corner, axis=1).max()
        found = commands[step].blended
        assert found.segments == w
        assert truth - 1e-6 <= found.position * 1e3 <= truth * 1.01 + 0.01
        assert found.position <= found.radius + 2e-5
        turned = np.max((rotations * Rotation.from_euler("xyz", rpy, degrees=True).inv()).magnitude())
        assert turned - 1e-9 <= found.angle <= found.turn + 1e-4
    for step, corner in ((5, [0, 0, 0, 0, -30, 0]), (6, [20, 5, 0, 0, 0, 0])):
        _, end, w = spans[step]
        away = np.abs(sampled(f, h, end - w // 2, end + w // 2) - corner).max()
        assert away - 1e-9 <= np.degrees(commands[step].blended.angle) <= away * 1.001 + 1e-6
    for step in (1, 3, 4):
        first, last, _ = spans[step]
        points, _ = arm.poses(sampled(f, h, first, last, per_segment=40))
        speed = np.linalg.norm(np.diff(points, axis=0), axis=1).max() / (h / 40)
        assert speed * (1 - 1e-6) <= commands[step].tool_speed.largest * 1e3 <= speed * 1.01


def test_the_line_and_the_arc_between_their_blends():
    """Compare with the plain definition: distances from a line, and from a circle and its plane."""
    f, h, spans = read(compiled().text)
    arm = Arm.in_folder(compiled().plan.robot.folder)
    before = spans[0][2]
    first, last, w = spans[1]
    points, _ = arm.poses(sampled(f, h, first + before // 2, last - w // 2))
    assert np.abs(points[:, 1:] - [1174.4, 1176]).max() < 1e-3
    first, last, behind = spans[3]
    points, _ = arm.poses(sampled(f, h, first + w // 2, last - behind // 2))
    assert np.abs(points[:, 1] - 1174.4).max() < 1e-3
    assert np.abs(np.hypot(points[:, 0] - 150, points[:, 2] - 1226) - 50).max() < 1e-3


@pytest.mark.parametrize("seed", range(12))
def test_a_move_line_that_is_changed(seed):
    """A move line is changed by 0.02 deg. Outside of blends, this is found. Within a blend, it is found, or
    the corner is still within its ball.
    """
    text = compiled().text
    *_, spans = read(text)
    rng = np.random.default_rng(seed)
    lines = text.split("\n")
    order = [k for k, line in enumerate(lines) if re.match(r"X[-0-9]", line)][1:]
    k = int(rng.integers(0, len(order) - 3))
    axis = int(rng.integers(0, 3))
    parts = re.findall(r"([A-Z])(-?[0-9.]+)", lines[order[k]])
    parts[axis] = parts[axis][0], f"{float(parts[axis][1]) + 0.02:.6f}"
    lines[order[k]] = "".join(letter + value for letter, value in parts)
    result = judged("\n".join(lines))
    touched = range(k, k + 4)  # segments k to k + 3 depend on point k
    inside = any(
        blend and all(end - blend // 2 <= s < end + blend // 2 for s in touched)
        for _, end, blend in spans.values()
    )
    assert inside or codes(result), (k, axis)


def test_outputs_and_maps_that_are_changed():
    text = compiled().text
    assert codes(judged(text)) == []
    lines = text.split("\n")
    (at,) = (k for k, line in enumerate(lines) if line == "M1==1")
    for off, found in ((-1, []), (1, []), (2, ["Y1165"]), (-3, ["Y1165"])):
        moved = [*lines]
        moved.insert(at + off, moved.pop(at))
        # Update the map's lines of both commands.
        place = moved.index("M1==1") + 1
        shown = re.sub(
            r"(; command [13] \S+ \S+ \d+ )(\d+) (\d+)",
            lambda m, place=place: (
                m[1] + " ".join(str(_shifted(int(x), at + 1, place)) for x in (m[2], m[3]))
            ),
            "\n".join(moved),
        )
        assert sorted(set(codes(judged(shown)))) == found, off
    for old, new in ((r"blend (\d+)$", "blend 0"), (r" blend (\d+)$", "")):
        changed = re.sub(rf"(; command 1 .*){old}", rf"\g<1>{new}", text, count=1, flags=re.MULTILINE)
        assert changed != text
        assert codes(judged(changed))


def _shifted(line, before, behind):
    """Return the number of a move line after a line was moved from `before` to `behind`."""
    if behind <= line < before:
        return line + 1
    if before < line <= behind:
        return line - 1
    return line


WAYS = """
DEFAULT {TCP} [2] (mm,deg,s) {B}
INPUT DOOR M11
P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [MIN]
WHEN DOOR ON
  P0020 MOVEL 80 1174.4 1176 0 0 0 BLEND 10
  P0030 MOVEL 80 1174.4 1276 0 0 0
ELSE
  P0040 DMOVE 80 0 0 0 0 0
  P0050 MOVEL_SPLINE 90 1174.4 1200 0 0 0; 80 1174.4 1276 0 0 0
END
P0060 MOVEC 100 1174.4 1226; 0 1174.4 1176 0 0 0
"""


@pytest.mark.parametrize("target", ["rotary", "prog"])
def test_the_ways_of_a_when(target):
    """Both branches of a WHEN begin at the same position. The second branch doesn't begin at the end of the
    first.
    """
    result = yarclang.compile(WAYS, robot="INDUSTRIAL6", target=target)
    assert result.value is not None, result.diagnostics
    kinds = [command.kind for command in result.value.certificate.commands]
    assert kinds == ["joint", "line", "line", "line", "pose_spline", "arc"]
    assert result.value.certificate.position < 2e-5


def test_an_arm_with_a_joint_too_many(tmp_path):
    """For an arm with a spare joint, the pose at the end of a line doesn't determine the joints, so they are
    claimed.
    """
    from programs import compiled as compiled_for

    from tests.robot.made_arms import DATA, REAL, made

    file, arguments, size = REAL["panda"]
    assert size == 7
    made(DATA / file, tmp_path / "arm", *arguments)
    text = """
DEFAULT {TCP} [4] (mm,deg,s) {B}
P0010 MOVEJ 10 30 15 -100 10 110 5 [10]
P0020 DMOVE 60 0 0 0 0 0 BLEND 15
P0030 DMOVEJ 4 4 4 4 4 4 4 BLEND 15
P0040 DMOVE 0 60 0 0 5 0
"""
    result, diagnostics = compiled_for(text, str(tmp_path / "arm"))
    assert [one.message for one in diagnostics if one.is_error] == []
    assert result is not None
    assert result.certificate.commands[1].blended.position <= 0.01502


# if a motion doesn't reach its programmed speed, the planner claims the share of the speed that the motion
# reaches


SHORT_WAY = "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ 20 0 0 0 -30 0 [2]\nP0020 DMOVE 0 0 -6 0 0 0 [V 500]\n"


def speed_judged(kept, least=None):
    """Judge the short path with claimed shares of its speed: `kept` as the largest ones, `least` as the
    smallest ones (None: the same).
    """
    made = yarclang.compile(SHORT_WAY, robot="INDUSTRIAL6").value
    claims = replace(claims_of(made.plan), kept=kept, least=kept if least is None else least)
    return certify(made.text, made.program, made.plan.robot, made.plan.robot.tolerance, claims)


def test_the_judge_reports_a_speed_that_isnt_reached():
    found = yarclang.compile(SHORT_WAY, robot="INDUSTRIAL6")
    (finding,) = found.diagnostics
    assert finding.code == "Y0610"
    share = found.value.plan.motions[1].kept
    assert share < 0.9
    assert f"reaches {share * 100:.3g} % of it" in finding.message
    assert finding.fix.title.startswith("write [V ")
    # The certificate has the proved speed.
    speed = found.value.certificate.commands[1].tool_speed
    assert speed.programmed == pytest.approx(0.5 * share)
    assert speed.least == pytest.approx(speed.programmed, rel=1e-3)


@pytest.mark.parametrize("factor", [0.5, 0.99, 1.01, 2.0])
def test_a_wrong_claim_about_a_speed_is_refused(factor):
    made = yarclang.compile(SHORT_WAY, robot="INDUSTRIAL6").value
    result = speed_judged({1: made.plan.motions[1].kept * factor})
    assert "Y1167" in codes(result)


@pytest.mark.parametrize("kept", [{}, {1: 0.0}, {1: -1.0}, {1: float("nan")}, {1: 2.0}, {0: 0.5}])
def test_without_a_claim_the_text_is_held_to_the_programmed_speed(kept):
    assert "Y1167" in codes(speed_judged(kept))


@pytest.mark.parametrize("factor", [1.01, 2.0, 9.0])
def test_a_share_that_is_claimed_too_large_is_told_as_it_is(factor):
    """If two different shares are claimed, the speed may lie between them. The message has the
    proved share.
    """
    made = yarclang.compile(SHORT_WAY, robot="INDUSTRIAL6").value
    share = made.plan.motions[1].kept
    (finding,) = speed_judged({1: share * factor}, {1: share}).diagnostics
    assert finding.code == "Y0610"
    assert f"reaches {share * 100:.3g} % of it" in finding.message
