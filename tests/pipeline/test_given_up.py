"""Tests of cancelling an analysis: each phase often asks its listener whether to go on, and ends soon."""

import gc
import math
import time
from collections import Counter
from pathlib import Path

import pytest

from yarclang.pipeline.incremental import Analyst
from yarclang.pipeline.inputs import Options
from yarclang.progress import told_to
from yarclang.source import SourceFile

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"

LONGEST = 0.15
"""Longest allowed processor time between two calls of the listener [s]; 0.05 s is promised for a quiet
machine.
"""

HEAD = "DEFAULT {TCP} [5] (mm,deg,s) {B}\nP0010 MOVEJ_RPY 300 1074.4 1100 0 0 0\n"


def spline(count):
    """Return a program with one curve through `count` poses on a circle."""
    angles = [number / 40 for number in range(1, count + 1)]
    poses = [f"{300 * math.cos(a):.2f} 1074.4 {1100 + 200 * math.sin(a):.2f} 0 0 0" for a in angles]
    return f"{HEAD}P0020 MOVEL_SPLINE {';'.join(poses)} [{count / 2}]\nP0030 STOP\n"


def chain(count):
    """Return a program with `count` lines that are blended."""
    rows = [
        (
            f"P{number + 20:04} MOVEL {300 - number % 2 * 50 - number * 2} 1074.4 "
            f"{1100 - number // 2 % 2 * 40} 0 0 0 [V 200] BLEND 5"
        )
        for number in range(1, count)
    ]
    return HEAD + "\n".join([*rows, "P9000 STOP\n"])


def grid(count):
    """Return a program with a loop of `count` passes of three motions."""
    body = (
        "P0020 MOVEL $(300 - I % 7 * 20) 1074.4 1100 0 0 0\n"
        "P0030 MOVEJ $(I % 5) 0 0 0 -30 0\n"
        "P0040 MOVEJ_RPY 300 1074.4 1100 0 0 0\n"
    )
    return f"{HEAD}REPEAT I {count}\n{body}END\nP0050 STOP\n"


TEXTS = {
    "a curve through 100 poses": spline(100),
    "a curve through 250 poses": spline(250),
    "a chain of 30 lines": chain(30),
    "300 motions in a loop": grid(100),
    "a slow line": HEAD + "P0020 MOVEL 0 1074.4 1100 0 0 0 [600]\nP0030 STOP\n",
    "a loop around nothing": HEAD + "REPEAT 199\nREPEAT I 999\nIF I > 5\nEND\nEND\nEND\nP0030 STOP\n",
    "10,000 unknown commands": "P0010 MOVEK\n" * 10_000,
    "10,000 waits for nothing": HEAD + "".join(f"P{number + 20} WAIT 1\n" for number in range(10_000)),
    "10,000 suppressions": HEAD
    + "".join(f"LET A{number} = 1 ! yarc: ignore[Y0505]\n" for number in range(10_000)),
    "10,000 suppressions of nothing": "! yarc: ignore[Y0505]\n" * 10_000,
    "10,000 lines": HEAD + "".join(f"LET A{number} = {number}\n" for number in range(10_000)),
    "dispensing": (EXAMPLES / "11_dispensing.yarc").read_text(),
    "a weld seam": (EXAMPLES / "10_weld_seam.yarc").read_text(),
    "a cell": (EXAMPLES / "12_machine_cell.yarc").read_text(),
}


@pytest.mark.parametrize("name", TEXTS)
def test_every_phase_is_asked_often_whether_to_go_on(name):
    source = SourceFile(str(EXAMPLES / "test.yarc"), TEXTS[name])
    phases, gaps = Counter(), []

    def listen(what, *_):
        now = time.thread_time()
        gaps.append((now - last[0], what))
        phases[what.partition(":")[0]] += 1
        last[0] = time.thread_time()

    for _ in range(2):  # an import can't be interrupted: if the first round is slow, the second one counts
        phases.clear()
        gaps.clear()
        gc.collect()
        last = [time.thread_time()]
        with told_to(listen):
            found = Analyst(Options(robot="INDUSTRIAL6")).analyse(source, EXAMPLES)
        listen("the end")
        if max(gaps)[0] < LONGEST:
            break
    assert max(gaps)[0] < LONGEST
    assert len(gaps) > 10
    if found.certificate is not None:
        assert {"planning", "writing the controller text", "certifying"} <= phases.keys()
