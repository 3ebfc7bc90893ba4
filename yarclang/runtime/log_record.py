"""Content of a run's log: its attachments, its channels, and the conversion of notices to messages. No I/O.

The name of each number in a message ends in its unit. Times `time_s` are those of the notices' clock, counted
from the start of the log.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from typing import Any, TypeAlias, cast

import numpy as np
from mcap.writer import Writer

from yarclang.robot.actuation import from_counts
from yarclang.robot.model import Array, Robot
from yarclang.runtime.job import Job
from yarclang.runtime.log_scene import BODIES, EACH, TRANSFORMS, LoggedScene, scene_schemas
from yarclang.runtime.notices import Changed, Fail, Fill, Notice, Order, Override, Planned, Progress, Remark
from yarclang.runtime.outcome import Ended
from yarclang.runtime.sample import Sample
from yarclang.runtime.signals import InputChanged, OutputSet, WaitBegan, WaitEnded
from yarclang.runtime.values import values_text

FORMAT = "1"
"""Version of the messages' format. A log with another version can't be read with this module."""

METADATA = "yarc run"
PROGRAM, TEXT, CERTIFICATE, JOB = "program.yarc", "program.pmc", "certificate.json", "job.json"
"""Names of the log's attachments: the program, the controller text, the certificate, and facts about the
job.
"""

_DIGITS = 7
"""Decimals of joint positions [deg or mm] and of times [s] in the log. This resolution is far finer than an
encoder count, and than the duration of an exchange with the controller.
"""


@dataclass(frozen=True, slots=True)
class Anchor:
    """One instant on two clocks: `clock` [s] is that of the notices, `wall` [ns] is UTC since 1970.

    `pace` is the number of seconds on the notices' clock per second on the wall clock: 1, except for a
    simulator.
    """

    clock: float
    wall: int
    pace: float = 1.0

    def wall_at(self, clock: float) -> int:
        """Return the wall clock [ns] at a time of the notices' clock [s]."""
        return max(0, self.wall + round((clock - self.clock) / self.pace * 1e9))


@dataclass(frozen=True, slots=True)
class Begun:
    """Log entry: `job` is performed from now on."""

    job: Job


@dataclass(frozen=True, slots=True)
class Ordered:
    """Log entry: a person has given an order, at a time of the notices' clock [s]."""

    time: float
    order: Order


Item: TypeAlias = Notice | Begun | Ordered | Ended


class Record:
    """Writer of a log: converts notices of a run to MCAP messages."""

    def __init__(self, writer: Writer, job: Job, anchor: Anchor) -> None:
        self._writer = writer
        self._job = job
        self._anchor = anchor
        self._channels: dict[str, int] = {}
        self._last = anchor.clock
        self._planned = 0
        self._scene = LoggedScene(job.robot)
        self._shown = -math.inf

    def begin(self, facts: dict[str, str]) -> None:
        """Write the start of the log: the header, the metadata (facts about the run and its job), the
        attachments, and the channels.
        """
        writer, job, wall = self._writer, self._job, self._anchor.wall
        writer.start()
        facts = {
            "format": FORMAT,
            "program": job.name,
            "robot": job.robot.name,
            "fingerprint": job.robot.fingerprint,
            **facts,
        }
        writer.add_metadata(METADATA, {key: _clean(value) for key, value in facts.items()})
        for name, media_type, content in (
            (JOB, "application/json", json.dumps(_described(job))),
            (TEXT, "text/plain", job.text),
            (PROGRAM, "text/plain", job.source),
            (CERTIFICATE, "application/json", job.certificate),
        ):
            if content:
                writer.add_attachment(wall, wall, name, media_type, _clean(content).encode())
        motors = {"motors": " ".join(map(str, job.robot.controller.motors))}
        for topic, properties in _schemas(job.robot).items():
            schema = {"title": topic, "type": "object", "properties": {"time_s": _NUMBER, **properties}}
            schema_id = writer.register_schema(f"yarc.{topic}", "jsonschema", json.dumps(schema).encode())
            self._channels[topic] = writer.register_channel(f"/{topic}", "json", schema_id, motors)
        for topic, (name, schema) in scene_schemas().items():
            schema_id = writer.register_schema(name, "jsonschema", json.dumps(schema).encode())
            self._channels[topic] = writer.register_channel(f"/{topic}", "json", schema_id)
        bodies = self._scene.bodies(wall)
        if bodies["entities"]:
            self._add(BODIES, wall, bodies)

    def write(self, item: Item) -> None:
        """Write one message to the file's buffer; a flush brings it to the disk."""
        match item:
            case Sample():
                self._message("positions", item.time, self._positions(item))
                self._show(item)
            case Changed(time=moment, state=state, why=why):
                self._message("state", moment, {"state": state.value, "why": why})
            case Progress(time=moment):
                content = {"done_s": item.done, "left_s": item.left, "command": item.command}
                self._message("progress", moment, content | {"source_line": item.source_line})
            case Remark(time=moment, text=text):
                kind = "warning" if item.warning else "pass" if item.begins_pass else "remark"
                self._message("events", moment, {"kind": kind, "text": text})
            case OutputSet() | WaitBegan() | WaitEnded() | InputChanged():
                content = {"kind": _KINDS[type(item)], **asdict(item)}
                del content["time"]
                self._message("signals", item.time, content)
            case Planned(text=text, certificate=certificate, kind=kind):
                self._planned += 1
                number, wall = self._planned, self._anchor.wall_at(item.time)
                for name, media_type, said in (
                    (f"{kind}-{number}.pmc", "text/plain", text),
                    (f"{kind}-{number}.json", "application/json", certificate),
                ):
                    self._writer.add_attachment(wall, wall, name, media_type, _clean(said).encode())
            case Ordered(time=moment, order=order):
                self._message("events", moment, {"kind": "order", "text": _order_text(order)})
            case Begun(job=job):
                self._message("jobs", self._last, self._begun(job))
            case Ended():
                self._message("outcome", self._last, self._outcome(item))

    def _show(self, sample: Sample) -> None:
        """Write the robot's frames, unless they were written less than `EACH` ago."""
        if not 0.0 <= sample.time - self._shown < EACH:
            self._shown = sample.time
            wall = self._anchor.wall_at(sample.time)
            (q,) = from_counts(self._job.robot, sample.actual[None])
            if np.isfinite(q).all():
                self._add(TRANSFORMS, wall, self._scene.transforms(wall, q))

    def _message(self, topic: str, moment: float, content: dict[str, Any]) -> None:
        self._last = moment
        wall = self._anchor.wall_at(moment)
        self._add(topic, wall, {"time_s": round(moment - self._anchor.clock, _DIGITS), **content})

    def _add(self, topic: str, wall: int, content: dict[str, Any]) -> None:
        self._writer.add_message(self._channels[topic], wall, json.dumps(content).encode(), wall)

    def _positions(self, sample: Sample) -> dict[str, Any]:
        robot = self._job.robot
        actual, commanded = from_counts(robot, np.stack((sample.actual, sample.commanded)))
        return {
            "program_time_s": sample.program_time,
            "actual_counts": sample.actual.tolist(),
            "following_error_counts": sample.following.tolist(),
            "commanded_counts": np.round(sample.commanded, 4).tolist(),
            "actual_joints": _by_joint(robot, actual),
            "commanded_joints": _by_joint(robot, commanded),
        }

    def _begun(self, job: Job) -> dict[str, Any]:
        # An approach has a name and a source of its own; a part of the program has those of the program.
        belongs = (job.name, job.source) == (self._job.name, self._job.source)
        return {
            "job": job.name,
            "offset_s": job.offset,
            "duration_s": job.duration,
            "of_program": belongs,
        }

    def _outcome(self, ended: Ended) -> dict[str, Any]:
        joints = None if ended.joints is None else _by_joint(self._job.robot, ended.joints)
        return {
            "well": ended.well,
            "what": ended.what,
            "remedy": ended.remedy,
            "command": ended.command,
            "done_s": ended.done,
            "joints": joints,
            "code": ended.code,
            "where": None if ended.where is None else asdict(ended.where),
        }


_KINDS: dict[type, str] = {
    OutputSet: "set",
    WaitBegan: "wait began",
    WaitEnded: "wait ended",
    InputChanged: "input",
}
_NUMBER, _TEXT, _TRUTH = {"type": "number"}, {"type": "string"}, {"type": "boolean"}
_COUNTS = {"type": "array", "items": _NUMBER}


def _schemas(robot: Robot) -> dict[str, dict[str, Any]]:
    """Return the JSON properties of the messages of each topic, by topic."""
    joints = {"type": "object", "properties": dict.fromkeys(_joint_keys(robot), _NUMBER)}
    return {
        "positions": {
            "program_time_s": _NUMBER,
            "actual_counts": _COUNTS,
            "following_error_counts": _COUNTS,
            "commanded_counts": _COUNTS,
            "actual_joints": joints,
            "commanded_joints": joints,
        },
        "state": {"state": _TEXT, "why": _TEXT},
        "progress": {"done_s": _NUMBER, "left_s": _NUMBER, "command": _TEXT, "source_line": _NUMBER},
        "events": {"kind": {"enum": ["remark", "warning", "order"]}, "text": _TEXT},
        "signals": {
            "kind": {"enum": list(_KINDS.values())},
            "name": _TEXT,
            "variable": _TEXT,
            "value": _NUMBER,
            "place": _TEXT,
            "wanted": _NUMBER,
            "waited": _NUMBER,
            "met": _TRUTH,
            "cause": _TEXT,
        },
        "jobs": {"job": _TEXT, "offset_s": _NUMBER, "duration_s": _NUMBER, "of_program": _TRUTH},
        "outcome": {
            "well": _TRUTH,
            "what": _TEXT,
            "remedy": _TEXT,
            "command": _TEXT,
            "done_s": _NUMBER,
            "joints": joints | {"type": ["object", "null"]},
            "code": _TEXT,
            "where": {"type": ["object", "null"]},
        },
    }


def _joint_keys(robot: Robot) -> list[str]:
    return [f"{name}_{unit}" for name, unit in zip(robot.joint_names, robot.axis_unit_names, strict=True)]


def _by_joint(robot: Robot, joints: Array) -> dict[str, float]:
    """Return joint positions (n,) [rad or m] by name, `J1_deg` and so on."""
    values = np.round(joints / robot.axis_units, _DIGITS).tolist()
    return dict(zip(_joint_keys(robot), values, strict=True))


def _described(job: Job) -> dict[str, Any]:
    """Return everything that a reader must know about the job and its robot."""
    robot = job.robot
    limits = np.column_stack((robot.limits.lower, robot.limits.upper)) / robot.axis_units[:, None]
    return {
        "duration_s": job.duration,
        "takes": job.lasting.to_json(),
        "commands": [
            {
                "index": command.index,
                "name": command.name,
                "source_line": command.source_line,
                "begins_s": command.begins,
                "ends_s": command.ends,
                "clock_s": command.clock,
            }
            for command in job.commands
        ],
        "joints": [
            {"name": name, "unit": unit, "limits": [bound if np.isfinite(bound) else None for bound in pair]}
            for name, unit, pair in zip(
                robot.joint_names, robot.axis_unit_names, limits.tolist(), strict=True
            )
        ],
        "controller": asdict(cast("Any", robot.controller)),
    }


def _order_text(order: Order) -> str:
    match order:
        case Override(percent=percent):
            return f"override {percent:g} %"
        case Fail(what=what):
            return f"fail: {what}"
        case Fill(client=client, values=values):
            return f"fill by {client}: {values_text(values)}"
        case _:
            return type(order).__name__.lower()


def _clean(text: str) -> str:
    """Remove surrogates, which file names may contain and UTF-8 can't encode."""
    return text.encode("utf-8", "replace").decode()
