"""Measure zones for RESULTS.md: `python benchmarks/zones.py`, in an environment with yarclang. Times are CPU
times.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from yarclang.cell.description import Names, read_cell
from yarclang.certify import whole_text
from yarclang.certify.bodies.zones import find_zones
from yarclang.diagnostics import Result
from yarclang.pipeline.inputs import Options, open_program
from yarclang.pipeline.stages import certified, check_program, plan_checked
from yarclang.robot.description import load_robot
from yarclang.semantics.declared.meanings import is_word
from yarclang.source import SourceFile

EXAMPLE = Path(__file__).parents[1] / "examples" / "06_palletising.yarc"

BORDERS = """units = "mm,deg,s"
[[zones]]
name = "FLOOR"
rule = "allowed"
shape = "half-space"
frame = "B"
normal = [0, 0, 1]
xyz = [0, 0, 400]
watch = ["tool", "elbow"]
[[zones]]
name = "FENCED"
rule = "allowed"
shape = "box"
frame = "B"
xyz = [0, 0, 1500]
size = [3000, 3000, 3000]
watch = ["tool", "arm"]
[[zones]]
name = "WALKWAY"
rule = "forbidden"
shape = "box"
frame = "B"
xyz = [-1300, 0, 1000]
size = [600, 3000, 2000]
watch = ["tool", "arm"]
[[zones]]
name = "FRONT"
rule = "allowed"
shape = "joints"
joints = { J1 = [-120, 120] }
"""
"""Four zones around the palletiser, two of them for the whole arm."""
SLOW = """[[zones]]
name = "AT_PALLET"
rule = "slow"
shape = "box"
frame = "B"
xyz = [-160, 870, 600]
size = [600, 500, 200]
speed = 250
"""
"""A zone that contains a third of the motions."""


def main() -> None:
    """Measure everything, and print the table."""
    robot = load_robot("INDUSTRIAL6").value
    opened = open_program(str(EXAMPLE), Options()).value
    assert robot is not None
    assert opened is not None
    checked = check_program(opened.module, opened.request)
    assert checked.value is not None
    print("zones                      plan ms  certify ms  of it zones ms")
    for name, text in (("none", None), ("four", BORDERS), ("four and a slow one", BORDERS + SLOW)):
        cell = None
        if text is not None:
            source = SourceFile("cell.toml", text)
            cell = read_cell(source, EXAMPLE.parent, Names(is_word, robot)).value
        placed = Result(replace(checked.value, cell=cell), checked.diagnostics)
        planned = plan_checked(placed, opened.request)
        assert planned.value is not None, planned.diagnostics
        plan = best(lambda placed=placed: plan_checked(placed, opened.request))
        whole = best(lambda planned=planned: certified(planned.value, opened.request))
        whole_text.find_zones = lambda *_: ({}, [])
        without = best(lambda planned=planned: certified(planned.value, opened.request))
        whole_text.find_zones = find_zones
        print(f"{name:25}  {plan:7.0f}  {whole:10.0f}  {whole - without:14.0f}")


def best(work: Callable[[], object], count: int = 7) -> float:
    """Return the shortest time of several runs [ms]."""
    spent = []
    for _ in range(count):
        begun = time.process_time()
        work()
        spent.append((time.process_time() - begun) * 1e3)
    return min(spent)


if __name__ == "__main__":
    main()
