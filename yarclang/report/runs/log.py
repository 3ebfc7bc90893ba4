"""Read the log of a run: the program, the reports, and the robot's positions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from yarclang.diagnostics import Diagnostic, Result
from yarclang.files import LARGEST_LOG, read_whole, reason_of
from yarclang.frozen import frozen
from yarclang.lasting import Lasting, known
from yarclang.report.runs.messages import Outcome, RecordedRobot, Told, read_messages, read_only, read_robot
from yarclang.report.runs.records import Records, read_records
from yarclang.robot.model import Array
from yarclang.runtime.job import JobCommand
from yarclang.runtime.log_record import CERTIFICATE, FORMAT, JOB, METADATA, PROGRAM, TEXT


@frozen(eq=False)
class RecordedRun:
    """A run as its log describes it. Times are in s of the controller's clock, from the log's start.

    Attributes:
        file: file that was read.
        program: name of the program for people.
        controller: address of the controller.
        version: version of yarclang that wrote the log.
        started: date and time in UTC, ISO 8601.
        pace: seconds of the controller per second of real time: 1, except for a simulator.
        robot: robot as the log describes it.
        commands: commands of the program, with their times in it.
        duration: sum of the times of all commands [s], those of both branches of each WHEN included.
        lasting: duration of a run of the program, in which only one branch of each WHEN is executed.
        counts_dwells: True if times of the program include dwells; False in older logs.
        text: controller text that was streamed.
        source: text of the program; may be empty.
        certificate: certificate as JSON; may be empty.
        told: all reports, in order.
        times: (N,) times of the samples [s].
        program_times: (N,) time of the program at each sample [s], accurate to one or two segments.
        passes: (N,) number of the program's `Pass` to which each sample belongs, from 0; -1 during the motion
            to the start.
        actual: (N, n) actual joint positions [rad or m].
        commanded: (N, n) commanded joint positions [rad or m].
        following: (N, n) following errors of the motors [counts].
        unread: number of damaged messages.
    """

    file: str
    program: str
    controller: str
    version: str
    started: str
    pace: float
    robot: RecordedRobot
    commands: tuple[JobCommand, ...]
    duration: float
    lasting: Lasting
    counts_dwells: bool
    text: str
    source: str
    certificate: str
    told: tuple[Told, ...]
    times: Array
    program_times: Array
    passes: NDArray[np.int64]
    actual: Array
    commanded: Array
    following: Array
    unread: int

    @property
    def outcome(self) -> Outcome | None:
        """Outcome of the run; None if the log has none."""
        return next((one for one in reversed(self.told) if isinstance(one, Outcome)), None)

    @property
    def end(self) -> float:
        """Time of the last known event or sample [s]."""
        last = self.told[-1].time if self.told else 0.0
        return max(last, float(self.times[-1])) if len(self.times) else last


def read_run(file: str) -> Result[RecordedRun]:
    """Read the log of a run, even if it is incomplete.

    Returns:
        None, with a finding, if the file can't be read or isn't a log that this version can read.
    """
    try:
        content = read_whole(Path(file), LARGEST_LOG)
    except OSError as error:
        reason = reason_of(error)
        return _refused("Y0107", f"{file} can't be read: {reason}", "check the path and its rights")
    logs = "logs are the .mcap files that `yarc run` writes, by default in yarc-runs/"
    records = read_records(content)
    if records is None:
        return _refused("Y1401", f"{file} {'is no MCAP file' if content else 'is empty'}", logs)
    facts, job = records.metadata.get(METADATA), records.attachments.get(JOB)
    if facts is None and not records.trouble:
        return _refused("Y1401", f"{file} is an MCAP file, but not a run log", logs)
    if facts is not None and facts.get("format") != FORMAT:
        version, wrote = facts.get("yarclang", "?"), facts.get("format", "?")
        message = (
            f"{file} was written by yarclang {version} in format {wrote}; this version reads format {FORMAT}"
        )
        return _refused("Y1403", message, f"read it with yarclang {version}")
    if facts is None or job is None or TEXT not in records.attachments:
        return _refused(
            "Y1401", f"{file} {records.trouble or 'has no program'}: it is cut off before the program", logs
        )
    try:
        run = _run(file, facts, json.loads(job), records)
    except (ValueError, KeyError, TypeError, AttributeError):
        return _refused("Y1401", f"{file} is damaged where it describes the program and the robot", logs)
    return Result(run, _doubts(file, records, run))


def _refused(code: str, message: str, help_: str) -> Result[RecordedRun]:
    return Result(None, (Diagnostic(code, message, help=help_),))


def _doubts(file: str, records: Records, run: RecordedRun) -> tuple[Diagnostic, ...]:
    """Return findings about unreliable data."""
    if records.trouble:
        message = f"{file} {records.trouble}; it is read up to {run.end:.3f} s"
    elif run.unread:
        message = f"{file} is damaged: {run.unread} of its messages can't be read"
    else:
        return ()
    return (Diagnostic("Y1402", message),)


def _run(file: str, facts: Mapping[str, str], job: Mapping[str, Any], records: Records) -> RecordedRun:
    robot = read_robot(facts, job)
    n = len(robot.joint_names)
    messages = read_messages(robot, records.messages)
    table = np.array(messages.rows, dtype=np.float64).reshape(len(messages.rows), 2 + 3 * n)
    text = {name: content.decode("utf-8", "replace") for name, content in records.attachments.items()}
    return RecordedRun(
        file=file,
        program=facts["program"],
        controller=facts["controller"],
        version=facts["yarclang"],
        started=facts["started"],
        pace=float(facts["pace"]),
        robot=robot,
        commands=tuple(_command(one) for one in job["commands"]),
        duration=float(job["duration_s"]),
        lasting=_lasting(job),
        counts_dwells="takes" in job,
        text=text[TEXT],
        source=text.get(PROGRAM, ""),
        certificate=text.get(CERTIFICATE, ""),
        told=tuple(messages.told),
        times=read_only(table[:, 0]),
        program_times=read_only(table[:, 1]),
        passes=np.array(messages.passes, dtype=np.int64),
        actual=read_only(table[:, 2 : 2 + n] * robot.axis_units),
        commanded=read_only(table[:, 2 + n : 2 + 2 * n] * robot.axis_units),
        following=read_only(table[:, 2 + 2 * n :]),
        unread=records.unread + messages.unread,
    )


def _lasting(job: Mapping[str, Any]) -> Lasting:
    """Return the program's duration. Older logs only have the time of its motions."""
    if "takes" not in job:
        return known(float(job["duration_s"]))
    takes = job["takes"]
    return Lasting(
        float(takes["duration_at_least_s"]),
        float(takes["duration_s"]),
        int(takes["waits_at_least"]),
        int(takes["waits"]),
        bool(takes.get("loops", False)),  # older logs have none
    )


def _command(message: Mapping[str, Any]) -> JobCommand:
    begins = float(message["begins_s"])
    # older logs have no clock: their times count the branches of a WHEN one after the other
    clock = float(message.get("clock_s", begins))
    return JobCommand(
        message["index"], message["name"], message["source_line"], begins, float(message["ends_s"]), clock
    )
