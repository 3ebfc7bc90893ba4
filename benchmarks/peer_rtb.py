"""Solve the lines with roboticstoolbox-python: `python peer_rtb.py TASK TOL` prints seconds and results as
JSON.

For each line, the poses come from `ctraj`, and the joint positions from `ik_LM` (its C++ solver), started at
the previous sample. TOL is the tolerance of `ik_LM`: half of the squared error. The script runs without
yarclang, because the toolbox may be in a separate environment.
"""

from __future__ import annotations

import json
import re
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

warnings.simplefilter("ignore")

SHAPES = re.compile(r"<(visual|collision)>.*?</\1>", re.DOTALL)
"""Shapes, which are removed: the toolbox's URDF reader knows no capsules, and only joints are needed."""


def main() -> None:
    """Solve the task of the command line."""
    import roboticstoolbox as rtb
    from spatialmath import SE3

    task = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    tolerance = float(sys.argv[2])
    with tempfile.TemporaryDirectory() as folder:
        bare = Path(folder) / "robot.urdf"
        bare.write_text(SHAPES.sub("", Path(task["urdf"]).read_text(encoding="utf-8")), encoding="utf-8")
        robot = rtb.Robot.URDF(str(bare))
    chain = robot.ets(end="flange") * rtb.ET.SE3(np.array(task["tool"]))
    poses = [(SE3(first, check=False), SE3(last, check=False)) for first, last in np.array(task["poses"])]
    s, start = np.array(task["s"]), np.array(task["start"])
    begun, cpu = time.perf_counter(), time.process_time()
    found, failed = _solve(rtb.ctraj, chain, poses, s, start, tolerance)
    seconds, cpu = time.perf_counter() - begun, time.process_time() - cpu
    apart = float(np.abs(np.array(found) - np.array(task["joints"])).max())
    print(
        json.dumps(
            {
                "seconds": seconds,
                "cpu": cpu,
                "samples": len(found),
                "failed": failed,
                "apart": apart,
                "version": rtb.__version__,
            }
        )
    )


def _solve(ctraj: Any, chain: Any, poses: Any, s: Any, q: Any, tolerance: float) -> tuple[list[Any], int]:
    """Return joint positions at all samples, and the number of samples that weren't reached."""
    found, failed = [], 0
    for start, end in poses:
        for pose in ctraj(start, end, s=s):
            solution = chain.ik_LM(pose.A, q0=q, tol=tolerance)
            q = solution.q
            failed += not solution.success
            found.append(q)
    return found, failed


if __name__ == "__main__":
    main()
