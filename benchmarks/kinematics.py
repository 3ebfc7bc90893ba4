"""Measure the inverse kinematics: `python benchmarks/kinematics.py`, in an environment with yarclang[dev].

Parts:

- `branches`: all solutions of the closed form, in batches;
- `solutions`: all solutions of other arms of six joints, in batches and alone; their number is compared with
  the solutions of all eliminations together, and with EAIK's;
- `spare`: the nearest solution of arms of seven joints;
- `search`: random reachable poses within limits, without a start value, compared with other solvers;
- `line`: planning of a MOVEL.

roboticstoolbox-python and EAIK may be installed in a separate environment; `--peer-python` or PEER_PYTHON
names its interpreter. Without it, they are left out.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import arms
import numpy as np
import programs
from measure import process

from tests.robot.kinematics import arms as made
from yarclang.robot.chain import joints_between, screws
from yarclang.robot.description import load_robot
from yarclang.robot.kinematics import (
    Solutions,
    branches,
    elimination,
    flange_poses,
    nearest_solutions,
    reaching,
)
from yarclang.robot.kinematics.search import span
from yarclang.robot.kinematics.within import nearest_turn
from yarclang.robot.model import Chain, Limits
from yarclang.robot.urdf import MOVING, read_urdf
from yarclang.source import SourceFile

COUNT, PEER_COUNT, SPARE_COUNT = 10_000, 1000, 300
BAXTER = "baxter_description/urdf/baxter.urdf"
TASKS = {
    # base, tip, and the other solvers that support this arm
    "UR5": ("base_link", "tool0", ("pin", "rtb", "eaik")),
    "Panda": ("panda_link0", "panda_link8", ("pin", "rtb")),
    "calibrated": ("base_link", "flange", ("pin", "rtb")),
    "Kinova": ("j2s6s200_link_base", "j2s6s200_end_effector", ("pin", "rtb", "eaik")),
}
ROUNDS = 15


def main() -> None:
    """Measure the requested parts."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"some of {', '.join(PARTS)}; default: all")
    parser.add_argument("--peer-python", default=os.environ.get("PEER_PYTHON", ""))
    options = parser.parse_args()
    for name in options.parts or PARTS:
        for row in PARTS[name](options):
            print(row, flush=True)


def _median(work: Callable[[], Any], rounds: int = ROUNDS) -> tuple[float, float]:
    """Return median and least wall time [s] of the rounds after a first one, which isn't counted."""
    work()
    times = []
    for _ in range(rounds):
        begun = time.perf_counter()
        work()
        times.append(time.perf_counter() - begun)
    return statistics.median(times), min(times)


def measure_branches(_: argparse.Namespace) -> Iterator[str]:
    """Measure all branches of the arm with a spherical wrist."""
    robot = load_robot("INDUSTRIAL6").value
    assert robot is not None
    yield "| all branches of INDUSTRIAL6, poses in a batch | median | least | goal |\n|---|---|---|---|"
    for count in (100, 1000, 10_000):
        poses = flange_poses(robot.chain, _draw(robot.chain, robot.limits, count))
        middle, least = (one / count * 1e6 for one in _median(partial(branches, robot.chain, poses)))
        yield f"| {count:,} | {middle:.2f} µs a pose | {least:.2f} µs | 3 µs |"


def measure_solutions(options: argparse.Namespace) -> Iterator[str]:
    """Measure all solutions of arms without a spherical wrist."""
    ours = {name: made.COBOTS[name] for name in made.COBOTS} | {"offset6": made.offset6()[0]}
    yield (
        "| all solutions (CPU time) | a pose in a batch | alone, with limits | most | goal "
        "|\n|---|---|---|---|---|"
    )
    high = np.full(6, math.pi)
    limits = made.limits_of(-high, high)
    for name, chain in ours.items():
        q = _draw(chain, limits, 500)
        poses = flange_poses(chain, q)
        branches(chain, poses[:2])
        begun = time.process_time()
        valid = branches(chain, poses)[1]
        batch = (time.process_time() - begun) / len(poses)
        begun = time.process_time()
        for pose, near in zip(poses[:50], q[:50], strict=True):
            nearest_solutions(chain, limits, pose, near)
        alone = (time.process_time() - begun) / 50
        goal = "20 µs, 0.5 ms" if name == "ur5" else "2 ms alone"
        yield f"| {name} | {batch * 1e6:.0f} µs | {alone * 1e3:.2f} ms | {valid.sum(axis=1).max()} | {goal} |"
    yield _random_arms()
    if options.peer_python:
        yield _beside_eaik(options.peer_python)


def measure_spare(_: argparse.Namespace) -> Iterator[str]:
    """Measure the nearest solution of redundant arms, from random joint positions within limits, and from
    nearby joint positions.
    """
    ours = {name: made.seven(name) for name in made.SEVEN}
    six = np.radians([170, 135, 150, 190, 130, 360])
    ours["INDUSTRIAL6 on a rail"] = made.on_rail(made.industrial6()[0], six)
    ours["UR5 on a rail"] = made.on_rail(made.COBOTS["ur5"], np.full(6, 2.0 * math.pi))
    ours |= {"YuMi": made.yumi7(), "Baxter": _baxter(), "Sawyer": made.sawyer7()}
    ours |= {"Panda on a rail": _on_rail(made.seven("panda")), "Panda on a base": made.on_base(1.0)}
    yield (
        "| nearest solution (CPU time) | median | 95 % | from nearby, median | solved | goal "
        "|\n|---|---|---|---|---|---|"
    )
    for name, (chain, limits) in ours.items():
        count = COUNT if name == "panda" else PEER_COUNT if name in made.SEVEN else SPARE_COUNT
        q = _draw(chain, limits, count)
        nearby = np.clip(q + np.random.default_rng(3).normal(0.0, 0.1, q.shape), limits.lower, limits.upper)
        poses, away = flange_poses(chain, q), _draw(chain, limits, count)[::-1]
        times, solved = {"away": [], "nearby": []}, 0
        for number, pose in enumerate(poses):
            found = {}
            for key, references in (("away", away), ("nearby", nearby)):
                begun = time.process_time()
                found[key] = nearest_solutions(chain, limits, pose, references[number], is_only=True)
                times[key].append(time.process_time() - begun)
            solved += all(
                isinstance(one, Solutions) and bool(np.abs(flange_poses(chain, one.q) - pose).max() < 1e-8)
                for one in found.values()
            )
        middle, most = 1e3 * statistics.median(times["away"]), 1e3 * float(np.percentile(times["away"], 95))
        near = 1e3 * statistics.median(times["nearby"])
        yield f"| {name} | {middle:.2f} ms | {most:.2f} ms | {near:.2f} ms | {solved:,} of {count:,} | 2 ms |"


def _on_rail(arm: tuple[Chain, Limits]) -> tuple[Chain, Limits]:
    """Return an arm on a rail of 2 m."""
    chain, limits = arm
    on_rail, _ = made.on_rail(chain, limits.upper)
    return on_rail, made.limits_of(np.r_[-1.0, limits.lower], np.r_[1.0, limits.upper])


def _baxter() -> tuple[Chain, Limits]:
    """Return the right arm of Baxter, from its URDF."""
    text = arms.MIMICS.sub("", arms.SHAPES.sub("", (arms.DATA / BAXTER).read_text(encoding="utf-8-sig")))
    chain, limits, _ = _arm(text, "torso", "right_hand_link", "Baxter")
    return chain, limits


def _random_arms(count: int = 1000) -> str:
    """Compare the numbers of solutions with those that all eliminations together find, on random arms."""
    random = np.random.default_rng(0)
    total = fewer = 0
    for _ in range(count):
        chain = made.random6(random)
        poses = flange_poses(chain, random.uniform(-3.0, 3.0, (1, 6)))
        own = int(branches(chain, poses)[1].sum())
        found = [
            elimination.candidates(elimination._elimination(chain, order), poses)[1] for order in range(6)
        ]
        every = np.concatenate(found)
        most = int(elimination.distinct(chain, poses, np.zeros(len(every), dtype=int), every)[1].sum())
        total, fewer = total + most, fewer + max(most - own, 0)
    return f"\n{count:,} arms by chance: {fewer} of {total:,} solutions missed"


def _beside_eaik(python: str) -> str:
    """Compare the number of solutions of a UR5 with EAIK's, each checked by forward kinematics."""
    base, tip, _ = TASKS["UR5"]
    text = arms.urdf("UR5")
    chain, limits, joints = _arm(text, base, tip, "UR5")
    poses = flange_poses(chain, _draw(chain, limits, PEER_COUNT))
    task = {
        "urdf": text,
        "base": base,
        "tip": tip,
        "joints": joints,
        "poses": poses.tolist(),
        "lower": limits.lower.tolist(),
        "upper": limits.upper.tolist(),
        "screws": chain.screws.tolist(),
        "home": chain.base_from_flange.tolist(),
    }
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "task.json")
        path.write_text(json.dumps(task), encoding="utf-8")
        answer = process(python, str(Path(__file__).with_name("peer_search.py")), "eaik", str(path))
    found = json.loads(answer.output)
    own = branches(chain, poses)[1].sum(axis=1)
    others = []
    for pose, rows in zip(poses, found["q"], strict=True):
        q = np.array(rows)
        good = np.abs(flange_poses(chain, q) - pose).max(axis=(1, 2)) < 1e-8
        zeros = np.zeros(int(good.sum()), dtype=int)
        others.append(int(elimination.distinct(chain, pose[None], zeros, q[good])[1].sum()))
    fewer = int((own < others).sum())
    return (
        f"UR5, {len(poses):,} poses: {own.sum():,} solutions, EAIK {sum(others):,} in "
        f"{found['cpu'] / len(poses) * 1e6:.0f} µs a pose; "
        f"fewer than EAIK at {fewer}, more at {int((own > others).sum())}"
    )


def measure_search(options: argparse.Namespace) -> Iterator[str]:
    """Measure random reachable poses within limits."""
    yield "| random reachable poses | solved within limits | a pose | goal |\n|---|---|---|---|"
    for name, (base, tip, peers) in TASKS.items():
        text = arms.urdf(name)
        chain, limits, joints = _arm(text, base, tip, name)
        poses = flange_poses(chain, _draw(chain, limits, COUNT))
        reaching(chain, limits, poses[:100])
        begun = time.perf_counter()
        q, _ = reaching(chain, limits, poses)
        seconds = time.perf_counter() - begun
        share = _solved(chain, limits, poses, q[:, None])
        yield f"| {name}: ours | {share * 100:.2f} % of {COUNT:,} | {seconds / COUNT * 1e6:.0f} µs | 99.9 % |"
        task = {
            "urdf": text,
            "base": base,
            "tip": tip,
            "joints": joints,
            "poses": poses[:PEER_COUNT].tolist(),
            "lower": limits.lower.tolist(),
            "upper": limits.upper.tolist(),
            "screws": chain.screws.tolist(),
            "home": chain.base_from_flange.tolist(),
        }
        for peer in peers:
            python = sys.executable if peer == "pin" else options.peer_python
            if python:
                yield _peer(name, peer, python, task, chain, limits, poses[:PEER_COUNT])


def _peer(name: str, peer: str, python: str, task: Any, chain: Chain, limits: Limits, poses: Any) -> str:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "task.json")
        path.write_text(json.dumps(task), encoding="utf-8")
        made = process(python, str(Path(__file__).with_name("peer_search.py")), peer, str(path))
    found = json.loads(made.output)
    most = max(len(rows) for rows in found["q"])
    q = np.array([rows + rows[:1] * (most - len(rows)) for rows in found["q"]])
    low, high = span(chain, limits)
    q = nearest_turn(chain, limits, q, 0.5 * (low + high))  # full turns don't count as errors
    share = _solved(chain, limits, poses, q)
    return (
        f"| {name}: {peer} | {share * 100:.2f} % of {len(poses):,} | "
        f"{found['seconds'] / len(poses) * 1e6:.0f} µs | |"
    )


def measure_line(_: argparse.Namespace) -> Iterator[str]:
    """Measure MOVELs of 400 samples, from checked program to plan."""
    from yarclang.pipeline import inputs, stages

    text = programs.lines(100).replace("[1]", "[2]")
    opened = inputs.open_source(SourceFile("benchmark.yarc", text), Path.cwd(), inputs.Options(tm=5.0)).value
    assert opened is not None
    checked = stages.check_program(opened.module, opened.request).value
    assert checked is not None
    settings: list[Any] = []
    plan = stages.plan

    def kept(*arguments: Any) -> Any:
        settings[:] = arguments
        return plan(*arguments)

    stages.plan = kept
    stages.plan_module(opened.module, opened.request)
    stages.plan = plan
    planned = plan(*settings).value
    assert planned is not None
    counts = [motion.curve.segments for motion in planned.motions[1:]]
    middle, least = _median(lambda: plan(*settings))
    yield "| a checked program planned | median | least | goal |\n|---|---|---|---|"
    yield (
        f"| a MOVEL of {statistics.mean(counts):.0f} samples, one of {len(counts)} | "
        f"{middle / len(counts) * 1e3:.2f} ms | {least / len(counts) * 1e3:.2f} ms | 3 ms |"
    )


PARTS = {
    "branches": measure_branches,
    "solutions": measure_solutions,
    "spare": measure_spare,
    "search": measure_search,
    "line": measure_line,
}


def _arm(text: str, base: str, tip: str, name: str) -> tuple[Chain, Limits, list[str]]:
    """Return chain, position limits and joint names of a URDF's arm. The paper's robot has those of its
    robot.toml.
    """
    urdf = read_urdf(SourceFile("arm.urdf", text))
    joints = [joint for joint in joints_between(urdf, base, tip) or () if joint.kind in MOVING]
    chain = screws(urdf, base, tip, joints)
    assert chain is not None, urdf.findings
    ends = [
        (joint.lower, joint.upper) if joint.kind != "continuous" else (-np.inf, np.inf) for joint in joints
    ]
    lower, upper = (np.array([end[side] for end in ends], dtype=float) for side in (0, 1))
    if name == "calibrated":
        robot = load_robot("INDUSTRIAL6").value
        assert robot is not None
        lower, upper = robot.limits.lower, robot.limits.upper
    ones = np.ones(len(joints))
    return chain, Limits(lower, upper, ones, ones, ones, ones), [joint.name for joint in joints]


def _draw(chain: Chain, limits: Limits, count: int) -> Any:
    """Return random joint positions (count, n) within limits."""
    low, high = span(chain, limits)
    return low + np.random.default_rng(0).random((count, chain.size)) * (high - low)


def _solved(chain: Chain, limits: Limits, poses: Any, q: Any) -> float:
    """Return the share of poses that one of the answers (N, B, n) reaches within 1e-8 and limits."""
    stand = flange_poses(chain, q.reshape(-1, chain.size)).reshape(*q.shape[:2], 4, 4)
    good = np.abs(stand - poses[:, None]).max(axis=(2, 3)) < 1e-8
    good &= ((q >= limits.lower - 1e-8) & (q <= limits.upper + 1e-8)).all(axis=2)
    return float(good.any(axis=1).mean())


if __name__ == "__main__":
    main()
