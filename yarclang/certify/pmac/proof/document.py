"""The proof of a certified text as JSON: the robot's numbers, the program, and what makes its motions checkable without search."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from yarclang import hir
from yarclang.certify.blends.corner import tolerance_of
from yarclang.certify.claims import Claims
from yarclang.certify.kinematics.arm import axes_of, flange_poses
from yarclang.certify.kinematics.described import own_robot
from yarclang.certify.kinematics.motors import counts_per_joint
from yarclang.certify.motion.joint import joint_weights
from yarclang.certify.motion.programmed import goal_pose
from yarclang.certify.pmac.proof.planes import planes_of
from yarclang.certify.pmac.proof.room import Room, commands_of, told_arm, told_frame
from yarclang.certify.pmac.proof.shares import frame_proof, spline_proof
from yarclang.certify.pmac.reader import READER
from yarclang.certify.read.layout import Layout, Place, lay_out
from yarclang.certify.read.text import ControllerText
from yarclang.decisions import bits_of
from yarclang.pmac.controller import turbo_pmac
from yarclang.robot.model import Array, Robot, Tolerance
from yarclang.units import DEG, MM
from yarclang.verify.course import follow
from yarclang.verify.reader import read
from yarclang.verify.verdict import FORM, verify


class NoProofError(Exception):
    """A text of which no proof can be written: the text of the exception says why."""


def proof_of(
    text: str,
    content: ControllerText,
    program: hir.Program,
    robot: Robot,
    tolerance: Tolerance,
    claims: Claims,
) -> str:
    """Return the proof of a certified text as JSON.

    Args:
        text: the whole text as it is written, with its seal.
        content: the same as the judge has read it.
        program: what it was certified against.
        robot: the arm.
        tolerance: of motions that have none of their own.
        claims: the planner's.

    Raises:
        NoProofError: the text is for another buffer, the arm has joints that the checker doesn't know, or the checker doesn't follow the proof.
    """
    if content.target != "rotary":
        raise NoProofError(
            f"a text with the target {content.target} has no proof: only texts that are streamed have"
        )
    robot = own_robot(robot)
    start = READER.start(content, robot).q
    layout = lay_out(content, program, start, robot.axis_units)
    if not isinstance(layout, Layout):
        raise NoProofError("the text isn't the program's")
    controller = turbo_pmac(robot)
    told = read(text, list(controller.axes), list(controller.motors), controller.coordinate_system)
    rows, course = follow(told)
    motions, steps = dict[str, Any](), list[dict[str, Any]]()
    places = {place.step: (row, place) for row, place in enumerate(layout.places)}
    begins = flange_poses(robot.chain, layout.begins) if places else np.empty((0, 4, 4))
    for number, entry in enumerate(told.entries):
        steps.append({"title": entry.title})
        if number not in places:
            continue
        row, place = places[number]
        begin = _Begin(layout.begins[row], begins[row])
        steps[-1] |= _told(place, begin, robot, tolerance, claims)
        if place.size and place.before is None and place.behind is None and "unchecked" not in steps[-1]:
            proof = _proof(layout, place, begin, robot, tolerance, claims)
            if isinstance(proof, str):
                steps[-1]["unchecked"] = proof
            elif proof is not None:
                motions[str(number)] = proof
    around = Room(commands_of(layout, program, robot), robot)
    document = {
        "form": FORM,
        "version": content.header.version,
        "text": hashlib.sha256(text.encode("ascii")).hexdigest(),
        "robot": _robot(robot),
        "program": {
            "start": (program.start / robot.axis_units).tolist(),
            "outputs": sorted({bit for one in program.outputs for bit in bits_of(one.signal.variable)}),
            "safe": told.safe,
            "registers": told.registers,
            "course": course,
            "steps": steps,
        },
        "motions": motions,
        "cell": around.told,
        "planes": planes_of(rows, around.told, around.items, robot),
    }
    made = json.dumps(document, separators=(",", ":"), allow_nan=False) + "\n"
    verdict = verify(text.encode("ascii"), made.encode("ascii"))
    if verdict.refused:
        raise NoProofError(f"the checker doesn't follow the proof of this text: {verdict.refused}")
    return made


class _Begin:
    """Where a motion begins: joints `q` (n,) and `flange` (4, 4)."""

    def __init__(self, q: Array, flange: Array) -> None:
        self.q, self.flange = q, flange


def _robot(robot: Robot) -> dict[str, Any]:
    controller, limits, units = turbo_pmac(robot), robot.limits, robot.axis_units
    lines = axes_of(robot.chain)
    turns = lines.turn == 1.0
    if not (turns & (lines.slide == 0.0) | ~turns & (lines.turn == 0.0) & (lines.slide == 1.0)).all():
        raise NoProofError("the arm has a joint that turns and slides at once")
    return {
        "name": robot.name,
        "fingerprint": robot.fingerprint,
        "joints": list(robot.joint_names),
        "axes": list(controller.axes),
        "motors": list(controller.motors),
        "feedback": list(controller.feedback),
        "lower": _in_units(limits.lower / units),
        "upper": _in_units(limits.upper / units),
        "velocity": _in_units(limits.velocity / units),
        "acceleration": _in_units(limits.acceleration / units),
        "jerk": _in_units(limits.jerk / units),
        "motor_velocity": _in_units(robot.actuation.velocity),
        "counts": [_in_units(row * units) for row in counts_per_joint(robot)],
        "coordinate_system": controller.coordinate_system,
        "rotary_words": controller.rotary_words,
        "hold_time": controller.hold_time,
        "i8": controller.i8,
        "i10": controller.i10,
        **told_arm(robot),
    }


def _in_units(numbers: Array) -> list[float | None]:
    """Return numbers of robot.toml as it writes them, without the last digits that the way to SI and back has changed."""
    return [float(f"{one:.13g}") if np.isfinite(one) else None for one in numbers.tolist()]


def _told(place: Place, begin: _Begin, robot: Robot, tolerance: Tolerance, claims: Claims) -> dict[str, Any]:
    """Return what the program says of a motion."""
    motion = place.motion
    own = tolerance_of(motion, tolerance)
    told: dict[str, Any] = {"tolerance": _in_units(np.array([own.position / MM, own.angle / DEG]))}
    timing = motion.timing
    if timing.duration is not None:
        told["duration"] = float(f"{timing.duration:.13g}")
    if timing.speed is not None:
        told["speed"] = _speed(timing.speed)
        kept = claims.kept.get(place.step, 1.0)
        if kept < 1.0:
            told["kept"] = float(kept)
    if timing.ceiling is not None:
        told["ceiling"] = float(f"{timing.ceiling / MM:.13g}")
    if place.any_jerk:
        told["any_jerk"] = True
    match motion:
        case hir.LineMove(goal=goal) | hir.ArcMove(goal=goal):
            pose = goal_pose(goal, begin.flange)[1]
            told |= {"move": "line", "pose": told_frame(pose), "tool": told_frame(goal.flange_from_moving)}
            if isinstance(motion, hir.ArcMove):
                told |= {"move": "arc", "via": motion.via.tolist()}
        case hir.JointMove() | hir.SplineMove() | hir.AvoidMove():
            told["move"] = "joint" if isinstance(motion, hir.JointMove) else "spline"
            told["through"] = list(_through(place, begin, robot, claims))
            if motion.tolerance is not None and place.size:
                told["unchecked"] = "its path, since TOL is of the moving frame"
        case hir.PoseSplineMove(waypoints=waypoints):
            poses = [told_frame(one.base_from_moving) for one in waypoints]
            told |= {"move": "spline of poses", "poses": poses, "unchecked": "its path, a spline of poses"}
        case hir.TimedMove():
            told |= {"move": "timetable", "unchecked": "its path and time, a timetable"}
            told.pop("duration", None)
    return told


def _speed(speed: hir.Reading) -> list[float | None]:
    """Return a speed as one of the frame's origin [mm/s] and as one of its turn [deg/s]."""
    read_as = (speed.length, MM), (speed.angle, DEG)
    return [None if number is None else float(f"{number / unit:.13g}") for number, unit in read_as]


def _through(place: Place, begin: _Begin, robot: Robot, claims: Claims) -> Iterator[dict[str, Any]]:
    """Yield the way-points of a joint motion: joints [deg or mm], and the poses that these are chosen for."""
    motion = place.motion
    claimed = claims.witnesses.get(place.step)
    goals = motion.goals
    if isinstance(motion, hir.AvoidMove) and claimed is not None:
        for q in claimed[:-1]:
            yield {"q": (q / robot.axis_units).tolist()}
        claimed = claimed[-1:]
    for number, goal in enumerate(goals):
        match goal:
            case hir.JointGoal(q=q):
                yield {"q": (q / robot.axis_units).tolist()}
            case hir.JointDelta(dq=dq):
                yield {"q": ((begin.q + dq) / robot.axis_units).tolist()}
            case hir.PoseGoal():
                of_text = isinstance(motion, hir.JointMove) or claimed is None
                q_told = None if of_text or claimed is None else (claimed[number] / robot.axis_units).tolist()
                frame = told_frame(goal.flange_from_moving)
                yield {"q": q_told, "pose": told_frame(goal.base_from_moving), "tool": frame}


def _proof(
    layout: Layout, place: Place, begin: _Begin, robot: Robot, tolerance: Tolerance, claims: Claims
) -> dict[str, Any] | str | None:
    """Return what makes a motion checkable; why it can't be checked; None for one that needs nothing."""
    motion = place.motion
    if isinstance(motion, hir.LineMove | hir.ArcMove):
        start, goal = goal_pose(motion.goal, begin.flange)
        own = tolerance_of(motion, tolerance)
        return frame_proof(layout, place, start, goal, motion.goal.flange_from_moving, robot, own)
    if isinstance(motion, hir.SplineMove | hir.AvoidMove):
        through = [one["q"] for one in _through(place, begin, robot, claims)]
        points = np.array([begin.q / robot.axis_units, *through]) * robot.axis_units
        return spline_proof(layout, place, points, joint_weights(robot, tolerance), claims)
    return None
