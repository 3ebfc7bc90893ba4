"""What is known inside of a process to what is said of it: joints by their names, offers, programs, ends. No I/O."""

from __future__ import annotations

import numpy as np

from yarclang.certify.certificate import CommandCertificate, Load
from yarclang.coordinator.messages import replies
from yarclang.coordinator.messages.events import Finished
from yarclang.coordinator.messages.findings import finding_messages
from yarclang.coordinator.messages.message import Joints
from yarclang.coordinator.offers import Offer, OfferedMotion
from yarclang.coordinator.programs import Loaded, Way
from yarclang.motion.plan import MotionPlan
from yarclang.robot.model import Array, Robot
from yarclang.runtime.outcome import Ended, Where
from yarclang.runtime.rest import off_the_start
from yarclang.units import DEG, MM

_SHOWN = 129
"""Joint positions of a thinned motion."""


def joints_by_name(robot: Robot, joints: Array) -> Joints:
    """Return joint positions (n,) [rad or m] by their names, in deg or mm."""
    return {
        name: round(float(value), 6)
        for name, value in zip(robot.joint_names, joints / robot.axis_units, strict=True)
    }


def joints_of(robot: Robot, joints: Joints) -> Array:
    """Return (n,) the joint positions [rad or m] that a message tells."""
    return np.array([joints[name] for name in robot.joint_names]) * robot.axis_units


def finished(time: float, name: str, ended: Ended, robot: Robot) -> Finished:
    """Return the event that something has ended."""
    return Finished(
        time_s=time,
        name=name,
        well=ended.well,
        what=ended.what or None,
        help=ended.remedy or None,
        code=ended.code or None,
        command=ended.command or None,
        done_s=round(ended.done, 4),
        joints=None if ended.joints is None else joints_by_name(robot, ended.joints),
    )


def offer_described(offer: Offer, robot: Robot) -> replies.OfferDescribed:
    """Return an offer as a message."""
    return replies.OfferDescribed(
        number=offer.number,
        text=offer.text,
        title=offer.title,
        duration_s=offer.duration,
        moves=offer.job is not None,
        start=joints_by_name(robot, offer.start),
        end=joints_by_name(robot, offer.end),
        motions=tuple(map(_motion, offer.motions)),
        course=_course(offer.plan),
    )


def _motion(one: OfferedMotion) -> replies.MotionOffered:
    proved = one.proved
    clearance, deviation = proved.clearance, proved.deviation
    return replies.MotionOffered(
        title=one.title,
        seconds=one.seconds,
        branch=one.branch,
        peaks=_peaks(proved),
        path=None
        if proved.kind == "joint"
        else replies.PathBound(position_mm=deviation.position / MM, angle_deg=deviation.angle / DEG),
        clearance=None
        if clearance is None
        else replies.ClearanceBound(
            distance_mm=clearance.distance / MM, first=clearance.first, second=clearance.second
        ),
    )


def _peaks(proved: CommandCertificate) -> replies.Peaks:
    return replies.Peaks(
        velocity=_peak(proved.velocity),
        acceleration=_peak(proved.acceleration),
        jerk=_peak(proved.jerk) if proved.jerk_judged else None,
        motor_velocity=_peak(proved.motor_velocity),
    )


def _peak(load: Load) -> replies.Peak:
    return replies.Peak(name=load.name, share=float(load.share))


def _course(plan: MotionPlan | None) -> replies.Course:
    if plan is None or plan.duration == 0.0:
        return replies.Course(times=(), joints=())
    times = np.linspace(0.0, plan.duration, _SHOWN)
    values = np.round(plan.sample(times)[0] / plan.robot.axis_units, 4) + 0.0
    return replies.Course(times=tuple(np.round(times, 4).tolist()), joints=tuple(map(tuple, values.tolist())))


def program_described(number: int, loaded: Loaded) -> replies.ProgramDescribed:
    """Return a program that can be run as a message."""
    program, rest = loaded.program, loaded.rest
    off = off_the_start(program, program.end)
    reason = ""
    if off:
        reason = f"its end is off by {off.partition(': ')[2]}"
    return replies.ProgramDescribed(
        number=number,
        name=loaded.name,
        duration_s=program.duration,
        commands=tuple(
            replies.ProgramCommand(
                title=one.title,
                index=one.index,
                begins_s=one.begins,
                ends_s=one.ends,
                line=one.source_line,
            )
            for one in program.commands
        ),
        offset_s=rest.offset,
        rest_s=rest.duration,
        steps=len(loaded.steps),
        begins_within=loaded.begins_within,
        guarded=rest.guarded,
        by_legs=bool(program.legs),
        not_looped=reason,
        first=rest.commands[0].index if rest.commands else "",
    )


def way_described(way: Way, robot: Robot, start: Array) -> replies.Way:
    """Return what lies between a robot and a program's start as a message; without a motion, `end` is that start (n,) [rad or m]."""
    job = way.job
    return replies.Way(
        text=way.text,
        duration_s=None if job is None else job.duration,
        title=job.commands[0].title if job is not None and job.commands else "",
        end=joints_by_name(robot, start if job is None else job.end),
        findings=finding_messages(way.findings),
    )


def place_described(where: Where | None) -> replies.SourcePlace | None:
    """Return where a command stands in its source as a message."""
    if where is None:
        return None
    return replies.SourcePlace(
        file=where.file,
        line=where.line,
        column=where.column,
        end_column=where.end_column,
        text=where.text,
        note=where.note,
    )
