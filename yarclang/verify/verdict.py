"""The verdict about a controller text: check it by its proof, for the robot that the proof describes."""

import hashlib
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import chain
from typing import Any, NoReturn
from urllib.parse import unquote

from yarclang.verify import course
from yarclang.verify.apart import check_apart
from yarclang.verify.arm import Arm
from yarclang.verify.chains import chains_of, check_chain, why_not
from yarclang.verify.course import Moved
from yarclang.verify.exact import RefusedError, need, unknown, whole
from yarclang.verify.limits import check_limits
from yarclang.verify.parts import check_parts
from yarclang.verify.reader import PRINTED, read

_LIMITS = ("velocity", "acceleration", "jerk", "motor_velocity")
_ROBOT = (
    "name fingerprint joints kinds axes motors feedback lower upper counts coordinate_system rotary_words"
)
_OF_ROBOT = {*_ROBOT.split(), *_LIMITS, "hold_time", "largest_tm", "i8", "i10", "arm"}
_OF_PROOF = "form version text robot program motions cell planes"
_OF_PROGRAM = "start outputs safe registers course steps"
_OF_STEP = "title move tolerance duration speed kept ceiling any_jerk blend unchecked "
_OF_JOINTS = "through tool tolerance_of"
_OF_MOVE = {"line": "pose tool", "arc": "pose tool via", "joint": _OF_JOINTS, "spline": _OF_JOINTS}
_OF_MOVE |= {"timetable": "rows within", "spline of poses": "pose tool poses"}
_OF_MOTION = "from until pieces s rates speeds corner goal start axis angle quaternions turns "
_OF_MOTION += "centre spoke side sweep via"
_OF_GOALS = {"through": "q pose tool", "rows": "q at v a"}
_NAME = r"(?!(True|False|None)$)[A-Za-z_{][\w.{}=-]*"
"""A string that is printed without quotes: one word. Words after a space could look like other fields."""
FORM = 5
"""Version of the proof format that this checker reads."""
ALWAYS_UNCHECKED = (
    "torques",
    "percentages of limits ([50%], ACC), apart from the limits themselves",
    "that program, cell and robot's numbers, as told here, are those of the source and of the files",
)
_MALFORMED = (
    KeyError,
    TypeError,
    ValueError,
    IndexError,
    AttributeError,
    ZeroDivisionError,
    RecursionError,
    OverflowError,
    MemoryError,
)


@dataclass
class Verdict:
    """The result of all checks.

    Attributes:
        refused: reason why the controller text or its proof is wrong; empty if neither is.
        checked: the properties that were checked.
        unchecked: the properties that were not checked.
        exempt: exceptions from limits, and paths that are planned only at run time; the text states each.
        told: the proof's description of the robot and the program.
    """

    refused: str = ""
    checked: list[str] = field(default_factory=list)
    unchecked: list[str] = field(default_factory=list)
    exempt: list[str] = field(default_factory=list)
    told: list[str] = field(default_factory=list)


def verify(text: bytes, proof: bytes) -> Verdict:
    """Check a controller text by its proof."""
    verdict = Verdict()
    try:
        _verify(text, _read_proof(proof), verdict)
    except RefusedError as refusal:
        verdict.refused = str(refusal)
    except _MALFORMED as error:
        verdict.refused = f"the proof isn't in its form: {type(error).__name__} {error}"[:300]
    return verdict


def _read_proof(proof: bytes) -> dict[str, Any]:
    """Read a proof with exact numbers, and refuse duplicate names."""

    def number(printed: str) -> Fraction:
        found = re.fullmatch(r"-?[0-9]{1,30}(\.[0-9]{1,30})?([eE][-+]?[0-9]{1,2})?", printed)
        need(found is not None, "a number is too long")
        return Fraction(printed)

    def once(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
        need(len(dict(pairs)) == len(pairs), "a name stands twice in the proof")
        return dict(pairs)

    def refuse(constant: str) -> NoReturn:
        raise RefusedError(f"{constant} is no number")

    read_ = json.loads(
        proof, parse_float=number, parse_int=number, parse_constant=refuse, object_pairs_hook=once
    )
    need(isinstance(read_, dict), "the proof is no table")
    return dict(read_)


def _verify(text: bytes, proof: dict[str, Any], verdict: Verdict) -> None:
    need(proof["form"] == FORM, f"the proof has form {proof['form']}, this checker reads {FORM}")
    need(hashlib.sha256(text).hexdigest() == proof["text"], "the proof is for another text")
    robot, program = proof["robot"], proof["program"]
    strange = unknown(proof, _OF_PROOF) or unknown(program, _OF_PROGRAM)
    need(not strange, f"the proof has {strange}, which this checker doesn't know")
    _check_robot(robot, verdict)
    content = read(text.decode("ascii"), robot["axes"], robot["motors"], robot["coordinate_system"])
    need(content.version == proof["version"], "the proof was made by another version than the text")
    same = (content.robot, content.fingerprint) == (robot["name"], robot["fingerprint"])
    need(same, "the proof is about another robot than the text")
    arm = Arm(robot)
    course.check_start(content, robot, program["start"])
    rows, done = course.follow(content)
    titles = [step["title"] for step in program["steps"]]
    need(
        [entry.title for entry in content.entries] == titles,
        "the text has other commands than the proof says",
    )
    need(done == program["course"], "the text's actions differ from the proof's, or are in another order")
    same = (content.safe, content.registers) == (program["safe"], program["registers"])
    need(same, "the text has other safe values, registers or watched inputs than the proof says")
    course.check_guard(content, robot)
    course.check_variables(content, robot, program["outputs"])
    verdict.checked += [
        "every line has the form that its place allows, and the controller keeps all segment times",
        "the told commands, dwells, outputs, barriers, registers, in order, at rest or in a blend's middle",
        "ways that meet, and passes of a loop, end at one place; a RAPID leads to where the robot stands",
        "the guard, and that nothing but the told outputs is assigned",
        "start, as told and as the header says it",
    ]
    course.check_duration(content)
    verdict.checked.append("the header's duration, each loop once")
    for row, step in zip(rows, program["steps"], strict=True):
        free = bool(step.get("any_jerk", False))
        need(
            free or not row.entry.any_jerk,
            f"{row.entry.title}: its jerk is free, and the proof doesn't say so",
        )
    _check_stands(content.start, robot)
    shares = ", ".join(
        f"{what} {float(share):.3%}" for what, share in check_limits(rows, robot, verdict.exempt).items()
    )
    verdict.checked.append(f"joints stay in their ranges; largest shares of limits: {shares}")
    for name in ("start", "outputs", "safe", "registers"):
        verdict.told.append(f"program {name}: {_shown(program[name])}")
    motion = "the start"
    for deed in done:
        if deed.startswith("move "):
            motion = titles[int(deed.removeprefix("move "))]
        else:
            verdict.told.append(f"after {motion}: {deed}")
    low, full, words = content.marks
    verdict.told.append(f"guard: I16 {low} lines, I17 {full} lines, a buffer of {words} words")
    barriers = {step for _, step, _ in content.barriers.values()}
    _check_motions(rows, barriers, program, proof, arm, verdict)
    _list_later(content.registers, verdict)
    _check_bodies(rows, done, proof, arm, content.registers, verdict)
    _list_allowed(content.registers, proof["cell"]["bodies"], rows, verdict)
    verdict.unchecked += ALWAYS_UNCHECKED


def _list_later(lines: list[str], verdict: Verdict) -> None:
    """List what is planned and proved only when the controller text runs."""
    kinds, later = [line.split(" ")[1] for line in lines], "planned and proved at run time"
    if "search" in kinds:
        verdict.exempt.append(f"the path after a motion that an input ends: {later}")
    for line in lines:
        if line.startswith("; watch") and " then " in line:
            name = line.split(" then ")[1].split(" ")[0]
            verdict.exempt.append(f"the path on which the robot leaves ({name}): {later}")
    if "offset" in kinds:
        verdict.exempt.append(f"paths in frames that registers shift, after the shift: {later}")


def _list_allowed(
    lines: list[str], bodies: list[dict[str, Any]], rows: list[Moved], verdict: Verdict
) -> None:
    """List the pairs of bodies that commands allow to touch, so that their distance isn't checked."""
    known = {name for body in bodies for name in (body["name"].upper(), body["name"].upper().split(" ")[0])}
    found, moving = dict[tuple[str, ...], list[str]](), {row.entry.step for row in rows if row.control}
    for line in lines:
        _, kind, step, *words = line.split(" ")
        if kind == "allow":
            names = tuple(map(unquote, words))
            need(len(names) == 2 and step.isdecimal(), f"{line!r} doesn't name a command and two bodies")
            need(int(step) in moving, f"{line!r} is for a command without moves")
            found.setdefault(names, []).append(step)
    for (one, other), steps in found.items():
        pair = f"{one} and {other} during commands {', '.join(steps)} of the map"
        absent = "" if known.issuperset((one, other)) else ", but not both are bodies of the proof"
        verdict.exempt.append(f"{pair}: the program lets them touch{absent}")


def _check_bodies(
    rows: list[Moved], done: list[str], proof: dict[str, Any], arm: Arm, lines: list[str], verdict: Verdict
) -> None:
    """Check that bodies stay apart, and add the results and the data of the bodies to the verdict."""
    cell = proof["cell"]
    need(set(cell) == {"bodies", "exceptions", "zones"}, "the cell has other fields than a cell's")
    checked, left = check_apart(rows, cell, proof["planes"], arm, lines)
    verdict.checked.append(checked)
    verdict.unchecked += left
    bodies = cell["bodies"]
    if any("during" in body for body in bodies):
        verdict.unchecked += check_parts(rows, done, bodies, arm)
        verdict.checked.append("parts stay where they are when the arm takes or leaves them")
    called = [f"{number} {_shown(body['name'])}" for number, body in enumerate(bodies)]
    for name, body in zip(called, bodies, strict=True):
        numbers = {field: value for field, value in body.items() if field not in ("name", "corners")}
        if corners := body.get("corners", []):
            for axis, column in zip("xyz", zip(*corners, strict=True), strict=False):
                numbers[f"corners in {axis}"] = [min(column), max(column)]
            digest = hashlib.sha256(" ".join(map(str, chain(*corners))).encode()).hexdigest()
            numbers["corners"] = f"{len(corners)} of SHA-256 {digest}"
        verdict.told.append(f"body {name} [m]: {_shown(numbers)}")
    for zone in cell["zones"]:
        watched = ", ".join(called[whole(one)] for one in zone["watched"])
        verdict.told.append(f"zone {_shown({**zone, 'watched': []})} bodies {watched or 'none'}")
    for one, other, least, first, last in cell["exceptions"]:
        how = "may touch" if least is None else f"stay {float(least) * 1000:.6g} mm apart"
        names = f"{called[whole(one)]} and {called[whole(other)]}"
        verdict.told.append(f"{names} {how} during commands {whole(first)} to {whole(last)} of the map")


def _check_robot(robot: dict[str, Any], verdict: Verdict) -> None:
    """Check the form of the numbers that describe the robot, and add them to the verdict."""
    need(set(robot) == _OF_ROBOT, "the robot has other fields than a robot's")
    size = len(robot["joints"])
    need(0 < size <= 16, "the robot has 1 to 16 joints")
    for name in f"axes kinds motors counts {' '.join(_LIMITS)} lower upper".split():
        need(len(robot[name]) == size, f"the robot has another number of {name} than joints")
    need(all(kind in ("turns", "slides") for kind in robot["kinds"]), "a joint that neither turns nor slides")
    ends = [one for one in (*robot["lower"], *robot["upper"]) if one is not None]
    counts = [one for row in robot["counts"] for one in row]
    need(all(isinstance(one, Fraction) for one in (*ends, *counts)), "a number is none")
    for name in _LIMITS:
        positive = all(isinstance(one, Fraction) and one > 0 for one in robot[name])
        need(positive, f"a limit of {name} that isn't above 0")
    for name in ("coordinate_system", "i8", "i10", "rotary_words"):
        need(robot[name].denominator == 1, f"{name} is no integer")
        robot[name] = int(robot[name])
    robot["motors"] = [int(one) for one in robot["motors"]]
    times = robot["i10"], robot["hold_time"], robot["largest_tm"]
    need(robot["i8"] >= 0 and min(times) > 0, "a time that isn't above 0")
    need(len(set(robot["axes"])) == size and all(re.fullmatch("[A-Z]", one) for one in robot["axes"]), "axes")
    verdict.told.append(f"robot {robot['name']} {robot['fingerprint']}")
    for name, value in robot.items():
        if name not in ("name", "fingerprint"):
            verdict.told.append(f"robot {name}: {_shown(value)}")


def _shown(value: Any) -> str:
    """Return a value of the proof as text. A string is quoted unless it is a name, so that it can't look like
    other values.
    """
    if isinstance(value, str):
        return value if re.fullmatch(_NAME, value, re.ASCII) else json.dumps(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_shown, value))}]"
    if isinstance(value, dict):
        return " ".join(f"{name} {_shown(one)}" for name, one in value.items())
    return f"{float(value):.12g}" if isinstance(value, Fraction) else str(value)


def _check_stands(start: tuple[int, ...], robot: dict[str, Any]) -> None:
    for at, low, high, name in zip(start, robot["lower"], robot["upper"], robot["joints"], strict=True):
        past = max(0 if low is None else low * PRINTED - at, 0 if high is None else at - high * PRINTED)
        need(past <= PRINTED // 10**9, f"the text starts with {name} beyond its range")


def _check_motions(
    rows: list[Moved],
    barriers: set[int],
    program: dict[str, Any],
    proof: dict[str, Any],
    arm: Arm,
    verdict: Verdict,
) -> None:
    """Check each motion against its description in the proof; `barriers` are the commands that are none."""
    for row, told in zip(rows, program["steps"], strict=True):
        title = row.entry.title
        _tell(title, told, verdict)
        need(told.get("any_jerk", False) in (True, False), f"{title}: any_jerk is neither true nor false")
        names = _OF_STEP + _OF_MOVE.get(told["move"], "poses") if "move" in told else "title unchecked"
        goals = [(goal, fields) for place, fields in _OF_GOALS.items() for goal in told.get(place, [])]
        strange = unknown(told, names) or ", ".join({unknown(*goal) for goal in goals} - {""})
        known = told.get("move", "line") in _OF_MOVE or told.get("unchecked")
        need(bool(known), f"{title}: a motion of a kind that isn't known")
        if strange:
            told["unchecked"] = f"all of it, since this checker doesn't know its {strange}"
        # A barrier after a search has the name of the search's motion.
        is_motion = title.split(" ")[1].startswith(("MOVE", "DMOVE")) and row.entry.step not in barriers
        need(is_motion == ("move" in told), f"{title}: the proof tells a motion as none, or none as a motion")
        if "move" not in told:
            need(not row.control, f"{title}: the map gives moves to a command that is no motion")
            if strange:
                verdict.unchecked.append(f"{title}: {told['unchecked']}")
            continue
        need(
            row.entry.blend is None or "blend" in told,
            f"{title}: it flows into the next motion, and the proof doesn't say so",
        )
        if row.entry.any_jerk:
            verdict.exempt.append(f"{title}: the jerk, also in its blends: its profile has no limit")
    steps = {str(row.entry.step) for row in rows if row.control}
    need(steps.issuperset(proof["motions"]), "the proof is about motions that the text doesn't have")
    strange = " ".join(unknown(one, _OF_MOTION) for one in proof["motions"].values()).strip()
    need(not strange, f"a motion of the proof has {strange}, which this checker doesn't know")
    widest, alone, still, flowing = [Fraction(0), Fraction(0)], 0, 0, 0
    stood = [{"move": "start", "through": [{"q": program["start"]}]}]  # the last motion before each command
    for row, told in zip(rows, program["steps"], strict=True):
        stood.append(told if "move" in told else stood[row.after + 1])
    for links in chains_of(rows, program["steps"]):
        reason, title = why_not(links, proof["motions"]), links[0][0].entry.title
        if reason:
            if len(links) > 1:
                title += f" to {links[-1][0].entry.title}, {len(links)} motions that flow into each other"
            verdict.unchecked.append(f"{title}: path, goal, time and speed ({reason})")
        else:
            verdict.unchecked += check_chain(
                links, proof["motions"], arm, stood[links[0][0].after + 1], verdict.told
            )
            if len(links) > 1:
                flowing += len(links)
                continue
            alone, still = alone + 1, still + (not links[0][0].control)
            widest = [max(pair) for pair in zip(widest, links[0][1]["tolerance"], strict=True)]
    if alone:
        verdict.checked.append(
            f"{alone} motions from rest to rest ({still} of them lead nowhere) keep the told times, speeds "
            "and paths, which begin where the robot stands, in order of time and whole, within their "
            f"tolerances, {float(widest[0]):g} mm and {float(widest[1]):g} deg at most"
        )
    if flowing:
        verdict.checked.append(
            f"{flowing} motions that flow into others keep paths, corners, times and speeds as well"
        )


def _tell(title: str, told: dict[str, Any], verdict: Verdict) -> None:
    numbers = "; ".join(
        f"{name} {_shown(value)}" for name, value in told.items() if name not in ("move", "title")
    )
    verdict.told.append(f"{title}: {told.get('move', 'no motion')}; {numbers}".rstrip("; "))
