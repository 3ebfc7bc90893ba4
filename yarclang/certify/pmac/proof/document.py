"""The proof of a certified controller text as JSON.

It contains the robot, the program, and the data with which the checker checks motions without search.
"""

from __future__ import annotations

import hashlib
import json
from typing import Any

from yarclang import hir
from yarclang.certify.claims import Claims
from yarclang.certify.judged import Judged
from yarclang.certify.kinematics.arm import axes_of
from yarclang.certify.kinematics.described import own_robot
from yarclang.certify.kinematics.motors import counts_per_joint
from yarclang.certify.pmac.proof.motions import Motions
from yarclang.certify.pmac.proof.planes import planes_of
from yarclang.certify.pmac.proof.room import Room, commands_of, in_units, told_arm
from yarclang.certify.pmac.reader import READER
from yarclang.certify.read.layout import Layout, lay_out
from yarclang.certify.read.text import ControllerText
from yarclang.decisions import bits_of
from yarclang.pmac.controller import turbo_pmac
from yarclang.robot.model import Robot, Tolerance
from yarclang.units import MS
from yarclang.verify.course import follow
from yarclang.verify.exact import RefusedError
from yarclang.verify.reader import read
from yarclang.verify.verdict import FORM, verify


class NoProofError(Exception):
    """No proof of a text can be written; the message is the reason."""


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
        text: the whole text as written, with its seal.
        content: the text as the judge has read it.
        program: the program that the text was certified against.
        robot: the arm.
        tolerance: tolerance of motions without their own.
        claims: the planner's claims.

    Raises:
        NoProofError: the text is for another buffer, the arm has joints that the checker does not know, or
            the checker rejects the proof.
    """
    if content.target != "rotary":
        raise NoProofError(
            f"a text with the target {content.target} has no proof: only streamed texts have one"
        )
    robot = own_robot(robot)
    start = READER.start(content, robot).q
    layout = lay_out(content, program, start, robot.axis_units)
    if not isinstance(layout, Layout):
        raise NoProofError("the text isn't the program's")
    controller = turbo_pmac(robot)
    checked = read(text, list(controller.axes), list(controller.motors), controller.coordinate_system)
    try:
        rows, course = follow(checked)
    except RefusedError as refusal:
        raise NoProofError(f"the checker doesn't follow this text: {refusal}") from None
    judged = Judged(robot, tolerance, claims, lambda *_: None)
    steps, motions = [{"title": entry.title} for entry in checked.entries], dict[str, Any]()
    if layout.places:
        all_ = Motions(judged, layout, program, {row.entry.step: row.first for row in rows})
        for place in layout.places:
            steps[place.step] |= all_.told[place.step]
        motions = all_.proofs
    around = Room(commands_of(layout, program, robot), robot)
    try:
        planes = planes_of(rows, around.told, around.items, robot, checked.registers)
    except RefusedError as refusal:
        raise NoProofError(f"the checker doesn't take this cell: {refusal}") from None
    document = {
        "form": FORM,
        "version": content.header.version,
        "text": hashlib.sha256(text.encode("ascii")).hexdigest(),
        "robot": _robot(robot),
        "program": {
            "start": (program.start / robot.axis_units).tolist(),
            "outputs": sorted({bit for one in program.outputs for bit in bits_of(one.signal.variable)}),
            "safe": checked.safe,
            "registers": checked.registers,
            "course": course,
            "steps": steps,
        },
        "motions": motions,
        "cell": around.told,
        "planes": planes,
    }
    made = json.dumps(document, separators=(",", ":"), allow_nan=False) + "\n"
    verdict = verify(text.encode("ascii"), made.encode("ascii"))
    if verdict.refused:
        raise NoProofError(f"the checker doesn't follow the proof of this text: {verdict.refused}")
    return made


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
        "lower": in_units(limits.lower / units),
        "upper": in_units(limits.upper / units),
        "velocity": in_units(limits.velocity / units),
        "acceleration": in_units(limits.acceleration / units),
        "jerk": in_units(limits.jerk / units),
        "motor_velocity": in_units(robot.actuation.velocity),
        "counts": [in_units(row * units) for row in counts_per_joint(robot)],
        "coordinate_system": controller.coordinate_system,
        "rotary_words": controller.rotary_words,
        "largest_tm": float(f"{controller.largest_segment / MS:.13g}"),
        "hold_time": controller.hold_time,
        "i8": controller.i8,
        "i10": controller.i10,
        **told_arm(robot),
    }
