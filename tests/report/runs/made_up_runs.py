"""Invented runs: a plan is executed as the test describes, and reported as a controller would report it."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import yarclang
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.jobs import Papers, job_of
from yarclang.robot.actuation import from_counts, to_counts
from yarclang.runtime.job import Job
from yarclang.runtime.log import RunLog
from yarclang.runtime.log_record import Anchor
from yarclang.runtime.notices import Changed, Notice, Progress
from yarclang.runtime.outcome import Ended
from yarclang.runtime.sample import Sample
from yarclang.runtime.state import State

ANCHOR = Anchor(5000.0, 1_790_000_000_000_000_000)
"""The start of all runs."""

EACH = 0.04
"""Time between two samples [s]."""

TURNING = """\
P0010 MOVEJ_LSPB 40 10 20 0 30 0 [3] (deg,s)
P0020 MOVEJ_LSPB 0 0 0 0 0 0 [4] (deg,s)
P0030 MOVEJ_LSPB 30 10 20 15 30 60 [2] (deg,s)
P0040 STOP
"""
"""A program whose second motion returns to the start."""


@cache
def made(
    text: str = TURNING, robot: str = "INDUSTRIAL6", name: str = "turning.yarc"
) -> tuple[Job, MotionPlan]:
    """Return a job and its plan."""
    compiled = yarclang.compile(text, robot=robot, name=name).value
    assert compiled is not None
    papers = Papers(text, json.dumps(compiled.certificate.to_json()))
    job = job_of(compiled.certificate, compiled.text, compiled.plan.robot, name, papers).value
    assert job is not None
    return job, compiled.plan


@dataclass(frozen=True, eq=False)
class Samples:
    """Reported samples of one pass, and the true values behind them: program times (N,), and the commanded
    joint positions (N, n) [rad or m].
    """

    notices: tuple[Notice, ...]
    times: np.ndarray
    commanded: np.ndarray


def samples(
    job: Job,
    plan: MotionPlan,
    rate: Callable[[np.ndarray], np.ndarray] = np.ones_like,
    *,
    length: float | None = None,
    begins: float = 0.1,
    seed: int = 0,
    off: np.ndarray | float = 0.0,
    left_out: tuple[float, float] | None = None,
) -> Samples:
    """Return the reported samples of a pass.

    Args:
        job: the executed job.
        plan: its plan.
        rate: the override at times of the clock, from the start of the pass.
        length: duration of the pass [s of the clock]; by default that of the program.
        begins: start of the pass [s from the log's start].
        seed: seed of the random errors of the program times.
        off: offset of the commanded joint positions [rad or m].
        left_out: start and end of the branch of a WHEN that isn't executed [s of the program].
    """
    chance = np.random.default_rng(seed)
    fine = np.arange(0.0, plan.duration if length is None else length, 1e-3)
    run = np.concatenate(([0.0], np.cumsum(rate(fine)[:-1]) * 1e-3))
    clock = np.arange(0.0, fine[-1], EACH) + chance.uniform(0.0, 2e-3)
    times = np.interp(clock, fine, run)
    if left_out is not None:
        times = np.where(times > left_out[0], times + left_out[1] - left_out[0], times)
    times = np.minimum(times, plan.duration)
    commanded = plan.sample(times)[0] + off
    later = plan.sample(np.minimum(times + 1e-3, plan.duration))[0]
    lag = (later - plan.sample(times)[0]) / 1e-3 * 5e-4  # the motors are half a millisecond behind
    actual = np.round(to_counts(job.robot, commanded - lag) * 32.0) / 32.0
    following = np.round(to_counts(job.robot, commanded) - actual, 1)
    # the reported program time comes from the buffer: whole segments, up to 50 ms old, with an error of one
    # segment in either direction
    told = np.maximum(times - chance.uniform(0.0, 0.05, len(times)), 0.0)
    told = np.clip(
        np.floor(told / job.segment) * job.segment + chance.integers(-1, 2, len(times)) * job.segment,
        0.0,
        None,
    )
    notices = tuple(
        Sample(ANCHOR.clock + begins + when, float(time), place, error)
        for when, time, place, error in zip(clock, told, actual, following, strict=True)
    )
    return Samples(notices, times, from_counts(job.robot, actual + following))


def write(
    path: Path, job: Job, told: Sequence[Notice | Job], ended: Ended | None = None, *, version: str = "0.1.0"
) -> Path:
    """Write a log of the notices, in the order of time. A job in the list means that this job begins."""
    with RunLog.open(path, job, "127.0.0.1:1025", version=version, anchor=ANCHOR) as log:
        for one in told:
            if isinstance(one, Job):
                log.begin(one)
            else:
                log.take(one)
        log.close(ended)
    assert log.failure is None
    return log.path


def whole(path: Path, job: Job, plan: MotionPlan, **execution: object) -> tuple[Path, Samples]:
    """Write the log of a run that comes to its end. Return its path and the samples."""
    seen = samples(job, plan, **execution)  # type: ignore[arg-type]
    first, last = seen.notices[0].time, seen.notices[-1].time
    told: list[Notice | Job] = [
        Changed(first - 0.1, State.STOP, ""),
        job,
        Changed(first - 0.05, State.INIT, f"loading {job.name}"),
        Changed(first, State.MOVE, ""),
    ]
    for number, sample in enumerate(seen.notices):
        if number % 6 == 0:
            told.append(progress(job, sample.time, seen.times[number]))
        told.append(sample)
    told.append(Changed(last + 0.05, State.STOP, f"at the end of {job.name}, to a count"))
    return write(path, job, told, Ended(True, joints=job.end, done=job.duration)), seen


def progress(job: Job, time: float, done: float) -> Progress:
    """Return the progress as the stream reports it."""
    command = job.command_at(done)
    title, line = (command.title, command.source_line) if command else ("", 0)
    return Progress(time, float(done), job.duration - float(done), title, line)
