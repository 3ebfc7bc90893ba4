"""Inspection of a controller before anything moves: the questions, the found value and the required value of
each setting, and the remedy for each difference.
"""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Sequence

from yarclang.pmac.controller import turbo_pmac
from yarclang.pmac.variables import ARMED, ECHO, FEEDBACK_PLC, GUARD_PLC, HEARTBEAT, ROTARY_FULL, WATCHED
from yarclang.robot.model import Robot
from yarclang.runtime.actions import Script, Wait
from yarclang.runtime.inspection import Checked, Inspection, Item
from yarclang.runtime.pmac.feedback import MotorStatus
from yarclang.runtime.pmac.operation import Operation, Refused, number_in
from yarclang.runtime.pmac.pace import OTHER_PACE, OTHER_PACE_REMEDY, pace_of
from yarclang.runtime.pmac.rest import motor_statuses, stands_at, system_words
from yarclang.runtime.pmac.supervision import AT_REST_WITHIN, needed, patience_for, remember, wound_up

TURBO = ("602404", "602413", "603382")
"""CID of a Turbo PMAC Clipper, of a Turbo PMAC2-VME and of a Geo Brick."""

_LONGEST_QUESTION = 200
_GUARD_TIME = 0.5
_TRIAL = 0.06
"""Time to which the watchdog is set for its test [s]."""
_EARLIEST = 0.9
"""The guard PLC must not hold before this fraction of `_TRIAL` is over."""
_CLOSE_ENOUGH = 1e-6
_EXACT = 1e-7
"""Relative tolerance of the counts per unit of an axis definition; over a whole turn, the error is less
than a count.
"""

_BIT = re.compile(r"(?<=,\d\d),1$|(?<=,\d),1$")
_NUMBER = re.compile(r"\$[0-9A-F]+|\d+\.?\d*|\.\d+")
_SHORTENED = re.compile(r"(ENDI)F\b")
_TERM = re.compile(r"([+-]?)(\d+\.?\d*|\.\d+|(?=[A-Z]))([A-CU-Z]?)")


def inspect(operation: Operation, robot: Robot, items: Sequence[Item]) -> Script[Inspection]:
    """Inspect the controller: its kind, its settings, the motors, running programs, and the guard PLC.

    Nothing moves. The guard is tested only if all motors are closed-loop and at rest, and no program runs.

    Args:
        operation: state of the run, and access to the controller.
        robot: the robot.
        items: the settings to compare, with their required values.
    """
    operation.slowest = 0.0
    with contextlib.suppress(Refused):
        # If another client left a buffer open on this port, the buffer would store the questions.
        yield from operation.ask("CLOSE")
    checked = [(yield from _kind(operation))]
    running = yield from _idle(operation, robot)
    checked.append(running)
    for question in _questions(items):
        checked += yield from _compared(operation, question)
    motors = yield from motor_statuses(operation, robot)
    checked += [_motor(robot, row, motor) for row, motor in enumerate(motors)]
    joints = None
    if not any(one.verdict == "error" for one in checked):
        joints = yield from stands_at(operation, robot)
        checked.append((yield from guard_works(operation, robot)))
        if checked[-1].verdict == "ok":
            checked += yield from _watchdog_works(operation, robot)
        kinds = {"number": "number", "bits": "number", "listing": "listing"}
        looked = [(item.subject, item.question, kinds.get(item.kind, "definition")) for item in items]
        operation.memory = yield from remember(operation, robot, looked)
    return Inspection(tuple(checked), joints, running.verdict == "ok")


def _kind(operation: Operation) -> Script[Checked]:
    """Ask for the controller's CID and TYPE, and check that at least one of them is that of a Turbo PMAC."""
    try:
        identity = yield from operation.one("CID")
        name = yield from operation.one("TYPE")
    except Refused as refused:
        return Checked("controller", str(refused), "a Turbo PMAC", "error", "is this a Turbo PMAC?")
    fits = identity in TURBO or "TURBO" in name.upper()
    remedy = "" if fits else "programs for the Turbo PMAC have another meaning on this controller"
    return Checked(
        "controller", f"{name} (CID {identity})", "a Turbo PMAC", "ok" if fits else "error", remedy
    )


def _idle(operation: Operation, robot: Robot) -> Script[Checked]:
    """Check that no program runs in the coordinate system, and that no program was left unfinished."""
    status = yield from system_words(operation, robot)
    motors = yield from motor_statuses(operation, robot)
    subject = f"coordinate system {turbo_pmac(robot).coordinate_system}"
    if all(motor.at_rest for motor in motors):
        if not status.running:
            return Checked(subject, "no program runs", "no program runs", "ok")
        state, remedy = (
            "an unfinished program is held, or waits for lines",
            "end it at the robot's position with `yarc stop --to ...`",
        )
    else:
        state, remedy = "it moves", "wait for its end, or `yarc stop --to ...`"
    return Checked(subject, state, "no program runs", "error", remedy)


def _questions(items: Sequence[Item]) -> Iterator[list[Item]]:
    """Group settings into lines with questions. Only questions that are answered by a number can share a
    line.
    """
    line: list[Item] = []
    for item in items:
        together = item.kind in ("number", "bits")
        if line and (not together or sum(len(one.question) for one in line) > _LONGEST_QUESTION):
            yield line
            line = []
        if together:
            line.append(item)
        else:
            yield [item]
    if line:
        yield line


def _compared(operation: Operation, items: list[Item]) -> Script[list[Checked]]:
    try:
        answers = yield from operation.ask("".join(item.question for item in items))
    except Refused as refused:
        return [Checked(item.subject, str(refused), item.wanted, "error", item.remedy) for item in items]
    if len(items) == 1:
        return [_verdict(items[0], "\n".join(answers))]
    if len(answers) != len(items):
        told = f"{len(answers)} values for {len(items)} questions"
        return [Checked(item.subject, told, item.wanted, "error", item.remedy) for item in items]
    return [_verdict(item, text) for item, text in zip(items, answers, strict=True)]


def _verdict(item: Item, answer: str) -> Checked:
    ok = _SAME[item.kind](answer, item.wanted)
    if item.kind == "listing":
        shown = "as it should be" if ok else "another program" if _without_end(answer) else "empty"
        return Checked(
            item.subject,
            shown,
            "as in `yarc settings`",
            "ok" if ok else "error",
            "" if ok else item.remedy,
        )
    return Checked(
        item.subject, answer or "nothing", item.wanted, "ok" if ok else "error", "" if ok else item.remedy
    )


def _same_number(actual: str, expected: str) -> bool:
    try:
        one, other = number_in(actual), number_in(expected)
    except ValueError:
        return False
    return _close(one, other)


def _close(first: float, other: float) -> bool:
    return abs(first - other) <= _CLOSE_ENOUGH * max(1.0, abs(other))


def _same_bits(actual: str, expected: str) -> bool:
    try:
        bits = int(number_in(expected))
        return int(number_in(actual)) & bits == bits
    except ValueError:
        return False


def _same_text(actual: str, expected: str) -> bool:
    """Return True if two texts of a setting agree except for case, spaces, leading zeros and the format of
    numbers.
    """
    one, other = _words(actual), _words(expected)
    if len(one) != len(other):
        return False
    return all(
        a == b or (isinstance(a, float) and isinstance(b, float) and _close(a, b))
        for a, b in zip(one, other, strict=True)
    )


def _same_definition(actual: str, expected: str) -> bool:
    """Return True if two axis definitions agree. Terms may be in any order, and a missing factor is 1."""
    one, other = _terms(actual), _terms(expected)
    return one.keys() == other.keys() and all(
        abs(one[axis] - other[axis]) <= _EXACT * max(1.0, abs(other[axis])) for axis in one
    )


def _terms(text: str) -> dict[str, float]:
    """Return the terms of an axis definition: the counts by axis, with the offset under ''. Text that isn't a
    term gets a key of its own, so that it equals no other term.
    """
    terms: dict[str, float] = {}
    text = re.sub(r"\s", "", text.upper())
    for term in re.findall(r"[+-]?[^+-]+", text):
        if shape := _TERM.fullmatch(term):
            value = float(shape[2] or 1.0) * (-1.0 if shape[1] == "-" else 1.0)
            terms[shape[3]] = terms.get(shape[3], 0.0) + value
        else:
            terms[term] = 0.0
    return {axis: value for axis, value in terms.items() if value or axis}


def _same_address(actual: str, expected: str) -> bool:
    """Return True if two addresses of M-variables agree; a width of one bit may be omitted."""
    return _same_text(_BIT.sub("", actual), _BIT.sub("", expected))


def _same_listing(actual: str, expected: str) -> bool:
    """Return True if two program listings agree. A listing adds a RETURN and may shorten words."""
    return _same_text(_SHORTENED.sub(r"\1", _without_end(actual)), _SHORTENED.sub(r"\1", expected.upper()))


def _without_end(listing: str) -> str:
    """Return a listing without the RETURN at its end."""
    return re.sub(r"\s*RET(URN)?\s*$", "", listing.upper())


def _words(text: str) -> list[str | float]:
    words: list[str | float] = []
    at = 0
    text = re.sub(r"\s", "", text.upper())
    for number in _NUMBER.finditer(text):
        words += [text[at : number.start()], number_in(number[0])]
        at = number.end()
    return [*words, text[at:]]


_SAME = {
    "number": _same_number,
    "bits": _same_bits,
    "definition": _same_definition,
    "address": _same_address,
    "listing": _same_listing,
}


def _motor(robot: Robot, row: int, status: MotorStatus) -> Checked:
    number = robot.controller.motors[row]
    subject = f"motor {number}"
    expected = "closed-loop, homed, without a fault"
    if trouble := status.trouble:
        remedy = f"find out why, then close its loop: `#{number}J/`"
        return Checked(subject, trouble, expected, "error", remedy)
    if not status.has("home complete"):
        return Checked(
            subject, "it isn't homed", expected, "error", "home it: until then its position is meaningless"
        )
    if status.has("warning following error"):
        return Checked(
            subject, "its following error is beyond Ixx12", expected, "warning", "check its load and tuning"
        )
    return Checked(subject, "closed-loop, homed", expected, "ok")


def guard_works(operation: Operation, robot: Robot) -> Script[Checked]:
    """Arm the guard PLC while the rotary is empty, and check that the PLC holds at once.

    Afterwards an abort ends the hold; it doesn't affect motors that are closed-loop and at rest. Leftover
    lines in the rotary, of a program that is no longer run, are deleted.
    """
    system = turbo_pmac(robot).coordinate_system
    subject = f"guard PLC {GUARD_PLC}"
    expected = "holds when the rotary buffer runs low"
    remedy = (
        f"without it the robot isn't stopped if this computer fails: download `yarc settings {robot.name}`"
    )
    yield from operation.ask("CLOSE ALL")
    (full,) = yield from operation.numbers(ROTARY_FULL, 1)
    if full:
        yield from operation.ask(f"&{system}DELETE ROT")
    # The rotary is empty, so the PLC must hold at its next scan, and set the flag to 2.
    yield from operation.ask(f"{ARMED}=1")
    since = operation.now
    value = 1.0
    while value == 1.0 and operation.now - since < _GUARD_TIME:
        yield Wait(operation.now + 0.01)
        (value,) = yield from operation.numbers(ARMED, 1)
    yield from operation.ask(f"{ARMED}=0")
    yield from operation.ask(f"&{system}A")
    if value == 2.0:
        return Checked(
            subject, f"it held within {max(operation.now - since, 1e-3) * 1e3:.0f} ms", expected, "ok"
        )
    return Checked(subject, "armed, but it doesn't react", expected, "error", remedy)


def _watchdog_works(operation: Operation, robot: Robot) -> Script[list[Checked]]:
    """Let the guard PLC watch this computer, restart its timer only once, and check that the PLC then holds.

    The PLC must hold when the timer has run down, and not before. PLC 0 must see the guard's heartbeat. Then
    the longest silence of this computer is chosen from the slowest reply of the inspection, unless a person
    has set it.
    """
    controller = turbo_pmac(robot)
    remedy = f"download `yarc settings {robot.name}` and SAVE"
    wound = wound_up(controller, _TRIAL)
    begun = since = operation.now
    (first,) = yield from operation.numbers(HEARTBEAT, 1)
    yield from operation.ask(f"{wound} {WATCHED}=1")
    yield Wait(operation.now + _TRIAL / 2.0)
    again = operation.now
    # Restart the timer, as each question of a run does, unless this computer is late.
    (flag,) = yield from operation.numbers(f"{wound} {WATCHED}", 1)
    since = again if flag == 1.0 else since
    while flag == 1.0 and operation.now - since < _GUARD_TIME:
        yield Wait(operation.now + 0.01)
        (flag,) = yield from operation.numbers(WATCHED, 1)
    lasted = operation.now - since
    beat, echo = yield from operation.numbers(f"{HEARTBEAT}{ECHO}", 2)
    spent = operation.now - begun
    yield from operation.ask(f"{WATCHED}=0")
    yield from operation.ask(f"&{controller.coordinate_system}A")
    if flag != 2.0 or lasted < _EARLIEST * _TRIAL:
        pace = yield from pace_of(operation, controller)
        if abs(pace - 1.0) > OTHER_PACE:
            found = f"runs about {pace:.2g} times as fast as on this computer"
            return [Checked("the controller's time", found, "real time", "error", OTHER_PACE_REMEDY)]
    return [
        _biting(operation, robot, flag, lasted, remedy),
        _beating(operation, beat - first, spent, remedy),
        _heartbeat_item(beat - echo, remedy),
    ]


def _biting(operation: Operation, robot: Robot, flag: float, lasted: float, remedy: str) -> Checked:
    hold_time = robot.controller.hold_time
    operation.silence = operation.wanted_silence or patience_for(operation.slowest, hold_time)
    rest = operation.silence + hold_time
    expected = "holds when this computer sends nothing"
    if flag != 2.0:
        return Checked("watchdog", "started, but it doesn't react", expected, "error", remedy)
    if lasted < _EARLIEST * _TRIAL:
        return Checked(
            "watchdog",
            f"it held {lasted * 1e3:.0f} ms after it was started with a time of {_TRIAL * 1e3:.0f} ms",
            expected,
            "error",
            remedy,
        )
    measured = f"holds after {operation.silence:.2g} s of silence: at rest within {rest:.2g} s"
    if rest <= AT_REST_WITHIN + 0.05 or operation.silence > needed(operation.slowest):
        # No warning about a slow connection: either the robot is at rest in time, or the long silence has
        # another cause, which is the robot's hold time or a person's choice.
        return Checked("watchdog", measured, expected, "ok")
    slow = f"a reply has taken {operation.slowest * 1e3:.0f} ms: find out what slows the link"
    return Checked("watchdog", measured, "at rest within 1 s", "warning", slow)


def _beating(operation: Operation, beats: float, spent: float, remedy: str) -> Checked:
    subject, wanted = "heartbeat of the guard PLC", "beats"
    if beats <= 0.0:
        return Checked(subject, f"doesn't change for {spent * 1e3:.0f} ms", wanted, "error", remedy)
    operation.beat = spent / beats
    return Checked(subject, f"each {operation.beat * 1e3:.1f} ms", wanted, "ok")


def _heartbeat_item(behind: float, remedy: str) -> Checked:
    subject, expected = f"PLC {FEEDBACK_PLC}, running", "it hears the guard PLC's heartbeat"
    if behind > 3.0:
        return Checked(
            subject, "it doesn't run", expected, "error", f"`I5=3`, `ENABLE PLC {FEEDBACK_PLC}`; or {remedy}"
        )
    return Checked(subject, "it runs", expected, "ok")
