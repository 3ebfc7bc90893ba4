"""Measure the compiler's time and memory for splines through thousands of points.

python benchmarks/splines.py [COUNT ...] [--robot NAME] [--path weld|bead|pocket|spiral] [--joints]
[--turning] [--time TEXT]
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path

import measure
from toolpaths import CENTRES, PATHS, SPEED


def main() -> None:
    """Measure the task of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("counts", type=int, nargs="*", default=[1_000, 10_000, 100_000])
    parser.add_argument("--robot", default="INDUSTRIAL6", choices=sorted(CENTRES))
    parser.add_argument("--path", default="spiral", choices=sorted(PATHS))
    parser.add_argument("--joints", action="store_true", help="MOVEJ_SPLINE through the same poses")
    parser.add_argument("--turning", action="store_true", help="turn by 1 deg/mm, to and fro")
    parser.add_argument(
        "--time", help=f"what stands in the brackets: V {SPEED:g}, or 0.04 s a point with --joints"
    )
    asked = parser.parse_args()
    for count in asked.counts:
        time = asked.time or (f"{0.04 * count:g}" if asked.joints else f"V {SPEED:g}")
        command = "MOVEJ_SPLINE_RPY" if asked.joints else "MOVEL_SPLINE"
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "spline.yarc"
            file.write_text(text(asked.robot, asked.path, count, command, time, turning=asked.turning))
            done = measure.process("yarcc", str(file), "--robot", asked.robot, "--out-dir", folder)
        told = next((line for line in reversed(done.output.splitlines()) if "certified" in line), done.output)
        print(
            f"{command} {count} points [{time}]: {done.seconds:.1f} s, {done.cpu:.1f} s on a core, "
            f"{done.peak:.0f} MB; "
            f"{told[told.index(':') + 2 :]}"
        )


def text(robot: str, path: str, count: int, command: str, time: str, *, turning: bool) -> str:
    """Return a program of one spline through `count` points of a path."""
    pieces = PATHS[path]()
    points = [next(pieces) for _ in range(count + 1)]
    places, gone = [], 0.0
    for number, (a, b, c) in enumerate(points):
        gone += math.dist(points[max(number - 1, 0)], (a, b, c))
        turn = abs((gone + 10.0) % 40.0 - 20.0) if turning else 0.0
        x, y, z = (at + by for at, by in zip(CENTRES[robot], (a, b, c), strict=True))
        places.append(f"{x:.4f} {y:.4f} {z:.4f} {turn:.4f} 0 0")
    way = ";\n  ".join(places[1:])
    return (
        f"DEFAULT {{TCP}} [5] (mm,deg,s) {{B}}\nP0010 MOVEJ_RPY {places[0]}\nP0020 {command} {way} [{time}]\n"
    )


if __name__ == "__main__":
    main()
