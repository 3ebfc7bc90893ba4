"""The verdicts of the judge and of the small checker about the same text.

Texts are also changed at random, by a forger who has the checker.
"""

import hashlib
import json
import re
from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from programs import compiled, robot_of

from yarclang.campaign.drawing import drawn
from yarclang.certify.certifying import certify
from yarclang.independent.arm import Arm as IndependentArm
from yarclang.independent.reading import read as read_anew
from yarclang.pipeline.proofs import proof_of
from yarclang.pipeline.stages import claims_of
from yarclang.robot.model import Tolerance
from yarclang.verify.verdict import ALWAYS_UNCHECKED, verify

EMPTY = {"cell": {"bodies": [], "exceptions": [], "zones": []}, "planes": []}
"""A proof's cell without bodies; checking changed texts with bodies would take most of the time."""


@dataclass
class Tried:
    """Results about random programs and changed texts.

    Attributes:
        counts: numbers of programs and of changed texts, by both verdicts.
        unchecked: what the checker has listed as unchecked, by kind.
        faults: every disagreement, with its seed.
    """

    counts: Counter = field(default_factory=Counter)
    unchecked: Counter = field(default_factory=Counter)
    faults: list = field(default_factory=list)


def kind_of(said):
    """Return an unchecked item without names of commands and without numbers."""
    return re.sub(r"P?[0-9]+(?:\.[0-9]+)?", "#", said.split(": ", 1)[-1])


def moved(text, random):
    """Return a text in which one number of one move line is changed."""
    lines = text.split("\n")
    begin = lines.index("SPLINE1")
    moves = [k for k, line in enumerate(lines) if k > begin and re.match(r"[XU]-?[0-9]", line)]
    k = int(random.choice(moves))
    numbers = list(re.finditer(r"(?<=[A-Z])-?[0-9.]+", lines[k]))
    one = numbers[int(random.integers(len(numbers)))]
    way = float(random.choice([-1, 1])) * 10.0 ** random.uniform(-5.0, 1.0)
    lines[k] = f"{lines[k][: one.start()]}{float(one[0]) + way:.6f}{lines[k][one.end() :]}"
    return "\n".join(lines)


def exchanged(text, random):
    """Return a text in which two neighbouring move lines are exchanged."""
    lines = text.split("\n")
    begin = lines.index("SPLINE1")
    is_move = [k > begin and bool(re.match(r"[XU]-?[0-9]", line)) for k, line in enumerate(lines)]
    pairs = [k for k in range(len(lines) - 1) if is_move[k] and is_move[k + 1] and lines[k] != lines[k + 1]]
    k = int(random.choice(pairs))
    lines[k], lines[k + 1] = lines[k + 1], lines[k]
    return "\n".join(lines)


def scaled(text, random):
    """Return a text in which all positions of one axis are scaled, including the start."""
    share = 1 + float(random.choice([-1, 1])) * 10.0 ** random.uniform(-6.0, -1.0)
    lines = text.split("\n")
    begin = lines.index("SPLINE1")
    letter = re.match(r"[A-Z]", next(line for line in lines[begin:] if re.match(r"[XU]-?[0-9]", line)))[0]
    form = rf"{letter}(-?[0-9.]+)"
    for k in range(begin, len(lines)):
        if re.match(r"[XU]-?[0-9]", lines[k]):
            lines[k] = re.sub(form, lambda one: f"{letter}{float(one[1]) * share:.6f}", lines[k])
    return "\n".join(lines)


def faster(text, random):
    """Return a text with another segment time, which is one that the controller can keep."""
    times = list(re.finditer(r"(?m)^TM([0-9.]+)$", text))
    one = times[int(random.integers(len(times)))]
    steps = max(1, round(float(one[1]) * 4096 * float(random.choice([0.5, 0.9, 0.999, 1.001, 1.1, 2]))))
    return f"{text[: one.start()]}TM{steps / 4096:.12f}".rstrip("0").rstrip(".") + text[one.end() :]


def shorter(text, random):
    """Return a text without one of the lines after its header, and with an unchanged map."""
    lines = text.split("\n")
    del lines[int(random.integers(lines.index("CLOSE ALL"), len(lines) - 1))]
    return "\n".join(lines)


CHANGES = {one.__name__: one for one in (moved, moved, moved, exchanged, scaled, faster, shorter)}


def try_program(name, seed, tried, changes=4):
    """Compile a random program, and compare both verdicts about its text and about changed texts."""
    random = np.random.default_rng([name == "INDUSTRIAL6", seed])
    program = drawn(IndependentArm.in_folder(robot_of(name).folder), random, most=3)
    found, _ = compiled(program.text, name)
    tried.counts["drawn"] += 1
    if found is None:
        tried.counts["not compiled"] += 1
        return
    made = proof_of(found)
    if made.value is None:
        tried.faults.append((name, seed, "no proof", [one.message for one in made.diagnostics]))
        return
    verdict = verify(found.text.encode(), made.value.encode())
    tried.counts["refused by mistake" if verdict.refused else "accepted by both"] += 1
    if verdict.refused:
        tried.faults.append((name, seed, "refused by mistake", verdict.refused))
        return
    left = [kind_of(one) for one in verdict.unchecked if one not in ALWAYS_UNCHECKED]
    tried.counts["texts with something unchecked"] += bool(left)
    tried.unchecked.update(set(left))
    proof = json.loads(made.value) | EMPTY
    for number in range(changes):
        how = list(CHANGES)[int(random.integers(len(CHANGES)))]
        text = CHANGES[how](found.text, random)
        if text != found.text:
            _compare(found, text, proof, (name, seed, number, how), tried)


def _compare(found, text, proof, case, tried):
    """Compare both verdicts about a changed text."""
    own = found.certificate.tolerance
    verdict = verify(
        text.encode(), json.dumps(proof | {"text": hashlib.sha256(text.encode()).hexdigest()}).encode()
    )
    tried.counts[f"changed texts, {case[-1]}"] += 1
    if not is_wrong(found, text, own):
        tried.counts["refused by the checker alone" if verdict.refused else "changed and accepted"] += 1
    elif verdict.refused:
        tried.counts["changed and refused by both"] += 1
    elif not is_wrong(found, text, Tolerance(1.1 * own.position, 1.1 * own.angle)):
        tried.counts["within a tenth of a tolerance"] += 1
    elif keeps_by_samples(found, text, proof["program"]["steps"]):
        tried.counts["within a tolerance by samples, beyond the judge's bound"] += 1
    elif any(one not in ALWAYS_UNCHECKED for one in verdict.unchecked):
        tried.counts["refused by the judge, listed as unchecked"] += 1
    else:
        tried.faults.append((*case, "accepted", reasons(found, text)))


def keeps_by_samples(found, text, steps):
    """Return True if a changed text certainly keeps its tolerance.

    This is so if samples of the changed joint motions differ from those of the right text by less than 95 %
    of the tolerance. (The checker's bound may be up to 1.5 times the deviation, because moving a control
    point moves the spline by only 2/3 of the point's way.)
    """
    (_, right), (_, changed) = read_anew(found.text), read_anew(text)
    left = np.degrees(found.certificate.tolerance.angle) * 0.95
    for step, executed in right.items():
        if changed[step].control.shape != executed.control.shape or changed[step].segment != executed.segment:
            return False
        off = np.abs(changed[step].sample() - executed.sample()).max()
        if off > 0 and (steps[step].get("move") not in ("joint", "spline") or off > left):
            return False
    return True


def reasons(found, text):
    """Return the reasons why the judge refuses a text."""
    judged = certify(
        text, found.program, found.plan.robot, found.certificate.tolerance, claims_of(found.plan)
    )
    return [f"{one.code} {one.message}" for one in judged.diagnostics if one.is_error]


def is_wrong(found, text, tolerance):
    """Return True if the judge refuses a text."""
    judged = certify(text, found.program, found.plan.robot, tolerance, claims_of(found.plan))
    return judged.value is None or any(one.is_error for one in judged.diagnostics)
