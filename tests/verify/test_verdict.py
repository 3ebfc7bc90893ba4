"""Certified texts are accepted, and everything undecided is named.

The checker needs nothing but the standard library.
"""

import re
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from programs import compiled, robot_of

from tests.verify.proof_forging import BLENDED, MOTIONS, WAYS, made
from yarclang.campaign.drawing import drawn
from yarclang.independent.arm import Arm
from yarclang.pipeline.proofs import proof_of
from yarclang.verify import verdict as verdicts
from yarclang.verify.__main__ import ACCEPTED, REFUSED, UNCHECKED, USAGE, main, status_of
from yarclang.verify.verdict import ALWAYS_UNCHECKED, Verdict, verify

ROOT = Path(__file__).resolve().parents[2]
LISTING_4 = (ROOT / "examples" / "01_listing4.yarc").read_text()

HIDDEN = """
import sys
class Hidden:
    def find_spec(self, name, path=None, target=None):
        outer = name.split(".")[0]
        ours = name.startswith("yarclang.") and not name.startswith("yarclang.verify")
        if ours or outer not in (*sys.stdlib_module_names, "yarclang"):
            raise ImportError(f"{name} is hidden")
sys.meta_path.insert(0, Hidden())
sys.argv = ["verify", *sys.argv[1:]]
import runpy
runpy.run_module("yarclang.verify", run_name="__main__")
"""


def judged(program, robot="INDUSTRIAL6"):
    text, proof = made(program, robot)
    return verify(text.encode(), proof.encode())


def own(verdict):
    """Return the unchecked items, without those that are never checked."""
    return [one for one in verdict.unchecked if one not in ALWAYS_UNCHECKED]


def test_motions_from_rest_to_rest_are_decided_whole():
    for program in (MOTIONS, LISTING_4):
        verdict = judged(program)
        assert verdict.refused == ""
        assert own(verdict) == []
        assert set(ALWAYS_UNCHECKED) <= set(verdict.unchecked)


SPLINE = "MOVEJ_SPLINE 5 0 0 0 5 0; 0 -6.158742 -46.519197 0 52.677939 0 [5] (deg,s)"


def test_what_is_not_decided_is_named():
    mixed = BLENDED.replace(
        "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]", "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [5] BLEND 10"
    )
    assert own(judged(mixed)) == []
    spline = mixed.replace("MOVEJ_RPY 0 1174.4 1176 0 0 0 [5]", SPLINE)
    assert own(judged(spline)) == []
    assert own(judged(WAYS)) == []
    timed = "P0010 MOVEJ_TIMED 1 0 0 0 0 0 [1]; 0 0 0 0 0 0 [2] (deg,s)"
    assert own(judged(timed)) == []
    assert judged(timed).exempt == [
        "P0010 MOVEJ_TIMED 1: the jerk, also in its blends: its profile has no limit"
    ]
    spoken = (
        "DEFAULT {TCP} (mm,deg,s) {B}\n"
        "P0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [4]\n"
        "P0020 MOVEL 100 1174.4 1176 0 0 0 [V 50]"
    )
    assert own(judged(spoken)) == []
    turned = spoken.replace("MOVEL 100 1174.4 1176 0 0 0 [V 50]", "DMOVE 0 0 0 0 0 30 [V 20]")
    assert own(judged(turned)) == []


def test_motions_that_the_checker_could_not_tell_exactly_are_named():
    near = "P0010 MOVEJ_SPLINE 10 0 0 0 0 0; 10.005 0 0 0 0 0; 20 0 5 0 0 0 [8] (deg,s)"
    assert own(judged(near)) == [
        (
            "P0010 MOVEJ_SPLINE 1: path, goal, time and speed (the proof says 'its path, a spline with "
            "waypoints side by side')"
        )
    ]
    begun = "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [4]\n"
    beside = f"{begun}P0020 MOVEC 0.5 1174.39 1176; 100 1100 1176 0 0 0 [4]"
    assert own(judged(beside)) == [
        (
            "P0020 MOVEC 3: path, goal, time and speed (the proof says 'its path, an arc whose via point is "
            "beside one of its ends')"
        )
    ]


def test_equal_waypoints_of_a_spline_of_poses_are_one():
    begun = "DEFAULT {TCP} (mm,deg,s) {B}\nP0010 MOVEJ_RPY 0 1174.4 1176 0 0 0 [4]\n"
    side, end = "60 1134.4 1176 0 0 10", "180 1174.4 1126 5 0 0"
    twice = f"{begun}P0020 MOVEL_SPLINE {side}; {side}; {end}; {end}; {end} [5]"
    beside = end.replace("180", "180.0000000001")
    for text in (twice, twice.replace(f"{end} [5]", f"{beside} [5]")):
        assert own(judged(text)) == []
    alone = f"{begun}P0020 MOVEL_SPLINE {side}; {side} [5]"
    assert own(judged(alone)) == []


def test_a_jerk_without_a_limit_is_named():
    free = "P0010 MOVEJ_TOPP 30 0 0 0 0 0 [MIN] (deg,s)"
    assert own(judged(free)) == []
    assert judged(free).exempt == [
        "P0010 MOVEJ_TOPP 1: the jerk, also in its blends: its profile has no limit"
    ]


def test_it_tells_of_which_robot_and_program_it_was_told():
    told = judged(MOTIONS).told
    fingerprint = robot_of("INDUSTRIAL6").fingerprint
    assert f"robot INDUSTRIAL6 {fingerprint}" in told
    assert "robot velocity: [60, 60, 60, 60, 60, 60]" in told
    assert [one for one in told if one.startswith("after ")] == [
        "after P0020 MOVEL 5: put M20=1",
        "after P0040 MOVEC 7: barrier wait 4 M11=1 5 DOOR",
        "after P0070 DMOVE 10: dwell 500",
        "after P0070 DMOVE 10: put M20=0",
    ]
    assert any(
        one.startswith("P0020 MOVEL 5: line; tolerance [0.02, 0.002]; duration 4; pose [") for one in told
    )


def test_it_runs_with_all_but_the_standard_library_hidden(tmp_path):
    text, proof = made(LISTING_4)
    (tmp_path / "one.pmc").write_text(text)
    (tmp_path / "one.proof.json").write_text(proof)
    command = [sys.executable, "-c", HIDDEN, "one.pmc", "one.proof.json"]
    begun = time.perf_counter()
    done = subprocess.run(
        command,
        cwd=tmp_path,
        env={"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.returncode == UNCHECKED, done.stderr
    assert "nothing wrong in what was checked" in done.stdout
    # the check takes 0.4 s on an idle computer
    assert time.perf_counter() - begun < 10
    (tmp_path / "one.pmc").write_text(text.replace("TM50", "TM51"))
    done = subprocess.run(
        command, cwd=tmp_path, env={"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout) == (REFUSED, "")
    assert "refused: the proof is for another text" in done.stderr


def test_the_status_says_what_was_decided(tmp_path, capsys):
    assert status_of(Verdict()) == ACCEPTED
    assert status_of(Verdict(unchecked=["torques"])) == UNCHECKED
    assert status_of(Verdict(refused="no", unchecked=["torques"])) == REFUSED
    assert main([]) == USAGE
    assert main([str(tmp_path / "no.pmc"), str(tmp_path / "no.json")]) == USAGE
    assert "No such file" in capsys.readouterr().err


@pytest.mark.parametrize("name", sorted(one.stem for one in (ROOT / "examples").glob("0[2-7]*.yarc")))
def test_examples_are_accepted(name):
    from yarclang import compile as compile_text
    from yarclang.pipeline.stages import Compiled

    source = ROOT / "examples" / f"{name}.yarc"
    found = compile_text(source.read_text(), name=source.name, folder=source.parent)
    assert isinstance(found.value, Compiled)
    proof = proof_of(found.value)
    assert proof.value is not None
    assert len(proof.value) < 5 * len(found.value.text)
    verdict = verify(found.value.text.encode(), proof.value.encode())
    assert (verdict.refused, own(verdict)) == ("", [])


@pytest.mark.parametrize("name", ["INDUSTRIAL6", "TRACKED_MANIPULATOR"])
def test_what_is_certified_by_chance_is_accepted(name):
    robot = robot_of(name)
    arm = Arm.in_folder(robot.folder)
    accepted, decided = 0, set()
    for seed in range(100, 112):
        found, _ = compiled(drawn(arm, np.random.default_rng(seed), most=3).text, robot)
        if found is None:
            continue
        proof = proof_of(found)
        assert proof.value is not None, (seed, proof.diagnostics)
        verdict = verify(found.text.encode(), proof.value.encode())
        assert verdict.refused == "", seed
        accepted += 1
        decided |= set(
            re.findall(r": (joint|line|arc|spline|spline of poses|timetable);", "\n".join(verdict.told))
        )
    assert accepted >= 5
    assert len(decided) >= 3


def test_a_proof_that_the_checker_does_not_follow_is_not_written(monkeypatch):
    found, _ = compiled("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)", "INDUSTRIAL6")
    assert found is not None
    assert proof_of(found).value is not None
    monkeypatch.setattr(verdicts, "check_limits", lambda *_: verdicts.need(False, "so"))
    made_ = proof_of(found)
    assert made_.value is None
    assert [one.code for one in made_.diagnostics] == ["Y1196"]


def test_a_text_for_a_program_buffer_has_no_proof():
    found, _ = compiled("P0010 MOVEJ 10 0 0 0 0 0 [2] (deg,s)", "INDUSTRIAL6", target="prog")
    assert found is not None
    assert [one.code for one in proof_of(found).diagnostics] == ["Y1196"]


def test_it_is_short_enough_to_be_read():
    lines = [
        line for file in (ROOT / "yarclang" / "verify").glob("*.py") for line in file.read_text().split("\n")
    ]
    assert max(map(len, lines)) <= 110
