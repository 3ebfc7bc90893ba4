"""Measure the main ratios: `python benchmarks/ratios.py`, in an environment with yarclang.

The two sides of each ratio are measured alternately in one run, so that fast and slow machines give the same
ratio. Whole processes are measured by the clock, work inside a process on a core; the shortest times count.
The table shows each ratio, its goal, and the recorded ratio of `ratios.toml`. If a ratio misses its goal, or
is worse than recorded, a warning is printed, but the exit status is 0; it is nonzero only if something
couldn't be measured. `--record` writes the measured ratios to `ratios.toml` and to the table in RESULTS.md.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import tempfile
import time
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from measure import by_turns, process

HERE = Path(__file__).parent
RECORD = HERE / "ratios.toml"
RESULTS = HERE / "RESULTS.md"
EXAMPLES = HERE.parent / "examples"
LISTING4 = str(EXAMPLES / "01_listing4.yarc")
WORSE = 0.2
"""Share by which a ratio may be worse than the recorded one, because of other load on the machine."""

TM = "5"
LINES, PEER_LINES, EDITED = "200", "30", "300"
FEW, MANY = 10, 400

Run = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Ratio:
    """A ratio of the record.

    Attributes:
        name: its key.
        what: the two sides, in words.
        goal: the bound.
        grows: True if the ratio must be at least the goal; False if it must be at most the goal.
        last: the recorded ratio.
    """

    name: str
    what: str
    goal: float
    grows: bool
    last: float

    @property
    def bound(self) -> str:
        """The goal in words."""
        return f"at {'least' if self.grows else 'most'} {self.goal:g}"

    def warning(self, found: float) -> str:
        """Return the warning on a measured ratio; empty if there is none."""
        sign = -1.0 if self.grows else 1.0
        if sign * (found - self.goal) > 0.0:
            return f"{self.what}: {found:.3g}, the goal is {self.bound}"
        if sign * (found - self.last) > WORSE * self.last:
            return f"{self.what}: {found:.3g}, {self.last:.3g} was recorded last"
        return ""


def read_record() -> tuple[str, tuple[Ratio, ...]]:
    """Read `ratios.toml`.

    Returns:
        Time and place of the measurement, and the ratios.
    """
    data = tomllib.loads(RECORD.read_text(encoding="utf-8"))
    return data["measured"], tuple(
        Ratio(name, one["what"], one.get("at_least", one.get("at_most")), "at_least" in one, one["last"])
        for name, one in data["ratios"].items()
    )


def record_text(measured: str, ratios: tuple[Ratio, ...]) -> str:
    """Return the text of `ratios.toml`."""
    rows = [
        "# The main ratios as they were measured last; benchmarks/ratios.py reads and writes this file.",
        "",
    ]
    rows += [f"measured = {json.dumps(measured)}"]
    for one in ratios:
        bound = "at_least" if one.grows else "at_most"
        rows += ["", f"[ratios.{one.name}]", f"what = {json.dumps(one.what)}"]
        rows += [f"{bound} = {one.goal:g}", f"last = {one.last:.3g}"]
    return "\n".join(rows) + "\n"


def table(measured: str, ratios: tuple[Ratio, ...]) -> str:
    """Return the table of RESULTS.md."""
    rows = [f"`python benchmarks/ratios.py`, {measured}.", "", "| ratio | last | goal |", "|---|---|---|"]
    rows += [f"| {one.what} | {one.last:.3g} | {one.bound} |" for one in ratios]
    return "\n".join(rows)


def with_table(results: str, measured: str, ratios: tuple[Ratio, ...]) -> str:
    """Return the text of RESULTS.md with a new table."""
    begin, end = "<!-- ratios -->", "<!-- /ratios -->"
    made = f"{begin}\n{table(measured, ratios)}\n{end}"
    return re.sub(f"{begin}.*?{end}", lambda _: made, results, count=1, flags=re.DOTALL)


def main() -> None:
    """Measure all ratios, print the table, and warn."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=3, help="of long work; three times as many of short")
    parser.add_argument("--record", metavar="WHERE", help="record what is measured: the machine, in words")
    options = parser.parse_args()
    begun = time.monotonic()
    _, ratios = read_record()
    found: dict[str, float] = {}
    for measure in (startup, planning, editing, stages, collisions, cost):
        found |= measure(options.rounds)
    assert set(found) == {one.name for one in ratios}, "ratios.toml has other ratios than are measured"
    print("| ratio | measured | last | goal |\n|---|---|---|---|")
    for one in ratios:
        print(f"| {one.what} | {found[one.name]:.3g} | {one.last:.3g} | {one.bound} |")
    print(f"{time.monotonic() - begun:.0f} s")
    for text in filter(None, (one.warning(found[one.name]) for one in ratios)):
        print(f"warning: {text}")
    if options.record:
        measured = f"{time.strftime('%Y-%m-%d', time.gmtime())}, {options.record}"
        new = tuple(Ratio(one.name, one.what, one.goal, one.grows, found[one.name]) for one in ratios)
        RECORD.write_text(record_text(measured, new), encoding="utf-8")
        text = RESULTS.read_text(encoding="utf-8")
        RESULTS.write_text(with_table(text, *read_record()), encoding="utf-8")


def startup(rounds: int) -> dict[str, float]:
    """Measure whole short processes against the imports that they need."""
    with tempfile.TemporaryDirectory() as folder:
        robot = ("--robot", "INDUSTRIAL6")
        tasks = {
            "imports": _python("import pinocchio, scipy.linalg"),
            "compile_listing4": _door("yarcc", *robot, "-o", f"{folder}/out.pmc", LISTING4),
            "check_listing4": _door("yarc", "check", *robot, LISTING4),
            "click": _python("import click"),
            "help": _door("yarcc", "--help"),
            "fmt_listing4": _door("yarc", "fmt", "--check", LISTING4),
        }
        runs = by_turns(tasks, 3 * rounds)
    heavy, light = runs["imports"], runs["click"]
    return {
        "compile_listing4": _times(runs["compile_listing4"], heavy, "seconds"),
        "check_listing4": _times(runs["check_listing4"], heavy, "seconds"),
        "help": _times(runs["help"], light, "seconds"),
        "fmt_listing4": _times(runs["fmt_listing4"], light, "seconds"),
    }


def planning(rounds: int) -> dict[str, float]:
    """Measure straight lines from text to joint samples, and a loop over pin that solves their poses; both
    for each sample.
    """
    with tempfile.TemporaryDirectory() as folder:
        task = Path(folder, "task.json")
        task.write_text(json.dumps(_inside("task", PEER_LINES, TM)), encoding="utf-8")
        peer = partial(_script, "peer_pin.py", str(task))
        runs = by_turns({"ours": partial(_inside, "plan", LINES, TM), "pin": peer}, rounds, warm=False)
    each = {name: [{"cpu": one["cpu"] / one["samples"]} for one in done] for name, done in runs.items()}
    return {"planning": _times(each["pin"], each["ours"])}


def editing(rounds: int) -> dict[str, float]:
    """Measure analyses of an edited program against its first analysis."""
    runs = [_inside("edits", EDITED, TM) for _ in range(rounds)]
    first = _least(runs, "first")
    return {"edit_planned": _least(runs, "planned") / first, "edit_quick": _least(runs, "quick") / first}


def stages(rounds: int) -> dict[str, float]:
    """Measure the certificate against planning, in one compilation."""
    runs = [_inside("stages", LINES, TM)["stages"] for _ in range(rounds)]
    return {"certificate": _times([one["certify"] for one in runs], [one["plan"] for one in runs])}


def collisions(rounds: int) -> dict[str, float]:
    """Measure the collision check against compiling without it."""
    runs = [_inside("collisions", "0", "0") for _ in range(max(1, rounds - 1))]
    return {"collisions": _least(runs, "check") / _least(runs, "without")}


def cost(rounds: int) -> dict[str, float]:
    """Measure a command of a long program against a command of a short one."""
    tasks = {str(count): partial(_inside, "cost", str(count), "50", "lines") for count in (FEW, MANY)}
    runs = by_turns(tasks, max(1, rounds - 1), warm=False)
    return {"cost": _times(runs[str(MANY)], runs[str(FEW)]) * FEW / MANY}


def _times(runs: list[Run], others: list[Run], key: str = "cpu") -> float:
    """Return the ratio of the shortest times of both sides. The shortest are used because other load only
    makes times longer.
    """
    return _least(runs, key) / _least(others, key)


def _least(runs: list[Run], key: str) -> float:
    return min(one[key] for one in runs)


def _python(code: str) -> Callable[[], Run]:
    return partial(_whole, sys.executable, "-c", code)


def _door(name: str, *words: str) -> Callable[[], Run]:
    return partial(_whole, str(Path(sys.executable).with_name(name)), *words)


def _whole(*command: str) -> Run:
    return {"seconds": process(*command).seconds}


def _inside(what: str, *words: str) -> Any:
    return _script("inside.py", what, *words)


def _script(name: str, *words: str) -> Any:
    return json.loads(process(sys.executable, str(HERE / name), *words).output)


if __name__ == "__main__":
    main()
