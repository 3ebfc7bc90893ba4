"""Solve poses with other solvers, without a start value: `python peer_search.py SOLVER TASK` prints the
results as JSON.

SOLVER is `pin` (a loop over Pinocchio with damped steps and random restarts), `rtb` (the C++ `ik_LM` of
roboticstoolbox-python, with its own restarts and limits) or `eaik` (EAIK's analytic solver, for the arms that
it supports). The script runs without yarclang, because the solvers may be in separate environments. All
solvers get the same poses and limits; the caller judges the answers.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np

warnings.simplefilter("ignore")

RTB_TOLERANCE = 5e-19
"""Half of the squared error: 1e-9 m and rad."""


def main() -> None:
    """Solve the task of the command line."""
    solver, path = sys.argv[1:]
    task = json.loads(Path(path).read_text(encoding="utf-8"))
    for key in ("poses", "lower", "upper", "screws", "home"):
        task[key] = np.array(task[key], dtype=float)
    setup = {"pin": _pin, "rtb": _rtb, "eaik": _eaik}[solver](task)
    setup(task["poses"][0])  # the setup of the first call isn't timed
    begun, cpu = time.perf_counter(), time.process_time()
    found = [setup(pose) for pose in task["poses"]]
    seconds, cpu = time.perf_counter() - begun, time.process_time() - cpu
    print(json.dumps({"seconds": seconds, "cpu": cpu, "q": [np.atleast_2d(q).tolist() for q in found]}))


def _pin(task: dict[str, Any]) -> Any:
    import pinocchio as pin

    model = pin.buildModelFromXML(task["urdf"])
    others = [model.getJointId(name) for name in model.names[1:] if name not in task["joints"]]
    model = pin.buildReducedModel(model, others, pin.neutral(model))
    data = model.createData()
    tip = model.getFrameId(task["tip"])
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    base = data.oMf[model.getFrameId(task["base"])].copy()
    low = np.where(np.isfinite(task["lower"]), task["lower"], -np.pi)
    high = np.where(np.isfinite(task["upper"]), task["upper"], np.pi)
    random = np.random.default_rng(0)

    def full(q: Any) -> Any:
        # pin represents a continuous joint by cosine and sine
        parts = [
            [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
            for joint, value in zip(list(model.joints)[1:], q, strict=True)
        ]
        return np.concatenate(parts)

    def solve(pose: Any) -> Any:
        target = base * pin.SE3(pose)
        q = 0.5 * (low + high)
        for _ in range(100):
            for _ in range(30):
                pin.computeJointJacobians(model, data, full(q))
                error = pin.log6(pin.updateFramePlacement(model, data, tip).actInv(target)).vector
                size = np.linalg.norm(error)
                if size < 1e-9:
                    return q
                jacobian = pin.getFrameJacobian(model, data, tip, pin.LOCAL)
                damped = jacobian @ jacobian.T + (1e-12 + 0.01 * size * size) * np.eye(6)
                step = jacobian.T @ np.linalg.solve(damped, error)
                q = np.clip(q + step * min(1.0, 0.8 / max(np.abs(step).max(), 1e-9)), low, high)
            q = low + random.random(len(low)) * (high - low)
        return q

    return solve


def _rtb(task: dict[str, Any]) -> Any:
    import roboticstoolbox as rtb

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "robot.urdf"
        path.write_text(task["urdf"], encoding="utf-8")
        robot = rtb.Robot.URDF(str(path))
    chain = robot.ets(start=task["base"], end=task["tip"])
    low = np.where(np.isfinite(task["lower"]), task["lower"], -np.pi)
    high = np.where(np.isfinite(task["upper"]), task["upper"], np.pi)
    chain.qlim = np.array([low, high])
    # EAIK's chains begin at the parent of the base
    base = chain.eval(np.zeros(len(low))) @ np.linalg.inv(task["home"])
    return lambda pose: chain.ik_LM(base @ pose, tol=RTB_TOLERANCE, joint_limits=True).q


def _eaik(task: dict[str, Any]) -> Any:
    from eaik.pybindings.EAIK import Robot

    linear, axes = task["screws"][:, :3], task["screws"][:, 3:]
    points = np.cross(axes, linear)
    ends = np.vstack([np.zeros(3), points, task["home"][:3, 3]])
    robot = Robot(axes.T, np.diff(ends, axis=0).T, task["home"][:3, :3], [], True)
    turns = 2.0 * np.pi

    def solve(pose: Any) -> Any:
        q = np.array(robot.calculate_IK(pose).Q)
        # shift by full turns into the limits
        middle = 0.5 * (task["lower"] + task["upper"])
        middle = np.where(np.isfinite(middle), middle, 0.0)
        return q - turns * np.round((q - middle) / turns) if len(q) else np.zeros((1, len(axes)))

    return solve


if __name__ == "__main__":
    main()
