"""Solve the lines in a loop over pin: `python peer_pin.py TASK` prints seconds and results as JSON.

For each sample, the pose is computed, and then solved by damped least squares, from the previous sample's
joint positions until the error is below 1e-9. The loop has no limits, no time law and no choice of a branch,
so that it is as fast as possible.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

TOLERANCE = 1e-9
"""Largest norm of the remaining twist [m, rad]."""

DAMPING = 1e-12


def main() -> None:
    """Solve the task of the command line."""
    task = json.loads(Path(sys.argv[1]).read_text(encoding="utf-8"))
    model = pin.buildModelFromUrdf(task["urdf"])
    flange = model.frames[model.getFrameId("flange")]
    placement = flange.placement * pin.SE3(np.array(task["tool"]))
    tool = model.addFrame(pin.Frame("tool", flange.parentJoint, placement, pin.FrameType.OP_FRAME))
    data = model.createData()
    poses, s = np.array(task["poses"]), np.array(task["s"])
    begun, cpu = time.perf_counter(), time.process_time()
    found, worst = _solve(model, data, tool, poses, s, np.array(task["start"]))
    seconds, cpu = time.perf_counter() - begun, time.process_time() - cpu
    apart = float(np.abs(found - np.array(task["joints"])).max())
    print(json.dumps({"seconds": seconds, "cpu": cpu, "samples": len(found), "error": worst, "apart": apart}))


def _solve(model: Any, data: Any, tool: int, poses: Any, s: Any, q: Any) -> tuple[Any, float]:
    """Return joint positions (N, n) at all samples, and the largest remaining error."""
    found = []
    worst = 0.0
    damping = DAMPING * np.eye(6)
    for first, last in poses:
        start, end = pin.SE3(first), pin.SE3(last)
        shift = end.translation - start.translation
        turn = pin.log3(end.rotation @ start.rotation.T)
        for share in s:
            target = pin.SE3(pin.exp3(share * turn) @ start.rotation, start.translation + share * shift)
            for _ in range(50):
                pin.forwardKinematics(model, data, q)
                error = pin.log6(pin.updateFramePlacement(model, data, tool).actInv(target)).vector
                size = np.linalg.norm(error)
                if size < TOLERANCE:
                    break
                jacobian = pin.computeFrameJacobian(model, data, q, tool, pin.LOCAL)
                q = q + jacobian.T @ np.linalg.solve(jacobian @ jacobian.T + damping, error)
            worst = max(worst, float(size))
            found.append(q)
    return np.array(found), worst


if __name__ == "__main__":
    main()
