"""Read the messages in the log of a run: reports, samples as rows of numbers, and the robot."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from yarclang.frozen import frozen
from yarclang.robot.controller import Controller
from yarclang.robot.kinds import DEFAULT, kind_of
from yarclang.robot.model import Array
from yarclang.runtime.notices import Changed, Progress, Remark
from yarclang.runtime.outcome import Where
from yarclang.runtime.signals import InputChanged, OutputSet, Signal, WaitBegan, WaitEnded
from yarclang.runtime.state import State
from yarclang.units import DEG, MM

_UNITS = {"deg": DEG, "mm": MM}


@frozen(eq=False)
class RecordedRobot:
    """The robot as the log of a run describes it.

    Attributes:
        lower: (n,) lower limits of the joints [rad or m]; infinite if there is none.
        upper: (n,) upper limits of the joints [rad or m]; infinite if there is none.
    """

    name: str
    fingerprint: str
    joint_names: tuple[str, ...]
    axis_unit_names: tuple[str, ...]
    lower: Array
    upper: Array
    controller: Controller

    @property
    def axis_units(self) -> Array:
        """Axis unit of each joint in SI (n,)."""
        return np.array([_UNITS[name] for name in self.axis_unit_names])


@frozen
class Pass:
    """The beginning of a job's execution, as a log reports it.

    Attributes:
        time: time of the beginning [s].
        job: name of the job.
        duration: duration of the job [s].
        of_program: True for the program or a part of it; False for the motion to its start.
    """

    time: float
    job: str
    duration: float
    of_program: bool


@frozen(eq=False)
class Outcome:
    """Outcome of the run, with the fields of `yarclang.runtime.outcome.Ended`."""

    time: float
    well: bool
    what: str
    remedy: str
    command: str
    done: float
    code: str = ""
    where: Where | None = None


Told: TypeAlias = Changed | Progress | Remark | Signal | Pass | Outcome


@dataclass(slots=True)
class Messages:
    """Contents of the messages in the log of a run.

    Attributes:
        told: the run's reports of progress, remarks, signals, passes and its outcome, in order.
        rows: for each sample its time and program time [s], the actual and the commanded joints [deg or mm],
            and the following errors [counts].
        passes: number of the pass to which each sample belongs; -1 during the motion to the start.
        unread: number of invalid messages.
    """

    told: list[Told] = field(default_factory=list)
    rows: list[tuple[float, ...]] = field(default_factory=list)
    passes: list[int] = field(default_factory=list)
    unread: int = 0


def read_messages(robot: RecordedRobot, messages: Iterable[tuple[str, dict[str, Any]]]) -> Messages:
    """Convert a log's messages (topic and content) to `Messages`. Invalid messages are only counted."""
    read_so_far = Messages()
    number, on_the_way = 0, False
    begun = False
    for topic, content in messages:
        try:
            if topic == "positions":
                read_so_far.rows.append(_row(robot, content))
                read_so_far.passes.append(-1 if on_the_way else number)
            elif (report := _as_report(topic, content)) is not None:
                read_so_far.told.append(report)
                if isinstance(report, Remark):
                    number += report.begins_pass and begun and not on_the_way
                if isinstance(report, Pass):
                    number += report.of_program and begun
                    begun, on_the_way = begun or report.of_program, not report.of_program
        except (ValueError, KeyError, TypeError):
            read_so_far.unread += 1
    return read_so_far


def _row(robot: RecordedRobot, content: Mapping[str, Any]) -> tuple[float, ...]:
    """Convert a message with a sample of joint positions to a row of `Messages.rows`.

    Raises:
        ValueError, KeyError, TypeError: a value is missing or invalid.
    """
    keys = [f"{name}_{unit}" for name, unit in zip(robot.joint_names, robot.axis_unit_names, strict=True)]
    actual, commanded = content["actual_joints"], content["commanded_joints"]
    row = (
        content["time_s"],
        content["program_time_s"],
        *(actual[key] for key in keys),
        *(commanded[key] for key in keys),
        *content["following_error_counts"],
    )
    if len(row) != 2 + 3 * len(keys):
        raise ValueError("a motor is missing")
    return tuple(float(value) for value in row)


def _as_report(topic: str, content: Mapping[str, Any]) -> Told | None:
    """Return a message as a report; None for an unknown topic."""
    time = float(content["time_s"])
    match topic:
        case "state":
            return Changed(time, State(content["state"]), content["why"])
        case "progress":
            return Progress(
                time, content["done_s"], content["left_s"], content["command"], content["source_line"]
            )
        case "events":
            text = f"ordered: {content['text']}" if content["kind"] == "order" else content["text"]
            return Remark(time, text, content["kind"] == "warning", content["kind"] == "pass")
        case "signals":
            return _signal(time, content)
        case "jobs":
            return Pass(time, content["job"], float(content["duration_s"]), bool(content["of_program"]))
        case "outcome":
            return Outcome(
                time,
                content["well"],
                content["what"],
                content["remedy"],
                content["command"],
                content["done_s"],
                # older logs have neither a code nor a place
                content.get("code", ""),
                Where(**content["where"]) if content.get("where") else None,
            )
        case _:
            return None


def _signal(time: float, content: Mapping[str, Any]) -> Signal | None:
    """Convert a message of a log to a report about inputs and outputs; None for a message of another kind.

    Raises:
        ValueError, KeyError, TypeError: a value is missing or invalid.
    """
    name, variable, value = str(content["name"]), str(content["variable"]), float(content["value"])
    match content["kind"]:
        case "set":
            return OutputSet(time, name, variable, value)
        case "input":
            return InputChanged(time, name, variable, value, str(content["cause"]))
        case "wait began":
            return WaitBegan(time, str(content["place"]), name, variable, float(content["wanted"]), value)
        case "wait ended":
            waited, met = float(content["waited"]), bool(content["met"])
            return WaitEnded(time, str(content["place"]), name, variable, value, waited, met)
        case _:
            return None


def read_robot(facts: Mapping[str, str], job: Mapping[str, Any]) -> RecordedRobot:
    """Return the robot that the metadata and the job in a log describe.

    Raises:
        ValueError, KeyError, TypeError: a value is missing or invalid.
    """
    joints = job["joints"]
    units = tuple(joint["unit"] for joint in joints)
    pairs = [joint["limits"] for joint in joints]
    scale = np.array([_UNITS[unit] for unit in units])
    lower = np.array([-np.inf if low is None else low for low, _ in pairs], dtype=np.float64)
    upper = np.array([np.inf if high is None else high for _, high in pairs], dtype=np.float64)
    said: dict[str, Any] = job["controller"]
    controller: dict[str, Any] = {
        key: tuple(value) if isinstance(value, list) else value for key, value in said.items()
    }
    return RecordedRobot(
        name=facts["robot"],
        fingerprint=facts["fingerprint"],
        joint_names=tuple(joint["name"] for joint in joints),
        axis_unit_names=units,
        lower=read_only(lower * scale),
        upper=read_only(upper * scale),
        controller=_restored(controller),
    )


def _restored(content: dict[str, Any]) -> Controller:
    kind = kind_of(str(content.get("kind", DEFAULT)))
    if kind is None:
        raise ValueError(f"there is no kind of controller {content['kind']!r}")
    return kind.restored(content)


def read_only(values: Array) -> Array:
    """Return an array after making it read-only."""
    values.setflags(write=False)
    return values
