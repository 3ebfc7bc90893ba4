"""Tests of `yarc campaign`: its report is the same on any number of processes and after any number of kills,
and it finds faults.
"""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from click.testing import CliRunner

from yarclang.campaign import judging
from yarclang.campaign.drawing import drawn
from yarclang.campaign.judging import Task, arm_of, judged_chunk, judged_program
from yarclang.campaign.report import as_text, summed
from yarclang.cli.yarc import main
from yarclang.diagnostics import Diagnostic, Result
from yarclang.fleet.spreading import Place, racing_workers
from yarclang.independent.judging import judge
from yarclang.pipeline.stages import Request, compile_module
from yarclang.robot.description import load_robot
from yarclang.source import SourceFile
from yarclang.syntax.parse import parse

TASK = Task(("INDUSTRIAL6", "TRACKED_MANIPULATOR"))
COMMAND = [
    sys.executable,
    "-c",
    "import sys; from yarclang.cli.yarc import main; main(sys.argv[1:])",
    "campaign",
]


def report(*arguments):
    made = CliRunner().invoke(main, ["campaign", "--format", "json", *map(str, arguments)])
    assert made.exit_code in (0, 1), made.output
    data = json.loads(made.stdout)
    assert data.pop("processor_seconds") > 0.0
    return data


def test_a_campaign_that_is_killed_again_and_again_reports_as_one_that_is_not(tmp_path):
    state = tmp_path / "state"
    kills = 0
    for number in range(20):
        process = subprocess.Popen(
            [*COMMAND, "--programs", "36", "-j", "1", "--state", str(state)],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        before = state.read_bytes().count(b"\n") if state.exists() else 0
        until = time.monotonic() + 120.0
        # kill it soon after it has stored a chunk, the first time during the first chunk
        while process.poll() is None and time.monotonic() < until:
            if number and state.exists() and state.read_bytes().count(b"\n") > max(1, before):
                break
            if not number and state.exists():
                time.sleep(0.5)
                break
            time.sleep(0.01)
        if process.poll() is not None:
            break
        process.send_signal(signal.SIGKILL)
        process.wait()
        kills += 1
    assert kills >= 3
    assert report("--programs", 36, "--state", state, "-j", 1) == report("--programs", 36, "-j", 2)
    # all programs are in the state: none is left to do
    assert report("--programs", 36, "--state", state)["programs"] == 36


def test_a_larger_number_goes_on(tmp_path):
    state = tmp_path / "state"
    assert report("--programs", 4, "--state", state)["programs"] == 4
    size = state.stat().st_size
    assert report("--programs", 7, "--state", state) == report("--programs", 7)
    assert state.stat().st_size > size


def ending(chunk, task):
    """End the process that gets the chunk with program 13."""
    first, count = chunk
    if first <= 13 < first + count:
        os.kill(os.getpid(), signal.SIGKILL)
    return judging.Piece(first, count)


def test_a_program_that_ends_its_processes_is_found_alone(monkeypatch):
    monkeypatch.setattr(judging, "judged_chunk", ending)
    made = CliRunner().invoke(main, ["campaign", "--format", "json", "--programs", "40", "-j", "2"])
    assert made.exit_code == 1, made.output
    data = json.loads(made.stdout)
    assert [one["seed"] for one in data["finds"]] == [13]
    assert "SIGKILL" in data["finds"][0]["faults"][0]
    assert data["programs"] == 40


def test_results_are_there_as_soon_as_they_are_made():
    with racing_workers(slow_first, Place(2), lambda _: ()) as do:
        found = list(do(range(60)))
    assert found[0][0] != 0
    assert sorted(found) == [(number, -number) for number in range(60)]


def slow_first(number):
    if number == 0:
        time.sleep(1.0)
    return -number


def test_a_chunk_is_as_its_programs_alone():
    alone = [judged_chunk((seed, 1), TASK) for seed in range(6)]
    together = summed([judged_chunk((0, 6), TASK)], 0)
    apart = summed(alone, 0)
    together.seconds = apart.seconds = 0.0
    assert together == apart
    assert together.compiled >= 2
    assert together.found == 0


def made_of(seed):
    robot = load_robot("INDUSTRIAL6").value
    program = drawn(arm_of(robot), np.random.default_rng(seed), 3)
    made = compile_module(parse(SourceFile("a.yarc", program.text)).value, Request(robot)).value
    return robot, program, made


def shifted(found):
    return f"{found[0][0]}{float(found[1]) + 0.05:.6f}"


@pytest.mark.parametrize("what", ["position", "time", "one point", "another goal"])
def test_texts_that_are_forged_are_found(what):
    seen = 0
    for seed in range(12):
        robot, program, made = made_of(seed)
        if made is None:
            continue
        chosen = {motion.step: motion.waypoints for motion in made.plan.motions}
        arm = arm_of(robot)
        assert judge(arm, program.said, made.text, chosen, {}).faults == ()
        lines = made.text.split("\n")
        points = [
            number for number, line in enumerate(lines)
            if line[:1] in "XYZABCUVW" and line[1:2].strip("-").isdigit() and number > lines.index("RAPID") + 2  # noqa: E501
        ]  # fmt: skip
        if what == "time":
            number = next(number for number, line in enumerate(lines) if line.startswith("TM"))
            lines[number] = f"TM{float(lines[number][2:]) * 0.5:g}"
        elif what == "another goal":
            step = max(program.said)
            chosen[step] = chosen[step] + 1e-4
        else:
            for number in points[len(points) // 2 :] if what == "position" else [points[len(points) // 2]]:
                lines[number] = re.sub(r"^[A-Z](-?[0-9.]+)", shifted, lines[number])
        found = judge(arm, program.said, "\n".join(lines), chosen, {}).faults
        assert found, (seed, what)
        seen += 1
    assert seen >= 4


def broken(module, request, *, how):
    made = compile_module(module, request)
    if made.value is None:
        return made
    if how == "crash":
        raise ZeroDivisionError("nothing to divide")
    if how == "certificate":
        return Result(None, (Diagnostic("Y1165", "the text does what the program doesn't say"),))
    if how == "silent":
        return Result(None, ())
    text = "no text" if how == "garbage" else made.value.text.replace("\nTM", "\nTM1", 1)
    return Result(replace(made.value, text=text), made.diagnostics)


@pytest.mark.parametrize("how", ["crash", "certificate", "silent", "garbage", "slow"])
def test_what_is_wrong_with_the_compiler_is_found(monkeypatch, how):
    monkeypatch.setattr(judging, "compile_module", partial(broken, how=how))
    made = CliRunner().invoke(main, ["campaign", "--programs", "6", "-j", "1"])
    assert made.exit_code == 1, made.output
    assert "with something wrong" in made.output
    assert "--again" in made.output
    assert "no faults were found" not in made.output


def test_one_program_again():
    made = CliRunner().invoke(main, ["campaign", "--again", "1", "--format", "json"])
    assert made.exit_code == 0, made.output
    data = json.loads(made.stdout)
    one = judged_program(1, TASK)
    assert (data["text"], data["worst"], data["robot"]) == (one.text, one.worst, "TRACKED_MANIPULATOR")
    text = CliRunner().invoke(main, ["campaign", "--again", "1"]).stdout
    assert one.text.strip() in text
    # `yarc check` can read the printed program
    assert not parse(SourceFile("a.yarc", text)).diagnostics


def test_robots_and_cells_of_ones_own(tmp_path):
    shutil.copytree("stdlib/robots/industrial6", tmp_path / "ours")
    cell = tmp_path / "cell.toml"
    cell.write_text(
        'units = "mm,deg"\n'
        "[[obstacles]]\n"
        'name = "WALL"\n'
        'shape = "box"\n'
        "size = [4000, 100, 4000]\n"
        'frame = "B"\n'
        "xyz = [0, 900, 0]\n"
    )
    free = report("--programs", 4, "--robot", tmp_path / "ours")
    walled = report("--programs", 4, "--robot", tmp_path / "ours", "--cell", cell)
    assert free["compiled"] > walled["compiled"]
    assert sum(walled["refused"].values()) == 4 - walled["compiled"]
    state = tmp_path / "state"
    report("--programs", 1, "--robot", tmp_path / "ours", "--cell", cell, "--state", state)
    cell.write_text(cell.read_text().replace("900", "901"))
    arguments = [
        "campaign",
        "--programs",
        "1",
        "--robot",
        str(tmp_path / "ours"),
        "--cell",
        str(cell),
        "--state",
        str(state),
    ]
    made = CliRunner().invoke(main, arguments)
    assert made.exit_code == 1
    assert "its cell is" in made.output


@pytest.mark.parametrize(
    ("arguments", "status", "words"),
    [
        (["--programs", "0"], 2, "--programs"),
        (["--seed", "-1"], 2, "--seed"),
        (["--robot", "NOBODY"], 1, "there is no robot 'NOBODY'"),
        (["--cell", "nowhere.toml"], 1, "nowhere.toml"),
        (["--again", "3", "--state", "x"], 2, "--again"),
        (["--state", "no/folder/x"], 1, "no/folder/x"),
        (["--scheduler", "tcp://127.0.0.1:1", "--programs", "1"], 1, "scheduler"),
    ],
)
def test_what_cannot_be_done_is_said(arguments, status, words):
    made = CliRunner().invoke(main, ["campaign", *arguments])
    assert made.exit_code == status, made.output
    assert words.lower() in made.output.lower()
    assert "Traceback" not in made.output


def test_the_text_says_what_was_done():
    text = "\n".join(as_text(summed([judged_chunk((0, 4), TASK)], 0), TASK))
    assert "4 programs of seeds 0 to 3, for INDUSTRIAL6, TRACKED_MANIPULATOR" in text
    assert "no faults were found" in text
