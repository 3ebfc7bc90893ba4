"""Conversion of the coordinator's values to messages: joint positions by joint names, offers, programs,
outcomes. No I/O.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from yarclang.cell.model import Present
from yarclang.certify.certificate import CommandCertificate, Load
from yarclang.certify.outward import least, most
from yarclang.coordinator.kept_parts import Known
from yarclang.coordinator.messages import events, replies
from yarclang.coordinator.messages.events import Finished
from yarclang.coordinator.messages.findings import finding_messages
from yarclang.coordinator.messages.message import Joints
from yarclang.coordinator.offers import Offer, OfferedMotion
from yarclang.coordinator.programs import Loaded, Way
from yarclang.diagnostics import Result
from yarclang.handling.parts import first_parts
from yarclang.lasting import Lasting
from yarclang.motion.plan import MotionPlan
from yarclang.pipeline.parts import ends_of
from yarclang.report.carried import carried_parts
from yarclang.robot.model import Array, Robot
from yarclang.runtime import signals
from yarclang.runtime.outcome import Ended, Where
from yarclang.runtime.standing import off_the_start
from yarclang.units import DEG, MM

_SHOWN = 129
"""Number of joint positions by which a message describes a motion."""


def joints_by_name(robot: Robot, joints: Array) -> Joints:
    """Return joint positions by the names of the joints, in deg or mm.

    Args:
        robot: the robot.
        joints: (n,) joint positions [rad or m].
    """
    return {
        name: round(float(value), 6)
        for name, value in zip(robot.joint_names, joints / robot.axis_units, strict=True)
    }


def joints_of(robot: Robot, joints: Joints) -> Array:
    """Return the joint positions (n,) that a message contains [rad or m]."""
    return np.array([joints[name] for name in robot.joint_names]) * robot.axis_units


def finished(time: float, name: str, ended: Ended, robot: Robot) -> Finished:
    """Return the event for the end of an action.

    Args:
        time: time of the event [s].
        name: name of the action.
        ended: outcome of the action.
        robot: the robot.
    """
    return Finished(
        time_s=time,
        name=name,
        well=ended.well,
        what=ended.what or None,
        help=ended.remedy or None,
        code=ended.code or None,
        command=ended.command or None,
        done_s=round(ended.reached, 4),
        joints=None if ended.joints is None else joints_by_name(robot, ended.joints),
        line=None if ended.concerns is None else ended.concerns.source_line or None,
    )


def takes(lasting: Lasting) -> replies.Takes:
    """Return a duration as a message."""
    return replies.Takes(
        duration_s=lasting.most,
        duration_at_least_s=lasting.least,
        waits=lasting.waits,
        waits_at_least=lasting.fewest,
        loops=lasting.loops,
    )


def lasting_of(takes: replies.Takes) -> Lasting:
    """Return the duration that a message contains."""
    return Lasting(
        takes.duration_at_least_s, takes.duration_s, takes.waits_at_least, takes.waits, takes.loops
    )


def offer_described(offer: Offer, robot: Robot) -> replies.OfferDescribed:
    """Return an offer as a message."""
    return replies.OfferDescribed(
        number=offer.number,
        text=offer.text,
        title=offer.title,
        duration_s=offer.lasting.most,
        takes=takes(offer.lasting),
        moves=offer.job is not None,
        start=joints_by_name(robot, offer.start),
        end=joints_by_name(robot, offer.end),
        motions=tuple(map(_motion, offer.motions)),
        parts=() if offer.plan is None else tuple(_deeds(offer.plan)),
        course=_course(offer.plan),
    )


def _deeds(plan: MotionPlan) -> Iterator[str]:
    """Yield the effects of a plan's SETs on parts of the cell, in words, for example `takes BOX 3`."""
    program = plan.program
    carried = carried_parts(plan.robot, program, program.start, ends_of(plan))
    for step in range(len(program.steps)) if carried is not None else ():
        for verb, names in carried.deeds(step) if carried is not None else ():
            yield f"{verb} {', '.join(names)}"


def _motion(motion: OfferedMotion) -> replies.MotionOffered:
    proved = motion.proved
    clearance, deviation = proved.clearance, proved.deviation
    return replies.MotionOffered(
        title=motion.title,
        seconds=motion.seconds,
        branch=motion.branch,
        peaks=_peaks(proved),
        path=None
        if proved.kind == "joint"
        else replies.PathBound(
            position_mm=most(deviation.position, MM), angle_deg=most(deviation.angle, DEG)
        ),
        clearance=None
        if clearance is None
        else replies.ClearanceBound(
            distance_mm=least(clearance.distance, MM), first=clearance.first, second=clearance.second
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
    """Return a loaded program as a message."""
    program, rest = loaded.program, loaded.rest
    off = off_the_start(program, program.end)
    reason = ""
    if off:
        reason = f"its end is off by {off.partition(': ')[2]}"
    return replies.ProgramDescribed(
        number=number,
        name=loaded.name,
        duration_s=program.lasting.most,
        takes=takes(program.lasting),
        commands=tuple(
            replies.ProgramCommand(
                title=one.title,
                index=one.index,
                begins_s=one.clock,
                ends_s=one.clock + one.ends - one.begins,
                line=one.source_line,
            )
            for one in program.commands
        ),
        offset_s=rest.clock,
        rest_s=rest.lasting.most,
        rest_takes=takes(rest.lasting),
        steps=len(loaded.steps),
        begins_within=loaded.begins_within,
        guarded=rest.guarded,
        by_legs=bool(program.legs),
        not_looped=reason,
        first=rest.commands[0].index if rest.commands else "",
        tools=_tools_at(loaded),
    )


def _tools_at(loaded: Loaded) -> tuple[str, ...] | None:
    if loaded.around is None or not loaded.around.tools or loaded.assumed is None:
        return None
    return loaded.assumed.tools


def way_described(way: Way, robot: Robot, start: Array) -> replies.Way:
    """Return the motion from the robot's position to a program's start as a message.

    Args:
        way: the motion.
        robot: the robot.
        start: (n,) start of the program [rad or m]. It is the field `end` of the message if no motion is
            needed or possible.
    """
    job = way.job
    return replies.Way(
        text=way.text,
        duration_s=None if job is None else job.lasting.most,
        title=job.commands[0].title if job is not None and job.commands else "",
        end=joints_by_name(robot, start if job is None else job.end),
        findings=finding_messages(way.findings),
        zone=way.zone,
    )


def signals_described(
    variables: Mapping[str, str], values: Mapping[str, float | None]
) -> tuple[replies.NamedSignal, ...]:
    """Return the values of inputs or outputs as messages.

    Args:
        variables: controller variables, by the names of the signals.
        values: values by controller variable; None if a value isn't known.
    """
    return tuple(
        replies.NamedSignal(name=name, variable=one, value=values.get(one)) for name, one in variables.items()
    )


def place_described(place: Where | None) -> replies.SourcePlace | None:
    """Return the place of a command in its source file as a message."""
    if place is None:
        return None
    return replies.SourcePlace(
        file=place.file,
        line=place.line,
        column=place.column,
        end_column=place.end_column,
        text=place.text,
        note=place.note,
    )


def parts_described(loaded: Result[Known]) -> replies.Parts:
    """Return the places of a cell's parts as a message."""
    findings, known_places = finding_messages(loaded.diagnostics), loaded.value
    if known_places is None:
        return replies.Parts(parts=(), moved=False, doubt=None, findings=findings)
    names = {one.variable: name for name, one in known_places.cell.outputs.items() if one.grip is not None}
    return replies.Parts(
        parts=tuple(
            replies.PartPlace(
                name=one.name,
                held=None if one.gripper is None else names.get(one.gripper, ""),
                sure=one.is_sure,
                pose=tuple(map(tuple, one.transform.tolist())),
            )
            for one in known_places.present.parts.items
        ),
        moved=known_places.present != Present(first_parts(known_places.cell)),
        doubt=known_places.doubt or None,
        findings=findings,
    )


def signal_of(event: events.OutputSet | events.WaitEnded | events.InputChanged) -> signals.Signal:
    """Convert an event about an input or output to a signal of the runtime."""
    match event:
        case events.OutputSet():
            return signals.OutputSet(event.time_s, event.name, event.variable, event.value)
        case events.InputChanged():
            return signals.InputChanged(event.time_s, event.name, event.variable, event.value, event.cause)
    return signals.WaitEnded(
        event.time_s, event.place, event.name, event.variable, event.value, event.waited_s, event.met
    )
