"""Measurements inside one process of ours. Each prints one JSON object, and excludes imports.

python inside.py stages COUNT TM        the compiler's stages, for as many lines
python inside.py plan COUNT TM          lines to joint samples every TM ms
python inside.py cost COUNT TM KIND     text to certified text, without the imports
python inside.py task COUNT TM          the lines as peer_*.py read them
python inside.py edits COUNT TM         a first look at the lines, and looks at edits of them
python inside.py collisions 0 0         an example compiled with and without the collision check
"""

from __future__ import annotations

import json
import statistics
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import programs

from yarclang.backend_pmac import writing
from yarclang.motion.limits import bounds_of
from yarclang.motion.plan import MotionPlan
from yarclang.motion.profile import load_profile
from yarclang.pipeline import inputs, stages
from yarclang.pipeline.incremental import Analyst
from yarclang.robot.library import stdlib_folder
from yarclang.source import SourceFile

Times = dict[str, float]
"""`seconds` of wall time, and `cpu` seconds on a core."""

STAGES = (
    (inputs, ("parse", "load_robot")),
    (stages, ("check", "plan", "certify")),
    (writing, ("lower", "emit")),
)


def main() -> None:
    """Measure the task of the command line."""
    what, count, tm, *kind = sys.argv[1:]
    print(json.dumps(globals()[f"measure_{what}"](int(count), float(tm), *kind)))


def measure_stages(count: int, tm: float) -> dict[str, Any]:
    """Return the times of each stage of one compilation."""
    times: dict[str, Times] = {}
    for module, names in STAGES:
        for name in names:
            setattr(module, name, _timed(getattr(module, name), name, times))
    _timed(_compiled, "all", times)(programs.lines(3, 0), tm)  # imports everything before the measurement
    times.clear()
    compiled = _timed(_compiled, "all", times)(programs.lines(count), tm)
    rows = sum(motion.curve.segments for motion in compiled.plan.motions)
    return {"stages": times, "rows": rows, "bytes": len(compiled.text)}


def measure_cost(count: int, tm: float, kind: str) -> Times:
    """Return the times from text to certified text, the median of several different programs if they are
    short.
    """
    make = getattr(programs, kind)
    _compiled(make(10, 0), tm)  # imports everything before the measurement
    found: list[dict[str, Times]] = []
    for seed in range(1, 2 + min(8, 1000 // count)):
        found.append({})
        _timed(_compiled, "all", found[-1])(make(count, seed), tm)
    return {key: statistics.median(times["all"][key] for times in found) for key in ("seconds", "cpu")}


def measure_plan(count: int, tm: float) -> dict[str, Any]:
    """Return the seconds from text to joint positions at every `tm` of the plan, and to the plan alone."""
    _planned(programs.lines(3, 0), tm)  # imports everything before the measurement
    text = programs.lines(count)
    begun, cpu = time.perf_counter(), time.process_time()
    planned = _planned(text, tm)
    alone = time.perf_counter() - begun
    q, _, _ = planned.sample(np.arange(0.0, planned.duration, tm * 1e-3))
    seconds, cpu = time.perf_counter() - begun, time.process_time() - cpu
    return {"seconds": seconds, "cpu": cpu, "planning": alone, "samples": len(q)}


def measure_task(count: int, tm: float) -> dict[str, Any]:
    """Return the lines as poses of {TCP}, with our joint positions for comparison."""
    plan = _planned(programs.lines(count), tm)
    motions = plan.motions[1:]
    samples = round(1000.0 / tm)
    path: Any = motions[0].path
    s = load_profile("LSPB").law(path, bounds_of(plan.robot)).pure(np.arange(1, samples + 1) / samples)
    lines: list[Any] = [motion.path.frame for motion in motions]  # type: ignore[attr-defined]
    return {
        "urdf": str(stdlib_folder() / "robots" / "industrial6" / "industrial6.urdf"),
        "tool": motions[0].path.flange_from_moving.tolist(),  # type: ignore[attr-defined]
        "start": motions[0].path.start.tolist(),
        "poses": [line.poses(np.array([0.0, 1.0])).tolist() for line in lines],
        "s": s.tolist(),
        "joints": np.concatenate([motion.path.joints(s) for motion in motions]).tolist(),
    }


def measure_edits(count: int, tm: float) -> dict[str, float]:
    """Return the seconds on a core of the first analysis of a program, of an analysis after an edit in its
    last tenth, and of a quick one; medians of 10 edits.
    """
    from incremental import edited

    analyst, here = Analyst(inputs.Options(tm=tm)), Path.cwd()
    lines = programs.lines(count).split("\n")
    _planned(programs.lines(3, 0), tm)  # imports everything before the measurement
    times: dict[str, list[float]] = {"first": [], "planned": [], "quick": []}

    def look(what: str, source: SourceFile) -> None:
        begun = time.process_time()
        analyst.analyse(source, here, quick=what == "quick")
        times[what].append(time.process_time() - begun)

    look("first", SourceFile("lines.yarc", "\n".join(lines)))
    for number in range(10):
        look("planned", edited(lines, 3 + int(count * (0.9 + 0.01 * number)), 0.1))
    for number in range(10):
        look("quick", edited(lines, 3 + count * number // 10, 0.1))
    return {what: statistics.median(found) for what, found in times.items()}


def measure_collisions(_count: int, _tm: float) -> dict[str, float]:
    """Return the seconds of compiling an example without the collision check, and of the check."""
    from collision import CELL, EXAMPLE, palletising

    from yarclang.cell.description import Names, read_cell
    from yarclang.robot.description import load_robot
    from yarclang.semantics.declared.meanings import is_word

    names = Names(is_word, _value(load_robot("INDUSTRIAL6")))
    without, _, check = palletising(_value(read_cell(SourceFile("cell.toml", CELL), EXAMPLE.parent, names)))
    return {"without": without / 1e3, "check": check / 1e3}


def _opened(text: str, tm: float) -> inputs.Opened:
    opened = inputs.open_source(SourceFile("benchmark.yarc", text), Path.cwd(), inputs.Options(tm=tm))
    return _value(opened)


def _planned(text: str, tm: float) -> MotionPlan:
    opened = _opened(text, tm)
    return _value(stages.plan_module(opened.module, opened.request))


def _compiled(text: str, tm: float) -> stages.Compiled:
    opened = _opened(text, tm)
    return _value(stages.compile_module(opened.module, opened.request))


def _value(result: Any) -> Any:
    if result.value is None:
        raise SystemExit("\n".join(f"{one.code} {one.message}" for one in result.diagnostics[:5]))
    return result.value


def _timed(work: Callable[..., Any], name: str, times: dict[str, Times]) -> Callable[..., Any]:
    """Return `work` with its times added to those of `name`."""

    def run(*arguments: Any) -> Any:
        begun, cpu = time.perf_counter(), time.process_time()
        result = work(*arguments)
        had = times.get(name, {"seconds": 0.0, "cpu": 0.0})
        times[name] = {
            "seconds": had["seconds"] + time.perf_counter() - begun,
            "cpu": had["cpu"] + time.process_time() - cpu,
        }
        return result

    return run


if __name__ == "__main__":
    main()
